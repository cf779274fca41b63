"""The door of the public functions: what comes in is of the kind that its annotation says, or is refused.

One place for all of them. What a value means, and whether it is in range, the functions themselves ask.
"""

from __future__ import annotations

import inspect
import math
import numbers
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

from ..errors import InputError

_P = ParamSpec("_P")
_R = TypeVar("_R")
_LONGEST = 60  # characters of what came, in a message


def checked(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Refuse arguments of another kind than their annotations say: InputError with name, value and wish.

    >>> @checked
    ... def half(rate_hz: float) -> float:
    ...     return rate_hz / 2.0
    >>> half("fast")
    Traceback (most recent call last):
    knobcam.errors.InputError: rate_hz: is the text 'fast'; give a number
    """
    signature = inspect.signature(function)
    kinds = {name: _alternatives(str(one.annotation)) for name, one in signature.parameters.items()}
    many = {one.name: one.kind for one in signature.parameters.values()}

    @wraps(function)
    def inside(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        for name, value in signature.bind(*args, **kwargs).arguments.items():
            if many[name] is inspect.Parameter.VAR_KEYWORD:
                for key, each in value.items():
                    _check(key, each, kinds[name])
            elif many[name] is inspect.Parameter.VAR_POSITIONAL:
                for each in value:
                    _check(name, each, kinds[name])
            else:
                _check(name, value, kinds[name])
        return function(*args, **kwargs)

    return inside


def check(name: str, value: object, kind: str) -> None:
    """Refuse a value of another kind than an annotation says."""
    _check(name, value, _alternatives(kind))


def described(value: object) -> str:
    """Return what came, for a message: short, whatever it is."""
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} ({value.dtype})"
    if value is None:
        return "None"
    if isinstance(value, str):
        return f"the text {_short(value)}"
    if isinstance(value, float) and math.isnan(value):
        return "NaN"
    plain = isinstance(value, bool | numbers.Number)
    return f"{_short(value)} ({type(value).__name__})" if plain else _article(type(value).__name__)


def _short(value: object) -> str:
    try:
        text = repr(value)
    except ValueError:  # a whole number of thousands of digits
        text = "a number"
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _article(name: str) -> str:
    return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"


def _alternatives(annotation: str) -> tuple[str, ...]:
    """Split a union at its bars, those in brackets left alone."""
    parts, depth = [""], 0
    for letter in annotation:
        depth += (letter == "[") - (letter == "]")
        if letter == "|" and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return tuple(part.strip() for part in parts)


def _check(name: str, value: object, kinds: tuple[str, ...]) -> None:
    if any(_fits(name, value, kind) for kind in kinds):
        return
    wish = " or ".join(dict.fromkeys(_WORDS.get(kind) or _in_words(kind) for kind in kinds))
    raise InputError(f"{name}: is {described(value)}; give {wish}")


def _in_words(kind: str) -> str:
    outer, inner = _inside(kind)
    if outer in _EVERY:
        words = " or ".join(_WORDS.get(one) or _in_words(one) for one in _alternatives(inner.split(",")[0]))
        return f"a list of such ({words})"
    return _WORDS.get(outer) or _article(outer)


def _inside(kind: str) -> tuple[str, str]:
    found = re.fullmatch(r"([\w.]+)\[(.*)\]", kind)
    return (found[1], found[2]) if found else (kind, "")


def _fits(name: str, value: object, kind: str) -> bool:
    if kind in _TESTS:
        return _TESTS[kind](value)
    outer, inner = _inside(kind)
    if outer == "Iterable" and not isinstance(value, Collection):
        return isinstance(value, Iterable)  # to look at what gives its content but once would use it up
    if outer in _EVERY:
        if isinstance(value, str):
            return outer != "Sequence"  # which the function refuses by itself
        if (
            not isinstance(value, Collection)
            or not isinstance(value, _EVERY[outer])
            or getattr(value, "ndim", 1) == 0
        ):
            return False
        for each in value:
            _check(name, each, _alternatives(inner))
        return True
    if outer in _OPEN:
        return isinstance(value, _OPEN[outer])
    if not re.fullmatch(r"[A-Z]\w+|_core\.\w+", outer) or outer in _ANY:
        return True
    return any(one.__name__ == outer.rpartition(".")[2] for one in type(value).__mro__)


def is_number(value: object) -> bool:
    """Whether it is a real number that a float can hold; NaN is none."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Real):
        return False
    try:
        return not math.isnan(float(value))
    except OverflowError:
        return False


def _is_whole(value: object) -> bool:
    return isinstance(value, numbers.Integral) and not isinstance(value, bool) and abs(int(value)) < 2**63


_TESTS: Mapping[str, Callable[[object], bool]] = {
    "None": lambda value: value is None,
    "str": lambda value: isinstance(value, str),
    "bool": lambda value: isinstance(value, bool | np.bool_),
    "float": is_number,
    "int": _is_whole,
    "os.PathLike[str]": lambda value: isinstance(value, os.PathLike),
    "ArrayLike": lambda value: value is not None,  # its content is asked for by name
    "ColumnMap": lambda value: isinstance(value, str | Iterable) and not isinstance(value, np.ndarray),
    "Coordinate": lambda value: isinstance(value, str),
    "Limit": lambda value: isinstance(value, str),
    "Acts": lambda value: isinstance(value, str),
    "Clears": lambda value: isinstance(value, bool | np.bool_) or callable(value),
}
_WORDS = {
    "None": "None",
    "str": "a text",
    "bool": "True or False",
    "float": "a number",
    "int": "a whole number",
    "os.PathLike[str]": "a path",
    "ArrayLike": "an array of numbers",
    "ColumnMap": "a text, a list or a dict of them",
    "Coordinate": "a text",
    "Limit": "a text",
    "Acts": "a text",
    "Clears": "True, False or a function",
    "Mapping": "a dict",
    "Iterable": "a list",
    "Callable": "a function",
}
_EVERY: Mapping[str, Any] = {"Sequence": Sequence, "Collection": Collection, "Iterable": Iterable}
_OPEN: Mapping[str, Any] = {"Mapping": Mapping, "Callable": Callable}
_ANY = {"Any", "Controller", "Handle", "Watch", "Law"}
"""What only has to have a method, which is asked for when it is called."""
