"""D of a pair: how seldom the wrong one is chosen after a motion, with what captures say already."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import knobcam as kc
from knobcam.fit.rule import RULE
from knobcam.learn.contenders import contenders
from knobcam.learn.telling import TOLD, Rival, Telling, wrong_choice

RIVALS = tuple(
    Rival((one,), cast("Any", SimpleNamespace(core=SimpleNamespace(free=range(count)))))
    for one, count in (("return_spring", 9), ("position_polynomial", 11))
)


def d_of(lead: float, spring_right: float, polynomial_right: float) -> float:
    """D of a spring and a polynomial, where so much speaks for the spring already."""
    asks = Telling(RIVALS)
    asks.__dict__["leads"] = np.array([[0.0, lead], [-lead, 0.0]])
    told = np.array([[0.0, spring_right], [polynomial_right, 0.0]])
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


def test_what_captures_tell_already_has_no_odds(alike: kc.LearningResult) -> None:
    both = contenders(alike, ("base", "return_spring"))
    assert math.isnan(Telling(both).leads[0, 1])
