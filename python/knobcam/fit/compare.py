"""Where a model fails: the error split over every axis, beside what noise alone would give."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import _core
from ..base import showing
from ..base.door import checked
from ..base.said import OfAxis, Quantity, Said, Stretch, Topic, joined, number, said
from ..base.tables import TextTable, text_table
from . import origin
from .described import names
from .digits import left_out_Nm
from .rule import RULE
from .runs import in_words
from .unheard import unheard

if TYPE_CHECKING:
    import numpy as np

    from ..base.arrays import FloatArray
    from ..base.showing import Figure
    from .fitting import Fit

_UNITS = {
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "acceleration": ("rad/s^2", "m/s^2"),
    "time": ("s", "s"),
    "frequency": ("Hz", "Hz"),
    "history": ("rad", "m"),
}
_NEARLY = 99.95  # per cent, which a decimal rounds up to all
_MANY = 10.0  # noise floors, from which on chance makes no more than a hundredth of the squared error
_ROUNDING = 1e-6  # of the torque: what is smaller is not left by a model
# What any residual fills as well, whatever its cause, leads only with clearly more than the others.
_WEIGHT = {"frequency": RULE.frequency_leads, "time": RULE.time_leads}


class Figures(NamedTuple):
    """How large an error is: `rmse` in N m (N), `explained` the share of the torque's variance that the model
    explains, `relative` the error in RMS torques, as robot identification states it (Gautier 1997).
    """

    rmse: float
    explained: float
    relative: float

    @classmethod
    def of(cls, error: FloatArray, torque: FloatArray) -> Figures:
        """Return the figures of an error on the torque that was measured; NaN where there was none."""
        import numpy as np

        rmse, spread, rms = (math.sqrt(float(np.mean(x**2))) for x in (error, torque - torque.mean(), torque))
        explained = 1.0 - (rmse / spread) ** 2 if spread > 0.0 else math.nan
        return cls(rmse, explained, rmse / rms if rms > 0.0 else math.nan)

    def document(self) -> dict[str, float]:
        """Return them as documents have them."""
        return {"rmse": self.rmse, "explained": self.explained, "relative_error": self.relative}

    @property
    def in_percent(self) -> Quantity:
        """How much is explained, which is not rounded up to all of it where more than rounding is left."""
        explained = 100.0 * self.explained
        nearly = explained > _NEARLY and self.relative > _ROUNDING
        return Quantity(explained, "%", "more than 99.9" if nearly else f"{explained:.1f}")


def in_floors(times: float) -> str:
    """Return how many times its noise floor an error is, in no more digits than tell anything."""
    return f"{times:.2f}" if times < _MANY else f"{times:.0f}"


class Region(NamedTuple):
    """A stretch of an axis in which the model fails beyond chance.

    `mean` is the mean residual there, N m (along frequency the RMS of the excess); `share` its part of the
    squared error beyond the noise; `direction` 1 forward, -1 backward, 0 both.
    """

    start: float
    end: float
    direction: int
    mean: float
    share: float


@dataclass(frozen=True, eq=False)
class Split:
    """The error along one axis; arrays of shape (bins,).

    `low` and `high` are the borders of the bins and `direction` whose motion they hold (1 forward, -1
    backward, 0 both); `mean` and `rms` of the residual in N m; `band` the half-width of the 95 % band that
    chance gives the mean. Along frequency `mean` is the RMS per bin and `band` what chance stays below.
    `share` is the part of the squared error beyond the noise that the bin means hold, `part` what that is of
    the whole squared error, `chance` what noise alone would hold in one capture of twenty. Along frequency
    only lines count, for a residual that lies over position or velocity fills the spectrum broadly as well.
    """

    axis: str
    unit: str
    low: FloatArray
    high: FloatArray
    direction: np.ndarray[Any, np.dtype[np.int8]]
    count: FloatArray
    mean: FloatArray
    rms: FloatArray
    band: FloatArray
    share: float
    part: float
    chance: float
    regions: tuple[Region, ...]

    @property
    def fails(self) -> bool:
        """Whether the model fails along this axis beyond chance."""
        return bool(self.regions) and self.share > self.chance

    @property
    def mean_share(self) -> float:
        """The part of the squared error that the bin means hold, noise included; none along frequency."""
        squares = float((self.count * self.rms**2).sum())
        if self.axis == "frequency" or not squares > 0.0:
            return 0.0
        return float((self.count * self.mean**2).sum()) / squares

    def where(self) -> Said:
        """The worst region in words."""
        if not self.fails:
            return Said("nowhere beyond chance")
        worst = self.regions[0]
        return Said(Stretch(self.axis, worst.start, worst.end, self.unit, worst.direction))


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(showing.Tabled):
    """A fit held against its captures, axis by axis."""

    fit: Fit
    splits: tuple[Split, ...]

    def __getitem__(self, axis: str) -> Split:
        """The split along one axis."""
        return {split.axis: split for split in self.splits}[axis]

    @cached_property
    def worst(self) -> Split | None:
        """The axis that holds the largest share of the error beyond noise; None where chance explains all.

        Any residual changes with time too, and has lines in frequency where the motion repeats itself; so
        these two lead only where they hold clearly more than what the motion itself has.
        """
        failing = [] if self.exact else [split for split in self.splits if split.fails]
        return max(failing, key=lambda split: _WEIGHT.get(split.axis, 1.0) * split.share, default=None)

    @cached_property
    def judged(self) -> tuple[float, float, float, float, list[float]]:
        """What the core judges the fit by: error, noise floor, what the noise leaves in variances of the raw
        noise, the torque beside which an error is rounding, and the part of the squared error along each axis
        that fails.
        """
        fit = self.fit
        beyond = [split.part for split in self.splits if split.fails]
        torque = max(self.torque_rms, left_out_Nm(fit, self.torque_rms) / RULE.rounding)
        return fit.rmse, fit.noise_floor, fit.white_squares, torque, beyond

    @property
    def exact(self) -> bool:
        """Whether what is left is rounding, as where a model meets its own noise-free torque."""
        return _core.complete(self.judged)[0]

    @property
    def complete(self) -> bool:
        """Whether the error is what noise alone leaves, but for what is too small to feel on any axis."""
        return _core.complete(self.judged)[1]

    @cached_property
    def figures(self) -> Figures:
        """How large the error is over all captures."""
        import numpy as np

        return Figures.of(*(np.concatenate(parts) for parts in zip(*self._counted, strict=True)))

    @cached_property
    def by_capture(self) -> tuple[Figures, ...]:
        """How large it is on each of them."""
        return tuple(Figures.of(error, torque) for error, torque in self._counted)

    @cached_property
    def _counted(self) -> list[tuple[FloatArray, FloatArray]]:
        """Error and measured torque of each capture at the samples that count."""
        return [
            (rest[signals.rows][signals.used], signals.tau[signals.used])
            for rest, signals in zip(self.fit.residuals, self.fit.prepared, strict=True)
        ]

    @property
    def held_out(self) -> bool | None:
        """Whether the model was fitted to none of these captures; None where it does not say to which."""
        told = [origin.fitted_to(self.fit.model, one.capture) for one in self.fit.prepared]
        return None if None in told else not any(told)

    @property
    def origin(self) -> str:
        """What has to be known of a model that was not fitted to these captures, in one sentence."""
        return origin.in_words(self.fit.model, self.fit.prepared, names(self.fit.prepared))

    @property
    def summary(self) -> Said:
        """How large the error is, what noise leaves of it, and where it shows."""
        return joined(" ", (self.size, self.place))

    @property
    def error(self) -> Said:
        """How large the error is, in figures."""
        return said(
            "{error} {rmse}, {explained} of the variance explained, relative error {relative}",
            error=Topic("RMS error", "error"),
            rmse=number(self.fit.rmse, self.fit.torque_unit),
            explained=self.figures.in_percent,
            relative=number(100.0 * self.figures.relative, "%", ".3g"),
        )

    @property
    def size(self) -> Said:
        """How large the error is, and what noise leaves of it."""
        fit, unit, head = self.fit, self.fit.torque_unit, self.error
        if self.exact:
            return said("{head}; what is left is rounding.", head=head)
        if math.isnan(fit.noise_floor):
            return said("{head}; {why}.", head=head, why=unheard(fit).why)
        if fit.noise_floor == 0.0:
            return said("{head}; the torque has no noise, so nothing of what is left is chance.", head=head)
        times, floor = fit.rmse / fit.noise_floor, number(fit.noise_floor, unit)
        if self.complete:
            end = "{head}: {times:.3f} times the noise floor of {floor}, and chance explains it."
            return said(end, head=head, times=times, floor=floor)
        if times >= _MANY:  # how many times then tells nobody anything
            end = "{head}; noise alone would leave {floor}, so hardly any of it is chance{where}."
            where = ", and no axis shows where" if self.worst is None else ""
            return said(end, head=head, floor=floor, where=where)
        if self.worst is None:
            end = "{head}: {times:.3f} times the noise floor of {floor}, and no axis shows where."
            return said(end, head=head, times=times, floor=floor)
        end = "{head}: {times:.2f} times the noise floor of {floor}."
        return said(end, head=head, times=times, floor=floor)

    @property
    def place(self) -> Said | None:
        """Where the error shows; None where it does not, or chance explains it."""
        worst = self.worst
        if worst is None or self.exact or self.complete or not self.fit.noise_floor > 0.0:
            return None
        return said(
            "It shows most along {axis} ({share} of the excess), worst at {where}.",
            axis=OfAxis(worst.axis),
            share=number(100 * worst.share, "%", ".0f"),
            where=worst.where(),
        )

    @cached_property
    def torque_rms(self) -> float:
        """RMS of the measured torque about its mean over the samples that count, N m."""
        import numpy as np

        return float(np.std(np.concatenate([one.tau[one.used] for one in self.fit.prepared])))

    def plot(self) -> Figure:
        """The residual along every axis, with the band of chance and the regions that leave it."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam compare --json`."""
        fit = self.fit
        fitted = fit.document()
        each = zip(fitted["captures"], self.by_capture, fit.prepared, strict=True)
        captures = [
            {**capture, **figures.document(), "fitted_to_it": origin.fitted_to(fit.model, one.capture)}
            for capture, figures, one in each
        ]
        return {
            "schema": "knobcam.compare/1",
            **self.figures.document(),
            "noise_floor": fit.noise_floor,
            "unit": fit.torque_unit,
            "held_out": self.held_out,
            "captures": captures,
            "findings": fitted["findings"],
            "effects": list(fit.model.effects),
            "per_capture": fitted["per_capture"],
            "torque_rms": self.torque_rms,
            "complete": self.complete,
            "summary": self.summary,
            "axes": [_split_document(split) for split in self.splits],
        }

    _EACH = ("capture", "RMS error", "variance explained", "relative error")
    _HEAD = ("axis", "share of the excess", "by chance below", "where it is worst")

    def _rows(self) -> list[tuple[str, ...]]:
        ranked = sorted(self.splits, key=lambda split: (not split.fails, -split.share))
        return [
            (split.axis, _percent(split.share), _percent(split.chance), split.where()) for split in ranked
        ]

    def _each(self) -> list[tuple[str, ...]]:
        """How large the error is on each of several captures, as rows of text."""
        unit = self.fit.torque_unit
        return [
            (name, f"{one.rmse:.4g} {unit}", _percent(one.explained), _percent(one.relative))
            for name, one in zip(names(self.fit.prepared), self.by_capture, strict=True)
        ]

    def __repr__(self) -> str:
        lines = [self.summary, *([self.origin] if self.origin else []), *in_words(self.fit.per_capture)]
        lines += [text_table(self._EACH, self._each())] if len(self.by_capture) > 1 else []
        return "\n".join([*lines, text_table(self._HEAD, self._rows())])

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        each = TextTable("On each capture", self._EACH, self._each())
        whole = TextTable(f"{self.summary} {self.origin}".rstrip(), self._HEAD, self._rows())
        return (whole, each) if len(self.by_capture) > 1 else (whole,)


