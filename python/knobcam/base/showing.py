"""How a result shows itself: it asks here, and `knobcam.show.results` answers, of which no result knows.

A result is plain data. Its `plot()`, `look()` and `report()` call the functions of the same name below; what
they call in turn is named once, when the package is imported (`answered_by`), and loaded when it is needed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure as Figure

    from .arrays import IntArray
    from .tables import TextTable


class Look(Protocol):
    """Linked plots to brush in, as `look()` returns them; see `knobcam.show.linked.Look`."""

    chosen: Sequence[IntArray]
    step: int

    @property
    def widget(self) -> Any:
        """What a notebook shows."""

    @property
    def share(self) -> float:
        """The part of the shown model's squared error that the chosen samples have, 0 to 1."""

    def html(self) -> str:
        """Return a page of the plots alone."""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write that page and return its path."""


class Shows(Protocol):
    """What answers: one function for each way in which a result shows itself."""

    def plot(self, result: object) -> Figure:
        """Return the picture of a result."""

    def html(self, tables: Sequence[TextTable]) -> str:
        """Return tables as a notebook shows them."""

    def look(self, result: object) -> Look:
        """Return the linked plots of a result."""

    def report(self, result: object, path: str | os.PathLike[str]) -> Path:
        """Write the report of a result and return its path."""


_find: Callable[[], Shows]


def answered_by(find: Callable[[], Shows]) -> None:
    """Name what answers from now on; `find` is called for every question, so that it can load it late."""
    global _find
    _find = find


def plot(result: object) -> Figure:
    """Return the picture of a result."""
    return _find().plot(result)


def look(result: object) -> Look:
    """Return the linked plots of a result."""
    return _find().look(result)


def report(result: object, path: str | os.PathLike[str]) -> Path:
    """Write the report of a result and return its path."""
    return _find().report(result, path)


class Tabled(ABC):
    """A result that a notebook shows as its tables."""

    @abstractmethod
    def tables(self) -> Sequence[TextTable]:
        """Return what it says of itself, as tables of text."""

    def _repr_html_(self) -> str:
        return _find().html(self.tables())
