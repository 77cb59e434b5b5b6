"""Values, draws and densities are those of the library, to the bit."""

import io
import json
import pickle

import numpy as np
import pytest

import merlkit
from conftest import directions

MATERIALS = ["nickel", "lambert:reflectance=0.8/0.5/0.25", "ggx:ax=0.1,ay=0.4"]


def table_of(text):
    return np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1, dtype=np.float32)


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("method", ["half-vector:2KB", "cosine", "lobe:ggx"])
def test_draws_densities_and_values_have_the_bits_of_the_command(command, material, method):
    text = command("sample", material, "--sampler", method, "--theta", "40", "--phi", "20", "--count", "500", "--with-points")
    wo, u, wi, pdf, value = np.split(table_of(text), [3, 5, 8, 9], axis=1)
    loaded = merlkit.load(material)
    sampler = merlkit.Sampler.build(loaded, method)
    drawn, density = sampler.sample(wo, u)
    assert np.array_equal(drawn, wi)
    assert np.array_equal(density, pdf[:, 0])
    assert np.array_equal(sampler.pdf(wo[0], wi), pdf[:, 0])
    assert np.array_equal(loaded.eval(wo[0], wi), value)


@pytest.mark.parametrize("lookup", ["floor", "linear", "centred"])
def test_lookup_rules_have_the_bits_of_the_command(command, lookup):
    text = command("sample", "nickel", "--lookup", lookup, "--theta", "70", "--count", "200", "--with-points")
    wo, _, wi, _, value = np.split(table_of(text), [3, 5, 8, 9], axis=1)
    assert np.array_equal(merlkit.load("nickel", lookup).eval(wo, wi), value)


def test_a_picture_has_the_pixels_of_the_command(command, tmp_path, nickel):
    name = tmp_path / "picture"
    command("render", "nickel", "--size", "24x16", "--spp", "4", "-o", str(name))
    picture = write_pfm(tmp_path / "python.pfm", merlkit.render(nickel, width=24, height=16, spp=4))
    text = command("diff", str(picture), f"{name}.exr", "--json", "-")
    difference = json.loads(text)["results"]
    assert difference["rel_mse"] == difference["mean_relative"] == difference["flip"] == 0


def write_pfm(path, picture):
    height, width, _ = picture.shape
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(picture[::-1].astype("<f4").tobytes())
    return path


def test_files_are_those_of_the_command(command, tmp_path, nickel, sampler):
    ours, theirs = tmp_path / "ours.safetensors", tmp_path / "theirs.safetensors"
    assert sampler.save(ours) == ours.stat().st_size
    command("build", "nickel", "--sampler", "half-vector:2KB", "-o", str(theirs))
    assert ours.read_bytes() == theirs.read_bytes() == sampler.to_bytes()
    for format, end in [("npz", "npz"), ("header", "h"), ("runtime", "merlkit")]:
        merlkit.export(nickel, tmp_path / "ours", format, sampler="half-vector:2KB")
        command("export", "nickel", "--format", format, "--sampler", "half-vector:2KB", "-o", str(tmp_path / "theirs"))
        file = f"nickel.{end}"
        assert (tmp_path / "ours" / file).read_bytes() == (tmp_path / "theirs" / file).read_bytes()
    for code in ["merlkit.h", "merlkit.glsl", "merlkit.hlsl", "merlkit.wgsl"]:
        assert (tmp_path / "ours" / code).read_bytes() == (tmp_path / "theirs" / code).read_bytes()


def test_a_fit_is_that_of_the_command(command):
    text = command("fit", "nickel", "--model", "ggx", "--pairs", "200", "--json", "-")
    expected = json.loads(text)["results"]["materials"][0]["fits"]
    fit = merlkit.fit(merlkit.load("nickel", "linear"), ["ggx"], pairs=200)
    assert fit.fits == expected
    assert fit.best["model"] == "ggx"
    assert fit.material().origin == merlkit.load(fit.best["material"]).origin
    assert "<materialx" in fit.text("materialx")


def test_checks_are_those_of_the_command(command, sampler):
    text = command("check", "nickel", "--sampler", "half-vector:2KB", "--draws", "2000", "--json", "-")
    report = merlkit.check(sampler, draws=2000)
    assert report.passed and not report.failures
    assert report.outcomes == json.loads(text)["results"][0]["outcomes"]


