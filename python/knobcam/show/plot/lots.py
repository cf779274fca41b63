"""Pictures of a batch: verdicts by lot, hints, parameters over captures, torque-angle curves, charts."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .style import (
    BACKWARD,
    BLACK,
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
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from ...base.arrays import FloatArray
    from ...fleet import BatchResult

_ACROSS = 3  # pictures in a row
_MOST_CURVES = 400
_FULL = 10.0  # standard errors at which a colour is full
_MOST_LOTS, _WIDEST, _NUMBERED, _TICKS = 20, 14.0, 12, 12  # lots that are told apart, inches, lots
_FAR = 4.0  # widths of what is usual: a limit beyond would flatten all the rest
_ROOM = 0.15  # of a picture, above and below
_DOTS = 1000  # captures, of which more are one image, and not a mark each, in a page
_NAMED = 3  # of what lies beyond the edge of a picture
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
    lots, names = _worst(result), list(result.found)
    called = [f"{lot} ({len(some)})" for lot, some in lots.items()]
    figure = Picture(12.0, max(2.6, 1.6 + 0.35 * max(len(lots), len(names))), result.headline)
    left, right = figure.subplots(1, 2)
    before = np.zeros(len(lots))
    for kind, (label, colour) in _SAID.items():
        share = _shares(lots, partial(_is, kind))
        if share.any():
            left.barh(called, share, left=before, color=colour, label=label, height=0.7)
            before += share
    bad = _shares(lots, lambda row: row["ok"] is False)
    if bad.any():
        left.barh(called, bad, color=BLACK, label="not OK", height=0.2)
    left.invert_yaxis()
    left.set_xlabel("% of the captures of a lot, whose number stands beside its name")
    left.grid(axis="y", visible=False)
    legend_above(left)
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


def _worst(result: BatchResult) -> dict[str, list[dict[str, Any]]]:
    """Return the rows of each lot by what it is called; of many lots, of those with most that is not well."""
    lots: dict[str, list[dict[str, Any]]] = {}
    for row in result.counted:
        lots.setdefault(row["lot"] or "", []).append(row)
    well = _shares(lots, lambda row: row["ok"] is not False and _kind(row) == "complete")
    worst = sorted(zip(well, lots, strict=True))[:_MOST_LOTS]
    told = sorted(lot for _, lot in worst)
    found = {_lot(lot): lots[lot] for lot in told}
    if others := [lot for lot in lots if lot not in told]:
        found[f"{len(others)} other lots"] = [row for lot in others for row in lots[lot]]
    return found


def _shares(lots: dict[str, list[dict[str, Any]]], has: Callable[[dict[str, Any]], bool]) -> FloatArray:
    """Return which share of each lot's captures has something, per cent."""
    return np.array([100.0 * sum(map(has, some)) / len(some) for some in lots.values()])


