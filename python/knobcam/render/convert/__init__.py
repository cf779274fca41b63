"""Models that leave: in another form, with every effect said to be exact, approximate or impossible there."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...base.door import checked
from ...capture.motions import MotionTrack
from ...capture.motions import motion as make_motion
from ...errors import InputError
from ...model import Model
from ...model.simulate import simulate
from ..renderer import check_torque
from .conversion import Conversion, Fate, Form, Measured
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
EVERY = "impossible"
"""What stands for every impossible effect among those to be left out."""


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
) -> Conversion:
    """Return `model` (or its file or name) in another form: mujoco, c, fmu, cogging-table, urdf, modelica.

    `without` names effects to be left out, `"impossible"` all that have no place there; the files then say
    so. `motion` is what the torque error is foretold and measured on, a name or a track; `rate_hz` the steps
    a second of a form that steps; `kt` the torque constant of a motor whose table is in A, N m/A; `suffix`
    that of the file, where one target writes several kinds.

    Raises InputError for an effect that is impossible there and not left out.
    """
    model = model if isinstance(model, Model) else Model.load(model)
    if to not in TARGETS:
        raise InputError(f"to={to!r}: is no form that a model can take; choose {', '.join(TARGETS)}")
    check_torque(model)
    for name in without:
        if name not in (EVERY, *model.effects):
            raise InputError(f"without {name}: is no effect of the model; it has {', '.join(model.effects)}")
    target: Target = import_module(f".{TARGETS[to]}", __name__).TARGET
    track = make_motion(motion, rate_hz=rate_hz) if isinstance(motion, str) else motion
    options = Options(rate_hz, kt, suffix, track)
    fates = _judged(model, target, options, without, to)
    kept = _without(model.frozen(), [fate.effect for fate in fates if fate.left_out], to)
    form = target.write(kept, terms_of(kept), options._replace(header=_header(model, fates)))
    errors = {fate.effect: fate for fate in form.fates}
    form = form._replace(fates=tuple(errors.get(fate.effect, fate) for fate in fates))
    name = motion if isinstance(motion, str) else "given"
    return Conversion(model, kept, to, name, form, _measured(target, form, kept, options))


def _judged(
    model: Model, target: Target, options: Options, without: Sequence[str], to: str
) -> tuple[Fate, ...]:
    """Return what becomes of each effect; what is impossible and not left out is refused."""
    terms = terms_of(model)
    fates = tuple(
        Fate(fate.effect, "exact", "its values are those at which it does nothing")
        if fate.kind == "impossible" and terms[fate.effect].neutral
        else fate
        for fate in target.judge(model, terms, options)
    )
    impossible = [fate for fate in fates if fate.kind == "impossible"]
    refused = [fate for fate in impossible if fate.effect not in without and EVERY not in without]
    if refused:
        said = "; ".join(f"{fate.effect} {fate.how}" for fate in refused)
        raise InputError(
            f"model '{model.name}': impossible in {to}: {said}; leave out what has no place there with "
            f"--without {' '.join(fate.effect for fate in refused)}, or --without {EVERY}"
        )
    dropped = {fate.effect for fate in impossible} | {name for name in without if name != EVERY}
    return tuple(fate._replace(kind="impossible", left_out=True) if fate.effect in dropped else fate for fate in fates)


def _without(model: Model, dropped: Sequence[str], to: str) -> Model:
    """Return the model without these effects; it is frozen, so that no parameter is tied to one of them."""
    kept = [name for name in model.effects if name not in dropped]
    if not kept:
        raise InputError(f"model '{model.name}': nothing of it is left that {to} could have; see {to} in the docs")
    return Model(model.core.only(kept))


def _header(model: Model, fates: tuple[Fate, ...]) -> tuple[str, ...]:
    """Return what a file says of itself."""
    lines = [f"{model.name or 'A model'} of knobcam, converted."]
    return (*lines, *(f"Left out: {fate.effect}, which {fate.how}." for fate in fates if fate.left_out))


def _measured(target: Target, form: Form, kept: Model, options: Options) -> Measured:
    """Return the torque along the motion of the model that was kept, and of what was written."""
    exact = simulate(kept, options.motion, noise="none").tau
    try:
        found: FloatArray | None = np.asarray(target.measure(form, kept, options), dtype=np.float64)
        why = ""
    except Unmeasured as error:
        found, why = None, str(error)
    return Measured(options.motion, exact, found, why)
