"""What was learned of a capture, in one picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .candidates import draw_candidates
from .change import draw_change, draw_residual
from .failures import shares
from .ladder import draw_ladder, title
from .movements import draw_movements
from .style import Picture, styled, torque_scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.gridspec import SubplotSpec

    from ...learn import LearningResult


@styled
def learned(learned: LearningResult) -> Picture:
    """The error ladder, the residual before and after where it failed, what moved, and what remains.

    Where nothing came in, what was weighed takes the place of what moved.
    """
    figure = Picture(13.0, 9.0, title(learned))
    grid = figure.add_gridspec(2, 2)
    draw_ladder(figure.add_subplot(grid[0, 0]), learned)
    draw_change(figure, grid[0, 1], learned)
    if len(learned.ladder) > 1:
        draw_movements(figure.add_subplot(grid[1, 0]), learned)
    else:
        draw_candidates(figure.add_subplot(grid[1, 0]), learned.last)
    _draw_remaining(figure, grid[1, 1], learned)
    return figure


@styled
def remaining(learned: LearningResult) -> Picture:
    """Where the error of the last model lies, beside what chance gives, and the axis that is worst."""
    figure = Picture(9.0, 4.0 if learned.after.worst is None else 6.4, title(learned))
    _draw_remaining(figure, figure.add_gridspec(1, 1)[0], learned)
    return figure


def _draw_remaining(figure: Figure, cell: SubplotSpec, learned: LearningResult) -> None:
    worst = learned.after.worst
    rows = cell.subgridspec(1 if worst is None else 2, 1)
    shares(figure.add_subplot(rows[0]), learned.after)
    if worst is not None:
        scale = torque_scale(learned.model.torque_unit, float(np.max(np.abs(worst.mean), initial=0.0)))
        says = (
            "What is left after reversals" if worst.axis == "history" else f"What is left along {worst.axis}"
        )
        draw_residual(figure.add_subplot(rows[1]), worst, scale, says)
