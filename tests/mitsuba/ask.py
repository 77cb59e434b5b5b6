"""Asks Mitsuba 3 about a .bsdf file. All files of numbers are little-endian f32, directions in the frame of the surface.

ask.py values VARIANT FILE PAIRS OUT    pairs wo, wi -> value of each channel or wavelength, then pdf
ask.py draws VARIANT FILE QUERIES OUT   wo, u -> wi, pdf, first channel of the weight
ask.py sphere VARIANT FILE SCENE OUT    side, samples, eye, target, degrees, centre, radius, towards light -> picture
"""
import sys

import mitsuba as mi
import numpy as np

kind, variant, path, given, out = sys.argv[1:6]
mi.set_variant(variant)
spectral = "spectral" in variant
numbers = np.fromfile(given, "<f4")
bsdf = {"type": "measured", "filename": path}
context, surface = mi.BSDFContext(), mi.SurfaceInteraction3f()


def look(wo, wavelengths=None):
    surface.wi = mi.Vector3f(*map(float, wo))
    if wavelengths:
        surface.wavelengths = wavelengths


def values(pair, material):
    wi = mi.Vector3f(*map(float, pair[3:]))
    look(pair[:3], [450, 480, 500, 550] if spectral else None)
    found = list(material.eval(context, surface, wi))
    if spectral:
        look(pair[:3], [580, 600, 620, 620])
        found += list(material.eval(context, surface, wi))[:3]
    return found + [material.pdf(context, surface, wi)]


def draw(query, material):
    look(query[:3], [450, 500, 580, 620] if spectral else None)
    sample, weight = material.sample(context, surface, 0.5, mi.Point2f(*map(float, query[3:])))
    return [*sample.wo, sample.pdf, weight[0]]


def sphere():
    side, samples = int(numbers[0]), int(numbers[1])
    eye, target, centre, towards = (list(map(float, numbers[k : k + 3])) for k in (2, 5, 9, 13))
    light = {"type": "rgb", "value": [1.0, 1.0, 1.0]}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sensor": {
            "type": "perspective",
            "fov": float(numbers[8]),
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(eye, target, [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
            "sampler": {"type": "independent", "sample_count": samples},
        },
        "sky": {"type": "constant", "radiance": light},
        "sun": {"type": "directional", "direction": [-x for x in towards], "irradiance": light},
        "ball": {"type": "sphere", "center": centre, "radius": float(numbers[12]), "bsdf": bsdf},
    }
    return np.array(mi.render(mi.load_dict(scene), seed=3))


if kind == "sphere":
    result = sphere()
else:
    material = mi.load_dict(bsdf)
    rows, ask = (numbers.reshape(-1, 6), values) if kind == "values" else (numbers.reshape(-1, 5), draw)
    result = np.array([ask(row, material) for row in rows])
result.astype("<f4").tofile(out)
