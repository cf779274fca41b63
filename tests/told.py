"""Whether JSON has the shape that `knobcam.base.pages` says."""

from __future__ import annotations

import types
from typing import Any, Literal, NotRequired, get_args, get_origin, get_type_hints, is_typeddict


def check(value: Any, hint: Any, where: str = "it") -> None:
    """Assert that a value that came as JSON has a shape: no field more, none less, each of its type."""
    origin, inside = get_origin(hint), get_args(hint)
    if is_typeddict(hint):
        assert isinstance(value, dict), f"{where} is no {hint.__name__}: {value!r}"
        fields = get_type_hints(hint)
        missing, unknown = hint.__required_keys__ - value.keys(), value.keys() - fields.keys()
        assert not missing, f"{where} has no {sorted(missing)}, which {hint.__name__} asks for"
        assert not unknown, f"{where} has {sorted(unknown)}, of which {hint.__name__} knows nothing"
        for name, one in value.items():
            check(one, fields[name], f"{where}.{name}")
    elif origin is types.UnionType:
        assert any(fits(value, one) for one in inside), f"{where} is no {hint}: {value!r}"
    elif origin is Literal:
        assert value in inside, f"{where} is none of {inside}: {value!r}"
    elif origin is NotRequired:
        check(value, inside[0], where)
    elif origin is list:
        assert isinstance(value, list), f"{where} is no list: {value!r}"
        for at, one in enumerate(value):
            check(one, inside[0], f"{where}[{at}]")
    elif origin is tuple:
        assert isinstance(value, list) and len(value) == len(inside), f"{where} is no {hint}: {value!r}"
        for at, (one, of) in enumerate(zip(value, inside, strict=True)):
            check(one, of, f"{where}[{at}]")
    elif origin is dict:
        assert isinstance(value, dict), f"{where} is no {hint}: {value!r}"
        for name, one in value.items():
            check(one, inside[1], f"{where}.{name}")
    else:
        number = isinstance(value, int | float) and not isinstance(value, bool)
        right = number if hint is float else type(value) is hint
        assert right, f"{where} is no {hint}: {value!r}"


def fits(value: Any, hint: Any) -> bool:
    """Whether a value has a shape."""
    try:
        check(value, hint)
    except AssertionError:
        return False
    return True
