"""Which effects a model could be given, and why others cannot be missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..capture.formats.units import VOLTAGES
from .beyond import incoherent

if TYPE_CHECKING:
    from collections.abc import Collection

    from .fitting import Fit


def absent(fit: Fit, without: Collection[str]) -> tuple[list[str], dict[str, str]]:
    """Return the effects that a model could be given but those of `without`, and why others could not."""
    catalogue = fit.model.catalogue()
    have = fit.model.effects
    free = {name for name, parameter in fit.model.params.items() if parameter.role == "free"}
    joined = fit.model.joint is not None
    wrong = incoherent(fit)
    left_out = {}
    could = []
    for one, row in catalogue.items():
        if one in {*have, *without} or row.unsearched:
            continue
        if row.needs is not None and row.needs not in have:
            left_out[one] = f"it changes '{row.needs}', which the model does not have"
        elif joined and row.place == "coupling":
            left_out[one] = "another joint is in the model already"
        elif wrong and row.place != "load":
            left_out[one] = "errors of the recorded motion look like it"
        elif row.given is not None and fit.model.torque_unit in VOLTAGES:
            left_out[one] = row.given
        elif row.taken_up is not None and free.issuperset(row.taken_up.by):
            left_out[one] = row.taken_up.why
        else:
            could.append(one)
    return could, left_out
