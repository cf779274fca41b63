"""How punctual a render loop was: its wake-ups as a histogram and over the last second."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .style import BLUE, ORANGE, WRONG, Picture, legend_above, number, plain, shade, styled
from .thin import envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...render.loop_report import Durations, LoopReport

_US = 1e6  # microseconds in a second
_SENTENCE = 400  # letters of a remark


@styled
def timing(report: LoopReport) -> Picture:
    """Histogram of wake-ups after their deadlines and of steps; the lateness over the last second."""
    remarks = [plain(remark, _SENTENCE) for remark in report.remarks]
    figure = Picture(10.0, 4.6, "\n".join([report.headline, *remarks]))
    left, right = figure.subplots(1, 2)
    _histogram(left, report)
    _timeline(right, report)
    return figure


def _histogram(axes: Axes, report: LoopReport) -> None:
    _steps(axes, report.late, BLUE, "wake-up after deadline")
    _steps(axes, report.busy, ORANGE, "step")
    period = _US / report.rate_hz
    axes.axvline(period, color=WRONG, lw=1.2, ls="--", label=f"period, {number(period)} µs")
    axes.set(xscale="log", yscale="log")
    axes.set_ylim(bottom=0.7)
    axes.set_title("All steps", pad=22.0)
    axes.set_xlabel("duration (µs)")
    axes.set_ylabel("steps per bin")
    legend_above(axes)


def _steps(axes: Axes, durations: Durations, colour: str, label: str) -> None:
    """Draw the bins from the first that holds something to the last one."""
    (filled,) = np.nonzero(durations.counts)
    if not filled.size:
        return
    shown = slice(filled[0], filled[-1] + 1)
    edges = _US * durations.edges[filled[0] : filled[-1] + 2]
    # The bin of no duration at all begins at zero, which a logarithmic axis does not have.
    edges = np.maximum(edges, 0.5e-3)
    axes.stairs(durations.counts[shown], edges, color=colour, lw=1.3, fill=False, baseline=0.5, label=label)


def _timeline(axes: Axes, report: LoopReport) -> None:
    last = report.last
    axes.plot(*envelope(last.t, _US * last.late), color=BLUE, lw=0.9, label="wake-up after deadline")
    period = 1.0 / report.rate_hz
    deadlines = last.t - last.late
    (before,) = np.nonzero(np.diff(deadlines) > 1.5 * period)
    if before.size:
        gaps = [(deadlines[i] + period, deadlines[i + 1] - deadlines[i] - period) for i in before]
        missed = round(sum(length for _, length in gaps) / period)
        shade(axes, gaps, f"missed ({missed} periods)")
    axes.set_ylim(bottom=0.0)
    axes.set_title("Last second", pad=22.0)
    axes.set_xlabel("time since the start (s)")
    axes.set_ylabel("wake-up after deadline (µs)")
    legend_above(axes)
