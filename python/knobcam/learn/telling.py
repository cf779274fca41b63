"""How well a motion would tell rivals apart, before it is made: D of each of them beside each other.

D is what a refit of one rival, with what the data so far say of its parameters, would leave of the torque
that another predicts, in variances of the noise: r' (Sigma + J V J')^-1 r (Atkinson & Fedorov 1975;
Buzzi-Ferraris & Forzatti 1983), behind the measurement filter; of the motion that is chosen it is the refit
itself. The expected logarithm of the Bayes factor is D/2, and the choice is wrong with the probability
Phi(-sqrt(D)/2). Of a pair that captures leave tied D says how seldom it is with what they say already.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import cached_property
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import _core
from ..base.said import OfEffect, Said, joined
from ..capture.motions import MotionTrack
from ..errors import InputError
from ..fit.doubts import white_variance
from ..fit.price import charged, count
from ..fit.refit import cores
from ..fit.rule import RULE
from ..model import Model
from ..model.effects import effects as catalogue
from ..model.simulate import exact

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.arrays import FloatArray
    from ..capture.formats.units import Coordinate
    from ..fit import Fit

TOLD = 10.8
"""From this D on the choice is wrong in at most 5 of 100."""
ENOUGH = 4.0 * TOLD
"""More for a pair is no better while another one has less: what comes true may be half of it."""
_MARGIN = 1.05  # of a peak torque: what the parameters, drawn a few times, may not have shown
_DRAWS = 6
_BEYOND = 2.0  # standard deviations by which a draw may be worse than its covariance says
_NEARER = 8
_SURE = 3.0  # standard deviations of a speed from which on its sign is known
_LONG = 4096  # samples, of which no filter takes the ends for all
_MOSTLY = 0.75  # of a motion: where less would count, what the filter spreads does
_IMITATED = (
    0.1  # of the D the other way: what a model leaves that contains another but for what it has to learn
)
_MOST_LEAD = 5.8  # hardly less than what tells two apart: what captures leave tied a motion has to tell
_TIED = 2.0  # times what tells two apart: rivals that tied are fitted to their end, which moves the odds
_NORMAL = NormalDist()
_EDGE = 0.1  # of the rate: the edge of the torque's filter where the captures have none


@dataclass(frozen=True, eq=False)
class Rival:
    """A set of effects beyond the base model, and the fit of the model with it."""

    effects: tuple[str, ...]
    fit: Fit

    @property
    def name(self) -> Said:
        """Return it for people."""
        return joined(" + ", map(OfEffect, self.effects)) or Said("the base model alone")


def apart(rivals: Sequence[Rival]) -> tuple[Said, ...]:
    """Return names of rivals by what they do not all have, where each has something of that."""
    all_have = set(rivals[0].effects).intersection(*(one.effects for one in rivals))
    own = [[effect for effect in one.effects if effect not in all_have] for one in rivals]
    if not all_have or not all(own):
        return tuple(one.name for one in rivals)
    return tuple(joined(" + ", map(OfEffect, effects)) for effects in own)


class Told(NamedTuple):
    """What a motion tells of rivals.

    `d` has D of the torque of a row's model beside a column's; `dearer` says of each how much more its
    parameters cost once the motion determines them, in variances of the noise.
    """

    d: FloatArray
    dearer: FloatArray


@dataclass(frozen=True, eq=False)
class Telling:
    """Rivals with what their captures say of them; asks what a motion would say."""

    rivals: tuple[Rival, ...]
    seed: int = 0

    @property
    def coordinate(self) -> Coordinate:
        """Rotary or linear, as all of them are."""
        return self.rivals[0].fit.model.coordinate

    @cached_property
    def white(self) -> float:
        """Variance of white noise of the raw torque, (N m)^2, as the best of the rivals leaves it."""
        best = min((rival.fit for rival in self.rivals), key=lambda fit: fit.rmse)
        return white_variance(best, best.noise_floor if best.noise_floor > 0.0 else best.rmse)

    @cached_property
    def edge_hz(self) -> float | None:
        """Edge of the filter of the torque, Hz, as the captures have it."""
        return self.rivals[0].fit.prepared[0].core.edge_hz

    @cached_property
    def omega_sd(self) -> float:
        """How well the captures know the speed, rad/s; 0 where they do not say."""
        known = [one.sd("omega") for one in self.rivals[0].fit.prepared]
        return max((float(np.median(one)) for one in known if one is not None), default=0.0)

    @cached_property
    def mechanics(self) -> tuple[tuple[Model, ...], ...]:
        """Of each rival the models that the data allow, without what only the sensor does."""
        return tuple(
            tuple(Model(model.core.only(_of_the_knob(model))) for model in models) for models in self.drawn
        )

    @cached_property
    def drawn(self) -> tuple[tuple[Model, ...], ...]:
        """Of each rival its model as fitted, and some that the data allow."""
        rng = np.random.default_rng(self.seed)
        return tuple(
            (Model(rival.fit.core.model), *(self._allowed(rival.fit, rng) for _ in range(_DRAWS)))
            for rival in self.rivals
        )

    def _allowed(self, fit: Fit, rng: np.random.Generator) -> Model:
        """Return a model drawn by the covariance, and drawn nearer until the captures themselves allow it.

        What is hardly determined has an error that is no ellipse: far along it the captures say no.
        """
        normals = rng.standard_normal(len(fit.core.free))
        count = len(normals)
        most = float(np.sum(normals**2)) + _BEYOND * math.sqrt(2.0 * count)
        here = self._squares(fit, Model(fit.core.model))
        for _ in range(_NEARER):
            model = Model(fit.core.drawn(normals.tolist()))
            if (self._squares(fit, model) - here) / self.white <= most:
                return model
            normals = 0.5 * normals
        return Model(fit.core.model)

    def _squares(self, fit: Fit, model: Model) -> float:
        """Return the sum of squares that a model leaves of the captures, (N m)^2."""
        left = 0.0
        for one in fit.prepared:
            rest = (one.tau - model.core.torque(one.core))[one.used]
            left += float(np.sum(rest**2))
        return left

    @cached_property
    def reach_s(self) -> float:
        """How far to either side of a direction that is not sure samples of a capture do not count."""
        rate = self.rivals[0].fit.prepared[0].core.rate_hz
        t = np.arange(_LONG) / rate
        omega = np.where(t == t[_LONG // 2], 0.0, 1.0)
        still = exact(self.coordinate, MotionTrack(t, t, omega, np.zeros(_LONG)), self._filter(rate))
        return 0.5 * (_LONG - 1 - still.used) / rate

    def _filter(self, rate_hz: float) -> dict[str, float]:
        return {"torque_edge_hz": min(self.edge_hz or _EDGE * rate_hz, 0.45 * rate_hz)}

    def signals(
        self, track: MotionTrack, torque: FloatArray | None = None, *, every: bool = False
    ) -> _core.Signals:
        """Return the signals of a motion that is known exactly, with this torque (or none) behind the filter.

        Where the sensors would not know which way it goes, nothing counts, nor what that reaches through the
        filter, as in a capture, unless `every` sample does. Raises InputError for a motion of which too
        little is left.
        """
        known = np.abs(track.omega) > _SURE * self.omega_sd
        if not (every or known.all()):
            reach = round(self.reach_s * track.rate_hz)
            sure = np.convolve(~known, np.ones(2 * reach + 1), "same") < 0.5
            known = sure if np.mean(sure) >= _MOSTLY else known
        return exact(self.coordinate, track, self._filter(track.rate_hz), torque, known | every)

    def peak(self, track: MotionTrack, *, draws: bool) -> float:
        """Return the largest torque that any rival asks for, N m, with a margin for what is not known.

        Without end where one cannot be followed: no number says what it asks for.
        """
        still = self.signals(track, every=True)
        most = 0.0
        for models in self.mechanics:
            for model in models if draws else models[:1]:
                asked = float(np.max(np.abs(model.core.torque(still, filtered=False))))
                most = max(most, asked) if math.isfinite(asked) else math.inf
        return _MARGIN * most

    def lost(self, track: MotionTrack) -> str:
        """Return which rival cannot be weighed on a motion that sensors tell of, and why; or nothing."""
        try:
            made = self.signals(track)
        except InputError:
            return ""
        for one in self.rivals:
            try:
                one.fit.core.expected(made, self.white)
            except InputError as error:
                return f"{one.name}: {error}"
        return ""

    def evidence(self, track: MotionTrack, rate_hz: float | None = None) -> Told:
        """Return D of a row's model beside a column's, and how much dearer each becomes.

        At another rate than the track's each of its samples counts as so many. Both as fitted: a model that
        is drawn beside a rival that is not differs from it by what the same data say of both, and D would
        count that.
        """
        still = self.signals(track)
        n = len(self.rivals)
        told, dearer = np.zeros((n, n)), np.zeros(n)
        white = self._white(track, rate_hz)
        counted = still.used * (rate_hz or track.rate_hz) / track.rate_hz
        for truth in range(n):
            torque = self.rivals[truth].fit.core.model.torque(still, filtered=False)
            made = self.signals(track, torque)
            for other in (one for one in range(n) if one != truth):
                told[truth, other], errors = self.rivals[other].fit.core.expected(made, white)
                dearer[other] = self._dearer(self.rivals[other], errors, counted)
        return Told(told, dearer)

    def refitted(self, track: MotionTrack, over: Callable[..., bool] = lambda more: False) -> Told:
        """Return what a motion tells where each rival is refitted to it and to the captures together.

        What gives way far from where it was fitted leaves less than the straight line from there says: a
        joint that becomes stiff, a law of friction that becomes another. A pair that does not get its turn
        before the time is `over`, or that is not told anyhow, has what the line says. Those that are told
        least go first, as they decide; none begins that takes as long as the longest before and has not that
        long.
        """
        told = self.evidence(track)
        still = self.signals(track)
        longest = 0.0
        pairs = sorted(zip(*np.nonzero(told.d >= TOLD), strict=True), key=lambda pair: float(told.d[pair]))
        for truth, other in pairs:
            begun = time.monotonic()
            if over(longest):
                break
            torque = self.rivals[truth].fit.core.model.torque(still, filtered=False)
            told.d[truth, other] = self._left_by(self.rivals[other].fit, self.signals(track, torque))
            longest = max(longest, time.monotonic() - begun)
        return told

    def _left_by(self, fit: Fit, made: _core.Signals) -> float:
        """Return how much more a refit to captures and a motion leaves than of the captures, by the noise.

        As `fit` does it: over a longer way detents need another period than one that is refined is led to.
        """
        both = _core.fit([*cores(fit), made], fit.core.model, False)
        before = sum(one.core.used for one in fit.prepared)
        more = both.rmse**2 * (before + made.used) - fit.core.rmse**2 * before
        return max(more / self.white, 0.0)

    def _dearer(self, rival: Rival, errors: FloatArray, counted: float) -> float:
        """Return how much more a rival's parameters cost with these errors and so many samples more.

        As `learn` charges them: what a motion determines is a choice that it was not before.
        """
        fit = rival.fit
        after = dict(zip(fit.core.free, errors.tolist(), strict=True))
        longer = 1.0 + counted / sum(one.core.used for one in fit.prepared)
        return self._price(longer) * charged(fit, rival.effects, after) - self._price() * charged(
            fit, rival.effects
        )

    def _price(self, longer: float = 1.0) -> float:
        """Return what a parameter costs where captures are so many times as long."""
        best = min((rival.fit for rival in self.rivals), key=lambda fit: fit.rmse)
        return math.log(max(longer * best.white_squares, math.e))

    def _white(self, track: MotionTrack, rate_hz: float | None) -> float:
        """Return the variance of noise with which the samples of a track tell as many of another rate would.

        What they tell is weighed against what the captures so far do: it is no use to count D some times.
        """
        return self.white * track.rate_hz / (rate_hz or track.rate_hz)

    @cached_property
    def leads(self) -> FloatArray:
        """What captures say already of a row's rival beside a column's: twice the logarithm of the odds.

        As `learn` weighs them, by what each leaves and the price of its parameters, to nearly what counts as
        told; not a number where captures tell them far beyond that, by that price and by the one that effects
        come in for.
        """
        if not self.white > 0.0:
            return np.full((len(self.rivals), len(self.rivals)), np.nan)
        best = min((rival.fit for rival in self.rivals), key=lambda fit: fit.rmse)
        noise = min(1.0, (best.noise_floor / best.rmse) ** 2) if best.noise_floor > 0.0 else 1.0
        left = np.array([noise * _left(one.fit) / self.white for one in self.rivals])
        plain = left + self._price() * np.array([charged(one.fit, one.effects) for one in self.rivals])
        full = left + RULE.price * np.array([count(one.fit, one.effects) for one in self.rivals])
        odds, near = (cost[None, :] - cost[:, None] for cost in (plain, full))
        tied = np.minimum(np.abs(odds), np.abs(near)) <= _TIED * RULE.alike
        return np.where(tied, np.clip(odds, -_MOST_LEAD, _MOST_LEAD), np.nan)

    def between(self, told: Told, one: int, other: int) -> float:
        """Return D of a pair of rivals: what makes the wrong choice as rare as a motion and captures do.

        What they say already counts, and so do prices after the motion: a model that imitates the plainer one
        that is right leaves as little as that does on any motion, but no more has its parameters' worth. Each
        of both is right as often as captures say. Where they tell them already it is D of the motion alone.
        """
        lead = float(self.leads[one, other])
        if math.isnan(lead):
            return self._alone(told.d, one, other)
        gains = float(told.dearer[other] - told.dearer[one])
        sides = (lead, gains, float(told.d[one, other])), (-lead, -gains, float(told.d[other, one]))
        wrong = sum(_chosen_wrongly(now + more, d) / (1.0 + math.exp(-0.5 * now)) for now, more, d in sides)
        if wrong > 0.0:
            return (2.0 * _NORMAL.inv_cdf(min(wrong, 0.5))) ** 2
        # Too seldom for a number: the worse of both, of which what leads may tell one on any motion.
        return min((now + more + d) ** 2 / d for now, more, d in sides if d > 0.0)

    def _alone(self, told: FloatArray, one: int, other: int) -> float:
        """Return D of a pair on the motion alone, whichever of them is right.

        But of a model that another one contains, or can imitate with more parameters, only where that other
        one is right: where itself is, both explain the torque on any motion, and the plainer is chosen.
        """
        for plain, rich in ((one, other), (other, one)):
            within = set(self.rivals[plain].effects) < set(self.rivals[rich].effects)
            fewer = len(self.rivals[plain].fit.core.free) < len(self.rivals[rich].fit.core.free)
            if within or (fewer and told[plain, rich] < _IMITATED * told[rich, plain]):
                return float(told[rich, plain])
        return float(min(told[one, other], told[other, one]))

    def pairs(self, told: Told) -> list[float]:
        """Return D of each pair, in no order; none of a single rival."""
        n = len(told.d)
        return [self.between(told, i, j) for i in range(n) for j in range(i)]

    def least(self, told: Told) -> float:
        """Return the least D of all pairs; 0 of a single rival."""
        return min(self.pairs(told), default=0.0)

    def errors(self, track: MotionTrack, rate_hz: float | None = None) -> dict[str, float]:
        """Return the standard errors of the first rival's parameters after a motion; the rate as above."""
        core = self.rivals[0].fit.core
        _, errors = core.expected(self.signals(track), self._white(track, rate_hz))
        return dict(zip(core.free, errors.tolist(), strict=True))


def good(pairs: Sequence[float]) -> float:
    """Return how good a motion is that tells so much of each pair.

    As good as the least of them, but of two motions rather the one that tells more pairs enough: some that no
    motion tells apart shall not hide the others.
    """
    return sum(min(d, ENOUGH) for d in pairs) + math.log1p(min(pairs))


def wrong_choice(d: float) -> float:
    """Return how often the wrong one of two rivals would be chosen."""
    return _chosen_wrongly(0.0, max(d, 0.0))


def _chosen_wrongly(ahead: float, d: float) -> float:
    """Return how often a motion of this D turns what spoke for the right one so far to the wrong one."""
    if d > 0.0:
        return 0.5 * math.erfc((ahead + d) / (2.0 * math.sqrt(2.0 * d)))
    return float(ahead < 0.0) if ahead else 0.5


def _left(fit: Fit) -> float:
    """Return the sum of squares that a fit leaves, (N m)^2."""
    return fit.rmse**2 * sum(one.core.used for one in fit.prepared)


def _of_the_knob(model: Model) -> list[str]:
    rows = catalogue(model.coordinate)
    return [one for one in model.effects if one not in rows or rows[one].place != "sensor"]
