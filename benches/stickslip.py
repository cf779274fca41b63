"""The render step as one would write it oneself: in NumPy, in Numba, in plain Python.

Knob parameters come as an array in the order of NAMES.
"""

import math
from typing import Any

import numpy as np
from numba import njit

import knobcam as kc

Floats = np.ndarray[Any, np.dtype[np.float64]]

NAMES = ("M", "c_neg", "c_pos", "b_neg", "b_pos", "a", "period", "shift", "d_neg", "d_pos", "band")
_SLOTS = (
    *("inertia.M", "coulomb.neg", "coulomb.pos", "viscous.neg", "viscous.pos"),
    *("detent.A", "detent.P", "detent.S", "karnopp.D_neg", "karnopp.D_pos", "karnopp.dv"),
)
STIFFNESS, DAMPING = 37.0, 0.02  # of the anchor, N m/rad and N m s/rad


def parameters(model: kc.Model) -> Floats:
    """The parameters of a model of these effects."""
    values = {row[0]: row[1] for row in model.core.rows()}
    return np.array([values[name] for name in _SLOTS])


def stribeck_of(model: kc.Model) -> Floats:
    """Rise, Stribeck velocity and exponent of a model; a rise of 0 where it has none."""
    values = {row[0]: row[1] for row in model.core.rows()}
    return np.array(
        [values.get(f"stribeck.{name}", one) for name, one in (("rise", 0.0), ("vs", 1.0), ("delta", 1.0))]
    )


def numpy_law(p: Floats, s: Floats, theta: Floats, omega: Floats, alpha: Floats) -> Floats:
    """The sliding law everywhere; within the band friction is clamped to what static friction holds.

    It has no anchor and no memory: a stuck knob is answered by whatever the sliding law says there.
    """
    m, c_neg, c_pos, b_neg, b_pos, a, period, shift, d_neg, d_pos, band = p
    forth = omega > 0.0
    dry = np.where(forth, c_pos, -c_neg)
    if s[0] != 0.0:
        dry = dry * (1.0 + s[0] * np.exp(-((np.abs(omega) / s[1]) ** s[2])))
    push = m * alpha + a * np.sin(theta / period + shift)
    friction = dry + np.where(forth, b_pos, b_neg) * omega
    stuck = np.abs(omega) < band
    return push + np.where(stuck, np.clip(friction, -d_neg, d_pos), friction)


def _anchored(p, s, theta, omega, alpha, out):  # type: ignore[no-untyped-def]
    """Elastoplastic friction (Hayward & Armstrong 2000) with the same two limits as knobcam's."""
    m, c_neg, c_pos, b_neg, b_pos, a, period, shift, d_neg, d_pos, band = p
    strain, slipping, before = 0.0, False, theta[0]
    if abs(omega[0]) > band:
        strain, slipping = math.copysign(1.0, omega[0]), True
    for i in range(theta.size):
        w = omega[i]
        if not (math.isfinite(theta[i]) and math.isfinite(w) and math.isfinite(alpha[i])):
            out[i:] = 0.0
            return
        level = 1.0
        if s[0] != 0.0:
            level += s[0] * math.exp(-((abs(w) / s[1]) ** s[2]))
        back, forth = c_neg * level, c_pos * level
        hold_back, hold_forth = max(d_neg, back), max(d_pos, forth)
        by = theta[i] - before
        before = theta[i]
        if slipping:
            low, high = back, forth
        else:
            low, high = hold_back, hold_forth
        pull = strain * (low if strain < 0.0 else high) + STIFFNESS * by
        asked = pull + DAMPING * w
        if not slipping and (asked < -hold_back or asked > hold_forth):
            slipping = True
            low, high = back, forth
            strain = math.copysign(1.0, asked)
        else:
            strain = min(max(pull / (low if pull < 0.0 else high), -1.0), 1.0)
            if slipping and abs(w) <= band and abs(asked) <= 0.5 * (low if asked < 0.0 else high):
                slipping = False
                low, high = hold_back, hold_forth
                strain = min(max(pull / (low if pull < 0.0 else high), -1.0), 1.0)
        friction = min(max(asked, -low), high)
        if slipping and abs(strain) == 1.0:
            friction = high if strain > 0.0 else -low
        drag = (b_pos if w > 0.0 else b_neg) * w
        out[i] = m * alpha[i] + a * math.sin(theta[i] / period + shift) + drag + friction


numba_step = njit(_anchored)


class PurePython:
    """The same step, one sample at a time, in plain Python."""

    def __init__(self, p: Floats) -> None:
        self.p = tuple(p.tolist())
        self.strain, self.slipping, self.before = 0.0, False, 0.0

    def step(self, theta: float, omega: float, alpha: float) -> float:
        """Torque by which the knob answers, N m."""
        m, c_neg, c_pos, b_neg, b_pos, a, period, shift, d_neg, d_pos, band = self.p
        if not (math.isfinite(theta) and math.isfinite(omega) and math.isfinite(alpha)):
            return 0.0
        by, self.before = theta - self.before, theta
        low, high = (c_neg, c_pos) if self.slipping else (d_neg, d_pos)
        strain = self.strain
        pull = strain * (low if strain < 0.0 else high) + STIFFNESS * by
        asked = pull + DAMPING * omega
        if not self.slipping and (asked < -d_neg or asked > d_pos):
            self.slipping, low, high = True, c_neg, c_pos
            self.strain = math.copysign(1.0, asked)
        else:
            self.strain = min(max(pull / (low if pull < 0.0 else high), -1.0), 1.0)
            if self.slipping and abs(omega) <= band and abs(asked) <= 0.5 * (low if asked < 0.0 else high):
                self.slipping, low, high = False, d_neg, d_pos
                self.strain = min(max(pull / (low if pull < 0.0 else high), -1.0), 1.0)
        friction = min(max(asked, -low), high)
        if self.slipping and abs(self.strain) == 1.0:
            friction = high if self.strain > 0.0 else -low
        drag = (b_pos if omega > 0.0 else b_neg) * omega
        return m * alpha + a * math.sin(theta / period + shift) + drag + friction
