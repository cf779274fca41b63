"""Static friction: where the torque of a knob that hardly moves piles up (Figure 24)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, PowerNorm

from .components import Samples
from .style import GREEN, PURPLE, Picture, legend_above, motion_units, number, styled, torque_scale
from .torques import headline

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...fit import Estimate, Fit
    from ...fit.stiction import Stiction

# From a grey that a single sample shows in, to black.
_INK = LinearSegmentedColormap.from_list("ink", ["#C8D8E4", "#0072B2", "#000000"])


@styled
def stiction(fit: Fit, estimate: Stiction | None = None) -> Picture:
    """Density of the isolated friction torque over velocities near zero (Figure 24 of the paper).

    Lines mark +-dv, -D_neg and D_pos: from `estimate` with their intervals, else from the model's Karnopp
    parameters, where there are any.
    """
    samples = Samples(fit, every=True)  # while it sticks, a sample says nothing about sliding friction
    friction = samples.isolated("velocity")
    borders = _borders(fit, estimate)
    slow = 0.05 * float(np.max(np.abs(samples.omega)))
    reach = 5.0 * borders["dv"].value if "dv" in borders else slow
    near = np.abs(samples.omega) <= reach
    heights = [abs(border.value) for name, border in borders.items() if name != "dv"]
    peak = max([float(np.max(np.abs(friction[near]), initial=0.0)), *heights])
    scale = torque_scale(fit.model.torque_unit, peak)
    speed = motion_units(fit.model.coordinate)["omega"]
    top = 1.15 * peak * scale.factor or 1.0
    figure = Picture(8.5, 5.6, headline(fit))
    axes = figure.add_subplot()
    window = [[-reach, reach], [-top, top]]
    cells = int(np.clip(np.sqrt(near.sum()), 30, 120))
    counts, x, y = np.histogram2d(samples.omega[near], friction[near] * scale.factor, cells, window)
    density = np.where(counts > 0.0, counts, np.nan).T  # empty cells stay white
    image = axes.pcolormesh(x, y, density, norm=PowerNorm(0.5, vmin=0.0), cmap=_INK, rasterized=True)
    if near.any():
        figure.colorbar(image, label="samples per cell", pad=0.01)
    for name, border in borders.items():
        if name == "dv":
            _mark(axes.axvline, axes.axvspan, border, 1.0, GREEN, f"±Δv = {number(border.value)} {speed}")
            _mark(axes.axvline, axes.axvspan, border, -1.0, GREEN, None)
        else:
            factor = scale.factor if name == "D_pos" else -scale.factor
            label = f"{'−D₋' if name == 'D_neg' else 'D₊'} = {number(border.value * factor)} {scale.unit}"
            _mark(axes.axhline, axes.axhspan, border, factor, PURPLE, label)
    axes.set(xlim=(-reach, reach), ylim=(-top, top))
    axes.set_title("Friction near standstill")
    axes.set_xlabel(f"velocity ({speed})")
    axes.set_ylabel(f"isolated friction ({scale.unit})")
    legend_above(axes)
    return figure


def _borders(fit: Fit, estimate: Stiction | None) -> dict[str, Estimate]:
    """Return those of dv, D_neg and D_pos that are known."""
    if estimate is not None:
        found = {"dv": estimate.dv, "D_neg": estimate.d_neg, "D_pos": estimate.d_pos}
    else:
        found = {name: fit.params.get(f"karnopp.{name}") for name in ("dv", "D_neg", "D_pos")}
    return {name: border for name, border in found.items() if border is not None and border.value > 0.0}


def _mark(
    line: Callable[..., Any],
    span: Callable[..., Any],
    border: Estimate,
    factor: float,
    color: str,
    label: str | None,
) -> None:
    """Draw a border, and its interval where one is known."""
    line(border.value * factor, color=color, ls="--", lw=1.3, label=label)
    low, high = (factor * limit for limit in border.ci95)
    if np.isfinite([low, high]).all() and low != high:
        span(min(low, high), max(low, high), color=color, alpha=0.2, lw=0, zorder=0.5)
