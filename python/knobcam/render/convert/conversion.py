"""What became of a model in another form: effect by effect, in torque, and in the file itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ...base import showing
from ...base.door import checked
from ...base.tables import TextTable, text_table
from ...base.writing import write

if TYPE_CHECKING:
    import os
    from pathlib import Path

    from ...base.arrays import BoolArray, FloatArray
    from ...base.showing import Figure
    from ...capture.motions import MotionTrack
    from ...model import Model

_MORE = 1e-3  # of the torque RMS: measured errors that are beyond those foretold by more need a word
_STILL = 1e-9  # of the greatest speed: what rounding leaves of a reversal
Kind = Literal["exact", "approximate", "impossible"]


class Fate(NamedTuple):
    """What becomes of an effect, and by what; `error` is the torque that this is expected to cost, RMS, N m.

    `left_out` is one that is impossible there and that the caller does without: what it costs is how far the
    torque of the whole model is from that of all other effects.
    """

    effect: str
    kind: Kind
    how: str
    error: float = 0.0
    left_out: bool = False


class Form(NamedTuple):
    """A model in another form: the fates that writing it settled, and the file, text or bytes.

    `error` is the RMS torque that all of them cost, as expected from the numbers that were written, and
    `remarks` what a user has to know.
    """

    fates: tuple[Fate, ...]
    content: str | bytes
    error: float = 0.0
    remarks: tuple[str, ...] = ()


class Measured(NamedTuple):
    """The torque that the other form was found to have along a motion, beside the model's; N m, (samples,).

    `exact` is of what was kept of the model, `whole` of all of it. Errors are of the samples at which the
    knob moves: at rest dry friction is whatever holds it.
    """

    motion: MotionTrack
    exact: FloatArray
    found: FloatArray | None
    whole: FloatArray
    why_not: str = ""

    @property
    def torque(self) -> float:
        """RMS torque of what was kept of the model, N m."""
        return rms(self.exact[self.moves])

    @property
    def moves(self) -> BoolArray:
        """The samples at which it is clear which way the knob goes."""
        return moves(self.motion)

    @property
    def error(self) -> float | None:
        """RMS of what the other form has more or less of it, N m; None where nothing could be measured."""
        return None if self.found is None else rms((self.found - self.exact)[self.moves])

    @property
    def lost(self) -> float:
        """RMS of what the whole model has more or less than what was kept of it, N m."""
        return rms((self.whole - self.exact)[self.moves])

    @property
    def whole_error(self) -> float | None:
        """RMS of what the other form has more or less of the whole model; None where nothing was measured."""
        return None if self.found is None else rms((self.found - self.whole)[self.moves])


@dataclass(frozen=True, eq=False, repr=False)
class Conversion(showing.Tabled):
    """A model in another form: what became of each effect, the error foretold and measured, and the file.

    `kept` is the model without what is impossible there. `save(path)` writes the file.
    """

    model: Model
    kept: Model
    target: str
    motion: str
    form: Form
    measured: Measured

    @property
    def fates(self) -> tuple[Fate, ...]:
        """What became of each effect, in the order of the chain."""
        return self.form.fates

    @property
    def predicted_error(self) -> float:
        """RMS torque that the approximations cost on the motion, as foretold; N m."""
        return self.form.error

    @property
    def measured_error(self) -> float | None:
        """RMS torque by which the written form misses the model on the motion, N m; None: not measured."""
        return self.measured.error

    @property
    def predicted_whole_error(self) -> float:
        """RMS torque that approximations and what is left out cost together, as foretold; N m.

        Their squares are added, as of torques that have nothing to do with each other.
        """
        return math.hypot(self.form.error, self.measured.lost)

    @property
    def measured_whole_error(self) -> float | None:
        """RMS torque by which the written form misses all of the model, what is left out too; N m."""
        return self.measured.whole_error

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a user has to know, that more was measured than foretold included."""
        error = self.measured_error
        if error is None or error - self.predicted_error <= _MORE * self.measured.torque:
            return self.form.remarks
        said = "More is measured than expected: "
        if self.kept.joint is None:
            return (*self.form.remarks, f"{said}it is not what it is said to be on this motion; report it.")
        why = "surfaces that knock carry what rounding leaves into other knocks, and both are as right."
        return (*self.form.remarks, said + why)

    @checked
    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the file, whole or not at all, and return its path."""
        return write(path, self.form.content)

    def plot(self) -> Figure:
        """The torque of the model and of the other form along the motion, and their difference."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return it as JSON can keep it."""
        return {
            "to": self.target,
            "effects": [
                {
                    "effect": one.effect,
                    "kind": one.kind,
                    "how": one.how,
                    "predicted_error": one.error,
                    "left_out": one.left_out,
                }
                for one in self.fates
            ],
            "motion": self.motion,
            "unit": self.model.torque_unit,
            "torque_rms": self.measured.torque,
            "predicted_error": self.predicted_error,
            "measured_error": self.measured_error,
            "predicted_whole_error": self.predicted_whole_error,
            "measured_whole_error": self.measured_whole_error,
            "not_measured": self.measured.why_not or None,
            "remarks": list(self.remarks),
        }

    _HEAD = ("effect", "there", "expected error", "by")

    def _rows(self) -> list[tuple[str, ...]]:
        unit = self.model.torque_unit
        return [
            (
                one.effect,
                "left out" if one.left_out else one.kind,
                f"{one.error:.3g} {unit}" if one.kind == "approximate" or one.left_out else "-",
                one.how,
            )
            for one in self.fates
        ]

    @property
    def summary(self) -> str:
        """One sentence: how near it comes."""
        unit = self.model.torque_unit
        torque = f"of {self.measured.torque:.3g} {unit} RMS on the motion {self.motion}"
        foretold = f"{self.predicted_error:.3g} {unit}"
        if self.measured_error is None:
            return f"Expected error: {foretold} {torque}; not measured: {self.measured.why_not}."
        said = f"Error: {foretold} expected, {self.measured_error:.3g} {unit} measured, {torque}."
        if not any(one.left_out for one in self.fates):
            return said
        both = f"{self.predicted_whole_error:.3g} {unit} expected, {self.measured_whole_error:.3g} {unit}"
        return f"{said} With what is left out: {both} measured."

    def __repr__(self) -> str:
        lines = [f"{self.model.name or 'The model'} for {self.target}", text_table(self._HEAD, self._rows())]
        return "\n".join([*lines, self.summary, *self.remarks])

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.summary, self._HEAD, self._rows()),)


def moves(motion: MotionTrack) -> BoolArray:
    """Return the samples at which it is clear which way the knob goes."""
    speed = np.abs(motion.omega)
    return np.asarray(speed > _STILL * speed.max())


def rms(values: FloatArray) -> float:
    """Return the root of the mean square; 0 of nothing."""
    return float((values @ values / len(values)) ** 0.5) if len(values) else 0.0
