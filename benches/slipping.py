"""Textbook friction on the drift test: a handle of 5e-5 kg m^2 that is pushed while it sticks.

Each law takes the hand's torque at 5 kHz, what holds and what slides (N m), and returns the angle. The
friction acts on the handle a sample after it was sensed, as that of a device does.
"""

from typing import Any

import numpy as np
from numba import njit

Floats = np.ndarray[Any, np.dtype[np.float64]]

DT, SUBSTEPS = 2e-4, 20
INERTIA, DAMPING = 5e-5, 1e-4
BAND = 0.01  # rad/s, of Karnopp
STIFFNESS = 37.0  # of the bristles, N m/rad
BRISTLES = 0.04  # their damping, N m s/rad
STRIBECK = 0.1  # rad/s


@njit
def _move(theta, omega, tau):  # type: ignore[no-untyped-def]
    h = DT / SUBSTEPS
    for _ in range(SUBSTEPS):
        faster = omega + h * (tau - DAMPING * omega) / INERTIA
        theta, omega = theta + 0.5 * h * (omega + faster), faster
    return theta, omega


@njit
def karnopp(push: Floats, hold: float, slide: float) -> Floats:
    """Karnopp 1985 with the torque known: friction cancels it within the band and forgets where."""
    theta, omega = 0.0, 0.0
    out = np.empty_like(push)
    for i in range(push.size):
        hand = push[i - 1] if i > 0 else 0.0  # what is measured is a sample old
        stuck = abs(omega) < BAND
        friction = min(max(hand, -hold), hold) if stuck else slide * np.sign(omega)
        theta, omega = _move(theta, omega, push[i] - friction)
        out[i] = theta
    return out


@njit
def dahl(push: Floats, hold: float, slide: float) -> Floats:
    """Dahl 1968: dF/dx = sigma (1 - sgn(v) F/F_C), which creeps under a push that swings (Dupont 2002)."""
    theta, omega, force = 0.0, 0.0, 0.0
    out = np.empty_like(push)
    h = DT / SUBSTEPS
    for i in range(push.size):
        for _ in range(SUBSTEPS):
            force += h * omega * STIFFNESS * (1.0 - np.sign(omega) * force / hold)
            faster = omega + h * (push[i] - force - (DAMPING + BRISTLES) * omega) / INERTIA
            theta, omega = theta + 0.5 * h * (omega + faster), faster
        out[i] = theta
    return out


@njit
def lugre(push: Floats, hold: float, slide: float) -> Floats:
    """LuGre (Canudas de Wit et al. 1995): bristles that bend and slip at every speed, so they creep."""
    theta, omega, bend = 0.0, 0.0, 0.0
    out = np.empty_like(push)
    h = DT / SUBSTEPS
    for i in range(push.size):
        for _ in range(SUBSTEPS):
            most = slide + (hold - slide) * np.exp(-((omega / STRIBECK) ** 2))
            rate = omega - STIFFNESS * abs(omega) / most * bend
            bend += h * rate
            force = STIFFNESS * bend + BRISTLES * rate
            faster = omega + h * (push[i] - force - DAMPING * omega) / INERTIA
            theta, omega = theta + 0.5 * h * (omega + faster), faster
        out[i] = theta
    return out


LAWS = {"Karnopp": karnopp, "Dahl": dahl, "LuGre": lugre}
