"""A name comes with its weight against its rivals, and intervals with what the choice among them adds."""

from __future__ import annotations

import pytest

import knobcam as kc
from knobcam.learn.rivals import in_percent, with_choice


def test_weights_add_up_to_one_and_the_rivals_are_in_the_document(alike: kc.LearningResult) -> None:
    step = alike.ladder[1]
    assert sum(step.weights.values()) == pytest.approx(1.0, abs=0.01)
    document = step.document()
    assert document["weight"] == step.weights[step.added or ""]
    assert document["rivals"] == {one: w for one, w in step.weights.items() if one != step.added}
    assert "weight" not in alike.ladder[0].document()


def test_what_cannot_be_told_apart_shares_the_weight(alike: kc.LearningResult) -> None:
    step = alike.ladder[1]
    assert step.equivalent, "the capture tells them apart"
    assert 0.0 < step.weights[step.added or ""] < 0.999


def test_the_choice_among_rivals_widens_intervals_and_moves_no_value(alike: kc.LearningResult) -> None:
    bare, wide = alike.fit.params, alike.params
    assert with_choice(bare, alike.ladder[:1]) == dict(bare)
    assert all(wide[name].value == bare[name].value for name in bare)
    assert all(wide[name].se >= bare[name].se for name in bare if bare[name].determined)
    assert any(wide[name].se > 1.01 * bare[name].se for name in bare if bare[name].determined)
    last = alike.document()["ladder"][-1]["params"]
    assert all(last[name]["ci95"] == list(wide[name].ci95) for name in bare if bare[name].determined)


def test_a_weight_is_told_as_a_share() -> None:
    assert (in_percent(None), in_percent(0.9999), in_percent(0.25)) == ("", "> 99.9 %", "25.0 %")
