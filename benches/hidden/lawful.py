"""Laws that are in no catalogue, as physics gives them: what a proposal should find where no name is right.

Each is a torque of the exact motion, and says of which variables it is one. Nothing here is the program's own
grammar.
"""

from collections.abc import Callable

import numpy as np

from .chain import Grow, Kind, Scene, log_uniform
from .motions import Floats

Rng = np.random.Generator


def hum(rng: Rng, scene: Scene) -> Floats:
    """The mains, 50 or 60 Hz."""
    return np.sin(2.0 * np.pi * rng.choice([50.0, 60.0]) * scene.track.t + rng.uniform(0.0, 2.0 * np.pi))


def crank_inertia(rng: Rng, scene: Scene) -> Floats:
    """An inertia that turns with the angle, once or twice a turn."""
    return (
        np.cos(rng.choice([1.0, 2.0]) * scene.track.theta + rng.uniform(0.0, 2.0 * np.pi)) * scene.track.alpha
    )


def eddy_brake(rng: Rng, scene: Scene) -> Floats:
    """Currents in a turning disc: the torque is largest at one speed and falls beyond."""
    x = scene.track.omega / (rng.uniform(0.1, 0.5) * np.quantile(np.abs(scene.track.omega), 0.9))
    return x / (1.0 + x**2)


def rubbing_sector(rng: Rng, scene: Scene) -> Floats:
    """A seal that rubs at one angle, more the faster (where it is dry it has a name: position_friction)."""
    return np.exp(-(_off(rng, scene, 0.15, 0.5) ** 2)) * scene.track.omega


def centrifugal(rng: Rng, scene: Scene) -> Floats:
    """What an eccentric's bearing is pushed with: the square of the speed times the sine of the angle."""
    return scene.track.omega**2 * np.sin(scene.track.theta + rng.choice([0.0, rng.uniform(0.0, 2.0 * np.pi)]))


def fading_wave(rng: Rng, scene: Scene) -> Floats:
    """A vibration that was struck before the capture and dies away in it."""
    t = scene.track.t
    swing = np.sin(2.0 * np.pi * log_uniform(rng, 3.0, 40.0) * t + rng.uniform(0.0, 2.0 * np.pi))
    return np.exp(-t / (rng.uniform(0.15, 0.6) * t[-1])) * swing


def fading_relief(rng: Rng, scene: Scene) -> Floats:
    """A wave over the angle that wears off."""
    t, theta = scene.track.t, scene.track.theta
    waves = rng.uniform(5.0, 20.0) * 2.0 * np.pi / np.ptp(theta)
    return np.exp(-t / (rng.uniform(0.2, 0.6) * t[-1])) * np.sin(
        waves * theta + rng.uniform(0.0, 2.0 * np.pi)
    )


def clutch(rng: Rng, scene: Scene) -> Floats:
    """A fluid that slips: it saturates with the speed, where the sign has long changed."""
    return np.tanh(scene.track.omega / (rng.uniform(0.2, 0.7) * np.quantile(np.abs(scene.track.omega), 0.9)))


def warming_drag(rng: Rng, scene: Scene) -> Floats:
    """Grease that warms up: the viscous torque decays in time."""
    t = scene.track.t
    return scene.track.omega * np.exp(-t / (rng.uniform(0.15, 0.5) * t[-1]))


def slack_spring(rng: Rng, scene: Scene) -> Floats:
    """A magnet at one angle that pulls the inertia's way only there: a bump times the acceleration."""
    return np.exp(-(_off(rng, scene, 0.15, 0.4) ** 2)) * scene.track.alpha


def coriolis(rng: Rng, scene: Scene) -> Floats:
    """An arm that slides out as the knob turns: drag that changes linearly with the angle."""
    return scene.track.theta * scene.track.omega


def band_brake(rng: Rng, scene: Scene) -> Floats:
    """A resonance of the bearing: more friction within a band of speed."""
    speed = np.abs(scene.track.omega)
    middle = np.quantile(speed, rng.uniform(0.55, 0.85))
    off = (speed - middle) / (rng.uniform(0.15, 0.3) * middle)
    return np.sign(scene.track.omega) * np.exp(-(off**2))


def growing_ripple(rng: Rng, scene: Scene) -> Floats:
    """A ripple over the angle that grows with the speed."""
    theta = scene.track.theta
    waves = rng.uniform(3.0, 15.0) * 2.0 * np.pi / np.ptp(theta)
    return np.abs(scene.track.omega) * np.sin(waves * theta + rng.uniform(0.0, 2.0 * np.pi))


