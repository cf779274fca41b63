"""The signature of an effect: what it adds to the torque of a small knob."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..effects import effects
from ..model import Model
from ..motions import motion
from .components import torque_at
from .laws import friction
from .style import BACKWARD, BLACK, FORWARD, Picture, legend_above, motion_units, plain, styled, torque_scale
from .thin import some

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..effects import Effect, ParameterInfo
    from ..formats.table import FloatArray

# What a parameter that is neutral at zero is set to, by unit: about what a small knob has (Table 7).
_TYPICAL = {
    "N m": 0.01,
    "N m s/rad": 0.001,
    "N m s^2/rad": 5e-5,
    "N m/rad": 0.01,
    "rad": 0.05,
    "rad/s": 0.5,
    "s": 0.005,
    "": 0.5,
}
# The knob that carries the effect: what it adds can depend on detents and friction (Table 7, knob 4).
_CARRIER = {
    "inertia.M": 4.9e-5,
    "coulomb.neg": 0.0011,
    "coulomb.pos": 0.0011,
    "viscous.neg": 0.00048,
    "viscous.pos": 0.00056,
    "detent.A": 0.011,
    "detent.P": 0.076,
    "detent.S": 0.0,
}


def example(effect: Effect) -> dict[str, float]:
    """Return a telling value of each parameter on a knob: its neutral one, or a typical one for zero."""
    entry = effects("rotary").get(effect.id, effect)
    return {f"{effect.id}.{p.name}": _example(p) for p in entry.params}


def _example(parameter: ParameterInfo) -> float:
    value = parameter.neutral if parameter.neutral != 0.0 else _TYPICAL.get(parameter.unit, 0.01)
    return float(np.clip(value, parameter.lower, parameter.upper))


@styled
def effect(effect: Effect) -> Picture:
    """The torque that an effect adds to a small knob for example values, over position and over velocity."""
    values = example(effect)
    carrier = {name: value for name, value in _CARRIER.items() if not name.startswith(f"{effect.id}.")}
    full = _model({**carrier, **values})
    if effect.id == "karnopp":
        return _standing(effect, full)
    track = motion("sweep")
    theta, omega, alpha = track.theta, track.omega, track.alpha
    whole = torque_at(full, list(full.effects), theta=theta, omega=omega, alpha=alpha)
    rest = [name for name in full.effects if name != effect.id]
    added = whole - torque_at(full, rest, theta=theta, omega=omega, alpha=alpha)
    figure = Picture(10.0, 4.4, _title(effect, values))
    _cloud(figure.add_subplot(1, 2, 1), theta, omega, added, "position", motion_units("rotary")["theta"])
    _cloud(figure.add_subplot(1, 2, 2), omega, omega, added, "velocity", motion_units("rotary")["omega"])
    return figure


def _model(values: dict[str, float]) -> Model:
    model = Model.of(dict.fromkeys(name.split(".")[0] for name in values))
    for name, value in values.items():
        model = model.with_value(name, value)
    return model


def _standing(effect: Effect, model: Model) -> Picture:
    """Stiction adds nothing while the knob moves: its signature is the stick band beside sliding friction."""
    figure = Picture(8.0, 4.8, _title(effect, {}))
    friction(figure.add_subplot(), model)
    return figure


def _title(effect: Effect, values: dict[str, float]) -> str:
    short = ", ".join(f"{name.split('.')[1]} = {value:g}" for name, value in values.items())
    lines = [f"{effect.id}: {effect.law}", f"shows {effect.shows}"]
    return "\n".join(plain(line, 200) for line in lines) + (
        f"\nhere with {plain(short, 200)}" if short else ""
    )


def _cloud(axes: Axes, x: FloatArray, omega: FloatArray, added: FloatArray, name: str, unit: str) -> None:
    """Draw the added torque in the colour of the direction of motion."""
    scale = torque_scale("rotary", float(np.max(np.abs(added), initial=0.0)))
    # Where both directions feel the same, the thin one lies within the wide one.
    for forward, color, size, label in (
        (True, FORWARD, 5.0, "moving forward"),
        (False, BACKWARD, 1.8, "moving backward"),
    ):
        rows = some((omega >= 0.0) == forward)
        tau = added[rows] * scale.factor
        axes.plot(x[rows], tau, ".", ms=size, mew=0, color=color, rasterized=True, label=label)
    axes.axhline(0.0, color=BLACK, lw=0.6, zorder=1)
    axes.set_title(f"Over {name}")
    axes.set_xlabel(f"{name} ({unit})")
    axes.set_ylabel(f"added torque ({scale.unit})")
    legend_above(axes)
