"""Magnitudes that no knob reaches: a unit that is another than it was taken for."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding
from ..formats.units import Coordinate

LARGEST_NM = 1.0
"""RMS torque (N m) beyond what a hand turns; a hand gives about 5 N m at the most, for a moment."""

LARGEST_RAD_S = 100.0
"""RMS velocity (rad/s), a thousand revolutions a minute."""

_SPAN_S = 0.02  # over which the velocity is read off the angle


def check_size(columns: dict[str, FloatArray], usable: BoolArray, coordinate: Coordinate) -> list[Finding]:
    """Return a warning where torque or velocity of a rotary axis are those of no knob."""
    if coordinate == "linear":
        return []
    findings = []
    rms = float(np.sqrt(np.mean(np.square(columns["tau"][usable]))))
    if rms > LARGEST_NM:
        message = (
            f"tau: {rms:.4g} N m RMS is more than hands turn; if it is in mN m, map tau=... [mNm]; "
            "of a larger machine state the unit: tau=... [Nm]"
        )
        findings.append(Finding("unit", "tau", int(usable.sum()), (), message, "warning"))
    t, theta = columns["t"][usable], columns["theta"][usable]
    span = max(1, round(_SPAN_S * len(t) / max(float(t[-1] - t[0]), 1e-9)))
    if len(t) > span:
        speed = float(np.sqrt(np.mean(np.square((theta[span:] - theta[:-span]) / (t[span:] - t[:-span])))))
        if speed > LARGEST_RAD_S:
            message = (
                f"theta: {speed:.4g} rad/s RMS is faster than hands turn; if it is in degrees, "
                "map theta=... [deg]; of a motor state the unit: theta=... [rad]"
            )
            findings.append(Finding("unit", "theta", int(usable.sum()), (), message, "warning"))
    return findings
