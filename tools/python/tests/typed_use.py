"""What type checkers must accept; it is not run."""

import numpy as np
import numpy.typing as npt
from typing import Optional

import merlkit


def grey(wo: npt.NDArray[np.float32], wi: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    return np.full(wi.shape, 0.5 / np.pi)


material: merlkit.Material = merlkit.load("nickel", "linear", table="f16")
function: merlkit.Material = merlkit.from_function(grey, isotropic=True, name="grey")
sampler: merlkit.Sampler = merlkit.Sampler.build(material, "half-vector:64KB")
wo: npt.NDArray[np.float32] = merlkit.spherical(0.5, [0.0, 1.0])
drawn: tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]] = sampler.sample(wo, [[0.5, 0.5]])
values: npt.NDArray[np.float32] = material.eval(wo, drawn[0])
table: npt.NDArray[np.float32] = material.table
theta_h: npt.NDArray[np.float64] = merlkit.axes(material).theta_h
lookup: Optional[str] = material.lookup
passed: bool = merlkit.check(sampler, draws=1000).passed
picture: npt.NDArray[np.float32] = merlkit.render([material, function], lights=["studio"], spp=4)
model: str = merlkit.fit(material, ["ggx"]).best["model"]
