"""A torque that its map computes with constants which nobody knows: `tau=kt/R*(duty*supply - ke*omega)`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .capture import of_table
from .formats.columnmap import parse_map
from .formats.expression import evaluate
from .formats.resolve import resolve
from .quality.ruled import Ruled

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from ..base.arrays import FloatArray
    from .capture import Capture
    from .formats import Table
    from .reading import Reading

SPEED = "omega"
"""The smoothed velocity in a formula, of a file that has no column of that name."""

_LET_GO = "let_go:tau"
_STRAIGHT = 1e-9  # how far from proportional rounding takes what is so
_PROBED = 64  # values of a column that a formula is tried with


class Formula:
    """The torque of one file as its constants make it.

    `scales` are the constants that the whole torque grows with (1) or, as the R of `kt/R`, falls with (-1),
    `terms` those in proportion to which something is added to it. `capture` has the torque with each of the
    first 1 and of the others 0. InputError says of a constant that it is neither.
    """

    def __init__(self, path: str | os.PathLike[str], free: Sequence[str], reading: Reading) -> None:
        file = Path(path)
        column_map = reading.map or ()
        self._map, self._coordinate = column_map, reading.coordinate
        entries = parse_map(column_map)
        if "tau" not in entries:
            raise InputError(f"{file}: map: tau is missing, of which the free constants are a part")
        self._expression = entries["tau"].expression
        self._table = reading.table(file)
        for at, name in enumerate(free):
            if name in self._table.columns or name in free[:at]:
                what = "is named twice" if name in free[:at] else "is a column of the file"
                raise InputError(f"{file}: free constant '{name}' {what}; call it by another name")
        unknown_speed = SPEED not in self._table.columns
        ones = dict.fromkeys([*free, *([SPEED] if unknown_speed else [])], np.asarray(1.0))
        self.scales, self.terms = self._roles(free, ones)
        self._constants = ones | dict.fromkeys(self.terms, np.asarray(0.0))
        capture = of_table(file, self._with(self._constants), reading)
        if self.terms and _LET_GO in {one.key for one in capture.findings if not one.overruled}:
            # A term may say when the motor was off, and is told there.
            reading = replace(reading, overrule=(*reading.overrule, _LET_GO))
            capture = of_table(file, self._with(self._constants), reading)
        self.capture = capture
        columns = resolve(self._with(self._constants), column_map, self._coordinate).columns
        self._keep = reading.kept(str(file), columns, Ruled(reading.overrule))
        if unknown_speed:
            signals = self.capture.prepare()
            speed = np.full(len(columns["theta"]), np.nan)
            speed[self._keep] = signals.on_capture(signals.omega)
            self._constants[SPEED] = speed

    def at(self, values: Mapping[str, float], delay_s: float = 0.0) -> Capture:
        """Return the capture with the torque that such values of the terms make.

        A command, or a reading, acts `delay_s` later than it is logged: the speed of a term is that of then,
        what switches it (`omega*enabled`) is a command like the others.
        """
        if not any(values.values()):
            return self.capture
        constants = self._constants | {name: np.asarray(value) for name, value in values.items()}
        speed = constants.get(SPEED)
        if speed is not None and speed.ndim:
            t, own = self.capture.t, speed[self._keep]
            known = np.isfinite(own)
            then = np.full(len(speed), np.nan)
            then[self._keep] = np.where(known, np.interp(t + delay_s, t[known], own[known]), np.nan)
            constants[SPEED] = then
        torque = resolve(self._with(constants), self._map, self._coordinate).columns["tau"][self._keep]
        return replace(self.capture, tau=np.where(self.capture.mask, torque, self.capture.tau))

    def _with(self, constants: Mapping[str, FloatArray]) -> Table:
        return replace(self._table, columns={**self._table.columns, **constants})

    def _roles(
        self, free: Sequence[str], ones: Mapping[str, FloatArray]
    ) -> tuple[dict[str, int], tuple[str, ...]]:
        """Return the constants that scale the torque, with the sign of their power, and those that add to it.

        That is the formula's, whatever the columns hold: a motor may have been off throughout.
        """
        rng = np.random.default_rng(0)
        drawn = dict(ones)

        def torque(**values: float) -> FloatArray:
            def look_up(name: str) -> FloatArray:
                if name in values:
                    return np.asarray(values[name])
                if name not in drawn:
                    shape = () if self._table.column(name).ndim == 0 else (_PROBED,)
                    drawn[name] = rng.uniform(0.5, 2.0, shape)
                return drawn[name]

            return np.atleast_1d(evaluate(self._expression, look_up))

        def same(a: FloatArray, b: FloatArray) -> bool:
            return bool(np.allclose(a, b, rtol=_STRAIGHT, atol=_STRAIGHT))

        base = torque()
        scales: dict[str, int] = {}
        terms = []
        for name in free:
            halved, doubled, trebled = (torque(**{name: value}) for value in (0.5, 2.0, 3.0))
            if same(base, halved) and same(base, doubled):
                raise InputError(f"free constant '{name}' is not in tau={self._expression}; leave it out")
            if same(doubled, 2.0 * base) or same(doubled, 0.5 * base):
                scales[name] = 1 if same(doubled, 2.0 * base) else -1
            elif same(doubled - base, 2.0 * (base - halved)) and same(trebled - doubled, doubled - base):
                terms.append(name)
            else:
                raise InputError(
                    f"free constant '{name}': tau={self._expression} neither is in proportion to it nor has "
                    "a term that is; write it like tau=kt/R*(duty*supply-ke*omega), each name once"
                )
        return scales, tuple(terms)
