"""Just noticeable differences: from how much on a hand feels that a knob is another one.

Knowles & Sheridan (1966), The "feel" of rotary controls: friction and inertia, Human Factors 8: a change of
friction or of inertia is noticed from 10 to 20 % of it on. Yang, Tan, Buttolo, Johnston & Pizlo (2003),
Thresholds for dynamic changes in a rotary switch, EuroHaptics, and Tan, Yang, Pizlo, Buttolo & Johnston
(2008), Manual detection of spatial and temporal torque variation through a rotary switch, IEEE Transactions
on Haptics 1: a ripple over the angle is noticed from a torque on that its spatial period decides, and not how
fast it is turned.
"""

from __future__ import annotations

import math

from ..errors import InputError
from ..model.effects import Effect

SHARE = 0.10
"""Of friction or inertia: the smaller end of what Knowles & Sheridan found, as some notice that much."""
_TORQUE_N_M = 0.030  # about which Yang et al. measured
_PERIODS_DEG = (2.8, 180.0)
_SHARES = (0.0037, 0.2617)  # of that torque, at these periods


def difference(name: str, effect: Effect, reference: float, period_deg: float | None, unit: str) -> float:
    """Return the just noticeable difference of a parameter about a reference, in its `unit`.

    InputError for what nobody measured, and for a ripple whose period is not given.
    """
    if effect.friction or effect.over == "acceleration":
        return SHARE * abs(reference)
    if effect.over == "position" and unit == "N m":
        if period_deg is None:
            raise InputError(f"{name}: a hand feels it by its period; add period_deg")
        return ripple(period_deg)
    raise InputError(f"{name}: nobody measured its just noticeable difference; give percent, or min and max")


def ripple(period_deg: float) -> float:
    """Return the torque, N m, from which on a ripple of such a period is noticed: its amplitude, or a change
    of it; between the ends that were measured a power of the period.
    """
    low, high = _PERIODS_DEG
    if not low <= period_deg <= high:
        raise InputError(
            f"period_deg = {period_deg:g}: thresholds were measured from {low} to {high:g} degrees"
        )
    part = math.log(period_deg / low) / math.log(high / low)
    return float(_TORQUE_N_M * _SHARES[0] * (_SHARES[1] / _SHARES[0]) ** part)
