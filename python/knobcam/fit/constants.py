"""A fit whose torque is computed with constants that nobody knows: kt/R of a motor, its back-EMF.

What was measured is a voltage, and its noise is none of the scale's: where that is free, the fit is one in V,
and one parameter that is known in N m gives the scale (kt/R = M / M in V), for it is no more than a unit.
What is added in proportion to a constant (ke omega) is fitted beside the model: what it adds and no parameter
of the model can take is what tells it (Frisch & Waugh 1933, Econometrica 1, 387). Where that is next to
nothing the constant is not determined: wherever the motor is driven, ke omega is viscous friction.

A command stands until the next row, and a reading is older than its row; what is in proportion to the speed
is of the same instant as the motion. Half a row between them takes from the inertia what half a row of all
damping is, which an interval of a fit without it does not hold: the delay is fitted with the constants.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import _core
from ..base.door import checked
from ..capture.formula import Formula
from ..capture.prepare import prepare as prepare_signals
from ..capture.reading import Reading
from ..errors import InputError
from ..model import Model
from .alike import check_captures
from .estimate import Z95, Constants, Estimate
from .fitting import Fit, as_logged
from .zeros import aligned

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..capture import Capture
    from ..capture.formats.columnmap import ColumnMap

_OWN = 3e-3  # share of a term's square that the model cannot take, at least: less may be a column's noise
_STEP = 0.1  # of the torque's spread, by which a term is changed to see what follows
_ROUNDS = 4
_CLOSE = 1e-4  # relative, of a scale
_DELAY = "delay_s"  # beside the terms
_LATE = 0.5  # of a row, by which the motion is shifted to see what follows
_LATEST = 1.0  # rows: a command stands for one, and what is later than that is an effect to be added
_STEPS = 3
_BLOCKS = 40  # stretches whose sums are taken to be independent
_T95 = 2.021  # Student's two-sided 95 % quantile for as many


class _Trial(NamedTuple):
    """A fit with certain values of the terms: its residuals, and the torque that it was given."""

    fit: Fit
    rest: FloatArray
    torque: FloatArray


class _Terms(NamedTuple):
    """The terms that were found, with their covariance, and by each how the parameters move.

    The delay, where the motion tells it, is the last of them.
    """

    fit: Fit
    values: dict[str, float]
    covariance: FloatArray
    moves: list[dict[str, float]]
    undetermined: dict[str, str]


@checked
def fit_constants(
    paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    model: Model | str | os.PathLike[str] | None = None,
    *,
    map: ColumnMap,
    free: str | Sequence[str],
    known: Mapping[str, float] | None = None,
    prepare: str = "smooth",
    detents: str = "auto",
    options: Mapping[str, float] | None = None,
    **reading: Any,
) -> Fit:
    """Fit a model to files whose torque is computed with the constants `free`, and these with it.

    The map's tau is a formula in them, such as `"tau=kt/R*(duty*supply - ke*omega*enabled)"`: of columns, of
    the names in `free`, and of `omega`, which is the smoothed velocity where no column is called so. Each
    constant scales the whole torque (of kt/R the quotient is found), or adds a term in proportion to it.
    `known` holds parameters of the model in N m (N) that are not fitted: a scale is told by the first of them
    that is a torque's and not 0. `Fit.constants` has what was found, with intervals, or why it is not
    determined; intervals of the parameters hold what the constants leave open.

    `model`, `prepare` and `detents` as in `fit`, `options` of the preparation, others as in `load`. Raises
    InputError for a formula that is not of this kind and for what cannot be read or fitted.
    """
    files = [paths] if not isinstance(paths, Sequence) or isinstance(paths, str) else list(paths)
    names = [free] if isinstance(free, str) else list(free)
    if not files or not names:
        raise InputError("fit_constants needs a file and a free constant; give at least one of each")
    if any(reading.pop(name, None) is not None for name in ("kt", "resistance_ohm")):
        raise InputError(
            f"{files[0]}: kt and resistance are for a torque without free constants; leave them out"
        )
    how = Reading(map=map, **reading)
    formulas = [Formula(file, names, how) for file in files]
    captures = [one.capture for one in formulas]
    check_captures(captures)
    if isinstance(model, str | os.PathLike):
        model = Model.load(model)
    if model is not None and formulas[0].scales and model.torque_unit != formulas[0].capture.torque_unit:
        model = Model(model.core.as_torque(1.0, 0.0))  # its values are a start, whatever scales them
    first = as_logged(captures, model, prepare=prepare, detents=detents, **(options or {}))
    motor = _Motor(formulas, first, prepare, dict(options or {}))
    return motor.solved(dict(known or {}))


class _Motor:
    """The files, and their torque as the constants make it."""

    def __init__(self, formulas: list[Formula], first: Fit, method: str, options: dict[str, float]) -> None:
        self.formulas, self.first, self.method = formulas, first, method
        edges = [one.core.edge_hz for one in first.prepared]
        # What is taken off must not differ with the constants.
        own = [{"torque_edge_hz": edge} if method == "smooth" and edge else {} for edge in edges]
        self.options = [options | one for one in own]
        sides = {sign: [n for n, one in formulas[0].scales.items() if one == sign] for sign in (1, -1)}
        self.scale = "/".join(["*".join(sides[1]) or "1", *sides[-1]]) if formulas[0].scales else ""

    def solved(self, known: dict[str, float]) -> Fit:
        """Return the fit with its constants."""
        for name in known:
            if name not in self.first.params:
                raise InputError(
                    f"known parameter '{name}' is none of the model, which has {', '.join(self.first.params)}"
                )
        told = [name for name, value in known.items() if value != 0.0 and self._is_torque(self.first, name)]
        reference = told[0] if told and self.scale else ""
        others = {name: value for name, value in known.items() if name != reference}
        size = 1.0
        found = self._terms(others, size)
        for _ in range(_ROUNDS if reference and others else 0):
            before, size = size, known[reference] / self._told(found.fit, reference)
            found = self._terms(others, size)
            if abs(size / before - 1.0) < _CLOSE:
                break
        undetermined = dict(found.undetermined)
        errors = self._errors(found)
        estimates = {
            name: self._estimate(value, math.sqrt(found.covariance[i, i]))
            for i, (name, value) in enumerate(found.values.items())
        }
        late = estimates.pop(_DELAY, None)
        if not reference:
            if self.scale:
                undetermined[self.scale] = (
                    "every torque of the model grows with it, so no motion tells it, and the values here "
                    "are of a torque with 1 for it; say what is known in N m, as --known inertia.M=VALUE"
                )
            constants = Constants(estimates, undetermined, errors, bool(self.scale), late)
            return replace(found.fit, constants=constants)
        fitted = self._in_torque(found, estimates, undetermined, errors, reference, known)
        assert fitted.constants is not None
        return replace(fitted, constants=fitted.constants._replace(delay=late))

    def _in_torque(
        self,
        found: _Terms,
        estimates: dict[str, Estimate],
        undetermined: dict[str, str],
        errors: dict[str, float],
        reference: str,
        known: dict[str, float],
    ) -> Fit:
        """Return the fit with its torque scaled so that the reference is what is known of it."""
        value, error = self._told(found.fit, reference), errors[reference]
        size = known[reference] / value
        captures = [self._scaled(one, size) for one in self._at(found.values)]
        scaled = self._fitted(captures, found, known, found.values.get(_DELAY, 0.0))
        share = error / abs(value)
        correlated = found.fit.correlation.get(reference, {})
        wider = {}
        for name, estimate in scaled.params.items():
            if not self._is_torque(scaled, name) or name not in errors:
                wider[name] = errors.get(name, estimate.se)
                continue
            own, by_scale = size * errors[name], abs(estimate.value) * share
            sign = math.copysign(1.0, estimate.value * value)
            both = 2.0 * sign * correlated.get(name, 0.0) * own * by_scale
            wider[name] = math.sqrt(max(own**2 + by_scale**2 - both, 0.0))
        wider |= dict.fromkeys(known, 0.0)
        constants = {self.scale: self._estimate(size, abs(size) * share)} | estimates
        return replace(scaled, constants=Constants(constants, undetermined, wider, False))

    @staticmethod
    def _told(fitted: Fit, name: str) -> float:
        """The value of what a scale is to be told by."""
        estimate = fitted.params[name]
        if not estimate.determined or estimate.ci95[0] <= 0.0 <= estimate.ci95[1]:
            raise InputError(
                f"known parameter '{name}' cannot give the scale: these captures do not tell it from none "
                f"({estimate.interval}); give another one first"
            )
        return estimate.value

    @staticmethod
    def _is_torque(fitted: Fit, name: str) -> bool:
        """Whether a parameter grows with the unit of torque."""
        effect = name.partition(".")[0]
        one, other = (
            Model.of([effect], fitted.model.coordinate, torque_unit=unit).params[name].unit
            for unit in ("A", "V")
        )
        return one != other

    @staticmethod
    def _estimate(value: float, error: float) -> Estimate:
        return Estimate(value, (value - Z95 * error, value + Z95 * error), "", error)

    @staticmethod
    def _scaled(capture: Capture, size: float) -> Capture:
        return replace(capture, tau=size * capture.tau)

    def _errors(self, found: _Terms) -> dict[str, float]:
        """The standard errors of the parameters, with what the terms leave open."""
        moves = np.array([[move[name] for name in found.fit.params] for move in found.moves]).reshape(
            len(found.moves), len(found.fit.params)
        )
        more = np.einsum("in,ij,jn->n", moves, found.covariance, moves)
        pairs = zip(found.fit.params.items(), more, strict=True)
        return {name: math.hypot(e.se, math.sqrt(max(extra, 0.0))) for (name, e), extra in pairs}

    def _fitted(
        self,
        captures: Sequence[Capture],
        found: _Terms | None,
        fixed: Mapping[str, float],
        delay_s: float,
    ) -> Fit:
        """Fit the model to captures, prepared alike, whose commands act so much later than they are logged.

        The motion is moved: to move the torque would smooth its noise, by which the floor is known.
        """
        pairs = zip(captures, self.options, strict=True)
        signals = aligned([prepare_signals(one, self.method, **options) for one, options in pairs])
        if delay_s != 0.0:
            signals = tuple(replace(one, core=one.core.later(delay_s)) for one in signals)
        model = (found.fit if found else self.first).model
        for name, value in fixed.items():
            model = model.with_value(name, value).with_fixed(name)
        return Fit(signals, _core.fit([one.core for one in signals], model.core, False))

    def _at(self, values: Mapping[str, float]) -> list[Capture]:
        """The captures with the torque that such values make."""
        terms = {name: value for name, value in values.items() if name != _DELAY}
        return [one.at(terms, values.get(_DELAY, 0.0)) for one in self.formulas]

    def _trial(self, values: Mapping[str, float], fixed: Mapping[str, float]) -> _Trial:
        fitted = self._fitted(self._at(values), None, fixed, values.get(_DELAY, 0.0))
        torque = [one.on_capture(np.where(one.used, one.tau, np.nan)) for one in fitted.prepared]
        return _Trial(fitted, fitted.residual, np.concatenate(torque))

    def _terms(self, known: Mapping[str, float], size: float) -> _Terms:
        """Find the terms; what is known is in the unit of a torque that is `size` times this one."""
        fixed = {
            name: value / size if self._is_torque(self.first, name) else value
            for name, value in known.items()
        }
        bare = self._trial({}, fixed)
        columns: dict[str, FloatArray] = {}
        moves, undetermined = [], {}
        terms = self.formulas[0].terms
        for name in (*terms, *([_DELAY] if terms else [])):  # one scale alone is no more than a unit
            step = self._step(name, bare)
            if step == 0.0:
                undetermined[name] = "what it is multiplied by is nought throughout"
                continue
            changed = self._trial({name: step}, fixed)
            column = np.nan_to_num((bare.rest - changed.rest) / step)
            added = np.nan_to_num((bare.torque - changed.torque) / step)
            alone = column - self._along(column, columns)
            if float(alone @ alone) < _OWN * float(added @ added):
                if name != _DELAY:
                    undetermined[name] = self._taken(name, columns, bare.fit)
                continue
            columns[name] = column
            params = (bare.fit.params, changed.fit.params)
            moves.append({key: (params[1][key].value - params[0][key].value) / step for key in params[0]})
        if not columns:
            return _Terms(bare.fit, {}, np.zeros((0, 0)), [], undetermined)
        matrix = np.column_stack(list(columns.values()))
        values = np.zeros(len(columns))
        latest = _LATEST / min(one.capture.rate_hz for one in self.formulas)
        most = [latest if name == _DELAY else math.inf for name in columns]
        trial = bare
        for _ in range(_STEPS):  # a term is linear where the model is, a delay nearly so
            rest = np.nan_to_num(trial.rest)
            values = np.clip(values + np.linalg.lstsq(matrix, rest, rcond=None)[0], np.negative(most), most)
            trial = self._trial(dict(zip(columns, values.tolist(), strict=True)), fixed)
        covariance = _covariance(matrix, trial.rest)
        return _Terms(
            trial.fit, dict(zip(columns, values.tolist(), strict=True)), covariance, moves, undetermined
        )

    def _step(self, name: str, bare: _Trial) -> float:
        """By how much a constant is changed to see what follows."""
        if name == _DELAY:
            return _LATE / max(one.capture.rate_hz for one in self.formulas)
        whole = self._spread(name)
        return _STEP * float(np.nanstd(bare.torque)) / whole if whole > 0.0 else 0.0

    def _spread(self, name: str) -> float:
        """How much of a torque one of a term makes."""
        added = [one.at({name: 1.0}).tau - one.capture.tau for one in self.formulas]
        return float(np.nanstd(np.concatenate(added)))

    @staticmethod
    def _along(column: FloatArray, columns: Mapping[str, FloatArray]) -> FloatArray:
        if not columns:
            return np.zeros_like(column)
        matrix = np.column_stack(list(columns.values()))
        along: FloatArray = matrix @ np.linalg.lstsq(matrix, column, rcond=None)[0]
        return along

    @staticmethod
    def _taken(name: str, columns: Mapping[str, FloatArray], fitted: Fit) -> str:
        held = [one for one in fitted.params if one.startswith("viscous.")]
        others = f" and {', '.join(columns)}" if columns else ""
        values = " ".join(f"{one}=VALUE" for one in held)
        return (
            f"the model{others} can make what it adds to the torque, which stays in "
            f"{' and '.join(held) or 'its parameters'}; of a back-EMF runs with the motor off tell it "
            f"({name}*omega*ENABLED, where ENABLED is then 0)"
            + (f", or friction that is known (--known {values})" if held else "")
        )


def _covariance(matrix: FloatArray, rest: FloatArray) -> FloatArray:
    """Covariance of coefficients by fits without one long stretch each: residuals may be correlated.

    The few stretches that tell a constant also bend the fit to their own errors: by what these leave it looks
    surer than it is, by a fit without them (Bell & McCaffrey 2002, CR3) it does not.
    The 95 % interval is that of Student's t for the number of stretches, so that a normal one of this
    covariance is as wide.
    """
    rows = np.flatnonzero(np.isfinite(rest))
    whole = matrix[rows].T @ matrix[rows]
    steps = []
    for part in np.array_split(rows, _BLOCKS):
        own = matrix[part]
        steps.append(np.linalg.pinv(whole - own.T @ own, hermitian=True) @ (own.T @ rest[part]))
    apart = np.array(steps) - np.mean(steps, axis=0)
    covariance: FloatArray = apart.T @ apart * ((_BLOCKS - 1) / _BLOCKS) * (_T95 / Z95) ** 2
    return covariance
