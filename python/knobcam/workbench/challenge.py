"""Knobs that hide something to be found: of three levels, with hints and a score, and each can be solved.

That `knobcam.learn` itself ends each of `challenges.toml` with what is hidden, alone and told from all else,
is what `benches/study_challenge.py` holds.
"""

from __future__ import annotations

import secrets
import tomllib
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from ..errors import InputError
from ..model.effects import base_effects_shown
from ..model.effects import effect as catalogued
from .sources import Simulated

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base import pages_sources
    from .session import Session

PERFECT = 100
"""The score of who finds it unaided."""
HINT, WRONG, LIST = 15, 10, 40
"""What a hint costs, an effect that was added and is not there, and the list of what the program weighed."""
SECONDS = 6.0
_PLACES = {
    "load": "It is in the knob, or in what the knob drives.",
    "coupling": "It lies between the shaft and the knob.",
    "sensor": "It is in what measures or makes the torque.",
}


@cache
def levels() -> Mapping[str, Sequence[tuple[str, tuple[str, ...], int]]]:
    """Return of each level knobs, what they hide, and the seed of the noise."""
    told = tomllib.loads(resources.files(__package__).joinpath("challenges.toml").read_text("utf-8"))
    return {
        level: [(one["knob"], tuple(one["hides"]), one["seed"]) for one in some]
        for level, some in told.items()
    }


def drawn(level: str) -> Simulated:
    """Return a knob of a level, by chance. Raises InputError for a level that there is not."""
    if level not in levels():
        raise InputError(f"level={level!r} is unknown; choose {', '.join(levels())}")
    knob, hidden, seed = secrets.choice(levels()[level])
    return Simulated(knob, hidden, "sweep", SECONDS, seed, level=level)


def standing(session: Session, capture: str) -> pages_sources.Challenge:
    """Return how it goes with what a capture hides. Raises InputError for one that hides nothing."""
    opened = session.captures.get(capture)
    if opened is None or not opened.hidden:
        raise InputError(f"capture {capture!r} hides nothing; make a new one")
    unsealed = bool(session.hints.get(f"{capture} list"))
    taken = min(session.hints.get(capture, 0), len(_hints(opened.hidden)))
    fits = [node for node in session.nodes.values() if capture in node.captures]
    here = session.node
    base = {*base_effects_shown(opened.capture.coordinate)}
    if fits:
        base |= {*fits[0].fit.model.effects}
    wrong = sorted(session.guessed.get(capture, set()) - base - {*opened.hidden})
    own = {*here.fit.model.effects} if capture in here.captures else set()
    found = [one for one in opened.hidden if one in own]
    solved = len(found) == len(opened.hidden) and own <= base | {*opened.hidden}
    return {
        "hints": _hints(opened.hidden)[:taken],
        "more": taken < len(_hints(opened.hidden)),
        "wrong": wrong,
        "found": len(found),
        "hidden": len(opened.hidden),
        "solved": solved,
        "sealed": bool((opened.simulated or {}).get("level")) and not (unsealed or solved),
        "score": max(0, PERFECT - HINT * taken - WRONG * len(wrong) - LIST * unsealed),
    }


def hint(session: Session, capture: str, whole: bool) -> None:
    """Give away a little more of what a capture hides, or the `whole` list of what the program weighed.

    Raises InputError for a capture that hides nothing.
    """
    standing(session, capture)
    of = f"{capture} list" if whole else capture
    with session.lock:
        session.hints[of] = session.hints.get(of, 0) + 1
        session.touched()


def _hints(hidden: Sequence[str]) -> list[str]:
    """First where each effect acts, then where it shows, then what makes it."""
    effects = [catalogued(one) for one in hidden]
    acts = [f"{_PLACES[one.place]}{' It is friction.' if one.friction else ''}" for one in effects]
    return [
        *acts,
        *(f"It shows {one.shows}." for one in effects),
        *(f"It could come of {one.causes[0]}." for one in effects),
    ]
