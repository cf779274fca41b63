"""Motion columns that contradict each other: stuck, wrapped, in another unit than they say."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding, Rows, rows_in_words, spans
from ..formats.units import SI, Coordinate
from .order import quantile

AGREEMENT = (0.8, 1.25)
"""Ratio of a derivative's column to the derivative of theta that passes as the same unit."""

MAX_SPREAD = 0.3
"""Interquartile range of that ratio, relative, above which the columns are too noisy to judge."""

_WINDOWS_S = (0.005, 0.02, 0.08, 0.32)  # spans compared: short ones for fast motion, long ones for noise
_MIN_WINDOWS = 20
_ALIKE = 0.5  # correlation over the longest spans, below which a column is no derivative of another
_OTHER = 5.0  # times larger that its integral is: that of noise alone is not

_FACTORS: dict[Coordinate, dict[float, str]] = {
    "linear": {1e3: "thousandths", 1e6: "millionths"},
    "rotary": {
        1e3: "thousandths",
        1e6: "millionths",
        180 / math.pi: "degrees",
        1 / (2 * math.pi): "turns",
        60 / (2 * math.pi): "rpm",
    },
}


def check_stuck(name: str, values: FloatArray, usable: BoolArray) -> list[Finding]:
    """Return a warning when a column holds one value throughout."""
    held = values[usable]
    if np.any(held != held[0]):
        return []
    remedy = {
        "theta": "nothing moved, so no parameter can be told",
        "tau": "there is no torque to explain; check the sensor or the map",
    }.get(name, f"if its sensor was off, leave {name} out and it is derived from theta")
    message = f"{name}: constant at {held[0]:.6g} in all {len(held)} samples: {remedy}"
    return [Finding("stuck", name, len(held), (), message, "warning")]


def check_wrapped(theta: FloatArray, usable: BoolArray, rows: Rows, coordinate: Coordinate) -> list[Finding]:
    """Return a warning when a rotary theta (rad) jumps by most of a turn between neighbours."""
    if coordinate == "linear":
        return []
    jump = np.abs(np.diff(theta)) > math.pi
    at = rows[1:][jump & usable[1:] & usable[:-1]]
    if not at.size or len(at) > len(theta) // 10:
        return []
    message = (
        f"theta: jumps by more than half a turn at {rows_in_words(at)}; "
        f"if the angle wraps around, map theta=unwrap(...)"
    )
    return [Finding("wrap", "theta", len(at), spans(at), message, "warning")]


def check_scale(
    t: FloatArray,
    theta: FloatArray,
    column: FloatArray,
    order: int,
    usable: BoolArray,
    coordinate: Coordinate,
) -> list[Finding]:
    """Return a warning when omega (`order` 1) or alpha (2) is not that derivative of theta.

    The column is integrated `order` times and its differences over a window compared with those of theta:
    no derivative of a noisy angle is taken. The median over windows with much motion makes the ratio.
    """
    name = "omega" if order == 1 else "alpha"
    derivative = "d theta/dt" if order == 1 else "d2 theta/dt2"
    ratio, apart = _ratio(t, theta, column, order, usable)
    if order == 1 and apart:
        message = f"{name}: has nothing to do with {derivative}; check which column is which in the map"
        return [Finding("contradiction", name, int(usable.sum()), (), message, "warning")]
    if ratio is None or AGREEMENT[0] <= ratio <= AGREEMENT[1]:
        return []
    if -AGREEMENT[1] <= ratio <= -AGREEMENT[0]:
        kind, reason = "sign", "its sign is reversed, map it with a minus"
    else:
        kind, reason = "unit", _likely(name, abs(ratio), coordinate)
    message = f"{name}: {ratio:.4g} times {derivative}: {reason}; nothing is changed"
    return [Finding(kind, name, int(usable.sum()), (), message, "warning")]


def _likely(name: str, ratio: float, coordinate: Coordinate) -> str:
    """Return the unit that would explain `ratio`, within the agreement that passes as equal."""
    unit = SI[coordinate][name]
    known = [
        (factor, f"the column may be in {word} where {unit} is expected")
        for factor, word in _FACTORS[coordinate].items()
    ]
    known += [
        (1 / factor, f"theta may be in {word} where {SI[coordinate]['theta']} is expected")
        for factor, word in _FACTORS[coordinate].items()
    ]
    factor, reason = min(known, key=lambda pair: abs(math.log(pair[0] / ratio)))
    if AGREEMENT[0] <= ratio / factor <= AGREEMENT[1]:
        return f"near {factor:.4g}, so {reason} (or t is not in s)"
    return "check the units in the map"


def _ratio(
    t: FloatArray, theta: FloatArray, column: FloatArray, order: int, usable: BoolArray
) -> tuple[float | None, bool]:
    """Return the median ratio of `column` to the derivative of `theta`, and whether they are strangers.

    The ratio is None when it cannot be judged.
    """
    dt = np.diff(t)
    broken = ~(usable[1:] & usable[:-1])
    usual = quantile(dt[~broken], 0.5) if not broken.all() else 0.0
    if usual <= 0.0:
        return None, False
    broken |= ~(dt < 3.0 * usual)
    holes = np.concatenate(([0], np.cumsum(broken)))
    integral = np.where(usable, column, 0.0)
    for _ in range(order):
        area = np.where(broken, 0.0, 0.5 * (integral[1:] + integral[:-1]) * dt)
        integral = np.concatenate(([0.0], np.cumsum(area)))

    best: tuple[float, float] | None = None
    apart = False
    for window in _WINDOWS_S:
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
        low, middle, high = (quantile(ratios, share) for share in (0.25, 0.5, 0.75))
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
