"""What results say of themselves, of results of which everything is known."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from known import BASE, SAMPLES, Known, climbed, comparison, estimate, joint_of

import knobcam as kc
from knobcam.base.said import Said
from knobcam.fit import forward, refit
from knobcam.fit.absent import absent
from knobcam.fit.beyond import Beyond
from knobcam.fit.diagnose import Candidate, Diagnosis, p_in_words
from knobcam.fit.estimate import Z95
from knobcam.fit.rule import RULE
from knobcam.fit.stiction import Stiction, _estimate
from knobcam.learn import exchanged, headline, limitations
from knobcam.learn.cut import Cut
from knobcam.learn.ladder import Unexplained
from knobcam.learn.learning import LearningResult

LEFT = Unexplained("velocity", 0.4, "worst at there")


def learned(
    found: tuple[str, ...] = (),
    left: Unexplained | None = None,
    complete: bool = True,
    cut: Cut | None = None,
    best: Any = None,
    **fit: Any,
) -> LearningResult:
    """A search that came to an end of which all is known."""
    ladder = climbed(*((one, 3.0 - at) for at, one in enumerate(found)))
    ladder[-1] = replace(ladder[-1], fit=replace(ladder[-1].fit, **fit))
    last: Any = SimpleNamespace(comparison=comparison(complete), best=best)
    return LearningResult(tuple(ladder), found, last, left, cut)


def test_the_verdict_is_one_sentence_and_never_says_more_than_is_known(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(headline, "tells_nothing", lambda prepared: None)
    monkeypatch.setattr(headline, "within_rounding", lambda fit: None)
    cut = Cut("budget", 2.0, ("stribeck",))
    one, two = ("stribeck",), ("stribeck", "offset")
    told = [
        (
            learned(),
            "complete",
            "Nothing is missing that this capture could show: chance explains the error.",
        ),
        (learned(one), "missing", "stribeck was missing; with it the rest is chance."),
        (learned(two), "missing", "stribeck and offset were missing; with them the rest is chance."),
        (
            learned((), LEFT, False),
            "unexplained",
            "Something is missing that no effect of the catalogue explains: 40 %",
        ),
        (
            learned(one, LEFT, False),
            "unexplained",
            "stribeck found, and still something is missing that no effect",
        ),
        (
            learned(one, LEFT),
            "unexplained",
            "stribeck found, and still something is missing that no single effect",
        ),
        (
            learned(one, LEFT, False, best=SimpleNamespace(effect="offset", error_fall=0.163)),
            "unexplained",
            "stribeck found, and more is missing and not in the model yet: offset, which takes 16.3 % off",
        ),
        (
            learned((), LEFT, cut=cut),
            "unexplained",
            "Whether anything is missing is not known: the search was cut",
        ),
        (
            learned(one, LEFT, cut=cut),
            "unexplained",
            "stribeck found; whether anything more is missing is not known",
        ),
        (
            learned(one, LEFT, log_fault="turned round"),
            "unexplained",
            "The log or its map is to be mended first",
        ),
        (
            learned(one, LEFT, noise_floor=math.nan),
            "unexplained",
            "Whether anything is missing cannot be told: these",
        ),
        (
            learned((), LEFT, impossible=LEFT.hint),
            "unexplained",
            "The model leaves chance alone, but worst at there",
        ),
        (
            learned(one, LEFT, impossible=LEFT.hint),
            "unexplained",
            "stribeck found; the model leaves chance alone, but",
        ),
    ]
    for result, verdict, words in told:
        assert result.verdict == verdict and result.headline.startswith(words), words
    share = 100.0 * math.sqrt(8.0 / 91.0)
    law = (
        f"stribeck was missing; with it the rest, beside {share:.1f} % by which a law may be off, is chance."
    )
    assert learned(one, None, False).headline == law
    wrong = SimpleNamespace(core=SimpleNamespace(incoherent=(5.0, 9.0)), findings=())
    for found, begin in (((), "What is left"), (one, "stribeck found; what is left")):
        result = learned(found, LEFT, prepared=(wrong,))
        assert result.headline.startswith(
            f"{begin}, 40 % of it along velocity (worst at there), cannot be told"
        )


def test_what_the_torque_filter_takes_off_is_no_failure_of_the_model_and_is_said():
    beyond = Beyond("fast waves", "position", 0.4)
    left = Unexplained("position", 0.4, "fast waves")
    nothing = learned((), left, beyond=beyond)
    assert nothing.headline == (
        "Nothing is missing of what passes the torque filter: chance explains that. Not weighed: fast waves."
    )
    some = learned(("stribeck",), left, beyond=beyond)
    assert some.headline == (
        "stribeck was missing; with it what else passes the torque filter is chance. Not weighed: fast waves."
    )


def test_the_ladder_has_a_row_for_every_step_and_one_for_the_noise():
    result = learned(("stribeck", "offset"))
    last = replace(result.ladder[-1], dropped=("unbalance",), equivalent=("viscous", "karnopp"), p_value=0.02)
    result.ladder[1].__dict__["weights"] = {}
    last.__dict__["weights"] = {"offset": 0.75}
    result = replace(result, ladder=(*result.ladder[:-1], last))
    for step, fall in zip(result.ladder, (0.0, 0.7, 1.0 / 3.0), strict=True):
        object.__setattr__(step.fit, "error_fall", fall)
    first, second, third, noise = result.rows()
    assert first == ("first model", "10", "1", "", "", "", "")
    assert second[:4] == ("+ stribeck", "3", "1", "-70.0 %") and second[6] == ""
    assert third == ("+ offset - unbalance", "2", "1", "-33.3 %", "0.020", "75.0 %", "viscous, karnopp")
    assert noise == ("sensor noise alone", "1", "", "", "", "", "")
    assert len(result.head) == len(first) and result.head[1] == "RMS error (N m)"
    # Bars are as long as errors, the longest 24 characters, and noise is dotted.
    assert result._bars() == ["#" * 24, "#" * 7, "#" * 5, ".."]
    assert learned((), noise_floor=math.nan)._bars() == ["#" * 24, ""]


def candidate(effect: str, rmse: float, word: Any, p_value: float = 0.0004, **more: Any) -> Candidate:
    fit: Any = Known(rmse, (*BASE, effect), rmse_heldout=0.5)
    object.__setattr__(fit, "error_fall", 1.0 - rmse / 2.0)
    object.__setattr__(fit, "compare", lambda: SimpleNamespace(summary="The rest is chance.", complete=True))
    return Candidate(effect, fit, p_value, 100.0, 2, word=word, said=Said(str(word)), **more)


def diagnosed(*candidates: Candidate, **left_out: str) -> Diagnosis:
    fit: Any = Known(2.0, rmse_heldout=1.0)
    object.__setattr__(fit, "compare", lambda: SimpleNamespace(summary="It fails.", complete=False))
    return Diagnosis(fit, candidates, left_out)


def test_a_diagnosis_names_the_best_and_why_it_names_none():
    spring = candidate("return_spring", 1.0, "missing", equivalent=("unbalance",))
    drag = candidate("quadratic_drag", 1.5, "part")
    little, other = candidate("stribeck", 1.9, "too_little"), candidate("offset", 1.9, "too_little")
    chance, wrong = candidate("offset", 2.0, "chance", 0.4), candidate("offset", 1.0, "implausible")
    for best, words in (
        (spring, "It fails. Missing first of all: return_spring or unbalance (error -50.0 %)."),
        (drag, "It fails. A part of what is missing: quadratic_drag (error -25.0 %)."),
    ):
        assert diagnosed(chance, best, little).best is best and diagnosed(chance, best).summary == words
    untold = candidate("offset", 2.0, "untold")
    for none, why in (
        ((untold, little), "Without the noise, what is missing cannot be told from chance."),
        ((chance,), "No effect of the catalogue lowers this error beyond chance."),
        (
            (wrong, chance),
            "No effect of the catalogue that could be missing lowers this error beyond chance.",
        ),
        (
            (little, chance),
            "No effect of the catalogue is the cause: 1 effect takes off some of it, but too little.",
        ),
        (
            (little, other),
            "No effect of the catalogue is the cause: 2 effects take off some of it, but too little.",
        ),
    ):
        assert diagnosed(*none).best is None and diagnosed(*none).summary == f"It fails. {why}"


def test_a_diagnosis_lists_what_could_be_before_what_could_not():
    spring = candidate("return_spring", 1.0, "missing", equivalent=("unbalance",))
    chance = candidate("torque_lag", 2.0, "chance", 0.4, note="as expected")
    both = diagnosed(spring, chance, backlash="errors of the motion look like it")
    # On unseen blocks the error falls from 1 to a half.
    assert both.rows([spring]) == [
        ("return_spring", "load", "-50.0 %", "-50.0 %", "<= 0.001", "missing; cannot be told from unbalance")
    ]
    assert both.rows([chance])[0][1:] == ("sensor", "+0.0 %", "-50.0 %", "0.400", "chance; as expected")
    lines = repr(both).splitlines()
    at = [
        next(i for i, line in enumerate(lines) if line.startswith(one))
        for one in ("Could", "Too", "Left", "With")
    ]
    assert at == sorted(at) and lines[0] == both.summary and "remarks" in lines[at[0] + 1]
    assert any("return_spring" in line for line in lines[at[0] + 2 : at[1]])
    assert "torque_lag" in lines[at[1] + 1] and "remarks" not in lines[at[1] + 1]
    assert lines[at[2]] == "Left out: backlash: errors of the motion look like it"
    assert lines[at[3]] == "With return_spring: The rest is chance." and both.remaining.complete
    none = repr(diagnosed(chance)).splitlines()
    assert none[1] == "Could be missing: nothing" and "remarks" in none[3] and not none[-1].startswith("With")
    could, could_not = both.tables()
    assert [row[0] for row in could.rows] == ["return_spring"] and [row[0] for row in could_not.rows] == [
        "torque_lag"
    ]
    assert both["torque_lag"] is chance and both.could_be == (spring,) == both.beyond_chance


def test_chance_is_said_in_three_figures_and_as_a_bound_where_its_draws_tell_no_less():
    said = [p_in_words(p_value) for p_value in (9.99e-4, 1e-3, 0.0021, 0.25)]
    assert said == ["<= 0.001", "<= 0.001", "0.002", "0.250"]


def fitted(effects: tuple[str, ...], free: tuple[str, ...], incoherent: Any = None, unit: str = "N m") -> Any:
    params = {name: SimpleNamespace(role="free") for name in free}
    one = SimpleNamespace(core=SimpleNamespace(incoherent=incoherent))
    model = {"coordinate": "rotary", "torque_unit": unit, "params": params, "catalogue": kc.effects}
    model |= {"effects": effects, "joint": joint_of(effects)}
    return SimpleNamespace(model=SimpleNamespace(**model), prepared=(one,))


def test_what_cannot_be_weighed_is_left_out_with_the_reason():
    catalogue = kc.effects()
    could, why = absent(fitted(BASE, ()), ("stribeck",))
    searched = {one for one, row in catalogue.items() if not row.unsearched}
    assert {*could, *why} == searched - {*BASE, "stribeck"} and not set(could) & set(why)
    harmonic = "detent_harmonics"
    assert why[harmonic] == "it changes 'detent', which the model does not have"
    assert harmonic in absent(fitted((*BASE, "detent"), ()), ())[0]
    # Two couplings cannot be told apart; nor can what is no load where the motion is wrong.
    joined = absent(fitted((*BASE, "backlash"), ()), ())[1]
    assert [one for one in joined if catalogue[one].place == "coupling"] == ["compliance"]
    wrong = absent(fitted(BASE, (), (5.0, 9.0)), ())[0]
    assert {catalogue[one].place for one in wrong} == {"load"} and "quadratic_drag" in wrong
    taken = {one: row.taken_up for one, row in catalogue.items() if row.taken_up is not None}
    for one, by in taken.items():
        if one not in BASE:
            assert absent(fitted(BASE, tuple(by.by)), ())[1][one] == by.why
            assert absent(fitted(BASE, tuple(by.by)[1:]), ())[1].get(one) != by.why
    # What a motor is given as a voltage was not measured by anything that drifts; a current was.
    given = [absent(fitted(BASE, (), unit=unit), ())[1].get("torque_drift") for unit in ("V", "duty", "A")]
    assert given[0] == given[1] == catalogue["torque_drift"].given and given[2] is None


def test_the_error_of_a_static_friction_is_that_of_its_interval():
    assert _estimate(None, "N m") is None
    found = _estimate((0.05, 0.04, 0.07), "N m")
    assert found is not None and (found.value, found.ci95, found.unit) == (0.05, (0.04, 0.07), "N m")
    assert found.se == pytest.approx(0.03 / (2.0 * Z95))
    fit: Any = SimpleNamespace(prepared=(), rmse=1.0, noise_floor=1.0)
    sticks = Stiction(fit, found, None, None, (4, 1))
    assert not sticks.determined and repr(sticks).splitlines()[0] == "Stiction from 5 breakaways"
    assert "karnopp.D_neg" in repr(sticks) and "karnopp.D_pos" not in repr(sticks)
    assert sticks.missing[0].startswith("1 breakaways forward, and 3 are needed") and len(sticks.missing) == 2
    none = Stiction(fit, None, None, None, (0, 0))
    assert repr(none).splitlines() == ["Stiction from 0 breakaways", *none.missing] and len(none.missing) == 3
    assert none._rows() == [] and none.document()["params"] == {}
    for rmse, loud in ((1.09, False), (1.11, True)):
        whole = Stiction(SimpleNamespace(**{**vars(fit), "rmse": rmse}), found, found, found, (4, 4))  # type: ignore[arg-type]
        assert whole.determined and any("times the noise floor" in one for one in whole.missing) == loud
    still = _estimate((0.01, 0.0, 0.02), "rad/s")
    assert any(
        "the true band may be wider" in one for one in Stiction(fit, found, found, still, (4, 4)).missing
    )


def test_what_a_simulated_motion_explains_is_of_the_measured_positions_variance():
    def run(error: Any, measured: Any) -> Any:
        counts = np.ones(len(measured), dtype=bool)
        return SimpleNamespace(error=np.array(error), measured=np.array(measured), counts=counts)

    # Of a variance of 4 and 1 over two samples each an error of 1 is left.
    runs = [run([1.0, 0.0], [0.0, 4.0]), run([0.0, 0.0], [1.0, 3.0])]
    assert forward.Forward._r2(runs) == pytest.approx(1.0 - 1.0 / 10.0)
    assert forward.Forward._rmse(runs) == pytest.approx(0.5)
    assert math.isnan(forward.Forward._r2([run([1.0, 0.0], [2.0, 2.0])]))


def test_the_torque_of_a_knob_is_called_so_and_an_effect_comes_in_with_its_fit():
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.01)
    bare = kc.fit(kc.simulate(knob, "multisine", duration_s=3.0, seed=3))
    sprung = bare.add("return_spring")
    assert sprung.before is bare and sprung.params["return_spring.k"].value == pytest.approx(0.01, rel=0.1)
    assert sprung.rmse < 0.9 * bare.rmse and sprung.model.effects == (*bare.model.effects, "return_spring")
    # An interval lies about its value, as wide as its error says; a sound log has no findings.
    for one in sprung.params.values():
        assert one.ci95 == pytest.approx((one.value - Z95 * one.se, one.value + Z95 * one.se), nan_ok=True)
    assert sprung.document()["findings"] == []
    said = sprung.forward().summary
    assert said.startswith("Position simulated from the measured torque: RMSE ") and said.endswith(
        "open loop from the measured state at the start."
    )
    asked: list[float] = []
    refit.add(bare, "offset", asked.append)
    assert asked


def test_motion_shows_where_a_torque_that_needs_it_is_sure():
    def of(**values: tuple[float, float, str]) -> Any:
        params = {}
        for name, (value, se, unit) in values.items():
            params[name.replace("__", ".")] = estimate(value, se)._replace(unit=unit)
        return SimpleNamespace(
            model=SimpleNamespace(coordinate="rotary", catalogue=kc.effects), params=params
        )

    still = {"coulomb__pos": (1.0, 0.01, "N m")}
    for value, sure in ((3.1, True), (2.9, False), (-3.1, True)):
        assert limitations._stands_out(of(**still, viscous__pos=(value, 1.0, "N m s/rad"))) == sure
    # What does not need motion, or is not of the base model, says nothing of it.
    assert limitations._stands_out(of(**still))
    assert limitations._stands_out(of(quadratic_drag__d=(0.0, 1.0, "N m s^2/rad^2")))
    assert not limitations._stands_out(
        of(**still, inertia__M=(9.0, math.inf, "kg m^2"), viscous__pos=(0.0, 1.0, "N m s"))
    )


def test_sets_are_weighed_of_what_came_in_and_of_the_best_that_did_not(monkeypatch: pytest.MonkeyPatch):
    asked: list[Any] = []
    monkeypatch.setattr(exchanged, "cores", lambda fit: [])
    monkeypatch.setattr(exchanged, "converged", lambda fit: fit)
    monkeypatch.setattr(exchanged, "replace", lambda fit, core=None, **more: replace(core or fit, **more))
    monkeypatch.setattr(exchanged, "_steps", lambda fit, names, *_: [fit, *names])

    def of(sets: list[Any], complete: bool = False, *found: str) -> Any:
        ladder = climbed(*((one, 2.0 - 0.5 * at) for at, one in enumerate(found)))
        weighed = [
            SimpleNamespace(
                effect=one, score=score, fit=Known(1.5), beyond_chance=beyond, implausible=(), place=place
            )
            for one, score, beyond, place in (
                ("return_spring", 50.0, True, "load"),
                ("unbalance", 90.0, True, "load"),
                ("offset", 99.0, False, "load"),
                ("backlash", 99.0, True, "coupling"),
            )
        ]
        for step in ladder[1:]:
            step.diagnosis.__dict__["candidates"] = weighed  # type: ignore[union-attr]

        def core_sets(_: Any, first: Any, models: Any, most: int, progress: Any) -> Any:
            asked.append(([name for name, _ in models], most))
            return sets

        monkeypatch.setattr(exchanged._core, "sets", core_sets)
        return exchanged.exchanged(ladder, comparison(complete), lambda _: None)

    two = ("stribeck", "quadratic_drag")
    better = (["unbalance", "stribeck"], Known(1.2, (*BASE, "unbalance", "stribeck")))
    worse = (["unbalance", "stribeck"], Known(1.6, (*BASE, "unbalance", "stribeck")))
    assert of([better], False, *two)[1:] == better[0]
    # Those that came in first, then by what they take off; more than noise is left for three.
    assert asked[-1] == ([*two, "unbalance", "return_spring"], 3)
    assert of([worse], True, *two) is None and asked[-1][1] == 2
    # What it has already is the best: nothing is exchanged, whatever comes after.
    assert of([(list(two), Known(1.0)), better], False, *two) is None
    count = len(asked)
    assert of([better], False, "stribeck") is None and of([better], False, "stribeck", "backlash") is None
    assert len(asked) == count
    # What explains as much, but for less than its parameters' price, is no better.
    price = Known(math.sqrt(1.5**2 - 1e-3), (*BASE, "unbalance", "stribeck"))
    assert of([(better[0], price)], False, *two) is None
    # Of one name that explains as much, to the price of a parameter, it is the other way round.
    for left, taken in ((0.5, True), (1.5, False)):
        off = (1.0 + left) * RULE.price / SAMPLES  # it has a parameter less
        alone = (["unbalance"], Known(math.sqrt(1.5**2 + off), (*BASE, "unbalance")))
        assert (of([(list(two), Known(1.5)), alone], False, *two) is not None) == taken


def test_what_could_be_in_the_place_of_a_name_is_said_with_it_unless_it_came_in_too():
    story = learned(("stribeck", "offset"))
    tied = [replace(one, equivalent=("presliding", "offset")) for one in story.ladder[1:]]
    story = replace(story, ladder=(story.ladder[0], *tied))
    assert story.headline == (
        "stribeck (or presliding) and offset (or presliding) were missing; with them the rest is chance."
    )
