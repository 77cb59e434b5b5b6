"""Times of calls from Python beside the library's own, a reader in numpy, and Mitsuba 3, in one run.

    python3 bench.py [ROWS]

Mitsuba is measured where it is installed. The least of several calls counts, and the candidates take turns.
"""

import sys
import tempfile
import time

import numpy as np

import merlkit
from merlkit import _native

ROWS = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
REPEATS = 15


def directions(seed):
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(ROWS, 3))
    vectors[:, 2] = np.abs(vectors[:, 2])
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)


def numpy_lookup(table, wo, wi):
    """What people write: the half vector, the difference vector by two rotations, and three indices."""
    half = wi + wo
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    theta_h = np.arccos(np.clip(half[..., 2], -1, 1))
    phi_h = np.arctan2(half[..., 1], half[..., 0])
    cos, sin = np.cos(-phi_h), np.sin(-phi_h)
    x, y, z = wi[..., 0] * cos - wi[..., 1] * sin, wi[..., 0] * sin + wi[..., 1] * cos, wi[..., 2]
    cos, sin = np.cos(-theta_h), np.sin(-theta_h)
    x, z = x * cos + z * sin, -x * sin + z * cos
    theta_d = np.arccos(np.clip(z, -1, 1))
    phi_d = np.mod(np.arctan2(y, x), np.pi)
    h = np.clip((np.sqrt(theta_h / (np.pi / 2)) * 90).astype(int), 0, 89)
    d = np.clip((theta_d / (np.pi / 2) * 90).astype(int), 0, 89)
    p = np.clip((phi_d / np.pi * 180).astype(int), 0, 179)
    return table[h, d, p]


def mitsuba_tasks(material, wo, wi, u):
    """Evaluation and sampling of the exported .bsdf file by Mitsuba's `measured` material, called from Python."""
    try:
        import drjit as dr
        import mitsuba as mi

        mi.set_variant("llvm_ad_rgb")
        if not dr.has_backend(dr.JitBackend.LLVM):
            raise ImportError("no LLVM")
    except ImportError as error:
        print(f"no Mitsuba: {error}")
        return {}
    folder = tempfile.mkdtemp()
    path = merlkit.export(material, folder, "bsdf")[0]
    bsdf = mi.load_dict({"type": "measured", "filename": str(path)})
    si = dr.zeros(mi.SurfaceInteraction3f, ROWS)
    si.wi = mi.Vector3f(*np.broadcast_to(wo, wi.shape).T.copy())
    other, points = mi.Vector3f(*wi.T.copy()), mi.Point2f(*u.T.copy())
    context = mi.BSDFContext()
    dr.eval(si, other, points)

    def run(result):
        dr.eval(result)
        dr.sync_thread()

    return {
        "eval": lambda: run(bsdf.eval(context, si, other)),
        "sample": lambda: run(bsdf.sample(context, si, mi.Float(0.5), points)),
        "pdf": lambda: run(bsdf.pdf(context, si, other)),
    }


def timed(call):
    def task():
        start = time.perf_counter()
        call()
        return time.perf_counter() - start

    return task


def least(tasks):
    """The least seconds of each task; they take turns."""
    best = dict.fromkeys(tasks, float("inf"))
    for _ in range(REPEATS):
        for name, task in tasks.items():
            best[name] = min(best[name], task())
    return best


def main():
    material = merlkit.load("nickel")
    sampler = merlkit.Sampler.build(material)
    wo, wi = merlkit.spherical(0.5), directions(1)
    u = np.random.default_rng(2).random((ROWS, 2)).astype(np.float32)
    table = np.ascontiguousarray(material.table)
    given = np.broadcast_to(wo, wi.shape)
    beside = mitsuba_tasks(merlkit.load("nickel", "linear"), wo, wi, u)
    subjects = {"eval": (material, wi), "sample": (sampler, u), "pdf": (sampler, wi)}
    print(f"{ROWS} rows, ns a row\n\n| call | library | Python | ratio | numpy | Mitsuba |\n|---|---|---|---|---|---|")
    for name, (subject, other) in subjects.items():
        times = {
            "library": lambda: _native._time_library(subject, name, wo, other, 1),
            "python": timed(lambda: getattr(subject, name)(wo, other)),
        }
        if name == "eval":
            times["numpy"] = timed(lambda: numpy_lookup(table, given, wi))
        if name in beside:
            times["mitsuba"] = timed(beside[name])
        best = least(times)
        ns = {key: f"{value / ROWS * 1e9:.1f}" for key, value in best.items()}
        ratio = best["python"] / best["library"]
        print(f"| {name} | {ns['library']} | {ns['python']} | {ratio:.2f} | {ns.get('numpy', '–')} | {ns.get('mitsuba', '–')} |")


main()
