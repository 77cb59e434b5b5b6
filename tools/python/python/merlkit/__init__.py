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

from __future__ import annotations

from typing import Any, Dict, List, Literal, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

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


Floats = npt.NDArray[np.float32]
Angles = npt.NDArray[np.float64]


class Axes(NamedTuple):
    """Angles of the lower edges of a table's bins, radians, float64.

    The first three axes of `Material.table` follow them. The `linear` lookup places values at these edges, `floor` takes the value
    of the bin that an angle falls in, and `centred` places values at the middles of bins.
    """

    theta_h: Angles
    theta_d: Angles
    phi_d: Angles


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


def spherical(theta: npt.ArrayLike, phi: npt.ArrayLike = 0.0) -> Floats:
    """Unit directions of polar angles and azimuths in radians, of the shape (..., 3), float32."""
    polar, azimuth = np.broadcast_arrays(
        np.asarray(theta, dtype=np.float64), np.asarray(phi, dtype=np.float64)
    )
    sine = np.sin(polar)
    direction = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(polar)], axis=-1)
    return direction.astype(np.float32)


def check(
    sampler: Sampler,
    *,
    draws: int = 100_000,
    seed: int = 1,
    significance: float = 0.01,
    wo: Optional[npt.ArrayLike] = None,
) -> CheckReport:
    """Checks that a sampler is right, as `merlkit check` does.

    Draws are valid and have the density that `pdf` says, the density is positive wherever the material reflects and integrates to one
    minus the fraction of failed draws, draws follow it (chi-square), and the albedo estimate is unbiased. `wo` are the directions to
    check at, of the shape (N, 3); by default those of the command. At the default significance, one run in a hundred fails by chance.
    """
    result = _native.check(sampler, draws=draws, seed=seed, significance=significance, wo=wo)
    return CheckReport(result["material"], result["sampler"], result["outcomes"])


def render(
    materials: Union[Material, Sequence[Material]],
    *,
    lights: Sequence[str] = ("studio",),
    sampler: str = "half-vector:64KB",
    width: Optional[int] = None,
    height: int = 360,
    spp: int = 64,
    ground: bool = False,
    bounces: int = 8,
    strategy: Literal["mis", "light", "brdf", "ris"] = "mis",
    seed: int = 0,
) -> Floats:
    """Path-traces a row of spheres, one for each material, as `merlkit render` does.

    The picture is linear RGB of the shape (height, width, 3), float32, with the top row first. `lights` are words of the command's
    `--light`: "studio", "uniform", "point:X,Y,Z", the path of an environment map and others. `spp` is the number of paths per
    pixel, and `bounces` the largest number of surfaces on a path. The result does not depend on the number of threads.
    """
    if isinstance(materials, Material):
        materials = [materials]
    return _native.render(
        list(materials),
        lights=list(lights),
        sampler=sampler,
        width=width,
        height=height,
        spp=spp,
        ground=ground,
        bounces=bounces,
        strategy=strategy,
        seed=seed,
    )


def _restore_material(
    material: str,
    lookup: Literal["floor", "linear", "centred"],
    invalid: Literal["cell", "channel"],
    table: Literal["f32", "f16", "rgb9e5"],
) -> Material:
    return load(material, lookup, invalid=invalid, table=table)
