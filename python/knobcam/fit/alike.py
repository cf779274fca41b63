"""Whether captures, and a model beside them, go into one fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..capture import Capture
from ..errors import InputError
from ..model import Model


def check_captures(captures: Sequence[Capture]) -> None:
    """Raise InputError where one is no capture, two are the same or their torques have different units."""
    for number, capture in enumerate(captures, 1):
        if not isinstance(capture, Capture):
            raise InputError(f"capture {number} is {capture!r}, no Capture; read files with load()")
        for before, other in enumerate(captures[: number - 1], 1):
            if np.array_equal(other.tau, capture.tau) and np.array_equal(other.theta, capture.theta):
                raise InputError(
                    f"captures {before} and {number} are the same: counting one twice would only narrow "
                    "the intervals; give it once"
                )
    units = {one.torque_unit: str(one.meta.get("source", "a capture")) for one in captures}
    if len(units) > 1 and len({one.coordinate for one in captures}) == 1:
        said = " and ".join(f"{source} in {unit}" for unit, source in units.items())
        raise InputError(
            f"torques of different units, {said}, cannot be one fit; convert them with kt (--kt)"
        )


def check_unit(model: Model, capture: Capture) -> None:
    """Raise InputError where a model has another unit of torque than a capture."""
    # Of another kind of axis the core says so.
    if model.torque_unit != capture.torque_unit and model.coordinate == capture.coordinate:
        raise InputError(
            f"the model is in {model.torque_unit}, {capture.meta.get('source', 'the capture')} in "
            f"{capture.torque_unit}; convert the one of the motor with kt (--kt)"
        )
