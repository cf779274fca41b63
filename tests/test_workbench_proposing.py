"""Laws for what no effect explains at the workbench: looked for, laid over the residuals, taken, kept."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import numpy as np
import pytest
from brake import braked_knob
from workbench_server import served, wrong

import knobcam as kc
from knobcam.base.said import Said
from knobcam.fit.estimate import Estimate
from knobcam.learn.left import mapped
from knobcam.workbench import surface
from knobcam.workbench.bench import Bench
from knobcam.workbench.proposing import doubt_of, looked_for, taken, typed
from knobcam.workbench.script import script
from knobcam.workbench.session import Session
from knobcam.workbench.state import document
from knobcam.workbench.tell import quiet


@pytest.fixture
def asked(client: httpx.Client, bench: Bench, braked: kc.Capture) -> httpx.Client:
    """Laws were looked for beside the first model of the knob."""
    bench.session.take(braked, "braked")
    assert state(client)["proposed"] is None
    assert client.post("/api/propose", json={}).status_code == 200
    return client


def speed(words: list[str]) -> float:
    """The speed in what is said of a law's parameters, rad/s."""
    [said] = [word.split() for word in words if word.startswith("w = ")]
    assert "rad/s" in said
    return float(said[2])


def state(client: httpx.Client) -> dict[str, Any]:
    told: dict[str, Any] = client.get("/api/state").json()
    told.pop("job")  # what could be missing is weighed in the background, when it comes to its turn
    return told


def test_a_law_is_proposed_laid_over_the_residual_and_taken_under_a_name(
    asked: httpx.Client, bench: Bench
) -> None:
    told = state(asked)
    first = told["proposed"][0]
    assert first["words"][-1] == "no shorter law is as good" and first["variables"] == ["omega"]
    assert first["doubt"] == ""
    assert first["rmse"] < 1.02 * told["noise_floor"] < 0.5 * told["rmse"]
    assert first["fall"] == pytest.approx(1.0 - first["rmse"] / told["rmse"])
    assert "proposed, not found" in Said.of(told["proposed_said"])
    assert speed(first["words"]) == pytest.approx(1.3, abs=0.03)
    there = {"node": told["node"], "capture": told["active"][0], "number": "1"}
    answer = asked.get("/api/law", params=there)
    head = answer.content.split(b"\n")[0]
    assert json.loads(head)["names"] == ["law 1"]
    overlay = np.frombuffer(answer.content[-4 * json.loads(head)["n"] :], dtype="<f4")
    residual = bench.session.view.residual(0)
    used = ~np.isnan(residual)
    assert np.std(residual[used] - overlay[used]) == pytest.approx(first["rmse"], rel=0.02)
    assert asked.post("/api/accept", json={"number": 1, "name": "eddy"}).status_code == 200
    after = state(asked)
    assert [step["label"] for step in after["ladder"]] == ["first model", "+ eddy"]
    assert after["rmse"] == pytest.approx(first["rmse"], rel=1e-6)
    assert {"eddy.a", "eddy.w"} <= {one["name"] for one in after["params"]}
    assert after["proposed"] is None
    # Back, what was looked for is there still; forth, the law is.
    asked.post("/api/undo", json={})
    assert state(asked)["proposed"] == told["proposed"]
    asked.post("/api/redo", json={})
    assert state(asked)["rmse"] == after["rmse"]
    asked.post("/api/undo", json={})
    assert asked.post("/api/accept", json={"number": 2, "name": "eddy"}).status_code == 200
    assert bench.session.node.fit.model.laws == {"eddy": told["proposed"][1]["label"]}


def test_a_session_with_a_law_goes_on(braked: kc.Capture, tmp_path: Path) -> None:
    path = str(braked.save(tmp_path / "braked.npz"))
    there = Bench(kept_in=tmp_path / "sessions")
    there.session.open(path)
    with served(there) as client:
        client.post("/api/propose", json={})
        client.post("/api/accept", json={"number": 1, "name": "eddy"})
        assert client.post("/api/add", json={"effect": "return_spring"}).status_code == 200
        before = state(client)
    kc.forget_effect("eddy")
    with served(Bench(kept_in=tmp_path / "sessions")) as client:
        client.post("/api/continue", json={"session": state(client)["left"][0]["id"]})
        after = state(client)
        assert client.post("/api/drop", json={"effect": "eddy"}).status_code == 200
    assert [step["label"] for step in after["ladder"]] == ["first model", "+ eddy", "+ return_spring"]
    for one, other in zip(before["ladder"], after["ladder"], strict=True):
        assert one["rmse"] == pytest.approx(other["rmse"], rel=1e-6)
    for one, other in zip(before["params"], after["params"], strict=True):
        assert one["name"] == other["name"] and one["value"] == pytest.approx(other["value"], rel=1e-3)


