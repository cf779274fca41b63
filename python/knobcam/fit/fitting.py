"""The fit: parameters with units and intervals, and what they leave unexplained."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..base import showing
from ..base.door import checked
from ..base.tables import TextTable, text_table
from ..capture import Capture, load
from ..capture.prepare import Prepared
from ..capture.prepare import prepare as prepare_signals
from ..errors import InputError
from ..model import Model
from ..model.effects import base_effects, base_effects_shown
from . import refit, runs
from .ahead import ahead, delayed, mended
from .alike import check_captures, check_unit
from .beyond import Beyond, beyond
from .described import described, documented, found, summary
from .doubts import doubts
from .estimate import Z95, Constants, Estimate, rows_of
from .origin import with_origin
from .plausible import columns_at_fault, impossible, log_fault, one_velocity
from .uncounted import at_rest
from .zeros import aligned

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from ..base.arrays import FloatArray
    from ..base.showing import Figure, Look
    from ..capture.finding import Finding
    from .compare import Comparison
    from .diagnose import Diagnosis
    from .forward import Forward
    from .stiction import Stiction


@dataclass(frozen=True, eq=False, repr=False)
class Fit(showing.Tabled):
    """A model fitted to one or several captures of a knob; immutable.

    `before` is the fit that it came from by `add`, `constants` those of its torque that were fitted with it.
    """

    prepared: tuple[Prepared, ...]
    core: _core.Fit
    before: Fit | None = None
    constants: Constants | None = None

    @cached_property
    def model(self) -> Model:
        """The model at its best parameters; it knows what it was fitted to."""
        return with_origin(Model(self.core.model), self.prepared)

    @cached_property
    def params(self) -> Mapping[str, Estimate]:
        """All parameters of the model by `effect.parameter`."""
        se = dict(zip(self.core.free, self.core.standard_errors.tolist(), strict=True))
        se |= self.constants.errors if self.constants else {}
        estimates = {}
        for name, value, unit, role in self.core.model.rows():
            error = 0.0 if role == "fixed" else se.get(name if role == "free" else role, math.nan)
            interval = (value - Z95 * error, value + Z95 * error)
            estimates[name] = Estimate(value, interval, unit, error)
        return MappingProxyType(estimates)

    @cached_property
    def per_capture(self) -> Mapping[str, tuple[runs.OfRun, ...]]:
        """Parameters that are not the same in all captures, by `effect.parameter`, as they are in each."""
        return runs.per_capture(self)

    @property
    def rmse(self) -> float:
        """Root mean square error over the samples that count, N m."""
        return self.core.rmse

    @property
    def rmse_heldout(self) -> float:
        """The same on blocks that the fit did not see, N m."""
        return self.core.rmse_heldout

    @property
    def noise_floor(self) -> float:
        """What the torque sensor's noise alone would leave, N m."""
        return self.core.noise_floor

    @property
    def excess(self) -> float:
        """The mean squared error beyond what noise alone would leave, (N m)^2."""
        return self.rmse**2 - self.noise_floor**2

    @property
    def white_squares(self) -> float:
        """What noise alone leaves of the sum of squares, in variances of the raw torque's noise."""
        return self.core.white_squares

    @property
    def undetermined(self) -> Mapping[str, str]:
        """Parameters that the captures do not determine, and why."""
        return dict(self.core.undetermined)

    @cached_property
    def correlation(self) -> Mapping[str, Mapping[str, float]]:
        """Correlation of the estimates, by parameter and parameter."""
        names, matrix = self.core.free, self.core.correlation
        return {a: {b: float(matrix[i, j]) for j, b in enumerate(names)} for i, a in enumerate(names)}

    @cached_property
    def residuals(self) -> tuple[FloatArray, ...]:
        """Measured minus modelled torque on each capture, N m; NaN at samples that do not count."""
        parts = []
        for signals in self.prepared:
            rest = np.where(signals.used, signals.tau - self.model.core.torque(signals.core), np.nan)
            parts.append(signals.on_capture(rest))
        return tuple(parts)

    @property
    def residual(self) -> FloatArray:
        """Measured minus modelled torque, N m, the captures one after the other; see `residuals`."""
        return np.concatenate(self.residuals)

    @property
    def signals(self) -> Prepared:
        """The prepared signals of the first capture."""
        return self.prepared[0]

    @checked
    def predict(self, capture: Capture) -> FloatArray:
        """Return the model's torque on the motion of a capture, through the measurement filter, N m.

        Shape (samples,); NaN at samples that are masked.
        """
        if capture.coordinate != self.model.coordinate:
            raise InputError(
                f"the model is of a {self.model.coordinate} axis, the capture of a {capture.coordinate} one"
            )
        check_unit(self.model, capture)
        signals = prepare_signals(capture, self.signals.method, **self.signals.options)
        return signals.on_capture(self.model.core.torque(signals.core))

    def band(self, signals: Prepared | None = None) -> FloatArray:
        """Return the half-width of the 95 % band of the mean prediction at each kept sample, N m.

        Matlab's `nlpredci`, with the covariance of correlated residuals.
        """
        return self.core.band((signals or self.signals).core)

    @checked
    def bootstrap(self, draws: int = 1000, seed: int = 0) -> Mapping[str, FloatArray]:
        """Return block-bootstrap refits (Kuensch 1989) of each determined parameter, shape (draws,)."""
        if draws < 1 or seed < 0:
            raise InputError(f"draws={draws}, seed={seed}: give whole numbers, draws from 1, seed from 0")
        return dict(zip(self.core.free, self.core.bootstrap(draws, seed), strict=True))

    def compare(
        self,
        captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]] | None = None,
    ) -> Comparison:
        """Return where the model fails: on its captures, or as it is on others (or their files)."""
        from .compare import compare

        return self._comparison if captures is None else compare(self._on(captures))

    @cached_property
    def _comparison(self) -> Comparison:
        """Where it fails on its own captures."""
        from .compare import compare

        return compare(self)

    def forward(
        self,
        captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]] | None = None,
        *,
        horizon_s: float | None = None,
    ) -> Forward:
        """Return the motion that the measured torque makes of the model, beside the measured motion.

        On its captures, or as it is on others. With a horizon the simulation begins anew from the measured
        state after so many seconds. Raises InputError for a model without inertia.
        """
        from .forward import forward

        return forward(self if captures is None else self._on(captures), horizon_s)

    def _on(
        self, captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]]
    ) -> Fit:
        """The model as it is, on other captures prepared in the same way."""
        options: dict[str, Any] = dict(self.signals.options)
        return fit(captures, self.model.frozen(), prepare=self.signals.method, **options)

    def diagnose(
        self,
        *,
        only: Collection[str] | None = None,
        without: Collection[str] = (),
        progress: Callable[[float], object] | None = None,
    ) -> Diagnosis:
        """Return which effects could be missing, ranked: what `knobcam.diagnose` says of this fit."""
        from .diagnose import diagnose

        return diagnose(self, only=only, without=without, progress=progress)

    def add(self, effect: str) -> Fit:
        """Return the fit with one effect of the catalogue more, every free parameter fitted anew.

        Raises InputError for an effect that the model has already or the catalogue does not have.
        """
        return refit.add(self, effect)

    def drop(self, effect: str) -> Fit:
        """Return the fit without one of its effects and those that change it, the rest fitted anew.

        Raises InputError for an effect that the model does not have, or that is its only one.
        """
        return refit.converged(refit.drop(self, effect))

    @property
    def error_fall(self) -> float:
        """The part of the RMS error of `before` that is gone; 0 for a fit that comes from none."""
        return refit.error_fall(self.before, self) if self.before else 0.0

    @cached_property
    def moved(self) -> Mapping[str, refit.Moved]:
        """How far the parameters of `before` went: in standard errors, and in percent."""
        return refit.moved(self.before, self) if self.before else {}

    def stiction(self) -> Stiction:
        """Return the static friction that the captures show."""
        from .stiction import stiction

        return stiction(self)

    def plot(self) -> Figure:
        """Measured and modelled torque over position and over velocity, whole and isolated."""
        return showing.plot(self)

    def look(self) -> Look:
        """Return linked plots to brush in: torque and residual over position, velocity and time."""
        return showing.look(self)

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam fit --json`."""
        return {
            "schema": "knobcam.fit/1",
            "captures": [described(signals) for signals in self.prepared],
            "findings": found(self),
            "unit": self.torque_unit,
            "rmse": self.rmse,
            "rmse_heldout": self.rmse_heldout,
            "noise_floor": self.noise_floor,
            "iterations": self.core.iterations,
            "evaluations": self.core.evaluations,
            "status": self.core.status,
            "message": self.core.message,
            "effects": list(self.model.effects),
            "at_shaft": list(self.model.at_shaft),
            "params": documented(self.params),
            **({"constants": self.constants.document()} if self.constants else {}),
            "per_capture": runs.document(self.per_capture),
            "undetermined": dict(self.undetermined),
            "correlation": {a: dict(row) for a, row in self.correlation.items()},
            "warnings": list(self.warnings),
            "notes": [note for signals in self.prepared for note in signals.notes],
        }

    HEAD = ("parameter", "value", "95 % interval", "unit")

    def rows(self) -> list[tuple[str, str, str, str]]:
        """The parameters as rows of text, under the words of `HEAD`."""
        return rows_of(self.params)

    @cached_property
    def log_fault(self) -> str | None:
        """What is wrong with the log, so that no model of it is one of the knob; None where nothing is."""
        return log_fault(self)

    @cached_property
    def delayed(self) -> _core.Fit | None:
        """A sketch of it with a torque that acts or is read late, where that is beyond doubt; else None."""
        return delayed(self)

    @cached_property
    def ahead(self) -> Finding | None:
        """The finding that the torque stands before the motion that it makes or after it; else None."""
        return ahead(self)

    @cached_property
    def impossible(self) -> str | None:
        """What of the model no knob has, beyond doubt; None where there is nothing."""
        return impossible(self)

    @cached_property
    def beyond(self) -> Beyond | None:
        """What of the torque its filter takes off and the model does not have."""
        return beyond(self)

    @cached_property
    def trace(self) -> tuple[list[str], float, float]:
        """Variables, gain (in variances of the raw noise) and chance of the law that it leaves most of."""
        return _core.trace(refit.cores(self), self.core.model)

    @property
    def torque_unit(self) -> str:
        """What its errors are in."""
        return self.model.torque_unit

    def __repr__(self) -> str:
        lines = ["Fit: " + summary(self), text_table(self.HEAD, self.rows()), self.core.message]
        lines += [f"{name}: {why}" for name, why in self.undetermined.items()]
        lines += [*self.model.sides, *runs.in_words(self.per_capture)]
        lines += self.constants.in_words() if self.constants else []
        lines += self.warnings
        lines += [self.ahead.message] if self.ahead and self.ahead.severity == "mended" else []
        return "\n".join(lines + ([refit.in_words(self)] if self.before else []))

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What makes these values doubtful, a sentence each."""
        return doubts(self)

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        own = (TextTable("Fit: " + summary(self), self.HEAD, self.rows()),)
        return (*own, self.constants.table()) if self.constants else own


@checked
def fit(
    captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]],
    model: Model | str | os.PathLike[str] | None = None,
    *,
    prepare: str = "smooth",
    detents: str = "auto",
    **options: float,
) -> Fit:
    """Fit a model to one capture (or its file), or jointly to several of the same knob.

    What belongs to a run (a sensor's zero) is each capture's own where they ask for it (`Fit.per_capture`).
    Without a model: the paper's Equation 1; detents are part of it if the data show them (`detents="auto"`),
    always (`"yes"`) or never (`"no"`), and so is a torque that acts later than it is logged, or is read late,
    where that is beyond doubt (`actuation_delay`, `torque_lag`, `Fit.ahead`). A model (or its file) is fitted
    as it is: its fixed and tied values stay so, and a free detent period is found from the data whatever its
    value; `detents` is not for it. `prepare` and `options` as in `prepare`.

    Raises InputError for captures that cannot be fitted, with what to do.
    """
    first = as_logged(captures, model, prepare=prepare, detents=detents, **options)
    return first if model is not None else mended(first)


def as_logged(
    captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]],
    model: Model | str | os.PathLike[str] | None = None,
    *,
    prepare: str = "smooth",
    detents: str = "auto",
    **options: float,
) -> Fit:
    """Fit as `fit` does, to the torque where it stands: for who looks for what is missing, a delay too."""
    given = [captures] if isinstance(captures, Capture | str | os.PathLike) else list(captures)
    several = [load(one) if isinstance(one, str | os.PathLike) else one for one in given]
    if not several:
        raise InputError("captures is empty; give at least one")
    check_captures(several)
    if isinstance(model, str | os.PathLike):
        model = Model.load(model)
    if detents not in ("auto", "yes", "no"):
        raise InputError(f"detents={detents!r}: choose auto, yes or no")
    if model is not None and detents != "auto":
        raise InputError(
            f"detents={detents!r} is for the base model; a model that is given is fitted as it is: "
            "add the effect detent to it, or take it out"
        )
    signals = aligned([prepare_signals(capture, prepare, **options) for capture in several])
    axis = several[0].coordinate
    base = base_effects(axis) + (base_effects_shown(axis) if detents == "yes" else ())
    start = model or Model.of(base, axis, several[0].torque_unit)
    check_unit(start, several[0])
    try:
        core = _core.fit([s.core for s in signals], start.core, model is None and detents == "auto")
    except InputError as error:
        # What is wrong may be why there is too little.
        why = (str(error), columns_at_fault(signals) or one_velocity(signals) or at_rest(signals))
        raise InputError("; ".join(filter(None, why))) from None
    return refit.begun(Fit(signals, core))
