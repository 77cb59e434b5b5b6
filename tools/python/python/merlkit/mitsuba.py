"""Materials and samplers of merlkit as a BSDF of Mitsuba 3.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import merlkit.mitsuba
    merlkit.mitsuba.register()
    bsdf = mi.load_dict({"type": "merlkit", "material": "nickel", "lookup": "linear"})

Values, draws and densities are computed by merlkit, not in Mitsuba's kernels, so they are those of the library. They have gradients with
respect to `scale`, and let those of lights pass; what asks for others gets a `NotImplementedError`. `register` makes Dr.Jit evaluate
loops and calls instead of recording them, which the plugin needs. Mitsuba's `wi` is merlkit's `wo`, and the other way round.
"""

from __future__ import annotations

import sys
from typing import Any, Tuple

import numpy as np

import merlkit

from . import _native

NAME = "merlkit"
"""The plugin's `type`."""


def register() -> None:
    """Registers the BSDF `merlkit` for the variant that is set: scalar_rgb, llvm_ad_rgb or another that is RGB, or spectral without
    polarisation.

    Its parameters are `material` and `lookup` as `merlkit.load` takes them, `sampler` as `merlkit.Sampler.build` does, and `scale`, a
    number that values are multiplied by and that can have a gradient.
    """
    import drjit as dr
    import mitsuba as mi

    variant = mi.variant()
    if variant is None or not variant.endswith(("_rgb", "_spectral")):
        raise ValueError(
            f"the variant is {variant}; set one that ends in _rgb or _spectral first, by mitsuba.set_variant"
        )
    scalar = variant.startswith("scalar")
    spectral = variant.endswith("_spectral")
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
            self.scale = mi.Float(props.get("scale", 1.0))
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not self.material.is_isotropic:
                flags = flags | mi.BSDFFlags.Anisotropic
            self.m_flags = flags
            self.m_components = [flags]

        def traverse(self, callback: Any) -> None:
            callback.put("scale", self.scale, mi.ParamFlags.Differentiable)

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
            return bs, dr.select(valid, self._spectrum(weight, si), 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not ctx.is_enabled(mi.BSDFFlags.GlossyReflection):
                return mi.Spectrum(0)
            value = self.material.eval_cos(_rows(si.wi), _rows(wo))
            return dr.select(active, self._spectrum(value, si), 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not ctx.is_enabled(mi.BSDFFlags.GlossyReflection):
                return mi.Float(0)
            density = self.sampler.pdf(_rows(si.wi), _rows(wo))
            return dr.select(active, _number(mi.Float, density, scalar), 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Tuple[Any, Any]:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def _spectrum(self, colours: Any, si: Any) -> Any:
            """Scaled colours: RGB, or at the wavelengths of the rays."""
            if spectral:
                colours = _at_wavelengths(colours, np.array(si.wavelengths))
            return _vector(mi.Spectrum, colours, scalar) * self.scale

        def to_string(self) -> str:
            return f"MerlkitBSDF[{self.material!r}, {self.sampler!r}]"

    mi.register_bsdf(NAME, lambda props: MerlkitBSDF(props))


def _at_wavelengths(colours: Any, wavelengths: Any) -> Any:
    """The spectra of exported `.bsdf` files: Σ over channels of colour · primary(λ). (N, 3) and (4, N) become (N, 4)."""
    nodes, primaries = _native._primary_spectra()
    weights = np.stack([np.interp(wavelengths, nodes, primary) for primary in primaries])
    return (np.moveaxis(colours, -1, 0)[:, None] * weights).sum(axis=0).astype(np.float32).T


def _rows(vector: Any) -> Any:
    """A vector of Dr.Jit, (3,) or (3, N), as rows."""
    import drjit as dr

    _refuse_replay()
    if dr.grad_enabled(vector):
        raise NotImplementedError(
            "merlkit has no gradients with respect to directions, and so none for shapes, cameras and transformations; "
            "lights and the parameter `scale` have them"
        )
    if dr.is_jit_v(vector) and dr.flag(dr.JitFlag.SymbolicScope):
        raise NotImplementedError(
            "merlkit can't be recorded in a symbolic loop or call; call merlkit.mitsuba.register() after anything that sets Dr.Jit's flags"
        )
    return np.ascontiguousarray(np.array(vector, dtype=np.float32).T)


def _refuse_replay() -> None:
    """Refuses integrators that replay paths for their gradients: they would end the process where loops are not recorded."""
    frame: Any = sys._getframe()
    while frame is not None:
        if frame.f_code.co_name in ("render_backward", "render_forward"):
            kinds = type(frame.f_locals.get("self")).__mro__
            if any(kind.__name__ == "RBIntegrator" for kind in kinds):
                raise NotImplementedError(
                    f"the integrator {kinds[0].__name__} replays paths for gradients, which needs recorded loops, and merlkit has none; "
                    "use `path` or `direct`"
                )
        frame = frame.f_back


def _vector(kind: Any, rows: Any, scalar: bool) -> Any:
    if scalar:
        return kind(*(float(x) for x in rows))
    return kind(*(np.ascontiguousarray(column) for column in np.atleast_2d(rows).T))


def _number(kind: Any, values: Any, scalar: bool) -> Any:
    return kind(float(values)) if scalar else kind(np.atleast_1d(values))
