"""Challenges of the workbench: they can be solved, cost what they say, and give nothing away unasked."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import httpx
import pytest
from workbench_server import wrong

import knobcam as kc
from knobcam.workbench import challenge
from knobcam.workbench.bench import Bench
from knobcam.workbench.session import Session
from knobcam.workbench.sources import Simulated
from knobcam.workbench.tree import Opened


@pytest.fixture(autouse=True)
def _one(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a client is given to find is one spring."""
    if "client" in request.fixturenames:
        monkeypatch.setattr(challenge, "levels", lambda: {"easy": [("knob4", ("return_spring",), 3)]})


def standing(client: httpx.Client) -> dict[str, Any]:
    capture = client.get("/api/state").json()["captures"][-1]["id"]
    told: dict[str, Any] = client.get("/api/challenge", params={"capture": capture}).json()
    return told


def test_every_level_has_challenges_of_its_kind() -> None:
    assert [*challenge.levels()] == ["easy", "middling", "hard"]
    assert min(map(len, challenge.levels().values())) >= 4
    for level, some in challenge.levels().items():
        assert {len(hidden) for _, hidden, _ in some} == {2 if level == "hard" else 1}


def test_no_challenge_is_solved_before_anybody_has_looked() -> None:
    # What the reading of the torque adds may be mended as the capture is read, with a finding that names it.
    of_sensors = {one.id for one in kc.effects().values() if one.place == "sensor"}
    every = [one for level in challenge.levels().values() for one in level if of_sensors & {*one[1]}]
    assert len(every) >= 4
    for knob, hidden, seed in every:
        capture = Simulated(knob, hidden, "sweep", challenge.SECONDS, seed).capture()
        first = kc.fit(capture)
        assert not {*hidden} & {*first.model.effects}, (knob, hidden)
        assert not capture.findings and not first.prepared[0].findings, (knob, hidden)


def test_an_easy_challenge_is_solved_by_the_program_itself() -> None:
    knob, hidden, seed = challenge.levels()["easy"][0]
    story = kc.learn(Simulated(knob, hidden, "sweep", challenge.SECONDS, seed).capture())
    assert (story.verdict, story.found) == ("missing", hidden)


def test_hints_wrong_effects_and_the_list_cost_and_what_is_hidden_alone_solves_it(
    client: httpx.Client, bench: Bench
) -> None:
    assert client.post("/api/simulate", json={"level": "easy"}).is_success
    (one,) = client.get("/api/state").json()["captures"]
    assert one["hides"] and "spring" not in one["name"]
    assert standing(client) == {
        **{"hints": [], "more": True, "wrong": [], "found": 0, "hidden": 1},
        **{"solved": False, "given_up": False, "graded": True, "level": "easy", "sealed": True, "score": 100},
    }
    client.post("/api/hint", json={"capture": one["id"]})
    told = standing(client)
    assert told["hints"] == ["It is in the knob, or in what the knob drives."] and told["score"] == 85
    client.post("/api/add", json={"effect": "quadratic_drag"})
    assert standing(client)["wrong"] == ["quadratic_drag"] and standing(client)["score"] == 75
    client.post("/api/add", json={"effect": "return_spring"})
    told = standing(client)
    assert (told["found"], told["solved"], told["sealed"]) == (1, False, True)
    client.post("/api/drop", json={"effect": "quadratic_drag"})
    told = standing(client)
    assert (told["solved"], told["sealed"], told["score"]) == (True, False, 75)
    client.post("/api/hint", json={"capture": one["id"], "whole": True})
    for _ in range(9):
        client.post("/api/hint", json={"capture": one["id"]})
    told = standing(client)
    assert (len(told["hints"]), told["more"], told["score"]) == (3, False, 5)
    wrong(client.post("/api/simulate", json={"level": "x"}), 400, "choose easy")
    wrong(client.get("/api/challenge", params={"capture": "c99"}), 400, "hides nothing")


def test_no_hint_of_two_hidden_effects_says_again_what_another_has_said() -> None:
    for _, hidden, _ in challenge.levels()["hard"]:
        hints = challenge._hints(hidden)
        assert len(hints) == 3
        told = [one for hint in hints for one in re.split(r"(?<=\.) (?=Another: )", hint)]
        plain = [one.removeprefix("One: ").removeprefix("Another: ") for one in told]
        assert len({*plain}) == len(plain)
    both = challenge._hints(("stribeck", "quadratic_drag"))
    assert both[0] == "Of each of them: It is in the knob, or in what the knob drives. It is friction."
    assert both[1].startswith("One: It shows ") and " Another: It shows at high speed." in both[1]


def test_a_surprise_that_is_no_challenge_hides_no_list(client: httpx.Client) -> None:
    client.post("/api/simulate", json={"knob": "knob4", "effects": ["return_spring"], "duration_s": 2.0})
    told = standing(client)
    assert not told["sealed"] and not told["graded"]


def test_who_is_told_what_was_hidden_has_given_up_and_who_found_it_has_not(client: httpx.Client) -> None:
    for found in (False, True):
        client.post("/api/simulate", json={"level": "easy"})
        capture = client.get("/api/state").json()["captures"][-1]["id"]
        if found:
            client.post("/api/add", json={"effect": "return_spring"})
        assert client.post("/api/hidden", json={"capture": capture}).json()["hidden"] == ["return_spring"]
        told = standing(client)
        assert (told["given_up"], told["solved"], told["score"]) == (not found, found, 100 * found)
        assert not told["sealed"]


def test_no_challenge_comes_twice_before_all_have_come() -> None:
    session = Session()
    easy = challenge.levels()["easy"]
    for at in range(len(easy)):
        source = challenge.drawn("easy", session)
        had = {"simulated": dataclasses.asdict(source)}
        session.captures[f"c{at}"] = Opened(f"c{at}", "", kc.simulate("knob4", duration_s=0.1), "", **had)
    hidden = [Simulated.again(one.simulated or {}).hidden for one in session.captures.values()]
    assert sorted(hidden) == sorted(one[1] for one in easy)
    assert challenge.drawn("easy", session).level == "easy"


def test_a_challenge_of_which_samples_are_left_out_keeps_its_score(client: httpx.Client) -> None:
    client.post("/api/simulate", json={"level": "easy"})
    capture = client.get("/api/state").json()["captures"][-1]["id"]
    client.post("/api/hint", json={"capture": capture})
    client.post("/api/add", json={"effect": "torque_drift"})
    before = standing(client)
    assert before["score"] == 75
    assert client.post("/api/leave-out", json={"runs": {capture: [[0, 500]]}}).is_success
    assert standing(client) == before
