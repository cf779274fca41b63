"""Magnitudes that no knob reaches: a unit that is another than it was taken for."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding
from ..formats.units import Coordinate
from .order import quantile

LARGEST_NM = 1.0
"""Torque (N m) that a hand turning a knob exceeds for a moment at most."""

LARGEST_RAD_S = 120.0
"""Velocity (rad/s) that no hand keeps up, eleven hundred revolutions a minute."""

_MOSTLY = 0.68  # of the samples: a deviation of normal ones, and nothing that few outliers move

_SPAN_S = 0.02  # over which the velocity is read off the angle


def check_size(
    columns: Mapping[str, FloatArray], usable: BoolArray, coordinate: Coordinate, names: Collection[str]
) -> list[Finding]:
    """Return a warning where torque or velocity of a rotary axis, if in `names`, are those of no knob."""
    if coordinate == "linear":
        return []
    findings = []
    usual = quantile(np.abs(columns["tau"][usable]), _MOSTLY)
    if "tau" in names and usual > LARGEST_NM:
        message = (
            f"tau: {usual:.4g} N m is more than hands turn; if it is in mN m, map tau=... [mNm]; "
            "of a larger machine state the unit: tau=... [Nm]"
        )
        findings.append(Finding("unit", "tau", int(usable.sum()), (), message, "warning"))
    t, theta = columns["t"][usable], columns["theta"][usable]
    span = max(1, round(_SPAN_S * len(t) / max(float(t[-1] - t[0]), 1e-9)))
    if "theta" in names and len(t) > span:
        speed = quantile(np.abs((theta[span:] - theta[:-span]) / (t[span:] - t[:-span])), _MOSTLY)
        if speed > LARGEST_RAD_S:
            message = (
                f"theta: {speed:.4g} rad/s is faster than hands turn; if it is in degrees, "
                "map theta=... [deg]; of a motor state the unit: theta=... [rad]"
            )
            findings.append(Finding("unit", "theta", int(usable.sum()), (), message, "warning"))
    return findings