def test_a_law_of_one_machine_is_not_weighed_on_another(braked: kc.Capture) -> None:
    session = Session()
    own = session.take(braked, "braked")
    typed(session, "2 a (omega/w) / (1 + (omega/w)^2)", "eddy", {"w": 1.3}, quiet)
    session.undo()
    assert "eddy" in {one["effect"] for one in document(session)["absent"]}  # undone, it may come again
    session.take(braked_knob(0.01, 2.0), "another", together=False)
    assert "eddy" not in {one["effect"] for one in document(session)["absent"]}
    diagnosis = session.weigh()
    assert "eddy" not in {one.effect for one in diagnosis.candidates} | set(diagnosis.left_out)
    session.use([own])
    assert "eddy" in {one["effect"] for one in document(session)["absent"]}


def test_the_script_of_a_session_makes_the_law_again(braked: kc.Capture, tmp_path: Path) -> None:
    session = Session()
    session.open(str(braked.save(tmp_path / "braked.npz")))
    looked_for(session, quiet)
    taken(session, 1, "eddy", quiet)
    session.drop("detent")
    lines = script(session.branch.done, session.captures, session.start)
    kc.forget_effect("eddy")
    told: dict[str, Any] = {}
    exec(lines, told)
    assert told["fit"].model.laws == session.node.fit.model.laws
    assert told["fit"].rmse == pytest.approx(session.node.fit.rmse, rel=1e-9)


def test_where_an_effect_explains_as_much_none_is_proposed(client: httpx.Client, bench: Bench) -> None:
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    bench.session.take(kc.simulate(knob, "sweep", rate_hz=1000.0), "sprung")
    client.post("/api/propose", json={})
    told = state(client)
    assert told["proposed"] == [] and "No law is proposed" in Said.of(told["proposed_said"])
    wrong(client.post("/api/accept", json={"number": 1}), 400, "no proposal has that number")


def test_what_cannot_be_taken_is_refused_and_changes_nothing(asked: httpx.Client) -> None:
    before = state(asked)
    there = {"node": before["node"], "capture": before["active"][0]}
    for number in ("0", "99", "one", ""):
        wrong(asked.get("/api/law", params=there | {"number": number}), 400, "number: give one from 1 to")
    wrong(asked.post("/api/accept", json={"number": 98}), 400, "no proposal has that number")
    wrong(asked.post("/api/accept", json={"number": "first"}), 400, "number")
    wrong(asked.post("/api/accept", json={"number": 1, "name": "coulomb"}), 400, "'coulomb'")
    wrong(asked.post("/api/accept", json={"number": 1, "name": "no name"}), 400, "name")
    assert state(asked) == before


def test_before_it_was_asked_there_is_no_law(opened: httpx.Client) -> None:
    wrong(opened.post("/api/accept", json={"number": 1}), 400, "no laws were looked for")


def test_before_a_capture_there_is_nothing_to_propose(client: httpx.Client) -> None:
    wrong(client.post("/api/propose", json={}), 400, "open one first")


def test_a_formula_is_typed_fitted_and_undone(client: httpx.Client, bench: Bench, braked: kc.Capture) -> None:
    bench.session.take(braked, "braked")
    before = state(client)
    body = {"law": "2 a (omega/w) / (1 + (omega/w)^2)", "name": "eddy", "guess": "a=0.01, w=1"}
    assert client.post("/api/formula", json=body).status_code == 200
    after = state(client)
    assert after["ladder"][-1]["label"] == "+ eddy" and after["rmse"] < 1.02 * after["noise_floor"]
    assert next(one for one in after["params"] if one["name"] == "eddy.w")["value"] == pytest.approx(
        1.3, abs=0.1
    )
    wrong(client.post("/api/formula", json=body), 400, "is an effect already")
    client.post("/api/undo", json={})
    assert state(client)["rmse"] == before["rmse"]
    # Undone it may come otherwise under its name; what it was is no more.
    assert client.post("/api/formula", json=body | {"law": "a tanh(omega/w)"}).status_code == 200
    again = state(client)
    assert again["ladder"][-1]["label"] == "+ eddy" and again["rmse"] != after["rmse"]
    assert bench.session.node.fit.model.laws == {"eddy": "a tanh(omega/w)"}


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"law": "2 a (omega"}, "character"),
        ({"law": "a omega", "name": "coulomb"}, "coulomb"),
        ({"law": "a omega", "guess": "a"}, "start a: '' is no number"),
        ({"law": "a sin(omega)"}, "rad"),
        ({"law": "a sin(k theta)", "guess": "b=1"}, "b"),
        ({"law": 3}, "law"),
        ({}, "law"),
    ],
)
def test_what_is_no_formula_is_refused_and_changes_nothing(
    opened: httpx.Client, body: dict[str, Any], words: str
) -> None:
    before, there = state(opened), set(kc.effects())
    wrong(opened.post("/api/formula", json=body), 400, words)
    assert state(opened) == before and set(kc.effects()) == there


