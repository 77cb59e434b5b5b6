"""Measured BRDFs and their importance samplers on numpy arrays.

Directions are arrays of the shape (N, 3), best of float32: `wo` towards the viewer, `wi` towards the light. Both leave the surface,
in a frame whose +z is the normal. `eval` is f_r in 1/sr without the cosine, and every `pdf` is per solid angle of `wi`, in 1/sr.
Angles are in radians.

    import numpy as np
    import merlkit

    nickel = merlkit.load("nickel")
    sampler = merlkit.Sampler.build(nickel, "half-vector:64KB")
    wo = merlkit.spherical(0.5)
    wi, pdf = sampler.sample(wo, np.random.random((100_000, 2)))
    weight = nickel.eval_cos(wo, wi) / pdf[:, None]
    print(weight.mean(axis=0), nickel.albedo(wo))
"""

from typing import Any, Dict, List, NamedTuple, Sequence, Union

import numpy as _np

from . import _native
from ._native import (
    Fit,
    FormatError,
    Material,
    Sampler,
    __version__,
    export,
    fit,
    from_function,
    load,
    material_names,
    model_names,
    report,
    sampler_names,
)

__all__ = [
    "Axes",
    "CheckReport",
    "Fit",
    "FormatError",
    "Material",
    "Sampler",
    "__version__",
    "axes",
    "check",
    "export",
    "fit",
    "from_function",
    "load",
    "material_names",
    "model_names",
    "render",
    "report",
    "sampler_names",
    "spherical",
]


class Axes(NamedTuple):
    """Angles of the lower edges of a table's bins, radians, float64.

    The first three axes of `Material.table` follow them. The `linear` lookup places values at these edges, `floor` takes the value
    of the bin that an angle falls in, and `centred` places values at the middles of bins.
    """

    theta_h: Any
    theta_d: Any
    phi_d: Any


class CheckReport(NamedTuple):
    """What `check` found."""

    material: str
    sampler: str
    outcomes: List[Dict[str, Any]]

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(outcome["pass"] for outcome in self.outcomes)

    @property
    def failures(self) -> List[Dict[str, Any]]:
        """The checks that failed."""
        return [outcome for outcome in self.outcomes if not outcome["pass"]]

    def __repr__(self) -> str:
        failed = len(self.failures)
        verdict = "all passed" if failed == 0 else f"{failed} failed"
        return f"<merlkit.CheckReport {self.sampler} for {self.material}: {len(self.outcomes)} checks, {verdict}>"


def axes(material: Material) -> Axes:
    """The axes of `material.table`."""
    return Axes(*material._axes)


def spherical(theta: Any, phi: Any = 0.0) -> Any:
    """Unit directions of polar angles and azimuths in radians, of the shape (..., 3), float32."""
    theta, phi = _np.broadcast_arrays(
        _np.asarray(theta, dtype=_np.float64), _np.asarray(phi, dtype=_np.float64)
    )
    sine = _np.sin(theta)
    direction = _np.stack([sine * _np.cos(phi), sine * _np.sin(phi), _np.cos(theta)], axis=-1)
    return direction.astype(_np.float32)


def check(
    sampler: Sampler,
    *,
    draws: int = 100_000,
    seed: int = 1,
    significance: float = 0.01,
    wo: Any = None,
) -> CheckReport:
    """Checks that a sampler is right, at `wo` of the shape (N, 3) or at the directions of `merlkit check`."""
    result = _native.check(sampler, draws=draws, seed=seed, significance=significance, wo=wo)
    return CheckReport(result["material"], result["sampler"], result["outcomes"])


def render(materials: Union[Material, Sequence[Material]], **options: Any) -> Any:
    """Path-traces a row of spheres, one for each material; see the stub for the options."""
    if isinstance(materials, Material):
        materials = [materials]
    return _native.render(list(materials), **options)


def _restore_material(material: str, lookup: str, invalid: str, table: str) -> Material:
    return load(material, lookup, invalid=invalid, table=table)
