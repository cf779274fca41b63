"""One of the five knobs with something hidden in it: what there is to find when no hardware is at hand."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from ..base.door import checked
from ..errors import InputError
from .effects import effect as catalogued
from .effects import effects
from .model import KNOBS, Model
from .typical import Carrier, with_typical

if TYPE_CHECKING:
    from ..capture.motions import MotionTrack
    from .effects import Effect
    from .simulate import SensorNoise

_NOT_NAMED = {
    "detent": "it belongs to the base model, which is fitted with it where it shows",
    "karnopp": "it does not show in a prediction from motion",
    "offset": "the dry friction of the two directions takes it up",
}
"""Effects that no search names, and why."""
LEAST = 1.6
"""An effect that makes less of the error than this, in noise floors, leaves nothing to look for."""


def knob_name(text: str) -> str:
    """Return the name of one of the five knobs from its name or number.

    Raises InputError for any other.
    """
    name = f"knob{text}" if text.isdecimal() else text
    if name not in KNOBS:
        raise InputError(f"knob={text!r} is none of the five; choose 1 to {len(KNOBS)}")
    return name


@checked
def hiding(
    knob: str,
    *hidden: str,
    motion: str | MotionTrack = "sweep",
    noise: str | SensorNoise = "ranged",
    duration_s: float = 6.0,
) -> Model:
    """Return one of the five knobs with these effects hidden in it.

    Each has the size that is ordinary on this knob and shows in such a `motion` to sensors of such `noise`,
    arguments as in `simulate`.

    Raises InputError for an effect that the knob has anyway, that the catalogue does not have, or that is
    nothing to find, with the knobs in which it is.
    """
    name = knob_name(knob)
    bare = Model.load(name)
    carrier = Carrier.of(bare, motion, noise, duration_s)
    model = bare
    for effect in hidden:
        entry = catalogued(effect)
        if why := _refusal(carrier, entry, name):
            others = [] if _unfound(entry) else _others(name, entry, motion, noise, duration_s)
            instead = f"hide it in {' or '.join(others)}" if others else "choose another"
            raise InputError(f"effect '{effect}' is nothing to hide: {why}; {instead}")
        model = with_typical(model, entry, carrier)
    return model


def hideable(
    knob: str,
    motion: str | MotionTrack = "sweep",
    noise: str | SensorNoise = "ranged",
    duration_s: float = 6.0,
) -> list[str]:
    """Return the effects that can be hidden in one of the five knobs, and found in such a motion."""
    name = knob_name(knob)
    if isinstance(motion, str) and isinstance(noise, str):
        return list(_known(name, tuple(effects()), motion, noise, duration_s))
    return list(_offered(name, tuple(effects()), motion, noise, duration_s))


def _offered(
    name: str,
    catalogue: tuple[str, ...],
    motion: str | MotionTrack,
    noise: str | SensorNoise,
    duration_s: float,
) -> tuple[str, ...]:
    """Return those of the catalogue that the knob can hide."""
    carrier = Carrier.of(Model.load(name), motion, noise, duration_s)
    return tuple(id for id in catalogue if not _refusal(carrier, catalogued(id), name))


# Once for each knob and motion: sizes take a while.
_known = lru_cache(64)(_offered)


def _refusal(carrier: Carrier, entry: Effect, name: str) -> str | None:
    """Why a knob does not hide an effect; None where it can."""
    if entry.id in carrier.model.effects:
        return f"{name} has it anyway"
    return _unfound(entry) or _hopeless(carrier, entry, name)


def _unfound(entry: Effect) -> str | None:
    """Why nobody looks for this effect; None where somebody does."""
    if entry.describes:
        return "it describes a torque over position, whatever the cause"
    return _NOT_NAMED.get(entry.id)


def _hopeless(carrier: Carrier, entry: Effect, name: str) -> str | None:
    """Why this knob cannot hide the effect in this motion; None where it can."""
    if entry.needs not in (None, *carrier.model.effects):
        return f"it changes '{entry.needs}', which {name} does not have"
    cost = carrier.cost(entry)
    if cost is None or cost.times < LEAST:
        least = 1.0 if cost is None else cost.times
        return (
            f"in {name} and this motion an ordinary size of it makes an error of {least:.2f} noise floors, "
            f"and {LEAST:g} would stand out"
        )
    return None


def _others(
    name: str, entry: Effect, motion: str | MotionTrack, noise: str | SensorNoise, duration_s: float
) -> list[str]:
    """The knobs that can hide it in this motion."""
    carriers = {
        knob: Carrier.of(Model.load(knob), motion, noise, duration_s) for knob in KNOBS if knob != name
    }
    return [knob for knob, carrier in carriers.items() if not _refusal(carrier, entry, knob)]
