"""The residual before and after, on the axis where the first model failed most."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .failures import bin_means, head_of, line_spectrum, of_excess
from .ladder import title
from .style import BLACK, WRONG, Picture, Scale, styled, torque_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.gridspec import SubplotSpec

    from ...fit.compare import Split
    from ...learn import LearningResult


@styled
def before_after(learned: LearningResult) -> Picture:
    """The residual of the first and of the last model on the axis where the first failed most.

    Bin means with the band that chance gives them; where nothing failed, over position.
    """
    figure = Picture(9.0, 6.0 if len(learned.ladder) > 1 else 3.6, title(learned))
    draw_change(figure, figure.add_gridspec(1, 1)[0], learned)
    return figure


def draw_change(figure: Figure, cell: SubplotSpec, learned: LearningResult) -> None:
    """Draw the two residuals on the same scales, the first above the last; one if nothing was added."""
    worst = learned.before.worst
    left = learned.unexplained.axis if learned.unexplained is not None else "position"
    axis = worst.axis if worst is not None else left
    splits = {"First model": learned.before[axis], "Last model": learned.after[axis]}
    if len(learned.ladder) == 1:
        splits = {"Residual": learned.after[axis]}
    highest = max(_peak(split) for split in splits.values())
    scale = torque_scale(learned.model.torque_unit, highest)
    rows = cell.subgridspec(len(splits), 1)
    first = None
    for row, (name, split) in enumerate(splits.items()):
        axes = figure.add_subplot(rows[row], sharex=first, sharey=first)
        draw_residual(axes, split, scale, f"{name}: {of_excess(split)}", row == len(splits) - 1)
        if first is not None and (legend := axes.get_legend()) is not None:
            legend.remove()  # the panel above has the same
        first = first or axes
    if first is not None and axis != "frequency":
        reach = 1.15 * scale.factor * highest
        first.set_ylim(-reach or -1.0, reach or 1.0)


def draw_residual(axes: Axes, split: Split, scale: Scale, says: str, lowest: bool = True) -> None:
    """Draw the residual along an axis beside what chance gives; only the lowest panel names the axis."""
    if split.axis == "frequency":
        line_spectrum(axes, split, scale)
    else:
        bin_means(axes, split, scale)
    axes.set_title(says, color=WRONG if split.fails else BLACK, fontweight="bold")
    if lowest:
        axes.set_xlabel(head_of(split, scale))
    else:
        axes.tick_params(labelbottom=False)


def _peak(split: Split) -> float:
    return float(np.max(np.maximum(np.abs(split.mean), split.band), initial=0.0))
