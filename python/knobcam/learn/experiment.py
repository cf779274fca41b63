"""The next experiment: the motion that tells apart what captures so far cannot, within limits."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..base import showing
from ..base.door import checked
from ..base.tables import TextTable, text_table
from ..capture.motion_plan import MotionPlan
from ..capture.motions import MotionTrack
from ..errors import InputError
from .contenders import contenders
from .limits import Limits
from .motion_space import Piece, bank, changed, plan, standard
from .telling import TOLD, Rival, Telling, wrong_choice

if TYPE_CHECKING:
    from pathlib import Path

    from ..base.arrays import FloatArray
    from ..base.showing import Figure
    from .learning import LearningResult

STANDARD = ("sweep", "multisine", "turns", "hand")
"""The motions that a designed one is held against."""
_SEARCH_S = 5.5
_CHANGE_S = 0.6
_KEPT = 5
_EASE = 0.75
_EASINGS = 12
_FASTER = 2.0, 5.0
_THINNED = {True: 2, False: 4}  # with a joint among the rivals, or none: samples of the search
_SLOWEST_HZ = 500.0


class Expected(NamedTuple):
    """A pair of rivals (places in `Experiment.rivals`): D of the motion, and of the best standard one."""

    pair: tuple[int, int]
    d: float
    standard_d: float

    @property
    def wrong_choice(self) -> float:
        """How often the wrong one would be chosen."""
        return wrong_choice(self.d)


class Sharpened(NamedTuple):
    """A parameter and its standard error: now, after the motion, and after the best standard one."""

    param: str
    before: float
    after: float
    after_standard: float


class Change(NamedTuple):
    """The limit that would have to be widened, to what, and the least D then."""

    limit: str
    to: float
    d: float


@dataclass(frozen=True, eq=False, repr=False)
class Experiment(showing.Tabled):
    """A motion, and what it is expected to tell; immutable.

    `expected` has a row for each pair of rivals, `sharpened` one for each parameter that was asked for.
    `change` is the smallest change of the limits that would tell the rivals apart where the motion does not;
    None: none that was tried would.
    """

    rivals: tuple[Rival, ...]
    limits: Limits
    plan: MotionPlan
    track: MotionTrack
    expected: tuple[Expected, ...]
    peak: tuple[float, float, float]
    sharpened: tuple[Sharpened, ...] = ()
    change: Change | None = None
    took_s: float = field(default=0.0, compare=False)

    @property
    def separable(self) -> bool:
        """Whether all rivals are told apart: D is at least 10.8, and at most 5 of 100 choices are wrong."""
        return all(one.d >= TOLD for one in self.expected)

    @property
    def headline(self) -> str:
        """What the motion would tell, in a sentence."""
        if self.sharpened:
            one = self.sharpened[0]
            return (
                f"{one.param} would be known {one.before / one.after:.3g} times as well after "
                f"{self.seconds:.3g} s: {self.plan.about}."
            )
        worst = min(self.expected, key=lambda one: one.d)
        names = " and ".join(self.rivals[i].name for i in worst.pair)
        if self.separable:
            return (
                f"{self.seconds:.3g} s tell {names} apart "
                f"(the wrong one is chosen in {_percent(worst.wrong_choice)}): {self.plan.about}."
            )
        told = f"No runnable motion within these limits tells {names} apart: D is {worst.d:.3g} at most"
        if self.change is None:
            return f"{told}, and no wider limit that was tried helps: on any motion they are nearly the same."
        limit, to, d = self.change
        return f"{told}. With {limit} = {to:.4g} it would be {d:.3g}."

    @property
    def seconds(self) -> float:
        """How long the motion takes."""
        return float(self.track.t[-1])

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam next --json`."""
        torque, omega, alpha = self.peak
        return {
            "schema": "knobcam.next/1",
            "rivals": [list(rival.effects) for rival in self.rivals],
            "separable": self.separable,
            "expected": [
                {
                    "pair": list(one.pair),
                    "D": one.d,
                    "wrong_choice": one.wrong_choice,
                    "standard_D": one.standard_d,
                }
                for one in self.expected
            ],
            "sharpened": [one._asdict() for one in self.sharpened],
            "change": None if self.change is None else self.change._asdict(),
            "motion": {
                "sample_rate_hz": self.limits.sample_rate_hz,
                "theta": self.track.theta.tolist(),
                "about": self.plan.about,
            },
            "peak": {"torque_Nm": torque, "omega_rad_s": omega, "alpha_rad_s2": alpha},
            "headline": self.headline,
            "took_s": self.took_s,
        }

    HEAD = ("to be told apart", "D", "wrong choice", "D of the best standard motion")
    SHARPENED = ("parameter", "standard error now", "after the motion", "after the best standard one")

    def rows(self) -> list[tuple[str, ...]]:
        """What is expected as rows of text, under the words of `HEAD`, or of `SHARPENED`."""
        if self.sharpened:
            return [
                (one.param, f"{one.before:.3g}", f"{one.after:.3g}", f"{one.after_standard:.3g}")
                for one in self.sharpened
            ]
        rows: list[tuple[str, ...]] = []
        for one in self.expected:
            names = " or ".join(self.rivals[i].name for i in one.pair)
            rows.append((names, f"{one.d:.3g}", _percent(one.wrong_choice), f"{one.standard_d:.3g}"))
        return rows

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.headline, self.SHARPENED if self.sharpened else self.HEAD, self.rows()),)

    def __repr__(self) -> str:
        torque, omega, alpha = self.peak
        at_most = self.limits
        head = self.SHARPENED if self.sharpened else self.HEAD
        return "\n".join(
            [
                self.headline,
                text_table(head, self.rows()),
                f"At most {torque:.3g} N m (limit {at_most.torque_Nm:.3g}), {omega:.3g} rad/s "
                f"({at_most.omega_rad_s:.3g}), {alpha:.3g} rad/s^2 ({at_most.alpha_rad_s2:.3g}), "
                "for every rival.",
            ]
        )

    def plot(self) -> Figure:
        """The motion, how the rivals' torques part on it, and D beside that of the standard motions."""
        return showing.plot(self)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the motion file, which `capture`, `simulate` and `record` take, and return its path."""
        return self.plan.save(path)


@checked
def next_experiment(
    story: LearningResult,
    *,
    rivals: Sequence[str] = (),
    sharpen: str | None = None,
    limits: Limits | str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    search_s: float = _SEARCH_S,
    seed: int = 0,
) -> Experiment:
    """Return the motion that would tell apart what was learned and what else it could be.

    `rivals` are sets of effects beyond the base model, each as names with `+` between (`base` for none); by
    default those that the captures could not tell. Without any, or with `sharpen`, the motion is the one that
    makes a parameter known best, by default the widest. `limits` are by default what the captures reached,
    10 s long; the motion exceeds none of them for any rival. It is searched for `search_s` seconds; the same
    `seed` begins the same search.

    Raises InputError for rivals that cannot be fitted and limits within which no motion is.
    """
    begun = time.monotonic()
    tell = progress or (lambda _: None)
    within = Limits.within(limits, story.fit.prepared)
    tell("fitting the rivals")
    found = contenders(story, rivals) if sharpen is None else ()
    tell("looking for the motion")
    designed = design(found or (Rival(story.found, story.fit),), within, sharpen, search_s, seed)
    return replace(designed, took_s=time.monotonic() - begun)


def design(
    rivals: tuple[Rival, ...],
    limits: Limits,
    sharpen: str | None = None,
    search_s: float = _SEARCH_S,
    seed: int = 0,
) -> Experiment:
    """Return the motion that parts rivals, or of a single one makes a parameter known best; see above."""
    begun = time.monotonic()
    designed = _Design(Telling(rivals, seed), limits, sharpen).best(search_s, seed)
    return replace(designed, took_s=time.monotonic() - begun)


@dataclass(frozen=True, eq=False)
class _Design:
    """A search for a motion."""

    telling: Telling
    limits: Limits
    sharpen: str | None

    @cached_property
    def param(self) -> str | None:
        """The parameter to be sharpened, None where rivals are to be told apart."""
        if len(self.telling.rivals) > 1:
            return None
        core = self.telling.rivals[0].fit.core
        params = self.telling.rivals[0].fit.params
        if self.sharpen is not None:
            if self.sharpen not in core.free:
                known = ", ".join(core.free)
                raise InputError(
                    f"sharpen={self.sharpen!r}: is no parameter that was fitted; known are {known}"
                )
            return self.sharpen
        return max(core.free, key=lambda name: params[name].se / max(abs(params[name].value), 1e-300))

    def best(self, search_s: float, seed: int) -> Experiment:
        """Return the best motion that is found in so long, and what it tells."""
        pool = self._searched(search_s, seed)
        if not pool:
            raise InputError(
                f"limits, torque_Nm: {self.limits.torque_Nm:.4g} N m move no rival at all; give more"
            )
        tracks = [self._runnable(pieces, draws=True) for pieces in pool]
        known = [(motion, *self._told(motion[0].track(self._search_hz()))) for motion in tracks if motion]
        if not known:
            raise InputError("limits, torque_Nm: too little for what the rivals may ask for; give more")
        (chosen, track), told, _ = max(known, key=lambda one: one[2])
        peak = (
            self.telling.peak(track, draws=True),
            float(np.max(np.abs(track.omega))),
            float(np.max(np.abs(track.alpha))),
        )
        param = self.param
        rivals = self.telling.rivals
        if param is not None:
            before = rivals[0].fit.params[param].se
            others = self._standard(self.limits.sample_rate_hz)
            usual = min((self.telling.errors(one)[param] for one in others), default=before)
            sharpened = (Sharpened(param, before, self.telling.errors(track)[param], usual),)
            return Experiment(rivals, self.limits, chosen, track, (), peak, sharpened)
        every = [self._told(one)[0] for one in self._standard(self._search_hz())]
        between = self.telling.between
        expected = tuple(
            Expected((i, j), between(told, i, j), max((between(one, i, j) for one in every), default=0.0))
            for i in range(len(rivals))
            for j in range(i + 1, len(rivals))
        )
        found = Experiment(rivals, self.limits, chosen, track, expected, peak)
        return found if found.separable else replace(found, change=self._change(pool, seed))

    def _told(self, track: MotionTrack) -> tuple[FloatArray, float]:
        """What a motion that is sampled as in the search tells at the full rate, and the least of it."""
        if self.param is not None:
            return np.zeros((1, 1)), -self.telling.errors(track)[self.param]
        told = self.telling.evidence(track) * self.limits.sample_rate_hz / self._search_hz()
        return told, self.telling.least(told)

    def _searched(self, search_s: float, seed: int) -> list[tuple[Piece, ...]]:
        """Return the best of the bank and of what is near its best, after so long."""
        rng = np.random.default_rng(seed)
        until = time.monotonic() + search_s
        scored: list[tuple[float, tuple[Piece, ...]]] = []
        for pieces in bank():
            if scored and time.monotonic() > until:
                break
            self._score(pieces, scored)
        while scored and time.monotonic() < until:
            scored.sort(key=lambda one: -one[0])
            del scored[_KEPT:]
            parent = scored[int(rng.integers(len(scored)))][1]
            self._score(changed(parent, rng, float(rng.choice((0.03, 0.1, 0.3)))), scored)
        scored.sort(key=lambda one: -one[0])
        return [pieces for _, pieces in scored[:3]]

    def _score(self, pieces: tuple[Piece, ...], scored: list[tuple[float, tuple[Piece, ...]]]) -> None:
        if (made := self._runnable(pieces, draws=False)) is not None:
            scored.append((self._told(made[1])[1], pieces))

    def _search_hz(self) -> float:
        rate = self.limits.sample_rate_hz
        return max(rate / _THINNED[self.telling.jointed], min(_SLOWEST_HZ, rate))

    def _runnable(self, pieces: tuple[Piece, ...], *, draws: bool) -> tuple[MotionPlan, MotionTrack] | None:
        """Return the motion of some pieces, eased until no rival asks for more torque than there is."""
        eased = 1.0
        rate = self.limits.sample_rate_hz if draws else self._search_hz()
        for _ in range(_EASINGS):
            made = plan(pieces, self.limits, eased)
            track = made.track(rate)
            if self.limits.hold(track) and self.telling.peak(track, draws=draws) <= self.limits.torque_Nm:
                return made, track
            eased *= _EASE
        return None

    def _standard(self, rate_hz: float) -> list[MotionTrack]:
        """Return the standard motions, each as large as the limits and the torque let it be."""
        tracks = []
        for name in STANDARD:
            sizes = (standard(name, self.limits, rate_hz, _EASE**times) for times in range(_EASINGS))
            fits = (one for one in sizes if self.telling.peak(one, draws=False) <= self.limits.torque_Nm)
            if (one := next(fits, None)) is not None:
                tracks.append(one)
        return tracks

    def _change(self, pool: list[tuple[Piece, ...]], seed: int) -> Change | None:
        """Return the smallest change of one limit with which the rivals are told apart."""
        for times in _FASTER:
            for name in ("duration_s", "omega_rad_s", "alpha_rad_s2", "torque_Nm", "theta"):
                wider = _widened(self.limits, name, times)
                other = replace(self, limits=wider)
                scored: list[tuple[float, tuple[Piece, ...]]] = []
                for pieces in (*pool, *other._searched(_CHANGE_S, seed)):
                    other._score(pieces, scored)
                d = max((score for score, _ in scored), default=0.0)
                if d >= TOLD:
                    shown = "theta_max_rad" if name == "theta" else name
                    return Change(shown, getattr(wider, shown), d)
        return None


def _percent(share: float) -> str:
    """Return a share for people."""
    return "< 0.01 %" if share < 1e-4 else f"{100.0 * share:.2g} %"


def _widened(limits: Limits, name: str, times: float) -> Limits:
    if name != "theta":
        return replace(limits, **{name: times * getattr(limits, name)})
    half = times * limits.half
    return replace(limits, theta_min_rad=limits.middle - half, theta_max_rad=limits.middle + half)
