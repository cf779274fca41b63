"""Pictures of a batch: verdicts by lot, hints, parameters over captures, torque-angle curves, charts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .style import (
    BACKWARD,
    BLUE,
    FORWARD,
    GREEN,
    GREY,
    PALE,
    SKY,
    WRONG,
    YELLOW,
    Picture,
    legend_above,
    motion_units,
    plain,
    styled,
    torque_scale,
    torque_word,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...base.arrays import BoolArray, FloatArray, IntArray
    from ...fleet import BatchResult

_ACROSS = 3  # pictures in a row
_MOST_CURVES = 400
_FULL = 10.0  # standard errors at which a colour is full
_SAID = {
    "complete": ("complete", BLUE),
    "missing": ("missing", GREEN),
    "unexplained": ("unexplained", WRONG),
    "not_weighed": ("more than chance, not learned", YELLOW),
    "error": ("not read", GREY),
}


@styled
def batch(result: BatchResult) -> Picture:
    """Verdicts of each lot, and how often each effect was found missing."""
    lots = sorted({row["lot"] or "" for row in result.rows})
    figure = Picture(12.0, max(2.6, 1.6 + 0.35 * max(len(lots), len(result.found))), result.headline)
    left, right = figure.subplots(1, 2)
    before = np.zeros(len(lots))
    for kind, (label, colour) in _SAID.items():
        count = [sum(_kind(row) == kind and (row["lot"] or "") == lot for row in result.rows) for lot in lots]
        if any(count):
            left.barh([_lot(lot) for lot in lots], count, left=before, color=colour, label=label, height=0.7)
            before += count
    left.invert_yaxis()
    left.set_xlabel("captures")
    left.grid(axis="y", visible=False)
    legend_above(left)
    names = list(result.found)
    right.barh(names, [result.found[name] for name in names], color=GREEN, height=0.7)
    right.invert_yaxis()
    right.set_xlabel("captures in which it was missing")
    right.grid(axis="y", visible=False)
    if not names:
        right.text(
            0.5, 0.5, "no effect was found missing", transform=right.transAxes, ha="center", color=GREY
        )
        right.set_yticks([])
    return figure


@styled
def batch_hints(result: BatchResult) -> Picture:
    """Effects over lots: how much more each lot has of what single captures may not show."""
    every, said = result.study.held, result.study.pooled
    lots = list(dict.fromkeys(result.study.table["lot"]))
    names = sorted({one.effect for one in every})
    score = np.full((len(names), len(lots)), np.nan)
    figure = Picture(
        max(6.0, 3.5 + 0.9 * len(lots)),
        1.6 + 0.24 * len(names),
        "What lots have more or less of than the first, by all their captures",
    )
    axes = figure.subplots()
    named = {
        (one.than if one.lot == lots[0] and one.than is not None else one.lot, one.effect) for one in said
    }
    for one in every:
        row, column = names.index(one.effect), lots.index(one.lot)
        score[row, column] = one.score
        if one.sure:
            axes.text(
                column,
                row,
                f"{one.score:+.1f}",
                ha="center",
                va="center",
                fontsize=8.0,
                weight="bold" if (one.lot, one.effect) in named else "normal",
                color="white" if abs(one.score) > 0.6 * _FULL else "black",
            )
    image = axes.imshow(score, cmap="RdBu_r", vmin=-_FULL, vmax=_FULL, aspect="auto")
    bar = figure.colorbar(image, ax=axes)
    bar.set_label("standard errors; a number: beyond chance")
    axes.set_yticks(range(len(names)), names)
    axes.set_xticks(range(len(lots)), [_lot(lot) for lot in lots], rotation=0 if len(lots) <= 8 else 90)
    axes.grid(visible=False)
    return figure


def _kind(row: dict[str, object]) -> str:
    if row["error"] is not None:
        return "error"
    return str(row["verdict"] or "not_weighed")


def _lot(lot: str) -> str:
    return plain(lot, 24) if lot else "no lot"


@styled
def batch_parameters(result: BatchResult) -> Picture:
    """Each parameter over the captures as they were made, lots apart, beside its limits."""
    study = result.study
    names = list(study.units)
    figure, grid = _grid(len(names), "Parameters over the captures, lot by lot; bars are 95 % intervals")
    table = study.table
    at = np.arange(len(table))
    rows = {row["capture"]: row for row in result.rows}
    bad = table["ok"].eq(False).to_numpy(dtype=bool)
    for axes, name in zip(grid, names, strict=False):
        value = table[name].to_numpy(dtype=float)
        ends = np.array(
            [rows[one]["params"].get(name, [None] * 3)[1:] for one in table["capture"]], dtype=float
        )
        axes.vlines(at, ends[:, 0], ends[:, 1], color=PALE, lw=1.0)
        _dots(axes, at, value, bad)
        held = result.drawn.of(name) if result.drawn is not None else None
        for edge in () if held is None else (held.low, held.high):
            if math.isfinite(edge):
                axes.axhline(edge, color=WRONG, lw=1.0, ls="--")
        _lots(axes, table["lot"].tolist())
        axes.set_title(f"{name} ({study.units[name]})")
    return figure


@styled
def batch_charts(result: BatchResult) -> Picture:
    """Control charts: the exponentially weighted mean of each parameter beside what chance allows it."""
    study = result.study
    figure, grid = _grid(
        len(study.charts), "Control charts: the moving mean (EWMA, λ = 0.2) stays in the band by chance"
    )
    for axes, one in zip(grid, study.charts, strict=False):
        at = np.arange(len(one.values))
        axes.plot(at, one.values, ".", color=PALE, ms=4.0)
        axes.fill_between(at, one.middle - one.half, one.middle + one.half, color=SKY, alpha=0.3, lw=0)
        axes.plot(at, one.mean, color=BLUE)
        out = one.out
        axes.plot(at[out], one.mean[out], "o", color=WRONG, ms=3.5)
        _lots(axes, study.table["lot"].tolist())
        axes.set_title(f"{one.parameter} ({study.units[one.parameter]})")
    return figure


@styled
def batch_curves(result: BatchResult) -> Picture:
    """Torque over the angle of all captures by direction, those that are not OK on top, with their bands."""
    some = [row for row in result.rows if row["curve"] is not None]
    kinds = [(row["coordinate"], row["unit"]) for row in some]
    most = max(sorted(set(kinds)), key=kinds.count)
    some = [row for row, kind in zip(some, kinds, strict=True) if kind == most]
    coordinate, unit = most
    some = some[:: max(1, len(some) // _MOST_CURVES)]
    every = np.array([row["curve"][way] for row in some for way in ("forward", "backward")], dtype=float)
    scale = torque_scale(unit, float(np.nanmax(np.abs(every), initial=0.0)))
    figure = Picture(12.0, 4.2, "Torque-angle curves, without what accelerates the inertia")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, way, colour in zip(panels, ("forward", "backward"), (FORWARD, BACKWARD), strict=True):
        for row in sorted(some, key=lambda one: one["ok"] is False or bool(one["outlier"])):
            odd = row["ok"] is False or bool(row["outlier"])
            torque = np.array(row["curve"][way], dtype=float) * scale.factor
            axes.plot(
                row["curve"]["theta"],
                torque,
                color=WRONG if odd else colour,
                lw=0.7,
                alpha=0.9 if odd else 0.35,
            )
        for band in result.drawn.bands() if result.drawn is not None else ():
            if band.direction == way:
                for edge in (band.low, band.high):
                    axes.plot(band.theta, np.array(edge) * scale.factor, color=WRONG, lw=1.2, ls="--")
        axes.set_title(way)
        axes.set_xlabel(f"position ({motion_units(coordinate)['theta']})")
    panels[0].set_ylabel(f"{torque_word(unit)} ({scale.unit})")
    return figure


def _grid(count: int, title: str) -> tuple[Picture, list[Axes]]:
    rows = max(1, math.ceil(count / _ACROSS))
    figure = Picture(13.0, 0.7 + 2.4 * rows, title)
    return figure, [figure.add_subplot(rows, _ACROSS, at + 1) for at in range(count)]


def _dots(axes: Axes, at: IntArray, value: FloatArray, bad: BoolArray) -> None:
    axes.plot(at[~bad], value[~bad], ".", color=BLUE, ms=4.0)
    axes.plot(at[bad], value[bad], "x", color=WRONG, ms=5.0)
    middle = np.nanmedian(value)
    spread = np.nanquantile(np.abs(value - middle), 0.95) or abs(middle) or 1.0
    low, high = np.nanmin(value), np.nanmax(value)
    axes.set_ylim(min(low, middle - 1.5 * spread), max(high, middle + 1.5 * spread))


def _lots(axes: Axes, lots: list[str]) -> None:
    """Mark where one lot ends and the next one begins, by name where there is room."""
    starts = [at for at in range(len(lots)) if at == 0 or lots[at] != lots[at - 1]]
    for start in starts[1:]:
        axes.axvline(start - 0.5, color=GREY, lw=0.8)
    if len(starts) <= 12:
        axes.set_xticks(starts, [_lot(lots[at]) for at in starts])
    axes.grid(axis="x", visible=False)
