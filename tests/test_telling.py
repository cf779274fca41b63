"""D of a pair: how seldom the wrong one is chosen after a motion, with what captures say already."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import knobcam as kc
from knobcam.fit.price import charged
from knobcam.fit.rule import RULE
from knobcam.learn import contenders as contenders_module
from knobcam.learn import telling
from knobcam.learn.contenders import contenders
from knobcam.learn.motion_space import Piece, plan
from knobcam.learn.telling import TOLD, Rival, Telling, Told, wrong_choice

RIVALS = tuple(
    Rival((one,), cast("Any", SimpleNamespace(core=SimpleNamespace(free=range(count)))))
    for one, count in (("return_spring", 9), ("position_polynomial", 11))
)


def d_of(lead: float, spring_right: float, polynomial_right: float, dearer: float = 0.0) -> float:
    """D of a spring and a polynomial, where so much speaks for the spring already.

    `dearer` is what the polynomial's parameters cost more after the motion.
    """
    asks = Telling(RIVALS)
    asks.__dict__["leads"] = np.array([[0.0, lead], [-lead, 0.0]])
    told = Told(np.array([[0.0, spring_right], [polynomial_right, 0.0]]), np.array([0.0, dearer]))
    assert asks.between(told, 1, 0) == asks.between(told, 0, 1), "which of both is named first is no matter"
    return asks.between(told, 0, 1)


@pytest.mark.parametrize("d", [0.0, 0.3, TOLD, 100.0, 4000.0, 1e6])
def test_of_two_that_captures_say_nothing_of_d_is_that_of_the_motion(d: float) -> None:
    assert d_of(0.0, d, d) == pytest.approx(d, abs=1e-12)


def test_where_the_plainer_one_leads_its_price_tells_it_though_the_other_leaves_nothing_of_it() -> None:
    assert d_of(5.5, 1.8, 11.0) > TOLD
    assert d_of(0.0, 1.8, 11.0) < TOLD
    assert d_of(5.5, 0.0, 1e6) == pytest.approx(1e6, rel=0.01), "too seldom wrong for a number"


def test_what_leads_is_no_better_told_by_a_motion_on_which_both_are_the_same() -> None:
    for lead in (0.0, 2.0, RULE.alike):
        assert wrong_choice(d_of(lead, 0.0, 0.0)) == pytest.approx(1.0 / (1.0 + math.exp(0.5 * lead)))


def test_the_more_a_motion_leaves_of_both_the_seldomer_the_wrong_one_is_chosen() -> None:
    for lead in (-4.0, 0.0, 4.0):
        every = [d_of(lead, d, d) for d in np.geomspace(0.1, 1e5, 40)]
        assert (np.diff(every) > 0.0).all()


def test_what_a_motion_makes_dearer_is_told_where_it_is_wrong_and_hardly_where_it_is_right() -> None:
    # Where the polynomial is right it has to tell by so much more.
    assert d_of(1.0, 2.0, 60.0, dearer=5.0) > TOLD > d_of(1.0, 2.0, 60.0)
    assert d_of(0.0, 30.0, 12.0, dearer=8.0) < TOLD < d_of(0.0, 30.0, 12.0)
    assert d_of(0.0, 30.0, 12.0, dearer=-8.0) > TOLD


def test_where_captures_tell_them_already_it_is_that_of_the_motion_alone() -> None:
    # The polynomial imitates the spring: they are told apart where it is right itself.
    assert d_of(math.nan, 1.0, 20.0) == 20.0
    assert d_of(math.nan, 8.0, 20.0) == 8.0


def test_what_captures_say_of_a_tie_is_the_odds_that_learn_has(alike: kc.LearningResult) -> None:
    rivals = contenders(alike, ())
    leads = Telling(rivals).leads
    assert (leads == -leads.T).all()
    (step,) = (one for one in alike.ladder if one.added)
    weight = [step.weights[rival.effects[0]] for rival in rivals]
    for at, other in zip(*np.triu_indices(len(rivals), 1), strict=True):
        odds = 2.0 * math.log(weight[at] / weight[other])
        assert leads[at, other] == pytest.approx(odds, abs=0.3)


def test_a_knob_that_stands_still_tells_nothing_apart_however_much_captures_say(
    alike: kc.LearningResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    asks = Telling(contenders(alike, ()))
    nothing = Told(np.zeros((len(asks.rivals),) * 2), np.zeros(len(asks.rivals)))
    assert asks.least(nothing) < TOLD
    monkeypatch.setattr(telling, "_left", lambda fit: 10.5 * asks.white * (fit is not asks.rivals[0].fit))
    beyond = Telling(asks.rivals)
    assert 5.0 < beyond.leads[0, 1] < RULE.alike
    assert beyond.between(nothing, 0, 1) < TOLD


def test_what_captures_tell_already_has_no_odds(alike: kc.LearningResult) -> None:
    both = contenders(alike, ("base", "return_spring"))
    assert math.isnan(Telling(both).leads[0, 1])


def test_the_price_after_a_motion_is_the_one_that_a_fit_with_it_is_charged(alike: kc.LearningResult) -> None:
    rivals = contenders(alike, ())
    asks = Telling(rivals)
    track = kc.motion("sweep", 8.0)
    again = kc.simulate(rivals[0].fit.model, track, noise=kc.SensorNoise(tau_sd=6e-3), seed=9)
    dearer = asks.evidence(track).dearer
    assert (dearer > 1.0).all(), "a motion that is longer and wider makes any choice a better one"
    for rival, more in zip(rivals, dearer, strict=True):
        both = kc.fit([*alike.captures, again], rival.fit.model)
        price = [math.log(fit.white_squares) * charged(fit, rival.effects) for fit in (both, rival.fit)]
        assert more == pytest.approx(price[0] - price[1], abs=0.5), rival.effects


def test_a_rival_that_gives_way_far_from_where_it_was_leaves_what_a_refit_leaves_and_no_line_says() -> None:
    knob = kc.Model.load("knob4").with_effect("quadratic_drag").with_value("quadratic_drag.d", 3e-5)
    first = kc.simulate(knob, "sweep", duration_s=2.0, seed=3)
    base = kc.fit(first)
    rivals = tuple(Rival((effect,), base.add(effect)) for effect in ("stribeck", "quadratic_drag"))
    asks = Telling(rivals)
    slow = kc.motion("sweep", 6.0)
    track = slow._replace(theta=3.0 * slow.theta, omega=3.0 * slow.omega, alpha=3.0 * slow.alpha)
    line, told = asks.evidence(track).d, asks.refitted(track).d
    for right, wrong in ((0, 1), (1, 0)):
        second = kc.simulate(rivals[right].fit.model, track, noise="none")
        before = rivals[wrong].fit
        both = kc.fit([first, second], before.model)
        squares = [fit.rmse**2 * sum(one.core.used for one in fit.prepared) for fit in (both, before)]
        came = (squares[0] - squares[1]) / asks.white
        assert came > TOLD and told[right, wrong] == pytest.approx(came, rel=0.15)
    # Where drag is right its own line is good; of a Stribeck law at far higher speeds it says nothing.
    assert max(line[0, 1] / told[0, 1], line[1, 0] / told[1, 0]) > 10.0
    assert (asks.refitted(track, lambda _: True).d == line).all(), "there is no time for a refit"


def test_of_refits_those_come_first_that_are_told_least_and_none_begins_that_has_not_its_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    line = np.array([[0.0, 900.0, 20.0], [40.0, 0.0, 300.0], [3.0, 70.0, 0.0]])
    now, asked, took = [0.0], [], 2.0

    def left_by(asks: Telling, fit: Any, made: float) -> float:
        asked.append(float(line[int(made), fit.at]))
        now[0] += took
        return 1.0

    model = [SimpleNamespace(torque=lambda still, filtered, at=at: at) for at in range(3)]
    fits = [SimpleNamespace(at=at, core=SimpleNamespace(model=model[at])) for at in range(3)]
    asks = Telling(tuple(Rival((str(fit.at),), cast("Any", fit)) for fit in fits))
    monkeypatch.setattr(telling, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(Telling, "evidence", lambda *_: Told(line.copy(), np.zeros(3)))
    monkeypatch.setattr(Telling, "signals", lambda _, track, torque=None: torque)
    monkeypatch.setattr(Telling, "_left_by", left_by)
    asks.refitted(cast("Any", None))
    assert asked == [20.0, 40.0, 70.0, 300.0, 900.0], "what is not told anyhow is not refitted"
    now[0], asked[:] = 0.0, []
    told = asks.refitted(cast("Any", None), lambda more: now[0] + more > 5.0)
    assert asked == [20.0, 40.0], "a third would end after 6 s"
    assert told.d[0, 2] == told.d[1, 0] == 1.0 and told.d[2, 1] == 70.0


def test_of_rivals_that_are_asked_for_the_one_that_cannot_be_fitted_is_named(
    alike: kc.LearningResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fit(story: object, wanted: tuple[str, ...]) -> object:
        if "backlash" in wanted:
            raise kc.InputError("effect 'backlash': explains too little of it to be followed")
        return story

    monkeypatch.setattr(contenders_module, "_fit", fit)
    with pytest.raises(kc.InputError, match=r"^rivals: stribeck\+backlash: effect 'backlash': explains"):
        contenders(alike, ["base", "stribeck+backlash"])


def test_of_a_motion_as_many_samples_count_as_of_a_recording_of_it() -> None:
    # To and fro: what lies about each of the reversals counts in no capture.
    first = kc.fit(kc.simulate("knob4", "sweep", duration_s=3.0, seed=1))
    asks = Telling((Rival((), first),))
    for size in (0.15, 1.0):
        made = plan((Piece("passes", (size, 1.0, 0.5, 1.0, 0.5), 1.0),), kc.Limits.reached(first.prepared))
        track = made.track(5000.0)
        recorded = kc.fit(kc.simulate(first.model, track, seed=3), first.model).prepared[0].core.used
        assert recorded < 0.99 * len(track.t)
        lost, thinned = (len(one.t) - asks.signals(one).used for one in (track, made.track(1250.0)))
        assert lost == pytest.approx(len(track.t) - recorded, rel=0.2)
        assert 4 * thinned == pytest.approx(lost, rel=0.2), "what a search looks at is as much"
