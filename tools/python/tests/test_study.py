"""Studies give the same bytes however their tasks are shared, and lost workers cost only their tasks."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from merlkit import study

PLAN = dict(
    samplers=["half-vector:2KB", "cosine"], thetas=[10.0, 60.0], seeds=2, draws=2000, models=["ggx"]
)


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def tasks():
    return study.plan(["lambert:reflectance=0.5", "ggx:ax=0.2,ay=0.2"], **PLAN)


@pytest.fixture(scope="module")
def expected(tasks, tmp_path_factory):
    folder = tmp_path_factory.mktemp("expected")
    assert study.run(tasks, folder) == len(tasks) == 18
    return files(folder)


def test_keys_are_stable_and_unique(tasks):
    keys = [study.key(task) for task in tasks]
    assert len(set(keys)) == len(keys)
    assert study.key(tasks[0]) == study.key(dict(reversed(tasks[0].items())))
    assert keys[0] == "estimate-lambert-reflectance-0-KEY".replace("KEY", keys[0].rsplit("-", 1)[1])


def test_an_estimate_is_near_the_albedo(tasks, expected, tmp_path):
    for name, content in expected.items():
        (tmp_path / name).write_bytes(content)
    for merged in study.merge(tasks, tmp_path):
        if merged["task"]["kind"] == "estimate":
            result = merged["result"]
            spread = result["deviation"][0] / merged["task"]["draws"] ** 0.5
            assert abs(result["mean"][0] - result["albedo"][0]) < 5 * spread + 1e-4


@pytest.mark.parametrize("count", [1, 3, 5])
def test_processes_with_a_part_each_give_the_same_bytes(tasks, expected, tmp_path, count):
    plan, results = tmp_path / "plan.json", tmp_path / "results"
    study.write(tasks, plan)
    command = [sys.executable, "-m", "merlkit.study"]
    jobs = [
        subprocess.Popen([*command, "run", str(plan), str(results), "--shard", f"{i}/{count}"], stdout=subprocess.DEVNULL)
        for i in range(1, count + 1)
    ]
    assert [job.wait() for job in jobs] == [0] * count
    assert files(results) == expected
    merged = tmp_path / "merged.json"
    subprocess.run([*command, "merge", str(plan), str(results), str(merged)], check=True)
    assert merged.stat().st_size > 1000


def test_what_is_finished_is_not_run_again(tasks, expected, tmp_path):
    for name, content in list(expected.items())[:10]:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match="8 results are missing"):
        study.merge(tasks, tmp_path)
    seen = []
    assert study.run(tasks, tmp_path, progress=lambda done, count: seen.append((done, count))) == 8
    assert seen[-1] == (8, 8)
    assert files(tmp_path) == expected


def test_wrong_shards_are_refused(tasks):
    for index, count in [(0, 3), (4, 3), (1, 0)]:
        with pytest.raises(ValueError, match="shard"):
            study.shard(tasks, index, count)
    assert sum((study.shard(tasks, i, 7) for i in range(1, 8)), []) == tasks


@pytest.mark.filterwarnings("ignore")
def test_a_lost_worker_costs_only_its_tasks(tasks, expected, tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    with distributed.LocalCluster(
        n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        killed = []

        def kill_one(done, count):
            if done == 3 and not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)
                time.sleep(0.2)

        assert study.run(tasks, tmp_path, client=client, progress=kill_one) == len(tasks)
        assert killed
    assert files(tmp_path) == expected


PICTURES = {"lights": ["studio"], "size": [50, 30], "tile": 20, "spp": 4}


def test_the_command_plans_and_runs_the_same_bytes(command, tmp_path):
    materials = ["lambert:reflectance=0.5", "ggx:ax=0.2,ay=0.2"]
    described = dict(PLAN, materials=materials, pictures=PICTURES)
    (tmp_path / "study.json").write_text(json.dumps(described))
    folder = tmp_path / "s"
    command("study", "plan", str(tmp_path / "study.json"), "-o", str(folder))
    tasks = study.plan(materials, **PLAN, pictures=PICTURES)
    study.write(tasks, tmp_path / "plan.json")
    assert (tmp_path / "plan.json").read_bytes() == (folder / "plan.json").read_bytes()
    # Each runs a part of what the other has planned.
    study.run(study.shard(study.read(folder / "plan.json"), 1, 2), folder / "results")
    command("study", "run", str(folder), "--shard", "2/2")
    study.run(tasks, tmp_path / "here")
    assert files(folder / "results") == files(tmp_path / "here")
    command("study", "merge", str(folder), "-o", str(tmp_path / "merged"))
    assert len(list((tmp_path / "merged").glob("*.exr"))) == 4


def test_tiles_are_left_to_the_command(tmp_path):
    tasks = study.plan(["lambert"], samplers=["cosine"], pictures=PICTURES)
    study.write(tasks, tmp_path / "plan.json")
    study.run(tasks, tmp_path / "results")
    arguments = ["merge", str(tmp_path / "plan.json"), str(tmp_path / "results"), str(tmp_path / "merged.json")]
    assert study.main(arguments) == 2
    assert not (tmp_path / "merged.json").exists()


def test_plans_that_were_changed_are_refused(tasks, tmp_path):
    path = tmp_path / "plan.json"
    study.write(tasks, path)
    text = path.read_text()
    path.write_text(text.replace(study.key(tasks[0]), "../../outside"))
    with pytest.raises(ValueError, match="is not its task's"):
        study.read(path)
    with pytest.raises(ValueError, match="more than"):
        study.plan(["lambert"], samplers=["cosine"], thetas=[10.0], seeds=10**15)


def test_ray_gives_the_same_bytes(tasks, expected, tmp_path):
    ray = pytest.importorskip("ray")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        seen = []
        done = study.run(tasks, tmp_path, client=ray, progress=lambda done, count: seen.append((done, count)))
        assert done == len(tasks) and seen[-1] == (18, 18)
    finally:
        ray.shutdown()
    assert files(tmp_path) == expected
