"""What a motion may ask of a knob and a rig: the limits within which an experiment is designed."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.reading import read_toml
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture.formats.units import Coordinate
    from ..capture.motions import MotionTrack
    from ..capture.prepare import Prepared

LONGEST_S = 10.0
MOST_S = 600.0
"""No motion takes longer."""
_MOST_SAMPLES = 10_000_000  # of a motion: every rival is followed over all of them, several times
_NUMBERS = (
    *("torque_Nm", "omega_rad_s", "alpha_rad_s2", "theta_min_rad", "theta_max_rad"),
    *("duration_s", "sample_rate_hz"),
)
_MOST_BYTES = 100_000
_ROUNDING = 1e-9
_FURTHEST = 1e9


@dataclass(frozen=True)
class Limits:
    """Largest torque, speed and acceleration either way, the angles to stay between, and how long, how often.

    SI; of a linear axis (`coordinate`, which captures say and no file does) in N and m. A motion that is
    designed exceeds none of them for any rival.
    """

    torque_Nm: float
    omega_rad_s: float
    alpha_rad_s2: float
    theta_min_rad: float
    theta_max_rad: float
    duration_s: float = LONGEST_S
    sample_rate_hz: float = 5000.0
    coordinate: Coordinate = "rotary"

    def __post_init__(self) -> None:
        for name, value in self.numbers.items():
            if not math.isfinite(value) or (value <= 0.0 and not name.startswith("theta")):
                wanted = "a number" if name.startswith("theta") else "a number above 0"
                raise InputError(f"limits, {name}: is {value}; give {wanted}")
        if not self.theta_min_rad < self.theta_max_rad:
            raise InputError(
                f"limits, theta_min_rad: is {self.theta_min_rad:.6g}, not below theta_max_rad, "
                f"{self.theta_max_rad:.6g}; nothing could move"
            )
        if not self.duration_s <= MOST_S:
            raise InputError(f"limits, duration_s: is {self.duration_s:.6g} s; give at most {MOST_S:.0f}")
        if not 10.0 <= self.sample_rate_hz <= 1e6:
            raise InputError(f"limits, sample_rate_hz: is {self.sample_rate_hz:.6g}; give 10 to 1e6")

    @classmethod
    def reached(cls, prepared: Sequence[Prepared], duration_s: float = LONGEST_S) -> Limits:
        """Return what captures themselves reached, 10 s long, at the rate of the first."""

        def most(name: str) -> float:
            every = [getattr(one, name)[one.used] for one in prepared]
            return float(np.max(np.abs(np.concatenate(every))))

        theta = np.concatenate([one.theta[one.used] for one in prepared])
        torque = max(float(np.max(np.abs(one.capture.tau[one.capture.mask]))) for one in prepared)
        return cls(
            torque,
            most("omega"),
            most("alpha"),
            float(np.min(theta)),
            float(np.max(theta)),
            duration_s=min(duration_s, _MOST_SAMPLES / prepared[0].core.rate_hz),
            sample_rate_hz=prepared[0].core.rate_hz,
            coordinate=prepared[0].capture.coordinate,
        )

    @classmethod
    def furthest(cls) -> Limits:
        """Return limits that nothing reaches, beside which a file of them is read."""
        return cls(_FURTHEST, _FURTHEST, _FURTHEST, -_FURTHEST, _FURTHEST, MOST_S)

    @classmethod
    def load(cls, path: str | os.PathLike[str], usual: Limits) -> Limits:
        """Read a file of limits; what it does not name is as usual. Raises InputError for what is none."""
        advice = "write lines such as torque_Nm = 0.1"
        values = read_toml(path, "file of limits", _MOST_BYTES, advice)
        if isinstance(schema := values.get("schema"), str):
            raise InputError(f"{path}: calls itself {schema[:40]}, which is no file of limits; {advice}")
        return usual.with_some(values, f"{path}: ")

    def with_some(self, given: Mapping[str, object], where: str = "limits, ") -> Limits:
        """Return them with some others by their names. Raises InputError, from `where`, for what is none."""
        numbers: dict[str, Any] = {}
        for name, value in given.items():
            if name not in _NUMBERS:
                of_parts = "a table of what a batch judges parts by, and " if isinstance(value, dict) else ""
                raise InputError(f"{where}{name}: is {of_parts}no limit; known are {', '.join(_NUMBERS)}")
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise InputError(f"{where}{name}: is {value!r}; give a number")
            numbers[name] = float(value)
        try:
            return replace(self, **numbers)
        except InputError as error:
            raise InputError(f"{where}{str(error).removeprefix('limits, ')}") from None

    @classmethod
    def within(
        cls,
        given: Limits | str | os.PathLike[str] | None,
        prepared: Sequence[Prepared],
        duration_s: float = LONGEST_S,
    ) -> Limits:
        """Return limits that are given, as they are or in a file, beside what captures reached.

        Raises InputError for more samples than a motion is designed with.
        """
        limits = given if isinstance(given, Limits) else cls.reached(prepared, duration_s)
        if given is not None and not isinstance(given, Limits):
            limits = cls.load(given, limits)
        samples = limits.duration_s * limits.sample_rate_hz
        if samples > _MOST_SAMPLES:
            many = f"{limits.duration_s:.6g} s at {limits.sample_rate_hz:.6g} Hz are {samples:.2g} samples"
            raise InputError(f"limits, duration_s: {many}; give at most {_MOST_SAMPLES:.0e}")
        return limits

    @property
    def numbers(self) -> dict[str, float]:
        """All of them by name."""
        return {name: getattr(self, name) for name in _NUMBERS}

    @property
    def unit(self) -> str:
        """What positions are in."""
        return "m" if self.coordinate == "linear" else "rad"

    @property
    def middle(self) -> float:
        """The angle between both ends."""
        return 0.5 * (self.theta_min_rad + self.theta_max_rad)

    @property
    def half(self) -> float:
        """Half of the range of angles."""
        return 0.5 * (self.theta_max_rad - self.theta_min_rad)

    def widened(self, name: str, times: float) -> Limits:
        """Return them with one so many times as wide; `theta` widens both angles about their middle."""
        if name != "theta":
            wider = times * self.numbers[name]
            given: dict[str, Any] = {name: min(wider, MOST_S) if name == "duration_s" else wider}
            return replace(self, **given)
        half = times * self.half
        return replace(self, theta_min_rad=self.middle - half, theta_max_rad=self.middle + half)

    def hold(self, track: MotionTrack) -> bool:
        """Whether a motion stays within them; the torque, which depends on a knob, apart."""
        more = 1.0 + _ROUNDING
        slack = _ROUNDING * self.half
        return (
            float(np.max(np.abs(track.omega))) <= self.omega_rad_s * more
            and float(np.max(np.abs(track.alpha))) <= self.alpha_rad_s2 * more
            and float(np.min(track.theta)) >= self.theta_min_rad - slack
            and float(np.max(track.theta)) <= self.theta_max_rad + slack
            and float(track.t[-1]) <= self.duration_s * more
        )
