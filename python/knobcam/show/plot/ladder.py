"""The error ladder: a waterfall from the first RMS error down to what the sensor's noise leaves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...fit.compare import in_floors
from ...fit.doubts import at_floor
from ..words import effect_word, p_word, sentence
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    PALE,
    WRONG,
    Picture,
    Scale,
    number,
    plain,
    source_of,
    styled,
    torque_scale,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...learn import LearningResult
    from ...learn.ladder import LearningStep

_NAMED = 2  # of the effects that look alike; a table has the others


@styled
def ladder(learned: LearningResult) -> Picture:
    """The RMS error of every step, what each effect took off it, and what sensor noise alone would leave.

    Whiskers are the 95 % interval of the RMS error, diamonds the error on blocks that the fit did not see.
    """
    figure = Picture(9.0, 1.9 + 0.5 * (len(learned.ladder) + 1), title(learned))
    draw_ladder(figure.add_subplot(), learned)
    return figure


def title(learned: LearningResult) -> str:
    """Return the verdict and the capture, for the top of a picture."""
    first = learned.captures[0]
    more = f" and {len(learned.captures) - 1} more" if len(learned.captures) > 1 else ""
    return f"{plain(sentence(learned.headline, learned.model.coordinate), 400)}\n{source_of(first)}{more}"


def draw_ladder(axes: Axes, learned: LearningResult) -> None:
    """Draw the waterfall, one row a step and one for what is left."""
    steps = learned.ladder
    longest = max(step.rmse for step in steps)
    scale = torque_scale(learned.model.torque_unit, longest)
    names = ["first model", *(f"+ {_word(step.added, learned)}" for step in steps[1:]), "what is left"]
    for row, step in enumerate(steps):
        if row:
            _step(axes, row, learned, scale)
        else:
            axes.barh(0, step.rmse * scale.factor, height=0.6, color=GREY, lw=0)
            _say(axes, scale.factor * _right_of(step), 0, f"{number(step.rmse * scale.factor)} {scale.unit}")
        _whiskers(axes, step, row, scale, "error on unseen blocks" if row == 0 else "")
    _rest(axes, learned, len(steps), scale)
    if math.isfinite(learned.noise_floor):
        floor = learned.noise_floor * scale.factor
        axes.axvline(floor, color=BLACK, lw=1.3, ls="--", label=f"sensor noise alone: {number(floor)}")
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.45, -0.55)
    axes.set_xlim(0.0, 1.42 * longest * scale.factor or 1.0)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel(f"RMS error ({scale.unit})")
    axes.set_title("Error ladder", fontweight="bold")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)


def _word(effect: str | None, learned: LearningResult) -> str:
    return plain(effect_word(effect or "", learned.model.coordinate), 30)


def _step(axes: Axes, row: int, learned: LearningResult, scale: Scale) -> None:
    """Draw what an effect took off (or, after a backward test, gave back), hung on the step above."""
    above, step = learned.ladder[row - 1 : row + 1]
    low, high = sorted((above.rmse * scale.factor, step.rmse * scale.factor))
    fell = step.rmse <= above.rmse
    axes.barh(row, high - low, left=low, height=0.6, color=GREEN if fell else WRONG, lw=0)
    axes.plot([above.rmse * scale.factor] * 2, [row - 0.7, row + 0.3], color=GREY, lw=0.8)
    said = f"{number(-100.0 * step.error_fall)} %"
    if math.isfinite(step.p_value):
        said += f"   {p_word(step.p_value, '.3f')}"
    if step.equivalent:
        others = [_word(name, learned) for name in step.equivalent]
        said += f"\nor {', '.join(others[:_NAMED])}" + (
            f" and {len(others) - _NAMED} more" if others[_NAMED:] else ""
        )
    _say(axes, scale.factor * max(above.rmse, _right_of(step)), row, said)


def _rest(axes: Axes, learned: LearningResult, row: int, scale: Scale) -> None:
    """Draw the last error: the part that noise explains, and what is beyond it."""
    step, floor = learned.ladder[-1], learned.noise_floor
    left = step.rmse * scale.factor
    axes.plot([left, left], [row - 0.7, row + 0.3], color=GREY, lw=0.8)
    beyond = math.isfinite(floor) and not at_floor(step.fit)
    chance = floor * scale.factor if beyond else left
    axes.barh(row, chance, height=0.6, color=BLUE if math.isfinite(floor) else PALE, lw=0)
    if beyond:
        axes.barh(row, left - chance, left=chance, height=0.6, color=WRONG, lw=0)
    said = f"{number(left)} {scale.unit}"
    if math.isfinite(floor) and floor > 0.0:
        said += f" = {in_floors(step.rmse / floor)} × noise"
    _say(axes, max(left, floor * scale.factor if math.isfinite(floor) else left), row, said)


def _whiskers(axes: Axes, step: LearningStep, row: int, scale: Scale, label: str) -> None:
    low, high = (scale.factor * limit for limit in step.rmse_ci95)
    axes.plot([low, high], [row, row], color=BLACK, lw=1.2)
    axes.plot(
        [low, low, math.nan, high, high],
        [row - 0.1, row + 0.1, math.nan, row - 0.1, row + 0.1],
        color=BLACK,
        lw=1.2,
    )
    unseen = step.rmse_heldout * scale.factor
    axes.plot([unseen], [row], "D", ms=4.5, color="white", mec=BLACK, mew=1.0, label=label or None)


def _right_of(step: LearningStep) -> float:
    """Where nothing of a step is drawn any more, N m."""
    return max(one for one in (step.rmse, step.rmse_ci95[1], step.rmse_heldout) if math.isfinite(one))


def _say(axes: Axes, right: float, row: int, text: str) -> None:
    axes.annotate(text, (right, row), (6, 0), textcoords="offset points", va="center", linespacing=1.25)
