"""Functions in Python as materials."""

import numpy as np
import pytest

import merlkit
from conftest import directions


def grey(wo, wi):
    assert wo.shape == wi.shape and wo.dtype == np.float32
    assert (wo[:, 2] > 0).all() and (wi[:, 2] > 0).all()
    return np.full(wi.shape, 0.5 / np.pi)


def streaks(wo, wi):
    half = wo + wi
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return np.exp(-20 * half[:, :1] ** 2 - 200 * half[:, 1:2] ** 2) * [0.3, 0.2, 0.1]


def test_values_are_the_functions():
    material = merlkit.from_function(grey, isotropic=True, name="grey")
    wi = directions(100)
    expected = merlkit.load("lambert:reflectance=0.5").eval([0, 0, 1], wi)
    assert np.allclose(material.eval([0, 0, 1], wi), expected, rtol=1e-6)
    assert np.allclose(material.albedo([0.6, 0, 0.8]), 0.5, rtol=1e-4)
    assert material.name == "grey" and material.is_isotropic and material.origin is None


@pytest.mark.parametrize(
    ("function", "isotropic", "method"),
    [(grey, True, "half-vector:2KB"), (streaks, False, "half-vector:2KB")],
)
def test_samplers_of_functions_pass_the_checks(function, isotropic, method):
    material = merlkit.from_function(function, isotropic=isotropic)
    sampler = merlkit.Sampler.build(material, method)
    report = merlkit.check(sampler, draws=2000, wo=merlkit.spherical([0.6], [0.4]))
    assert report.passed, report.failures


def test_a_disc_of_a_function_is_that_of_the_formula():
    material = merlkit.from_function(grey, isotropic=True)
    same = merlkit.load("lambert:reflectance=0.5")
    disc, expected = (merlkit.Sampler.build(m, "adaptive-disc:tables=4") for m in (material, same))
    wo, wi = merlkit.spherical(0.6), directions(200)
    assert np.allclose(disc.pdf(wo, wi), expected.pdf(wo, wi), rtol=1e-4, atol=1e-6)


def test_exceptions_of_a_function_come_through():
    calls = []

    def fails(wo, wi):
        calls.append(len(wi))
        if len(calls) > 5:
            raise RuntimeError("enough")
        return np.full(wi.shape, 0.1)

    material = merlkit.from_function(fails, isotropic=True)
    with pytest.raises(RuntimeError, match="enough"):
        merlkit.Sampler.build(material, "half-vector:2KB")
    assert len(calls) < 20
    with pytest.raises(RuntimeError, match="enough"):
        material.eval([0, 0, 1], directions(3))


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda wo, wi: wi[:1], r"shape \(1, 3\)"),
        (lambda wo, wi: wi[:, 0], "shape"),
        (lambda wo, wi: np.full(wi.shape, np.nan), "finite"),
        (lambda wo, wi: -np.abs(wi), "finite and not negative"),
        (lambda wo, wi: None, "dtype object"),
    ],
)
def test_results_that_are_no_values_are_refused(function, words):
    with pytest.raises((ValueError, TypeError), match=words):
        merlkit.from_function(function)


def test_a_function_is_not_taken_for_isotropic_that_is_not():
    with pytest.raises(ValueError, match="isotropic=False"):
        merlkit.from_function(streaks, isotropic=True)
    with pytest.raises(TypeError, match="f\\(wo, wi\\)"):
        merlkit.from_function(3)


def test_what_needs_a_file_refuses_functions(tmp_path):
    material = merlkit.from_function(grey, isotropic=True)
    sampler = merlkit.Sampler.build(material, "cosine")
    with pytest.raises(ValueError, match="is a function"):
        sampler.save(tmp_path / "x")
    with pytest.raises(ValueError, match="is a function"):
        merlkit.report(material, ["cosine"])


def test_a_picture_of_a_function():
    material = merlkit.from_function(grey, isotropic=True)
    expected = merlkit.render(merlkit.load("lambert:reflectance=0.5"), width=16, height=12, spp=2, sampler="cosine")
    assert np.allclose(merlkit.render([material], width=16, height=12, spp=2, sampler="cosine"), expected, rtol=1e-4)
