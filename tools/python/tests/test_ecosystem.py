"""Other packages: each test skips where its package is missing."""

import os
import pathlib

import numpy as np
import pytest

import merlkit
from conftest import directions


def test_an_archive_has_the_angles_of_its_axes(tmp_path, nickel):
    [path] = merlkit.export(nickel, tmp_path, "npz")
    archive = np.load(path)
    for name, angles in merlkit.axes(nickel)._asdict().items():
        assert np.array_equal(archive[name], angles)
    assert np.array_equal(archive["merl.rgb"] >= 0, nickel.valid)
    assert np.array_equal(np.maximum(archive["merl.rgb"], 0), nickel.table)


def test_a_dataset_is_the_table(nickel):
    pytest.importorskip("xarray")
    import merlkit.xarray

    dataset = merlkit.xarray.dataset(nickel)
    assert np.shares_memory(dataset.f_r.values, nickel.table)
    cell = dataset.f_r.sel(theta_h=0, theta_d=0, phi_d=0, channel="green")
    assert cell == nickel.table[0, 0, 0, 1]
    assert dataset.attrs["material"] == "nickel"


def test_plots_return_axes(nickel, sampler):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import merlkit.plot

    for axes in [
        merlkit.plot.polar(nickel, 0.7),
        merlkit.plot.table_slice(nickel),
        merlkit.plot.albedo(nickel),
        merlkit.plot.draws(sampler, 0.7, count=100),
    ]:
        axes.figure.canvas.draw()
        assert axes.get_title()
    own = plt.figure().add_subplot()
    assert merlkit.plot.albedo(nickel, axes=own) is own
    plt.close("all")


@pytest.fixture(params=["scalar_rgb", "llvm_ad_rgb"])
def mitsuba(request):
    mi = pytest.importorskip("mitsuba")
    # With an LLVM that it can't work with, Dr.Jit ends the process that it runs in, so one must be named.
    if request.param.startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in os.environ:
        pytest.skip("DRJIT_LIBLLVM_PATH names no LLVM")
    mi.set_variant(request.param)
    import merlkit.mitsuba

    merlkit.mitsuba.register()
    return mi


def bsdf_of(mi):
    return mi.load_dict({"type": "merlkit", "material": "nickel", "lookup": "linear", "sampler": "half-vector:2KB"})


def test_mitsuba_gets_the_values_and_densities(mitsuba):
    mi = mitsuba
    import drjit as dr

    bsdf, context = bsdf_of(mi), mi.BSDFContext()
    material = merlkit.load("nickel", "linear")
    sampler = merlkit.Sampler.build(material, "half-vector:2KB")
    wo, wi = directions(200, 1), directions(200, 2)
    if mi.variant().startswith("scalar"):
        values, densities = [], []
        for given, sampled in zip(wo, wi):
            si = dr.zeros(mi.SurfaceInteraction3f)
            si.wi = mi.Vector3f(*map(float, given))
            value, density = bsdf.eval_pdf(context, si, mi.Vector3f(*map(float, sampled)))
            values.append(np.array(value))
            densities.append(density)
    else:
        si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
        si.wi = mi.Vector3f(*wo.T.copy())
        value, density = bsdf.eval_pdf(context, si, mi.Vector3f(*wi.T.copy()))
        values, densities = np.array(value).T, np.array(density)
    assert np.allclose(values, material.eval_cos(wo, wi), rtol=1e-5)
    assert np.allclose(densities, sampler.pdf(wo, wi), rtol=1e-5)


@pytest.mark.parametrize("theta_o", [0.2, 1.0])
def test_mitsubas_own_chi_square_accepts_the_draws(mitsuba, theta_o):
    mi = mitsuba
    if mi.variant().startswith("scalar"):
        pytest.skip("Mitsuba's test is for arrays")
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    words = '<string name="material" value="nickel"/><string name="lookup" value="linear"/>'
    sample, pdf = BSDFAdapter("merlkit", words, wi=mi.ScalarVector3f(*map(float, merlkit.spherical(theta_o))))
    test = ChiSquareTest(
        domain=SphericalDomain(),
        sample_func=sample,
        pdf_func=pdf,
        sample_dim=3,
        sample_count=100_000,
        res=101,
        ires=16,
    )
    assert test.run(), test.messages


