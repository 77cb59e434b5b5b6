"""Threads, forks and memory."""

import concurrent.futures
import gc
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import merlkit
from conftest import directions


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_threads_get_the_same_values(nickel, sampler):
    wi = directions(50_000)
    expected = nickel.eval([0, 0, 1], wi)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for values in pool.map(lambda _: nickel.eval([0, 0, 1], wi), range(16)):
            assert np.array_equal(values, expected)


def test_other_threads_run_meanwhile(nickel):
    """A thread counts while another builds: it would count to nothing if the build held the interpreter."""
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        building = pool.submit(merlkit.Sampler.build, nickel, "adaptive-disc:tables=20")
        counted = 0
        while not building.done():
            counted += 1
        assert counted > 1000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_child_builds_too():
    program = """
        import os, sys, merlkit
        nickel = merlkit.load("nickel")
        merlkit.Sampler.build(nickel, "half-vector:2KB")
        child = os.fork()
        if child == 0:
            merlkit.Sampler.build(nickel, "half-vector:2KB")
            os._exit(0)
        _, status = os.waitpid(child, 0)
        sys.exit(os.waitstatus_to_exitcode(status))
    """
    subprocess.run([sys.executable, "-W", "ignore", "-c", textwrap.dedent(program)], check=True, timeout=60)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_nothing_leaks(nickel, sampler, tmp_path):
    wi, u = directions(2000), np.random.default_rng(1).random((2000, 2))
    grey = merlkit.load("lambert:reflectance=0.5")
    function = lambda wo, wi: np.full(wi.shape, 0.1)  # noqa: E731

    def round_trip(count):
        for _ in range(count):
            merlkit.Sampler.build(grey, "half-vector:tables=4,rows=4,segments=4")
            nickel.eval([0, 0, 1], wi)
            nickel.table[0, 0, 0]
            sampler.sample([0, 0, 1], u)
            with pytest.raises(ValueError):
                merlkit.load("nikel")
            merlkit.from_function(function).eval([0, 0, 1], wi[:4])

    round_trip(500)
    gc.collect()
    before = resident()
    round_trip(10_000)
    gc.collect()
    assert resident() - before < 8 << 20
