"""Motions that excite a knob: position with its exact first and second derivative."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.arrays import vector
from ..base.door import checked
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.arrays import FloatArray


class MotionTrack(NamedTuple):
    """A commanded motion; arrays of shape (samples,), SI."""

    t: FloatArray
    theta: FloatArray
    omega: FloatArray
    alpha: FloatArray

    @property
    def rate_hz(self) -> float:
        """Samples a second, of two or more."""
        return (len(self.t) - 1) / float(self.t[-1] - self.t[0])


def checked_track(track: MotionTrack) -> MotionTrack:
    """Return a track of float64 columns of one length, whose times advance. InputError says what is not."""
    columns = [vector(f"motion.{name}", values) for name, values in zip(track._fields, track, strict=True)]
    for name, values in zip(track._fields, columns, strict=True):
        if len(values) != len(columns[0]):
            raise InputError(f"motion.{name}: is not as long as t, {len(columns[0])} samples; cut them")
        if not np.isfinite(values).all():
            raise InputError(f"motion.{name}: holds what is no number; a motion to be made has no gaps")
    if len(columns[0]) < 2 or not (np.diff(columns[0]) > 0.0).all():
        raise InputError("motion.t: does not advance from sample to sample; give two or more, in their order")
    return MotionTrack(*columns)


def sweep(t: FloatArray, a: float = 0.0, b: float = 1.5, c: float = 1.0, d: float = 3.0) -> MotionTrack:
    """Swept sine of amplitude `c` rad; its frequency at time t is (a + (b - a) t / d) / d Hz.

    Equation 3 of the haptic-camera paper with its exact derivatives; the defaults are Equation 4.
    """
    u = (b - a) * t / d + a
    phase = np.pi / (b - a) * (u**2 - a**2)
    sin, cos = np.sin(phase), np.cos(phase)
    omega = 2.0 * c * (np.pi / d) * u * cos
    alpha = -4.0 * c * (np.pi / d) ** 2 * u**2 * sin + 2.0 * c * np.pi * (b - a) / d**2 * cos
    return MotionTrack(t, c * sin, omega, alpha)


def multisine(t: FloatArray, seed: int = 0, amplitude: float = 1.0, highest_hz: float = 4.0) -> MotionTrack:
    """Sum of harmonically related sines with random phases, falling as 1/f; `amplitude` rad at most.

    Periodic within the capture, so that it ends where it began.
    """
    base = 2.0 * np.pi / (t[-1] + (t[1] - t[0]))
    orders = np.arange(1, max(2, round(highest_hz * 2.0 * np.pi / base)) + 1)
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(orders))
    return _sines(t, base * orders, phases, 1.0 / orders, amplitude)


def hand(t: FloatArray, seed: int = 0, amplitude: float = 0.8) -> MotionTrack:
    """Slow, irregular turning as by hand: a few incommensurate sines below 1 Hz."""
    rng = np.random.default_rng(seed)
    w = 2.0 * np.pi * rng.uniform(0.08, 0.9, 7)
    return _sines(t, w, rng.uniform(0.0, 2.0 * np.pi, 7), 1.0 / w, amplitude)


def turns(t: FloatArray, speed: float = 6.0, span: float = 9.0, ramp_s: float = 0.15) -> MotionTrack:
    """Constant-speed passes forth and back over `span` rad at `speed` rad/s.

    At each end the speed turns round within `ramp_s` along half a cosine.
    """
    # Each pass starts with the turn from the one before: half a cosine, which leads nowhere on the whole.
    count, since = np.divmod(t, span / speed + ramp_s)
    forth = count % 2 == 0
    sign, start = np.where(forth, 1.0, -1.0), np.where(forth, 0.0, span)
    turn = np.pi * np.minimum(since / ramp_s, 1.0)
    theta = start + sign * speed * (np.maximum(since - ramp_s, 0.0) - np.sin(turn) * ramp_s / np.pi)
    omega = -sign * speed * np.cos(turn)
    alpha = np.where(since < ramp_s, sign * speed * np.sin(turn) * np.pi / ramp_s, 0.0)
    return MotionTrack(t, theta, omega, alpha)


def micro(t: FloatArray, amplitude: float = 0.02, frequency_hz: float = 1.0) -> MotionTrack:
    """Small slow oscillation: what happens just after each reversal."""
    w = np.array([2.0 * np.pi * frequency_hz])
    return _sines(t, w, np.zeros(1), np.ones(1), amplitude)


def _sines(
    t: FloatArray, w: FloatArray, phases: FloatArray, weights: FloatArray, amplitude: float
) -> MotionTrack:
    """Sum of sines, scaled so that the farthest excursion is `amplitude`."""
    theta, omega, alpha = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for rate, phase, weight in zip(w, phases, weights, strict=True):
        sin, cos = weight * np.sin(rate * t + phase), weight * np.cos(rate * t + phase)
        theta += sin
        omega += rate * cos
        alpha -= rate**2 * sin
    scale = amplitude / np.max(np.abs(theta))
    return MotionTrack(t, scale * theta, scale * omega, scale * alpha)


MOTIONS: dict[str, Callable[..., MotionTrack]] = {
    "sweep": sweep,
    "multisine": multisine,
    "turns": turns,
    "hand": hand,
    "micro": micro,
}


@checked
def motion(name: str, duration_s: float = 6.0, rate_hz: float = 5000.0, **options: float) -> MotionTrack:
    """Return a motion by name, sampled at n / rate for n = 1, 2, ...; options as its function takes them.

    A name that ends in `.toml` is that of a motion file, which takes as long as it says, and no options.

    Raises InputError for an unknown name or option, for a length that is no whole number of samples, and for
    a file that is none or jumps.
    """
    if not 1.0 <= rate_hz <= 1e7:
        raise InputError(f"a rate of {rate_hz} Hz is no sampling rate of a rig; choose 1 to 1e7")
    if name.lower().endswith(".toml"):
        from .motion_plan import load_track

        if options:
            raise InputError(f"motion={name!r}: a file takes no {', '.join(options)}; change it in the file")
        return load_track(name, rate_hz)
    if name not in MOTIONS:
        raise InputError(
            f"motion={name!r} is unknown; choose {', '.join(MOTIONS)}, a motion file (.toml) "
            "(or push, to simulate)"
        )
    samples = duration_s * rate_hz
    if not 3.0 <= samples <= 1e8:
        raise InputError(f"duration={duration_s} s at {rate_hz} Hz is {samples:g} samples; choose 3 to 1e8")
    t = np.arange(1, round(samples) + 1) / rate_hz
    try:
        return MOTIONS[name](t, **options)
    except TypeError as error:
        raise InputError(f"motion={name!r}: {error}") from None
