"""How a file is read: the options of `load` as one record, for everything that reads one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .formats import DEFAULT_MAX_BYTES, read_table
from .formats.clock import between
from .quality.held import read_apart

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from ..base.arrays import BoolArray, FloatArray
    from .formats import Table
    from .formats.columnmap import ColumnMap
    from .formats.units import Coordinate
    from .quality.ruled import Ruled
    from .quality.torque import Limit


@dataclass(frozen=True)
class Reading:
    """What `load` is told of a file, but for what makes a torque of a current or a voltage; see there."""

    map: ColumnMap | None = None
    coordinate: Coordinate | None = None
    rate_hz: float | None = None
    start: float | None = None
    end: float | None = None
    joint: str | None = None
    limit: Limit | None = None
    max_bytes: int = DEFAULT_MAX_BYTES
    overrule: tuple[str, ...] = ()
    leave_out: tuple[Sequence[float], ...] = ()

    def table(self, file: Path) -> Table:
        """Return the content of a file."""
        return read_table(file, self.max_bytes, self.joint)

    def kept(
        self, source: str, columns: dict[str, FloatArray], ruled: Ruled | None = None
    ) -> slice | BoolArray:
        """Return the samples from `start` to `end`; beside findings, of held rows those that were read."""
        keep = between(source, columns, self.rate_hz, self.start, self.end)
        if ruled is None or self.rate_hz is not None:
            return keep
        rows = np.arange(1, len(columns["theta"]) + 1)
        read = read_apart({name: values[keep] for name, values in columns.items()}, rows[keep], ruled)
        return keep if read.all() else np.isin(rows, rows[keep][read])


PLAIN = Reading()
"""The whole of a file that says what its columns are."""
