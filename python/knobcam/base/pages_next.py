"""What the page is told of the next experiment; see `pages.py`."""

from typing import TypedDict

from .pages_said import Part


class Enough(TypedDict):
    """A limit, and how wide it would have to be."""

    limit: str
    to: float


class Pair(TypedDict):
    """Two rivals: D that a motion promises, that of the best standard one, and what came (null: not yet)."""

    names: tuple[list[Part], list[Part]]
    d: float
    standard_d: float
    wrong_choice: float
    came: float | None


class HandStep(TypedDict):
    """What a hand has to do, in words; `beats` a minute, 0: none; why it `cannot`, empty where it can."""

    words: str
    seconds: float
    beats: float
    cannot: str


class Experiment(TypedDict):
    """A motion that tells rivals apart from D = `told` on; `verdict` is what its recording `capture` told.

    Of one rival alone it makes a parameter known better. `headline` is what it `promises` and how it moves,
    `source` what it can be recorded from at once, in words. Rivals that it does not tell apart are with
    `change`, if that is known.
    """

    id: str
    rivals: list[list[Part]]
    promises: list[Part]
    headline: list[Part]
    separable: bool
    seconds: float
    limits: dict[str, float]
    change: Enough | None
    pairs: list[Pair]
    told: float
    by_hand: bool
    steps: list[HandStep]
    source: str | None
    capture: str | None
    verdict: list[Part] | None
