"""An emulated handle: what a newcomer has instead of a force-feedback device."""

from __future__ import annotations

from typing import Self

import numpy as np

from .. import _core
from ..base.door import checked
from ..capture.motions import MotionTrack, motion
from ..errors import InputError
from .renderer import Device

_RATE_HZ = 5000.0


def to_and_fro(angle_rad: float = 1.0, speed_rad_s: float = 4.0, ramp_s: float = 0.1) -> MotionTrack:
    """One turn of `angle_rad` forth and back at `speed_rad_s`, to be followed again and again."""
    period_s = 2.0 * (angle_rad / speed_rad_s + ramp_s)
    return motion(
        "turns", round(5000.0 * period_s) / 5000.0, speed=speed_rad_s, span=angle_rad, ramp_s=ramp_s
    )


class EmulatedHandle(_core.EmulatedHandle):
    """A handle with the inertia, the delay and the encoder of a `Device`, for `run_loop` and `start_loop`.

    It moves as time goes by on the loop's clock, real or virtual: a loop that is late finds it where the last
    torque took it. `hand` is the motion that a hand follows, again and again from where the handle stands,
    through a spring (0.5 N m/rad) and a damper (5e-3 N m s/rad); None is no hand. `measures_hand`: whether
    the device measures the torque of the hand.
    """

    @checked
    def __new__(
        cls,
        device: Device | None = None,
        hand: MotionTrack | None = None,
        *,
        theta: float = 0.0,
        measures_hand: bool = False,
    ) -> Self:
        """Put a handle at `theta` rad at rest. Raises InputError for a device or a motion that cannot be."""
        device = Device() if device is None else device
        return super().__new__(cls, device.row, theta, _followed(hand), measures_hand)

    @property
    def theta(self) -> float:
        """Angle, rad."""
        return self.shown[0]

    @property
    def omega(self) -> float:
        """Speed, rad/s."""
        return self.shown[1]

    @property
    def work_J(self) -> float:
        """Work that hands have done on it so far, J: negative where it gave out energy."""
        return self.shown[2]


def _followed(hand: MotionTrack | None) -> _core.HandRow | None:
    if hand is None:
        return None
    if len(hand.t) < 2:
        raise InputError("hand: is no motion; give two samples or more, as kc.motion(...) does")
    theta, omega, alpha = (np.ascontiguousarray(column, dtype=np.float64) for column in hand[1:])
    return theta, omega, alpha, (len(hand.t) - 1) / (hand.t[-1] - hand.t[0])
