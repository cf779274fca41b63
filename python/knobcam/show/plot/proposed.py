"""What no name explains: as a curve over what it needs, the proposed formulas on it, and what length buys."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LinearSegmentedColormap

from .over_time import line
from .style import BAND, BLACK, BLUE, GREEN, GREY, ORANGE, VERMILLION, Picture, legend_above, plain, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...learn.left import Curve, Map
    from ...learn.proposals import Proposals

_BOTH = LinearSegmentedColormap.from_list("both", [BLUE, "white", VERMILLION])
_COLOURS = (VERMILLION, BLUE, GREEN)
_LONG = 40  # what is written along an axis
_UNITS = {"t": "s", "theta": "rad", "omega": "rad/s", "alpha": "rad/s^2", "s": "rad"}


@styled
def proposals(proposals: Proposals) -> Picture:
    """The residual over the variable of the first law with the laws on it, its map, error over length."""
    mapped = proposals.map
    widths = [1.6, 1.0] if mapped is None else [1.6, 1.2, 1.0]
    figure = Picture(8.5 if mapped is None else 13.0, 3.8, plain(proposals.headline, 400))
    grid = figure.add_gridspec(1, len(widths), width_ratios=widths)
    if mapped is not None:
        _map(figure.add_subplot(grid[1]), proposals, mapped)
    axis = figure.add_subplot(grid[0])
    if proposals.curve is not None:
        _curve(axis, proposals, proposals.curve)
    else:
        _over_time(axis, proposals)
    _front(figure.add_subplot(grid[-1]), proposals)
    return figure


def _curve(axis: Axes, proposals: Proposals, curve: Curve) -> None:
    known = curve.known
    x, value, band = (np.where(known, column, np.nan) for column in (curve.x, curve.value, curve.band))
    axis.fill_between(x, value - band, value + band, color=BAND, alpha=0.4, lw=0.0, label="95 % band")
    axis.plot(x, value, color=BLACK, lw=1.2, label="what is left")
    drawn = [(number, one) for number, one in enumerate(proposals.laws, 1) if one.law in curve.laws]
    for colour, (number, one) in zip(_COLOURS, drawn, strict=False):
        law = np.where(known, curve.laws[one.law], np.nan)
        axis.plot(x, law, color=colour, lw=1.2, ls="--", label=f"law {number}")
    unit = proposals.beside.torque_unit
    axis.set_xlabel(f"{curve.over} ({_UNITS.get(curve.over, '')})")
    times = curve.times if len(curve.times) <= _LONG else "all else of law 1"
    axis.set_ylabel(f"residual torque ({unit})" if not times else f"residual / ({times})")
    legend_above(axis)


def _map(axis: Axes, proposals: Proposals, mapped: Map) -> None:
    """What is left over the plane that it needs most; blank where that is not known."""
    most = float(np.nanmax(np.abs(mapped.value), initial=0.0)) or 1.0
    image = axis.pcolormesh(
        mapped.x, mapped.y, mapped.value, cmap=_BOTH, vmin=-most, vmax=most, rasterized=True
    )
    for axis_of, name in zip((axis.xaxis, axis.yaxis), mapped.over, strict=True):
        axis_of.set_label_text(f"{name} ({_UNITS.get(name, '')})")
    bar = axis.figure.colorbar(image, ax=axis)
    times = f" / ({mapped.times})" if mapped.times else ""
    bar.set_label(f"residual torque{times} ({proposals.beside.torque_unit})")


def _over_time(axis: Axes, proposals: Proposals) -> None:
    """A stretch of the residual, and the first law, where they are too fast for a curve."""
    signals = proposals.beside.prepared[0]
    left = proposals.beside.residuals[0]
    with_law = proposals.laws[0].fit.residuals[0] if proposals.laws else left
    t = signals.capture.t
    middle = 0.5 * (t[0] + t[-1])
    shown = np.abs(t - middle) < 0.1
    line(axis, t[shown], left[shown], color=BLACK, lw=1.0, label="what is left")
    line(axis, t[shown], (left - with_law)[shown], color=VERMILLION, lw=1.0, label="law 1")
    axis.set_xlabel("time (s)")
    axis.set_ylabel(f"residual torque ({proposals.beside.torque_unit})")
    legend_above(axis)


def _front(axis: Axes, proposals: Proposals) -> None:
    last = proposals.laws[0].fit if proposals.laws else proposals.beside
    front = [(0, proposals.beside.rmse_heldout)]
    front += [(one.complexity, one.rmse_heldout) for one in proposals.front]
    axis.axhline(last.noise_floor, color=GREY, lw=1.0, ls=":", label="noise alone")
    axis.plot(*zip(*front, strict=True), "o-", color=ORANGE, lw=1.0, label="no shorter one is as good")
    for number, one in enumerate(proposals.laws, 1):
        at = (one.complexity, one.rmse_heldout)
        axis.plot(*at, "o", color=VERMILLION if number == 1 else GREY, ms=4.0)
        axis.annotate(str(number), at, (3, 3), textcoords="offset points")
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("length of the law")
    axis.set_ylabel(f"error on unseen blocks ({proposals.beside.torque_unit})")
    legend_above(axis)
