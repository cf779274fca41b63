"""Where a capture comes from when it is no file: a simulated knob, an emulated rig, a rig on a port."""

from __future__ import annotations

import itertools
import os
import secrets
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

from ..base import pages_sources
from ..capture.motion_plan import MotionPlan
from ..capture.person import as_told
from ..errors import InputError
from ..model import KNOBS, Model
from ..model.effects import effects
from ..model.hiding import hideable, hiding
from ..model.simulate import simulate
from ..rig.asked import BY_HAND
from ..rig.emulator import EmulatedRig, absent
from ..rig.port import BAUD, ports
from ..rig.record import record
from ..rig.wirelog import SUFFIX
from .bodies import flag, number, text, whole

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..capture import Capture
    from ..learn.limits import Limits
    from ..rig.record import Watch
    from .tell import Tell

_LONGEST_S = 600.0
LED_S = 4.0
"""Seconds in which a hand is led in before a motion begins."""
_LATE_S = 2.0  # by which a hand may end later than it is led
_DESIGNED = "designed"  # the name of a motion that was
PARSED = "MotionPlan.parse"
"""What a script calls that makes such a motion."""
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
    def made_of(self) -> str:
        """Name of the motion that is recorded."""

    @property
    def hidden(self) -> tuple[str, ...]:
        """The effects that were put there for somebody to find."""

    @property
    def known(self) -> Mapping[str, Any]:
        """By which it is found again."""

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record into a wire log and return the capture, as `knobcam capture` does."""


@dataclass(frozen=True)
class Simulated:
    """One of the five knobs by `kc.simulate`.

    `plan` is the text of a motion file that it makes, at `rate_hz`; what it hides is as large as `motion` and
    `duration_s` say. Of a challenge it has the `level`.
    """

    name: str
    hidden: tuple[str, ...]
    motion: str
    duration_s: float
    seed: int
    plan: str = ""
    rate_hz: float = 5000.0
    level: str = ""

    @classmethod
    def again(cls, told: Mapping[str, Any]) -> Simulated:
        """Return what `asdict` told of one."""
        return cls(**{**told, "hidden": tuple(told["hidden"])})

    @property
    def words(self) -> str:
        """What it is."""
        return f"the simulated {self.name}"

    def trying(self, plan: str, rate_hz: float, seed: int) -> Simulated:
        """Return the same knob, for another motion."""
        return replace(self, plan=plan, rate_hz=rate_hz, seed=seed)

    def capture(self, told: Mapping[str, Any] = MappingProxyType({})) -> Capture:
        """Simulate it; `told` is what a person said of it, as `knobcam.load` takes that."""
        knob = hiding(self.name, *self.hidden, motion=self.motion, duration_s=self.duration_s)
        if self.plan:
            made = simulate(knob, MotionPlan.parse(self.plan).track(self.rate_hz), seed=self.seed)
        else:
            made = simulate(knob, self.motion, duration_s=self.duration_s, seed=self.seed)
        return as_told(made, self.words, told.get("overrule", ()), told.get("leave_out", ()))

    @property
    def made(self) -> str:
        """The Python that makes the same capture."""
        names = ", ".join(repr(name) for name in (self.name, *self.hidden))
        length = f"duration_s={self.duration_s!r}"
        knob = f"kc.hiding({names}, motion={self.motion!r}, {length})" if self.hidden else names
        if self.plan:
            return f"kc.simulate({knob}, {PARSED}({self.plan!r}).track({self.rate_hz!r}), seed={self.seed})"
        return f"kc.simulate({knob}, {self.motion!r}, {length}, seed={self.seed})"


@dataclass(frozen=True)
class Emulated:
    """One of the five knobs in an emulated rig, which starts with the recording and ends with it.

    `plan` is the text of a motion file in place of `motion`, made by its motor or `by_hand`, by its hand.
    """

    name: str
    hidden: tuple[str, ...]
    motion: str
    duration_s: float
    seed: int
    speed: float
    plan: str = ""
    by_hand: bool = False

    @property
    def words(self) -> str:
        """What it is."""
        return f"an emulated rig with {self.name}"

    @property
    def made_of(self) -> str:
        """Name of the motion that is recorded."""
        return _DESIGNED if self.plan else self.motion

    @property
    def known(self) -> Mapping[str, Any]:
        """By which it is found again."""
        return {"emulated": asdict(replace(self, plan="", by_hand=False))}

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record from it over its port."""
        tell("starting the emulated rig")
        knob = hiding(self.name, *self.hidden, motion=self.motion, duration_s=self.duration_s)
        plan = MotionPlan.parse(self.plan) if self.plan else None
        with TemporaryDirectory(prefix="knobcam-") as folder:
            file = plan.save(Path(folder) / "motion.toml") if plan and self.by_hand else None
            with EmulatedRig(knob, seed=self.seed, speed=self.speed, motion=file) as rig:
                tell("sending the motion to the rig")
                motion, seconds = _asked(self.motion, self.duration_s, plan, self.by_hand)
                return record(rig.port, motion, output=log, duration_s=seconds, progress=progress, told=tell)


