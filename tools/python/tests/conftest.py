"""What the tests share."""

import os
import shutil
import subprocess

import numpy as np
import pytest

import merlkit


@pytest.fixture(scope="session")
def nickel():
    return merlkit.load("nickel")


@pytest.fixture(scope="session")
def sampler(nickel):
    return merlkit.Sampler.build(nickel, "half-vector:2KB")


@pytest.fixture(scope="session")
def command():
    """Runs the command `merlkit`, which MERLKIT names or the search path has."""
    program = os.environ.get("MERLKIT") or shutil.which("merlkit")
    if program is None:
        pytest.skip("no command merlkit: set MERLKIT to its path")

    def run(*arguments):
        done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def directions(count, seed=1):
    """Directions over the hemisphere, a few below the horizon."""
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(count, 3))
    vectors[:, 2] = np.abs(vectors[:, 2])
    vectors[::50, 2] *= -1
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)
