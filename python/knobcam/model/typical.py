"""How large an effect ordinarily is on a knob, in a motion, to its sensors; the effect's own file says it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from .. import _core
from ..capture.motions import MotionTrack
from ..capture.motions import motion as make_motion
from .effects import effects
from .model import Model
from .simulate import exact, sensors, simulate

if TYPE_CHECKING:
    from .effects import Effect
    from .simulate import SensorNoise

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
_HOLDS = {"karnopp.D_neg": "coulomb.neg", "karnopp.D_pos": "coulomb.pos"}
_PAPER_RATE_HZ = 5000.0
_EDGE_HZ = 500.0  # of the measurement filter at that rate


class Cost(NamedTuple):
    """What an effect costs who does not know of it.

    `rmse` is the error that the model without it keeps, beside noise, and `floor` what noise leaves; `peak`
    is the largest torque; N m.
    """

    rmse: float
    floor: float
    peak: float

    @property
    def times(self) -> float:
        """The error without the effect, in noise floors."""
        return math.hypot(self.rmse, self.floor) / self.floor


class Carrier(NamedTuple):
    """A knob, a motion and the sensors that watch it: what the size of an effect depends on."""

    model: Model
    track: MotionTrack
    signals: _core.Signals
    noise: float
    limit: float

    @classmethod
    def of(
        cls,
        model: Model,
        motion: str | MotionTrack = "sweep",
        noise: str | SensorNoise = "ranged",
        duration_s: float = 6.0,
    ) -> Self:
        """Return the carrier that a model is in a motion; arguments as in `simulate`."""
        if motion == "push":
            pushed = simulate(model, "push", noise="none", duration_s=duration_s).columns
            motion = MotionTrack(*(pushed[name] for name in MotionTrack._fields))
        track = make_motion(motion, duration_s) if isinstance(motion, str) else motion
        rate = (len(track.t) - 1) / float(track.t[-1] - track.t[0])
        edge = _EDGE_HZ * min(rate / _PAPER_RATE_HZ, 1.0)
        signals = exact(model.coordinate, track, {"torque_edge_hz": edge})
        peak = float(np.max(np.abs(model.core.torque(signals, filtered=False))))
        seen = sensors(noise, peak)
        return cls(model, track, signals, seen.torque_noise, seen.tau_limit)

    def typical(self, effect: Effect) -> dict[str, float]:
        """Return parameter values of an effect at the size that is ordinary here."""
        core = _carrying(self.model, effect).core
        values = core.typical(effect.id, self.signals, self.noise, self.limit)
        return {f"{effect.id}.{p.name}": value for p, value in zip(effect.params, values, strict=True)}

    def cost(self, effect: Effect) -> Cost | None:
        """Return what the effect costs at that size; None where this knob cannot have it."""
        values = list(self.typical(effect).values())
        core = _carrying(self.model, effect).core
        cost = core.cost(effect.id, values, self.signals, self.noise)
        return None if cost is None else Cost(*cost)


def pictured() -> Carrier:
    """Return the carrier of the pictures, over more than a turn, with many reversals at many speeds.

    What follows one axis then follows no other.
    """
    return Carrier.of(
        of_values(CARRIER), make_motion("multisine", 12.0, seed=1, amplitude=4.0, highest_hz=1.5)
    )


def typical(effect: Effect, carrier: Carrier | None = None) -> dict[str, float]:
    """Return a telling value of each parameter of an effect, by default on the small knob of the pictures."""
    entry = effects("rotary").get(effect.id, effect)
    return (carrier or pictured()).typical(entry)


def with_typical(model: Model, effect: Effect, carrier: Carrier | None = None) -> Model:
    """Return a model with an effect more, of the size that is ordinary in the carrier, by default in a sweep.

    What the model ties stays tied.
    """
    values = typical(effect, carrier or Carrier.of(model))
    model = _carrying(model, effect)
    model = model.with_effect(effect.id) if effect.id not in model.effects else model
    for name, value in values.items():
        own = model.params.get(name)  # none of its own says that it is not used at present
        if own is None or own.role in ("free", "fixed"):
            model = model.with_value(name, value)
    return model


def _carrying(model: Model, effect: Effect) -> Model:
    """The knob as it carries an effect: behind a joint it holds no more than it rubs.

    Behind one, stiction shows in every reversal: a second cause beside the joint.
    """
    if effect.place != "coupling":
        return model
    for holds, rubs in _HOLDS.items():
        if holds in model.params and rubs in model.params:
            model = model.with_value(holds, abs(model.params[rubs].value))
    return model


def of_values(values: dict[str, float]) -> Model:
    """Return the model that has these parameters."""
    model = Model.of(dict.fromkeys(name.split(".")[0] for name in values))
    for name, value in values.items():
        model = model.with_value(name, value)
    return model
