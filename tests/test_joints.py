"""A joint against what else it could be: when joints are looked at, and how they are judged with the rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import hidden
import numpy as np
import pytest
from known import BASE, Known, climbed
from small import NAMES
from strata import Stratum

import knobcam as kc
from knobcam.fit.diagnose import Candidate
from knobcam.fit.rule import RULE
from knobcam.learn import contenders, joined, joints


def rubbing(over: float | None, friction: float = 0.01, inertia: float = 1e-4, edge_hz: float = 500.0) -> Any:
    """A fit of a knob whose friction builds up over a distance, if it does."""
    model = SimpleNamespace(
        builds_up_over=over, at_rest=lambda: (inertia, [friction, friction], [friction, friction], 0.0)
    )
    recorded = SimpleNamespace(core=SimpleNamespace(edge_hz=edge_hz))
    return SimpleNamespace(core=SimpleNamespace(model=model), prepared=(recorded,))


@dataclass(frozen=True)
class One:
    """A candidate of which everything is known."""

    effect: str
    rmse: float
    gain: float = 50.0
    p_value: float = 0.001
    place: str = "load"
    count: int = 3
    fit: Any = field(default_factory=lambda: rubbing(None))

    @property
    def score(self) -> float:
        return self.gain


@dataclass(frozen=True)
class Weighed:
    """A diagnosis; the first is named."""

    fit: Any
    candidates: tuple[Any, ...]
    left_out: dict[str, str] = field(default_factory=dict)
    comparison: Any = None

    @property
    def best(self) -> Any:
        return self.candidates[0] if self.candidates else None

    @property
    def could_be(self) -> tuple[Any, ...]:
        return tuple(one for one in self.candidates if one.effect != "presliding")


def test_joints_are_looked_at_where_what_is_named_does_not_explain_what_is_left(
    monkeypatch: pytest.MonkeyPatch,
):
    found = One("compliance", 1.0, gain=70.0, p_value=1.0, place="coupling")
    other = SimpleNamespace(candidates=(found,), left_out={"backlash": "too little", "offset": "asked not"})
    monkeypatch.setattr(joints, "absent", lambda fit, without: (["compliance", "backlash", "lag"], {}))
    monkeypatch.setattr(joints, "diagnose", lambda fit, only, progress: other)
    monkeypatch.setattr(joints, "judged", lambda comparison, candidates: tuple(candidates))

    def told(left: float, named: str = "lag", gain: float = 50.0, **more: Any) -> Any:
        # Of a mean square of 0.1 above the floor the named one leaves so much.
        candidates = (One(named, math.sqrt(1.0 + left), gain), One("presliding", 1.0, 60.0, 0.002))
        weighed = Weighed(Known(math.sqrt(1.1)), candidates, **more)
        return weighed, joints.overlooked(weighed, (), lambda _: None)

    before, after = told(0.1 * RULE.better * 1.01)
    assert [one.effect for one in after.candidates] == ["lag", "presliding", "compliance"]
    # Chance does as well no oftener than for what takes off less.
    assert after.candidates[2].p_value == 0.001 and after.left_out == {"backlash": "too little"}
    before, after = told(0.1 * RULE.better * 0.99)
    assert after is before
    # Another that could be missing explains it, though it is not named.
    some = (One("lag", math.sqrt(1.09)), One("polynomial", 1.0))
    tied = Weighed(Known(math.sqrt(1.1)), some)
    assert joints.overlooked(tied, (), lambda _: None) is tied
    # What looks like a joint and explains so little that a fiftieth of it tells nothing.
    for gain, looked in ((0.99, True), (1.01, False)):
        before, after = told(0.0, "torque_lag", gain * RULE.alike / RULE.relative)
        assert (after is not before) == looked
    # They were looked at already, or there is nothing to look at them for.
    before, after = told(0.09, left_out={"backlash": "too little"})
    assert after is before
    none = Weighed(Known(1.5), ())
    assert joints.overlooked(none, (), lambda _: None) is none
    # A joint that gives way so little shows as friction that builds up alone: 0.01 N m over 1e-4 rad
    # are 100 N m/rad, on which 1e-4 kg m^2 swings 159 times a second.
    much = 2.0 * RULE.alike / RULE.relative
    for over, edge_hz, looked in ((1e-4, 480.0, False), (1e-4, 470.0, True), (None, 470.0, False)):
        for named, gain in (("lag", much), ("lag", much + 0.99 * RULE.alike)):
            slips = One("presliding", 1.0, much, fit=rubbing(over, edge_hz=edge_hz))
            weighed = Weighed(Known(math.sqrt(1.1)), (One(named, 1.0, gain), slips))
            assert (joints.overlooked(weighed, (), lambda _: None) is not weighed) == looked
    # But not where it explains less than what is named.
    slips = One("presliding", 1.0, much, fit=rubbing(1e-4))
    weighed = Weighed(Known(math.sqrt(1.1)), (One("lag", 1.0, much + 1.01 * RULE.alike), slips))
    assert joints.overlooked(weighed, (), lambda _: None) is weighed


def test_chance_takes_off_no_more_than_the_best_of_many_tries_of_independent_numbers():
    diagnosis: Any = SimpleNamespace(candidates=(One("lag", 1.0, 20.0, 0.3), One("presliding", 1.0, 300.0)))
    # Below the one that chance does not make it is not as likely as the other for that.
    assert joints.chance(200.0, diagnosis) == 0.3 and joints.chance(200.0, diagnosis, 4) == 0.001
    assert joints.chance(300.0, diagnosis) == 0.001
    assert joints.chance(30.0, diagnosis, 4) == 0.3 and joints.chance(10.0, diagnosis, 4) == 1.0
    # The best of 10^4 draws of as many numbers, twice as loud, is less.
    draws = 2.0 * np.random.default_rng(3).chisquare(4, (300, 10_000)).max(axis=1)
    for took in np.linspace(40.0, 90.0, 11).tolist():
        assert joints.chance(took, diagnosis, 4) >= min(0.3, float(np.mean(draws >= took)))


def test_of_what_cannot_be_told_apart_the_first_comes_in_that_is_possible_at_its_end(
    monkeypatch: pytest.MonkeyPatch,
):
    @dataclass(frozen=True)
    class Tied:
        effect: str
        fit: str
        rmse: float
        equivalent: tuple[str, ...] = ()
        could_be: bool = True
        place: str = "load"

    followed: list[str] = []
    bad: set[str] = set()
    monkeypatch.setattr(joints, "converged", lambda fit: followed.append(fit) or f"{fit} at its end")
    monkeypatch.setattr(joints, "implausible", lambda one, before: ("no",) if one.effect in bad else ())
    best: Any = Tied("compliance", "soft", 1.0, ("presliding",), place="coupling")
    other, third = Tied("presliding", "slips", 1.2), Tied("lag", "late", 1.2)
    diagnosis: Any = SimpleNamespace(fit=Known(2.0), candidates=(best, third, other))
    assert joints.followed_to(diagnosis, best) == (best, "soft at its end") and followed == ["soft"]
    bad.add("compliance")
    assert joints.followed_to(diagnosis, best) == (other, "slips at its end")
    # What explains all of it does, too, though it takes more for that.
    third = Tied("lag", "late", 1.0)
    diagnosis.candidates = (best, third, other)
    assert joints.followed_to(diagnosis, best) == (third, "late at its end")
    # With nothing in its place it is what it is: the verdict says that its values cannot be.
    bad |= {"presliding", "lag"}
    assert joints.followed_to(diagnosis, best) == (best, "soft at its end")
    diagnosis.candidates = (best,)
    assert joints.followed_to(diagnosis, best) == (best, "soft at its end")
    # Of what is no joint the sketch tells whether it is possible.
    followed.clear()
    assert joints.followed_to(diagnosis, third) == (third, "late at its end") and followed == ["late"]
    # What comes in with it may bend a joint that was possible without.
    monkeypatch.setattr(
        joints, "implausible", lambda one, before: ("no",) if "soft at its end, " in one.fit else ()
    )
    diagnosis.candidates = (best, other)
    assert joints.followed_to(diagnosis, best) == (best, "soft at its end")
    whole: Any = joints.followed_to(diagnosis, best, lambda fit: cast(Any, f"{fit}, with detents"))
    assert whole == (other, "slips at its end, with detents")


def test_a_joint_and_the_other_in_its_place_are_judged_with_what_else_there_is(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(joints, "absent", lambda fit, without: (["backlash", "compliance", "offset"], {}))
    monkeypatch.setattr(joints, "judged", lambda comparison, candidates: tuple(candidates))
    monkeypatch.setattr(joints, "implausible", lambda candidate, before: (f"no {candidate.effect}",))
    monkeypatch.setattr(
        joints,
        "replace",
        lambda one, **more: Candidate(**{**vars(one), **more}) if isinstance(one, Candidate) else one,
    )
    first = Known(2.0)
    monkeypatch.setattr(Known, "compare", lambda self: None, raising=False)
    own, other = Known(1.0, (*BASE, "backlash")), Known(1.1, (*BASE, "compliance"))
    monkeypatch.setattr(joints, "in_place", lambda fit, one, progress: {"compliance": other}[one])
    weighed = Weighed(first, (One("offset", 1.9, 10.0, 0.02), One("backlash", 1.5)), {"cogging": "no"})
    told = joints.beside_others(weighed, "backlash", own, first, (), lambda _: None)
    assert [one.effect for one in told.candidates] == ["offset", "backlash", "compliance"]
    assert [one.count for one in told.candidates[1:]] == [4, 3]
    assert told.candidates[1].gain > told.candidates[2].gain > 1000.0
    assert told.candidates[1].implausible == ("no backlash",) and told.left_out == {"cogging": "no"}
    # Beside another model the others were never weighed.
    alone = joints.beside_others(weighed, "backlash", own, Known(1.8), (), lambda _: None)
    assert [one.effect for one in alone.candidates] == ["backlash", "compliance"]
    monkeypatch.setattr(joints, "in_place", lambda fit, one, progress: None)
    alone = joints.beside_others(weighed, "backlash", own, Known(1.8), (), lambda _: None)
    assert [one.effect for one in alone.candidates] == ["backlash"]


def test_a_parameter_that_may_be_anything_in_its_range_is_no_choice():
    def charged(*errors: float) -> float:
        known = {
            f"presliding.w{i}": SimpleNamespace(se=error, determined=error < math.inf)
            for i, error in enumerate(errors, 1)
        }
        fit = SimpleNamespace(params=known, model=SimpleNamespace(coordinate="rotary"))
        return Candidate("presliding", fit, 0.001, 100.0, 7).charged  # type: ignore[arg-type]

    assert charged() == 7.0
    # A share lies between 0 and 1: known to e^-6 of that it costs its price of 12, to all of it nothing.
    assert charged(math.exp(-0.5 * RULE.price)) == pytest.approx(7.0) == charged(1e-9)
    assert charged(1.0) == pytest.approx(6.0) == charged(50.0)
    assert charged(math.exp(-0.25 * RULE.price), 1.0) == pytest.approx(5.5)
    assert charged(math.inf, 0.0) == 7.0


def test_another_joint_is_fitted_from_where_the_one_that_came_in_ended(monkeypatch: pytest.MonkeyPatch):
    first = Known(3.0)
    ended = Known(1.0, (*BASE, "compliance", "offset"))
    steps = [SimpleNamespace(fit=one, effects=one.effects, diagnosis=None) for one in (first, ended)]
    story: Any = SimpleNamespace(ladder=steps, model=SimpleNamespace(coordinate="rotary"))
    monkeypatch.setattr(contenders, "in_place", lambda fit, other: (fit, other))
    monkeypatch.setattr(Known, "add", lambda self, effect: (self, effect, "alone"), raising=False)
    assert contenders._fit(story, ("compliance", "offset")) is ended
    assert contenders._fit(story, ("offset", "backlash")) == (ended, "backlash")
    # Beside other effects there is nothing to begin from, nor for what has no joint.
    assert contenders._fit(story, ("backlash",)) == (first, "backlash", "alone")
    assert contenders._fit(story, ("offset",)) == (first, "offset", "alone")


def came(added: str, *others: str) -> Any:
    """A step of a ladder that ends with a joint and two more effects."""
    model = SimpleNamespace(coordinate="rotary", effects=(*BASE, "compliance", "stribeck", "offset"))
    fit = SimpleNamespace(model=model)
    return SimpleNamespace(added=added, weights=dict.fromkeys(others, 0.3), equivalent=(), fit=fit)


def test_a_joint_is_instead_of_nothing_beside_one_that_stays():
    steps = [came("compliance", "backlash", "stribeck"), came("stribeck", "backlash", "presliding", "offset")]
    assert contenders.untold(steps) == [("compliance", "backlash"), ("stribeck", "presliding")]


def test_what_came_in_and_went_again_is_not_told_from_anything():
    assert contenders.untold([came("unbalance", "cogging"), came("stribeck", "presliding")]) == [
        ("stribeck", "presliding")
    ]


def test_a_joint_that_is_none_by_its_values_does_not_come_in_beside_a_companion():
    def told(**more: Any) -> Any:
        one = SimpleNamespace(
            effect="backlash",
            fit=BASE,
            p_value=0.001,
            equivalent=(),
            place="coupling",
            implausible=(),
            **more,
        )
        return {"backlash": one}, one

    class Told(dict[str, Any]):
        best = None

    rows, one = told()
    assert joined._step(Told(rows), "backlash").added == "backlash"
    one.implausible = ("its gap is nothing: it is compliance",)
    assert joined._step(Told(rows), "backlash") is None


def test_a_joint_gives_way_to_another_that_explains_better_what_came_in_after_it_left(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(joined, "converged", lambda fit: fit)
    monkeypatch.setattr(joined, "chance_of", lambda richer, before, diagnosis: 0.001)
    monkeypatch.setattr(joined, "within_law", lambda fit: fit.rmse < 1.04)
    asked: list[Any] = []

    def told(best: str, *implausible: str) -> Any:
        def beside(diagnosis: Any, joint: str, own: Known, before: Known, *_: object) -> Any:
            asked.append((joint, own, before.effects))
            fit = Known(1.0, (*before.effects, best))
            named = Candidate(best, fit, 0.001, 100.0, 3, implausible=implausible)  # type: ignore[arg-type]
            return Weighed(before, (named,))

        monkeypatch.setattr(joined, "beside_others", beside)

    def steps(*came: tuple[str, float]) -> Any:
        return joined.rejoined(climbed(*came), (), lambda _: None)

    came = (("offset", 4.0), ("backlash", 2.0), ("return_spring", 1.03))
    told("compliance")
    found = steps(*came)
    assert [one.added for one in found] == ["offset", "return_spring", "compliance"]
    assert [one.effects[3:] for one in found[:2]] == [("offset",), ("offset", "return_spring")]
    assert asked[0][0] == "backlash" and asked[0][1].rmse == 1.03
    assert asked[0][2] == (*BASE, "offset", "return_spring")
    # What came in last was weighed beside all others, and what has no joint has none to give.
    assert steps(*came[:2]) is None and steps(came[0], came[2]) is None and len(asked) == 1
    # Noise alone is left, or less than laws may be off by where no joint is simpler.
    assert steps(*came[:2], ("return_spring", 1.01)) is None
    assert steps(("compliance", 2.0), came[2]) is None and len(asked) == 1
    assert steps(("compliance", 2.0), ("return_spring", 1.05)) is None and len(asked) == 2
    told("backlash")
    assert steps(*came) is None
    told("compliance", "it cannot be")
    assert steps(*came) is None


@pytest.mark.parametrize(
    ("knob", "motion"), [("knob3", "multisine"), ("knob4", "multisine"), ("knob4", "hand")]
)
def test_the_fit_of_a_model_with_a_joint_ends_no_higher_than_where_it_began(knob: str, motion: str) -> None:
    # Its detents are looked for anew, beside a joint that a search without them bends.
    model = kc.Model.load(knob).with_effect("backlash")
    joint = {"backlash.gap": 5e-3, "backlash.k": 500.0, "backlash.d": 0.05, "backlash.share": 0.7}
    for name, value in joint.items():
        model = model.with_value(name, value)
    capture = kc.simulate(model, motion, duration_s=3.0, seed=4)
    assert kc.fit(capture, model).rmse <= kc.fit(capture, model.frozen()).rmse


def test_a_stiff_shaft_that_friction_over_a_way_nearly_explains_is_the_shaft_and_that_friction_is_itself():
    for effect, seed, other in (("compliance", 472002, "presliding"), ("presliding", 472000, "compliance")):
        knob = hidden.make(seed, [effect])
        columns = {name.partition("_")[0]: column for name, column in knob.capture.items()}
        diagnosis = kc.fit(kc.Capture.from_arrays(**columns)).diagnose()
        assert diagnosis.best is not None and diagnosis.best.effect == effect
        assert other not in diagnosis.best.equivalent


def test_surfaces_that_bounce_are_found_where_others_that_stick_together_explain_most_of_it() -> None:
    knob = Stratum.parse("one/backlash:252000").make("turns")
    columns = {name: np.asarray(knob.capture[column][:10_000]) for name, column in NAMES.items()}
    play = kc.diagnose(kc.fit(kc.Capture.from_arrays(**columns)), only=["backlash"])["backlash"]
    # Damped thirtyfold, which passes any force on at once, they leave 1.07 times the noise and no gap.
    assert play.fit.rmse < 1.02 * play.fit.noise_floor and not play.implausible
    true = {f"backlash.{name}": knob.truth[of] for name, of in [("k", "stiffness"), ("d", "damping")]}
    assert {name: play.parameters[name].value for name in true} == pytest.approx(true, rel=0.2)
