"""What a small knob has: telling values of an effect's parameters, to show it and to hide it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .effects import effects

if TYPE_CHECKING:
    from .effects import Effect, ParameterInfo
    from .model import Model

# The knob that carries an effect in its picture: friction and detents of middling size among the knobs of the
# haptic-camera paper (Table 7).
CARRIER = {
    "inertia.M": 4.9e-5,
    "coulomb.neg": 0.004,
    "coulomb.pos": 0.004,
    "viscous.neg": 0.00048,
    "viscous.pos": 0.00056,
    "detent.A": 0.005,
    "detent.P": 0.076,
    "detent.S": 0.0,
}
# Sizes that a hand would notice on such a knob. What is not listed has its neutral value, or, where that is
# zero, one by its unit.
_SIZES = {
    "backlash.gap": 0.04,
    "compliance.k": 1.0,
    "compliance.d": 0.002,
    "stribeck.rise": 2.0,
    "stribeck.vs": 0.5,
    "quadratic_drag.d": 1e-4,
    "detent_harmonics.A2": 0.004,
    "detent_harmonics.A3": 0.002,
    "detent_harmonics.A4": 0.001,
    "detent_harmonics.A5": 5e-4,
    "detent_harmonics.P": 0.076,
    "directional_detent.A": 0.003,
    "directional_detent.S": 0.5,
    "directional_detent.P": 0.076,
    "position_polynomial.p1": 0.002,
    "position_polynomial.p2": 0.001,
    "position_polynomial.p3": 5e-4,
    "return_spring.k": 0.004,
    "unbalance.a": 0.004,
    "end_stop.lo": -0.7,
    "end_stop.hi": 0.7,
    "end_stop.k_lo": 0.02,
    "end_stop.k_hi": 0.02,
    "end_stop.d": 5e-4,
    "position_friction.P": 0.5,
    "position_friction.a1": 0.5,
    "position_friction.b1": 0.1,
    "position_friction.a2": 0.2,
    "position_friction.b2": 0.1,
    "position_friction.a3": 0.1,
    "position_friction.b3": 0.1,
    "friction_drift.tau": 2.0,
    "regional.b1": -0.5,
    "regional.b2": 0.1,
    "regional.b3": 0.6,
    "regional.f1": 0.004,
    "regional.k1": 0.002,
    "regional.f2": -0.003,
    "regional.k2": 0.01,
    "regional.f3": 0.002,
    "regional.k3": -0.01,
    "regional.f4": -0.002,
    "regional.k4": 0.003,
    "wavelet.lo": -1.0,
    "wavelet.hi": 1.0,
    **{f"wavelet.c{n}": 0.005 * (-0.9) ** n for n in range(1, 32)},
    "presliding.w1": 0.3,
    "presliding.w2": 0.2,
    "presliding.w3": 0.2,
    "presliding.w4": 0.1,
    "presliding.w5": 0.1,
    "presliding.w6": 0.05,
    "torque_lag.lag": 0.003,
    "torque_lag.delay": 0.002,
    "torque_drift.d": 0.002,
    "torque_drift.e": 0.002,
    "saturation.limit": 0.008,
    "offset.tau0": 0.003,
}
_BY_UNIT = {
    "N m": 0.01,
    "N m s/rad": 0.001,
    "N m s^2/rad": 5e-5,
    "N m/rad": 0.01,
    "rad": 0.05,
    "rad/s": 0.5,
    "s": 0.005,
    "1": 0.5,
}


def typical(effect: Effect) -> dict[str, float]:
    """Return a telling value of each parameter of an effect on a small knob."""
    entry = effects("rotary").get(effect.id, effect)
    return {f"{effect.id}.{p.name}": _size(effect.id, p) for p in entry.params}


def _size(effect: str, parameter: ParameterInfo) -> float:
    value = parameter.neutral if parameter.neutral != 0.0 else _BY_UNIT.get(parameter.unit, 0.01)
    value = _SIZES.get(f"{effect}.{parameter.name}", value)
    return float(np.clip(value, parameter.lower, parameter.upper))


def with_typical(model: Model, effect: Effect) -> Model:
    """Return a model with an effect more, of typical size; what the model ties stays tied."""
    model = model.with_effect(effect.id) if effect.id not in model.effects else model
    for name, value in typical(effect).items():
        if model.params[name].role in ("free", "fixed"):
            model = model.with_value(name, value)
    return model
