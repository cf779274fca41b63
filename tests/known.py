"""Fits, comparisons and ladders of which everything is known: said, not made."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import knobcam as kc
from knobcam.fit.estimate import Estimate
from knobcam.learn.ladder import LearningStep

BASE = ("inertia", "coulomb", "viscous")
FLOOR = 1.0
SAMPLES = 1000.0


def joint_of(effects: tuple[str, ...]) -> str | None:
    """The effect among these that joins shaft and knob."""
    return next((one for one in effects if kc.effects()[one].place == "coupling"), None)


@dataclass(frozen=True)
class Known:
    """A fit that is said, not made. `helps` has how much larger its error would be without each effect."""

    rmse: float
    effects: tuple[str, ...] = BASE
    before: Any = None
    helps: dict[str, float] = field(default_factory=dict)
    params: dict[str, Estimate] = field(default_factory=dict)
    noise_floor: float = FLOOR
    white_squares: float = SAMPLES
    rmse_heldout: float = 1.0
    log_fault: str | None = None
    beyond: Any = None
    impossible: str | None = None
    torque_unit: str = "N m"
    period: float | None = None
    prepared: tuple[Any, ...] = ()
    laws: tuple[str, ...] = ()
    phases: frozenset[str] = frozenset()
    worths: dict[str, float] = field(default_factory=dict)

    @property
    def core(self) -> Any:
        model = SimpleNamespace(only=lambda effects: effects)
        return SimpleNamespace(free=self.effects, model=model, worth=lambda one: self.worths.get(one, 0.0))

    @property
    def model(self) -> Any:
        known = {"effects": self.effects, "coordinate": "rotary", "period": self.period, "core": None}
        known |= {"phases": self.phases}
        return SimpleNamespace(**known, catalogue=kc.effects, laws=self.laws, joint=joint_of(self.effects))

    @property
    def excess(self) -> float:
        return max(self.rmse**2 - self.noise_floor**2, 0.0)

    def drop(self, effect: str) -> Known:
        left = tuple(one for one in self.effects if one != effect)
        return Known(self.rmse * (1.0 + self.helps.get(effect, 0.0)), left, self, self.helps)


def estimate(value: float, se: float) -> Estimate:
    return Estimate(value, (value - 2.0 * se, value + 2.0 * se), "N m", se)


def comparison(complete: bool, *splits: Any, floor: float = FLOOR) -> Any:
    worst = max(splits, key=lambda one: one.share, default=None)
    by_axis = {one.axis: one for one in splits}
    known = {"complete": complete, "splits": splits, "worst": worst, "fit": Known(2.0, noise_floor=floor)}

    class Compared(SimpleNamespace):
        def __getitem__(self, axis: str) -> Any:
            return by_axis[axis]

    return Compared(**known)


def split(axis: str, share: float) -> Any:
    region = SimpleNamespace(start=10.0, end=14.0)
    return SimpleNamespace(
        axis=axis,
        share=share,
        mean_share=1.0 - share,
        regions=(region,),
        fails=share > 0.05,
        where=lambda: "there",
    )


def climbed(*steps: tuple[str, float], **last: Any) -> list[LearningStep]:
    """A ladder on which each effect leads to an error."""
    fit = Known(10.0)
    ladder = [LearningStep(fit)]
    for at, (effect, rmse) in enumerate(steps):
        more = last if at == len(steps) - 1 else {}
        fit = Known(rmse, (*fit.effects, effect), fit, **more)
        weighed = SimpleNamespace(comparison=comparison(False, split("position", 0.8)))
        ladder.append(LearningStep(fit, effect, diagnosis=weighed))
    return ladder
