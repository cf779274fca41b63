"""The loop ends in a verdict that the evidence supports, and says what a capture cannot tell."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest
from carried import carried
from small import COUPLINGS

import knobcam as kc
from knobcam.fit.refit import gain, needed
from knobcam.learn import earlier
from knobcam.learn.limitations import limitations


@pytest.fixture(scope="module")
def brief(sprung: kc.Capture) -> kc.Capture:
    """The same knob in fewer samples, for searches of which only a word is asked."""
    knob = kc.Model.parse(sprung.meta["model"])
    return kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0)


def test_the_hidden_spring_is_found_and_the_rest_is_chance(story: kc.LearningResult) -> None:
    assert story.verdict == "missing"
    assert len(story.found) == 1
    last = story.ladder[-1]
    assert "return_spring" in (*story.found, *last.equivalent)
    assert story.fit.rmse == pytest.approx(story.noise_floor, rel=0.05)
    assert story.headline.startswith(f"{story.found[0]} was missing")


def test_the_ladder_starts_at_the_base_model_and_goes_down(story: kc.LearningResult) -> None:
    assert story.ladder[0].added is None
    assert story.ladder[0].effects == ("inertia", "coulomb", "viscous", "detent")
    errors = [step.rmse for step in story.ladder]
    assert errors == sorted(errors, reverse=True)
    for above, step in zip(story.ladder, story.ladder[1:], strict=False):
        assert step.error_fall == pytest.approx(1.0 - step.rmse / above.rmse)
        assert step.fit.before is above.fit


def test_the_interval_of_an_error_holds_it_and_narrows_with_the_capture() -> None:
    knob = kc.Model.load("knob4")
    widths = []
    for duration in (3.0, 12.0):
        step = kc.LearningStep(kc.fit(kc.simulate(knob, "multisine", duration_s=duration)))
        low, high = step.rmse_ci95
        assert low < step.rmse < high
        widths.append(high - low)
    assert widths[1] < 0.75 * widths[0]


def test_a_knob_with_nothing_missing_is_complete(capture: kc.Capture) -> None:
    story = kc.learn(capture)
    assert (story.verdict, story.found, story.unexplained) == ("complete", (), None)
    assert len(story.ladder) == 1 and story.limitations == ()
    assert story.headline == "Nothing is missing that this capture could show: chance explains the error."
    assert story.record is None


def test_hum_in_the_torque_is_unexplained_and_its_line_is_named() -> None:
    capture = kc.simulate("knob4", "sweep", duration_s=3.0, rate_hz=1000.0)
    hum = dataclasses.replace(capture, tau=capture.tau + 2e-3 * np.sin(2.0 * np.pi * 50.0 * capture.t))
    story = kc.learn(hum)
    assert story.verdict == "unexplained" and story.found == ()
    assert story.unexplained is not None
    [line] = re.findall(r"line at ([\d.]+) Hz", story.unexplained.hint)
    assert story.unexplained.axis == "time" and float(line) == pytest.approx(50.0, abs=0.5)
    assert story.unexplained.share > 0.5
    assert "no effect of the catalogue explains" in repr(story)
    assert story.record is not None and "standing still with the drive on" in story.record


def test_detents_belong_to_the_base_model_also_where_they_come_in_late(brief: kc.Capture) -> None:
    without_detents = kc.learn(brief, detents="no", without=COUPLINGS)
    assert "detent" in [step.added for step in without_detents.ladder]
    assert "detent" not in without_detents.found
    bare = kc.Model.of(["inertia", "coulomb", "viscous"])
    assert "detent" in kc.learn(brief, bare, without=COUPLINGS).found


def test_a_model_that_has_the_effect_is_complete(brief: kc.Capture) -> None:
    story = kc.learn(brief, kc.Model.parse(brief.meta["model"]))
    assert (story.verdict, story.found) == ("complete", ())


def test_friction_that_goes_up_and_down_within_a_part_of_its_period_is_found() -> None:
    story = kc.learn(kc.simulate(kc.hiding("knob3", "position_friction"), "sweep", seed=3, rate_hz=2000.0))
    assert (story.verdict, story.found) == ("missing", ("position_friction",))


def test_a_harmonic_of_many_detents_and_an_unbalance_are_told_apart() -> None:
    knob = kc.hiding("knob4", "detent_harmonics", "unbalance")
    story = kc.learn(kc.simulate(knob, "turns", seed=3, duration_s=6.0, rate_hz=1000.0))
    assert story.verdict == "missing"
    assert set(story.found) == {"detent_harmonics", "unbalance"}


def test_an_effect_that_is_gone_already_is_not_tested_again(capture: kc.Capture) -> None:
    bare = kc.fit(capture, detents="no").drop("viscous")
    fit, dropped = earlier.retested(bare, ["detent", "viscous"])
    assert fit is bare and dropped == ()


def test_what_an_effect_is_worth_at_least_is_told_without_a_fit_that_lacks_it(sprung: kc.Capture) -> None:
    fit = kc.fit(sprung).add("return_spring")
    took = gain(fit.drop("return_spring"), fit, fit)
    assert 0.3 * took < fit.core.worth("return_spring") < 1.02 * took
    assert needed(fit, "return_spring") and fit.core.worth("backlash") == 0.0
    assert not needed(fit.add("quadratic_drag"), "quadratic_drag")


def test_an_effect_left_out_of_the_catalogue_is_never_found(brief: kc.Capture) -> None:
    story = kc.learn(brief, without=["return_spring", *COUPLINGS])
    assert "return_spring" not in story.found and story.without == ("return_spring", *COUPLINGS)
    with pytest.raises(kc.InputError, match="without: effect 'magic'"):
        kc.learn(brief, without=["magic"])


def test_each_step_is_told_while_it_runs(brief: kc.Capture) -> None:
    told: list[str] = []
    story = kc.learn(brief, progress=told.append, without=COUPLINGS)
    assert told[0] == "fitting the first model"
    assert any(story.found[0] in step for step in told)


def test_the_document_is_that_of_the_contract(story: kc.LearningResult) -> None:
    document = story.document()
    keys = {"schema", "capture", "noise_floor", "verdict", "found", "ladder", "unexplained"}
    assert keys <= document.keys() and document["schema"] == "knobcam.learn/1"
    assert {"path", "samples", "duration_s", "sample_rate_hz"} <= document["capture"].keys()
    first, last = document["ladder"][0], document["ladder"][-1]
    assert first["added"] is None and "p_value" not in first
    assert {"added", "effects", "rmse", "rmse_heldout", "params"} <= first.keys()
    assert {"error_fall", "p_value", "equivalent", "moved"} <= last.keys()
    assert last["params"].keys() == story.fit.params.keys()
    assert last["moved"]["inertia.M"].keys() == {"by_se", "by_percent", "by"}
    period = last["params"]["detent.P"]
    assert period["ci95"][0] < period["value"] < period["ci95"][1] and period["unit"] == "rad"
    json.dumps(document)


def test_a_story_tells_itself_in_the_terminal(story: kc.LearningResult) -> None:
    lines = repr(story).splitlines()
    assert lines[0] == story.headline
    bars = [line.count("#") for line in lines if "#" in line]
    assert len(bars) == len(story.ladder) and bars[0] > 2 * bars[-1]
    dots = next(line for line in lines if "sensor noise alone" in line).count(".....")
    assert dots >= 1
    assert repr(story).isascii()
    assert "<table>" in story._repr_html_()


def kinds(story: kc.LearningResult) -> set[str]:
    for one in story.limitations:
        assert one.message in repr(story) and one.record in repr(story)
    assert [one["kind"] for one in story.document()["limitations"]] == [one.kind for one in story.limitations]
    return {one.kind for one in story.limitations}


def track(omega: np.ndarray, rate: float = 5000.0) -> kc.MotionTrack:
    t = np.arange(1, len(omega) + 1) / rate
    return kc.MotionTrack(t, np.cumsum(omega) / rate, omega, np.gradient(omega) * rate)


def test_a_motion_in_one_direction_tells_nothing_of_the_other_nor_of_reversals() -> None:
    t = np.arange(1, 15001) / 5000.0
    story = kc.learn(kc.simulate(kc.Model.load("knob4"), track(3.0 + 2.5 * np.sin(4.0 * t))))
    assert {"no_reversal", "one_direction"} <= kinds(story)
    assert "friction backward" in " ".join(one.message for one in story.limitations)


def test_a_motion_that_is_never_slow_shows_no_friction_near_standstill() -> None:
    t = np.arange(1, 15001) / 5000.0
    story = kc.learn(kc.simulate(kc.Model.load("knob4"), track(5.0 + np.sin(4.0 * t))))
    assert "no_slow_motion" in kinds(story)


def test_less_than_a_detent_and_less_than_a_second_are_named() -> None:
    small = kc.learn(kc.simulate(kc.Model.load("knob4"), "micro", duration_s=0.8))
    assert {"too_short", "less_than_one_detent"} <= kinds(small)
    assert small.verdict != "missing" or small.ladder[-1].p_value <= 0.05


def test_a_slow_motion_tells_neither_inertia_nor_viscous_friction() -> None:
    slow = kc.motion("micro", amplitude=0.3, frequency_hz=0.1)
    assert "too_slow" in kinds(kc.learn(kc.simulate(kc.Model.load("knob2"), slow)))


@pytest.mark.parametrize(("rates_hz", "told"), [((1.0,), False), ((1.0, 3.0), True)])
def test_swings_at_one_rate_tell_no_inertia_from_a_spring(rates_hz: tuple[float, ...], told: bool) -> None:
    t = np.arange(1, 15001) / 5000.0
    omega = np.sum([0.5 * np.cos(2.0 * np.pi * rate * t) for rate in rates_hz], axis=0)
    fit = kc.fit(kc.simulate(kc.hiding("knob2", "return_spring"), track(omega)))
    # Of what is not in the model nothing is said.
    assert "one_rate" not in {one.kind for one in limitations(fit)}
    said = {one.kind for one in limitations(fit.add("return_spring"))}
    assert ("one_rate" not in said) is told


@pytest.mark.parametrize(("knob", "effect"), [("knob2", "return_spring"), ("knob3", "torque_drift")])
def test_a_sweep_is_not_called_slow_because_the_model_is_wrong(knob: str, effect: str) -> None:
    fit = kc.fit(kc.simulate(kc.hiding(knob, effect), "sweep"))
    swift = [e for name, e in fit.params.items() if name.startswith(("inertia", "viscous"))]
    assert fit.rmse > 2.0 * fit.noise_floor and all(abs(e.value) < 3.0 * e.se for e in swift)
    assert "too_slow" not in {one.kind for one in limitations(fit)}


def test_one_speed_alone_is_called_too_even_whatever_the_model() -> None:
    t = np.arange(1, 15001) / 5000.0
    fit = kc.fit(kc.simulate(kc.hiding("knob3", "unbalance"), track(np.full_like(t, 2.0))))
    (said,) = [one.message for one in limitations(fit) if one.kind == "too_slow"]
    assert "speeds of 2 to 2 rad/s" in said


def test_without_a_noise_floor_there_is_neither_an_accusation_nor_an_all_clear() -> None:
    story = kc.learn(kc.simulate(kc.Model.load("knob4"), "sweep", rate_hz=25.0), prepare="none")
    assert "no_noise_floor" in kinds(story)
    assert (story.verdict, story.found) == ("unexplained", ())
    assert "cannot be told" in story.headline


@pytest.mark.parametrize("motion", ["sweep", "multisine", "hand", "turns"])
def test_an_ordinary_motion_lacks_nothing(motion: str) -> None:
    knob = kc.Model.load("knob4")
    lacking = {one.kind for one in kc.learn(kc.simulate(knob, motion, rate_hz=1000.0)).limitations}
    assert lacking <= ({"no_slow_motion"} if motion == "turns" else set())


@pytest.mark.parametrize("knob", ["knob1", "knob3"])
def test_a_torque_with_the_other_sign_is_a_fault_of_the_log_and_nothing_is_accused(knob: str) -> None:
    run = kc.simulate(kc.hiding(knob, "stribeck"), "sweep", rate_hz=1000.0)
    columns = {name: values for name, values in run.columns.items() if name != "tau"}
    learned = kc.learn(kc.Capture.from_arrays(**columns, tau=-run.tau))
    assert (learned.verdict, learned.found) == ("unexplained", ())
    assert [finding["kind"] for finding in learned.document()["findings"]] == ["sign"]
    assert "minus" in learned.headline


def test_captures_of_one_knob_agree_and_those_of_a_changed_one_do_not(tmp_path: Path) -> None:
    knob = kc.Model.load("knob4")
    changed = knob.with_value("detent.P", 0.077)
    first, again, other = (
        kc.simulate(one, motion, seed=seed, duration_s=3.0, rate_hz=1000.0)
        for seed, (one, motion) in enumerate([(knob, "sweep"), (knob, "multisine"), (changed, "multisine")])
    )
    assert kc.learn([first, again], without=COUPLINGS).disagreements == ()
    other = dataclasses.replace(other, meta={"source": "changed.npz"})
    story = kc.learn([first, other], without=COUPLINGS)
    worst = story.disagreements[0]
    assert worst.by_se > 10.0
    assert f"{worst.param} is" in repr(story) and "in changed.npz" in repr(story)
    assert story.document()["disagreements"][0]["param"] == worst.param
    # A report says which parameter by what it is; and its plots know that they are of several captures.
    html = story.report(tmp_path / "two.html").read_text("utf-8")
    there = html.partition("Where the captures disagree")[2].partition("</ul>")[0]
    assert " in changed.npz, " in there and not any(name in there for name in story.params)
    assert carried(html)["captures"] == 2


def test_one_capture_agrees_with_itself(story: kc.LearningResult) -> None:
    assert story.disagreements == ()


def test_limitations_are_found_under_their_old_name_too(story: kc.LearningResult) -> None:
    with pytest.warns(DeprecationWarning, match="lacks is now called limitations"):
        assert story.lacks == story.limitations
    assert story.document()["lacks"] == story.document()["limitations"]


def test_a_model_with_less_than_no_inertia_is_no_all_clear_however_little_it_leaves() -> None:
    rng, t = np.random.default_rng(5), np.arange(6000) / 1000.0
    omega = 3.0 * np.pi * np.cos(3.0 * np.pi * t)
    theta, alpha = np.sin(3.0 * np.pi * t), -((3.0 * np.pi) ** 2) * np.sin(3.0 * np.pi * t)
    # At one frequency a spring is an inertia below zero, and here it is the stronger.
    tau = (
        0.02 * theta + 2e-3 * np.sign(omega) + 2e-4 * omega + 5e-5 * alpha + 1e-3 * rng.standard_normal(6000)
    )
    seen = theta + 1e-5 * rng.standard_normal(6000)
    story = kc.learn(kc.Capture.from_arrays(t=t, theta=seen, tau=tau))
    document = story.document()
    assert (story.verdict, story.found) == ("unexplained", ())
    assert "inertia.M came out negative" in document["headline"]
    assert "inertia.M" in document["unexplained"]["hint"]
    assert any("more than one frequency" in warning for warning in document["warnings"])
