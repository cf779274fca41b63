"""Motions from rest to rest as a few numbers that a person can read: moves, rests, waves; and their files.

A move gains speed along half a cosine, so that its angle, speed and acceleration are known exactly and none
of them jumps. Waves are a Fourier series (Swevers, Ganseman, Tuekel, De Schutter & Van Brussel 1997) that
swells from rest and dies away to it.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.reading import parse_toml, read_toml
from ..base.writing import write
from ..errors import InputError
from .motions import MotionTrack

if TYPE_CHECKING:
    from ..base.arrays import FloatArray

SCHEMA = "knobcam.motion/1"
_ADVICE = "`knobcam next -o` writes one"
_MOST_BYTES = 20_000_000  # of a file with every sample of a minute
_LONGEST_S = 600.0
_JUMP_S2 = 1e6  # an acceleration, rad/s^2, that no knob has: samples that far apart are a jump


@dataclass(frozen=True)
class Move:
    """To an angle `to` (rad), at most so fast (rad/s), with at most this acceleration (rad/s^2)."""

    to: float
    speed: float
    acceleration: float

    def profile(self, start: float) -> tuple[float, float, float]:
        """Return peak speed, seconds in which it is gained (and lost) and seconds in between."""
        way = abs(self.to - start)
        speed = min(self.speed, math.sqrt(2.0 * self.acceleration * way / math.pi))
        if way == 0.0 or speed == 0.0:
            return 0.0, 0.0, 0.0
        ramp = math.pi * speed / (2.0 * self.acceleration)
        return speed, ramp, max(0.0, way / speed - ramp)

    def seconds(self, start: float) -> float:
        """How long it takes."""
        _, ramp, cruise = self.profile(start)
        return 2.0 * ramp + cruise

    def end(self, _: float) -> float:
        """Where it ends."""
        return self.to

    def along(self, t: FloatArray, start: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return angle, speed and acceleration at times since its beginning."""
        speed, ramp, cruise = self.profile(start)
        if speed == 0.0:
            return np.full_like(t, self.to), np.zeros_like(t), np.zeros_like(t)
        sign = math.copysign(1.0, self.to - start)
        gaining = np.minimum(t, ramp)
        losing = np.clip(t - ramp - cruise, 0.0, ramp)
        turn = math.pi / ramp
        way = 0.5 * speed * (gaining - np.sin(turn * gaining) / turn)
        way += speed * np.clip(t - ramp, 0.0, cruise)
        way += 0.5 * speed * (losing + np.sin(turn * losing) / turn)
        fast = 0.5 * speed * (np.cos(turn * losing) - np.cos(turn * gaining))
        faster = 0.5 * speed * turn * (np.sin(turn * gaining) - np.sin(turn * losing))
        return start + sign * way, sign * fast, sign * faster

    def row(self) -> str:
        """Return it as a line of the file."""
        return f"move = {{ to = {self.to!r}, speed = {self.speed!r}, acceleration = {self.acceleration!r} }}"


