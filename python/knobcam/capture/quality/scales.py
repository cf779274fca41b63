"""Motion columns that contradict each other: reversed, in another unit than they say, or swapped."""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

from ...base.arrays import BoolArray, FloatArray
from ...base.said import Advice, OfColumn, Said, said
from ..finding import Finding, Severity
from ..formats.units import SI, Coordinate
from .motion import ratio

AGREEMENT = (0.8, 1.25)
"""Ratio of a derivative's column to the derivative of theta that passes as the same unit."""

_NAMED = (0.92, 1.09)
"""The same within which a unit is named: nearer than a gear of 50 is to the degrees of a radian."""

_GEARS = (1.25, 400.0)  # of a speed of the motor beside the angle of the joint

_ORDERS = {"omega": 1, "alpha": 2}
_DERIVATIVES = {"omega": "d {theta}/dt", "alpha": "d2 {theta}/dt2"}
_CLOCKS = {1e3: "ms", 1e6: "us", 1 / 60: "min", 1 / 3600: "h"}
_LONG = {
    1 / 60: "minutes",
    1 / 3600: "hours",
}  # of those the ones that are no decimals of a unit of theta either
_DECIMALS = {1e3: "thousandths", 1e6: "millionths"}
_REGISTERS = {10.0: "tenths", 100.0: "hundredths", 0.1: "tens", 0.01: "hundreds"}  # as drives count
_ANGLES = {180 / math.pi: "degrees", 1 / (2 * math.pi): "turns"}
_RPM = 60 / (2 * math.pi)


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

    def told(
        kind: str, column: str, what: Said, advice: Advice | None = None, severity: Severity = "warning"
    ) -> Finding:
        found = said("{column}: {what}", column=OfColumn(column), what=what)
        return Finding(kind, column, count, (), found, severity, advice)

    if swapped := _swapped(columns, sizes, usable):
        what = said(
            "stands in the place of {b}: as they are, {b} is what {a} should be and {a} what {b} should be",
            a=OfColumn(swapped[0]),
            b=OfColumn(swapped[1]),
        )
        return columns, [told("swapped", swapped[0], what, Advice("map them so", "columns"))]
    if sizes.strangers:
        what = said("has nothing to do with d {theta}/dt")
        advice = Advice("check which column is which in the map", "columns")
        return columns, [told("contradiction", "omega", what, advice)]
    sized = {name: said(f"{times:.4g} times {_DERIVATIVES[name]}") for name, times in off.items()}
    if len(off) == len(_ORDERS):
        first, second = off["omega"], off["alpha"]
        both = said("{omega} is {first}, {alpha} {second}", first=sized["omega"], second=sized["alpha"])
        if _alike(first, -1.0) and _alike(second, -1.0):
            what = said("{both}: it is {theta} whose sign is reversed; it is turned", both=both)
            turned = columns | {"theta": -columns["theta"]}
            return turned, [told("sign", "theta", what, severity="mended")]
        clock = next((unit for factor, unit in _CLOCKS.items() if _alike(first, factor)), None)
        if clock is not None and _alike(second, first**2):
            what = said("{both}: it is in {clock}", both=both, clock=clock)
            return columns, [told("unit", "t", what, Advice(f"map t=... [{clock}]", "unit"))]
        if _alike(first, second):
            return columns, [told("unit", "theta", *_likely(both, "omega", abs(first), coordinate))]
        each = {name: _likely(sized[name], name, abs(off[name]), coordinate) for name in off}
        return columns, [told("unit", name, *_unchanged(*likely)) for name, likely in each.items()]
    for name, times in off.items():  # one
        witness = next((other for other in _ORDERS if other != name and other in columns), None)
        if _alike(times, -1.0):
            if witness is None:
                what = said("{size}: its sign is reversed; nothing is changed", size=sized[name])
                return columns, [told("sign", name, what, Advice("map it with a minus", "minus"))]
            what = said(
                "its sign is reversed, as {theta} and {witness} say; it is turned", witness=OfColumn(witness)
            )
            return columns | {name: -columns[name]}, [told("sign", name, what, severity="mended")]
        agreed = witness is not None and witness in sizes.times
        likely = _likely(sized[name], name, abs(times), coordinate, theta_too=not agreed)
        if witness is None or not agreed:
            return columns, [told("unit", name, *_unchanged(*likely))]
        what = said(
            "{likely}; left out, since {theta} and {witness} agree",
            likely=likely[0],
            witness=OfColumn(witness),
        )
        left = {one: values for one, values in columns.items() if one != name}
        return left, [told("unit", name, what, likely[1], severity="mended")]
    return columns, []


def _unchanged(what: Said, advice: Advice | None) -> tuple[Said, Advice | None]:
    return said("{what}; nothing is changed", what=what), advice


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


def _likely(
    size: Said, name: str, times: float, coordinate: Coordinate, *, theta_too: bool = True
) -> tuple[Said, Advice | None]:
    """Return a size with the unit that would explain it, where that is near.

    Where none does, return it with the advice to look.
    """
    unit = SI[coordinate][name]
    units = _DECIMALS | (_ANGLES if coordinate == "rotary" else {})
    own = units | _REGISTERS | ({_RPM: "rpm"} if coordinate == "rotary" else {})
    known = [
        (factor, said(f"the column may be in {word} where {unit} is expected"))
        for factor, word in own.items()
    ]
    known += [
        (1 / factor, said(f"{{theta}} may be in {word} where {SI[coordinate]['theta']} is expected"))
        for factor, word in units.items()
        if theta_too
    ]
    slow = {factor: said(f"{{t}} may be in {word} where s is expected") for factor, word in _LONG.items()}
    known += slow.items() if theta_too else ()
    factor, reason = min(known, key=lambda pair: abs(math.log(pair[0] / times)))
    if not _NAMED[0] <= times / factor <= _NAMED[1]:
        gear = _GEARS[0] < times < _GEARS[1]
        side = ", or take both from one side of the gear" if gear else ""
        return size, Advice(f"check the units in the map and the rate{side}", "unit")
    other = "" if factor in slow else said(" (or {t} is not in s)") if theta_too else ""
    return said(
        "{size}: near {factor:.4g}, so {reason}{or_}", size=size, factor=factor, reason=reason, or_=other
    ), None
