"""What could not be told apart when it came in, beside the joint that came in after it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from known import BASE, Known

from knobcam.learn import ties

LAST = Known(1.02, (*BASE, "position_polynomial", "compliance"))


def end(rmse: float, *more: str, impossible: str | None = None) -> Any:
    return Known(rmse, (*BASE, "end_stop", "compliance", *more), impossible=impossible)


def test_what_explains_more_beside_a_joint_takes_the_place_of_what_came_in_before_it() -> None:
    better = end(1.0)
    assert ties._better({"end_stop": better, "unbalance": end(1.01)}, LAST) == ("end_stop", better)


@pytest.mark.parametrize(
    "other",
    [end(1.018), end(1.0, "its", "many", "parameters"), end(1.0, impossible="friction gives power back")],
    ids=["nearly as good", "for its parameters no better", "of no knob"],
)
def test_what_explains_no_more_for_its_parameters_or_is_of_no_knob_does_not(other: Any) -> None:
    assert ties._better({"end_stop": other}, LAST) is None
    assert ties._better({}, LAST) is None


def test_the_steps_to_another_set_are_in_the_order_of_those_that_led_to_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def step(added: str | None, diagnosis: object = None) -> Any:
        return SimpleNamespace(fit=LAST, added=added, diagnosis=diagnosis)

    weighed = object()
    ladder = [step(None), step("position_polynomial", weighed), step("gone"), step("compliance")]
    asked: list[Any] = []
    monkeypatch.setattr(ties, "climbed", lambda *all_of_it: asked.append(all_of_it) or ["climbed"])
    fit = end(1.0)
    assert ties._with(("end_stop", fit), ladder, 1) == (ladder[0], "climbed")
    assert asked == [(fit, ["end_stop", "compliance"], LAST, weighed)]
