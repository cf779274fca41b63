"""What resists the knob: every law once, for arrays of samples and, compiled, for one step of a simulation.

Friction is a level (N m) that may only oppose the motion; the rest depends on position and velocity.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from .compiled import njit
from .motions import Floats
from .rubbing import Ageing, Bristles

NONE = np.zeros((0, 3))


class Loads(NamedTuple):
    """The knob's loads; SI, zero or empty where it has none of the kind.

    Rows of `harmonics` and `rough`: spatial frequency (in detents; in 1/rad), amplitude (N m; relative to
    Coulomb), phase. Rows of `stops`: side (1 or -1), angle, stiffness, growth of the stiffness per rad,
    damping. Rows of `ripple`: spatial frequency in 1/rad, amplitude in N m, phase. `weights` and
    `distances` of Maxwell-slip elements: shares of the friction, and slip in rad.
    """

    inertia: float
    coulomb_neg: float
    coulomb_pos: float
    viscous_neg: float
    viscous_pos: float
    detent: float
    period: float
    phase: float
    back_gain: float = 0.0
    back_shift: float = 0.0
    harmonics: Floats = NONE
    poly: Floats = np.zeros(3)
    spring: float = 0.0
    spring_at: float = 0.0
    unbalance: float = 0.0
    unbalance_at: float = 0.0
    stops: Floats = np.zeros((0, 5))
    ripple: Floats = NONE
    rise: float = 0.0
    vs: float = 1.0
    delta: float = 1.0
    drag: float = 0.0
    exponent: float = 2.0
    rough: Floats = NONE
    mu: float = 0.0
    warm: float = 0.0
    warm_s: float = 1.0
    weights: Floats = np.zeros(0)
    distances: Floats = np.zeros(0)
    bristles: Bristles = Bristles()
    ageing: Ageing = Ageing()

    @property
    def remembers(self) -> bool:
        """Whether friction follows bristles or the age of its contacts."""
        return len(self.bristles.shares) > 0 or self.ageing.evolving != 0.0


@register_jitable
def detent(x, v, p):  # type: ignore[no-untyped-def]
    """The detents' torque; on the way back they may have another size and phase."""
    back = 1.0 * (v < 0.0)
    turned = x / p.period + p.phase + p.back_shift * back
    torque = p.detent * (1.0 + p.back_gain * back) * np.sin(turned)
    for i in range(p.harmonics.shape[0]):
        row = p.harmonics[i]
        torque = torque + row[1] * np.sin(row[0] * (x / p.period + p.phase) + row[2])
    return torque


@register_jitable
def push(x, v, p):  # type: ignore[no-untyped-def]
    """Torque of position, and of velocity as far as it is smooth."""
    torque = detent(x, v, p) + p.spring * (x - p.spring_at)
    if p.unbalance != 0.0:
        torque = torque + p.unbalance * np.sin(x + p.unbalance_at)
    for i in range(p.ripple.shape[0]):
        row = p.ripple[i]
        torque = torque + row[1] * np.sin(row[0] * x + row[2])
    torque = torque + x * (p.poly[0] + x * (p.poly[1] + x * p.poly[2]))
    forth = 1.0 * (v > 0.0)
    torque = torque + v * (p.viscous_neg + (p.viscous_pos - p.viscous_neg) * forth)
    if p.drag != 0.0:
        torque = torque + p.drag * np.abs(v) ** p.exponent * np.sign(v)
    for i in range(p.stops.shape[0]):
        row = p.stops[i]
        into = np.maximum(row[0] * (x - row[1]), 0.0)
        pressed = row[2] * into * (1.0 + row[3] * into) + row[4] * row[0] * v * (into > 0.0)
        # A stop pushes out and never holds back.
        torque = torque + row[0] * np.maximum(pressed, 0.0)
    return torque


@register_jitable
def level(t, x, v, p):  # type: ignore[no-untyped-def]
    """Friction now, relative to Coulomb's."""
    relative = 1.0 + 0.0 * x
    if p.rise != 0.0:
        relative = relative * (1.0 + p.rise * np.exp(-((np.abs(v) / p.vs) ** p.delta)))
    if p.warm != 0.0:
        relative = relative * (1.0 + p.warm * np.exp(-t / p.warm_s))
    series = 1.0 + 0.0 * x
    for i in range(p.rough.shape[0]):
        row = p.rough[i]
        series = series + row[1] * np.sin(row[0] * x + row[2])
    return relative * np.maximum(series, 0.0)


@njit
def build_up(theta, limit_neg, limit_pos, weights, distances, coulomb):  # type: ignore[no-untyped-def]
    """Friction of parallel Maxwell-slip elements (Al-Bender, Lampaert & Swevers 2005), at rest at first.

    Each carries its weight of the friction, and slips once it is strained by its slip distance.
    """
    z = np.zeros(len(weights))
    torque = np.zeros(len(theta))
    for i in range(len(theta)):
        step = theta[i] - theta[i - 1] if i > 0 else 0.0
        for j in range(len(weights)):
            z[j] += coulomb * weights[j] / distances[j] * step
            z[j] = min(max(z[j], -weights[j] * limit_neg[i]), weights[j] * limit_pos[i])
            torque[i] += z[j]
    return torque
