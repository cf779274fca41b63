"""Whether effects that leave chance alone are causes, or only draw what none of them is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.said import OfAxis, OfEffect, joined, said
from ..fit.plausible import stands_in
from ..fit.rule import RULE
from ..fit.verdict import off_by_law
from .ladder import Unexplained

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..fit import Fit

_AXES = {
    "s": "history",
    "theta": "position",
    "t": "time",
    "load": "load",
    "alpha": "acceleration",
    "omega": "velocity",
}
"""The axis along which a law lies that has a variable, by the first of these that it has."""


def in_doubt(
    fit: Fit, found: Sequence[str], before: Unexplained
) -> tuple[tuple[str, ...], Unexplained] | None:
    """Return why effects that leave chance alone between them are no explanation, and which of them are none.

    None where they may be causes. What came in with one, and may have gone again, may bend it until its
    values are not its own any more: what there is to explain is then what there was `before`. And what a law
    of mechanics still takes off what several leave, more than chance does and more than their own laws may be
    off by, shows that they only come near. Beside a joint what is left is of its knocks, and follows much.
    """
    names = joined(" and ", map(OfEffect, found))
    bent = {one: whys[0] for one in found if (whys := stands_in(one, fit))}
    if bent:
        one, why = next(iter(bent.items()))
        draw = "{names} draw it together, but {one}" if len(found) > 1 else "{one} draws it, but"
        template = draw + " by values that cannot be its own: {why}"
        hint = said(template, names=names, one=OfEffect(one), why=why)
        return tuple(bent), before._replace(hint=hint)
    if len(found) < 2 or fit.model.joint is not None or not follows(fit):
        return None
    variables, gain, _ = fit.trace
    axis = next(axis for variable, axis in _AXES.items() if variable in variables)
    template = "{names} draw all but what follows {axis} there, which chance does not make"
    hint = said(template, names=names, axis=OfAxis(axis))
    return (), Unexplained(axis, gain * _variance(fit) / fit.rmse**2, hint)


def follows(fit: Fit) -> bool:
    """Whether what a fit leaves follows a law, beyond chance and beyond what its own laws may be off by."""
    _, gain, p_value = fit.trace
    return p_value <= RULE.rare and gain * _variance(fit) > off_by_law(fit)


def _variance(fit: Fit) -> float:
    """Return the mean squared error of one variance of the raw noise, (N m)^2."""
    return fit.noise_floor**2 / fit.white_squares
