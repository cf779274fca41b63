"""Disturbances that no catalogue names, in time, position, velocity, acceleration and history."""

from collections.abc import Callable

import numpy as np
from scipy import ndimage, signal

from .chain import Grow, Kind, Scene, log_uniform
from .motions import Floats

Rng = np.random.Generator


def mains_hum(rng: Rng, scene: Scene) -> Floats:
    return np.sin(2.0 * np.pi * rng.choice([50.0, 60.0]) * scene.track.t + rng.uniform(0.0, 2.0 * np.pi))


def vibration(rng: Rng, scene: Scene) -> Floats:
    """A machine near by, whose strength swells and fades."""
    t = scene.track.t
    swell = 1.0 + rng.uniform(0.0, 0.8) * np.sin(2.0 * np.pi * rng.uniform(0.3, 1.0) * t)
    return swell * np.sin(2.0 * np.pi * rng.uniform(17.0, 43.0) * t + rng.uniform(0.0, 2.0 * np.pi))


def wander(rng: Rng, scene: Scene) -> Floats:
    """A random walk that is drawn back, far too fast for a drift."""
    dt = scene.track.t[1] - scene.track.t[0]
    keep = np.exp(-2.0 * np.pi * rng.uniform(2.0, 6.0) * dt)
    return signal.lfilter([1.0], [1.0, -keep], rng.standard_normal(len(scene.track.t)))


def bursts(rng: Rng, scene: Scene) -> Floats:
    """A few knocks on the table."""
    t, torque = scene.track.t, np.zeros(len(scene.track.t))
    for at in rng.uniform(0.1, 0.9, int(rng.integers(3, 8))) * t[-1]:
        since = np.maximum(t - at, 0.0)
        decay = np.exp(-since / rng.uniform(0.03, 0.15))
        torque += rng.choice([-1.0, 1.0]) * decay * np.sin(2.0 * np.pi * rng.uniform(15.0, 70.0) * since)
    return torque


def bump(rng: Rng, scene: Scene) -> Floats:
    """A dent in the track at one angle."""
    theta = scene.track.theta
    off = (theta - np.quantile(theta, rng.uniform(0.2, 0.8))) / rng.uniform(0.03, 0.12)
    return -off * np.exp((1.0 - off**2) / 2.0)


def rough_map(rng: Rng, scene: Scene) -> Floats:
    """A random relief over position, without a period."""
    theta = scene.track.theta
    step = 2e-3
    grid = np.arange(theta.min() - 1.0, theta.max() + 1.0, step)
    relief = ndimage.gaussian_filter1d(rng.standard_normal(len(grid)), rng.uniform(0.04, 0.15) / step)
    return np.interp(theta, grid, relief)


def pawl(rng: Rng, scene: Scene) -> Floats:
    """A spring that is bent at one angle when it is passed one way, and not the other."""
    theta, omega = scene.track.theta, scene.track.omega
    off = (theta - np.quantile(theta, rng.uniform(0.25, 0.75))) / rng.uniform(0.05, 0.15)
    return np.exp(-(off**2) / 2.0) * (omega > 0.0)


def friction_band(rng: Rng, scene: Scene) -> Floats:
    """More friction in a band of velocity, as at a resonance of the bearing."""
    speed = np.abs(scene.track.omega)
    middle = np.quantile(speed, rng.uniform(0.55, 0.85))
    return np.sign(scene.track.omega) * np.exp(-(((speed - middle) / (rng.uniform(0.1, 0.25) * middle)) ** 2))


def friction_step(rng: Rng, scene: Scene) -> Floats:
    """Friction that sets in or stops at a speed, as of a centrifugal brake."""
    omega = scene.track.omega
    at = np.quantile(np.abs(omega), rng.uniform(0.5, 0.85))
    return rng.choice([-1.0, 1.0]) * np.sign(omega) * (np.abs(omega) > at)


def surge(rng: Rng, scene: Scene) -> Floats:
    """An inertia that grows with the acceleration."""
    return scene.track.alpha**3


def memory(rng: Rng, scene: Scene) -> Floats:
    """Friction that starts high or low after each reversal and settles with time, whatever the distance."""
    t, sign = scene.track.t, np.sign(scene.track.omega)
    turned = np.concatenate([[True], np.diff(sign) != 0.0])
    since = t - np.maximum.accumulate(np.where(turned, t, t[0]))
    return rng.choice([-1.0, 1.0]) * sign * np.exp(-since / log_uniform(rng, 0.08, 0.4))


def creep(rng: Rng, scene: Scene) -> Floats:
    """A viscoelastic skin: a spring in line with a damper, which forgets its strain."""
    dt = scene.track.t[1] - scene.track.t[0]
    keep = np.exp(-dt / log_uniform(rng, 0.05, 0.4))
    return signal.lfilter([1.0], [1.0, -keep], scene.track.omega)


def _kind(group: str, shape: Callable[[Rng, Scene], Floats]) -> Kind:
    def draw(rng: Rng, scene: Scene) -> Grow:
        drawn = shape(rng, scene)
        unit = drawn / np.sqrt(np.mean(drawn**2))
        return lambda chain, size: chain._replace(strange=size * unit)

    return Kind(group, draw, (1e-5, 0.1))


STRANGE: dict[str, Kind] = {
    "mains_hum": _kind("time", mains_hum),
    "vibration": _kind("time", vibration),
    "wander": _kind("time", wander),
    "bursts": _kind("time", bursts),
    "bump": _kind("position", bump),
    "rough_map": _kind("position", rough_map),
    "pawl": _kind("position", pawl),
    "friction_band": _kind("velocity", friction_band),
    "friction_step": _kind("velocity", friction_step),
    "surge": _kind("acceleration", surge),
    "memory": _kind("history", memory),
    "creep": _kind("history", creep),
}
