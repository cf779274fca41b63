"""From the motion of the shaft to the torque on it: one rigid body, or two in contact."""

from typing import NamedTuple

import numba
import numpy as np

from .loads import Loads, build_up, detent, level, push
from .motions import Floats, Track


class Contact(NamedTuple):
    """Between shaft and knob: a free play of +-gap (rad), stiffness, damping; the knob's share of inertia."""

    gap: float
    stiffness: float
    damping: float
    share: float


def one_body(track: Track, p: Loads) -> Floats:
    """Torque on a shaft that is one with its knob: inverse dynamics, N m."""
    t, x, v, a = track
    relative, pressed = level(t, x, v, p), p.mu * np.abs(detent(x, v, p))
    neg, pos = p.coulomb_neg * relative + pressed, p.coulomb_pos * relative + pressed
    friction = np.where(v > 0.0, pos, -neg)
    if len(p.weights):
        friction = build_up(x, neg, pos, p.weights, p.distances, (p.coulomb_neg + p.coulomb_pos) / 2.0)
    return p.inertia * a + friction + push(x, v, p)


def two_bodies(track: Track, p: Loads, contact: Contact, substeps: int = 40) -> Floats:
    """Torque on a shaft that moves its knob through a contact; the hidden knob is simulated forward, N m."""
    held = _simulate(*track[:3], p, contact, substeps)
    return (1.0 - contact.share) * p.inertia * track.alpha + held


@numba.njit
def _held(e: float, de: float, contact: Contact) -> float:
    """Torque through the contact. Across a play the bodies push, and never pull, each other."""
    if contact.gap == 0.0:
        return contact.stiffness * e + contact.damping * de
    if e > contact.gap:
        return max(contact.stiffness * (e - contact.gap) + contact.damping * de, 0.0)
    if e < -contact.gap:
        return min(contact.stiffness * (e + contact.gap) + contact.damping * de, 0.0)
    return 0.0


@numba.njit
def _simulate(t, theta, omega, p, contact, substeps):  # type: ignore[no-untyped-def]
    """Torque through the contact at each sample.

    Semi-implicit Euler; in each substep friction brakes by its whole impulse or, where that would turn the
    velocity round, stops the knob. The knob starts in the middle of the play, as fast as the shaft.
    """
    inertia = contact.share * p.inertia
    coulomb = (p.coulomb_neg + p.coulomb_pos) / 2.0
    z = np.zeros(len(p.weights))
    x, v, out = theta[0], omega[0], np.zeros(len(t))
    dt = t[1] - t[0]
    h = dt / substeps
    for i in range(len(t) - 1):
        out[i] = _held(theta[i] - x, omega[i] - v, contact)
        for s in range(substeps):
            u = s / substeps
            shaft = theta[i] * (1.0 + 2.0 * u) * (1.0 - u) ** 2 + theta[i + 1] * u**2 * (3.0 - 2.0 * u)
            shaft += dt * u * (1.0 - u) * (omega[i] * (1.0 - u) - omega[i + 1] * u)
            speed = omega[i] * (1.0 - u) + omega[i + 1] * u
            torque = _held(shaft - x, speed - v, contact) - push(x, v, p)
            relative, pressed = level(t[i] + u * dt, x, v, p), p.mu * abs(detent(x, v, p))
            neg, pos = p.coulomb_neg * relative + pressed, p.coulomb_pos * relative + pressed
            if len(z) > 0:
                for j in range(len(z)):
                    z[j] += coulomb * p.weights[j] / p.distances[j] * h * v
                    z[j] = min(max(z[j], -p.weights[j] * neg), p.weights[j] * pos)
                    torque -= z[j]
                v += h * torque / inertia
            else:
                v = _braked(v, v + h * torque / inertia, h * neg / inertia, h * pos / inertia)
            x += h * v
    out[-1] = _held(theta[-1] - x, omega[-1] - v, contact)
    return out


@numba.njit
def _braked(before: float, free: float, neg: float, pos: float) -> float:
    """Velocity after friction that could change it by `neg` or `pos`, from what it were without."""
    if before > 0.0 or (before == 0.0 and free > 0.0):
        slowed = free - pos
        return slowed if slowed > 0.0 else min(free + neg, 0.0)
    slowed = free + neg
    return slowed if slowed < 0.0 else max(free - pos, 0.0)
