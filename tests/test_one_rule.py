"""What is missing is decided in one place: `learn`, `diagnose`, the page and the report say the same."""

from __future__ import annotations

import dataclasses
import json
import re
from typing import Any

import numpy as np
import pytest
from small import COUPLINGS

import knobcam as kc
from knobcam.base.said import Said
from knobcam.base.strict_json import as_json
from knobcam.fit.rule import RULE
from knobcam.show import results
from knobcam.workbench import state
from knobcam.workbench.session import Session

CHOSEN = ("missing", "part")


def humming() -> kc.Capture:
    """A knob with nothing missing but a hum of the mains in its torque, which is in no catalogue."""
    capture = kc.simulate("knob4", "sweep", seed=11, duration_s=2.0, rate_hz=2000.0)
    hum = 0.01 * np.sin(2.0 * np.pi * 50.0 * capture.t + 0.3)
    return dataclasses.replace(capture, tau=capture.tau + hum)


def faultless() -> kc.Capture:
    return kc.simulate("knob4", "sweep", seed=12, duration_s=2.0, rate_hz=1000.0)


def dragging() -> kc.Capture:
    """A knob with one plain effect that is hidden."""
    knob = kc.Model.load("knob4").with_effect("quadratic_drag").with_value("quadratic_drag.d", 6e-4)
    return kc.simulate(knob, "sweep", seed=13, duration_s=3.0, rate_hz=1000.0)


@pytest.fixture(scope="module", params=[humming, faultless, dragging], ids=lambda make: make.__name__)
def asked(request: pytest.FixtureRequest) -> dict[str, Any]:
    """A capture of which everybody was asked what is missing at first."""
    capture = request.param()
    session = Session()
    session.take(capture, "capture")
    diagnosis = session.weigh()
    learned = kc.learn(capture)
    return {
        "name": request.param.__name__,
        "page": json.loads(as_json(state.document(session))),
        "diagnosis": kc.fit(capture).diagnose(),
        "weighed": diagnosis,
        "learned": learned,
        "report": results.steps(learned)[0].document(),
    }


def told(rows: list[dict[str, Any]]) -> dict[str, str]:
    return {row["effect"]: row["word"] for row in rows}


def test_page_diagnosis_and_report_say_the_same_word_of_every_effect(asked: dict[str, Any]) -> None:
    page = told(asked["page"]["candidates"]["rows"])
    assert page == told(asked["diagnosis"].document()["candidates"])
    assert page == told(asked["report"]["candidates"]["rows"])
    assert len(page) > 10


def test_who_is_named_first_is_what_learn_adds_first(asked: dict[str, Any]) -> None:
    named = [row["effect"] for row in asked["page"]["candidates"]["rows"] if row["word"] in CHOSEN]
    added = [step.added for step in asked["learned"].ladder[1:2]]
    best = asked["diagnosis"].best
    assert named == added == ([] if best is None else [best.effect])
    if best is not None:
        assert best.equivalent == asked["learned"].ladder[1].equivalent


def test_the_text_names_nobody_whom_learn_does_not(asked: dict[str, Any]) -> None:
    diagnosis, learned = asked["diagnosis"], asked["learned"]
    could_be, *_ = repr(diagnosis).split("Too little, no more than chance, or not by their values:")
    named = {one.effect for one in diagnosis.candidates if re.search(rf"(?m)^ *{one.effect} ", could_be)}
    assert named == {one.effect for one in diagnosis.could_be}
    assert bool(named) == bool(learned.found)
    if not learned.found:
        assert Said.of(asked["page"]["concluded"]) == learned.headline


def test_a_hum_accuses_nobody_and_a_hidden_effect_is_named(asked: dict[str, Any]) -> None:
    verdict, found = {
        "humming": ("unexplained", ()),
        "faultless": ("complete", ()),
        "dragging": ("missing", ("quadratic_drag",)),
    }[asked["name"]]
    assert (asked["learned"].verdict, asked["learned"].found) == (verdict, found)
    if asked["name"] == "humming":
        # The trap: chance does explain less of it than these do, but none of them explains much.
        slivers = [one for one in asked["diagnosis"].candidates if one.p_value <= RULE.chance]
        assert len(slivers) > 1 and {one.word for one in slivers} <= {"too_little", "implausible"}
        assert "No effect of the catalogue that could be missing" in asked["diagnosis"].summary


def test_where_the_noise_is_not_known_nothing_is_told_from_chance() -> None:
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    capture = kc.simulate(knob, "sweep", rate_hz=25.0)
    diagnosis = kc.fit(capture, prepare="none").diagnose(only=["return_spring", "quadratic_drag"])
    assert {one.word for one in diagnosis.candidates} == {"untold"}
    assert diagnosis.best is None and "cannot be told from chance" in diagnosis.summary


def test_what_one_capture_shows_is_no_less_for_others_that_do_not() -> None:
    # Of the squared error a spring is enough for a name where the knob turns far, and less of all together.
    spring = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.0012)
    track = kc.motion("sweep", 3.0)
    smaller = kc.MotionTrack(track.t, *(0.3 * x for x in track[1:]))
    captures = [kc.simulate(spring, track, seed=5), *(kc.simulate(spring, smaller, seed=n) for n in (6, 7))]
    learned = kc.learn(captures, without=COUPLINGS)
    assert learned.found == kc.learn(captures[0], without=COUPLINGS).found == ("return_spring",)
    before, after = (step.rmse for step in learned.ladder)
    assert 1.0 - (after / before) ** 2 < RULE.worth
