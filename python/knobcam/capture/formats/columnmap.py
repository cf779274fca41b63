"""The column map: which column, times what, in which unit, is theta."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ...errors import InputError

TARGETS = ("t", "theta", "omega", "alpha", "tau")
"""The columns of a capture, which are the names a map may assign."""

_ASSIGNMENT = re.compile(r"(?:^|[\s,;])([A-Za-z_]\w*)\s*=")
_UNIT = re.compile(r"(?P<expression>.*)\[(?P<unit>[^\[\]]*)\]\s*", re.DOTALL)

ColumnMap = str | Iterable[str] | Mapping[str, str]
"""`"t=c0, theta=c1/8192 [turn]"`, a list of such texts, or `{"t": "c0", "theta": "c1/8192 [turn]"}`."""


@dataclass(frozen=True)
class Entry:
    """One line of a map: an expression over columns and the unit it is in (None: SI)."""

    expression: str
    unit: str | None

    @property
    def plain(self) -> bool:
        """Whether it is a column as it stands, and nothing is computed."""
        return re.fullmatch(r"`[^`]*`|[A-Za-z_][\w.]*", self.expression) is not None

    @property
    def column(self) -> str:
        """The name of the column of a plain entry."""
        return self.expression.strip("`")

    def __str__(self) -> str:
        return self.expression if self.unit is None else f"{self.expression} [{self.unit}]"


def parse_map(column_map: ColumnMap) -> dict[str, Entry]:
    """Return the entries of a map by target; InputError names what cannot be read.

    An angle or a torque may be absent: the names of a file may say the rest.
    """
    if isinstance(column_map, Mapping):
        pairs = [(str(target).strip(), str(text)) for target, text in column_map.items()]
    elif isinstance(column_map, str):
        pairs = _split(column_map)
    else:
        pairs = [pair for text in column_map for pair in _split(str(text))]
    entries: dict[str, Entry] = {}
    for target, text in pairs:
        if target not in TARGETS:
            raise InputError(f"map: {target!r} is not a column of a capture; assign {', '.join(TARGETS)}")
        if target in entries:
            raise InputError(f"map: {target} is assigned twice; leave one out")
        entries[target] = _entry(target, text)
    return entries


def lacking(entries: Mapping[str, Entry]) -> str | None:
    """Return what a capture needs and a map does not have; None where it has all."""
    return next((target for target in ("theta", "tau") if target not in entries), None)


def _split(text: str) -> list[tuple[str, str]]:
    """Split at every `name =`: an expression holds no equals sign, so commas and blanks both separate."""
    hidden = re.sub(r"`[^`]*`", lambda quoted: "`" + "_" * (len(quoted[0]) - 2) + "`", text)
    starts = list(_ASSIGNMENT.finditer(hidden))
    if not starts or hidden[: starts[0].start()].strip(" ,;"):
        raise InputError(
            f"map: {text!r} cannot be read; write it like 't=time, theta=pos/8192 [turn], tau=M'"
        )
    ends = [start.start() for start in starts[1:]] + [len(text)]
    return [(start[1], text[start.end() : end]) for start, end in zip(starts, ends, strict=True)]


def _entry(target: str, text: str) -> Entry:
    expression, unit = text.strip(" \t\r\n,;"), None
    if found := _UNIT.fullmatch(expression):
        expression, unit = found["expression"].strip(), found["unit"].strip()
        if not unit:
            raise InputError(f"map: {target} has an empty unit []; leave the brackets out for SI")
    if not expression:
        raise InputError(f"map: {target} is assigned nothing; write {target}=COLUMN")
    return Entry(expression, unit)
