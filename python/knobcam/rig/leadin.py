"""How a motion begins: a rig starts from rest where the knob stands, and no motion may jump."""

from __future__ import annotations

import math

import numpy as np

from ..capture.motion_plan import Move
from ..capture.motions import MotionTrack

_GENTLE_RAD_S2 = 60.0  # acceleration with which a motion is led in
_SHORTEST_S = 0.1
_SLOW_RAD_S, _SLOW_RAD_S2 = 1.0, 10.0  # with which a knob is brought to where a motion begins


def way(to: float, rate_hz: float, speed: float = math.inf, gain: float = math.inf) -> MotionTrack:
    """Return the slow way from rest at 0 to rest at an angle, at most at `speed`, with `gain` (rad/s^2)."""
    move = Move(to, min(speed, _SLOW_RAD_S), min(gain, _SLOW_RAD_S2))
    t = np.arange(math.ceil(move.seconds(0.0) * rate_hz)) / rate_hz
    return MotionTrack(t, *move.along(t, 0.0))


def behind(before: MotionTrack, track: MotionTrack, at: float, rate_hz: float) -> MotionTrack:
    """Return a motion behind another one that ends at rest at angle `at`; times count on from 0."""
    pairs = zip(before[1:], (at + track.theta, track.omega, track.alpha), strict=True)
    columns = [np.concatenate(pair) for pair in pairs]
    return MotionTrack(np.arange(len(columns[0])) / rate_hz, *columns)


def there_and_back(track: MotionTrack, rate_hz: float) -> MotionTrack:
    """Return a motion from rest to rest with the way from angle 0 to its beginning, and the way back."""
    start, end = float(track.theta[0]), float(track.theta[-1])
    led = led_in(track._replace(theta=track.theta - start), rate_hz)
    whole = behind(way(start, rate_hz), led, start, rate_hz)
    return behind(whole, way(-end, rate_hz), end, rate_hz)


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
