"""Models that leave: in another form, with every effect said to be exact, approximate or impossible there."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from ...base.door import checked
from ...capture.motions import MotionTrack, checked_track
from ...capture.motions import motion as make_motion
from ...errors import InputError
from ...model import Model
from ...model.simulate import simulate
from ..renderer import check_torque
from .conversion import Conversion, Fate, Form, Measured, moves, rms
from .target import Options, Target, Unmeasured
from .terms import terms_of

if TYPE_CHECKING:
    from ...base.arrays import FloatArray

__all__ = ["TARGETS", "Conversion", "Fate", "convert"]

TARGETS = {
    "mujoco": "mujoco",
    "c": "c",
    "fmu": "fmu",
    "cogging-table": "cogging",
    "urdf": "urdf",
    "modelica": "modelica",
}
"""The forms, each in a module of its own."""
FMI = (2, 3)
"""Versions of FMI that a unit can have, the usual one first."""
EVERY = "impossible"
"""What stands for every impossible effect among those to be left out."""
_SAME_RATE = 1e-6  # share by which the rate of a track may differ: what rounding leaves of its times


@checked
def convert(
    model: Model | str | os.PathLike[str],
    to: str,
    *,
    without: Sequence[str] = (),
    motion: str | MotionTrack = "sweep",
    rate_hz: float = 5000.0,
    kt: float | None = None,
    suffix: str = "",
    fmi: int = 2,
) -> Conversion:
    """Return `model` (or its file or name) in another form: mujoco, c, fmu, cogging-table, urdf, modelica.

    `without` names effects to be left out, `"impossible"` all that have no place there; the file then says
    so. `motion` is what the torque error is foretold and measured on, a name or a track; `rate_hz` the steps
    a second of a form that steps; `kt` the torque constant of a motor whose table is in A, N m/A; `suffix`
    that of the file, where one target writes several kinds; `fmi` the version of FMI of a unit, 2 or 3.

    Raises InputError for an effect that is impossible there and not left out.
    """
    model = model if isinstance(model, Model) else Model.load(model)
    if to not in TARGETS:
        raise InputError(f"to={to!r}: is no form that a model can take; choose {', '.join(TARGETS)}")
    if fmi not in FMI:
        raise InputError(f"fmi={fmi}: no unit has such a version; choose {' or '.join(map(str, FMI))}")
    if fmi != FMI[0] and to != "fmu":
        raise InputError(f"fmi={fmi}: is of a unit of FMI; leave it out of {to}")
    check_torque(model)
    for name in without:
        if name not in (EVERY, *model.effects):
            raise InputError(f"without {name}: is no effect of the model; it has {', '.join(model.effects)}")
    target: Target = import_module(f".{TARGETS[to]}", __name__).TARGET
    track = make_motion(motion, rate_hz=rate_hz) if isinstance(motion, str) else checked_track(motion)
    if abs(track.rate_hz - rate_hz) > _SAME_RATE * rate_hz:
        raise InputError(f"motion: has {track.rate_hz:g} samples a second; give one of rate_hz={rate_hz:g}")
    options = Options(rate_hz, kt, suffix, fmi, track)
    name = motion if isinstance(motion, str) else "given"
    whole = simulate(model, track, noise="none").tau
    fates, kept = _judged(model, target, options, without, (to, name, whole))
    form = target.write(kept, terms_of(kept), options._replace(header=_header(model, fates, name)))
    errors = {fate.effect: fate for fate in form.fates}
    form = form._replace(fates=tuple(errors.get(fate.effect, fate) for fate in fates))
    return Conversion(model, kept, to, name, form, _measured(target, form, kept, options, whole))


def _judged(
    model: Model,
    target: Target,
    options: Options,
    without: Sequence[str],
    about: tuple[str, str, FloatArray],
) -> tuple[tuple[Fate, ...], Model]:
    """Return what becomes of each effect, and the model of those that come along.

    It is frozen, so that no parameter is tied to one that does not. What is impossible and is not to be left
    out is refused, with what it would cost. `about` are the form, the motion and the whole model's torque.
    """
    to, name, whole = about
    fates, terms, kept = [], terms_of(model), []
    for fate in target.judge(model, terms, options):
        impossible = fate.kind == "impossible"
        if fate.effect in without or (impossible and EVERY in without):
            how = fate.how if impossible else "by request"
            cost = _cost(model, fate.effect, options.motion, whole)
            fates.append(Fate(fate.effect, "impossible", how, cost, left_out=True))
        elif impossible and terms[fate.effect].neutral:
            fates.append(Fate(fate.effect, "exact", "nothing: its values are those at which it does nothing"))
        else:
            fates.append(fate)
            kept.append(fate.effect)
    refused = [fate for fate in fates if fate.kind == "impossible" and not fate.left_out]
    if refused:
        costs = [f"{fate.effect} {_cost(model, fate.effect, options.motion, whole):.3g}" for fate in refused]
        raise InputError(
            f"model '{model.name}': impossible in {to}: {_reasons(refused)}; leave them out by name with "
            f"--without, or all of them with --without {EVERY}; that costs, in {model.torque_unit} RMS on "
            f"the motion {name}: {', '.join(costs)}"
        )
    if not kept:
        raise InputError(f"model '{model.name}': {to} can have nothing of it: {_reasons(fates)}")
    return tuple(fates), _only(model, kept)


def _reasons(fates: Sequence[Fate]) -> str:
    """Return the effects by why they are impossible."""
    names = {fate.how: [one.effect for one in fates if one.how == fate.how] for fate in fates}
    return "; ".join(f"{', '.join(found)} ({how})" for how, found in names.items())


def _cost(model: Model, effect: str, motion: MotionTrack, whole: FloatArray) -> float:
    """Return how far the torque of all other effects is from the whole one's, RMS, N m, where it moves."""
    others = [one for one in model.effects if one != effect]
    rest = _only(model, others)
    left = simulate(rest, motion, noise="none").tau if others else np.zeros_like(whole)
    return rms((whole - left)[moves(motion)])


def _only(model: Model, effects: Sequence[str]) -> Model:
    """Return a model of some of its effects, frozen: no parameter is tied to one that is not there."""
    return Model(model.frozen().core.only(list(effects)))


def _header(model: Model, fates: tuple[Fate, ...], motion: str) -> tuple[str, ...]:
    """Return what a file says of itself."""
    unit = model.torque_unit
    left_out = [
        f"Left out: {fate.effect} ({fate.how}), {fate.error:.3g} {unit} RMS on the motion {motion}."
        for fate in fates
        if fate.left_out
    ]
    return (f"{model.name or 'A model'} of knobcam, converted.", *left_out)


def _measured(target: Target, form: Form, kept: Model, options: Options, whole: FloatArray) -> Measured:
    """Return the torque along the motion of the model that was kept, and of what was written."""
    exact = simulate(kept, options.motion, noise="none").tau
    try:
        found: FloatArray | None = np.asarray(target.measure(form, kept, options), dtype=np.float64)
        why = ""
    except Unmeasured as error:
        found, why = None, str(error)
    return Measured(options.motion, exact, found, whole, why)