@styled
def batch_hints(result: BatchResult) -> Picture:
    """Effects over lots: how much more each lot has of what single captures may not show."""
    every, said = result.study.held, result.study.pooled
    lots = list(dict.fromkeys(result.study.table["lot"]))
    names = sorted({one.effect for one in every})
    score = np.full((len(names), len(lots)), np.nan)
    figure = Picture(
        min(max(6.0, 3.5 + 0.9 * len(lots)), _WIDEST),
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
        if one.sure and len(lots) > _NUMBERED:
            mark = "D" if (one.lot, one.effect) in named else "."
            axes.plot(column, row, mark, color="white" if abs(one.score) > 0.6 * _FULL else "black", ms=4.0)
        elif one.sure:
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
    mark = "a number: beyond chance" if len(lots) <= _NUMBERED else "dot: beyond chance\ndiamond: named"
    bar.set_label(f"standard errors\n{mark}")
    axes.set_yticks(range(len(names)), names)
    at = range(0, len(lots), math.ceil(len(lots) / _MOST_LOTS))
    axes.set_xticks(at, [_lot(lots[one]) for one in at], rotation=0 if len(lots) <= 8 else 90)
    axes.grid(visible=False)
    return figure


def _kind(row: dict[str, object]) -> str:
    if row["error"] is not None:
        return "error"
    return str(row["verdict"] or "not_weighed")


def _is(kind: str, row: dict[str, Any]) -> bool:
    return _kind(row) == kind


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
    thick = len(table) > _DOTS
    for axes, name in zip(grid, names, strict=False):
        value = table[name].to_numpy(dtype=float)
        ends = np.array(
            [rows[one]["params"].get(name, [None] * 3)[1:] for one in table["capture"]], dtype=float
        )
        held = result.drawn.of(name) if result.drawn is not None else None
        edges = [] if held is None else [one for one in (held.low, held.high) if math.isfinite(one)]
        axes.vlines(at, ends[:, 0], ends[:, 1], color=PALE, lw=1.0, rasterized=thick)
        axes.plot(at[~bad], value[~bad], ".", color=BLUE, ms=2.0 if thick else 4.0, rasterized=thick)
        axes.plot(at[bad], value[bad], "x", color=WRONG, ms=5.0, rasterized=thick)
        wide = np.abs(ends - value[:, np.newaxis])
        half = float(np.median(wide[np.isfinite(wide)])) if np.isfinite(wide).any() else 0.0
        low, high = study.ordinary(name)
        low, high = _range(low - half, high + half, edges)
        axes.set_ylim(low, high)
        for edge in edges:
            _limit(axes, edge, low, high)
        _beyond(axes, value, table["capture"].tolist(), low, high)
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
        axes.plot(at, one.values, ".", color=PALE, ms=4.0, rasterized=len(at) > _DOTS)
        axes.fill_between(at, one.middle - one.half, one.middle + one.half, color=SKY, alpha=0.3, lw=0)
        axes.plot(at, one.mean, color=BLUE)
        out = one.out
        axes.plot(at[out], one.mean[out], "o", color=WRONG, ms=3.5)
        seen = [*study.ordinary(one.parameter), *(one.middle - one.half), *(one.middle + one.half)]
        low, high = _range(float(np.nanmin(seen)), float(np.nanmax(seen)), [])
        axes.set_ylim(low, high)
        _beyond(axes, one.values, study.table["capture"].tolist(), low, high)
        _lots(axes, study.table["lot"].tolist())
        axes.set_title(f"{one.parameter} ({study.units[one.parameter]})")
    return figure


@styled
def batch_curves(result: BatchResult) -> Picture:
    """Torque over the angle of all captures by direction, those that are not OK on top, with their bands."""
    some = [row for row in result.counted if row["curve"] is not None]
    kinds = [(row["coordinate"], row["unit"]) for row in some]
    coordinate, unit = most = max(sorted(set(kinds)), key=kinds.count)
    some = [row for row, kind in zip(some, kinds, strict=True) if kind == most]
    odd = [row for row in some if row["ok"] is False or row["outlier"]]
    like = [row for row in some if not (row["ok"] is False or row["outlier"])]
    like, odd = (each[:: 1 + len(each) // _MOST_CURVES] for each in (like, odd))
    bands = result.drawn.bands() if result.drawn is not None else []
    ends = [value for band in bands for value in (*band.low, *band.high)]
    ways = ("forward", "backward")
    usual = np.array([row["curve"][way] for row in like or odd for way in ways], dtype=float)
    least, most_ = (float(f([*usual[np.isfinite(usual)], *ends])) for f in (np.min, np.max))
    scale = torque_scale(unit, max(abs(least), abs(most_)))
    figure = Picture(12.0, 4.2, "Torque-angle curves, without what accelerates the inertia")
    panels = figure.subplots(1, 2, sharey=True)
    low, high = (scale.factor * one for one in _range(least, most_, []))
    panels[0].set_ylim(low, high)
    for axes, way, colour in zip(panels, ways, (FORWARD, BACKWARD), strict=True):
        for row in (*like, *odd):
            is_odd = row["ok"] is False or bool(row["outlier"])
            torque = np.array(row["curve"][way], dtype=float) * scale.factor
            how = {"color": WRONG if is_odd else colour, "lw": 0.7, "alpha": 0.9 if is_odd else 0.35}
            axes.plot(row["curve"]["theta"], torque, **how)
        peaks = [_peak(np.array(row["curve"][way], dtype=float) * scale.factor, low, high) for row in odd]
        where = [row["curve"]["theta"][at] for row, (at, _) in zip(odd, peaks, strict=True)]
        values = np.array([value for _, value in peaks])
        _beyond(axes, values, [row["capture"] for row in odd], low, high, np.array(where))
        for band in bands:
            if band.direction == way:
                for edge in (band.low, band.high):
                    axes.plot(band.theta, np.array(edge) * scale.factor, color=WRONG, lw=1.2, ls="--")
        axes.set_title(way)
        axes.set_xlabel(f"position ({motion_units(coordinate)['theta']})")
    panels[0].set_ylabel(f"{torque_word(unit)} ({scale.unit})")
    return figure


def _peak(torque: FloatArray, low: float, high: float) -> tuple[int, float]:
    """Return where a curve is farthest beyond a range, and its torque there."""
    beyond = np.nan_to_num(np.maximum(torque - high, low - torque), nan=-np.inf)
    at = int(np.argmax(beyond))
    return at, float(torque[at])


def _range(low: float, high: float, edges: list[float]) -> tuple[float, float]:
    """Return what a picture shows: what is usual, with room about it, and limits unless they are far away."""
    size = (high - low) or abs(high) or 1.0
    for edge in edges:
        if min(abs(edge - low), abs(edge - high)) <= _FAR * size:
            low, high = min(low, edge), max(high, edge)
    room = _ROOM * ((high - low) or size)
    return low - room, high + room


def _limit(axes: Axes, edge: float, low: float, high: float) -> None:
    """Draw a limit; one that lies beyond the picture is said at its edge."""
    if low <= edge <= high:
        axes.axhline(edge, color=WRONG, lw=1.0, ls="--")
        return
    above = edge > high
    axes.text(
        0.99,
        0.97 if above else 0.03,
        f"limit {edge:.4g}, far {'above' if above else 'below'}",
        transform=axes.transAxes,
        ha="right",
        va="top" if above else "bottom",
        color=WRONG,
        fontsize=7.0,
    ).set_in_layout(False)


def _beyond(
    axes: Axes, value: FloatArray, names: list[str], low: float, high: float, at: FloatArray | None = None
) -> None:
    """Mark at the edge of a picture what lies beyond it, the farthest with value and name."""
    where = np.arange(len(value)) if at is None else at
    for some, edge, mark, way in ((value > high, high, "^", -1.0), (value < low, low, "v", 1.0)):
        if not some.any():
            continue
        axes.plot(where[some], np.full(int(some.sum()), edge), mark, color=WRONG, ms=5.0, clip_on=False)
        far = sorted(np.flatnonzero(some), key=lambda one: -abs(value[one] - edge))
        lines = [f"{_short(names[one])}: {value[one]:.3g}" for one in far[:_NAMED]]
        if len(far) > _NAMED:
            lines.append(f"and {len(far) - _NAMED} more")
        left = where[far[0]] < np.mean(axes.get_xlim())
        axes.annotate(
            "\n".join(lines),
            (where[far[0]], edge),
            xytext=(6.0 if left else -6.0, 4.0 * way),
            textcoords="offset points",
            ha="left" if left else "right",
            va="top" if way < 0.0 else "bottom",
            color=WRONG,
            fontsize=7.0,
        ).set_in_layout(False)


def _short(name: str) -> str:
    """Return the end of a capture's name, which tells it from its neighbours."""
    return plain("/".join(name.split("/")[-3:]), 32)


def _grid(count: int, title: str) -> tuple[Picture, list[Axes]]:
    rows = max(1, math.ceil(count / _ACROSS))
    figure = Picture(13.0, 0.7 + 2.4 * rows, title)
    return figure, [figure.add_subplot(rows, _ACROSS, at + 1) for at in range(count)]


def _lots(axes: Axes, lots: list[str]) -> None:
    """Mark where one lot ends and the next one begins, by as many names as there is room for."""
    starts = [at for at in range(len(lots)) if at == 0 or lots[at] != lots[at - 1]]
    told = starts[:: math.ceil(len(starts) / _TICKS)]
    for start in told[1:]:
        axes.axvline(start - 0.5, color=GREY, lw=0.8)
    axes.set_xticks(told, [_lot(lots[at]) for at in told], rotation=0 if len(told) <= 5 else 90)
    axes.grid(axis="x", visible=False)
