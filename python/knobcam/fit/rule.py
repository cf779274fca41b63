"""The thresholds that decide what is said to be missing: one table, which the core holds."""

from __future__ import annotations

from typing import NamedTuple

from .. import _core


class Threshold(NamedTuple):
    """A number that decides: its `unit`, its `meaning`, and its `source`, why it is so large.

    What it `decides` is a `verdict`, the `words` beside it, the `noise` that all is held against, or where a
    `search` goes.
    """

    name: str
    value: float
    unit: str
    decides: str
    meaning: str
    source: str


def thresholds() -> tuple[Threshold, ...]:
    """Return every threshold, in the order of the table; `KNOBCAM_RULE` may change some for a study."""
    return tuple(Threshold(*row) for row in _core.thresholds())


class Rule:
    """The values of the thresholds, by their names."""

    def __init__(self) -> None:
        self.__dict__.update((one.name, one.value) for one in thresholds())

    def __getattr__(self, name: str) -> float:
        """Raise AttributeError: no threshold is called that."""
        raise AttributeError(f"no threshold is called {name!r}")


RULE = Rule()
