"""Renders a scene with Mitsuba 3 as often as asked. render.py SCENE.json; then one request a line on standard input:
{"variant", "material", "samples", "seed", "out"}, and one reply a line on standard output: {"load", "render"}, seconds.

material is "measured", the .bsdf file, or "plugin": a BSDF in Python as people write it, which looks a table of MERL's up and
draws by the cosine. Pictures are little-endian f32, rows from the top.
"""
import json
import sys
import time

import mitsuba as mi
import numpy as np

given = json.load(open(sys.argv[1]))
scenes = {}


def merl_plugin(ball):
    """Registered for the current variant, whose types it uses, under a name of its own for each table."""
    import drjit as dr

    table = np.fromfile(ball["table"], "<f4")
    name = "merl_plugin_" + str(given["balls"].index(ball))

    class Merl(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.table = mi.Float(table)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components, self.m_flags = [flags], flags

        def value(self, wi, wo):
            h = dr.normalize(wi + wo)
            theta_h = dr.safe_acos(h.z)
            sin_h = dr.maximum(dr.sqrt(h.x * h.x + h.y * h.y), 1e-8)
            c, s = h.x / sin_h, h.y / sin_h
            x, y = c * wo.x + s * wo.y, c * wo.y - s * wo.x
            x, z = h.z * x - sin_h * wo.z, sin_h * x + h.z * wo.z
            phi_d = dr.atan2(y, x)
            phi_d = dr.select(phi_d < 0, phi_d + dr.pi, phi_d)
            row = dr.clip(mi.UInt32(dr.sqrt(theta_h / (dr.pi / 2)) * 90), 0, 89)
            column = dr.clip(mi.UInt32(dr.safe_acos(z) / (dr.pi / 2) * 90), 0, 89)
            depth = dr.clip(mi.UInt32(phi_d / dr.pi * 180), 0, 179)
            at = 3 * (depth + 180 * (column + 90 * row))
            return mi.Color3f(*(dr.gather(mi.Float, self.table, at + k) for k in range(3)))

        def eval(self, ctx, si, wo, active=True):
            active &= (si.wi.z > 0) & (wo.z > 0)
            return dr.select(active, dr.maximum(self.value(si.wi, wo), 0) * wo.z, 0)

        def pdf(self, ctx, si, wo, active=True):
            return dr.select((si.wi.z > 0) & (wo.z > 0), mi.warp.square_to_cosine_hemisphere_pdf(wo), 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs = mi.BSDFSample3f()
            bs.wo, bs.eta = mi.warp.square_to_cosine_hemisphere(sample2), 1.0
            bs.pdf = mi.warp.square_to_cosine_hemisphere_pdf(bs.wo)
            bs.sampled_type, bs.sampled_component = mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(0)
            weight = self.eval(ctx, si, bs.wo, active) / bs.pdf
            return bs, dr.select(active & (bs.pdf > 0), weight, 0)

        def to_string(self):
            return "Merl[]"

    mi.register_bsdf(name, Merl)
    return {"type": name}


def sphere(ball, material):
    bsdf = {"type": "measured", "filename": ball["bsdf"]} if material == "measured" else merl_plugin(ball)
    return {"type": "sphere", "center": ball["centre"], "radius": ball["radius"], "bsdf": bsdf}


def ground():
    """A diffuse rectangle at y = 0 that ends beyond what pixels tell apart."""
    to_world = mi.ScalarTransform4f().rotate([1, 0, 0], -90).scale(10000)
    reflectance = {"type": "rgb", "value": given["ground"]}
    return {"type": "rectangle", "to_world": to_world, "bsdf": {"type": "diffuse", "reflectance": reflectance}}


def scene(material):
    camera = given["camera"]
    film = {"type": "hdrfilm", "width": given["side"], "height": given["side"], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    described = {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 1},
        "sensor": {
            "type": "perspective",
            "fov": camera["degrees"],
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(camera["eye"], camera["target"], [0, 1, 0]),
            "film": film,
            "sampler": {"type": "multijitter"},
        },
        "sky": {
            "type": "envmap",
            "filename": given["sky"],
            # The middle of the map is -z here and the edge there.
            "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 180),
        },
    }
    for i, ball in enumerate(given["balls"]):
        described["ball" + str(i)] = sphere(ball, material)
    if given["ground"] is not None:
        described["ground"] = ground()
    return described


def answer(request):
    variant, material = request["variant"], request["material"]
    mi.set_variant(variant)
    start, load = time.perf_counter(), 0.0
    if (variant, material) not in scenes:
        scenes[variant, material] = mi.load_dict(scene(material))
        load = time.perf_counter() - start
    start = time.perf_counter()
    picture = np.array(mi.render(scenes[variant, material], spp=request["samples"], seed=request["seed"]))
    seconds = time.perf_counter() - start
    picture.astype("<f4").tofile(request["out"])
    return {"load": load, "render": seconds}


mi.set_log_level(mi.LogLevel.Error)
for line in sys.stdin:
    print(json.dumps(answer(json.loads(line))), flush=True)
