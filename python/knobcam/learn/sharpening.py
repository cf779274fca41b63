"""Which parameter a motion is to make known best."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import InputError
from ..model.effects import effects as catalogue

if TYPE_CHECKING:
    from ..capture.formats.units import Coordinate
    from ..fit import Fit


def check_sharpen(asked: str, coordinate: Coordinate) -> None:
    """Raise InputError for what is the name of no parameter that a fit may have."""
    effect, _, param = asked.partition("@")[0].partition(".")
    rows = catalogue(coordinate)
    if effect not in rows:
        raise InputError(
            f"sharpen={asked!r}: is no parameter; write one as inertia.M, an effect's and its name"
        )
    names = [one.name for one in rows[effect].params]
    if param not in names:
        known = ", ".join(f"{effect}.{one}" for one in names)
        raise InputError(f"sharpen={asked!r}: is no parameter of {effect}; it has {known}")


def to_sharpen(fit: Fit, asked: str | None) -> str:
    """Return the parameter that is to be known better: the one that is asked for, or the widest.

    Raises InputError for one that was not fitted.
    """
    free, params, phases = fit.core.free, fit.params, fit.model.phases
    if asked is not None:
        if asked not in free:
            known = ", ".join(free)
            raise InputError(f"sharpen={asked!r}: is no parameter that was fitted; known are {known}")
        return asked
    scale = {name: 1.0 if name in phases else max(abs(params[name].value), 1e-300) for name in free}
    return max(free, key=lambda name: params[name].se / scale[name])
