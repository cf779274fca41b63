"""What the catalogue's words are for an axis that slides, where they speak of a knob that turns."""

from __future__ import annotations

import re
from typing import Any

_SLIDES = {
    "moment of inertia": "mass",
    "there are detents": "there is an even ripple",
    "second series of detents": "second even ripple",
    "beside the detents": "beside the ripple",
    "falls into evenly spaced valleys": "runs over evenly spaced valleys, as of a screw or a row of magnets,",
    "falls into other valleys": "runs over other valleys",
    "detent wheel": "screw or rack",
    "detent spring": "spring",
    "grease the detent": "grease the drive",
    "detents": "ripples",
    "detent": "ripple",
    "rest angle": "rest position",
    "certain angles": "certain places",
    "torques": "forces",
    "torque": "force",
    "rad/s": "m/s",
    "few hundredths of a radian": "short way",
    "per turn": "per pitch",
    "per revolution": "per pitch",
    "revolution or pitch": "pitch",
    "after a turn": "after a pitch",
    "the shaft turns through": "the drive moves through",
    "what turns resists": "what moves resists",
    "that turn along": "that move along",
    "knob that turns in": "carriage that runs in",
    "turn the knob": "move the carriage",
    "the mass of the knob, most of all far from its axis": "the mass of the carriage and its load",
    "lighter or smaller in diameter": "lighter",
    "turn shaft against bearing and see with which of them the pattern moves": (
        "set the carriage on its rail anew and see whether the pattern moves along"
    ),
    "a bent shaft or an oval bearing": "a bent rail or screw",
    "straighten the shaft, align the bearings": "straighten the rail or screw, align the bearings",
    "a knob of rubber, or one pressed on with little grip": "a carriage that is held by rubber or a belt",
    "a long or thin shaft": "a long or thin screw or rod",
    "thicken the shaft": "thicken the screw or rod",
    "unbalanced knob": "unbalanced screw",
    "The knob's mass lies off its axis, or its axis off the rig's": "The screw's mass lies off its axis",
    "a lever, a pointer or a finger dimple on one side": "a screw or pulley that is heavier on one side",
    "bent shaft, or one that is off the axis of the rig": "bent screw, or one that is off its bearings' axis",
    "balance the knob": "balance the screw",
    "align the shaft with the rig": "align the screw with its bearings",
    "around the axis": "beside the axis",
    "knob": "carriage",
    "shaft": "drive",
}
"""Longer phrases go before the words in them."""
_WRITTEN = {"theta": "x", "omega": "v", "alpha": "dv/dt"}
LAW_NAMES = {written: name for name, written in _WRITTEN.items()}
"""What laws call the motion, by how that is written of an axis that slides."""
NAME = re.compile(r"dv/dt\b|[A-Za-z_]\w*")
"""A name in a law as it is written."""
_TYPESET = {r"\theta": "x", r"\omega": "v", r"\alpha": r"\dot v", r"\tau": "F", "x": "u"}
_SYMBOL = re.compile(r"\\(?:theta|omega|alpha|tau)(?![A-Za-z])|(?<![A-Za-z\\])x(?![A-Za-z])")
_WORDED = ("title", "name", "about", "shows", "causes", "remedies", "meaning")
_IN_LOWER_CASE = {phrase.lower(): other for phrase, other in _SLIDES.items()}
_PHRASE = re.compile("|".join(map(re.escape, _SLIDES)), re.IGNORECASE)


def sliding(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row of the catalogue, or one of its parameters, in the words for an axis that slides."""
    told = row | {key: _in_words(row[key]) for key in _WORDED if key in row}
    if "latex" in row:
        told["latex"] = _SYMBOL.sub(lambda one: _TYPESET[one.group()], row["latex"])
        if not row["latex"]:
            told["law"] = written(row["law"], "linear")
    return told | {"params": [sliding(one) for one in row["params"]]} if "params" in row else told


def written(law: str, coordinate: str) -> str:
    """Return a law as it is written of an axis; one of a slide that has a parameter called x, say, as it is.

    >>> written("a*sin(theta/P) + m*alpha", "linear")
    'a*sin(x/P) + m*dv/dt'
    """
    return _renamed(law, _WRITTEN, LAW_NAMES) if coordinate == "linear" else law


def read(formula: str, coordinate: str) -> str:
    """Return the law that is written so; where one of a slide has theta, say, an x in it is a parameter.

    >>> read("a sin(x/P) + m dv/dt", "linear")
    'a sin(theta/P) + m alpha'
    """
    return _renamed(formula, LAW_NAMES, _WRITTEN) if coordinate == "linear" else formula


def _renamed(law: str, names: dict[str, str], others: dict[str, str]) -> str:
    if any(one.group() in others for one in NAME.finditer(law)):
        return law
    return NAME.sub(lambda one: names.get(one.group(), one.group()), law)


def _in_words(words: str | list[str]) -> str | list[str]:
    if not isinstance(words, str):
        return [str(_in_words(one)) for one in words]
    return _PHRASE.sub(_instead, words)


def _instead(match: re.Match[str]) -> str:
    found = match.group()
    known = _IN_LOWER_CASE[found.lower()]
    return known[:1].upper() + known[1:] if found[0].isupper() else known
