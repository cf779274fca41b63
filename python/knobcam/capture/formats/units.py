"""Units at the edge: every column becomes SI here, and its unit tells a rotary from a linear axis."""

from __future__ import annotations

import re
from functools import cache
from typing import Any, Literal, NamedTuple

from ...base.optional import require
from ...errors import InputError

Coordinate = Literal["rotary", "linear"]

SI: dict[Coordinate, dict[str, str]] = {
    "rotary": {"t": "s", "theta": "rad", "omega": "rad/s", "alpha": "rad/s^2", "tau": "N m"},
    "linear": {"t": "s", "theta": "m", "omega": "m/s", "alpha": "m/s^2", "tau": "N"},
}
"""The SI unit of each column of a capture, by its coordinate."""

GIVEN = {"A": "current", "V": "voltage", "duty": "duty cycle"}
"""Units of what a motor was given, which stand for a torque that nobody measured, and what it is."""

VOLTAGES = ("V", "duty")
"""Those of them that hold the motor's back-EMF beside what drives its current."""

_DUTY = {"duty": 1.0, "1": 1.0, "%": 0.01}

COUNTS = "counts"
"""What stands for a unit where an encoder was not divided by its counts of a turn."""

_SPELLINGS = {
    spelling: unit
    for unit, spellings in {
        "s": "s sec secs second seconds",
        "ms": "ms msec millis milliseconds",
        "us": "us µs μs usec micros microseconds",
        "ns": "ns nsec nanos nanoseconds",
        "min": "minutes minute mins",  # `min` itself ends the name of a least value; in brackets see header
        "h": "hours hour hrs",
        "rad": "rad rads radian radians",
        "mrad": "mrad",
        "deg": "deg degs degree degrees °",
        "turn": "turn turns rev revs revolution revolutions",
        "rad/s": "rad/s rads/s rad_s radps rad_per_s rad_sec rad_per_sec rad/sec rad*s^-1",
        "deg/s": "deg/s deg_s degps dps deg_per_s deg_sec deg/sec °/s",
        "turn/s": "turn/s turns/s turn_s turns_s rev/s rev_s revs_s rps rev_per_s rev/sec",
        "rpm": "rpm r/min rev/min rev_min",
        "rad/s^2": "rad/s^2 rad/s2 rad/s² rad_s2 rad_s_2 rad_per_s2 rad/s/s rad/s**2",
        "deg/s^2": "deg/s^2 deg/s2 deg/s² deg_s2 deg_s_2 deg_per_s2 °/s² deg/s**2",
        "turn/s^2": "turn/s^2 turn/s2 turn_s2 rev/s^2 rev/s2 rev/s² rev_s2",
        "m/s": "m/s m_s mps m_per_s",
        "cm/s": "cm/s cm_s",
        "mm/s": "mm/s mm_s mm_per_s",
        "m/s^2": "m/s^2 m/s2 m/s² m_s2 m_s_2 m/s**2",
        "mm/s^2": "mm/s^2 mm/s2 mm/s² mm_s2",
        "m": "m meter meters metre metres",
        "cm": "cm",
        "mm": "mm",
        "um": "um µm μm",
        "N m": "nm n_m n*m n·m n.m n-m newtonmeter newton_meters",
        "mN m": "mnm mn_m mn*m mn·m mn.m",
        "uN m": "unm µnm μnm",
        "N cm": "ncm n_cm n*cm",
        "N mm": "nmm n_mm n*mm n·mm n.mm n-mm",
        "kN m": "knm",
        "N": "n newton newtons",
        "mN": "mn",
        "kN": "kn",
        "A": "a amp amps ampere amperes",
        "mA": "ma milliamp milliamps",
        "V": "v volt volts",
        "mV": "mv millivolts",
        COUNTS: "count counts cnt cnts tick ticks step steps lsb pulses",
    }.items()
    for spelling in spellings.split()
}

_US = {
    "inch": "inch inches",
    "inch/s": "in/s in_per_s inch/s inches/s",
    "inch/s^2": "in/s^2 in/s2 in/s² inch/s^2 inches/s^2",
    "ft": "ft feet",
    "ft/s": "ft/s ft_per_s feet/s",
    "ft/s^2": "ft/s^2 ft/s2 ft/s²",
    "lbf": "lbf",
    "ozf": "ozf",
    "kip": "kip kips",
} | {
    f"{force}f {length}": " ".join(
        f"{one}{sign}{other}"
        for weight in (force, f"{force}f")
        for one, other in ((weight, short), (short, weight))
        for sign in ("_", "*", "·", ".", "-")
    )
    for force in ("lb", "oz")
    for length, short in (("inch", "in"), ("ft", "ft"))
}
"""What headers in US units say; the pound of a torque is one of force, however it is written."""

_IMPERIAL = {spelling: unit for unit, spellings in _US.items() for spelling in spellings.split()}
_SPELLINGS |= _IMPERIAL

_NOT_UNITS = re.compile(r"\b(counts?|ticks?|steps?|lsb|pulses?)\b", re.IGNORECASE)
_TORQUE_SPELLING = re.compile(r"\b([numkM]?N)[ .*-]?([cm]?m)\b")


