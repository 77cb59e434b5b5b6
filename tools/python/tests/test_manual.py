"""The examples of the manual run."""

import importlib.util
import pathlib
import re

import pytest

MANUAL = pathlib.Path(__file__).parents[3] / "docs" / "python.md"


def examples():
    blocks = re.findall(r"```python\n(.*?)```", MANUAL.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) > 5
    # Those for a scheduler and for Mitsuba have tests of their own.
    return [block for block in blocks if "from dask" not in block and "import mitsuba" not in block]


def test_the_examples_run(tmp_path, monkeypatch):
    if not MANUAL.exists():
        pytest.skip("no manual here")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {}
    for block in examples():
        needed = {"merlkit.xarray": "xarray", "merlkit.plot": "matplotlib"}
        if any(name in block and importlib.util.find_spec(package) is None for name, package in needed.items()):
            continue
        exec(compile(block, str(MANUAL), "exec"), names)  # noqa: S102
    assert names["report"].passed
    assert (tmp_path / "nickel.mtlx").exists()
