"""Signatures as their authors wrote them: `FloatArray`, where Sphinx would spell out what that stands for."""

from __future__ import annotations

import inspect
from typing import Any


class _Bare:
    """A word that a signature shows without quotes."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return self.text


def as_written(
    app: object, what: str, name: str, thing: Any, options: object, arguments: str | None, returns: str | None
) -> tuple[str, str] | None:
    """Return arguments and result of a function or class of the package; None for what is compiled."""
    if arguments is None or what not in ("class", "function", "method"):
        return None
    if getattr(thing, "_is_protocol", False):
        return "", ""  # nothing makes one
    try:
        signature = inspect.signature(thing)
    except ValueError:
        return None
    listed = list(signature.parameters.values())
    if what == "method" and listed and listed[0].name == "self":
        del listed[0]
    shown = signature.replace(
        parameters=[_shown(one) for one in listed], return_annotation=inspect.Signature.empty
    )
    result = signature.return_annotation if what != "class" else ""
    return str(shown), result if isinstance(result, str) else ""


def _shown(one: inspect.Parameter) -> inspect.Parameter:
    # Named tuples keep the text of an annotation in an object.
    written = getattr(one.annotation, "__forward_arg__", one.annotation)
    if isinstance(written, str):
        one = one.replace(annotation=_Bare(written))
    # A default that is made anew for each object has no spelling that could be read as Python.
    return one.replace(default=_Bare("...")) if repr(one.default) == "<factory>" else one


def skip_fields(app: object, what: str, name: str, thing: Any, skip: bool, options: object) -> bool | None:
    """Leave out fields of named tuples, which say "Alias for field number 0"; the signature has them."""
    return True if type(thing).__name__ == "_tuplegetter" else None
