"""Where a model fails, at a glance: the residual along every axis beside what chance gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ...fit.compare import in_floors
from ..words import axis_tick, axis_word, unit_word
from .style import (
    BACKWARD,
    BAND,
    BLACK,
    FORWARD,
    GREY,
    PALE,
    WRONG,
    Picture,
    Scale,
    plain,
    styled,
    torque_scale,
    torque_word,
)
from .torques import headline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...fit.compare import Comparison, Split

_SOME = 0.1
"""Of the bins, twice what chance lets leave their bands of 95 %."""
_SIDES = {1: ("forward", FORWARD), -1: ("backward", BACKWARD), 0: ("mean residual", BLACK)}


@styled
def comparison(comparison: Comparison) -> Picture:
    """The residual along every axis: bin means, the band of chance, and the regions that leave it.

    Titles carry each axis's share of the squared error beyond noise; the worst axis is framed.
    """
    fit = comparison.fit
    explained, relative = comparison.figures.in_percent, 100.0 * comparison.figures.relative
    how_large = f"{explained} of the variance explained, relative error {relative:.3g} %"
    figure = Picture(11.5, 9.6, f"{headline(fit)}; {how_large}")
    peak = max(float(np.max(np.abs(split.mean), initial=0.0)) for split in comparison.splits)
    scale = torque_scale(fit.model.torque_unit, peak)
    shares(figure.add_subplot(4, 2, 1), comparison)
    for i, split in enumerate(comparison.splits):
        axes = figure.add_subplot(4, 2, i + 2)
        if split.axis == "frequency":
            line_spectrum(axes, split, scale)
        else:
            bin_means(axes, split, scale)
        _head(axes, split, scale, comparison.worst is split)
    return figure


def shares(axes: Axes, comparison: Comparison) -> None:
    """Draw the shares of all axes as bars, with the share that chance stays below.

    Where the noise is not known they are of the whole error, and chance is none of them.
    """
    known = comparison.fit.noise_floor > 0.0
    splits = [one for one in comparison.splits[::-1] if known or one.axis != "frequency"]
    rows = range(len(splits))
    colors = [WRONG if s is comparison.worst else BACKWARD if s.fails else PALE for s in splits]
    bars = [100.0 * (s.share if known else s.mean_share) for s in splits]
    axes.barh(rows, bars, height=0.62, color=colors)
    for row, (split, bar) in enumerate(zip(splits, bars, strict=True)):
        if not known:
            axes.text(bar + 1.5, row, f"{bar:.0f} %", va="center", color=BLACK)
            continue
        chance = 100.0 * split.chance
        axes.plot([chance, chance], [row - 0.4, row + 0.4], color=BLACK, lw=1.2)
        none = "no line" if split.axis == "frequency" else "chance"
        says, color = (f"{100.0 * split.share:.0f} %", BLACK) if split.fails else (none, GREY)
        right = 100.0 * float(np.nan_to_num(max(split.share, split.chance)))
        axes.text(right + 1.5, row, says, va="center", color=color)
    axes.set_yticks(rows, [axis_tick(s.axis) for s in splits])
    axes.set_xlim(0.0, 112.0)
    axes.set_xticks([0, 25, 50, 75, 100])
    axes.grid(visible=False, axis="y")
    told = "share of the error beyond noise (%)\nof each axis alone: they overlap\nblack: chance stays below"
    axes.set_xlabel(told if known else "share of the squared error (%), noise and all")
    axes.set_title(plain(_verdict(comparison)), fontweight="bold")


def of_excess(split: Split) -> str:
    """Return what is said of an axis in a title."""
    if split.fails:
        return f"{100.0 * split.share:.0f} % of the excess"
    if np.isnan(split.share):
        return "noise not known"
    beyond = float(np.mean(np.abs(split.mean) > split.band))
    if split.axis == "frequency" and beyond > 0.0:
        return "no line stands out"  # though more is left than noise at many: that is wide, as of an event
    # Where so many bins leave their band that it is seen, the axis as a whole may still be chance's.
    return "chance as a whole" if beyond > _SOME else "no more than chance"


def _verdict(comparison: Comparison) -> str:
    if not comparison.fit.noise_floor > 0.0:
        return "The noise is not known"
    times = comparison.fit.rmse / comparison.fit.noise_floor
    if comparison.complete:
        return f"Chance explains the rest ({times:.2f} × noise)"
    if comparison.worst is None:
        return f"{in_floors(times)} × noise, and no axis shows where"
    return f"{in_floors(times)} × noise, most along {axis_word(comparison.worst.axis)}"


def bin_means(axes: Axes, split: Split, scale: Scale) -> None:
    """Draw bin means as steps for each direction of motion, on the band that chance gives them."""
    # The load axis is itself a torque and is shown in the unit of torque.
    along = scale.factor if split.axis == "load" else 1.0
    directions = sorted(set(split.direction.tolist()), reverse=True)
    for direction in directions:
        name, color = _SIDES[direction]
        mine = split.direction == direction
        empty = split.count[mine] == 0.0
        borders = along * np.stack([split.low[mine], split.high[mine]], axis=1).ravel()
        band = np.repeat(np.where(empty, np.nan, scale.factor * split.band[mine]), 2)
        mean = np.repeat(np.where(empty, np.nan, scale.factor * split.mean[mine]), 2)
        axes.fill_between(borders, -band, band, color=BAND, alpha=0.45 / len(directions), lw=0)
        axes.plot(borders, mean, color=color, lw=1.1, label=name)
    if split.fails:
        for region in split.regions:
            span = along * region.start, along * region.end
            axes.axvspan(*span, color=WRONG, alpha=0.13, lw=0, zorder=0.4)
            if region.direction:
                # Both directions share the panel: a strip at its edge tells which of them fails.
                low, high = (0.96, 1.0) if region.direction > 0 else (0.0, 0.04)
                axes.axvspan(*span, low, high, color=_SIDES[region.direction][1], lw=0)
    axes.axhline(0.0, color=GREY, lw=0.6, zorder=0.9)
    peak = scale.factor * 1.15 * float(np.max(np.maximum(np.abs(split.mean), split.band), initial=0.0))
    axes.set_ylim(-peak or -1.0, peak or 1.0)
    axes.set_ylabel(f"residual ({scale.unit})")
    if split.axis == "history":
        # The first bin begins at zero, which a logarithmic axis does not have.
        first = float(split.high[split.low == 0.0].min(initial=np.inf))
        axes.set(xscale="log", xlim=(0.5 * first, float(split.high.max())))
    if len(directions) > 1:
        # Beside a title, in a panel that may be narrow.
        short = {"handlelength": 0.9, "handletextpad": 0.4, "columnspacing": 0.8}
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2, **short)


def line_spectrum(axes: Axes, split: Split, scale: Scale) -> None:
    """Draw the RMS residual per frequency bin and the level that chance stays below."""
    middle = 0.5 * (split.low + split.high)
    shown = lines_shown(split)
    usual = split.band if split.band.any() else split.mean
    floor = 0.02 * float(np.median(usual[shown])) if shown.any() else 0.0
    level = np.maximum(split.mean[shown], floor) * scale.factor
    band = split.band[shown] * scale.factor
    if split.band.any():
        axes.fill_between(middle[shown], floor * scale.factor, band, color=BAND, alpha=0.45, lw=0)
    axes.plot(middle[shown], level, color=BLACK, lw=0.7)
    if split.fails:
        for region in split.regions:
            axes.axvspan(
                max(region.start, middle[1] / 2), region.end, color=WRONG, alpha=0.3, lw=0, zorder=0.4
            )
    axes.set_ylabel(f"RMS per bin ({scale.unit})")
    if shown.any():
        axes.set(xscale="log", yscale="log")
        axes.set_xlim(float(middle[shown][0]), float(middle[shown][-1]))


def lines_shown(split: Split) -> npt.NDArray[np.bool_]:
    """Return which frequencies pass the measurement filter; where the noise is not known, which have any."""
    there = split.band > 1e-3 * float(np.max(split.band)) if split.band.any() else split.mean > 0.0
    shown: npt.NDArray[np.bool_] = there & (split.low + split.high > 0.0)
    return shown


def head_of(split: Split, scale: Scale) -> str:
    """Return the name of an axis with its unit."""
    if split.axis == "load":
        return f"modelled {torque_word(split.unit)} ({scale.unit})"
    return f"{axis_word(split.axis)} ({unit_word(split.unit)})"


def _head(axes: Axes, split: Split, scale: Scale, worst: bool) -> None:
    weight = "bold" if worst else "normal"
    axes.set_title(
        f"{axis_tick(split.axis)}: {of_excess(split)}",  # beside a legend; its whole name is below
        color=WRONG if split.fails else BLACK,
        fontweight=weight,
    )
    axes.set_xlabel(head_of(split, scale))
    if worst:
        axes.patch.set_facecolor("#FFF6F0")
        for side in ("left", "right", "top", "bottom"):
            axes.spines[side].set(visible=True, color=WRONG, linewidth=1.8)
