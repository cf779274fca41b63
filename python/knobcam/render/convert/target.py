"""What a target is: how it judges each effect, what it writes, and how what it wrote is measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from ...errors import InputError
from ..renderer import Device, Renderer
from .conversion import Fate, Form

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from ...capture.motions import MotionTrack
    from ...model import Model
    from .terms import Term

IMPOSED = Device(1e-15, 0.0, 0, encoder_step_rad=0.0, held=True)
"""A handle that adds nothing to what is rendered, and whose motion is imposed."""
OF_THE_SENSOR = "acts on the torque sensor of the measuring rig, not on the knob"
"""Why an effect of the sensor is nowhere converted: nothing would feel it."""
IN_PYTHON = "is a function in Python, which runs nowhere else"
FROM_THE_STEP = "the render step"
BY_PLACE = "a torque by position alone is all that it has"


class Options(NamedTuple):
    """What a caller may choose: steps a second, a motor's torque constant, the file's suffix, FMI, motion."""

    rate_hz: float
    kt: float | None
    suffix: str
    fmi: int
    motion: MotionTrack
    header: tuple[str, ...] = ()
    """What the file says of itself: the model, and what was left out of it."""


class Unmeasured(Exception):
    """Why what was written could not be measured here."""


class Target(NamedTuple):
    """One form in which a model leaves."""

    judge: Callable[[Model, Mapping[str, Term], Options], tuple[Fate, ...]]
    write: Callable[[Model, Mapping[str, Term], Options], Form]
    measure: Callable[[Form, Model, Options], FloatArray]


def rendered(model: Model, rate_hz: float) -> Renderer:
    """Return the step of a model. InputError for one that would feed a hand, which nothing forces here."""
    try:
        return Renderer(model, rate_hz)
    except InputError as error:
        why = str(error).replace("; correct it, or force it", "; correct it")
        raise InputError(f"model '{model.name}': {why}") from None


def judged_by_the_step(model: Model, terms: Mapping[str, Term], options: Options) -> tuple[Fate, ...]:
    """Judge the effects where the render step itself runs: what it renders is exact."""
    return tuple(_by_the_step(term) for term in terms.values())


def _by_the_step(term: Term) -> Fate:
    if term.place == "sensor":
        return Fate(term.effect, "impossible", OF_THE_SENSOR)
    if term.calls_out:
        return Fate(term.effect, "impossible", IN_PYTHON)
    return Fate(term.effect, "exact", FROM_THE_STEP)
