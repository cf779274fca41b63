"""One of the five knobs with something hidden in it: what there is to find when no hardware is at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import InputError
from .effects import effect as catalogued
from .effects import effects
from .model import KNOBS, Model
from .typical import with_typical

if TYPE_CHECKING:
    from .effects import Effect

_NOT_NAMED = {
    "detent": "it belongs to the base model, which is fitted with it where it shows",
    "karnopp": "it does not show in a prediction from motion",
    "offset": "the two Coulomb levels take it up",
}
"""Effects that no search names, and why."""


def knob_name(text: str) -> str:
    """Return the name of one of the five knobs from its name or number.

    Raises InputError for any other.
    """
    name = f"knob{text}" if text.isdecimal() else text
    if name not in KNOBS:
        raise InputError(f"knob={text!r} is none of the five; choose 1 to {len(KNOBS)}")
    return name


def hiding(knob: str, *hidden: str) -> Model:
    """Return one of the five knobs with these effects hidden in it, of typical sizes.

    Raises InputError for an effect that the knob has anyway, that the catalogue does not have, or that is
    nothing to find.
    """
    name = knob_name(knob)
    model = Model.load(name)
    for effect in hidden:
        entry = catalogued(effect)
        why = f"{name} has it anyway" if effect in model.effects else _unfound(entry)
        if why:
            raise InputError(f"effect '{effect}' is nothing to hide: {why}; choose another")
        model = with_typical(model, entry)
    return model


def hideable(knob: str) -> list[str]:
    """Return the effects that can be hidden in one of the five knobs."""
    has = Model.load(knob_name(knob)).effects
    return [
        name
        for name, entry in effects().items()
        if name not in has and entry.needs in (None, *has) and not _unfound(entry)
    ]


def _unfound(entry: Effect) -> str | None:
    """Why nobody looks for this effect; None where somebody does."""
    if entry.describes:
        return "it describes a torque over position, whatever the cause"
    return _NOT_NAMED.get(entry.id)
