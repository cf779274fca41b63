"""From the motion of the shaft to the torque on it: one rigid body, or two in contact."""

from typing import NamedTuple

import numpy as np

from .compiled import njit
from .loads import Loads, build_up, detent, level, push
from .motions import Floats, Track
from .rubbing import aged, bent, fresh, rubbed


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
    if p.remembers:
        memory = fresh(p.bristles, p.ageing, v[0])
        sliding = p.bristles.sliding if len(p.bristles.shares) else 1.0
        friction = rubbed(x, v, t[1] - t[0], neg, pos, p.bristles, p.ageing, sliding, memory)
    return p.inertia * a + friction + push(x, v, p)


def two_bodies(track: Track, p: Loads, contact: Contact, substeps: int = 40) -> Floats:
    """Torque on a shaft that moves its knob through a contact; the hidden knob is simulated forward, N m."""
    memory = fresh(p.bristles, p.ageing, track.omega[0])
    sliding = p.bristles.sliding if len(p.bristles.shares) else 1.0
    held = _simulate(*track[:3], p, contact, substeps, sliding, memory)
    return (1.0 - contact.share) * p.inertia * track.alpha + held


@njit
def _held(e: float, de: float, contact: Contact) -> float:
    """Torque through the contact. Across a play the bodies push, and never pull, each other."""
    if contact.gap == 0.0:
        return contact.stiffness * e + contact.damping * de
    if e > contact.gap:
        return max(contact.stiffness * (e - contact.gap) + contact.damping * de, 0.0)
    if e < -contact.gap:
        return min(contact.stiffness * (e + contact.gap) + contact.damping * de, 0.0)
    return 0.0


@njit
def _simulate(t, theta, omega, p, contact, substeps, sliding, memory):  # type: ignore[no-untyped-def]
    """Torque through the contact at each sample.

    Semi-implicit Euler; in each substep friction brakes by its whole impulse or, where that would turn the
    velocity round, stops the knob. The knob starts in the middle of the play, as fast as the shaft.
    """
    inertia = contact.share * p.inertia
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
            drive = _held(shaft - x, speed - v, contact) - push(x, v, p)
            v = slowed(t[i] + u * dt, x, v, drive, h, inertia, p, sliding, z, memory)
            x += h * v
    out[-1] = _held(theta[-1] - x, omega[-1] - v, contact)
    return out


@njit
def slowed(t, x, v, drive, h, inertia, p, sliding, slips, memory):  # type: ignore[no-untyped-def]
    """Velocity after `h` seconds of a body that `drive` N m pushes and friction slows."""
    relative, pressed = level(t, x, v, p), p.mu * abs(detent(x, v, p))
    neg, pos = p.coulomb_neg * relative + pressed, p.coulomb_pos * relative + pressed
    if len(slips) > 0:
        coulomb = (p.coulomb_neg + p.coulomb_pos) / 2.0
        for j in range(len(slips)):
            slips[j] += coulomb * p.weights[j] / p.distances[j] * h * v
            slips[j] = min(max(slips[j], -p.weights[j] * neg), p.weights[j] * pos)
            drive -= slips[j]
        return v + h * drive / inertia
    if len(p.bristles.shares) > 0:
        share = bent(h * v, p.bristles, memory) / sliding
        return v + h * (drive - share * (pos if share > 0.0 else neg)) / inertia
    if p.ageing.evolving != 0.0:
        share = aged(abs(v), h, p.ageing, memory)
        neg, pos = neg * share, pos * share
    return _braked(v, v + h * drive / inertia, h * neg / inertia, h * pos / inertia)


@njit
def _braked(before: float, free: float, neg: float, pos: float) -> float:
    """Velocity after friction that could change it by `neg` or `pos`, from what it were without."""
    if before > 0.0 or (before == 0.0 and free > 0.0):
        slowed = free - pos
        return slowed if slowed > 0.0 else min(free + neg, 0.0)
    slowed = free + neg
    return slowed if slowed < 0.0 else max(free - pos, 0.0)
