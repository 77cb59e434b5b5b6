"""Arrays of every kind give the right values or an exception that says what is wrong."""

import numpy as np
import pytest

import merlkit
from conftest import directions

WO = np.array([0.6, 0.0, 0.8], dtype=np.float32)


@pytest.fixture(scope="module")
def pairs(nickel):
    wi = directions(400)
    return wi, nickel.eval(WO, wi)


def layouts(wi):
    wide = np.zeros((len(wi), 6), dtype=np.float32)
    wide[:, ::2] = wi
    readonly = wi.copy()
    readonly.setflags(write=False)
    unaligned = np.frombuffer(b"x" + wi.tobytes(), dtype=np.uint8)[1:].view(np.float32).reshape(-1, 3)
    return {
        "float64": wi.astype(np.float64),
        "list": wi.tolist(),
        "strided": wide[:, ::2],
        "Fortran": np.asfortranarray(wi),
        "read-only": readonly,
        "big-endian": wi.astype(">f4"),
        "unaligned": unaligned,
        "reversed twice": np.ascontiguousarray(wi[::-1])[::-1],
        "matrix": np.asmatrix(wi),
    }


@pytest.mark.parametrize("name", layouts(directions(4)))
def test_the_layout_does_not_matter(nickel, sampler, pairs, name):
    wi, values = pairs
    given = layouts(wi)[name]
    assert np.array_equal(nickel.eval(WO, given), values)
    assert np.array_equal(nickel.eval(given, WO), nickel.eval(wi, WO))
    assert np.array_equal(sampler.pdf(WO, given), sampler.pdf(WO, wi))


def test_integers_are_numbers(nickel):
    assert np.array_equal(nickel.eval([0, 0, 1], [[0, 0, 1]]), nickel.eval([0.0, 0, 1], [[0.0, 0, 1]]))
    assert np.array_equal(nickel.eval([0, 0, 2], [0, 0, 5]), nickel.eval([0, 0, 1], [0, 0, 1]))


def test_leading_axes_are_broadcast(nickel, sampler, pairs):
    wi, values = pairs
    assert nickel.eval(WO, wi[0]).shape == (3,)
    assert np.isscalar(sampler.pdf(WO, wi[0]))
    assert np.array_equal(nickel.eval(WO[None], wi), values)
    assert np.array_equal(nickel.eval(np.tile(WO, (400, 1)), wi), values)
    assert np.array_equal(nickel.eval(WO, wi.reshape(20, 20, 3)), values.reshape(20, 20, 3))
    outer = nickel.eval(wi[:7, None], wi[None, :5])
    assert outer.shape == (7, 5, 3)
    assert np.array_equal(outer[3, 2], nickel.eval(wi[3], wi[2]))
    drawn, pdf = sampler.sample(wi[:7, None], np.full((5, 2), 0.25))
    assert drawn.shape == (7, 5, 3) and pdf.shape == (7, 5)


def test_no_rows_give_no_rows(nickel, sampler):
    none = np.zeros((0, 3), dtype=np.float32)
    assert nickel.eval(WO, none).shape == (0, 3)
    assert nickel.eval(none, WO).shape == (0, 3)
    assert nickel.eval(none, none).shape == (0, 3)
    assert nickel.albedo(none).shape == (0, 3)
    assert sampler.pdf(WO, none).shape == (0,)
    wi, pdf = sampler.sample(WO, np.zeros((0, 2)))
    assert wi.shape == (0, 3) and pdf.shape == (0,)
    assert nickel.eval(WO, np.zeros((4, 0, 3))).shape == (4, 0, 3)


