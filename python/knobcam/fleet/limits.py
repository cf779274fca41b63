"""Limits of a part: on parameters, on the torque-angle curve, on what may be missing from its model."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..base.reading import parse_toml, read_text
from ..capture.formats.units import GIVEN, SI, Coordinate
from ..errors import InputError
from ..model import Model
from ..model.effects import base_effects, base_effects_shown, effects
from .aqdef import is_dfq, parse
from .noticeable import difference
from .row import Row

_MOST_BYTES = 1_000_000
_ADVICE = "write lines such as coulomb.pos = { min = 0.008, max = 0.010 } below [parameters]"
_WHAT = "file of limits"
_KINDS = ("parameters", "curve", "effects")
UNIT = "unit"
"""Key on top of a file of what its torques are in, and the name of the limit that a part in another fails."""
_KEYS = ("min", "max", "reference", "percent", "jnd", "period_deg")
_DIRECTIONS = ("forward", "backward")


class Failed(NamedTuple):
    """A limit that a part is beyond, and the sentence that says by what."""

    limit: str
    why: str


@dataclass(frozen=True)
class Between:
    """A parameter from `low` to `high`, in its unit."""

    name: str
    low: float
    high: float
    unit: str

    def failed(self, row: Row) -> list[Failed]:
        """Return what a row is beyond."""
        if self.name not in row["params"]:
            return [Failed(self.name, f"{self.name} is not there: the capture does not show it")]
        value, low, high = row["params"][self.name]
        if value is None:
            return [Failed(self.name, f"{self.name} is not determined by the capture")]
        if self.low <= value <= self.high:
            return []
        beyond = f"below {self.low:.4g}" if value < self.low else f"above {self.high:.4g}"
        said = f"{self.name} is {value:.4g} {self.unit} ({low:.4g} to {high:.4g}), {beyond}"
        return [Failed(self.name, said)]


@dataclass(frozen=True)
class Band:
    """The torque-angle curve of one direction between two others; arrays of one length, rad (m), N m (N)."""

    direction: str
    theta: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]

    def failed(self, row: Row) -> list[Failed]:
        """Return what a row is beyond, at the angle where it is most."""
        limit = f"curve.{self.direction}"
        theta = np.array(row["curve"]["theta"], dtype=float)
        torque = np.array(row["curve"][self.direction], dtype=float)
        within = (theta >= self.theta[0]) & (theta <= self.theta[-1]) & np.isfinite(torque)
        if not within.any():
            return [Failed(limit, f"the {self.direction} curve is not there between the angles of its band")]
        low = np.interp(theta, self.theta, self.low)
        high = np.interp(theta, self.theta, self.high)
        beyond = np.where(within, np.maximum(torque - high, low - torque), -np.inf)
        at = int(np.argmax(beyond))
        if beyond[at] <= 0.0:
            return []
        side, edge = ("above", high[at]) if torque[at] > high[at] else ("below", low[at])
        what = f"the {self.direction} curve is {torque[at]:.4g} {row['unit']} at {theta[at]:.4g}"
        return [Failed(limit, f"{what}, {side} {edge:.4g}")]


@dataclass(frozen=True)
class Without:
    """Effects that may not be found, None for any at all; nor what none explains, if `all_named`."""

    forbidden: tuple[str, ...] | None
    all_named: bool

    def failed(self, row: Row) -> list[Failed]:
        """Return what of it was found."""
        found = [name for name in row["found"] if self.forbidden is None or name in self.forbidden]
        said = [Failed(f"effects.{name}", f"{name} was found") for name in found]
        if self.all_named and row["verdict"] == "unexplained":
            said.append(Failed("effects.unexplained", "something is left that no effect explains"))
        return said


@dataclass(frozen=True)
class Limits:
    """All limits of a file, its text, and the axis and the unit of torque that its numbers are of."""

    checks: tuple[Between | Band | Without, ...]
    text: str = ""
    axis: tuple[str, str] = ("rotary", "N m")

    @classmethod
    def load(cls, path: str | os.PathLike[str], model: Model | None, *, learned: bool) -> Limits:
        """Read a file of limits, TOML or AQDEF; InputError for what is none, and for what the model lacks.

        `model` is what is fitted, None for the base model; `learned` is whether effects are looked for.
        """
        return cls.parse(read_text(path, _WHAT, _MOST_BYTES), path, model, learned=learned)

    @classmethod
    def parse(cls, text: str, path: str | os.PathLike[str], model: Model | None, *, learned: bool) -> Limits:
        """Return the limits in the text of a file, as `load` does."""
        content = _of_dfq(text, str(path)) if is_dfq(text) else parse_toml(path, text, _WHAT, _ADVICE)
        try:
            axis = _axis(content.pop(UNIT, None), model)
            return cls(cls._checks(content, model or _base(*axis), learned), text, axis)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    @classmethod
    def _checks(
        cls, content: Mapping[str, Any], model: Model, learned: bool
    ) -> tuple[Between | Band | Without, ...]:
        if unknown := [name for name in content if name not in _KINDS]:
            raise InputError(f"[{unknown[0]}]: is no kind of limit; known are {', '.join(_KINDS)}")
        coordinate = model.coordinate
        checks: list[Between | Band | Without] = []
        units = {name: one.unit for name, one in model.params.items()}
        for name, entry in _flat(content.get("parameters", {})).items():
            if name not in units:
                raise InputError(f"{name}: the model has no such parameter; it has {', '.join(units)}")
            checks.append(_between(name, entry, units[name], coordinate))
        for direction, entry in _table("curve", content.get("curve", {})).items():
            checks.append(_band(direction, entry))
        if "effects" in content:
            if not learned:
                raise InputError(
                    "[effects]: nothing is looked for; leave it out, or call with --learn outliers"
                )
            checks.append(_without(_table("effects", content["effects"]), coordinate))
        if not checks:
            raise InputError(f"has no limit; {_ADVICE}")
        return tuple(checks)

    def failed(self, row: Row) -> list[Failed]:
        """Return the limits that the row of a capture is beyond; none for one that was not read."""
        if row["error"] is not None:
            return []
        if self.of_axis(row):
            return [one for check in self.checks for one in check.failed(row)]
        effects_alone = [one for one in self.checks if isinstance(one, Without)]
        failed = [one for check in effects_alone for one in check.failed(row)]
        if len(effects_alone) == len(self.checks):
            return failed
        is_, held = (f"{coordinate} in {unit}" for coordinate, unit in (_axis_of(row), self.axis))
        said = f"it is {is_}, and the numbers of its limits are {held}; give limits of its own"
        return [Failed(UNIT, f'{said}, with unit = "{row["unit"]}" on top'), *failed]

    def of_axis(self, row: Row) -> bool:
        """Whether a row that was read has the axis and the unit of torque that the numbers are of."""
        return _axis_of(row) == self.axis

    def beyond(self, row: Row) -> bool:
        """Whether a part asks for a closer look: another unit than that of the limits is no fault of its."""
        return any(one.limit != UNIT for one in self.failed(row))

    def of(self, name: str) -> Between | None:
        """Return the limits of a parameter."""
        return next((one for one in self.checks if isinstance(one, Between) and one.name == name), None)

    def bands(self) -> list[Band]:
        """Return those of the torque-angle curve."""
        return [one for one in self.checks if isinstance(one, Band)]


def _axis(unit: object, model: Model | None) -> tuple[Coordinate, str]:
    """Return axis and unit of torque of the numbers in a file: those of the model, or as the file says."""
    if model is not None:
        if unit not in (None, model.torque_unit):
            raise InputError(f"unit: is {unit!r}, and the model is in {model.torque_unit}; leave it out")
        return model.coordinate, model.torque_unit
    axes = {axis["tau"]: coordinate for coordinate, axis in SI.items()} | dict.fromkeys(GIVEN, "rotary")
    said = SI["rotary"]["tau"] if unit is None else str(unit)
    if said not in axes:
        raise InputError(f"unit: is {unit!r}; choose {', '.join(axes)}")
    return axes[said], said


def _axis_of(row: Row) -> tuple[str, str]:
    return row["coordinate"], row["unit"]


def _base(coordinate: Coordinate, unit: str) -> Model:
    """Return the base model of an axis, with what it has only where a capture shows it."""
    return Model.of((*base_effects(coordinate), *base_effects_shown(coordinate)), coordinate, unit)


def _of_dfq(text: str, path: str) -> dict[str, Any]:
    """Return the limits of a file of AQDEF, K2110 and K2111 of what K2002 names, as those of TOML."""
    found, units = {}, set()
    for one in parse(text, path):
        units.add(one.unit)
        ends = {key: edge for key, edge in (("min", one.low), ("max", one.high)) if edge is not None}
        if ends:
            found[one.name] = ends
    # Other programs spell N m in many ways; what the motor was given is spelled in one.
    said = [unit for unit in (SI["linear"]["tau"], *GIVEN) if unit in units]
    return {"parameters": found} | ({UNIT: said[0]} if said else {})


def _flat(entries: object, head: str = "") -> dict[str, Mapping[str, Any]]:
    """Return limits by whole names, which a file may write in parts: `coulomb.pos = ...`."""
    found: dict[str, Mapping[str, Any]] = {}
    for name, entry in _table(head or "parameters", entries).items():
        whole = f"{head}.{name}" if head else str(name)
        if isinstance(entry, Mapping) and entry and not set(entry) & set(_KEYS):
            found |= _flat(entry, whole)
        else:
            found[whole] = _table(whole, entry)
    return found


def _table(name: str, entry: object) -> Mapping[str, Any]:
    if not isinstance(entry, Mapping):
        raise InputError(f"{name}: is {entry!r}, no table; {_ADVICE}")
    return entry


def _between(name: str, entry: Mapping[str, Any], unit: str, coordinate: str) -> Between:
    if unknown := [key for key in entry if key not in _KEYS]:
        raise InputError(f"{name}: {unknown[0]} is unknown; known are {', '.join(_KEYS)}")
    given = {key: _number(f"{name}: {key}", value) for key, value in entry.items()}
    low, high = given.get("min", -np.inf), given.get("max", np.inf)
    if ("percent" in given) + ("jnd" in given) > ("reference" in given):
        raise InputError(f"{name}: give reference, and either percent or jnd of it")
    if "reference" in given:
        if "percent" in given:
            half = abs(given["reference"]) * given["percent"] / 100.0
        elif "jnd" in given:
            effect = effects(coordinate)[name.partition(".")[0]]
            half = given["jnd"] * difference(name, effect, given["reference"], given.get("period_deg"), unit)
        else:
            raise InputError(f"{name}: reference alone is no limit; add percent or jnd")
        low, high = max(low, given["reference"] - half), min(high, given["reference"] + half)
    if not low < high or (low, high) == (-np.inf, np.inf):
        raise InputError(f"{name}: from {low:g} to {high:g} there is nothing to be held; give min below max")
    return Between(name, low, high, unit)


def _band(direction: str, entry: object) -> Band:
    name = f"curve.{direction}"
    if direction not in _DIRECTIONS:
        raise InputError(f"{name}: is no direction; known are {', '.join(_DIRECTIONS)}")
    given = _table(name, entry)
    if set(given) != {"theta", "min", "max"}:
        raise InputError(f"{name}: give theta, min and max, lists of one length")
    theta, low, high = (_numbers(f"{name}: {key}", given[key]) for key in ("theta", "min", "max"))
    if not len(theta) == len(low) == len(high) >= 2:
        raise InputError(f"{name}: theta, min and max have {len(theta)}, {len(low)} and {len(high)} numbers")
    if any(b <= a for a, b in pairwise(theta)) or any(map(float.__gt__, low, high)):
        raise InputError(f"{name}: theta has to rise, and min to stay below max")
    return Band(direction, theta, low, high)


def _without(entry: Mapping[str, Any], coordinate: str) -> Without:
    if unknown := [key for key in entry if key not in ("forbidden", "unexplained")]:
        raise InputError(f"effects: {unknown[0]} is unknown; known are forbidden and unexplained")
    forbidden = entry.get("forbidden", [])
    if not isinstance(entry.get("unexplained", True), bool):
        raise InputError("effects: unexplained says whether that is allowed; give true or false")
    if forbidden == "any":
        return Without(None, not entry.get("unexplained", True))
    known = effects(coordinate)
    if not isinstance(forbidden, list) or (wrong := [one for one in forbidden if one not in known]):
        what = (
            "a list of effects, or 'any'" if not isinstance(forbidden, list) else f"{wrong[0]!r} is no effect"
        )
        raise InputError(f"effects: forbidden: {what}; knobcam effects lists them")
    return Without(tuple(forbidden), not entry.get("unexplained", True))


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise InputError(f"{name}: is {value!r}; give a number")
    return float(value)


def _numbers(name: str, values: object) -> tuple[float, ...]:
    if not isinstance(values, Sequence) or isinstance(values, str):
        raise InputError(f"{name}: is {values!r}; give a list of numbers")
    return tuple(_number(name, value) for value in values)
