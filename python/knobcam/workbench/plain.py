"""What was found in a log, as the page says it: columns by words, and no words of the command line."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ..capture.formats.units import GIVEN

if TYPE_CHECKING:
    from ..capture import Capture
    from ..capture.finding import Finding

_AGAIN = "if it is otherwise, open the file once more and say which column is which"
_WAYS = (
    (re.compile(r" ?\((?:[^()]*?)(?:--[a-z]|[a-z_]+= )[^()]*\)"), ""),  # options
    (
        re.compile(r", unless it is the drive's limit$"),
        ", unless it is the drive's limit: then switch it off",
    ),
    (re.compile(r"; --start and --end choose [^;]*"), ""),
    (re.compile(r" with --start and --end"), ""),
    (re.compile(r" with --overrule \S+"), ""),
    (re.compile(r"a (?:unit in the )?map says otherwise"), _AGAIN),
)
"""Advice of a command, and what it is where there are buttons."""

_MASKED = re.compile(r"[;:] masked$")
"""What stands at the head already, or no longer is so."""

_TORQUES = GIVEN | {"N": "force"}
_COLUMN = re.compile(r"\b(theta|omega|alpha|tau|t)\b(?! =)(?=[: ,;)]|$)")


def in_words(finding: Finding, capture: Capture) -> str:
    """Return a finding of a capture as a person reads it on a page, what was done about it first."""
    said = finding.message
    for way, words in _WAYS:
        said = way.sub(words, said)
    if finding.severity == "masked" or finding.overruled:
        said = _MASKED.sub("", said)
    if not said.startswith("columns"):  # of which the names of the program are told there
        said = _COLUMN.sub(lambda found: _names(capture)[found.group()], said)
    return f"{finding.severity}: {said}"


def _names(capture: Capture) -> dict[str, str]:
    """What the columns are called, by their names in the program."""
    position = "position" if capture.coordinate == "linear" else "angle"
    names = {"theta": position, "omega": "velocity", "alpha": "acceleration", "t": "time"}
    return names | {"tau": _TORQUES.get(capture.torque_unit, "torque")}
