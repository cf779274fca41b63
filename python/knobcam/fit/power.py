"""Whether a torque takes power out of the hand that it came from, whatever of it lies along the position."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import FloatArray
    from ..capture.prepare import Prepared

_EVERY_S = 0.002  # between the rows that are looked at
_LATE_S = 0.002  # by which drives and hosts log a torque late or early; a row where that is longer
_FEWEST = 500
_PLACES = 200  # of the map of position, with straight lines between
_SURE = 8.0  # standard errors
_TOLD = 0.9  # of the torque's variance, below which it is another thing that makes it


def gives_back(prepared: Sequence[Prepared]) -> bool:
    """Return whether inertia and friction are negative, beyond doubt, beside any torque of position.

    Of a knob that is passive neither is, and no torque of position, however strong, can make them so over a
    motion that comes by the same places at unlike speeds. But one that is read a little late or early can, as
    what a controller computes of an angle that it read before: so they have to be negative either way.
    """
    return all(_gives_back(one) for one in prepared)


def _gives_back(one: Prepared) -> bool:
    late = max(1, round(_LATE_S * one.core.rate_hz))
    # What a delay adds is in proportion to it: between the two ends nothing else is said.
    return all(_negative(one, shift) for shift in (0, late, -late))


def _negative(one: Prepared, shift: int) -> bool:
    """Whether inertia and friction take less than nothing of the torque `shift` rows after the motion."""
    every = max(1, round(_EVERY_S * one.core.rate_hz))
    last = len(one.used) - max(shift, 0)
    rows = np.arange(max(-shift, 0), last)
    rows = rows[one.used[rows] & one.used[rows + shift]][::every]
    if len(rows) < _FEWEST:
        return False
    theta, omega, alpha = (getattr(one, name)[rows] for name in ("theta", "omega", "alpha"))
    tau = one.tau[rows + shift]
    at = (theta - theta.min()) / max(float(np.ptp(theta)), 1e-12) * _PLACES
    place: FloatArray = np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(_PLACES + 1)))
    columns = np.column_stack([alpha, np.sign(omega), omega, place])
    columns /= np.sqrt(np.mean(columns**2, axis=0)) + np.finfo(float).tiny
    inverse = np.linalg.pinv(columns.T @ columns, rcond=1e-10, hermitian=True)
    factors = inverse @ (columns.T @ tau)
    rest = tau - columns @ factors
    left = float(rest @ rest)
    if left > (1.0 - _TOLD) * float(np.sum((tau - tau.mean()) ** 2)):
        return False
    # What is left is no white noise: fewer samples are independent.
    alike = min(0.99, max(0.0, float(rest[1:] @ rest[:-1]) / max(left, 1e-300)))
    noise = left / max(1, len(rows) - columns.shape[1]) * (1.0 + alike) / (1.0 - alike)
    # The power that friction takes is linear in its two factors.
    takes = np.zeros((2, columns.shape[1]))
    takes[0, 0] = 1.0
    takes[1, 1:3] = np.mean(columns[:, 1:3] * omega[:, None], axis=0)
    values = takes @ factors
    errors = np.sqrt(noise * np.einsum("ij,jk,ik->i", takes, inverse, takes))
    return bool((values + _SURE * errors < 0.0).all())
