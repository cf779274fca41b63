"""Measured and simulated position over time, and how far they are apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .over_time import line, times
from .style import BLACK, BLUE, GREY, PALE, Picture, Scale, legend_above, plain, source_of, styled

if TYPE_CHECKING:
    from matplotlib.gridspec import GridSpec

    from ...fit.forward import Forward, ForwardRun

_MOST = 3  # captures that a picture has room for
_MARKED = 40  # beginnings that are still told apart


@styled
def forward(forward: Forward) -> Picture:
    """Measured (wide, grey) and simulated (thin, blue) position over time, the error below; of each capture.

    Dotted: where the simulation began anew from the measured state.
    """
    shown = forward.runs[:_MOST]
    more = f" (the first {_MOST} of {len(forward.runs)} captures)" if len(forward.runs) > _MOST else ""
    figure = Picture(8.5, 0.9 + 3.4 * len(shown), plain(forward.summary, 400) + more)
    grid = figure.add_gridspec(2 * len(shown), 1, height_ratios=[1.6, 1.0] * len(shown))
    for number, run in enumerate(shown):
        _one(figure, grid, 2 * number, run, Scale(1e3, "mm") if forward.unit == "m" else Scale(1.0, "rad"))
    return figure


def _one(figure: Picture, grid: GridSpec, row: int, run: ForwardRun, scale: Scale) -> None:
    t = times(run.signals.capture)
    above = figure.add_subplot(grid[row])
    line(above, t, scale.factor * run.measured, color=PALE, lw=4.0, label="measured")
    line(above, t, scale.factor * run.simulated, color=BLUE, lw=0.9, label="simulated")
    above.set_ylabel(f"position ({scale.unit})")
    above.set_title(source_of(run.signals.capture), fontsize="small")
    above.tick_params(labelbottom=False)
    legend_above(above)
    below = figure.add_subplot(grid[row + 1], sharex=above)
    line(below, t, scale.factor * run.error, color=BLACK, lw=0.9)
    below.axhline(0.0, color=GREY, lw=0.6, zorder=0.9)
    if 1 < len(run.starts) <= _MARKED:
        for start in t[run.starts]:
            below.axvline(float(start), color=GREY, lw=0.6, ls=":")
    peak = scale.factor * float(np.nanmax(np.abs(run.error), initial=0.0))
    below.set_ylim(-1.1 * peak or -1.0, 1.1 * peak or 1.0)
    below.set_ylabel(f"error ({scale.unit})")
    below.set_xlabel("time (s)")
