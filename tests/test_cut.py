"""A search that is cut short says what it had weighed, and gives no verdict that it did not earn."""

from __future__ import annotations

import json

import pytest

import knobcam as kc
from knobcam.learn import Interrupted, learning, search


@pytest.fixture(scope="module")
def faultless() -> kc.Capture:
    return kc.simulate("knob4", "multisine", duration_s=3.0, seed=1)


def test_a_search_without_time_does_not_say_that_nothing_is_missing(faultless: kc.Capture) -> None:
    story = kc.learn(faultless, budget_s=1e-9)
    assert (story.verdict, story.found) == ("unexplained", ())
    document = json.loads(json.dumps(story.document()))
    assert document["cut"]["by"] == "budget" and "stribeck" in document["cut"]["not_weighed"]
    assert "not known" in story.headline and "not weighed were" in document["unexplained"]["hint"]
    assert "stribeck" in story.last.left_out


def test_a_search_with_time_enough_is_not_cut(faultless: kc.Capture) -> None:
    story = kc.learn(faultless, budget_s=600.0)
    assert story.verdict == "complete" and story.document()["cut"] is None


def test_what_came_in_before_the_cut_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    knob = kc.hiding("knob1", "stribeck", motion="multisine")
    capture = kc.simulate(knob, "multisine", duration_s=3.0, seed=2)
    weigh, asked = search.worth_adding, []

    def once(*args: object, **options: object) -> object:
        if asked:
            raise KeyboardInterrupt
        asked.append(True)
        return weigh(*args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(search, "worth_adding", once)
    with pytest.raises(Interrupted) as ended:
        learning.learn(capture)
    known = ended.value.so_far
    assert known.verdict == "unexplained" and len(known.ladder) == 2
    assert known.cut is not None and known.cut.by == "interrupt"


def test_a_budget_that_is_none_is_refused(faultless: kc.Capture) -> None:
    with pytest.raises(kc.InputError, match=r"budget_s=0\.0 must be above 0"):
        kc.learn(faultless, budget_s=0.0)