def test_loading_a_sampler_gives_the_same_draws(tmp_path, nickel, sampler):
    path = tmp_path / "nickel.safetensors"
    sampler.save(path)
    wo, u = directions(300), np.random.default_rng(2).random((300, 2))
    expected = sampler.sample(wo, u)
    for again in [
        merlkit.Sampler.load(path),
        merlkit.Sampler.load(path, nickel),
        pickle.loads(pickle.dumps(sampler)),
    ]:
        assert again.spec == sampler.spec
        for a, b in zip(again.sample(wo, u), expected):
            assert np.array_equal(a, b)
    with pytest.raises(ValueError, match="SHA-256"):
        merlkit.Sampler.load(path, merlkit.load("chrome"))
    with pytest.raises(FileExistsError, match="overwrite=True"):
        sampler.save(path)
    assert sampler.save(path, overwrite=True) == path.stat().st_size


def test_the_mean_weight_is_the_albedo(nickel, sampler):
    wo = merlkit.spherical(0.7)
    wi, pdf = sampler.draw_stratified(wo, 1 << 14, seed=3)
    weight = nickel.eval_cos(wo, wi)[pdf > 0] / pdf[pdf > 0, None]
    mean = weight.sum(axis=0) / len(pdf)
    assert np.allclose(mean, nickel.albedo(wo), rtol=2e-3)


def test_albedos_of_a_lambertian_are_its_reflectance():
    grey = merlkit.load("lambert:reflectance=0.8/0.5/0.25")
    albedo = grey.albedo(merlkit.spherical(np.array([[0.0, 0.5], [1.0, 1.4]]), 0.3))
    assert albedo.shape == (2, 2, 3)
    assert np.allclose(albedo, [0.8, 0.5, 0.25], rtol=1e-4)
    assert not grey.albedo([0.0, 0.0, -1.0]).any()


def test_the_table_is_the_materials_own_memory(nickel):
    table, valid = nickel.table, nickel.valid
    assert table.shape == valid.shape == (90, 90, 180, 3)
    assert np.shares_memory(table, nickel.table)
    axes = merlkit.axes(nickel)
    assert [len(axis) for axis in axes] == [90, 90, 180]
    # At the normal both angles are 0, and a pair in a cell has that cell's value under the floor rule.
    assert np.array_equal(nickel.eval([0, 0, 1], [0, 0, 1]), table[0, 0, 0])
    assert not table[~valid].any()
    for attempt in (
        lambda: table.__setitem__((0, 0, 0, 0), 1.0),
        lambda: table.setflags(write=True),
    ):
        with pytest.raises(ValueError):
            attempt()
    compact = merlkit.load("nickel", table="f16").table
    assert compact.flags.c_contiguous and not compact.flags.writeable
    assert np.allclose(compact, table, rtol=1e-3)
    del nickel
    assert table[0, 0, 0, 0] > 0


def test_a_table_outlives_its_material():
    table = merlkit.load("chrome").table
    assert np.isfinite(table).all() and table.max() > 1


def test_names_are_those_that_load_takes():
    assert "nickel" in merlkit.material_names()
    assert "ggx" in merlkit.model_names()
    assert merlkit.sampler_names()[0] == "half-vector"
    for name in merlkit.model_names():
        assert merlkit.load(name).eval([0, 0, 1], [0, 0, 1]).shape == (3,)


def test_what_notebooks_and_help_show(nickel, sampler):
    assert nickel._repr_png_()[1:4] == b"PNG"
    assert nickel.sphere(16).shape == (16, 16, 3)
    assert repr(nickel).startswith("<merlkit.Material nickel: floor lookup, isotropic")
    assert "half-vector:2KB for nickel" in repr(sampler)
    for item in [nickel.eval, nickel.albedo, sampler.sample, sampler.pdf, merlkit.load, merlkit.render, merlkit.check]:
        assert len(item.__doc__) > 60
    assert "(..., 3)" in nickel.eval.__doc__


def test_a_report_has_figures(nickel):
    report = merlkit.report(nickel, ["cosine"], draws=1000)
    assert report["samplers"][0]["spec"] == "cosine"
