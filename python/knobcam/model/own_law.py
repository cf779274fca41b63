"""Effects of one's own as formulas: no code is run, and a model file carries them.

>>> import knobcam as kc
>>> kc.own_law("brake_law", "2 a (omega/w) / (1 + (omega/w)^2)")["w"].unit
'rad/s'
>>> kc.forget_effect("brake_law")
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from .. import _core
from ..base.door import checked
from ..errors import InputError
from .own import Acts, OwnParameter, check_name

if TYPE_CHECKING:
    from .model import Model


@checked
def own_law(
    name: str,
    law: str,
    *,
    acts: Acts = "load",
    units: Mapping[str, str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
) -> dict[str, OwnParameter]:
    """Register a formula as the effect `name` of the catalogue, and return its parameters.

    The motion is `t` (s), `theta` (rad; m), `omega`, `alpha`, `direction` (-1 to 1, also `sign(omega)`) and
    `s`, the distance since the last reversal (rad; m); every other name is a parameter. Friction under a load
    is in proportion to `abs(load)*sign(omega)` (of what other effects press with, N m). There are
    `+ - * / ^`, brackets, ``|x|``, pi, and sin, cos, tan, exp, log, sqrt, abs, sign, tanh, min, max;
    `2 a omega` is a product, and `spline(x, 0, 0.7, 1, 0.2)` goes through numbers: cubic B-splines at 0, 1, 2
    and on, so many times high. As a `load` it answers the torque that the rig has to apply, N m (N), as
    `friction` a factor on the dry friction, as `sensor` what the torque sensor reads beside the torque, N m.

    `units` of parameters, such as `N m/rad`, follow from the law where they are not given; `bounds` keep a
    search out of where the law has no value. Parameters that the law is proportional to are solved for
    directly, and derivatives are exact. What it has in proportion to `alpha` is an inertia.

    Raises InputError for what is no formula, by the character, for units that do not agree, for bounds that
    contradict each other, and for a name that is built in or no identifier.
    """
    check_name("effect", name)
    rows = _core.register_law(name, acts, law, dict(units or {}), dict(bounds or {}))
    return {
        param: OwnParameter(unit, lower, upper, neutral, param, linear)
        for param, unit, lower, upper, neutral, linear in rows
    }


def free_name(model: Model) -> str:
    """Return the first of law, law_2, ... that neither the catalogue nor a model has."""
    taken = {*model.catalogue(), *model.effects}
    names = (f"law_{number}" if number > 1 else "law" for number in range(1, 2 + len(taken)))
    return next(one for one in names if one not in taken)


def guesses(words: Iterable[str], of: str) -> dict[str, float]:
    """Return where the parameters of a law start, of words such as `f=50`; `of` is what gave them, in errors.

    Raises InputError for a word that is none, or no number.
    """
    given = {}
    for one in words:
        name, _, value = one.partition("=")
        try:
            given[name.strip()] = float(value)
        except ValueError:
            raise InputError(f"{of} {one}: '{value}' is no number; give PARAMETER=VALUE") from None
    return given