def test_the_curve_of_what_is_left_has_its_band_and_the_laws_lie_within_it(asked: httpx.Client) -> None:
    curve = state(asked)["curve"]
    assert curve["over"] == "omega" and curve["times"] == ""
    value, band, first = (
        np.array(one, dtype=float) for one in (curve["value"], curve["band"], curve["laws"][0])
    )
    seen = ~np.isnan(value)
    assert seen.mean() > 0.5 and np.array_equal(seen, ~np.isnan(band))
    assert np.mean(np.abs(value - first)[seen] < 2.0 * band[seen]) > 0.9
    assert np.ptp(value[seen]) > 10.0 * np.median(band[seen])


def test_a_formula_is_fitted_while_it_is_typed_and_changes_nothing(asked: httpx.Client, bench: Bench) -> None:
    before = state(asked)
    formula = {"law": "2*a*(omega/w)/(1 + (omega/w)^2)", "guess": "a=0.01 w=1"}
    told = asked.post("/api/typed", json=formula).json()["tried"]
    assert told["rmse"] == pytest.approx(before["proposed"][0]["rmse"], rel=1e-3)
    assert speed(told["words"]) == pytest.approx(1.3, abs=0.03)
    there = {"node": before["node"], "capture": before["active"][0], "number": "typed"}
    assert asked.get("/api/law", params=there).is_success
    assert "character" in asked.post("/api/typed", json={"law": "2*a*(omega"}).json()["unfinished"]
    assert state(asked) == before
    assert not [one for one in kc.effects() if one.startswith("typed")]
    asked.post("/api/add", json={"effect": "stribeck"})
    now = {**there, "node": state(asked)["node"]}
    wrong(asked.get("/api/law", params=now), 400, "type one first")


def test_of_two_formulas_the_one_that_was_typed_last_is_fitted_whichever_comes_first(
    opened: httpx.Client,
) -> None:
    tried = opened.post("/api/typed", json={"law": "k*theta", "typed_ms": 2000}).json()
    assert tried["tried"]["law"] == "k*theta"
    late = opened.post("/api/typed", json={"law": "k*th", "typed_ms": 1999}).json()
    assert "tried" not in late and late["unfinished"].startswith("cancelled")
    newer = opened.post("/api/typed", json={"law": "k*th", "typed_ms": 2001}).json()
    assert "character" in newer["unfinished"]
    wrong(opened.post("/api/typed", json={"law": "k*theta", "typed_ms": -1}), 400, "typed_ms")


@pytest.fixture
def slide(bench: Bench) -> kc.Capture:
    """An axis that slides, taken from a knob."""
    knob = kc.simulate("knob4", "sweep", duration_s=4.0, rate_hz=1000.0, seed=5)
    capture = replace(knob, coordinate="linear", torque_unit="N")
    bench.session.take(capture, "slide")
    return capture


def test_a_formula_of_a_slide_is_typed_by_x_and_v(
    client: httpx.Client, bench: Bench, slide: kc.Capture
) -> None:
    told = client.post("/api/typed", json={"law": "b v + k x"}).json()["tried"]
    assert told["law"] == "b v + k x" and slide.coordinate == "linear"
    body = {"law": "b v + k x", "name": "mine"}
    assert client.post("/api/formula", json=body).status_code == 200
    assert bench.session.node.fit.model.laws == {"mine": "b omega + k theta"}


def test_a_formula_of_a_slide_is_refused_by_the_character_that_was_typed(
    client: httpx.Client, slide: kc.Capture
) -> None:
    assert slide.coordinate == "linear"
    for law, words in (
        ("k x + a foo(v)", "at character 9, 'foo(v)': 'foo' is no function"),
        ("a * (x + v", "at its end: wants the ')' of what opened at character 5"),
        ("k x + c )", "at character 9, ')'"),
    ):
        assert client.post("/api/typed", json={"law": law}).json()["unfinished"].startswith(words)