@checked
def compare(fit: Fit) -> Comparison:
    """Return where a fit fails: the error split over position, velocity, acceleration, time, load and history
    (distance since the last reversal) and over frequency.

    Held against what chance gives: noise of the sensor's level and colour, behind the same filter, in the
    same bins.
    """
    rotary = fit.model.coordinate == "rotary"
    splits = []
    for row in _core.locate([signals.core for signals in fit.prepared], fit.core.model):
        regions = tuple(Region(*region) for region in row.pop("regions"))
        if math.isnan(fit.noise_floor):
            # Without the noise there is no excess to share out, and nothing is beyond chance.
            regions, row["share"], row["chance"] = (), math.nan, math.nan
        units = {"load": 2 * (fit.torque_unit,)} | _UNITS
        unit = units[row["axis"]][0 if rotary else 1]
        splits.append(Split(unit=unit, regions=regions, **row))
    return Comparison(fit, tuple(splits))


def _percent(share: float) -> str:
    return "not known" if math.isnan(share) else f"{100 * share:.1f} %"


def _split_document(split: Split) -> dict[str, Any]:
    return {
        "axis": split.axis,
        "unit": split.unit,
        "share": split.share,
        "share_by_chance": split.chance,
        "fails": split.fails,
        "regions": [
            {"from": r.start, "to": r.end, "direction": r.direction, "mean": r.mean, "share": r.share}
            for r in split.regions[:20]
        ],
        "bins": {
            name: getattr(split, name).tolist()
            for name in ("low", "high", "direction", "count", "mean", "rms", "band")
        },
    }
