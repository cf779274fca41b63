"""What a search does with fits of which everything is known: what it keeps, drops, names and leaves open."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest
from known import BASE, SAMPLES, Known, climbed, comparison, estimate, split

import knobcam as kc
from knobcam.fit import refit, verdict
from knobcam.fit.rule import RULE
from knobcam.learn import earlier, exchanged, joined, search, selection
from knobcam.learn.cut import Cut
from knobcam.learn.ladder import LearningStep, Unexplained
from knobcam.learn.learning import LearningResult


def test_a_gain_is_the_fall_of_the_squares_in_variances_of_the_noise_and_has_its_price():
    # The mean square falls from 1.21 to 1.0 floors over a thousand samples.
    before, after = Known(1.1), Known(1.0, (*BASE, "stribeck"))
    assert refit.gain(before, after, after) == pytest.approx(210.0)
    for fall, paid in ((RULE.price * 1.001, True), (RULE.price * 0.999, False)):
        bare = Known(math.sqrt(1.0 + fall / SAMPLES))
        assert refit.unpaid(after, bare) != paid
        two = Known(1.0, (*BASE, "stribeck", "offset"))
        assert refit.unpaid(two, bare)
    # Paid for by many samples, and yet too little to be felt.
    for share, needed in ((RULE.worth * 1.01, True), (RULE.worth * 0.99, False)):
        bare = Known(1.0 / math.sqrt(1.0 - share))
        many = Known(1.0, (*BASE, "stribeck"), white_squares=1e6)
        assert refit.needless(many, bare) != needed
    assert (
        refit.error_fall(Known(2.0), Known(1.5)) == 0.25 and refit.error_fall(Known(0.0), Known(1.0)) == 0.0
    )
    assert refit.percent(-0.0001) == "+0.0 %" and refit.percent(0.25) == "+25.0 %"


def test_what_made_nothing_better_says_why():
    before = Known(2.0, rmse_heldout=2.0)
    richer = (*BASE, "stribeck")
    assert refit.worse(Known(1.0, richer, before, rmse_heldout=1.0)) == () == refit.worse(before)
    unseen = refit.worse(Known(1.0, richer, before, rmse_heldout=2.5))
    assert len(unseen) == 1 and "unseen blocks rose from 2 to 2.5 N m (+25.0 %)" in unseen[0]
    same = refit.worse(Known(2.0, richer, before, rmse_heldout=1.0))
    assert len(same) == 1 and "did not fall" in same[0]
    little = refit.worse(Known(math.sqrt(4.0 - 0.5 * RULE.price / SAMPLES), richer, before, rmse_heldout=1.0))
    assert len(little) == 1 and "another parameter" in little[0]
    two = refit.worse(Known(math.sqrt(4.0 - 1.5 * RULE.price / SAMPLES), (*richer, "offset"), before))
    assert len(two) == 1 and "2 more parameters" in two[0]


def test_parameters_move_in_errors_of_the_new_and_percent_of_the_old():
    old = Known(1.0, params={"a": estimate(-2.0, 0.3), "b": estimate(0.0, 1.0), "c": estimate(1.0, math.inf)})
    new = Known(1.0, params={"a": estimate(-1.0, 0.5), "b": estimate(1.0, 0.5), "c": estimate(2.0, 0.1)})
    moved = refit.moved(old, new)
    assert moved["a"] == (2.0, 50.0, 1.0) and moved["b"].by_se == 2.0 and math.isnan(moved["b"].by_percent)
    assert list(moved) == ["a", "b"]
    assert refit.moved(old, Known(1.0, params={"a": estimate(-2.0, 0.0)})) == {}


def test_laws_that_came_in_may_be_off_by_a_share_of_what_they_explain():
    first = Known(5.0)
    second = Known(3.0, before=first)
    third = Known(2.0, before=second)
    assert verdict.explained(third) == 21.0 and verdict.explained(first) == 0.0
    assert verdict.off_by_law(third) == pytest.approx(21.0 * RULE.law**2)
    # Where what a knock or a reversal leaves behind is among them by more; a soft shaft leaves nothing.
    soft = replace(third, effects=(*BASE, "compliance"))
    assert verdict.off_by_law(soft) == verdict.off_by_law(third)
    for late in ("backlash", "presliding"):
        gap = replace(third, effects=(*BASE, late))
        assert verdict.off_by_law(gap) == pytest.approx(21.0 * RULE.law_of_play**2)
    for times, within in ((0.99, True), (1.01, False)):
        # What is left above the floor, against what the laws may be off by.
        before = Known(math.sqrt(1.0 + 4e-4 / RULE.law**2))
        left = Known(math.sqrt(1.0 + times * 4e-4), before=before)
        assert verdict.within_law(left) == within
    assert not verdict.within_law(Known(2.0 * RULE.at_floor, before=Known(1e3)))


def test_what_a_law_may_be_off_by_names_nothing_more_also_above_the_floor_where_it_follows_a_reversal(
    monkeypatch,
):
    laws = []
    monkeypatch.setattr(verdict._core, "judge", lambda _, law, __: laws.append(law) or [])
    for rmse, effect in ((1.0, "stribeck"), (1.2, "stribeck"), (1.2, "presliding")):
        fit = Known(rmse, before=Known(5.0), effects=(*BASE, effect))
        assert verdict.judged(SimpleNamespace(fit=fit, judged=None), []) == ()
        expected = verdict.off_by_law(fit) if (rmse, effect) != (1.2, "stribeck") else 0.0
        assert laws.pop() == expected


@pytest.fixture(autouse=True)
def _nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selection, "in_doubt", lambda *_: None)
    monkeypatch.setattr(selection, "width", lambda fit: None)
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {})
    monkeypatch.setattr(selection, "tells_nothing", lambda prepared: None)


def named(ladder: list[LearningStep], left: Any, base: tuple[str, ...] = BASE) -> tuple[Any, Any]:
    told = selection.concluded(ladder, SimpleNamespace(comparison=left, candidates=()), base)
    return told.found, told.unexplained


def test_what_came_in_is_named_and_what_is_left_is_said(monkeypatch: pytest.MonkeyPatch):
    done, open_ = comparison(True), comparison(False, split("velocity", 0.3), split("time", 0.2))
    ladder = climbed(("stribeck", 1.5), ("quadratic_drag", 1.0))
    assert named(ladder, done) == (("stribeck", "quadratic_drag"), None)
    assert named(ladder, done, (*BASE, "stribeck")) == (("quadratic_drag",), None)
    # What is left has its axis; of what came in only what took off the most part of it is named then.
    found, left = named(climbed(("stribeck", 3.0), ("quadratic_drag", 2.9)), open_)
    assert found == ("stribeck",) and left == Unexplained("velocity", 0.3, "worst at there")
    # What ended at a bound stands in for something else, and is not named.
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {"stribeck.speed": 1e-3})
    assert named(climbed(("stribeck", 3.0), ("quadratic_drag", 2.9)), open_)[0] == ()
    assert named(climbed(("stribeck", 3.0)), done)[0] == ("stribeck",)
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {})
    nowhere = comparison(False, split("velocity", 0.05), split("time", 0.02))
    assert named(climbed(("stribeck", 3.0)), nowhere)[1].hint == "it shows on no axis alone"
    rhythm = comparison(False, split("frequency", 0.3), split("time", 0.2))
    line = named(climbed(("stribeck", 3.0)), rhythm)[1]
    assert line == Unexplained("time", 0.3, "a line at 12.0 Hz")
    assert line.hint.parts[0][:3] == ("frequency", 10.0, 14.0)  # where the page leads
    deaf = comparison(False, split("velocity", 0.3), split("time", 0.2), floor=math.nan)
    known = named(climbed(("stribeck", 3.0)), deaf)[1]
    assert (known.axis, known.share) == ("time", 0.8) and "no noise floor" in known.hint
    # A log at fault names nothing; neither does a model that no knob has, whatever explains most of it.
    fault = named(climbed(("stribeck", 1.0), log_fault="the torque is turned round"), done)
    assert fault == ((), Unexplained("load", 1.0, "the torque is turned round"))
    wrong = named(climbed(("stribeck", 3.0), ("quadratic_drag", 2.9), impossible="no knob has that"), done)
    assert wrong == ((), Unexplained("load", 1.0, "no knob has that"))
    beyond = SimpleNamespace(axis="position", share=0.4, words="waves beyond the filter")
    told = named(climbed(("stribeck", 1.0), beyond=beyond), done)
    assert told == (("stribeck",), Unexplained("position", 0.4, "waves beyond the filter"))
    # What no knob has is said first: of such a model it means nothing what the filter takes off.
    told = named(climbed(("stribeck", 1.0), beyond=beyond, impossible="no knob has that"), done)
    assert told == ((), Unexplained("load", 1.0, "no knob has that"))
    monkeypatch.setattr(selection, "width", lambda fit: "less than a detent")
    assert named(climbed(("stribeck", 1.0), impossible="no knob has that"), done) == (("stribeck",), None)


def test_more_than_are_believed_of_one_knob_together_name_no_cause():
    names = ("stribeck", "quadratic_drag", "presliding", "torque_lag")
    steps = list(zip(names, (4.0, 3.0, 2.0, 1.0), strict=True))
    assert named(climbed(*steps[:3]), comparison(True)) == (names[:3], None)
    found, left = named(climbed(*steps), comparison(True))
    assert found == () and (left.axis, left.share) == ("position", 0.8)
    assert left.hint.startswith(f"it takes {', '.join(names)} together")
    # A formula that the user took in is none of them; where more is left, that is what is said.
    assert named(climbed(*steps, laws=("torque_lag",)), comparison(True)) == (names, None)
    more = climbed(*steps[:3], ("torque_lag", 1.9))
    assert "together" not in named(more, comparison(False, split("time", 0.3)))[1].hint


def test_what_a_joint_bent_is_named_by_what_it_does_beside_it():
    left = 1.4**2 - 1.0
    for share, there in ((1.01, True), (0.99, False)):
        # Variances of the noise: a thousand samples of it, of which the spring takes as much off as is left.
        worths = {"return_spring": share * left * SAMPLES}
        for joint, came in (("backlash", there), ("stribeck", False)):
            ladder = climbed(("return_spring", 9.0), (joint, 1.4), worths=worths)
            found, _ = named(ladder, comparison(False, split("position", 0.3)))
            assert found == (("return_spring", joint) if came else (joint,)), (share, joint)


def without(fit: Any, effect: str) -> Any:
    """A fit without an effect and what changes it, as of `refit.drop`, which refuses what is not there."""
    assert effect in fit.model.effects
    left = tuple(one for one in fit.effects if effect not in (one, kc.effects()[one].needs))
    return replace(fit, effects=left, before=fit)


def test_where_too_many_came_in_the_joint_among_them_is_tried_alone(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(search, "converged", lambda fit: fit)
    monkeypatch.setattr(search, "drop", without)
    came = [("presliding", 9.0), ("backlash", 4.0), ("friction_drift", 2.0), ("return_spring", 1.0)]
    for p_value, steps, tried in (
        (0.001, came, True),
        (0.001, [("detent", 9.5), ("detent_harmonics", 9.2), *came[1:]], True),
        (0.5, came, False),
        (0.001, came[:3], False),
        (0.001, [came[1], came[0], *came[2:]], False),
        (0.001, [("stribeck", 4.0) if name == "backlash" else (name, rmse) for name, rmse in came], False),
    ):
        monkeypatch.setattr(search, "chance_of", lambda fit, before, diagnosis, p=p_value: p)
        ladder = climbed(*steps)
        ladder[1].diagnosis.fit = ladder[0].fit  # type: ignore[union-attr]
        step = search.joint_first(ladder)
        assert (step is not None) == tried, steps
        if step is not None:
            assert (step.added, step.p_value) == ("backlash", 0.001) and step.fit.before is ladder[0].fit
            assert step.fit.effects == (*BASE, "backlash")


def test_what_would_come_in_after_so_many_explains_nothing_and_is_not_named():
    best = SimpleNamespace(effect="cogging", error_fall=0.07)
    weighed: Any = SimpleNamespace(best=best)
    for many in (2, int(RULE.most), int(RULE.most) + 1):
        steps: Any = (LearningStep(Known(2.0), f"effect{at}", 0.001) for at in range(many))
        story = LearningResult(tuple(steps), (), weighed, Unexplained("position", 0.9, "worst at 0 rad"))
        assert (story.not_added is best) == (many <= RULE.most), many


def test_maps_of_position_together_name_no_cause(monkeypatch: pytest.MonkeyPatch):
    maps = climbed(("position_polynomial", 3.0), ("unbalance", 1.5), ("stribeck", 1.0))
    found, left = named(maps, comparison(True))
    assert found == ("stribeck",) and (left.axis, left.share) == ("position", 0.8)
    assert "position_polynomial and unbalance" in left.hint
    one = climbed(("unbalance", 1.5), ("stribeck", 1.0))
    assert named(one, comparison(True)) == (("unbalance", "stribeck"), None)


def test_what_is_no_longer_needed_goes_and_what_is_stays(monkeypatch: pytest.MonkeyPatch):
    followed: list[Any] = []
    monkeypatch.setattr(earlier, "drop", lambda fit, effect: fit.drop(effect))
    monkeypatch.setattr(earlier, "converged", lambda fit: followed.append(fit) or fit)
    helps = {"stribeck": 0.2, "offset": 1e-4, "unbalance": 0.1}
    fit = Known(1.0, (*BASE, *helps), helps=helps)
    left, gone = earlier.retested(fit, ["stribeck", "offset", "unbalance", "backlash"])
    assert gone == ("offset",) and left.effects == (*BASE, "stribeck", "unbalance")
    # Of what is worth far too much to go a sketch tells, and no fit without it is followed to its end.
    assert followed and all("offset" not in one.effects for one in followed)


def test_what_only_led_a_joint_to_a_better_end_is_left_out_again(monkeypatch: pytest.MonkeyPatch):
    followed: list[Known] = []
    monkeypatch.setattr(earlier, "drop", Known.drop)
    monkeypatch.setattr(earlier, "converged", lambda bare: followed.append(bare) or bare)

    def of(place: str) -> Any:
        return SimpleNamespace(effect="offset", place=place)

    fit = Known(2.0, (*BASE, "backlash"), before="what was before")
    helped = Known(1.0, (*BASE, "backlash", "offset"), fit, {"offset": 1e-4})
    bare = earlier.without_help(helped, of("load"), fit)
    assert bare is not None and bare.effects == fit.effects and bare.before == "what was before"
    needed = Known(1.0, (*BASE, "backlash", "offset"), fit, {"offset": 0.1})
    little = Known(2.0 * (1.0 - 0.5 * RULE.helped), (*BASE, "backlash", "offset"), fit)
    rigid = Known(1.0, (*BASE, "offset"), fit)
    # A sketch without it is so much worse that none is followed to its end.
    assert earlier.without_help(needed, of("load"), fit) is None and len(followed) == 1
    assert earlier.without_help(little, of("load"), fit) is None
    assert earlier.without_help(helped, of("coupling"), fit) is None
    assert earlier.without_help(rigid, of("load"), Known(2.0)) is None


def test_what_came_in_beside_no_joint_is_what_a_set_is_held_against():
    first, last = Known(2.0), Known(1.0, (*BASE, "stribeck", "offset"))
    assert exchanged._found(first, last) == ["stribeck", "offset"]
    assert exchanged._found(first, Known(1.0, (*BASE, "stribeck", "backlash"))) == []
    # 3000 variances of the noise taken off, and five parameters to pay.
    assert exchanged._score(last, first) == pytest.approx(3000.0 - 5 * RULE.price)


def test_an_effect_is_looked_for_anew_where_that_ends_lower(monkeypatch: pytest.MonkeyPatch):
    ladder = climbed(("stribeck", 3.0), ("unbalance", 2.0))
    asked: list[str] = []

    def again(rmse: float) -> Any:
        def add(fit: Known, effect: str, _: object) -> Known:
            asked.append(effect)
            return Known(rmse, (*fit.effects, effect), fit)

        monkeypatch.setattr(exchanged, "add", add)
        return exchanged.anew(ladder, comparison(False), lambda _: None)

    assert again(1.99) is None and again(1.9).rmse == 1.9
    assert again(1.9).before is ladder[-1].fit.before
    # What came in last was found beside all others.
    assert set(asked) == {"stribeck"}
    assert exchanged.anew(ladder[:2], comparison(False), lambda _: None) is None


def test_a_set_comes_in_by_what_each_explains_by_itself(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(joined, "converged", lambda fit: fit)
    alone = [
        SimpleNamespace(effect=one, gain=gain, score=gain - 10.0, p_value=p)
        for one, gain, p in (("a", 50.0, 0.02), ("b", 900.0, 0.001))
    ]
    diagnosis = SimpleNamespace(candidates=alone, fit=Known(2.0))
    fit = Known(1.0, (*BASE, "a", "b"), helps={"a": 0.5, "b": 1.0})
    steps = exchanged._steps(fit, ["a", "b"], LearningStep(Known(2.0)), diagnosis)
    assert [(one.added, one.rmse, one.fit.before.rmse) for one in steps] == [("b", 1.5, 2.0), ("a", 1.0, 1.5)]
    # Chance does as well no oftener than for what takes off less.
    assert [one.p_value for one in steps] == [0.001, 0.001]
    assert joined.chance_of(Known(math.sqrt(3.94)), Known(2.0), diagnosis) == 0.02
    assert joined.chance_of(Known(math.sqrt(3.999)), Known(2.0), diagnosis) == 1.0
    unknown = SimpleNamespace(candidates=alone, fit=Known(2.0, noise_floor=math.nan))
    assert joined.chance_of(Known(1.0), Known(2.0), unknown) == 1.0


def test_a_joint_and_what_hides_beside_it_come_in_where_both_are_needed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(joined, "converged", lambda fit: fit)
    monkeypatch.setattr(joined, "absent", lambda fit, without: (["backlash", "offset"], {}))
    monkeypatch.setattr(joined, "cores", lambda fit: [])
    monkeypatch.setattr(joined, "replace", lambda fit, core=None, **more: replace(core or fit, **more))
    first, last = Known(3.0), Known(2.0, (*BASE, "stribeck"))
    alone = Known(2.5, (*BASE, "offset"))

    class Told(dict[str, Any]):
        best = None

    implausible: list[str] = []

    def beside(told: Any, joint: str, own: Any, before: Any, *_: Any) -> Any:
        fit = replace(own, before=before)
        one = SimpleNamespace(effect=joint, fit=fit, p_value=0.001, equivalent=("compliance",))
        one.implausible = tuple(implausible)
        return Told({joint: one})

    def of(rmse: float, needed: float, p_value: float = 0.001) -> list[LearningStep] | None:
        pair = Known(rmse, (*BASE, "backlash", "offset"), None, {"offset": needed})
        monkeypatch.setattr(joined._core, "pairs", lambda *_: [("backlash", "offset", pair)])
        weighed = SimpleNamespace(effect="offset", fit=alone, gain=1.0, p_value=p_value)
        monkeypatch.setattr(joined, "beside_others", beside)
        return joined.joined(SimpleNamespace(fit=first, candidates=[weighed]), last, (), lambda _: None)

    both = of(1.0, 0.5)
    assert both is not None and [(one.added, one.rmse) for one in both] == [
        ("offset", 2.5),
        ("backlash", 1.0),
    ]
    assert both[0].fit.before is first and both[1].fit.before is both[0].fit
    assert both[1].equivalent == ("compliance",)
    joint = of(1.0, 1e-4)
    assert joint is not None and [one.added for one in joint] == ["backlash"]
    assert joint[0].fit.effects == (*BASE, "backlash") and joint[0].fit.before is first
    # Chance that does as well, and a pair that leaves more than half of what the search left.
    assert of(1.0, 0.5, 0.5) is None and of(1.0, 1e-4, 0.5) is None
    assert of(math.sqrt(1.0 + 3.0 * RULE.pair_leaves * 1.01), 0.5) is None
    assert of(math.sqrt(1.0 + 3.0 * RULE.pair_leaves * 0.99), 0.5) is not None
    # A joint that is none by its values, beside another effect or alone.
    implausible.append("a gap of nothing")
    assert of(1.0, 0.5) is None and of(1.0, 1e-4) is None


def test_a_joint_that_leads_by_a_sketch_is_followed_and_nothing_else(monkeypatch: pytest.MonkeyPatch):
    @dataclass(frozen=True)
    class Led:
        effect: str
        place: str
        score: float
        fit: Any
        gain: float = 0.0
        beyond_chance: bool = True
        implausible: tuple[str, ...] = ()

    @dataclass(frozen=True)
    class Weighed:
        fit: Any
        candidates: Any
        comparison: Any = None

        @property
        def best(self) -> Any:
            return self.candidates[0] if self.candidates else None

    monkeypatch.setattr(search, "converged", lambda fit: replace(fit, rmse=0.5 * fit.rmse))
    monkeypatch.setattr(search, "judged", lambda comparison, candidates: tuple(candidates))
    monkeypatch.setattr(search, "gain", lambda before, after, noise: before.rmse - after.rmse)
    joint, load = Led("backlash", "coupling", 9.0, Known(2.0)), Led("offset", "load", 8.0, Known(3.0))

    def end(*candidates: Led) -> Any:
        return search.followed(Weighed(Known(4.0), candidates), lambda _: None)

    told = end(load, joint)
    assert told.best.effect == "backlash" and told.candidates[1] is load
    assert told.best.fit.rmse == 1.0 and told.best.fit.before.rmse == 4.0 and told.best.gain == 3.0
    assert end() is None and end(load) is None
    assert end(replace(load, score=10.0), joint) is None
    assert (
        end(replace(joint, beyond_chance=False)) is None and end(replace(joint, implausible=("no",))) is None
    )


def test_what_returns_with_each_of_many_detents_is_no_free_map(monkeypatch: pytest.MonkeyPatch):
    period = 0.1
    for crossed, is_map in ((RULE.many * 0.99, True), (RULE.many * 1.01, False)):
        monkeypatch.setattr(selection, "travel", lambda _, crossed=crossed: crossed * 2.0 * math.pi * period)
        fit = SimpleNamespace(
            model=SimpleNamespace(coordinate="rotary", period=period, catalogue=kc.effects), prepared=()
        )
        assert selection._is_map("detent_harmonics", fit) == is_map
        # What needs no detents is a map however many there are.
        assert selection._is_map("position_polynomial", fit) and not selection._is_map("stribeck", fit)
        fit.model.period = None
        assert selection._is_map("detent_harmonics", fit)


def test_a_cut_names_a_few_of_what_was_not_weighed():
    cut = Cut("budget", 2.0, tuple("abcdefgh"))
    assert "its time was used up: not weighed were a, b, c, d, e, f and 2 more" in cut.words
    assert Cut("interrupt", 2.0, tuple("abcdef")).words.endswith(
        "it was interrupted: not weighed were a, b, c, d, e, f"
    )