@dataclass(frozen=True)
class Rest:
    """So many seconds at rest."""

    s: float

    def seconds(self, _: float) -> float:
        """How long it takes."""
        return self.s

    def end(self, start: float) -> float:
        """Where it ends."""
        return start

    def along(self, t: FloatArray, start: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return angle, speed and acceleration at times since its beginning."""
        return np.full_like(t, start), np.zeros_like(t), np.zeros_like(t)

    def row(self) -> str:
        """Return it as a line of the file."""
        return f"rest = {{ s = {self.s!r} }}"


@dataclass(frozen=True)
class Waves:
    """Sines and cosines (rad) of the multiples of a frequency about where it begins, from rest to rest."""

    s: float
    swell_s: float
    fundamental_hz: float
    sine: tuple[float, ...]
    cosine: tuple[float, ...]

    def seconds(self, _: float) -> float:
        """How long it takes."""
        return self.s

    def end(self, start: float) -> float:
        """Where it ends."""
        return start

    def along(self, t: FloatArray, start: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return angle, speed and acceleration at times since its beginning."""
        x, v, a = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        for order, (p, q) in enumerate(zip(self.sine, self.cosine, strict=True), 1):
            w = 2.0 * math.pi * self.fundamental_hz * order
            sin, cos = np.sin(w * t), np.cos(w * t)
            x += p * sin + q * cos
            v += w * (p * cos - q * sin)
            a -= w**2 * (p * sin + q * cos)
        left = np.minimum(t, self.s - t)
        u = np.clip(left / self.swell_s, 0.0, 1.0)
        sign = np.where(t < 0.5 * self.s, 1.0, -1.0) / self.swell_s
        # The polynomial of fifth degree whose first two derivatives vanish at both ends.
        e = u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        de = 30.0 * u**2 * (1.0 - u) ** 2 * sign
        dde = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / self.swell_s**2
        return start + e * x, e * v + de * x, e * a + 2.0 * de * v + dde * x

    def row(self) -> str:
        """Return it as a line of the file."""
        return (
            f"waves = {{ s = {self.s!r}, swell_s = {self.swell_s!r}, "
            f"fundamental_hz = {self.fundamental_hz!r}, "
            f"sine = {list(self.sine)!r}, cosine = {list(self.cosine)!r} }}"
        )


Part = Move | Rest | Waves
_KINDS: dict[str, type[Move] | type[Rest] | type[Waves]] = {"move": Move, "rest": Rest, "waves": Waves}


@dataclass(frozen=True)
class MotionPlan:
    """A motion from rest at `start` (rad, m on a linear axis) to rest, part by part; `about` in words."""

    parts: tuple[Move | Rest | Waves, ...]
    start: float = 0.0
    about: str = ""

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return sum(part.seconds(start) for part, start in self._starts())

    def _starts(self) -> list[tuple[Part, float]]:
        places, at = [], self.start
        for part in self.parts:
            places.append((part, at))
            at = part.end(at)
        return places

    def track(self, rate_hz: float) -> MotionTrack:
        """Return the motion, sampled at n / rate for n = 1, 2, ..., to its end."""
        samples = max(3, math.ceil(self.seconds * rate_hz))
        t = np.arange(1, samples + 1) / rate_hz
        columns = np.zeros((3, samples))
        columns[0] = self.start
        begin = 0.0
        for part, start in self._starts():
            end = begin + part.seconds(start)
            first, last = np.searchsorted(t, (begin, end), side="right")
            columns[:, first:last] = part.along(t[first:last] - begin, start)
            columns[:, last:] = [[part.end(start)], [0.0], [0.0]]
            begin = end
        return MotionTrack(t, *columns)

    def text(self) -> str:
        """The text of the motion file; `load` gives the same motion back, to the last bit."""
        lines = [
            f'schema = "{SCHEMA}"',
            f"about = {json.dumps(self.about, ensure_ascii=False)}",
            f"start = {self.start!r}",
        ]
        for part in self.parts:
            lines += ["", "[[parts]]", part.row()]
        return "\n".join(lines) + "\n"

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the motion file; it appears whole or not at all."""
        return write(path, self.text())

    @classmethod
    def parse(cls, text: str, source: str = "motion") -> MotionPlan:
        """Return the motion of a file's text. Raises InputError for what is none, or is of samples."""
        values = parse_toml(source, text, "motion file", _ADVICE)
        _check_schema(source, values)
        return _plan(source, values)


def load_track(path: str | os.PathLike[str], rate_hz: float) -> MotionTrack:
    """Return the motion in a file, of parts or of samples (`theta`, `sample_rate_hz`), at a rate.

    Raises InputError, one line, for what is no motion, jumps, or is of samples at another rate.
    """
    values = read_toml(path, "motion file", _MOST_BYTES, _ADVICE)
    _check_schema(path, values)
    if "theta" in values:
        return _sampled(path, values, rate_hz)
    return _plan(path, values).track(rate_hz)


def _check_schema(path: str | os.PathLike[str], values: dict[str, Any]) -> None:
    if values.get("schema") != SCHEMA:
        raise InputError(f'{path}: has no schema = "{SCHEMA}"; `knobcam next -o` writes a motion file')


def _plan(path: str | os.PathLike[str], values: dict[str, Any]) -> MotionPlan:
    rows = values.get("parts")
    if not isinstance(rows, list) or not rows:
        raise InputError(f"{path}: has neither [[parts]] nor theta; name what moves")
    parts = tuple(_part(path, at, row) for at, row in enumerate(rows, 1))
    about = values.get("about", "")
    if not isinstance(about, str):
        raise InputError(f"{path}: about: is {about!r}; give a text")
    plan = MotionPlan(parts, _number(path, "start", values.get("start", 0.0)), about)
    if not 0.0 < plan.seconds <= _LONGEST_S:
        raise InputError(f"{path}: takes {plan.seconds:.4g} s; a motion takes more than 0 and at most 600 s")
    return plan


def _part(path: str | os.PathLike[str], at: int, row: Any) -> Part:
    where = f"part {at}"
    known = ", ".join(_KINDS)
    if not isinstance(row, dict) or len(row) != 1 or next(iter(row)) not in _KINDS:
        raise InputError(f"{path}: {where} is none; write one of {known}")
    name, given = next(iter(row.items()))
    fields = _KINDS[name].__dataclass_fields__
    if not isinstance(given, dict) or set(given) != set(fields):
        raise InputError(f"{path}: {where}, {name}: takes {', '.join(fields)}, all of them")
    values: dict[str, Any] = {}
    for field, value in given.items():
        if field in ("sine", "cosine"):
            listed = value if isinstance(value, list) else [value]
            values[field] = tuple(_number(path, f"{where}, {field}", one) for one in listed)
            continue
        values[field] = _number(path, f"{where}, {field}", value)
        if field != "to" and values[field] <= 0.0:
            raise InputError(f"{path}: {where}, {field}: is {value}; give a number above 0")
    if len(values.get("sine", ())) != len(values.get("cosine", ())):
        raise InputError(f"{path}: {where}: needs as many cosines as sines; fill up with zeros")
    if 2.0 * values.get("swell_s", 0.0) > values.get("s", math.inf):
        raise InputError(
            f"{path}: {where}, swell_s: is more than half of s; it swells and dies away within s"
        )
    return _KINDS[name](**values)


def _sampled(path: str | os.PathLike[str], values: dict[str, Any], rate_hz: float) -> MotionTrack:
    given = _number(path, "sample_rate_hz", values.get("sample_rate_hz"))
    if not math.isclose(given, rate_hz, rel_tol=1e-6):
        raise InputError(
            f"{path}: its samples are of {given:.6g} Hz, wanted are {rate_hz:.6g} Hz; sample it at that rate"
        )
    listed = values["theta"] if isinstance(values["theta"], list) else []
    theta = np.array([_number(path, "theta", one) for one in listed])
    if len(theta) < 5:
        raise InputError(f"{path}: theta has {len(theta)} samples; a motion has five or more")
    omega = np.gradient(theta) * rate_hz
    alpha = np.gradient(omega) * rate_hz
    fastest = int(np.argmax(np.abs(np.diff(theta, 2))))
    if abs(float(np.diff(theta, 2)[fastest])) * rate_hz**2 > _JUMP_S2:
        raise InputError(f"{path}: theta jumps near row {fastest + 2}; no knob moves so, smooth it")
    return MotionTrack(np.arange(1, len(theta) + 1) / rate_hz, theta, omega, alpha)


def _number(path: str | os.PathLike[str], name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{path}: {name}: is {value!r}; give a number")
    return float(value)
