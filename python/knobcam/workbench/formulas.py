"""Formulas as the page has them: of an axis that slides they are typed and read by x, v and dv/dt."""

from __future__ import annotations

import re

from ..errors import InputError
from ..model.own_law import own_law
from ..model.sliding import LAW_NAMES, NAME, read, written

_CHARACTER = re.compile(r"(?<=character )\d+")


def register(name: str, formula: str, coordinate: str) -> None:
    """Register a formula as the effect `name`.

    Raises InputError for what is no formula, by the character of what was typed.
    """
    law = read(formula, coordinate)
    try:
        own_law(name, law)
    except InputError as error:
        words = str(error).removeprefix(f"law of effect '{name}': ")  # who types it has not named it yet
        if law != formula:
            words = _CHARACTER.sub(lambda at: str(_place(formula, int(at.group()))), words)
            words = written(words, coordinate)
        raise InputError(words) from error


def _place(formula: str, at: int) -> int:
    """Return which character of a formula is the one at a place of its law, both from 1."""
    longer = 0  # the law by now
    for name in NAME.finditer(formula):
        begin, length = 1 + name.start(), len(LAW_NAMES.get(name.group(), name.group()))
        if at < begin + longer:
            break
        if at < begin + longer + length:
            return begin
        longer += length - len(name.group())
    return at - longer
