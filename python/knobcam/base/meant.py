"""What a word that nobody knows may have been meant for."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

_NAMED = 3
_ALIKE = 0.7  # of all letters, as difflib counts: a few that changed places, are missing or too many
_PART = 4  # letters of a name's part that is no chance


def meant(word: str, known: Iterable[str]) -> str:
    """Return what a word may have been meant for, as words to stand between semicolons; else nothing."""
    from difflib import get_close_matches  # where something is wrong alone

    names = {one.strip("-").lower(): one for one in known}
    low = word.strip("-").lower().replace(" ", "_")
    parts = [one for one in names if len(low) >= _PART and low in one]
    near = get_close_matches(low, names, _NAMED, _ALIKE)
    found = list(dict.fromkeys(names[one] for one in [*near, *parts]))[:_NAMED]
    return f"perhaps {' or '.join(found)}" if found else ""
