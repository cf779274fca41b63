"""Parameters of parts as statistics programs of the industry take them: Q-DAS ASCII transfer format, `.dfq`.

Lines of a key and a value; `K2002/3` is a key of the third characteristic. Written and read are K0100 (how
many there are), K1001 (part number), K2001, K2002, K2110, K2111 and K2142 (number, name, limits, unit of
each), and of each part K0001 (value), K0002 (0: valid), K0004 (time), K0006 (lot), K0014 (the part itself).
Other keys are read over.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime

from ..base.reading import read_text
from ..errors import InputError
from .row import Row

_LINE = re.compile(r"(K\d{4})(?:/(\d+))?\s?(.*)")
_MISSING = 256
_VALID_BELOW = 255
_MOST_BYTES = 2**30
_TIME = "%d.%m.%Y/%H:%M:%S"


@dataclass
class Characteristic:
    """A parameter of parts: limits in its unit, None for none, a value for each part, NaN if unknown."""

    name: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    values: list[float] = field(default_factory=list)
    times: list[str] = field(default_factory=list)
    lots: list[str] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)


def text(rows: Sequence[Row], characteristics: Sequence[Characteristic], part: str) -> str:
    """Return the content of a file: rows of a batch, by characteristics whose values are still empty."""
    lines = [f"K0100 {len(characteristics)}", f"K1001/1 {_plain(part)}"]
    for at, one in enumerate(characteristics, 1):
        lines += [f"K2001/{at} {at}", f"K2002/{at} {_plain(one.name)}", f"K2004/{at} 0"]
        lines += [
            f"{key}/{at} {edge!r}"
            for key, edge in (("K2110", one.low), ("K2111", one.high))
            if edge is not None
        ]
        lines.append(f"K2142/{at} {_plain(one.unit)}")
    for row in rows:
        when = datetime.fromisoformat(row["time"]).strftime(_TIME) if row["time"] else None
        about = {"K0004": when, "K0006": row["lot"], "K0014": row["capture"]}
        for at, one in enumerate(characteristics, 1):
            value = row["params"].get(one.name, [None])[0]
            lines.append(f"K0001/{at} {0.0 if value is None else value!r}")
            lines.append(f"K0002/{at} {_MISSING if value is None else 0}")
            lines += [f"{key}/{at} {_plain(said)}" for key, said in about.items() if said]
    return "\r\n".join(lines) + "\r\n"


def read(path: str) -> list[Characteristic]:
    """Return the characteristics in a file with their values; InputError, with the line, for what is none."""
    return parse(read_text(path, "file of AQDEF", _MOST_BYTES), path)


def is_dfq(content: str) -> bool:
    """Whether a text begins as such a file does."""
    return content.lstrip("\ufeff \r\n").startswith("K0100")


def parse(content: str, path: str) -> list[Characteristic]:
    """Return the characteristics in the text of a file."""
    found: dict[int, Characteristic] = {}
    for number, line in enumerate(content.lstrip("\ufeff").splitlines(), 1):
        if not line.strip():
            continue
        match = _LINE.fullmatch(line.rstrip())
        if match is None or (number == 1 and match[1] != "K0100"):
            raise InputError(
                f"{path}, line {number}: {line[:40]!r} is no key and value of AQDEF; export it again"
            )
        key, at, value = match[1], int(match[2] or 1), match[3].strip()
        try:
            _take(found, key, at, value)
        except ValueError:
            raise InputError(f"{path}, line {number}: {key} is {value!r}, a number is needed") from None
    return [found[at] for at in sorted(found)]


def _take(found: dict[int, Characteristic], key: str, at: int, value: str) -> None:
    """Take one line; ValueError for a value that is no number where one is needed."""
    if key[1] == "2":
        one = found.setdefault(at, Characteristic(""))
        if key == "K2002":
            one.name = value
        elif key == "K2142":
            one.unit = value
        elif key == "K2110":
            one.low = _number(value)
        elif key == "K2111":
            one.high = _number(value)
        return
    if key[:3] != "K00" or at not in found:
        return
    one = found[at]
    if key == "K0001":
        one.values.append(_number(value))
        for others in (one.times, one.lots, one.parts):
            others.append("")
    elif not one.values:
        return
    elif key == "K0002" and int(value) >= _VALID_BELOW:
        one.values[-1] = math.nan
    elif key == "K0004":
        one.times[-1] = value
    elif key == "K0006":
        one.lots[-1] = value
    elif key == "K0014":
        one.parts[-1] = value


def _number(value: str) -> float:
    return float(value.replace(",", "."))


def _plain(said: object) -> str:
    """Return text on one line, of characters that the format can hold."""
    return " ".join("".join(one if one.isprintable() else " " for one in str(said)).split())