def test_where_nothing_has_a_name_a_law_is_looked_for_unasked(
    bench: Bench, braked: kc.Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("knobcam.workbench.state.unexplained", lambda _: True)
    bench.session.take(braked, "braked")
    bench.weigh().result.result(120.0)
    assert bench.session.proposals[bench.session.node.id].laws[0].variables == ("omega",)


def test_what_a_law_takes_off_is_of_the_error_that_it_was_looked_for_in(
    bench: Bench, braked: kc.Capture
) -> None:
    """Not of what came in meanwhile and explains a part of it: there a law may leave more, and rise."""
    session = bench.session
    session.take(braked, "braked")
    first = session.node.fit.rmse
    session.add("torque_drift")
    looked_for(session, quiet)
    laws = document(session)["proposed"]
    assert laws and session.node.fit.rmse < 0.8 * first
    for law in laws:
        assert law["fall"] == pytest.approx(1.0 - law["rmse"] / first, abs=1e-3)


def test_values_of_a_law_that_are_not_determined_are_said() -> None:
    known = {"a": Estimate(0.01, (0.009, 0.011), "N m", 5e-4), "n": Estimate(2.0, (2.0, 2.0), "1", 0.0)}
    assert doubt_of(known) == ""
    unknown = {
        "b": Estimate(0.3, (math.nan, math.nan), "1", math.nan),
        "c": Estimate(0.1, (-1.0, 1.2), "1", 0.5),
    }
    assert doubt_of(known | unknown) == "not determined: b; may be nothing as well: c"


def test_a_value_of_a_law_that_is_not_determined_is_marked_among_the_parameters(braked: kc.Capture) -> None:
    session = Session()
    session.take(braked, "braked")
    typed(session, "2 a (omega/w) / (1 + (omega/w)^2) + q*t", "mine", {"w": 1.3}, quiet)
    doubts = {one["name"]: one["doubt"] for one in document(session)["params"]}
    assert doubts["mine.a"] is None and doubts["viscous.pos"] is None
    assert doubts["mine.q"] == ["may be nothing as well, for the interval holds zero"]
    session.undo()
    typed(session, "a*tanh(omega/w)", "other", {"w": 1e-4}, quiet)
    doubts = {one["name"]: one["doubt"] for one in document(session)["params"]}
    assert {"param": "coulomb.neg"} in (doubts["other.a"] or [])


def test_what_is_left_over_two_variables_is_never_more_than_was_measured() -> None:
    # A motor at one speed goes along one line of time and angle: what a map has beside it is of no sample.
    t = np.linspace(0.0, 10.0, 2001)
    turned = 0.2 * t
    rest = 0.1 * np.sin(2.0 * np.pi * t / 5.0)
    x, y = np.linspace(0.0, 10.0, 21), np.linspace(0.0, 2.0, 21)
    beside_it = np.abs(x[None, :] / 10.0 - y[:, None] / 2.0) < 0.15
    steep = np.where(beside_it, 40.0 * (x[None, :] / 10.0 - y[:, None] / 2.0), np.nan)
    signals = SimpleNamespace(
        capture=SimpleNamespace(t=t),
        **{"theta": turned, "omega": np.full(2001, 0.2), "alpha": np.zeros(2001)},
        on_capture=lambda column: column,
        core=SimpleNamespace(column=lambda _: turned),
    )
    beside: Any = SimpleNamespace(residual=rest, prepared=[signals])
    core = {"over": ("t", "theta"), "times": "", "x": x, "y": y}
    core |= {"value": steep.T.ravel(), "band": np.full(steep.size, 0.1)}
    map_of = mapped(core, beside)
    assert np.nanmax(np.abs(map_of.value)) <= 0.1 < np.nanmax(np.abs(steep))
    assert (np.isfinite(map_of.band) == np.isfinite(map_of.value)).all()
    found: Any = SimpleNamespace(
        beside=beside,
        map=map_of,
        laws=[
            SimpleNamespace(variables=("t",), fit=SimpleNamespace(residual=rest)),
            SimpleNamespace(variables=("t", "theta"), fit=SimpleNamespace(residual=0.5 * rest)),
        ],
    )
    shown = surface.document(found)
    assert shown is not None and shown["laws"][0] is None and shown["laws"][1] is not None
    left, law = (np.array(one, dtype=float) for one in (shown["value"], shown["laws"][1]))
    there = np.isfinite(left)
    assert there.sum() > 40 and not there[~beside_it].any()
    assert 0.02 < np.abs(left[there]).max() <= 0.1
    assert law[there] == pytest.approx(0.5 * left[there])
