"""From what a motor was given to its torque: by the torque constant, of a voltage the resistance too."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.door import checked
from ..errors import InputError
from .formats.units import GIVEN

if TYPE_CHECKING:
    from .capture import Capture


class PerUnit(NamedTuple):
    """The torque that one of what a motor was given makes, N m (N), and what its back-EMF takes off that for
    each rad/s (m/s), N m s/rad (N s/m).
    """

    torque: float
    back_emf: float


def torque_per_unit(unit: str, kt: float | None, resistance_ohm: float | None) -> PerUnit:
    """Return how what is in `unit` becomes a torque, of a motor that makes `kt` N m (N) of an ampere.

    A current I makes the torque kt I. A voltage V drives the current (V - kt omega)/R through a winding of
    resistance R: the torque is kt/R V, less kt^2/R omega (Franklin, Powell & Emami-Naeini, Feedback Control
    of Dynamic Systems, Section 2.3). InputError says what is missing, too much or not positive.
    """
    for name, value in (("kt", kt), ("resistance", resistance_ohm)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name} = {value} must be a positive number")
    if unit not in GIVEN:
        raise InputError(f"the torque is in {unit} already: leave kt and resistance out")
    if unit == "duty":
        raise InputError(
            "a torque in duty is of a supply that nobody named: map tau=duty*SUPPLY [V], which kt and "
            "resistance convert"
        )
    if kt is None:
        raise InputError(f"a torque in {unit} needs kt, the motor's torque constant; give it in N m/A")
    if unit == "A":
        if resistance_ohm is not None:
            raise InputError("a torque in A needs kt alone: leave the resistance out")
        return PerUnit(kt, 0.0)
    if resistance_ohm is None:
        raise InputError(
            "a torque in V needs the resistance of the motor's winding beside kt; give it in ohm"
        )
    return PerUnit(kt / resistance_ohm, kt**2 / resistance_ohm)


@checked
def as_torque(capture: Capture, kt: float | None, resistance_ohm: float | None) -> Capture:
    """Return the capture with its torque in N m (N); see `Capture.as_torque`."""
    source = capture.meta.get("source")
    try:
        per = torque_per_unit(capture.torque_unit, kt, resistance_ohm)
        tau = per.torque * capture.tau
        if per.back_emf:
            signals = capture.prepare()
            omega = signals.on_capture(signals.omega)
            tau -= per.back_emf * np.where(capture.mask, omega, np.nan)
    except InputError as error:
        raise InputError(f"{source}: {error}" if source else str(error)) from None
    motor = {"of": capture.torque_unit, "kt": kt, "resistance_ohm": resistance_ohm}
    return replace(capture, tau=tau, torque_unit="", meta={**capture.meta, "motor": motor})
