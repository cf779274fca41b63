"""What the page draws of a fit: an effect by itself, and where the error lies."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import numpy as np

import knobcam as kc
from knobcam.workbench import arrays
from knobcam.workbench.session import Session


def test_the_torque_of_an_effect_itself_is_told_without_what_the_others_give_up_for_it(sprung: kc.Capture):
    session = Session()
    session.take(sprung, "sprung")
    spring = session.weigh()["return_spring"]
    content = arrays.own(spring, session.view, 0)
    head = json.loads(content.partition(b"\n")[0])
    column = np.frombuffer(content[-4 * head["n"] :], dtype="<f4")
    theta = session.view.fit.prepared[0].capture.theta
    k, rest = (spring.fit.params[f"return_spring.{name}"].value for name in ("k", "theta0"))
    counts = np.isfinite(column)
    np.testing.assert_allclose(column[counts], (k * (theta - rest))[counts], atol=0.02 * np.ptp(k * theta))
    whole = arrays.signature(spring, session.view, 0)
    signature = np.frombuffer(whole[-4 * head["n"] :], dtype="<f4")
    assert np.max(np.abs((signature - column)[counts])) > 0.05 * np.ptp(column[counts])


def test_no_bin_is_told_in_which_there_is_no_sample(sprung: kc.Capture):
    session = Session()
    after = sprung.t / sprung.duration_s
    session.take(dataclasses.replace(sprung, mask=sprung.mask & ~((after > 0.4) & (after < 0.7))), "a hole")
    whole = next(one for one in session.view.fit.compare().splits if one.axis == "time")
    told = next(one for one in session.view.splits() if one["axis"] == "time")
    assert np.sum(whole.count == 0.0) > 5
    assert len(told["mean"]) == len(told["low"]) == np.sum(whole.count > 0.0)
    middle = 0.55 * sprung.duration_s
    assert not any(low < middle < high for low, high in zip(told["low"], told["high"], strict=True))


def test_the_page_draws_every_machine_part_that_an_effect_is_said_to_be() -> None:
    source = (Path(__file__).parents[1] / "web" / "src" / "section.js").read_text("utf-8")
    (drawn,) = re.findall(r"const KINDS = \{ ([\w, ]+) \};", source)
    said = {one.section for axis in ("rotary", "linear") for one in kc.effects(axis).values()}
    assert said - {None} == {"gap", "spring", "weight", "poles", "fluid", "stops"}
    assert said - {None} <= {*drawn.split(", ")}
    assert kc.effects()["backlash"].document()["section"] == "gap"
