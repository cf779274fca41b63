"""Samples for a picture that grows: fewer of them, none of them invented, and every peak among them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..formats.table import FloatArray


class Thinned:
    """Of every `stretch` samples those two are kept whose `by` is the lowest and the highest.

    A sample is kept with all its columns, so that what is kept is true over any of them.
    """

    def __init__(self, stretch: int, by: str) -> None:
        self.stretch = stretch
        self._by = by
        self._kept: dict[str, list[FloatArray]] = {}
        self._rest: Mapping[str, FloatArray] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, columns: Mapping[str, FloatArray]) -> None:
        """Take samples that came; those that fill no whole stretch yet wait for the next ones."""
        joined = {
            name: np.concatenate([self._rest.get(name, []), column]) for name, column in columns.items()
        }
        by = joined[self._by]
        whole = len(by) // self.stretch * self.stretch
        self._rest = {name: column[whole:] for name, column in joined.items()}
        if self.stretch <= 2:
            at = np.arange(whole)
        else:
            rows = by[:whole].reshape(-1, self.stretch)
            starts = self.stretch * np.arange(len(rows))
            lowest = np.argmin(np.where(np.isnan(rows), np.inf, rows), axis=1)
            highest = np.argmax(np.where(np.isnan(rows), -np.inf, rows), axis=1)
            at = np.unique(np.concatenate([starts + lowest, starts + highest]))
        for name, column in joined.items():
            self._kept.setdefault(name, []).append(column[at])
        self._count += len(at)

    def since(self, first: int) -> dict[str, FloatArray]:
        """Return what is kept, from the sample at this place on."""
        self._kept = {name: [np.concatenate(parts)] for name, parts in self._kept.items()}
        return {name: parts[0][first:] for name, parts in self._kept.items()}
