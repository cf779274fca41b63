"""Samples for a picture that grows: one of every so many, none of them changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.arrays import FloatArray


class Thinned:
    """Keeps every `every`-th sample with all its columns.

    Choosing those of least and most torque instead would keep each peak, but tear the noise of a sensor apart
    into two bands, which over position look like friction.
    """

    def __init__(self, every: int) -> None:
        self.every = every
        self._kept: dict[str, list[FloatArray]] = {}
        self._came = 0

    def add(self, columns: Mapping[str, FloatArray]) -> None:
        """Take samples that came."""
        first = -self._came % self.every
        for name, column in columns.items():
            self._kept.setdefault(name, []).append(column[first :: self.every])
        self._came += len(next(iter(columns.values())))

    def since(self, first: int) -> dict[str, FloatArray]:
        """Return what is kept, from the sample at this place on."""
        self._kept = {name: [np.concatenate(parts)] for name, parts in self._kept.items()}
        return {name: parts[0][first:] for name, parts in self._kept.items()}
