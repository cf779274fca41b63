"""Kept answers: small captures go through all that Python decides, and all numbers and words are those kept.

A test that fails here says that answers changed, not that they are wrong: look at what changed, and where it
is meant, make the files anew and commit them with the reason.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from answers import Answers
from small import COUPLINGS, RATE_HZ, WAVES, Torque, detents, recorded, rises
from test_constants import FORMULA, FREE, INERTIA, MAP, motor

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fit import power, refit
from knobcam.learn import cut

LITTLE = 12.0  # how much less takes off hangs on where its search ended
HARDLY = 0.02  # of what the best explains: a joint that does less ends in another dent on another processor
SAID_ELSEWHERE = ("captures", "capture", "findings", "candidates", "correlation", "params", "ladder", "axes")
OF_THE_CATALOGUE = ("place", "law", "source", "shows", "confused", "name", "about", "causes", "remedies")
OF_THE_CATALOGUE += ("latex", "over", "section", "friction")


def without(document: dict[str, Any], *names: str) -> dict[str, Any]:
    return {key: own for key, own in document.items() if key not in names}


def all_but(*few: str) -> list[str]:
    """What else would draw the same, or takes long."""
    return [one for one in kc.effects("rotary") if one not in few]


def sure(fit: kc.Fit) -> bool:
    """Whether a fit tells its parameters apart: the values of those that it does not hang on rounding."""
    correlation = np.abs(fit.core.correlation)
    return not fit.undetermined and bool(np.all(correlation[~np.eye(len(correlation), dtype=bool)] < 0.995))


def searched(name: str, captures: kc.Capture | list[kc.Capture], **how: Any) -> kc.LearningResult:
    """Keep the whole way of captures to a verdict, and what is said of the last fit."""
    told = Answers(name)
    story = kc.learn(captures, **how)
    document = story.document()
    told.put("learned", without(document, "ladder"))
    told.put("head", [*story.head, story.headline])
    told.put("rows", [list(row) for row in story.rows()])
    told.put("printed", repr(story).splitlines())
    for step in story.ladder:
        fitted(told, f"step {step.added}", step.fit)
        told.put("  interval", [*step.rmse_ci95])
        told.put("  weight", step.weights)
    told.put("ladder", [without(one, "params", "moved") for one in document["ladder"]])
    compared(told, "before", story.before)
    compared(told, "after", story.after)
    diagnosed(told, "first", story.first_diagnosis)
    diagnosed(told, "last", story.last)
    told.done()
    return story


def fitted(told: Answers, name: str, fit: kc.Fit) -> None:
    document = fit.document()
    told.put(f"{name} fit", without(document, *SAID_ELSEWHERE, "iterations", "evaluations"))
    told.put("  warnings", [*fit.warnings, fit.torque_unit, fit.excess, fit.error_fall, *(fit.beyond or ())])
    if not sure(fit):
        return
    told.put("  values", document["params"])
    told.put("  rows", [list(row) for row in fit.rows()])
    told.put("  printed", repr(fit).splitlines())
    told.put("  moved", {key: list(one) for key, one in fit.moved.items()})
    told.put("  residual", fit.residual)
    if fit.before is not None:
        fewer = [refit.unpaid(fit, fit.before), refit.needless(fit, fit.before), *refit.worse(fit)]
        told.put("  worth it", [refit.gain(fit.before, fit, fit), *fewer])
        told.put("  in words", refit.in_words(fit))


def compared(told: Answers, name: str, comparison: kc.Comparison) -> None:
    for split in comparison.document()["axes"]:
        told.put(
            f"{name} {split['axis']}", {k: v for k, v in split.items() if isinstance(v, str | float | bool)}
        )
    told.put(f"{name} says", [comparison.summary, comparison.origin, comparison.held_out])
    told.put(f"{name} printed", repr(comparison).splitlines())
    told.put(f"{name} shares", [split.mean_share for split in comparison.splits])
    told.put(f"{name} judged", list(comparison.judged[:4]))
    told.put(f"{name} figures", [list(one) for one in (comparison.figures, *comparison.by_capture)])


def diagnosed(told: Answers, name: str, diagnosis: kc.Diagnosis) -> None:
    told.put(name, without(diagnosis.document(), *SAID_ELSEWHERE))
    told.put("  printed", [line for line in repr(diagnosis).splitlines() if not line.startswith("  ")])
    most = max((one.gain for one in diagnosis.candidates), default=0.0)
    for one in sorted(diagnosis.candidates, key=lambda one: one.effect):
        if one.place == "coupling" and one.gain < HARDLY * most:
            told.put(f"{name} {one.effect}", "hardly")
            continue
        told.put(f"{name} {one.effect}", [one.word, one.place, one.beyond_chance, one.could_be, one.count])
        if one.gain < LITTLE:
            continue
        told.put("  evidence", {"gain": one.gain, "p_value": one.p_value, "score": one.score})
        if one.fit is not None and sure(one.fit):
            told.put("  document", without(one.document(), *OF_THE_CATALOGUE))
            told.put("  remarks", [one.remarks, *one.implausible])


def test_of_nothing_that_is_missing_in_coloured_noise() -> None:
    searched("nothing", recorded(1, colour=0.7))


def test_of_two_effects_at_once() -> None:
    searched("two", recorded(2, rises))


def test_of_detents_with_a_harmonic_counted_from_elsewhere() -> None:
    one, other = recorded(3, detents), recorded(4, detents, waves=((0.8, 4.3), (0.3, 11.0)))
    moved = dataclasses.replace(other, theta=other.theta + 0.37, omega=None, alpha=None)
    searched("detents", [one, moved])


def test_of_runs_that_differ() -> None:
    def pulled(by: float) -> Torque:
        return lambda t, theta, *_: 5e-3 * theta + by

    other = recorded(6, pulled(-3e-3), waves=((0.8, 4.3), (0.3, 11.0)))
    few = all_but("return_spring", "stribeck", "friction_drift", "quadratic_drag", "load_friction")
    searched("differ", [recorded(5, pulled(2e-3)), other], without=few)


def test_of_a_hum_that_no_effect_explains() -> None:
    searched("hum", recorded(7, lambda t, *_: 3e-3 * np.sin(2.0 * np.pi * 50.0 * t)))


def test_of_friction_that_warms_up_on_a_slide_at_its_sensors_limit() -> None:
    capture = recorded(
        8, lambda t, theta, omega, _: 6e-3 * np.sign(omega) * np.exp(-t / 0.7), coordinate="linear"
    )
    searched("slide", dataclasses.replace(capture, tau=np.clip(capture.tau, -0.03, 0.03)))


def test_of_a_knob_whose_friction_gives_and_whose_torque_is_turned_round() -> None:
    gives = recorded(9, lambda t, theta, omega, _: -25e-3 * np.sign(omega) - 2e-3 * omega)
    told = Answers("gives")
    for name, sign in (("gives", 1.0), ("reversed", -1.0)):
        fit = kc.fit(dataclasses.replace(gives, tau=sign * gives.tau))
        fitted(told, name, fit)
        told.put(f"{name} gives back", [power.gives_back(fit.prepared), fit.log_fault, fit.impossible])
        compared(told, name, fit.compare())
        diagnosed(told, name, fit.diagnose(only=["return_spring", "stribeck", "offset", "friction_drift"]))
    # As much forth as back: what it takes cannot be read off where it ends.
    even = ((0.9, 2.0 * np.pi), (0.3, 6.0 * np.pi))
    for name, sign in (("takes", 1.0), ("gives", -1.0)):
        capture = recorded(22, count=3000, waves=even)
        turned = kc.fit(dataclasses.replace(capture, tau=sign * capture.tau)).prepared
        told.put(f"forth and back {name}", [power.gives_back(turned)])
    told.done()


def test_of_a_slow_angle_alone_one_way() -> None:
    capture = recorded(10, waves=((4.0, 0.5),), count=3000, sensors=False)
    searched("slow", capture)


def test_of_a_torque_that_comes_late() -> None:
    late = recorded(11, detents)
    searched("late", dataclasses.replace(late, tau=np.roll(late.tau, 6)), without=COUPLINGS)


def test_of_a_motor_by_its_current() -> None:
    waves = ((3.5, 3.1), (0.3, 9.7))
    cogs = recorded(
        12, lambda t, theta, *_: 8e-3 * np.sin(12.0 * theta + 0.4) + 5e-3 * np.cos(24.0 * theta), waves=waves
    )
    motor = kc.Capture.from_arrays(t=cogs.t, theta=cogs.theta, tau=cogs.tau / 0.03, torque_unit="A")
    searched("motor", motor)


def joined(count: int) -> kc.Capture:
    """A knob behind a spring and a damper, pulled by a spring of its own."""
    bare = recorded(13, count=count)
    steps, (k, d) = 40, (0.5, 2e-3)
    h = 1.0 / RATE_HZ / steps
    t = np.arange(count * steps) * h
    theta, omega = (sum(a * w**n * f(w * t + a) for a, w in WAVES) for n, f in ((0, np.sin), (1, np.cos)))
    there, speed, tau = theta[0], omega[0], np.zeros(count)
    for at in range(count * steps):
        force = k * (theta[at] - there) + d * (omega[at] - speed)
        if at % steps == 0:
            tau[at // steps] = force
        rubs = 8e-3 * np.tanh(speed / 0.02) + 4e-4 * speed + 8e-3 * there
        speed += h * (force - rubs) / 7e-5
        there += h * speed
    alpha = -sum(a * w * w * np.sin(w * bare.t + a) for a, w in WAVES)
    noise = 1e-3 * np.random.default_rng(14).standard_normal(count)
    return dataclasses.replace(bare, tau=3e-5 * alpha + tau + noise)


def test_of_a_joint_and_a_spring_behind_it() -> None:
    searched("joined", joined(1200), without=all_but("compliance", "return_spring", "torque_lag"))


def test_of_fits_that_are_asked_for_more() -> None:
    told = Answers("asked")
    capture = recorded(15, rises)
    fit = kc.fit(capture)
    richer = fit.add("stribeck")
    for name, one in (("first", fit), ("stribeck", richer), ("both", richer.add("return_spring"))):
        fitted(told, name, one)
        for horizon in (None, 0.2):
            try:
                forward = one.forward(horizon_s=horizon) if horizon else one.forward()
            except InputError as error:
                told.put(f"{name} forward", str(error).split(" is ")[0])
                continue
            told.put(f"{name} forward {horizon}", without(forward.document(), *SAID_ELSEWHERE))
            told.put("  says", [forward.text, forward.summary, *forward.remarks, *repr(forward).splitlines()])
    fitted(told, "less", richer.drop("stribeck"))
    told.put("bootstrap", {name: list(draws[:3]) for name, draws in richer.bootstrap(8, 3).items()})
    told.put("band", richer.band())
    told.put("predicted", richer.predict(recorded(16)))
    told.done()


def test_of_a_knob_that_sticks() -> None:
    rng = np.random.default_rng(17)
    t = np.arange(6000) / RATE_HZ
    # It is held until the push exceeds what holds it, turns by a smooth step and is held again.
    place = np.floor(t / 0.5)
    share = np.clip((t % 0.5 - 0.35) / 0.15, 0.0, 1.0)
    way = np.where(place % 2 < 1, 1.0, -1.0)
    step = share - np.sin(2.0 * np.pi * share) / 2.0 / np.pi
    theta = 0.5 * np.where(way > 0.0, step, 1.0 - step)
    omega, alpha = np.gradient(theta, t), np.gradient(np.gradient(theta, t), t)
    push = np.where(share > 0.0, way * 9e-3, way * 0.014 * (t % 0.5) / 0.35)
    tau = 1e-4 * alpha + push + 5e-4 * omega + 1e-3 * rng.standard_normal(len(t))
    theta, omega = theta + 2e-6 * rng.standard_normal(len(t)), omega + 1e-4 * rng.standard_normal(len(t))
    fit = kc.fit(kc.Capture.from_arrays(t=t, theta=theta, omega=omega, tau=tau))
    told = Answers("sticks")
    fitted(told, "fit", fit)
    found = fit.stiction()
    told.put("stiction", without(found.document(), *SAID_ELSEWHERE))
    told.put("says", [*found.missing, found.determined, *repr(found).splitlines()])
    told.put("model", {name: one.value for name, one in found.model.params.items()})
    again = kc.fit(fit.signals.capture, model=found.model).stiction()
    told.put("again", {name: one.value for name, one in again.model.params.items()})
    told.put("table", [list(row) for table in found.tables() for row in table.rows])
    told.done()


def test_of_a_search_that_is_cut_short(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = iter(range(10**6))
    monkeypatch.setattr(cut, "time", SimpleNamespace(monotonic=lambda: 0.5 * next(seconds)))
    told = Answers("cut")
    story = kc.learn(recorded(20, rises), budget_s=0.4)
    told.put("learned", story.document())
    told.put("words", [story.cut.words if story.cut else "", story.headline, *repr(story).splitlines()])
    told.done()


def test_of_a_motor_whose_constants_are_fitted(tmp_path: Path) -> None:
    told = Answers("constants")
    for name, off, held in (("let go", True, False), ("driven", False, False), ("held", True, True)):
        log = motor(tmp_path / "motor.csv", 21, off, held)
        fit = kc.fit_constants(log, map=[*MAP, FORMULA], free=FREE, known={"inertia.M": INERTIA})
        document = fit.document()
        told.put(name, {key: document[key] for key in ("rmse", "noise_floor", "params", "constants")})
        told.put(f"{name} says", [*fit.warnings, *repr(fit).splitlines()])
    told.done()
