"""Ctrl-C ends long calls within a second, in which threads of the library go on or stop by themselves."""

import os
import signal
import sys
import threading
import time

import numpy as np
import pytest

import merlkit

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")

PATIENCE = 1.0
"""Seconds within which a call must end; more than enough on a busy machine."""


def interrupted(call, delay=0.5):
    """Seconds from Ctrl-C to the end of a call, which must be by KeyboardInterrupt."""
    sent = []

    def interrupt():
        time.sleep(delay)
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        ended = time.monotonic()
        thread.join()
    return ended - sent[0]


def calls(nickel, sampler):
    many = [merlkit.load("lambert:reflectance=0.5")]
    return {
        "check": lambda: merlkit.check(sampler, draws=10_000_000),
        "fit": lambda: merlkit.fit(nickel, pairs=1_000_000),
        "render": lambda: merlkit.render(many, spp=1_000_000, width=64, height=64),
        "build": lambda: [merlkit.Sampler.build(nickel, "half-vector:1MB") for _ in range(1000)],
        "report": lambda: merlkit.report(nickel, ["half-vector:64KB"], draws=2_000_000_000),
    }


@pytest.mark.parametrize("name", ["check", "fit", "render", "build", "report"])
def test_a_long_call_ends_soon_after_ctrl_c(nickel, sampler, name):
    assert interrupted(calls(nickel, sampler)[name]) < PATIENCE


def test_the_package_works_after_an_interruption(nickel, sampler):
    picture = merlkit.render([nickel], spp=2, width=16, height=16)
    interrupted(lambda: merlkit.render([nickel], spp=1_000_000, width=64, height=64))
    assert np.array_equal(merlkit.render([nickel], spp=2, width=16, height=16), picture)


def test_a_function_is_called_no_more_after_ctrl_c():
    count = [0]

    def grey(wo, wi):
        count[0] += 1
        return np.full(wi.shape, 0.1)

    material = merlkit.from_function(grey, isotropic=True)
    assert interrupted(lambda: merlkit.render([material], spp=1_000_000, width=64, height=64)) < 60
    before = count[0]
    time.sleep(0.2)
    assert count[0] == before
    wo = merlkit.spherical(0.3)
    assert np.allclose(material.eval(wo, wo), 0.1)
