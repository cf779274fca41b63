"""Presliding (Maxwell slip) with forward sensitivities, as an ODE for `odeint` and as a compiled loop.

dz_i/dt = 2^(i-1)/s omega while element i sticks, |z_i| <= 1; with u_i = dz_i/ds beside it. The derivative of
the torque to a share w_i is the dry friction times (z_i - sgn omega), to s the same times the sum of w_i u_i.
"""

from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import odeint

Floats = np.ndarray[Any, np.dtype[np.float64]]
ELEMENTS = 6
FORGETS = 50.0  # how fast, per rad of an element's own distance, a slipping one loses its sensitivity


@njit
def _rate(x, t, s, rate_hz, omega):  # type: ignore[no-untyped-def]
    at = min(int(t * rate_hz), omega.size - 2)
    share = t * rate_hz - at
    w = omega[at] + share * (omega[at + 1] - omega[at])
    out = np.empty(2 * ELEMENTS)
    finer = 1.0
    for i in range(ELEMENTS):
        z, u = x[i], x[ELEMENTS + i]
        speed = w * finer / s
        if (z >= 1.0 and w > 0.0) or (z <= -1.0 and w < 0.0):
            out[i], out[ELEMENTS + i] = 0.0, -FORGETS * abs(speed) * u
        else:
            out[i], out[ELEMENTS + i] = speed, -speed / s
        finer *= 2.0
    return out


def by_odeint(s: float, rate_hz: float, omega: Floats) -> Floats:
    """z and dz/ds of every element at every sample, shape (samples, 12)."""
    t = np.arange(omega.size) / rate_hz
    start = np.zeros(2 * ELEMENTS)
    # Without a largest step it would step over the data.
    return odeint(_rate, start, t, args=(s, rate_hz, omega), hmax=1.0 / rate_hz, rtol=1e-4, atol=1e-4)


@njit
def by_loop(s, theta):  # type: ignore[no-untyped-def]
    """The same by a compiled loop: exact between samples, because the rate over the angle is constant."""
    out = np.zeros((theta.size, 2 * ELEMENTS))
    for k in range(1, theta.size):
        moved = (theta[k] - theta[k - 1]) / s
        finer = 1.0
        for i in range(ELEMENTS):
            z = out[k - 1, i] + moved * finer
            u = out[k - 1, ELEMENTS + i] - moved * finer / s
            if z > 1.0:
                z, u = 1.0, 0.0
            elif z < -1.0:
                z, u = -1.0, 0.0
            out[k, i], out[k, ELEMENTS + i] = z, u
            finer *= 2.0
    return out


@njit
def torque_and_slopes(p, motion, elements):  # type: ignore[no-untyped-def]
    """Torque and its derivatives to M, C-, C+, B-, B+, s, w1..w6; shape (13, samples)."""
    m, c_neg, c_pos, b_neg, b_pos = p[0], p[1], p[2], p[3], p[4]
    theta, omega, alpha = motion
    out = np.zeros((13, theta.size))
    for k in range(theta.size):
        forth = omega[k] > 0.0
        sign = 1.0 if forth else -1.0
        dry = 0.5 * (c_neg + c_pos)
        lag, by_s = 0.0, 0.0
        for i in range(ELEMENTS):
            lag += p[6 + i] * (elements[k, i] - sign)
            by_s += p[6 + i] * elements[k, ELEMENTS + i]
            out[7 + i, k] = dry * (elements[k, i] - sign)
        ahead = (1.0 if forth else 0.0) + 0.5 * lag
        drag = (b_pos if forth else b_neg) * omega[k]
        out[0, k] = m * alpha[k] + drag + c_pos * ahead - c_neg * (1.0 - ahead)
        out[1, k] = alpha[k]
        out[2, k], out[3, k] = ahead - 1.0, ahead
        out[4, k] = 0.0 if forth else omega[k]
        out[5, k] = omega[k] if forth else 0.0
        out[6, k] = dry * by_s
    return out
