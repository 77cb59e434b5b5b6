"""Studies of many materials: a list of independent tasks that any number of machines share.

A plan is a JSON file. Each task of it has a key that depends on the task alone, and its result is one file, KEY.json, in a folder that
the machines share. A task whose file is there is not run again. Results have the same bytes for any number of workers. Plans and
results are those of the command `merlkit study`, which runs the same code: either runs what the other has planned.

    python3 -m merlkit.study plan plan.json --material nickel --material chrome --sampler half-vector:64KB --theta 10 --theta 60 --seeds 4
    python3 -m merlkit.study run plan.json results --shard 1/8
    python3 -m merlkit.study merge plan.json results study.json

`run` is one job of a job array, or give it a client of dask.distributed, or the module ray:

    merlkit.study.run(merlkit.study.read("plan.json"), "results", client=Client("tcp://scheduler:8786"))
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from . import _native

Task = Dict[str, Any]
"""What a task is asked to do: `kind`, and what that kind needs."""

Folder = Union[str, "os.PathLike[str]"]

RETRIES = 3
"""How often Dask and Ray try a task again."""

_Named = Tuple[str, Task]


def key(task: Task) -> str:
    """The name of a task's result: readable words, then a checksum of all of the task."""
    return _native._task_key(json.dumps(task))


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
    pictures: Optional[Dict[str, Any]] = None,
) -> List[Task]:
    """The tasks of a study, those of a material together.

    For each material, sampler, polar angle of `wo` in degrees and seed, an estimate of the albedo from `draws` draws; with `checks`, for
    each material, sampler and seed the checks of `merlkit.check`; with `pictures`, for each material and sampler the tiles of a picture
    (`lights`, `size`, `tile`, `spp`, `bounces`, `seed`); with `models`, for each material their fits.
    """
    study = {
        "materials": list(materials),
        "samplers": list(samplers),
        "thetas": list(thetas),
        "seeds": seeds,
        "draws": draws,
        "checks": checks,
        "models": list(models),
        "lookup": lookup,
        "pictures": pictures,
    }
    return _tasks(_native._plan_study(json.dumps(study)))


def write(tasks: List[Task], path: Folder) -> None:
    """Writes a plan."""
    _write_whole(Path(path), _native._plan_tasks(json.dumps(tasks)))


def read(path: Folder) -> List[Task]:
    """Reads a plan."""
    data = Path(path).read_bytes()
    _native._check_plan(data, os.fspath(path))
    return _tasks(data.decode())


def _tasks(text: str) -> List[Task]:
    return [entry["task"] for entry in json.loads(text)["results"]]


def shard(tasks: Sequence[Task], index: int, count: int) -> List[Task]:
    """Part `index` of `count`, from 1 on: neighbours in the plan, which share materials."""
    if not 1 <= index <= count:
        raise ValueError(f"shard {index}/{count}; give one from 1/{count} to {count}/{count}")
    return list(tasks[len(tasks) * (index - 1) // count : len(tasks) * index // count])


def run_task(task: Task) -> Dict[str, Any]:
    """The result of a task."""
    result: Dict[str, Any] = json.loads(_native._run_task(json.dumps(task)))["results"]["result"]
    return result


def run(
    tasks: Iterable[Task],
    folder: Folder,
    *,
    client: Any = None,
    progress: Optional[Callable[[int, int], None]] = None,
) -> int:
    """Runs the tasks whose results are missing, and returns their number.

    Without `client` they run here, one after another. With a client of dask.distributed, or with the module ray after `ray.init`, they run
    on its workers, those of a material together; a worker that is lost costs the materials that it was at. `progress` is called with
    the number of finished tasks and of all that are to be run.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    missing = {key(task): task for task in tasks}
    missing = {name: task for name, task in missing.items() if not (target / f"{name}.json").exists()}
    if client is None:
        results = _run_here(missing)
    elif getattr(client, "__name__", None) == "ray":
        results = _run_on_ray(client, _groups(missing))
    else:
        results = _run_on_dask(client, _groups(missing))
    for done, (name, text) in enumerate(results, start=1):
        _write_whole(target / f"{name}.json", text)
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
            results.append(json.loads(path.read_text(encoding="utf-8"))["results"])
        else:
            missing.append(path.name)
    if missing:
        raise ValueError(
            f"{len(missing)} results are missing, the first is {missing[0]}; run the plan again, which runs only these"
        )
    return results


def _run_here(tasks: Dict[str, Task]) -> Iterable[Tuple[str, str]]:
    for name, task in tasks.items():
        yield name, _native._run_task(json.dumps(task))


def _groups(tasks: Dict[str, Task]) -> List[List[_Named]]:
    """Neighbours of one material, which is loaded once for all of them."""
    return [list(group) for _, group in itertools.groupby(tasks.items(), lambda named: named[1]["material"])]


def _run_group(group: List[_Named]) -> List[Tuple[str, str]]:
    return list(_run_here(dict(group)))


def _run_on_dask(client: Any, groups: List[List[_Named]]) -> Iterable[Tuple[str, str]]:
    from dask.distributed import as_completed

    futures = [client.submit(_run_group, group, key=f"merlkit-{group[0][0]}", retries=RETRIES) for group in groups]
    for future in as_completed(futures):
        yield from future.result()


def _run_on_ray(ray: Any, groups: List[List[_Named]]) -> Iterable[Tuple[str, str]]:
    remote = ray.remote(max_retries=RETRIES)(_run_group)
    waiting = [remote.remote(group) for group in groups]
    while waiting:
        finished, waiting = ray.wait(waiting)
        for reference in finished:
            yield from ray.get(reference)


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
            tasks = read(args.plan)
            merge(tasks, args.results)
            _write_whole(Path(args.output), _native._merge_study(args.plan, args.results))
    except (OSError, ValueError) as error:
        print(f"merlkit.study: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
