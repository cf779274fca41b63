"""Where a capture comes from when it is no file: a simulated knob, an emulated rig, a rig on a port."""

from __future__ import annotations

import itertools
import os
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ..base import pages
from ..errors import InputError
from ..model import KNOBS, Model
from ..model.effects import effects
from ..model.hiding import hideable, hiding
from ..model.simulate import simulate
from ..rig.emulator import EmulatedRig, absent
from ..rig.port import BAUD, ports
from ..rig.record import record
from ..rig.wirelog import SUFFIX
from .bodies import flag, number, text, whole

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..capture import Capture
    from ..rig.record import Watch
    from .session import Tell

_LONGEST_S = 600.0
_SECONDS = 6.0
_SEED = 2**32 - 1
_FASTEST = 100.0  # times real time
_FASTEST_BAUD = 100_000_000
MOVES = {
    "sweep": "swept sine, the paper's",
    "multisine": "many sines at once",
    "turns": "turns at constant speed",
    "micro": "small and slow: what happens at a reversal",
    "hand": "by hand",
}
"""The motions, in words."""
_PUSH = {"push": "a hand pushes, the knob sticks and slips"}  # which only the simulator can do


class Source(Protocol):
    """What can be recorded from."""

    @property
    def name(self) -> str:
        """In words, for a name of a file too."""

    @property
    def motion(self) -> str:
        """Name of the motion that is recorded."""

    @property
    def hidden(self) -> tuple[str, ...]:
        """The effects that were put there for somebody to find."""

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record into a wire log and return the capture, as `knobcam capture` does."""


@dataclass(frozen=True)
class Simulated:
    """One of the five knobs by `kc.simulate`."""

    name: str
    hidden: tuple[str, ...]
    motion: str
    duration_s: float
    seed: int

    @classmethod
    def again(cls, told: Mapping[str, Any]) -> Simulated:
        """Return what `asdict` told of one."""
        return cls(**{**told, "hidden": tuple(told["hidden"])})

    def capture(self) -> Capture:
        """Simulate it."""
        knob = hiding(self.name, *self.hidden, motion=self.motion, duration_s=self.duration_s)
        return simulate(knob, self.motion, duration_s=self.duration_s, seed=self.seed)

    @property
    def made(self) -> str:
        """The Python that makes the same capture."""
        names = ", ".join(repr(name) for name in (self.name, *self.hidden))
        length = f"duration_s={self.duration_s!r}"
        knob = f"kc.hiding({names}, motion={self.motion!r}, {length})" if self.hidden else names
        return f"kc.simulate({knob}, {self.motion!r}, {length}, seed={self.seed})"


@dataclass(frozen=True)
class Emulated:
    """One of the five knobs in an emulated rig, which starts with the recording and ends with it."""

    name: str
    hidden: tuple[str, ...]
    motion: str
    duration_s: float
    seed: int
    speed: float

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record from it over its port."""
        tell("starting the emulated rig")
        knob = hiding(self.name, *self.hidden, motion=self.motion, duration_s=self.duration_s)
        with EmulatedRig(knob, seed=self.seed, speed=self.speed) as rig:
            tell("sending the motion to the rig")
            return record(rig.port, self.motion, output=log, duration_s=self.duration_s, progress=progress)