@dataclass(frozen=True)
class OnPort:
    """A rig on a serial port, or `serial:NUMBER`; options as `knobcam capture` has them.

    `clears` is the number of the fault that a person has been told of and wants to be cleared; no other is.
    `plan` is the text of a motion file in place of `motion`, for the motor or `by_hand`; `limits` are its.
    """

    port: str
    motion: str
    duration_s: float
    model: str | None
    calibration: str | None
    baud: int
    clears: int | None = None
    plan: str = ""
    by_hand: bool = False
    limits: Limits | None = None
    name: str = "rig"
    hidden: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """What it is."""
        return f"the rig on {self.port}"

    @property
    def made_of(self) -> str:
        """Name of the motion that is recorded."""
        return _DESIGNED if self.plan else self.motion

    @property
    def known(self) -> Mapping[str, Any]:
        """By which it is found again."""
        return {"port": asdict(replace(self, clears=None, plan="", by_hand=False, limits=None))}

    def record(self, log: Path, tell: Tell, progress: Watch) -> Capture:
        """Record from it."""
        tell("looking for the rig, and sending it the motion")
        plan = MotionPlan.parse(self.plan) if self.plan else None
        motion, seconds = _asked(self.motion, self.duration_s, plan, self.by_hand)
        return record(
            self.port,
            motion,
            output=log,
            duration_s=seconds,
            model=self.model,
            calibration=self.calibration,
            limits=None if self.by_hand else self.limits,
            progress=progress,
            told=tell,
            baud=self.baud,
            clear_fault=lambda told: self.clears is not None and f" fault {self.clears}: " in told,
        )


def again(told: Mapping[str, Any]) -> Emulated | OnPort:
    """Return what `known` told of a rig."""
    if "emulated" in told:
        return Emulated(**{**told["emulated"], "hidden": tuple(told["emulated"]["hidden"])})
    return OnPort(**{**told["port"], "hidden": ()})


def _asked(
    motion: str, seconds: float, plan: MotionPlan | None, by_hand: bool
) -> tuple[str | MotionPlan, float]:
    """Return the motion to record, and how long: a hand begins later than the rig, and ends later."""
    if plan is None:
        return motion, seconds
    return (BY_HAND, LED_S + plan.seconds + _LATE_S) if by_hand else (plan, seconds)


def document() -> pages_sources.Sources:
    """Return what there is to choose from."""
    laws = effects()
    return {
        "knobs": [
            {"name": name, "words": Model.load(name).name, "hideable": hideable(name)} for name in KNOBS
        ],
        "effects": {name: laws[name].shows for name in laws},
        "titles": {name: laws[name].title for name in laws},
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
    return on_port(body)


def on_port(body: Mapping[str, Any]) -> OnPort:
    """Return the rig on a port that a body names. Raises InputError for what is none."""
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
    logs = (place / f"{source.name}-{source.made_of}-{count}{SUFFIX}" for count in itertools.count(1))
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
