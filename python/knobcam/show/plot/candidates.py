"""Which effect could be missing: how far the error falls with each, and which look alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..words import effect_word, p_word
from .style import BLACK, BLUE, GREY, ORANGE, Picture, legend_below, plain, styled
from .torques import headline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...fit.diagnose import Candidate, Diagnosis

_ALL = 100.0  # per cent
_COLUMNS = 2  # of the legend
_WORSE = 0.3  # of what is shown to the right: how far a bar to the left goes, whose length says nothing


@styled
def diagnosis(diagnosis: Diagnosis) -> Picture:
    """The error fall of every candidate, those that could be missing solid, those that look alike linked.

    Diamonds are the same on blocks that the fit did not see; the dashed line is all that there is to gain.
    """
    best = diagnosis.best
    said = "No effect of the catalogue that is weighed here is missing"
    if best is not None:
        first = "Missing first of all" if best.word == "missing" else "A part of what is missing"
        names = [effect_word(one, diagnosis.fit.model.coordinate) for one in (best.effect, *best.equivalent)]
        said = f"{first}: {plain(' or '.join(names), 200)}"
    rows = max(len(diagnosis.candidates), 1)
    figure = Picture(9.0, 1.9 + 0.32 * rows, f"{said}\n{headline(diagnosis.fit)}")
    draw_candidates(figure.add_subplot(), diagnosis)
    return figure


def draw_candidates(axes: Axes, diagnosis: Diagnosis) -> None:
    """Draw the bars, their words, and the brackets of those that look alike."""
    candidates, fit = diagnosis.candidates, diagnosis.fit
    falls = [100.0 * one.error_fall for one in candidates]
    # What noise leaves cannot be taken away; without a noise floor nothing is known to be there to gain.
    gain = 100.0 * (1.0 - fit.noise_floor / fit.rmse) if fit.noise_floor <= fit.rmse > 0.0 else 0.0
    top = max([gain, *falls, 1.0])
    least = max(min([*falls, 0.0]), -_WORSE * top)
    left = least - 0.16 * top
    axes.set_xlim(left, 1.35 * top)
    axes.set_xticks([tick for tick in axes.get_xticks() if left <= tick <= _ALL])  # no error falls by more
    axes.set_xlim(left, 1.35 * top)
    for row, (one, fall) in enumerate(zip(candidates, falls, strict=True)):
        axes.barh(
            row,
            fall,
            height=0.62,
            color=BLUE if one.could_be else "white",
            edgecolor=BLUE if one.could_be else GREY,
            hatch=None if one.could_be else "////",
            lw=0.9,
        )
        unseen = 100.0 * (1.0 - one.rmse_heldout / fit.rmse_heldout) if fit.rmse_heldout > 0.0 else 0.0
        # An effect that fails on unseen blocks can fail by any factor: an arrow says that it is far off.
        far = not unseen > left
        label = "on unseen blocks" if row == 0 else None
        place, marker = (left + 0.02 * top, "<") if far else (unseen, "D")
        axes.plot([place], [row], marker, ms=4.5, color="white", mec=BLACK, mew=1.0, label=label, zorder=3)
        off = f"   {fall:.0f} %".replace("-", "−") if fall < least else ""
        axes.annotate(
            _words(one) + off,
            (max(fall, place, 0.0), row),
            (8, 0),
            textcoords="offset points",
            va="center",
            color=BLACK if one.could_be else GREY,
        )
    if gain > 0.0:
        axes.axvline(gain, color=BLACK, lw=1.3, ls="--", label="all that noise leaves to gain")
    _links(axes, candidates)
    found = len(diagnosis.could_be)
    if 0 < found < len(candidates):
        axes.axhline(found - 0.5, color=BLACK, lw=0.8)
        axes.text(
            1.0,
            found - 0.47,
            "not missing",
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="top",
            color=GREY,
        )
    names = [plain(effect_word(one.effect, fit.model.coordinate), 30) for one in candidates]
    axes.set_yticks(range(len(candidates)), names)
    axes.set_ylim(max(len(candidates), 1) - 0.4, -0.6)
    axes.axvline(0.0, color=BLACK, lw=0.8)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("the RMS error falls by (%)")
    title = "What was weighed; solid: could be missing" if found else "No effect that could be missing"
    title = title if fit.noise_floor > 0.0 else "What was weighed; whether by chance is not known"
    legend_below(axes, title, _COLUMNS)


def _words(one: Candidate) -> str:
    said = "" if one.word == "untold" else p_word(one.p_value, ".2g")
    if one.implausible:
        said = f"{said}   implausible".strip()
    return said


def _links(axes: Axes, candidates: tuple[Candidate, ...]) -> None:
    """Join candidates that this capture cannot tell apart by a bracket left of their bars."""
    rows = {one.effect: row for row, one in enumerate(candidates)}
    drawn: set[frozenset[int]] = set()
    for one in candidates:
        group = frozenset(rows[name] for name in (one.effect, *one.equivalent) if name in rows)
        if len(group) < 2 or group in drawn:
            continue
        drawn.add(group)
        line = axes.get_yaxis_transform()
        # Left of zero, in the share of the width that the limits of the axis leave free there.
        x = 0.075 - 0.018 * (len(drawn) - 1)
        axes.plot([x, x], [min(group), max(group)], color=ORANGE, lw=2.2, transform=line)
        for row in group:
            axes.plot([x, 0.095], [row, row], color=ORANGE, lw=2.2, transform=line)
        there = "this capture" if len(candidates[0].fit.prepared) == 1 else "these captures"
        label = f"look alike in {there}" if len(drawn) == 1 else None
        axes.plot([x], [min(group)], color=ORANGE, lw=2.2, transform=line, label=label)
