"""The knobs that studies and benchmarks share: the paper's Equation 5 and random relatives of it."""

import numpy as np

from knobcam import Model

BASE = ["inertia", "coulomb", "viscous", "detent"]
# Equation 5 of the haptic-camera paper, SI.
PAPER_KNOB = {
    "inertia.M": 0.4,
    "coulomb.neg": 1.5,
    "coulomb.pos": 2.0,
    "viscous.neg": 1.0,
    "viscous.pos": 1.5,
    "detent.A": 1.0,
    "detent.P": 0.2,
    "detent.S": 0.9,
}


def model_of(values: dict[str, float]) -> Model:
    """Equation 1 with these values; without detents where their amplitude is zero."""
    effects = BASE if values["detent.A"] != 0.0 else BASE[:-1]
    model = Model.of(effects)
    for name, value in values.items():
        if name.split(".")[0] in effects:
            model = model.with_value(name, value)
    return model


def paper_like(rng: np.random.Generator) -> dict[str, float]:
    """A knob of the size of Equation 5, its detents anything from a tenth to ten times its friction."""
    neg, pos = 2.0 * rng.uniform(0.7, 1.3, 2)
    return {
        "inertia.M": rng.uniform(0.2, 0.8),
        "coulomb.neg": neg,
        "coulomb.pos": pos,
        "viscous.neg": rng.uniform(0.5, 2.0),
        "viscous.pos": rng.uniform(0.5, 2.0),
        "detent.A": 2.0 * _log_uniform(rng, 0.1, 10.0),
        "detent.P": _log_uniform(rng, 0.03, 0.5),
        "detent.S": rng.uniform(-np.pi, np.pi),
    }


def rig_like(rng: np.random.Generator, detents: bool) -> dict[str, float]:
    """A knob of the size of those that the paper measured."""
    friction = _log_uniform(rng, 2e-3, 35e-3)
    viscous = _log_uniform(rng, 1e-4, 2e-3)
    return {
        "inertia.M": _log_uniform(rng, 3e-5, 2e-4),
        "coulomb.neg": friction * rng.uniform(0.85, 1.15),
        "coulomb.pos": friction * rng.uniform(0.85, 1.15),
        "viscous.neg": viscous * rng.uniform(0.8, 1.2),
        "viscous.pos": viscous * rng.uniform(0.8, 1.2),
        "detent.A": _log_uniform(rng, 1e-3, 25e-3) if detents else 0.0,
        "detent.P": _log_uniform(rng, 0.03, 0.16),
        "detent.S": rng.uniform(-np.pi, np.pi),
    }


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def phase_error(fitted: float, true: float) -> float:
    """Difference of two angles within (-pi, pi]."""
    return float(np.angle(np.exp(1j * (fitted - true))))