def spelled_out(text: str) -> str | None:
    """Return the unit that a header spells as `text`, as a map would have it; None where it is none."""
    return _SPELLINGS.get(_squeezed(text))


def _squeezed(text: str) -> str:
    squeezed = re.sub(r"\s*([*·./^-])\s*|\s+", lambda found: found[1] or "_", text.strip()).lower()
    return squeezed.replace("⋅", "·")


def torque_unit_of(unit: str, coordinate: Coordinate) -> str:
    """Return what a torque is in where `unit` is given, by default that of the coordinate.

    Raises InputError for any that is neither.
    """
    if coordinate not in SI:
        raise InputError(f"coordinate={coordinate!r} is unknown; choose {' or '.join(SI)}")
    own = SI[coordinate]["tau"]
    if unit not in ("", own, *GIVEN):
        raise InputError(f"torque_unit={unit!r} is unknown; choose {own}, {', '.join(GIVEN)}")
    return unit or own


class ToSI(NamedTuple):
    """A factor to an SI unit, the coordinate that has it, None where both do, and that unit."""

    factor: float
    coordinate: Coordinate | None
    unit: str


def fits(target: str, unit: str) -> bool:
    """Whether numbers in `unit` can be those of column `target`."""
    try:
        to_si(target, unit)
    except InputError:
        return False
    return True


def is_unit(text: str) -> bool:
    """Whether a text is a unit of anything at all: counts are, a word like `raw` is none."""
    try:
        return bool(spelled_out(text)) or not _quantity(text).dimensionless
    except Exception:  # the parser raises a dozen types, tokenizer errors among them
        return False


def to_si(target: str, unit: str) -> ToSI:
    """Return what makes numbers in `unit` those of column `target` in SI.

    A torque may be what a motor was given (`GIVEN`). Raises InputError for an unknown unit or one of the
    wrong dimension. An angle needs an angle in its unit: a bare 1/s would leave a factor of 2 pi to be
    guessed.
    """
    spelling = _IMPERIAL.get(_squeezed(unit), " ".join(unit.split()))
    wanted: list[tuple[str, Coordinate | None]]
    wanted = [(units[target], None if target == "t" else axis) for axis, units in SI.items()]
    if target == "tau":
        if spelling in _DUTY:
            return ToSI(_DUTY[spelling], None, "duty")
        wanted += [(one, None) for one in GIVEN if one not in _DUTY]
    for si, coordinate in wanted:
        if spelling == si:
            return ToSI(1.0, coordinate, si)
    if _NOT_UNITS.search(spelling):
        raise InputError(
            f"map: {target} in [{spelling}]: a count is not a unit; divide by the counts per turn, "
            f"as in theta=pos/8192 [turn]"
        )
    try:
        quantity = _quantity(spelling)
    except Exception as error:  # the parser raises a dozen types, tokenizer errors among them
        raise InputError(
            f"map: {target} in [{spelling}]: unknown unit; write for example {_examples(target)}"
        ) from error
    registry = _registry()
    for si, coordinate in wanted:
        reference = registry.Quantity(1.0, si).to_root_units()
        if quantity.units == reference.units:
            return ToSI(float(quantity.magnitude / reference.magnitude), coordinate, si)
    meant = registry.Quantity(1.0, "standard_gravity").to_root_units() * quantity
    if any(meant.is_compatible_with(si) for si, _ in wanted):
        raise InputError(
            f"map: {target} in [{spelling}] is of a mass, not of its weight; write lbf for lb and kgf for "
            f"kg, as in [kgf] or [kgf cm]"
        )
    raise InputError(
        f"map: {target} in [{spelling}] has the wrong dimension; expected for example {_examples(target)}"
    )


def _quantity(unit: str) -> Any:
    registry = _registry()
    return registry.Quantity(1.0, registry.parse_units(_respell(unit))).to_root_units()


@cache
def _registry() -> Any:
    return require("pint", "a unit in the column map").UnitRegistry()


def _respell(unit: str) -> str:
    """Return `unit` as pint spells it: torques without a blank, typographic signs, revolutions a minute."""
    for sign, plain in (("·", "*"), ("⋅", "*"), ("²", "**2"), ("µ", "u"), ("μ", "u"), ("r/min", "rpm")):
        unit = unit.replace(sign, plain)
    return _TORQUE_SPELLING.sub(r"\1*\2", re.sub(r"\brev\b", "turn", unit))


def _examples(target: str) -> str:
    return {
        "t": "[s], [ms]",
        "theta": "[rad], [deg], [turn] (rotary) or [m], [mm] (linear)",
        "omega": "[rad/s], [deg/s], [rpm] (rotary) or [m/s], [mm/s] (linear)",
        "alpha": "[rad/s^2], [deg/s^2] (rotary) or [m/s^2] (linear)",
        "tau": "[N m], [mNm] (rotary), [N], [mN] (linear), or of a motor [A], [V], [duty]",
    }[target]
