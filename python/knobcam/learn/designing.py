"""The search for the motion that tells rivals apart, or makes a parameter known best, within limits."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ..base.door import checked
from ..capture.by_hand import by_hand as steps_by_hand
from ..capture.by_hand import hand_can, on_beats
from ..errors import InputError
from .contenders import contenders
from .cut import after
from .experiment import Change, Expected, Experiment, NoMotion, Sharpened
from .limits import Limits
from .motion_space import Piece, bank, changed, plan, standard
from .ranked import Rated, Scored, best_of
from .sharpening import to_sharpen
from .showing_more import along, longest_s, show_more
from .telling import ENOUGH, TOLD, Rival, Telling, Told, good

if TYPE_CHECKING:
    from ..capture.motion_plan import MotionPlan
    from ..capture.motions import MotionTrack
    from .learning import LearningResult

STANDARD = ("sweep", "multisine", "turns", "hand")
"""The motions that a designed one is held against."""
SEARCH = "looking for the motion"
"""What is said of the search, which is by far the longest."""
_SEARCH_S = 3.0  # at most: where motions take long to weigh, or the machine is slow
_TRIES = 500
"""Motions weighed beyond those that a search begins with, the same ones however quick the machine."""
_CHANGE_S = 3.0  # for all limits that might be wider, together
_CHANGE_TRIES = 30
_KEPT = 5
_SHORTEST = 64  # samples, fewer than which no filter takes
_NOTHING = 1.0  # variance of the noise: what tells no more of any pair tells nothing
_EASE, _EASINGS = 0.75, 12
_FASTER = 2.0, 5.0
_MORE, _PLENTY = 1.2, 2.0 * ENOUGH
"""A search goes on from enough to so much more than the best standard motion tells, but not beyond this."""
_REFITS_S = 2.0  # for refits to the last motions and the captures together
_THINNED = 4  # samples of the search; what is said of the motion that is chosen has all of them
_SLOWEST_HZ = 500.0


@checked
def next_experiment(
    story: LearningResult,
    *,
    rivals: Sequence[str] = (),
    sharpen: str | None = None,
    limits: Limits | str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    by_hand: bool = False,
    search_s: float = _SEARCH_S,
    seed: int = 0,
    between: Callable[[], None] | None = None,
) -> Experiment:
    """Return the motion that would tell apart what was learned and what else it could be.

    `rivals` are sets of effects beyond the base model, each as names with `+` between (`base` for none); by
    default those that the captures could not tell. Without any, where something is left that no effect
    explains, the motion shows more of that; elsewhere, or with `sharpen`, it is the one that makes a
    parameter known best, by default the widest. `limits` are by default what the captures reached, 10 s
    long (120 s to show more); the motion exceeds none of them for any rival. With `by_hand` it is one that a
    hand can make, without a motor. The search ends when all rivals are told apart with a margin, after 500
    motions, or, on a slow machine, after `search_s` seconds; unless that cut it short, the same `seed` gives
    the same motion.
    `between` is called before each motion that is weighed; what it raises ends the search.

    Raises InputError for rivals that cannot be fitted and limits within which no motion is.
    """
    begun = time.monotonic()
    tell = progress or (lambda _: None)
    axis = None if rivals or sharpen is not None else along(story)
    within = Limits.within(limits, story.fit.prepared, longest_s(axis))
    if axis is not None:
        tell(SEARCH)
        return show_more(story, axis, within, by_hand=by_hand)
    tell("fitting the rivals")
    found = contenders(story, rivals) if sharpen is None else ()
    tell(SEARCH)
    alone = (Rival(story.found, story.fit),)
    designed = design(found or alone, within, sharpen, search_s, seed, by_hand=by_hand, between=between)
    return replace(designed, untied=sharpen is None and not found, took_s=time.monotonic() - begun)


def design(
    rivals: tuple[Rival, ...],
    limits: Limits,
    sharpen: str | None = None,
    search_s: float = _SEARCH_S,
    seed: int = 0,
    *,
    by_hand: bool = False,
    between: Callable[[], None] | None = None,
) -> Experiment:
    """Return the motion that parts rivals, or of a single one makes a parameter known best; see above.

    A rival that asks for more torque than there is on any motion is left out where two others remain.
    """
    begun = time.monotonic()
    search = _Design(Telling(rivals, seed), limits, sharpen, by_hand, between)
    stuck = () if search.moves() else tuple(one for one in rivals if not search.of(one).moves())
    rest = tuple(one for one in rivals if one not in stuck)
    if stuck and len(rest) < 2:
        raise search.none()
    search = replace(search, telling=Telling(rest, seed)) if stuck else search
    return replace(search.best(search_s, seed), left_out=stuck, took_s=time.monotonic() - begun)


@dataclass(frozen=True, eq=False)
class _Design:
    """A search for a motion."""

    telling: Telling
    limits: Limits
    sharpen: str | None
    by_hand: bool = False
    between: Callable[[], None] | None = None

    @cached_property
    def param(self) -> str | None:
        """The parameter to be sharpened, None where rivals are to be told apart."""
        if len(self.telling.rivals) > 1:
            return None
        return to_sharpen(self.telling.rivals[0].fit, self.sharpen)

    def of(self, rival: Rival) -> _Design:
        """Return the search for one of the rivals alone."""
        return replace(self, telling=Telling((rival,), self.telling.seed))

    def moves(self) -> bool:
        """Whether any motion that a search begins with keeps to the limits."""
        return any(self._runnable(pieces, draws=False) is not None for pieces in bank())

    def best(self, search_s: float, seed: int) -> Experiment:
        """Return the best motion that is found in so long, and what it tells."""
        param = self.param
        until = time.monotonic() + search_s
        first = self._banked(until)
        if not first:
            raise self.none()
        twins = param is None and self._twins(first)
        over = after(search_s + _REFITS_S)
        pool = best_of(first)
        known = self._rated(pool, over) if twins else self._found(first, until, seed, over)
        if not known:
            few = "limits, torque_Nm: too little for what the rivals may ask for; give more"
            raise NoMotion(few, self._enough("torque_Nm"))
        _, _, chosen, track, told = max(known, key=lambda one: one.worth)
        omega, alpha = (float(np.max(np.abs(column))) for column in (track.omega, track.alpha))
        peak = (self.telling.peak(track, draws=True), omega, alpha)
        rivals = self.telling.rivals
        if param is not None:
            before = rivals[0].fit.params[param].se
            others = self._standard(self.limits.sample_rate_hz)
            usual = min([before, *(-self._told(one)[1] for one in others)])
            sharpened = (Sharpened(param, before, self.telling.errors(track)[param], usual),)
            return Experiment(rivals, self.limits, chosen, track, (), peak, sharpened)
        between, standard = self.telling.between, self._best_usual(over)
        expected = tuple(
            Expected((i, j), between(told, i, j), between(standard, i, j) if standard else 0.0)
            for i in range(len(rivals))
            for j in range(i + 1, len(rivals))
        )
        found = Experiment(rivals, self.limits, chosen, track, expected, peak)
        if found.separable or twins:
            return found
        return replace(found, change=self._change(pool, seed))

    def _found(
        self, first: Sequence[Scored], until: float, seed: int, over: Callable[[], bool]
    ) -> list[Rated]:
        """Return the last motions of a search, and of one that goes on where refits leave too little of D."""
        known = self._rated(self._searched(first, until, seed, _TRIES, self._plenty), over)
        if self.param is not None or not known or max(one.least for one in known) >= TOLD:
            return known
        return known + self._rated(self._searched(first, until, seed, _TRIES, math.inf), over)

    def _rated(self, pool: Sequence[tuple[Piece, ...]], over: Callable[[], bool]) -> list[Rated]:
        """Return some motions by refits, no more than the first if that tells enough."""
        known: list[Rated] = []
        for pieces in pool:
            if self.param is None and known and (over() or known[-1].least >= ENOUGH):
                break
            if (made := self._runnable(pieces, draws=True)) is None:
                continue
            if self.param is not None:
                told, worth = self._told(made[0].track(self._search_hz()))
            else:
                told = self.telling.refitted(made[1], over)
                worth = good(self.telling.pairs(told))
            known.append(Rated(worth, self.telling.least(told), *made, told))
        return known

    def _told(self, track: MotionTrack) -> tuple[Told, float]:
        """What a motion that is sampled as in the search tells at the full rate, and how good that is.

        Of a motion that is too slow for the sensors to know its direction it is minus infinity.
        """
        n = len(self.telling.rivals)
        nothing = Told(np.zeros((n, n)), np.zeros(n))
        try:
            if self.param is not None:
                return nothing, -self.telling.errors(track, self.limits.sample_rate_hz)[self.param]
            told = self.telling.evidence(track, self.limits.sample_rate_hz)
        except InputError:
            return nothing, -math.inf
        return told, good(self.telling.pairs(told))

    def _banked(self, until: float) -> list[Scored]:
        """Return the motions that a search begins with; some of them, where the time is over before."""
        scored: list[Scored] = []
        for pieces in bank():
            if scored and time.monotonic() > until:
                break
            self._score(pieces, scored)
        return scored

    def _twins(self, first: Sequence[Scored]) -> bool:
        """Whether rivals are the same on any motion: none of the first tells of a pair what noise would not.

        Nor do these in limits that are all far wider: a search would only find the largest of nothing.
        """
        if not first or max(one.most for one in first) >= _NOTHING:
            return False
        limits = self.limits
        for name in ("omega_rad_s", "alpha_rad_s2", "torque_Nm", "theta"):
            limits = limits.widened(name, max(_FASTER))
        wider = replace(self, limits=limits)
        for pieces in bank():
            scored: list[Scored] = []
            wider._score(pieces, scored)
            if any(one.most >= _NOTHING for one in scored):
                return False
        return True

    @cached_property
    def _usual(self) -> list[tuple[Told, float]]:
        """What each of the standard motions tells, and how good that is."""
        return [self._told(one) for one in self._standard(self._search_hz())]

    def _best_usual(self, over: Callable[[], bool]) -> Told | None:
        """What the best of the standard motions tells, refitted as to the one chosen if there is time."""
        rated = self._usual
        at = max(range(len(rated)), key=lambda at: rated[at][1], default=-1)
        if at < 0 or rated[at][1] == -math.inf:
            return None
        whole = [] if over() else self._standard(self.limits.sample_rate_hz)
        return self.telling.refitted(whole[at], over) if len(whole) == len(rated) else rated[at][0]

    @property
    def _plenty(self) -> float:
        """The least D with which a search ends."""
        if self.param is not None:
            return math.inf
        usual = max((self.telling.least(told) for told, _ in self._usual), default=0.0)
        return min(max(_MORE * usual, ENOUGH), _PLENTY)

    def _searched(
        self, first: Sequence[Scored], until: float, seed: int, tries: int, plenty: float
    ) -> list[tuple[Piece, ...]]:
        """Return the best of some motions and of what is near the best, weighed until one tells plenty."""
        rng = np.random.default_rng(seed)
        scored = list(first)
        for _ in range(tries):
            scored.sort(key=lambda one: -one.score)
            if not scored or scored[0].least >= plenty or time.monotonic() >= until:
                break
            del scored[_KEPT:]
            parent = scored[int(rng.integers(len(scored)))].pieces
            self._score(changed(parent, rng, float(rng.choice((0.03, 0.1, 0.3)))), scored)
        return best_of([*scored, *first])

    def _score(self, pieces: tuple[Piece, ...], scored: list[Scored]) -> None:
        if self.between is not None:
            self.between()
        if (made := self._runnable(pieces, draws=False)) is not None:
            told, score = self._told(made[1])
            if score > -math.inf:
                scored.append(Scored(score, self.telling.least(told), float(told.d.max()), pieces))

    def _search_hz(self) -> float:
        rate = self.limits.sample_rate_hz
        return max(rate / _THINNED, min(_SLOWEST_HZ, rate))

    def _runnable(self, pieces: tuple[Piece, ...], *, draws: bool) -> tuple[MotionPlan, MotionTrack] | None:
        """Return the motion of some pieces, eased until no rival asks for more torque than there is."""
        eased = 1.0
        rate = self.limits.sample_rate_hz if draws else self._search_hz()
        for _ in range(_EASINGS):
            made = plan(pieces, self.limits, eased)
            if self.by_hand:
                # The last sample is at rest.
                made = on_beats(made, self.limits.duration_s - 2.0 / self.limits.sample_rate_hz)
                if not hand_can(steps_by_hand(made, self.telling.coordinate)):
                    return None
            track = made.track(rate)
            if len(track.theta) < _SHORTEST or not track.omega.any():
                return None
            asked = self.telling.peak(track, draws=draws) * (1.0 if draws else self._doubt)
            if self.limits.hold(track) and asked <= self.limits.torque_Nm:
                return made, track
            eased *= _EASE
        return None

    @cached_property
    def _doubt(self) -> float:
        """How much more torque rivals may ask for than as fitted: what is found is made smaller by it."""
        track = plan(bank()[0], self.limits, 1.0).track(self._search_hz())
        fitted, drawn = (self.telling.peak(track, draws=draws) for draws in (False, True))
        return drawn / fitted if fitted > 0.0 else 1.0

    def _standard(self, rate_hz: float) -> list[MotionTrack]:
        """Return the standard motions, each as large as the limits and the torque let it be."""
        tracks = []
        for name in STANDARD:
            sizes = (standard(name, self.limits, rate_hz, _EASE**times) for times in range(_EASINGS))
            fits = (one for one in sizes if self.telling.peak(one, draws=False) <= self.limits.torque_Nm)
            if (one := next(fits, None)) is not None:
                tracks.append(one)
        return tracks

    def none(self) -> NoMotion:
        """Return what is said where no motion is within the limits: which of them is at fault."""
        limits, limit, least = self.limits, "duration_s", 0.0
        gentle, whole = (
            [plan(one, limits, eased).track(self._search_hz()) for one in bank()]
            for eased in (_EASE ** (_EASINGS - 1), 1.0)
        )
        moving = [one for one in gentle if one.omega.any() and limits.hold(one)]
        able = [one for one in moving if len(one.theta) >= _SHORTEST]
        if self.by_hand and replace(self, by_hand=False).moves():
            fault = f"{limits.duration_s:.4g} is too short, or the angles too near, for a hand"
        elif not able:
            speed = f"{limits.omega_rad_s:.4g} {limits.unit}/s"
            fault = f"{limits.duration_s:.4g} is too short for any motion at {speed}"
        elif lost := self.telling.lost(max(whole, key=lambda one: float(np.max(np.abs(one.omega))))):
            return NoMotion(f"rivals: {lost}; name others", None)
        elif (least := min(self.telling.peak(one, draws=True) for one in able)) > limits.torque_Nm:
            fault = f"{limits.torque_Nm:.4g} moves no rival, the gentlest motion takes {least:.3g}"
            limit = "torque_Nm"
        else:
            fault = f"{limits.omega_rad_s:.4g} is too slow for the sensors to know the direction"
            limit = "omega_rad_s"
        return NoMotion(f"limits, {limit}: {fault}; give more", self._enough(limit, least))

    def _enough(self, limit: str, least: float = 0.0) -> tuple[str, float] | None:
        """Return the smallest change of a limit with which there is a motion: which limit, and to what.

        It is more than `least` of it. None where none was found in the time that there is for it.
        """
        until = time.monotonic() + _CHANGE_S
        for times in _FASTER:
            more = times * max(1.0, least / self.limits.numbers[limit])
            wider = replace(self, limits=self.limits.widened(limit, more))
            for pieces in bank():
                if time.monotonic() > until:
                    return None
                if self.between is not None:
                    self.between()
                made = wider._runnable(pieces, draws=True)
                if made and wider._told(made[0].track(wider._search_hz()))[1] > -math.inf:
                    return limit, wider.limits.numbers[limit]
        return None

    def _change(self, pool: list[tuple[Piece, ...]], seed: int) -> Change | None:
        """Return the smallest change of one limit with which all rivals are told apart, by refits too."""
        limits = "duration_s", "omega_rad_s", "alpha_rad_s2", "torque_Nm", "theta"
        each_s, over = _CHANGE_S / (len(_FASTER) * len(limits)), after(_CHANGE_S + _REFITS_S)
        for times, name in product(_FASTER, limits):
            wider = self.limits.widened(name, times)
            other = replace(self, limits=wider)
            scored: list[Scored] = []
            until = time.monotonic() + each_s
            wide = other._searched(other._banked(until), until, seed, _CHANGE_TRIES, TOLD)
            for pieces in (*pool, *wide):
                other._score(pieces, scored)
            scored.sort(key=lambda one: -one.least)
            tells = [one.pieces for one in scored[:1] if one.least >= TOLD]
            if over() or not any(one.least >= TOLD for one in other._rated(tells, over)):
                continue
            # As who takes it at its word will look.
            until = time.monotonic() + _SEARCH_S
            d = max((one.least for one in other._found(other._banked(until), until, seed, over)), default=0.0)
            if d >= TOLD and not over():  # a refit that got no turn has what the line says
                shown = "theta_max_rad" if name == "theta" else name
                return Change(shown, getattr(wider, shown), d)
        return None
