"""Plots with matplotlib. Each function draws into the axes that it is given, or into new ones, and returns them.

    import merlkit.plot
    ax = merlkit.plot.polar(merlkit.load("nickel"), theta_o=0.7)
    ax.figure.savefig("nickel.pdf")
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

import merlkit

CHANNELS = ("tab:red", "tab:green", "tab:blue")
"""Colours of the channels."""


def _new_axes(axes: Any, **options: Any) -> Any:
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.figure().add_subplot(**options)


def polar(material: merlkit.Material, theta_o: float, *, cosine: bool = True, axes: Optional[Any] = None) -> Any:
    """f_r·cosθi (or f_r) in the plane of incidence for a `wo` at the polar angle `theta_o` in radians, one curve a channel."""
    axes = _new_axes(axes, projection="polar")
    theta = np.radians(np.linspace(-89.75, 89.75, 719))
    evaluate = material.eval_cos if cosine else material.eval
    # The light is on the other side of the normal at positive angles.
    values = evaluate(merlkit.spherical(theta_o, np.pi), merlkit.spherical(theta))
    for channel, colour in enumerate(CHANNELS):
        axes.plot(theta, values[:, channel], color=colour)
    axes.set_theta_zero_location("N")
    axes.set_thetalim(-np.pi / 2, np.pi / 2)
    axes.set_title(f"{material.name}, θo = {np.degrees(theta_o):.1f}°")
    return axes


def table_slice(material: merlkit.Material, *, phi_d: float = np.pi / 2, axes: Optional[Any] = None) -> Any:
    """A slice of a MERL table at the azimuth `phi_d` in radians: the mean of the channels by θh and θd, in a logarithmic grey scale."""
    axes = _new_axes(axes)
    angles = merlkit.axes(material)
    azimuth = int(np.searchsorted(angles.phi_d, phi_d % np.pi, side="right")) - 1
    values = material.table[:, :, azimuth].mean(axis=-1)
    dark = np.ma.masked_less_equal(values.T, 0.0)
    from matplotlib.colors import LogNorm

    mesh = axes.pcolormesh(
        np.degrees(np.append(angles.theta_h, np.pi / 2)),
        np.degrees(np.append(angles.theta_d, np.pi / 2)),
        dark,
        norm=LogNorm() if dark.count() else None,
        cmap="gray",
    )
    axes.figure.colorbar(mesh, ax=axes, label="f_r, 1/sr")
    axes.set_xlabel("θh, degrees")
    axes.set_ylabel("θd, degrees")
    axes.set_title(material.name)
    return axes


def albedo(material: merlkit.Material, *, axes: Optional[Any] = None) -> Any:
    """The directional albedo by the polar angle of `wo`, one curve a channel."""
    axes = _new_axes(axes)
    degrees = np.linspace(0.5, 89.5, 60)
    values = material.albedo(merlkit.spherical(np.radians(degrees)))
    for channel, colour in enumerate(CHANNELS):
        axes.plot(degrees, values[:, channel], color=colour)
    axes.set_xlabel("θo, degrees")
    axes.set_ylabel("albedo")
    axes.set_ylim(bottom=0)
    axes.set_title(material.name)
    return axes


def draws(sampler: merlkit.Sampler, theta_o: float, *, count: int = 2000, seed: int = 0, axes: Optional[Any] = None) -> Any:
    """Draws of a sampler for a `wo` at the polar angle `theta_o` in radians, seen from above the surface."""
    axes = _new_axes(axes)
    wo = merlkit.spherical(theta_o)
    wi, pdf = sampler.draw_stratified(wo, count, seed)
    axes.scatter(wi[pdf > 0, 0], wi[pdf > 0, 1], s=2, color="black", label="wi")
    axes.plot(wo[0], wo[1], "o", color="tab:red", label="wo")
    circle = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(circle), np.sin(circle), color="gray", linewidth=0.8)
    axes.set_aspect("equal")
    axes.set_title(f"{sampler.spec} for {sampler.material.name}")
    return axes