def fluid_mass(rng: Rng, scene: Scene) -> Floats:
    """Fluid that is dragged along: the faster, the more of it."""
    return np.abs(scene.track.omega) * scene.track.alpha


def worn_bump(rng: Rng, scene: Scene) -> Floats:
    """A bump in the track that wears off."""
    t = scene.track.t
    return np.exp(-(_off(rng, scene, 0.1, 0.3) ** 2)) * np.exp(-t / (rng.uniform(0.2, 0.6) * t[-1]))


def cam(rng: Rng, scene: Scene) -> Floats:
    """A cam with two noses, thrown by the speed."""
    return scene.track.omega**2 * np.cos(2.0 * scene.track.theta + rng.uniform(0.0, 2.0 * np.pi))


def gust(rng: Rng, scene: Scene) -> Floats:
    """Something that leans on the knob once."""
    t = scene.track.t
    return np.exp(-(((t - rng.uniform(0.25, 0.75) * t[-1]) / (rng.uniform(0.03, 0.12) * t[-1])) ** 2))


def tilted_drag(rng: Rng, scene: Scene) -> Floats:
    """A gap with oil that is wider on one side: the drag goes round with the angle."""
    return scene.track.omega * np.sin(scene.track.theta + rng.uniform(0.0, 2.0 * np.pi))


def grease(rng: Rng, scene: Scene) -> Floats:
    """A grease that thins as it is sheared (a power-law fluid): the drag grows with a root of the speed."""
    return _to_the(scene, rng.uniform(0.4, 0.7))


def thinning_film(rng: Rng, scene: Scene) -> Floats:
    """A polymer between two plates: the drag grows with a low power of the speed."""
    return _to_the(scene, rng.choice([0.3, 0.4, 0.5]))


def turbulent_film(rng: Rng, scene: Scene) -> Floats:
    """A bearing whose oil film is turbulent: between what is viscous and what stirs."""
    return _to_the(scene, rng.choice([1.4, 1.5, 1.6]))


def churning(rng: Rng, scene: Scene) -> Floats:
    """Vanes that lift what they stir the more, the faster they go."""
    return _to_the(scene, rng.choice([2.5, 2.6, 2.7]))


def _to_the(scene: Scene, power: float) -> Floats:
    omega = scene.track.omega
    return np.sign(omega) * np.abs(omega) ** power


def _off(rng: Rng, scene: Scene, narrow: float, wide: float) -> Floats:
    """Distance from an angle within the motion, in widths."""
    theta = scene.track.theta
    low, high = np.quantile(theta, [0.1, 0.9])
    return (theta - rng.uniform(low, high)) / (rng.uniform(narrow, wide) * 0.5 * (high - low))


def _kind(shape: Callable[[Rng, Scene], Floats]) -> Kind:
    def draw(rng: Rng, scene: Scene) -> Grow:
        drawn = shape(rng, scene)
        unit = drawn / np.sqrt(np.mean(drawn**2))
        return lambda chain, size: chain._replace(strange=chain.strange + size * unit)

    return Kind("law", draw, (1e-5, 0.1))


VARIABLES: dict[str, tuple[str, ...]] = {
    "hum": ("t",),
    "crank_inertia": ("alpha", "theta"),
    "eddy_brake": ("omega",),
    "rubbing_sector": ("omega", "theta"),
    "centrifugal": ("omega", "theta"),
    "fading_wave": ("t",),
    "fading_relief": ("t", "theta"),
    "clutch": ("omega",),
    "warming_drag": ("omega", "t"),
    "slack_spring": ("alpha", "theta"),
    "coriolis": ("omega", "theta"),
    "band_brake": ("omega",),
    "growing_ripple": ("omega", "theta"),
    "fluid_mass": ("alpha", "omega"),
    "worn_bump": ("t", "theta"),
    "cam": ("omega", "theta"),
    "gust": ("t",),
    "tilted_drag": ("omega", "theta"),
    "grease": ("omega",),
    "thinning_film": ("omega",),
    "turbulent_film": ("omega",),
    "churning": ("omega",),
}
"""Of what each law is one; a sign or a magnitude of the velocity counts as the velocity."""

NEVER_LOOKED_AT = ("growing_ripple", "fluid_mass", "cam", "gust", "tilted_drag")
"""Of these no capture changed anything of the search."""

LAWFUL: dict[str, Kind] = {name: _kind(globals()[name]) for name in VARIABLES}
