"""Motion columns that contradict each other: reversed, in another unit than they say, or swapped."""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding, Severity
from ..formats.units import SI, Coordinate
from .motion import ratio

AGREEMENT = (0.8, 1.25)
"""Ratio of a derivative's column to the derivative of theta that passes as the same unit."""

_ORDERS = {"omega": 1, "alpha": 2}
_DERIVATIVES = {"omega": "d theta/dt", "alpha": "d2 theta/dt2"}
_CLOCKS = {1e3: "ms", 1e6: "us"}
_FACTORS: dict[Coordinate, dict[float, str]] = {
    "linear": {1e3: "thousandths", 1e6: "millionths"},
    "rotary": {
        1e3: "thousandths",
        1e6: "millionths",
        180 / math.pi: "degrees",
        1 / (2 * math.pi): "turns",
        60 / (2 * math.pi): "rpm",
    },
}


class _Sizes(NamedTuple):
    """How many times the derivative of theta each column is, where that can be judged; and strangers."""

    times: dict[str, float]
    strangers: list[str]

    @property
    def off(self) -> dict[str, float]:
        """Those that are not the derivative."""
        return {name: times for name, times in self.times.items() if not _alike(times, 1.0)}


def check_scales(
    columns: dict[str, FloatArray], usable: BoolArray, coordinate: Coordinate
) -> tuple[dict[str, FloatArray], list[Finding]]:
    """Return the columns as mended where omega and alpha are not the derivatives of theta, and the findings.

    Two of three sensors that agree leave no doubt which one is wrong: it is turned, or left out. Where doubt
    is left nothing is changed, and a warning says what would set it right.
    """
    sizes = _sizes(columns, usable)
    off, count = sizes.off, int(usable.sum())
    if not off and not sizes.strangers and len(sizes.times) == len(_ORDERS.keys() & set(columns)):
        return columns, []

    def said(kind: str, column: str, message: str, severity: Severity = "warning") -> Finding:
        return Finding(kind, column, count, (), f"{column}: {message}", severity)

    if swapped := _swapped(columns, sizes, usable):
        one, other = swapped
        way = f"as they are, {other} is what {one} should be and {one} what {other} should be; map them so"
        return columns, [said("swapped", one, f"stands in the place of {other}: {way}")]
    if sizes.strangers:
        way = "has nothing to do with d theta/dt; check which column is which in the map"
        return columns, [said("contradiction", "omega", way)]
    told = {name: f"{times:.4g} times {_DERIVATIVES[name]}" for name, times in off.items()}
    if len(off) == len(_ORDERS):
        first, second = off["omega"], off["alpha"]
        both = f"omega is {told['omega']}, alpha {told['alpha']}"
        if _alike(first, -1.0) and _alike(second, -1.0):
            message = f"{both}: it is theta whose sign is reversed; it is turned"
            return columns | {"theta": -columns["theta"]}, [said("sign", "theta", message, "mended")]
        clock = next((unit for factor, unit in _CLOCKS.items() if _alike(first, factor)), None)
        if clock is not None and _alike(second, first**2):
            return columns, [said("unit", "t", f"{both}: it is in {clock}; map t=... [{clock}]")]
        if _alike(first, second):
            return columns, [said("unit", "theta", f"{both}: {_likely('omega', abs(first), coordinate)}")]
        kept = "nothing is changed"
        units = {name: _likely(name, abs(times), coordinate) for name, times in off.items()}
        return columns, [said("unit", name, f"{told[name]}: {units[name]}; {kept}") for name in off]
    for name, times in off.items():  # one
        witness = next((other for other in _ORDERS if other != name and other in columns), None)
        if _alike(times, -1.0):
            if witness is None:
                message = f"{told[name]}: its sign is reversed, map it with a minus; nothing is changed"
                return columns, [said("sign", name, message)]
            message = f"its sign is reversed, as theta and {witness} say; it is turned"
            return columns | {name: -columns[name]}, [said("sign", name, message, "mended")]
        agreed = witness is not None and witness in sizes.times
        reason = _likely(name, abs(times), coordinate, theta_too=not agreed)
        if not agreed:
            return columns, [said("unit", name, f"{told[name]}: {reason}; nothing is changed")]
        message = f"{told[name]}: {reason}; left out, since theta and {witness} agree"
        left = {one: values for one, values in columns.items() if one != name}
        return left, [said("unit", name, message, "mended")]
    return columns, []


def _alike(times: float, wanted: float) -> bool:
    return AGREEMENT[0] <= times / wanted <= AGREEMENT[1]


def _sizes(columns: dict[str, FloatArray], usable: BoolArray) -> _Sizes:
    times, strangers = {}, []
    for name, order in _ORDERS.items():
        if name in columns:
            found, apart = ratio(columns["t"], columns["theta"], columns[name], order, usable)
            if found is not None:
                times[name] = found
            if order == 1 and apart:  # an integral of an integral of noise is anything
                strangers.append(name)
    return _Sizes(times, strangers)


def _swapped(columns: dict[str, FloatArray], now: _Sizes, usable: BoolArray) -> tuple[str, str] | None:
    """Return the two columns that, each in the other's place, leave all derivatives what they should be."""
    orders = _ORDERS.keys() & set(columns)
    right = now.times.keys() - now.off.keys()
    placed = {"t", *right, *(["theta"] if right else [])}
    for one, other in combinations([name for name in columns if name not in placed], 2):
        there = columns | {one: columns[other], other: columns[one]}
        sizes = _sizes(there, usable)
        if sizes.times.keys() == orders and not sizes.off:
            return one, other
    return None


def _likely(name: str, times: float, coordinate: Coordinate, *, theta_too: bool = True) -> str:
    """Return the unit that would explain `times`, within the agreement that passes as equal."""
    unit = SI[coordinate][name]
    known = [
        (factor, f"the column may be in {word} where {unit} is expected")
        for factor, word in _FACTORS[coordinate].items()
    ]
    known += [
        (1 / factor, f"theta may be in {word} where {SI[coordinate]['theta']} is expected")
        for factor, word in _FACTORS[coordinate].items()
        if theta_too
    ]
    factor, reason = min(known, key=lambda pair: abs(math.log(pair[0] / times)))
    if AGREEMENT[0] <= times / factor <= AGREEMENT[1]:
        return f"near {factor:.4g}, so {reason}" + (" (or t is not in s)" if theta_too else "")
    return "check the units in the map"
