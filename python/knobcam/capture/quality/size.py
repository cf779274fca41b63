"""Magnitudes that no knob reaches: a unit that is another than it was taken for."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from ...base.arrays import BoolArray, FloatArray, chosen
from ...base.said import Advice, number, said
from ..finding import Finding
from ..formats.units import Coordinate
from .order import quantile, quantiles

LARGEST_NM = 1.0
"""Torque (N m) that a hand turning a knob exceeds for a moment at most."""

LARGEST_RAD_S = 120.0
"""Velocity (rad/s) that no hand keeps up, eleven hundred revolutions a minute."""

_MOSTLY = 0.68  # of the samples: a deviation of normal ones, and nothing that few outliers move

_MOMENTS = 0.99  # of the samples: all but the fastest moments, and single readings that are wrong

_REACH_RAD = 16.0 * math.pi  # eight turns: several times what hands turn a knob before they turn it back

_AGAIN = 1.5  # times its range that an angle goes to and fro

_BITS = range(8, 25)  # of encoders

_EXACT = 1e-4  # bits, within which the counts of a turn are a power of two: chance is so in one of 5000

_FEWEST = 100  # steps, of which all have to be whole

_SPAN_S = 0.02  # over which the velocity is read off the angle


def check_size(
    columns: Mapping[str, FloatArray], usable: BoolArray, coordinate: Coordinate, names: Collection[str]
) -> list[Finding]:
    """Return a warning where torque or velocity of a rotary axis, if in `names`, are those of no knob."""
    if coordinate == "linear":
        return []
    findings = []
    usual = quantile(np.abs(chosen(columns["tau"], usable)), _MOSTLY)
    if "tau" in names and usual > LARGEST_NM:
        found = said("{tau}: {usual} is more than hands turn", usual=number(usual, "N m"))
        advice = Advice(
            "if it is in mN m, map tau=... [mNm]; of a larger machine state the unit: tau=... [Nm]", "unit"
        )
        findings.append(Finding("unit", "tau", int(usable.sum()), (), found, "warning", advice))
    if "theta" in names:
        t, theta = chosen(columns["t"], usable), chosen(columns["theta"], usable)
        reason = _counts_of_degrees(theta) or _faster_than_hands(t, theta)
        if reason:
            found = said("{theta}: {reason}", reason=reason[0])
            advice = Advice(reason[1], "unit")
            findings.append(Finding("unit", "theta", int(usable.sum()), (), found, "warning", advice))
    return findings


def _faster_than_hands(t: FloatArray, theta: FloatArray) -> tuple[str, str] | None:
    """Say that no hand turns so fast all the time, or for a moment that far to and fro; and what to do."""
    span = max(1, round(_SPAN_S * len(t) / max(float(t[-1] - t[0]), 1e-9)))
    if len(t) <= span:
        return None
    speeds = np.abs((theta[span:] - theta[:-span]) / (t[span:] - t[:-span]))
    usual, most = quantiles(speeds, _MOSTLY, _MOMENTS)
    remedy = "if it is in degrees, map theta=... [deg]; of a motor state the unit: theta=... [rad]"
    if usual > LARGEST_RAD_S:
        return f"{usual:.4g} rad/s is faster than hands turn", remedy
    wide = float(np.ptp(theta))
    to_and_fro = float(np.sum(np.abs(np.diff(theta[::span])))) >= _AGAIN * wide
    if most > LARGEST_RAD_S and wide > _REACH_RAD and to_and_fro:
        turns = wide / math.tau
        return f"{most:.4g} rad/s to and fro over {turns:.3g} turns is more than hands do", remedy
    return None


def _counts_of_degrees(theta: FloatArray) -> tuple[str, str] | None:
    """Say that the angle's steps are those of a binary encoder in degrees, which in radians none has."""
    step = np.abs(np.diff(theta))
    moved = step[step > 0.0]
    if not moved.size:
        return None
    least = float(moved.min())
    bits = math.log2(360.0) - math.log2(least)
    exact = abs(bits - round(bits)) < _EXACT and round(bits) in _BITS
    if not (exact and len(moved) > _FEWEST):
        return None
    if not (np.abs(moved / least - np.rint(moved / least)) < 0.01).all():
        return None
    return (
        f"its steps of {least:.6g} are 360/{2 ** round(bits)}, so it is in degrees",
        "map theta=... [deg], or theta=... [rad] if it is not",
    )
