"""Studies of many materials: a list of independent tasks that any number of machines share.

A plan is a JSON file. Each task of it has a key that depends on the task alone, and its result is one file, KEY.json, in a folder that
the machines share. A task whose file is there is not run again. Results have the same bytes for any number of workers.

    python3 -m merlkit.study plan plan.json --material nickel --material chrome --sampler half-vector:64KB --theta 10 --theta 60 --seeds 4
    python3 -m merlkit.study run plan.json results --shard 1/8
    python3 -m merlkit.study merge plan.json results study.json

`run` is one job of a job array, or give it a client of dask.distributed:

    merlkit.study.run(merlkit.study.read("plan.json"), "results", client=Client("tcp://scheduler:8786"))
"""

from __future__ import annotations

import argparse
import functools
import hashlib
import json
import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np

import merlkit

Task = Dict[str, Any]
"""What a task is asked to do: `kind`, and what that kind needs."""

Folder = Union[str, "os.PathLike[str]"]

RETRIES = 3
"""How often Dask tries a task again."""


def key(task: Task) -> str:
    """The name of a task's result: readable words, then a checksum of all of the task."""
    text = json.dumps(task, sort_keys=True)
    words = f"{task['kind']}-{Path(task['material']).stem}"
    safe = "".join(c if c.isalnum() or c in "-." else "-" for c in words)
    return f"{safe[:80]}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def plan(
    materials: Sequence[str],
    *,
    samplers: Sequence[str] = (),
    thetas: Sequence[float] = (),
    seeds: int = 1,
    draws: int = 10_000,
    checks: bool = False,
    models: Sequence[str] = (),
    lookup: str = "floor",
) -> List[Task]:
    """The tasks of a study, those of a material together.

    For each material, sampler, polar angle of `wo` in degrees and seed, an estimate of the albedo from `draws` draws; with `checks`, for
    each material, sampler and seed the checks of `merlkit.check`; with `models`, for each material their fits.
    """
    tasks: List[Task] = []
    for material in materials:
        subject = {"material": material, "lookup": lookup}
        for sampler in samplers:
            for seed in range(1, seeds + 1):
                drawn = {**subject, "sampler": sampler, "seed": seed, "draws": draws}
                for theta in thetas:
                    tasks.append({"kind": "estimate", **drawn, "theta": theta})
                if checks:
                    tasks.append({"kind": "check", **drawn})
        if models:
            tasks.append({"kind": "fit", **subject, "models": list(models)})
    return tasks


def write(tasks: List[Task], path: Folder) -> None:
    """Writes a plan."""
    _write_whole(Path(path), _text({"schema": 1, "tasks": tasks}))


def read(path: Folder) -> List[Task]:
    """Reads a plan."""
    document = json.loads(Path(path).read_text(encoding="utf-8"))
    if document.get("schema") != 1:
        raise ValueError(f"{path} is not a plan of this version; make it again with `python3 -m merlkit.study plan`")
    tasks: List[Task] = document["tasks"]
    return tasks


