"""Prints `src/types.js`: the types of what Python tells the page, of the schema in `pages*.py`.

Needs nothing but Python, so that the page is built where the package is not installed.
"""

from __future__ import annotations

import runpy
import sys
import textwrap
import types
from pathlib import Path
from typing import Any, Literal, NotRequired, Union, get_args, get_origin, get_type_hints, is_typeddict

PACKAGE = Path(__file__).resolve().parents[1] / "python" / "knobcam"
SCHEMA = ("base.pages_said", "base.pages_left", "base.pages_next", "base.pages", "base.pages_sources")
HEAD = """/**
 * What the server and the reports tell. Made by `python3 dev.py page` of pages*.py in python/knobcam/base.
 */
"""
PLAIN = {str: "string", int: "number", float: "number", bool: "boolean", type(None): "null"}
WIDTH = 112
FAST = "\0"  # a blank inside a field, where no line ends


def javascript(hint: Any) -> str:
    """Return a type of the schema as JSDoc writes it."""
    if hint in PLAIN:
        return PLAIN[hint]
    if is_typeddict(hint):
        return str(hint.__name__)
    origin, inside = get_origin(hint), get_args(hint)
    if origin is Literal:
        return " | ".join(f'"{value}"' for value in inside)
    told = [javascript(one) for one in inside]
    if origin in (Union, types.UnionType):
        return " | ".join(told)
    if origin is list:
        return f"({told[0]})[]" if " | " in told[0] else f"{told[0]}[]"
    if origin is dict and inside[0] is str:
        return f"Record<string, {told[1]}>"
    if origin is tuple:
        return f"[{', '.join(told)}]"
    raise TypeError(f"{hint!r} is nothing that JSON has")


def typedef(shape: Any) -> str:
    """Return a class of the schema as a comment that declares its type."""
    fields = []
    for name, hint in get_type_hints(shape, include_extras=True).items():
        hint = get_args(hint)[0] if get_origin(hint) is NotRequired else hint
        field = f"{name}{'' if name in shape.__required_keys__ else '?'}: {javascript(hint)}"
        fields.append(field.replace(" ", FAST))
    whole = f"@typedef {{{{{', '.join(fields)}}}}} {shape.__name__}"
    law = textwrap.wrap(whole, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
    said = textwrap.dedent(f"    {shape.__doc__}").strip().splitlines()
    if len(short := " ".join([*said, *law]).replace(FAST, " ")) <= WIDTH - 5:
        return f"/** {short} */"
    return "\n".join(["/**", *(f" * {line}".rstrip().replace(FAST, " ") for line in said + law), " */"])


def module() -> str:
    """Return the whole file."""
    sys.path.insert(0, str(PACKAGE))
    found = (one for name in SCHEMA for one in runpy.run_module(name).items())
    shapes = [one for one in dict(found).values() if is_typeddict(one)]
    sys.path.remove(str(PACKAGE))
    return "\n".join([HEAD, *(f"{typedef(shape)}\n" for shape in shapes), "export {};\n"])


if __name__ == "__main__":
    print(module(), end="")
