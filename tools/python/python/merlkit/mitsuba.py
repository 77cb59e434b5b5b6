"""Materials and samplers of merlkit as a BSDF of Mitsuba 3.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import merlkit.mitsuba
    merlkit.mitsuba.register()
    bsdf = mi.load_dict({"type": "merlkit", "material": "nickel", "lookup": "linear"})

Values, draws and densities are computed by merlkit, not in Mitsuba's kernels, so they are those of the library and have no
gradients. `register` makes Dr.Jit evaluate loops and calls instead of recording them, which the plugin needs. Mitsuba's `wi` is
merlkit's `wo`, and the other way round.
"""

from __future__ import annotations

from typing import Any, Tuple

import numpy as np

import merlkit

NAME = "merlkit"
"""The plugin's `type`."""


def register() -> None:
    """Registers the BSDF `merlkit` for the variant that is set: scalar_rgb, llvm_ad_rgb or another that is RGB.

    Its parameters are `material` and `lookup` as `merlkit.load` takes them, and `sampler` as `merlkit.Sampler.build` does.
    """
    import drjit as dr
    import mitsuba as mi

    variant = mi.variant()
    if variant is None or not variant.endswith("_rgb"):
        raise ValueError(
            f"the variant is {variant}; set one that is RGB first, by mitsuba.set_variant, or export a .bsdf file for a spectral one"
        )
    scalar = variant.startswith("scalar")
    if not scalar:
        dr.set_flag(dr.JitFlag.SymbolicLoops, False)
        dr.set_flag(dr.JitFlag.SymbolicCalls, False)

    class MerlkitBSDF(mi.BSDF):  # type: ignore[misc]
        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.material = merlkit.load(
                props.get("material", "nickel"), props.get("lookup", "floor")
            )
            self.sampler = merlkit.Sampler.build(
                self.material, props.get("sampler", "half-vector:64KB")
            )
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not self.material.is_isotropic:
                flags = flags | mi.BSDFFlags.Anisotropic
            self.m_flags = flags
            self.m_components = [flags]

        def sample(
            self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> Tuple[Any, Any]:
            bs = dr.zeros(mi.BSDFSample3f)
            if not ctx.is_enabled(mi.BSDFFlags.GlossyReflection):
                return bs, mi.Spectrum(0)
            given = _rows(si.wi)
            drawn, pdf = self.sampler.sample(given, _rows(sample2))
            value = self.material.eval_cos(given, drawn)
            valid = active & (_number(mi.Float, pdf, scalar) > 0)
            weight = value / np.where(pdf > 0, pdf, 1)[..., None]
            bs.wo = _vector(mi.Vector3f, drawn, scalar)
            bs.pdf = dr.select(valid, _number(mi.Float, pdf, scalar), 0)
            bs.eta = 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            bs.sampled_component = mi.UInt32(0)
            return bs, dr.select(valid, _vector(mi.Color3f, weight, scalar), 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not ctx.is_enabled(mi.BSDFFlags.GlossyReflection):
                return mi.Spectrum(0)
            value = self.material.eval_cos(_rows(si.wi), _rows(wo))
            return dr.select(active, _vector(mi.Color3f, value, scalar), 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not ctx.is_enabled(mi.BSDFFlags.GlossyReflection):
                return mi.Float(0)
            density = self.sampler.pdf(_rows(si.wi), _rows(wo))
            return dr.select(active, _number(mi.Float, density, scalar), 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Tuple[Any, Any]:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self) -> str:
            return f"MerlkitBSDF[{self.material!r}, {self.sampler!r}]"

    mi.register_bsdf(NAME, lambda props: MerlkitBSDF(props))


def _rows(vector: Any) -> Any:
    """A vector of Dr.Jit, (3,) or (3, N), as rows."""
    return np.ascontiguousarray(np.array(vector, dtype=np.float32).T)


def _vector(kind: Any, rows: Any, scalar: bool) -> Any:
    if scalar:
        return kind(*(float(x) for x in rows))
    return kind(*(np.ascontiguousarray(column) for column in np.atleast_2d(rows).T))


def _number(kind: Any, values: Any, scalar: bool) -> Any:
    return kind(float(values)) if scalar else kind(np.atleast_1d(values))
