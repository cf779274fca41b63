"""Four ways to turn a knob, each with its exact velocity and acceleration."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Floats = np.ndarray[tuple[int], np.dtype[np.float64]]


class Track(NamedTuple):
    """The motion of the shaft; arrays of shape (samples,), SI."""

    t: Floats
    theta: Floats
    omega: Floats
    alpha: Floats


def chirp(rng: np.random.Generator, t: Floats) -> Track:
    """A sine whose frequency grows linearly."""
    low, high = rng.uniform(0.1, 0.4), rng.uniform(1.2, 2.8)
    rate = (high - low) / t[-1]
    phase = rng.uniform(0.0, 2.0 * np.pi) + 2.0 * np.pi * (low * t + rate * t**2 / 2.0)
    first, second = 2.0 * np.pi * (low + rate * t), 2.0 * np.pi * rate
    amplitude = rng.uniform(0.5, 1.8)
    sin, cos = amplitude * np.sin(phase), amplitude * np.cos(phase)
    return Track(t, sin, first * cos, second * cos - first**2 * sin)


def multisine(rng: np.random.Generator, t: Floats) -> Track:
    """Many sines with random phases, the higher the smaller."""
    orders = np.arange(1, round(rng.uniform(15, 27)))
    w = 2.0 * np.pi * orders / (t[-1] + t[1])
    return _scaled(_sines(t, w, rng.uniform(0.0, 2.0 * np.pi, len(w)), 1.0 / orders), rng.uniform(0.6, 1.1))


def turns(rng: np.random.Generator, t: Floats) -> Track:
    """Long turns both ways at a nearly constant speed, on which faster and slower stretches are laid."""
    w, phase = 2.0 * np.pi * rng.uniform(0.15, 0.45), rng.uniform(0.0, 2.0 * np.pi)
    square, fast = rng.uniform(0.8, 2.5), rng.uniform(4.0, 12.0)
    sin, cos = np.sin(w * t + phase), np.cos(w * t + phase)
    # tanh(s sin) is a square wave with round corners.
    bent = np.tanh(square * sin)
    omega = fast * bent / np.tanh(square)
    alpha = fast / np.tanh(square) * (1.0 - bent**2) * square * w * cos
    ripple = rng.uniform(0.15, 0.45) * fast
    v, turn = 2.0 * np.pi * rng.uniform(1.2, 3.0), rng.uniform(0.0, 2.0 * np.pi)
    omega = omega + ripple * np.sin(v * t + turn)
    alpha = alpha + ripple * v * np.cos(v * t + turn)
    step = t[1] - t[0]
    # Hermite's rule: its error is of the fourth order, far below the encoder's step.
    moved = step / 2.0 * (omega[1:] + omega[:-1]) - step**2 / 12.0 * (alpha[1:] - alpha[:-1])
    theta = np.concatenate([[0.0], np.cumsum(moved)])
    return Track(t, theta - np.median(theta), omega, alpha)


def hand(rng: np.random.Generator, t: Floats) -> Track:
    """Overlapping minimum-jerk submovements (Flash & Hogan 1985) between random places, and a tremor."""
    theta, omega, alpha = np.zeros((3, len(t)))
    begin, place, reach = -0.3, 0.0, rng.uniform(0.8, 1.8)
    while begin < t[-1]:
        lasts = rng.uniform(0.35, 1.0)
        target = rng.uniform(-reach, reach)
        s = np.clip((t - begin) / lasts, 0.0, 1.0)
        step = target - place
        theta += step * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        omega += step * 30.0 * s**2 * (1.0 - s) ** 2 / lasts
        alpha += step * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / lasts**2
        place, begin = target, begin + lasts * rng.uniform(0.5, 0.9)
    w = 2.0 * np.pi * rng.uniform(5.0, 9.0, 3)
    tremor = _scaled(_sines(t, w, rng.uniform(0.0, 2.0 * np.pi, 3), np.ones(3)), rng.uniform(2e-3, 8e-3))
    return Track(t, theta + tremor.theta, omega + tremor.omega, alpha + tremor.alpha)


def _sines(t: Floats, w: Floats, phases: Floats, weights: Floats) -> Track:
    sin = weights[:, None] * np.sin(np.outer(w, t) + phases[:, None])
    cos = weights[:, None] * np.cos(np.outer(w, t) + phases[:, None])
    return Track(t, sin.sum(0), (w[:, None] * cos).sum(0), -(w[:, None] ** 2 * sin).sum(0))


def _scaled(track: Track, amplitude: float) -> Track:
    """The same motion with its farthest excursion at `amplitude`."""
    by = amplitude / float(np.abs(track.theta).max())
    return Track(track.t, by * track.theta, by * track.omega, by * track.alpha)


MOTIONS: dict[str, Callable[[np.random.Generator, Floats], Track]] = {
    "chirp": chirp,
    "multisine": multisine,
    "turns": turns,
    "hand": hand,
}