def shard(tasks: Sequence[Task], index: int, count: int) -> List[Task]:
    """Part `index` of `count`, from 1 on: neighbours in the plan, which share materials."""
    if not 1 <= index <= count:
        raise ValueError(f"shard {index}/{count}; give one from 1/{count} to {count}/{count}")
    return list(tasks[len(tasks) * (index - 1) // count : len(tasks) * index // count])


def run_task(task: Task) -> Dict[str, Any]:
    """The result of a task."""
    return _KINDS[task["kind"]](task)


def run(
    tasks: Iterable[Task],
    folder: Folder,
    *,
    client: Any = None,
    progress: Optional[Callable[[int, int], None]] = None,
) -> int:
    """Runs the tasks whose results are missing, and returns their number.

    Without `client` they run here, one after another. With a client of dask.distributed they run on its workers; a worker that is lost
    costs the tasks that it was running. `progress` is called with the number of finished tasks and of all that are to be run.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    missing = {key(task): task for task in tasks}
    missing = {name: task for name, task in missing.items() if not (target / f"{name}.json").exists()}
    results = _run_here(missing) if client is None else _run_on(client, missing)
    for done, (name, result) in enumerate(results, start=1):
        _write_whole(target / f"{name}.json", _text({"task": missing[name], "result": result}))
        if progress is not None:
            progress(done, len(missing))
    return len(missing)


def merge(tasks: Iterable[Task], folder: Folder) -> List[Dict[str, Any]]:
    """The results of all tasks in the order of the plan."""
    target = Path(folder)
    results, missing = [], []
    for task in tasks:
        path = target / f"{key(task)}.json"
        if path.exists():
            results.append(json.loads(path.read_text(encoding="utf-8")))
        else:
            missing.append(path.name)
    if missing:
        raise ValueError(
            f"{len(missing)} results are missing, the first is {missing[0]}; run the plan again, which runs only these"
        )
    return results


def _run_here(tasks: Dict[str, Task]) -> Iterable[Tuple[str, Any]]:
    for name, task in tasks.items():
        yield name, run_task(task)


def _run_on(client: Any, tasks: Dict[str, Task]) -> Iterable[Tuple[str, Any]]:
    from dask.distributed import as_completed

    futures = [client.submit(run_task, task, key=f"merlkit-{name}", retries=RETRIES) for name, task in tasks.items()]
    names = {future.key: name for future, name in zip(futures, tasks)}
    for future in as_completed(futures):
        yield names[future.key], future.result()


@functools.lru_cache(maxsize=2)
def _material(name: str, lookup: Any) -> merlkit.Material:
    return merlkit.load(name, lookup)


@functools.lru_cache(maxsize=4)
def _sampler(material: str, lookup: str, sampler: str) -> merlkit.Sampler:
    return merlkit.Sampler.build(_material(material, lookup), sampler)


def _estimate(task: Task) -> Dict[str, Any]:
    material = _material(task["material"], task["lookup"])
    sampler = _sampler(task["material"], task["lookup"], task["sampler"])
    wo = merlkit.spherical(math.radians(task["theta"]))
    u = np.random.Generator(np.random.Philox(task["seed"])).random((task["draws"], 2), dtype=np.float32)
    wi, pdf = sampler.sample(wo, u)
    # A failed draw has the weight 0.
    weight = material.eval_cos(wo, wi).astype(np.float64) / np.where(pdf > 0, pdf, 1)[:, None]
    return {
        "mean": weight.mean(axis=0).tolist(),
        "deviation": weight.std(axis=0).tolist(),
        "failed": int((pdf == 0).sum()),
        "albedo": material.albedo(wo).tolist(),
    }


def _check(task: Task) -> Dict[str, Any]:
    sampler = _sampler(task["material"], task["lookup"], task["sampler"])
    report = merlkit.check(sampler, draws=task["draws"], seed=task["seed"])
    return {"passed": report.passed, "failures": report.failures}


def _fit(task: Task) -> Dict[str, Any]:
    return {"fits": merlkit.fit(_material(task["material"], task["lookup"]), task["models"]).fits}


_KINDS: Dict[str, Callable[[Task], Dict[str, Any]]] = {"estimate": _estimate, "check": _check, "fit": _fit}


def _text(document: Any) -> str:
    return json.dumps(document, sort_keys=True, indent=1, ensure_ascii=False) + "\n"


def _write_whole(path: Path, text: str) -> None:
    """Writes a file that appears whole or not at all, so that a worker that is killed leaves no half of one."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _part(text: str) -> Tuple[int, int]:
    index, _, count = text.partition("/")
    return int(index), int(count)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m merlkit.study", description="Studies of many materials on many machines.")
    commands = parser.add_subparsers(dest="command", required=True)
    planning = commands.add_parser("plan", help="write the list of tasks")
    planning.add_argument("plan")
    planning.add_argument("--material", action="append", required=True)
    planning.add_argument("--sampler", action="append", default=[])
    planning.add_argument("--theta", action="append", type=float, default=[], help="polar angle of wo in degrees")
    planning.add_argument("--seeds", type=int, default=1)
    planning.add_argument("--draws", type=int, default=10_000)
    planning.add_argument("--checks", action="store_true", help="check each sampler, too")
    planning.add_argument("--model", action="append", default=[], help="model to fit to each material")
    planning.add_argument("--lookup", default="floor")
    running = commands.add_parser("run", help="run the tasks whose results are missing")
    running.add_argument("plan")
    running.add_argument("results", help="folder that all machines share")
    running.add_argument("--shard", type=_part, default=(1, 1), metavar="I/N", help="the part of the tasks to run, from 1/N to N/N")
    merging = commands.add_parser("merge", help="write all results as one file")
    merging.add_argument("plan")
    merging.add_argument("results")
    merging.add_argument("output")
    return parser


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """The command line."""
    args = _parser().parse_args(arguments)
    try:
        if args.command == "plan":
            tasks = plan(
                args.material,
                samplers=args.sampler,
                thetas=args.theta,
                seeds=args.seeds,
                draws=args.draws,
                checks=args.checks,
                models=args.model,
                lookup=args.lookup,
            )
            write(tasks, args.plan)
            print(f"{args.plan}: {len(tasks)} tasks")
        elif args.command == "run":
            done = run(shard(read(args.plan), *args.shard), args.results)
            print(f"{args.results}: {done} tasks run")
        else:
            _write_whole(Path(args.output), _text({"schema": 1, "results": merge(read(args.plan), args.results)}))
    except (OSError, ValueError) as error:
        print(f"merlkit.study: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
