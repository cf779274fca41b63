"""What the page draws of a fit, and what it says and asks before there is one."""

from __future__ import annotations

import dataclasses
import json
import re
from html import unescape
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import numpy as np
import pytest

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


@pytest.mark.parametrize(
    ("mapped", "axis", "said"),
    [
        (
            "theta=Position [rad], tau=Iq [A]",
            "rotary",
            "no column of times; where there is none, type how many",
        ),
        (
            "t=Time [s], theta=Position [m], tau=Iq [A]",
            "rotary",
            "the angle or position in [m] is for an axis that",
        ),
        (
            "t=Time [s], theta=3 [rad], tau=Iq [A]",
            "rotary",
            "the angle or position 3 is a single value, not a col",
        ),
        ("t=Time [s], theta=Pos [rad], tau=Iq [A]", "rotary", "no column 'Pos'"),
        ("t=Time [s], theta=Position [rad]", "rotary", "the torque, force or current is missing: say which"),
    ],
)
def test_what_is_wrong_with_fields_that_were_filled_in_is_said_in_their_words(
    client: httpx.Client, tmp_path: Path, mapped: str, axis: str, said: str
):
    log = tmp_path / "log.csv"
    rows = np.column_stack(
        [np.arange(200) / 1e3, np.sin(np.arange(200) / 20.0), np.cos(np.arange(200) / 20.0)]
    )
    np.savetxt(log, rows, delimiter=",", header="Time,Position,Iq", comments="")
    refused = client.post("/api/open", json={"path": str(log), "map": mapped, "coordinate": axis})
    words = refused.json()["error"]
    assert refused.status_code == 400 and words.startswith(f"log.csv: {said}"), words
    assert not re.search(r"map|--|\b(theta|tau|omega)\b|coordinate", words), words


def test_the_page_says_which_samples_it_will_ask_for_so_that_the_browser_asks_meanwhile(
    opened: httpx.Client,
):
    links = re.findall(r'<link rel="preload" as="fetch"[^>]* href="([^"]*)"', opened.get("/").text)
    state = opened.get("/api/state").json()
    assert len(links) == len(state["active"]) == 1
    asked = parse_qs(urlsplit(unescape(links[0])).query)
    assert asked["node"] == [state["node"]] and asked["capture"] == state["active"]
    answer = opened.get(
        "/api/arrays", params={name: one for name, (one,) in asked.items() if name != "token"}
    )
    assert json.loads(answer.content.split(b"\n")[0])["names"] == asked["names"][0].split(",")
