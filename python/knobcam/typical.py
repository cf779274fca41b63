"""What a small knob has: telling values of any effect's parameters, to show it and to hide it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .effects import effects

if TYPE_CHECKING:
    from .effects import Effect, ParameterInfo

# What a parameter that is neutral at zero is set to, by unit: about what a small knob has (Table 7 of the
# haptic-camera paper).
_BY_UNIT = {
    "N m": 0.01,
    "N m s/rad": 0.001,
    "N m s^2/rad": 5e-5,
    "N m/rad": 0.01,
    "rad": 0.05,
    "rad/s": 0.5,
    "s": 0.005,
    "": 0.5,
}
# The knob that carries an effect: what it adds can depend on detents and friction (Table 7, knob 4).
CARRIER = {
    "inertia.M": 4.9e-5,
    "coulomb.neg": 0.0011,
    "coulomb.pos": 0.0011,
    "viscous.neg": 0.00048,
    "viscous.pos": 0.00056,
    "detent.A": 0.011,
    "detent.P": 0.076,
    "detent.S": 0.0,
}


def typical(effect: Effect) -> dict[str, float]:
    """Return a telling value of each parameter on a knob: its neutral one, or a typical one for zero."""
    entry = effects("rotary").get(effect.id, effect)
    return {f"{effect.id}.{p.name}": _value(p) for p in entry.params}


def _value(parameter: ParameterInfo) -> float:
    value = parameter.neutral if parameter.neutral != 0.0 else _BY_UNIT.get(parameter.unit, 0.01)
    return float(np.clip(value, parameter.lower, parameter.upper))