@dataclass(frozen=True)
class OnPort:
    """A rig on a serial port, or `serial:NUMBER`; options as `knobcam capture` has them.

    `clears` is the number of the fault that a person has been told of and wants to be cleared; no other is.
    """

    port: str
    motion: str
    duration_s: float
    model: str | None
    calibration: str | None
    baud: int
    clears: int | None = None
    name: str = "rig"
    hidden: tuple[str, ...] = ()

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record from it."""
        tell("looking for the rig, and sending it the motion")
        return record(
            self.port,
            self.motion,
            output=log,
            duration_s=self.duration_s,
            model=self.model,
            calibration=self.calibration,
            progress=progress,
            baud=self.baud,
            clear_fault=lambda told: self.clears is not None and f" fault {self.clears}: " in told,
        )


def document() -> pages.Sources:
    """Return what there is to choose from."""
    laws = effects()
    return {
        "knobs": [
            {"name": name, "words": Model.load(name).name, "hideable": hideable(name)} for name in KNOBS
        ],
        "effects": {name: laws[name].shows for name in laws},
        "motions": {"simulated": MOVES | _PUSH, "emulated": MOVES, "port": MOVES | {"hand": "you turn it"}},
        "no_emulated_rig": absent(),
        "ports": [{"port": port, "words": words} for port, words in ports().items()],
        "folder": str(Path.cwd()),
    }


def simulated(body: Mapping[str, Any]) -> Simulated:
    """Return the simulation that a body asks for. Raises InputError for what cannot be simulated."""
    motion, seconds, seed = _motion(body, MOVES | _PUSH), _seconds(body), _seed(body)
    return Simulated(*_knob(body, motion, seconds), motion, seconds, seed)


def recorded(body: Mapping[str, Any]) -> Source:
    """Return what a body wants to be recorded from. Raises InputError for what cannot be."""
    source = text(body, "source")
    if source == "emulated":
        if why := absent():
            raise InputError(f"the emulated rig: {why}")
        speed = number(body, "speed", 1.0, 0.1, _FASTEST)
        motion, seconds, seed = _motion(body, MOVES), _seconds(body), _seed(body)
        return Emulated(*_knob(body, motion, seconds), motion, seconds, seed, speed)
    if source != "port":
        raise InputError(f"source={source!r} is unknown; choose emulated or port")
    port = text(body, "port", "").strip()
    if not port:
        raise InputError("port is empty; choose one of the list, or type its path")
    model, calibration = (text(body, name, "").strip() or None for name in ("model", "calibration"))
    baud = whole(body, "baud", BAUD, 1, _FASTEST_BAUD)
    clears = None if body.get("clear_fault") is None else whole(body, "clear_fault", 0, 0, 255)
    return OnPort(port, _motion(body, MOVES), _seconds(body), model, calibration, baud, clears)


def new_log(folder: str, source: Source) -> Path:
    """Return a new name for a wire log in a folder. Raises InputError where there is no such folder."""
    place = Path(folder.strip() or ".").expanduser().absolute()
    if not place.is_dir():
        raise InputError(f"folder {str(place)!r}: there is none; make it first, or choose another")
    if not os.access(place, os.W_OK):
        raise InputError(f"folder {str(place)!r}: cannot be written to; choose another")
    logs = (place / f"{source.name}-{source.motion}-{count}{SUFFIX}" for count in itertools.count(1))
    return next(log for log in logs if not log.exists())


def _knob(body: Mapping[str, Any], motion: str, seconds: float) -> tuple[str, tuple[str, ...]]:
    """The knob and what it hides; a surprise is chosen here, and told nobody."""
    knob, named = text(body, "knob", "knob3"), body.get("effects", [])
    if not isinstance(named, list) or not all(isinstance(one, str) for one in named):
        raise InputError("effects: give a list of ids of the catalogue")
    if flag(body, "surprise", False):
        if named:
            raise InputError("a surprise is what nobody has chosen; choose no effects, or no surprise")
        named = [_surprise(knob, motion, seconds)]
    hiding(knob, *named, motion=motion, duration_s=seconds)  # refuses what cannot be hidden
    return knob, tuple(named)


def _surprise(knob: str, motion: str, seconds: float) -> str:
    """An effect that leaves a trace on this knob in this motion: another would be no fun to look for."""
    effects = hideable(knob, motion, duration_s=seconds)
    if not effects:
        raise InputError(f"no effect shows in {knob} in so little of this motion; record longer")
    return secrets.choice(effects)


def _motion(body: Mapping[str, Any], among: Mapping[str, str]) -> str:
    motion = text(body, "motion", "sweep")
    if motion not in among:
        raise InputError(f"motion={motion!r} is unknown; choose {', '.join(among)}")
    return motion


def _seconds(body: Mapping[str, Any]) -> float:
    return number(body, "duration_s", _SECONDS, 0.1, _LONGEST_S)


def _seed(body: Mapping[str, Any]) -> int:
    return whole(body, "seed", 0, 0, _SEED)