def test_mitsuba_renders_a_furnace(mitsuba):
    mi = mitsuba
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 3},
            "sphere": {"type": "sphere", "bsdf": {"type": "merlkit", "material": "lambert:reflectance=0.5", "sampler": "cosine"}},
            "sky": {"type": "constant"},
            "sensor": {
                "type": "perspective",
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
                "film": {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}},
                "sampler": {"type": "independent", "sample_count": 64},
            },
        }
    )
    picture = np.array(mi.render(scene))
    assert np.allclose(picture[3:5, 3:5, :3].mean(), 0.5, atol=0.04)


def test_the_notebook_runs_from_top_to_bottom():
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    nbformat = pytest.importorskip("nbformat")
    path = pathlib.Path(__file__).parents[3] / "docs" / "python.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120).execute()


def test_mitsuba_must_have_a_variant_that_the_plugin_knows():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_spectral_polarized")
    import merlkit.mitsuba

    with pytest.raises(ValueError, match="_spectral"):
        merlkit.mitsuba.register()


def sphere_scene(mi, integrator, reflectance):
    """A sphere that fills the middle of a picture of 16 x 16 pixels, under a sky of radiance 1."""
    material = f"lambert:reflectance={reflectance}"
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": integrator},
            "sphere": {"type": "sphere", "bsdf": {"type": "merlkit", "material": material, "sampler": "cosine"}},
            "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [1, 1, 1]}},
            "sensor": {
                "type": "perspective",
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
                "film": {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}},
                "sampler": {"type": "independent", "sample_count": 128},
            },
        }
    )


@pytest.mark.parametrize("variant", ["scalar_spectral", "llvm_ad_spectral"])
def test_mitsuba_renders_spectra_whose_colours_are_the_materials(variant):
    mi = pytest.importorskip("mitsuba")
    if variant.startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in os.environ:
        pytest.skip("DRJIT_LIBLLVM_PATH names no LLVM")
    mi.set_variant(variant)
    import merlkit.mitsuba

    merlkit.mitsuba.register()
    picture = np.array(mi.render(sphere_scene(mi, "direct", "0.8/0.4/0.1")))
    assert np.allclose(picture[6:10, 6:10, :3].mean(axis=(0, 1)), [0.8, 0.4, 0.1], atol=0.02)


@pytest.fixture
def differentiable():
    mi = pytest.importorskip("mitsuba")
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        pytest.skip("DRJIT_LIBLLVM_PATH names no LLVM")
    mi.set_variant("llvm_ad_rgb")
    import merlkit.mitsuba

    merlkit.mitsuba.register()
    return mi


def gradient(mi, integrator, name):
    """The derivative of the mean of the middle of the picture, which is reflectance x scale x radiance, 0.5."""
    import drjit as dr

    scene = sphere_scene(mi, integrator, 0.5)
    parameters = mi.traverse(scene)
    dr.enable_grad(parameters[name])
    parameters.update()
    picture = mi.render(scene, parameters, spp=128)
    dr.backward(dr.mean(picture[6:10, 6:10, :], axis=None))
    return np.array(dr.grad(parameters[name])).ravel()


@pytest.mark.parametrize("integrator", ["direct", "path"])
def test_mitsuba_has_gradients_of_the_scale_and_of_lights(differentiable, integrator):
    found = gradient(differentiable, integrator, "sphere.bsdf.scale")
    assert np.allclose(found, 0.5, atol=0.02), found
    # Each channel of the light is a third of the mean.
    found = gradient(differentiable, integrator, "sky.radiance.value")
    assert np.allclose(found, 0.5 / 3, atol=0.01), found


def causes(error):
    while error is not None:
        yield f"{type(error).__name__}: {error}"
        error = error.__cause__ or error.__context__


def test_mitsuba_gradients_that_are_missing_are_errors(differentiable):
    mi = differentiable
    import drjit as dr

    angle = mi.Float(0.4)
    dr.enable_grad(angle)
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(0, 0, 1)
    with pytest.raises(NotImplementedError, match="directions"):
        bsdf_of(mi).eval(mi.BSDFContext(), si, mi.Vector3f(dr.sin(angle), 0, dr.cos(angle)))
    # Without the refusal, Dr.Jit ends the process.
    with pytest.raises(Exception) as raised:
        gradient(mi, "prb", "sphere.bsdf.scale")
    assert any("NotImplementedError" in cause and "path" in cause for cause in causes(raised.value))
