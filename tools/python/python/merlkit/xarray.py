"""Tables as xarray datasets.

    import merlkit.xarray
    nickel = merlkit.xarray.dataset(merlkit.load("nickel"))
    nickel.f_r.sel(channel="red").sel(phi_d=1.57, method="nearest")
"""

from __future__ import annotations

from typing import Any

import merlkit


def dataset(material: merlkit.Material) -> Any:
    """The cells of a MERL table as an `xarray.Dataset`.

    `f_r` is the table itself, without a copy, in 1/sr; `valid` says which of its channels hold a value. The coordinates `theta_h`,
    `theta_d` and `phi_d` are the lower edges of bins, in radians (`merlkit.Axes`); `channel` is red, green and blue.
    """
    import xarray

    dimensions = ("theta_h", "theta_d", "phi_d", "channel")
    axes = merlkit.axes(material)
    angle = {"units": "rad"}
    return xarray.Dataset(
        {
            "f_r": (dimensions, material.table, {"units": "1/sr", "long_name": "BRDF without the cosine"}),
            "valid": (dimensions, material.valid),
        },
        coords={
            "theta_h": ("theta_h", axes.theta_h, {**angle, "long_name": "angle of the half vector"}),
            "theta_d": ("theta_d", axes.theta_d, {**angle, "long_name": "difference angle"}),
            "phi_d": ("phi_d", axes.phi_d, {**angle, "long_name": "azimuth of the difference"}),
            "channel": ("channel", ["red", "green", "blue"]),
        },
        attrs={"material": material.name, "lookup": material.lookup, "sha256": material.sha256},
    )
