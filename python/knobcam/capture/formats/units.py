"""Units at the edge: every column becomes SI here, and its unit tells a rotary from a linear axis."""

from __future__ import annotations

import re
from functools import cache
from typing import Any, Literal

from ...base.optional import require
from ...errors import InputError

Coordinate = Literal["rotary", "linear"]

SI: dict[Coordinate, dict[str, str]] = {
    "rotary": {"t": "s", "theta": "rad", "omega": "rad/s", "alpha": "rad/s^2", "tau": "N m"},
    "linear": {"t": "s", "theta": "m", "omega": "m/s", "alpha": "m/s^2", "tau": "N"},
}
"""The SI unit of each column of a capture, by its coordinate."""

_NOT_UNITS = re.compile(r"\b(counts?|ticks?|steps?|lsb|pulses?)\b", re.IGNORECASE)
_TORQUE_SPELLING = re.compile(r"\b([numkM]?N)[ .*-]?([cm]?m)\b")


def to_si(target: str, unit: str) -> tuple[float, Coordinate | None]:
    """Return the factor from `unit` to the SI unit of column `target`, and the coordinate that it implies.

    The coordinate is None where both share the unit (t). Raises InputError for an unknown unit or one of the
    wrong dimension. An angle needs an angle in its unit: a bare 1/s would leave a factor of 2 pi to be
    guessed.
    """
    spelling = " ".join(unit.split())
    for coordinate, units in SI.items():
        if spelling == units[target]:
            return 1.0, None if target == "t" else coordinate
    if _NOT_UNITS.search(spelling):
        raise InputError(
            f"map: {target} in [{spelling}]: a count is not a unit; divide by the counts per turn, "
            f"as in theta=pos/8192 [turn]"
        )
    registry = _registry()
    try:
        quantity = registry.Quantity(1.0, registry.parse_units(_respell(spelling))).to_root_units()
    except Exception as error:  # the parser raises a dozen types, tokenizer errors among them
        raise InputError(
            f"map: {target} in [{spelling}]: unknown unit; write for example {_examples(target)}"
        ) from error
    for coordinate, units in SI.items():
        reference = registry.Quantity(1.0, units[target]).to_root_units()
        if quantity.units == reference.units:
            return float(quantity.magnitude / reference.magnitude), None if target == "t" else coordinate
    raise InputError(
        f"map: {target} in [{spelling}] has the wrong dimension; expected for example {_examples(target)}"
    )


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
        "tau": "[N m], [mNm] (rotary) or [N], [mN] (linear)",
    }[target]
