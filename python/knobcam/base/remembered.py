"""What was worked out of a thing, for as long as that lives."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TypeVar
from weakref import WeakKeyDictionary

One = TypeVar("One")
Told = TypeVar("Told")


def remembered(of: Callable[[One], Told]) -> Callable[[One], Told]:
    """Make a function of one immutable thing answer again what it did, without keeping the thing alive."""
    known: WeakKeyDictionary[One, Told] = WeakKeyDictionary()

    @functools.wraps(of)
    def told(one: One) -> Told:
        if one not in known:
            known[one] = of(one)
        return known[one]

    return told
