"""Documents as JSON that every reader takes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def as_json(document: Mapping[str, Any], indent: int | None = 1) -> str:
    """Return the document as JSON; numbers that JSON does not have (nan, inf) become null."""
    return json.dumps(plain(document), allow_nan=False, indent=indent)


def island(document: Mapping[str, Any], name: str) -> str:
    """Return a document as an element of a page, which has it without asking for it."""
    # No text of a file can end the element: JSON has another way to write its first letter.
    held = as_json(document, indent=None).replace("<", "\\u003c")
    return f'<script type="application/json" id="{name}">{held}</script>'


def plain(value: Any) -> Any:
    """Return the same of what JSON has: maps, lists, text and finite numbers; others become null."""
    if isinstance(value, float):  # as most are
        return value if math.isfinite(value) else None
    if isinstance(value, str):
        return readable(value)
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, Mapping):
        return {readable(str(key)): plain(item) for key, item in value.items()}
    return readable(str(value)) if isinstance(value, Path) else value


def readable(text: str) -> str:
    """Return a text with what is no letter as its escape, as the bytes are of a name that is not UTF-8."""
    return text if text.isascii() else text.encode("utf-8", "backslashreplace").decode("utf-8")
