"""A search that is cut short: what it had weighed by then, and no verdict that it did not earn."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .learning import LearningResult

_NAMED = 6  # effects in a sentence


class OutOfTime(Exception):
    """The search has used up its time."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C in a search; `so_far` is what it had learned."""

    def __init__(self, so_far: LearningResult) -> None:
        super().__init__("what was known by then is above")
        self.so_far = so_far


class Cut(NamedTuple):
    """What cut a search short, its `budget` or an `interrupt`, after how long, and what it did not weigh."""

    by: str
    after_s: float
    not_weighed: tuple[str, ...]

    @property
    def words(self) -> str:
        """It in a sentence without a stop."""
        few = ", ".join(self.not_weighed[:_NAMED])
        more = len(self.not_weighed) - _NAMED
        rest = f" and {more} more" if more > 0 else ""
        was = "its time was used up" if self.by == "budget" else "it was interrupted"
        return f"the search was cut after {self.after_s:.3g} s because {was}: not weighed were {few}{rest}"


@dataclass
class Deadline:
    """The time of a search, asked from time to time while it works; it knows what is being weighed."""

    budget_s: float
    weighing: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not self.budget_s > 0.0:
            raise InputError(f"budget_s={self.budget_s} must be above 0 seconds")
        self._start = time.monotonic()

    @classmethod
    def of(cls, budget_s: float | None) -> Deadline:
        """Return the deadline of so many seconds from now; None: there is none."""
        return cls(math.inf if budget_s is None else budget_s)

    def __call__(self, _: float = 0.0) -> None:
        """Raise OutOfTime when the time is used up."""
        if time.monotonic() - self._start > self.budget_s:
            raise OutOfTime

    def cut(self, by: BaseException) -> Cut:
        """Return how it ended a search."""
        why = "budget" if isinstance(by, OutOfTime) else "interrupt"
        return Cut(why, time.monotonic() - self._start, tuple(self.weighing))


def after(seconds: float) -> Callable[..., bool]:
    """Return what says whether so much time has gone by since now, or will have in some seconds more."""
    until = time.monotonic() + seconds
    return lambda more=0.0: time.monotonic() + more > until