def test_what_is_no_direction_has_the_value_0(nickel, sampler):
    bad = np.array([[np.nan, 0, 1], [np.inf, 0, 1], [0, 0, 0], [0, 0, -1], [1, 0, 0]])
    assert not nickel.eval(WO, bad).any()
    assert not nickel.eval(bad, WO).any()
    assert not sampler.pdf(WO, bad).any()
    wi, pdf = sampler.sample(bad, [0.5, 0.5])
    assert not wi.any() and not pdf.any()
    wi, pdf = sampler.sample(WO, [[np.nan, 0.5], [-1, 2], [np.inf, -np.inf]])
    assert np.isfinite(wi).all() and np.isfinite(pdf).all()


@pytest.mark.parametrize(
    ("wi", "exception", "words"),
    [
        (np.zeros((4, 2)), ValueError, r"wi has the shape \(4, 2\)"),
        (np.zeros(()), ValueError, "wi has the shape"),
        (1.0, ValueError, "wi has the shape"),
        (np.zeros((3, 3), dtype=object), TypeError, "dtype object"),
        (np.zeros((3, 3), dtype=complex), TypeError, "complex"),
        (np.zeros((3, 3), dtype=bool), TypeError, "bool"),
        (np.zeros(3, dtype="datetime64[s]"), TypeError, "datetime"),
        (np.ma.masked_array(np.zeros((2, 3)), mask=True), TypeError, "masked"),
        ([[1, 2, 3], [1, 2]], ValueError, None),
        (None, TypeError, "object"),
        ("x", TypeError, "dtype"),
        ({"wi": 1}, TypeError, "object"),
    ],
)
def test_what_is_no_array_of_directions_is_refused(nickel, sampler, wi, exception, words):
    for call in (nickel.eval, nickel.eval_cos, sampler.pdf):
        with pytest.raises(exception, match=words):
            call(WO, wi)


def test_shapes_that_do_not_correspond_are_refused(nickel, sampler):
    with pytest.raises(ValueError, match=r"\(4, 3\) and wi of shape \(5, 3\)"):
        nickel.eval(np.zeros((4, 3)), np.zeros((5, 3)))
    with pytest.raises(ValueError, match="u has the shape"):
        sampler.sample(WO, np.zeros((5, 3)))
    with pytest.raises(ValueError, match="one direction"):
        sampler.draw_stratified(np.zeros((2, 3)), 4)


@pytest.mark.parametrize("rows", [1 << 31, 1 << 40, 1 << 58])
def test_what_memory_cannot_hold_is_refused(nickel, sampler, rows):
    # An array of one row in memory that claims to have many.
    many = np.broadcast_to(WO, (rows, 3))
    for call in (lambda: nickel.eval(many, many), lambda: nickel.eval(WO, many), lambda: sampler.pdf(WO, many)):
        with pytest.raises((MemoryError, ValueError)):
            call()
    with pytest.raises((MemoryError, ValueError)):
        sampler.draw_stratified(WO, rows)


def test_errors_have_the_librarys_texts(tmp_path):
    with pytest.raises(ValueError, match="did you mean nickel"):
        merlkit.load("nikel")
    with pytest.raises(FileNotFoundError, match="cannot open"):
        merlkit.load(tmp_path / "none.binary")
    broken = tmp_path / "broken.binary"
    broken.write_bytes(b"\0" * 100)
    with pytest.raises(merlkit.FormatError, match="at byte"):
        merlkit.load(broken)
    with pytest.raises(ValueError, match="choose one of \"floor\""):
        merlkit.load("nickel", "nearest")
    with pytest.raises(TypeError, match="os.PathLike"):
        merlkit.load(3)
    with pytest.raises(ValueError, match="no sampler is called"):
        merlkit.Sampler.build(merlkit.load("lambert"), "halfvector")
    with pytest.raises(ValueError, match="needs a MERL table"):
        merlkit.load("lambert").table
    with pytest.raises(ValueError, match="0 × 8 pixels"):
        merlkit.render(merlkit.load("lambert"), width=0, height=8)


def test_a_subclass_does_not_leak_into_results(nickel):
    assert type(nickel.eval(np.asmatrix(WO), WO)) is np.ndarray
