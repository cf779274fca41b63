"""Several effects that leave chance alone, and are no causes: they draw together what none of them is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from examiner import Case
from known import BASE, Known, climbed, comparison, split
from small import COUPLINGS, NAMES

import knobcam as kc
from knobcam.learn import LearningResult, exchanged, selection, together
from knobcam.learn.ladder import Unexplained

LEFT = Unexplained("position", 0.4, "")


def learnt(case: str, every: int = 4) -> LearningResult:
    """A search with every so manieth sample of a case, without joints, which take by far the longest."""
    knob = Case.parse(case).make().capture
    columns = {name: np.asarray(knob[column][::every]) for name, column in NAMES.items()}
    return kc.learn(kc.Capture.from_arrays(**columns), without=COUPLINGS)


@pytest.mark.parametrize("seed", [460000, 460001])
def test_a_pawl_is_not_said_to_be_friction_over_position_and_what_gives_it_a_constant(seed: int) -> None:
    story = learnt(f"strange/pawl:{seed}")
    assert story.verdict == "unexplained"


def test_a_pawl_that_rubs_one_way_alone_is_no_friction_over_position_whatever_went_again() -> None:
    story = learnt("strange/pawl:472000")
    assert story.verdict == "unexplained" and story.found == ()
    assert "values that cannot be its own: what varies rubs one way alone" in str(story.headline)


def test_of_periods_that_explain_as_much_friction_has_one_that_the_motion_crosses() -> None:
    knob = Case.parse("several/effects:472001").make().capture
    columns = {name: np.asarray(knob[column][::2]) for name, column in NAMES.items()}
    beside = kc.fit(kc.Capture.from_arrays(**columns)).add("presliding")
    led = kc.diagnose(beside, without=COUPLINGS)["position_friction"]
    # The strongest waves alone lead to 0.264, of which the motion crosses no more than a trend.
    assert led.implausible == () and led.word == "missing"
    estimate = led.parameters["position_friction.P"]
    assert estimate.ci95[0] < 1.0 / 5.2485 < estimate.ci95[1]


@pytest.mark.parametrize("leaves, taken", [(1.0, True), (1.002, True), (1.01, False)])
def test_an_effect_with_values_that_are_not_its_own_is_looked_for_at_others_beside_a_joint_too(
    monkeypatch: pytest.MonkeyPatch, leaves: float, taken: bool
) -> None:
    ladder = climbed(("position_friction", 3.0), ("compliance", 1.0))
    asked: list[str] = []

    def elsewhere(_: object, fit: object, effect: str, progress: object) -> object:
        asked.append(effect)
        return fit

    last, again = ladder[-1].fit, Known(leaves, ladder[-1].fit.effects)
    monkeypatch.setattr(exchanged, "_core", SimpleNamespace(elsewhere=elsewhere))
    monkeypatch.setattr(exchanged, "cores", lambda _: [])
    monkeypatch.setattr(exchanged, "converged", lambda _: again)
    monkeypatch.setattr(exchanged, "replace", lambda fit, **_: fit)

    def stands_in(one: str, fit: object) -> tuple[str, ...]:
        return ("it is a trend",) if one == "position_friction" and fit is last else ()

    monkeypatch.setattr(exchanged, "stands_in", stands_in)
    found = exchanged.at_own_values(ladder, lambda _: None)
    # A thousand samples of noise: 1.002 leaves 4 variances more, which tell nothing, 1.01 leaves 20.
    assert asked == ["position_friction"] and (found is again) == taken


def doubted(
    monkeypatch: pytest.MonkeyPatch,
    trace: tuple[list[str], float, float],
    bent: str = "",
    joint: str | None = None,
    found: tuple[str, ...] = ("unbalance", "stribeck"),
) -> object:
    fit = SimpleNamespace(
        trace=trace,
        model=SimpleNamespace(joint=joint),
        noise_floor=2.0,
        white_squares=400.0,
        rmse=2.0,
    )
    monkeypatch.setattr(together, "stands_in", lambda one, _: ("it is a trend",) if one == bent else ())
    monkeypatch.setattr(together, "off_by_law", lambda _: 0.1)
    return together.in_doubt(fit, found, LEFT)  # type: ignore[arg-type]


def test_what_a_law_takes_off_beyond_chance_and_beyond_what_laws_may_be_off_by_speaks_against_a_set(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    none, left = doubted(monkeypatch, (["omega", "theta"], 20.0, 0.005))
    assert none == () and (left.axis, left.share) == ("position", 0.05)
    assert left.hint == (
        "unbalance and stribeck draw all but what follows position there, which chance does not make"
    )
    assert doubted(monkeypatch, (["omega", "theta"], 20.0, 0.006)) is None
    assert doubted(monkeypatch, (["omega", "theta"], 9.0, 0.005)) is None
    assert doubted(monkeypatch, (["omega", "theta"], 20.0, 0.005), joint="backlash") is None


def test_of_a_set_an_effect_with_values_that_are_not_its_own_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    none, left = doubted(monkeypatch, ([], 0.0, 1.0), bent="stribeck", joint="backlash")
    assert none == ("stribeck",) and left[:2] == LEFT[:2]
    assert str(left.hint).endswith("but stribeck by values that cannot be its own: it is a trend")


def test_one_effect_is_asked_for_its_values_and_not_for_what_a_law_takes_off(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    trace = (["omega", "theta"], 20.0, 0.005)
    assert doubted(monkeypatch, trace, found=("stribeck",)) is None
    none, left = doubted(monkeypatch, trace, bent="stribeck", found=("stribeck",))
    assert none == ("stribeck",)
    assert str(left.hint) == "stribeck draws it, but by values that cannot be its own: it is a trend"


def test_what_is_in_doubt_is_unexplained_and_a_cause_beside_it_is_still_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, answer in (("width", None), ("at_bounds", {}), ("tells_nothing", None)):
        monkeypatch.setattr(selection, name, lambda _, answer=answer: answer)
    monkeypatch.setattr(selection, "in_doubt", lambda *_: (("detent",), LEFT))
    ladder = climbed(("presliding", 4.0), ("detent", 1.5))
    last = SimpleNamespace(comparison=comparison(True, split("velocity", 0.3)), candidates=())
    told = selection.concluded(ladder, last, BASE)
    assert (told.found, told.unexplained) == (("presliding",), LEFT)


def test_where_chance_explains_the_rest_but_for_what_follows_a_law_each_is_looked_for_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ladder = climbed(("stribeck", 3.0), ("unbalance", 1.02))
    asked: list[str] = []

    def again(rmse: float, *, follows: bool = True) -> object:
        def add(fit: Known, effect: str, _: object) -> Known:
            asked.append(effect)
            return Known(rmse, (*fit.effects, effect), fit)

        monkeypatch.setattr(exchanged, "add", add)
        monkeypatch.setattr(exchanged, "follows", lambda _: follows)
        return exchanged.anew(ladder, comparison(True), lambda _: None)

    assert again(1.0, follows=False) is None and asked == []
    # A thousand samples of noise: 1.0 takes off 40 variances, more than a parameter costs, and 1.019 only 2.
    assert again(1.019) is None and set(asked) == {"stribeck", "unbalance"}
    assert again(1.0).rmse == 1.0  # type: ignore[attr-defined]
