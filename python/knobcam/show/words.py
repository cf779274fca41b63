"""What effects, parameters and units are called in pictures and reports: as on the page, never by ids."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ..base.said import OfAxis, OfEffect, OfParam, Said
from ..fit.diagnose import LEAST_P, p_in_words
from ..model.effects import effects

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_PARAM = re.compile(r"(\w+\.\w+)")
_BRIEF = re.compile("[,;] ")
"""Behind which stands what else is to be known of a parameter."""
SHORT = {"N s^2/m": "kg", "N m s^2/rad": "kg m²", "1": ""}
"""Units with a shorter name; the radian is left out, as everybody does."""


def effect_word(effect: str, coordinate: str) -> str:
    """Return an effect in two or three words; one that is nowhere catalogued by its id."""
    known = effects(coordinate).get(effect)
    return effect if known is None else known.title


def param_word(name: str, coordinate: str) -> str:
    """Return a parameter by its effect's words and its own letters, as there is room for in a picture."""
    effect, _, own = name.partition(".")
    return f"{effect_word(effect, coordinate)}: {own}"


def param_phrase(name: str, coordinate: str) -> str:
    """Return a parameter by what it is and of which effect; with its letter where that has several alike."""
    effect, _, own = name.partition(".")
    known = effects(coordinate).get(effect)
    if known is None:
        return f"{own} ({effect})"  # of a law of one's own there are its letters alone
    words = {one.name: _BRIEF.split(one.meaning)[0] for one in known.params}
    letter = own.partition("@")[0]
    what = words[letter]
    what += f" {letter}" if [*words.values()].count(what) > 1 else ""
    return what if known.title in what else f"{what} ({known.title})"


def axis_word(axis: str) -> str:
    """Return what an axis is called."""
    return "distance since reversal" if axis == "history" else axis


def and_words(several: Sequence[str]) -> str:
    """Return several words as one speaks: a, b and c."""
    return _listed(several, "and")


def or_words(several: Sequence[str]) -> str:
    """Return the same of which one is meant: a, b or c."""
    return _listed(several, "or")


def axis_tick(axis: str) -> str:
    """Return the same where there is little room."""
    return "since reversal" if axis == "history" else axis


def _listed(several: Sequence[str], between: str) -> str:
    *head, last = several
    return f"{', '.join(head)} {between} {last}" if head else last


def with_params(said: str, params: Iterable[str], coordinate: str) -> str:
    """Return text in which parameters of a model stand by their names with these in words."""
    known = {*params}
    words = _PARAM.split(said)
    return "".join(param_phrase(one, coordinate) if one in known else one for one in words)


def unit_word(unit: str) -> str:
    """Return a unit as a person writes it; nothing for what has none."""
    return SHORT.get(unit, unit.replace("^2", "²").replace("^3", "³"))


def p_word(p_value: float, digits: str) -> str:
    """Return a p-value with so many digits; a bound where it is no more than one."""
    return f"p {bound_word(p_in_words(p_value))}" if p_value <= LEAST_P else f"p = {p_value:{digits}}"


def bound_word(text: str) -> str:
    """Return text with the sign of a bound as a person writes it."""
    return text.replace("<= ", "≤\u00a0").replace("> ", ">\u00a0")


def worded(said: str, coordinate: str) -> str:
    """Return text with effects and parameters in words, where it is a sentence that knows them."""
    if not isinstance(said, Said):
        return said
    told = []
    for part in said.parts:
        if isinstance(part, OfEffect):
            told.append(effect_word(part.effect, coordinate))
        elif isinstance(part, OfParam):
            told.append(param_phrase(part.param, coordinate))
        elif isinstance(part, OfAxis):
            told.append(axis_word(part.along))
        else:
            told.append(str(part))
    return "".join(told)


def sentence(said: Said, coordinate: str) -> str:
    """Return the same as a sentence of its own."""
    words = worded(said, coordinate)
    return words[:1].upper() + words[1:]
