"""What a column's name says: the quantity, by its words, and the unit, in brackets or as the last words.

`Iq [A]`, `pos_deg`, `Velocity (rpm)`, `torque_mNm`, `time_ms`, `Time / s`, `motorPosition`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from .units import COUNTS, spelled_out

_HEADS: dict[tuple[str, ...], str] = {
    (word,): quantity
    for quantity, words in {
        "t": "t time times timestamp stamp elapsed",
        "theta": "theta angle angles ang position positions pos q phi rotation displacement",
        "omega": "omega velocity velocities vel velo speed speeds dq qd qdot thetadot",
        "alpha": "alpha acceleration accelerations accel acc ddq qdd qddot thetaddot",
        "tau": "tau torque torques trq tor effort efforts force forces",
        "current": "current currents iq amps",
        "voltage": "voltage uq vq volts",
        "duty": "duty pwm",
    }.items()
    for word in words.split()
}
_HEADS |= {
    tuple(pair.split()): quantity
    for quantity, pairs in {
        "t": "x value",  # LabVIEW's
        "omega": "theta dot, q dot, phi dot, pos dot, position dot, ang vel, ang velocity, ang speed",
        "alpha": "theta ddot, q ddot, phi ddot, pos ddot, position ddot, ang acc, ang accel",
        "current": "i q, current q, q current",
        "voltage": "u q, v q, voltage q, q voltage",
        "other": "d current, d voltage, current d, voltage d",
    }.items()
    for pair in pairs.split(", ")
}


def _words_of(text: str) -> frozenset[str]:
    return frozenset(text.split())


_MEASURED = _words_of(
    "measured meas actual act present estimate estimated est shaft motor joint knob angular rotor output "
    "sensor encoder enc feedback mechanical mech relative elapsed since start system"
)
"""Words that leave it the quantity that is meant."""

_ASKED_FOR = _words_of(
    "target goal desired des ref reference setpoint set sp cmd command commanded demand demanded error err "
    "limit lim max min offset bias std sigma feedforward ff control electrical"
)
"""Words of what was asked for, or of what is no measurement."""

_ANGLES_ALONE = _words_of("angle phi rotation")
_UNIT_OF = {
    "t": ("s", "ms", "us", "ns", "min", "h"),
    "theta": ("rad", "mrad", "deg", "turn", "m", "cm", "mm", "um", "inch", "ft", COUNTS),
    "omega": ("rad/s", "deg/s", "turn/s", "rpm", "m/s", "cm/s", "mm/s", "inch/s", "ft/s"),
    "alpha": ("rad/s^2", "deg/s^2", "turn/s^2", "m/s^2", "mm/s^2", "inch/s^2", "ft/s^2"),
    "tau": (
        *("N m", "mN m", "uN m", "N cm", "N mm", "kN m", "lbf inch", "lbf ft", "ozf inch", "ozf ft"),
        *("N", "mN", "kN", "lbf", "ozf", "kip"),
    ),
    "current": ("A", "mA"),
    "voltage": ("V", "mV"),
}
_QUANTITY = {unit: quantity for quantity, units in _UNIT_OF.items() for unit in units}


_SHORT: dict[tuple[str | None, str], str] = {("theta", "in"): "inch", ("t", "min"): "min", ("t", "h"): "h"}
"""What in brackets is the unit of one quantity alone: a torque (in) comes in, a speed (min) is the least."""

_PARTS = {"%": 100, "percent": 100, "pct": 100, "‰": 1000, "permille": 1000, "promille": 1000}

_AT_END = re.compile(r"\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))\s*$")
"""What is in brackets at the end of a name."""
_LONGEST = 200  # letters of a name; what damaged a file makes names of 10^5, which patterns take minutes for


@dataclass(frozen=True)
class Label:
    """What a name says: a column of a capture, `current` or `voltage`; None when it says nothing.

    `plain`: every word is understood. `measured` is False for what was asked of a machine. `joint` is the
    number behind the quantity of one of several: `q3`, `actual_q_0`.
    """

    quantity: str | None
    unit: str | None = None
    plain: bool = False
    measured: bool = True
    joint: str | None = None


def read_label(name: str, stated: str | None = None) -> Label:
    """Return what a column's name says; of a dotted one the last part, the others only what was asked for.

    `stated` is the unit that the file says beside the name, for a name that says none.
    """
    if len(name) > _LONGEST:
        return Label(None, stated)
    parents, _, last = name.rpartition(".") if name.replace(".", "").isidentifier() else ("", "", name)
    if parents and (one := re.fullmatch(r"c(\d{1,2})", last)):  # of a matrix, one column a joint
        return replace(read_label(parents, stated), joint=one[1])
    asked = bool(_ASKED_FOR & {word.lower() for word in words_of(parents)})
    text, unit = _bracketed(last)
    words = words_of(text)
    if unit is not None:
        label = _labelled(words, unit)
    elif len(text) > 1 and spelled_out(text):
        unit = spelled_out(text)
        label = Label(_QUANTITY.get(str(unit)), unit)
    else:
        shorter, unit = _suffix(words)
        label = _labelled(shorter, unit)
        if unit is not None and not label.plain:  # the `a` of `torque_a` is no ampere
            other = _labelled(words, None)
            label = label if other.quantity in (None, label.quantity) else other
    if label.unit is None and stated is not None:
        label = _labelled(words, stated)
    return replace(label, measured=label.measured and not asked)


def parts_in(name: str) -> int | None:
    """Return how many parts make a whole where a name says parts of one: 100 of %, 1000 of ‰; else None.

    Drives log torque and current so (IEC 61800-7-201, objects 6077 and 6078), of what they are rated for.
    """
    if len(name) > _LONGEST or read_label(name).quantity not in ("tau", "current"):
        return None
    return next((parts for word in words_of(name) if (parts := _PARTS.get(word.lower())) is not None), None)


def _labelled(words: list[str], unit: str | None) -> Label:
    lower, joint = _numbered([word.lower() for word in words])
    if len(lower) > 1 and lower[0] == "current" and len(lower[1]) > 2 and (lower[1],) in _HEADS:
        lower = lower[1:]  # the position that is current
    quantity, rest = _head(lower)
    if "t" in lower and rest:
        quantity = None  # T_motor is a temperature
    if quantity is None:
        told = None if unit is None else _QUANTITY.get(unit)
        return Label(told, unit, measured=not _ASKED_FOR & set(lower))
    fits = unit is None or _QUANTITY.get(unit) == quantity
    if unit in ("m", "cm", "mm", "um", "inch", "ft"):
        fits = fits and not _ANGLES_ALONE & set(lower)
    plain = fits and all(word in _MEASURED or word in _ASKED_FOR for word in rest)
    if unit is not None and not fits:
        quantity = _QUANTITY.get(unit, quantity)
    return Label(quantity, unit, plain, not _ASKED_FOR & set(rest), joint)


def _numbered(words: list[str]) -> tuple[list[str], str | None]:
    """Take the number of a joint off a quantity: `q3`, `q_3`; a number elsewhere is a word like others."""
    for at, word in enumerate(words):
        joined = re.fullmatch(r"([a-z]+)(\d+)", word)
        name, number = joined.groups() if joined else (word, "".join(words[at + 1 : at + 2]))
        if _HEADS.get((name,)) not in (None, "t") and re.fullmatch(r"\d{1,2}", number):
            return [*words[:at], name, *words[at + (1 if joined else 2) :]], number
    return words, None


def _bracketed(name: str) -> tuple[str, str | None]:
    """Split `Iq [A]`, `Velocity (rpm)` and `Time / s`; brackets around no unit are words like others."""
    for pattern in (r"(.+?)\s*[\[({<]([^\[\](){}<>]*)[\])}>]\s*", r"(.+\S)\s*/\s*([^/\s][^\s]*)\s*"):
        if not (found := re.fullmatch(pattern, name)):
            continue
        head = _head([word.lower() for word in words_of(found[1])])[0]
        if unit := _SHORT.get((head, found[2])) or spelled_out(found[2]):
            return found[1], unit
    return name, None


def bracketed(name: str) -> str | None:
    """Return what stands in brackets at the end of a name, whatever it is."""
    found = _AT_END.search(name[-_LONGEST:])
    return found and (found[1] or found[2])


def without_brackets(name: str) -> str:
    """Return a name without what stands in brackets at its end."""
    return _AT_END.sub("", name)


def words_of(text: str) -> list[str]:
    """Split at signs, blanks and humps, but not inside a unit such as mNm."""
    found: list[str] = []
    for part in re.findall(r"[^\W_]+|[°%‰]", text):
        whole = part.lower() in ("mnm", "ncm", "knm", "unm") or (part.lower(),) in _HEADS
        found += [part] if whole else re.split(r"(?<=[a-z0-9])(?=[A-Z][a-z])|(?<=[a-z]{2})(?=[A-Z]{2})", part)
    return found


def _suffix(words: list[str]) -> tuple[list[str], str | None]:
    """Take the unit off the end, the longest first: rad_s before s. What stands alone is no unit."""
    for length in (4, 3, 2, 1):
        if len(words) > length and (unit := spelled_out("_".join(words[-length:]))):
            return words[:-length], unit
    return words, None


def _head(words: list[str]) -> tuple[str | None, list[str]]:
    """Return the quantity that one or two words name and the words left over; None for two quantities."""
    found: list[str] = []
    rest: list[str] = []
    at = 0
    while at < len(words):
        for length in (2, 1):
            quantity = _HEADS.get(tuple(words[at : at + length]))
            if quantity is not None and len(words) - at >= length:
                found.append(quantity)
                at += length
                break
        else:
            rest.append(words[at])
            at += 1
    if len(set(found)) == 1 and found[0] != "other":
        return found[0], rest
    return None, words
