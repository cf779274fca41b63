"""How a motion begins: a rig starts from rest where the knob stands, and no motion may jump."""

from __future__ import annotations

import math

import numpy as np

from ..capture.motions import MotionTrack

_GENTLE_RAD_S2 = 60.0  # acceleration with which a motion is led in
_SHORTEST_S = 0.1


def led_in(track: MotionTrack, rate_hz: float) -> MotionTrack:
    """Return the motion behind a lead that begins at rest at angle 0 and joins it smoothly.

    The lead is the polynomial of fifth degree with the angle, speed and acceleration of the motion's first
    point at its end, as long as a gentle start takes. Times count on from 0.
    """
    theta, omega, alpha = (float(column[0]) for column in track[1:])
    # To gain speed without going far it has to swing back first, which takes four times as long.
    seconds = 4.0 * (abs(omega) / _GENTLE_RAD_S2 + math.sqrt(abs(theta) / _GENTLE_RAD_S2))
    seconds = max(seconds, _SHORTEST_S)
    points = max(1, math.ceil(seconds * rate_hz))
    length = points / rate_hz
    u = np.arange(points) / points
    # Coefficients of u^3, u^4, u^5 from value, slope and curvature at u = 1; all three are 0 at u = 0.
    p, v, a = theta, omega * length, alpha * length**2
    c = np.array([10.0 * p - 4.0 * v + 0.5 * a, -15.0 * p + 7.0 * v - a, 6.0 * p - 3.0 * v + 0.5 * a])
    powers = np.array([3.0, 4.0, 5.0])
    lead = (c * u[:, None] ** powers).sum(1)
    speed = (c * powers * u[:, None] ** (powers - 1.0)).sum(1) / length
    curve = (c * powers * (powers - 1.0) * u[:, None] ** (powers - 2.0)).sum(1) / length**2
    columns = [np.concatenate(pair) for pair in zip((lead, speed, curve), track[1:], strict=True)]
    return MotionTrack(np.arange(len(columns[0])) / rate_hz, *columns)
