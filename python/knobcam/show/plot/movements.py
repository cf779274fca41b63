"""How far the parameters of a model moved when the missing effects came in."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..words import effect_word, param_word, unit_word
from .ladder import title
from .style import BAND, BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILLION, Picture, legend_below, plain, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from ...fit.refit import Moved
    from ...learn import LearningResult
    from ...learn.ladder import LearningStep

_COLORS = (BLUE, ORANGE, GREEN, PURPLE, VERMILLION)
_COLUMNS = 3  # of the legend
_BAR = 0.15  # inches of a bar with its words
_USUAL = 2.0  # standard errors: within that nothing happened


@styled
def movements(learned: LearningResult) -> Picture:
    """Movement of each parameter of the first model, in standard errors, for each effect that came in."""
    rows, came = len(plotted(learned.ladder)), len(learned.ladder) - 1
    figure = Picture(8.5, 1.8 + max(0.36, _BAR * came) * rows, title(learned))
    draw_movements(figure.add_subplot(), learned)
    return figure


def draw_movements(axes: Axes, learned: LearningResult) -> None:
    """Draw a bar for each parameter and effect; linear up to 2 standard errors, then by decades."""
    names, kind = plotted(learned.ladder), learned.model.coordinate
    came = [step for step in learned.ladder if step.added is not None]
    width = 0.72 / max(len(came), 1)
    reach = 10.0
    for i, step in enumerate(came):
        moves = {name: step.moved[name] for name in names if name in step.moved}
        rows = [names.index(name) + (i - 0.5 * (len(came) - 1)) * width for name in moves]
        moved = [move.by_se for move in moves.values()]
        color = _COLORS[i % len(_COLORS)]
        label = f"+ {plain(effect_word(step.added or '', kind), 30)}"
        axes.barh(rows, moved, height=0.9 * width, color=color, lw=0, label=label)
        for row, (name, move) in zip(rows, moves.items(), strict=True):
            _say(axes, row, move, learned.params[name].unit if name in learned.params else "")
        reach = max([reach, *map(abs, moved)])
    axes.axvspan(-_USUAL, _USUAL, color=BAND, alpha=0.3, lw=0, zorder=0.5)
    axes.axvline(0.0, color=BLACK, lw=0.8)
    axes.set_xscale("symlog", linthresh=_USUAL, linscale=0.6)
    # Room for the words beyond the longest bar, on a scale by decades.
    limit = 10.0 ** (math.log10(reach) * 1.18 + 0.55)
    axes.set_xlim(-limit, limit)
    ticks = [10.0**k for k in range(1, int(math.log10(limit)) + 1)]
    axes.set_xticks([*(-tick for tick in ticks[::-1]), -2.0, 0.0, 2.0, *ticks], minor=False)
    axes.set_xticks([], minor=True)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:+g}".replace("-", "−") if value else "0")
    axes.set_yticks(range(len(names)), [plain(param_word(name, kind)) for name in names])
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("moved by (standard errors)")
    legend_below(axes, "Parameters that moved", _COLUMNS)


def plotted(ladder: Sequence[LearningStep]) -> list[str]:
    """Return the parameters of the first model, but for those that went before they could move."""
    came = [step for step in ladder if step.added is not None]
    return [name for name in ladder[0].params if not came or any(name in step.moved for step in came)]


def _say(axes: Axes, row: float, move: Moved, unit: str) -> None:
    """Write the change at the end of a bar that leaves the band: in percent, or in the unit of a phase."""
    if abs(move.by_se) <= _USUAL:
        return
    side = 1 if move.by_se > 0.0 else -1
    words = f"{move.by:+.2g} {unit_word(unit)}"
    if not move.sizeless:
        percent = move.by_percent
        words = f"{percent:+,.0f} %" if abs(percent) >= 100.0 else f"{percent:+.3g} %"
    axes.annotate(
        words.replace("-", "−"),
        (move.by_se, row),
        (4 * side, 0),
        textcoords="offset points",
        ha="left" if side > 0 else "right",
        va="center",
        fontsize=8.0,
    )
