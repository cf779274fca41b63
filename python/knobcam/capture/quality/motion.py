"""Motion columns that are stuck or wrap, and how large one is beside the derivative of another."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, chosen
from ...base.said import Advice, OfColumn, said
from ..finding import Finding, Rows, rows_in_words, spans
from ..formats.units import Coordinate
from .order import quantile, quantiles

MAX_SPREAD = 0.3
"""Interquartile range of that ratio, relative, above which the columns are too noisy to judge."""

_WINDOWS_S = (0.005, 0.02, 0.08, 0.32)  # spans compared: short ones for fast motion, long ones for noise
_SLOWEST_S = 0.02  # between rows, for those spans
_FASTER = (
    4.0  # times the rows of their longest, where a clock is in another unit: the log may be so much faster
)
_MIN_WINDOWS = 20
_ALIKE = 0.5  # correlation over the longest spans, below which a column is no derivative of another
_MANY = 1000  # samples, of which a sensor's differ
_FEW_VALUES = 8
_OTHER = 5.0  # times larger that its integral is: that of noise alone is not


def check_stuck(name: str, values: FloatArray, usable: BoolArray) -> list[Finding]:
    """Return a warning when a column holds one value throughout."""
    held = chosen(values, usable)
    if np.any(held != held[0]):
        return []
    known = {
        "theta": (": nothing moved, so no parameter can be told", None),
        "tau": (": there is no torque to explain", Advice("check the sensor or the map", "columns")),
    }
    left_out = Advice(f"if its sensor was off, leave {name} out and it is derived from theta", "columns")
    why, advice = known.get(name, ("", left_out))
    found = said(
        "{name}: constant at {value:.6g} in all {count} samples{why}",
        name=OfColumn(name),
        value=held[0],
        count=len(held),
        why=why,
    )
    return [Finding("stuck", name, len(held), (), found, "warning", advice)]


def check_few_values(torque: FloatArray, usable: BoolArray) -> list[Finding]:
    """Return a warning when a torque has a few values alone, as one that was asked for and not measured."""
    held = chosen(torque, usable)
    if len(held) < _MANY or len(np.unique(held[:_MANY])) > _FEW_VALUES:
        return []
    values = np.unique(held)
    if not 1 < len(values) <= _FEW_VALUES:
        return []
    found = said(
        "{tau}: has {count} values alone ({values}): it was computed or asked for, and is no measurement",
        count=len(values),
        values=", ".join(f"{value:.4g}" for value in values),
    )
    advice = Advice(
        "map what was measured, or what a motor was given, as tau=... [A], [V] or [duty]", "columns"
    )
    return [Finding("few-values", "tau", len(held), (), found, "warning", advice)]


def check_wrapped(theta: FloatArray, usable: BoolArray, rows: Rows, coordinate: Coordinate) -> list[Finding]:
    """Return a warning when a rotary theta (rad) jumps by most of a turn between neighbours."""
    if coordinate == "linear":
        return []
    jump = np.abs(np.diff(theta)) > math.pi
    at = rows[1:][jump & usable[1:] & usable[:-1]]
    if not at.size or len(at) > len(theta) // 10:
        return []
    found = said("{theta}: jumps by more than half a turn at {rows}", rows=rows_in_words(at))
    advice = Advice("if the angle wraps around, map theta=unwrap(...)", "unwrap")
    return [Finding("wrap", "theta", len(at), spans(at), found, "warning", advice)]


def ratio(
    t: FloatArray, theta: FloatArray, column: FloatArray, order: int, usable: BoolArray
) -> tuple[float | None, bool]:
    """Return the median ratio of `column` to that derivative of `theta`, and whether they are strangers.

    The column is integrated `order` times and its differences over a window compared with those of theta:
    no derivative of a noisy angle is taken. The median over windows with much motion makes the ratio, None
    when it cannot be judged.
    """
    # What lies between rows that count is bridged like what lies between rows: every third may be masked.
    t, theta, column = chosen(t, usable), chosen(theta, usable), chosen(column, usable)
    dt = np.diff(t)
    usual = quantile(dt, 0.5) if len(dt) else 0.0
    if usual <= 0.0:
        return None, False
    broken = ~(dt < 3.0 * usual)
    holes = np.concatenate(([0], np.cumsum(broken)))
    integral = column
    for _ in range(order):
        area = np.where(broken, 0.0, 0.5 * (integral[1:] + integral[:-1]) * dt)
        integral = np.concatenate(([0.0], np.cumsum(area)))

    best: tuple[float, float] | None = None
    apart = False
    # A clock that seems to stand nearly still may be in another unit: the windows are then as many rows.
    slower = max(1.0, usual / _SLOWEST_S)
    windows = _WINDOWS_S if slower == 1.0 else (*_WINDOWS_S, _FASTER * _WINDOWS_S[-1])
    # So may one by which all is over at once.
    quicker = min(1.0, len(t) * usual / (_MIN_WINDOWS * _WINDOWS_S[0]))
    for window in np.multiply(slower * quicker, windows):
        span = max(1, round(window / usual))
        start = np.arange(0, len(t) - order * span, max(1, span // 2))
        start = start[holes[start] == holes[start + order * span]]
        if len(start) < _MIN_WINDOWS:
            break
        wanted, found = (_difference(values, start, span, order) for values in (theta, integral))
        sizes = float(np.linalg.norm(wanted)), float(np.linalg.norm(found))
        alike = abs(float(wanted @ found)) > _ALIKE * sizes[0] * sizes[1]
        apart = not alike and sizes[1] > _OTHER * sizes[0]
        strong = (np.abs(wanted) >= quantile(np.abs(wanted), 0.6)) & (wanted != 0.0)
        if strong.sum() < _MIN_WINDOWS // 4:
            continue
        ratios = found[strong] / wanted[strong]
        low, middle, high = quantiles(ratios, 0.25, 0.5, 0.75)
        if middle != 0.0 and (best is None or (high - low) / abs(middle) < best[0]):
            best = ((high - low) / abs(middle), middle)
    if best is not None and best[0] <= MAX_SPREAD:
        return float(best[1]), False
    return None, apart


def _difference(values: FloatArray, start: NDArray[np.intp], span: int, order: int) -> FloatArray:
    """Return the first or second difference of `values` over `span` samples from each `start`."""
    if order == 1:
        return values[start + span] - values[start]
    return values[start + 2 * span] - 2.0 * values[start + span] + values[start]
