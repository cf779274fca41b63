"""All that is missing found at once at the workbench: what `learn` finds, as steps of the session."""

from __future__ import annotations

import json
import re
import runpy
from dataclasses import replace
from pathlib import Path

import httpx
import numpy as np
import pytest
import told as told_as

import knobcam as kc
from knobcam.base import pages
from knobcam.base.said import OfEffect, Said, said
from knobcam.base.strict_json import as_json
from knobcam.errors import InputError
from knobcam.fit.diagnose import diagnose
from knobcam.learn import LearningResult
from knobcam.learn.ladder import LearningStep, Unexplained
from knobcam.workbench import adding, ended, kept, pace, saving, state
from knobcam.workbench.bench import Bench
from knobcam.workbench.jobs import Cancelled, Job
from knobcam.workbench.journal import Journal
from knobcam.workbench.session import Session
from knobcam.workbench.tell import quiet


@pytest.fixture
def searched(recording: Path) -> Session:
    session = Session()
    session.open(str(recording))
    session.search()
    return session


@pytest.fixture(scope="module")
def motor() -> kc.Capture:
    """A motor that turns evenly, whose ripple has several orders: the first of them pass for detents."""
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 20.0, 1.0 / 400.0)
    theta = 2.5 * np.pi * np.sin(2.0 * np.pi * t / 10.0) + 0.02 * np.sin(9.0 * t)
    omega = np.gradient(theta, t)
    ripple = 0.02 * np.sin(7.0 * theta) + 0.012 * np.sin(12.0 * theta + 1.0) + 0.009 * np.sin(21.0 * theta)
    tau = ripple + 0.01 * np.sign(omega) + 0.002 * omega + 0.0006 * rng.standard_normal(len(t))
    return kc.Capture.from_arrays(t=t, theta=theta, tau=tau)


def document(session: Session) -> dict:
    found: dict = json.loads(as_json(state.document(session)))
    told_as.check(found, pages.Session)
    return found


def test_what_is_found_at_once_is_what_learn_finds_and_goes_back_step_by_step(
    searched: Session, story: kc.LearningResult
) -> None:
    assert [one.effect for one in searched.branch.steps] == [step.added for step in story.ladder]
    assert searched.node.fit.model.text() == story.model.text()
    page = document(searched)
    assert page["searched"] and page["verdict"][0] != "What could be missing is not weighed yet."
    assert Said.of(page["concluded"]) == story.headline
    searched.undo()
    assert searched.node.fit.model.effects == story.ladder[0].effects
    assert not document(searched)["searched"]
    searched.redo()
    assert Said.of(document(searched)["concluded"]) == story.headline


def test_what_came_in_by_hand_is_not_what_a_search_begins_with_and_is_there_to_go_back_to(
    recording: Path, story: kc.LearningResult
) -> None:
    session = Session()
    session.open(str(recording))
    session.add("quadratic_drag")
    session.search()
    assert [one.effect for one in session.branch.steps] == [None, "quadratic_drag", None, "return_spring"]
    assert session.node.fit.model.text() == story.model.text()
    with pytest.raises(InputError, match="in the model already"):
        session.search()


def test_a_search_that_is_ended_keeps_what_had_come_in_and_is_no_verdict(
    motor: kc.Capture, tmp_path: Path, capsys
) -> None:
    path = motor.save(tmp_path / "motor.npz")
    first = Bench(kept_in=tmp_path / "sessions")
    session = first.session
    session.open(str(path))
    told: list[str] = []

    def tell(what: str, _: float | None = None, *, last: bool = False) -> None:
        told.append(what)

    words = session.search(tell, lambda: any(one.startswith("adding") for one in told))
    came = [one.effect for one in session.branch.steps if one.effect]
    assert len(came) == 1 and session.node.fit.rmse < session.branch.steps[0].fit.rmse
    assert re.fullmatch(rf"the search was ended after \d+ s; by then it had found: {came[0]}", words)
    page = document(session)
    assert not page["searched"] and page["concluded"] == []
    script = saving.save(session, "script", tmp_path / "session.py", quiet)
    assert runpy.run_path(str(script))["fit"].rmse == pytest.approx(session.node.fit.rmse, rel=1e-6)
    assert "kc.learn(" not in script.read_text()
    before = session.node.fit.model.effects
    first.close()
    second = Bench(kept_in=tmp_path / "sessions")
    try:
        second.go_on("000001", quiet)
        assert second.session.node.fit.model.effects == before and second.session.node.cut
        assert second.session.search() == ""  # nothing is said of one that comes to its end
        assert document(second.session)["searched"]
    finally:
        second.close()


def test_a_search_says_how_long_it_takes_once_it_has_weighed_and_its_bar_never_goes_back(
    motor: kc.Capture,
) -> None:
    session, seen = Session(), []
    session.take(motor, "motor")
    job = Job(
        "finding everything", lambda _: None, told=lambda job: seen.append((job.what, job.takes_s, job.done))
    )
    with pace.clocked(job, pace.Weighings(job.what)) as tell:
        session.search(tell)
    stages = [*dict.fromkeys(str(what) for what, _, _ in seen)]
    assert stages[0] == "finding everything" or stages[0].startswith("fitting")
    known = [takes for _, takes, _ in seen if takes is not None]
    assert len({*known}) == 1 and 0.0 < known[0][0] < known[0][1]
    done = [one for _, _, one in seen if one is not None]
    assert done == sorted(done) and done[0] > 0.0 and done[-1] < 1.0
    before = [done for what, takes, done in seen if takes is None]
    assert set(before) == {None}  # and until it has weighed it promises nothing


def test_only_a_search_can_be_ended(client: httpx.Client) -> None:
    assert client.post("/api/enough", json={}).json()["cancelled"] is False


def test_what_a_search_found_is_in_the_script_of_the_session(
    searched: Session, tmp_path: Path, capsys
) -> None:
    script = tmp_path / "session.py"
    saving.save(searched, "script", script, quiet)
    assert "kc.learn(" in script.read_text()
    assert runpy.run_path(str(script))["fit"].model.text() == searched.node.fit.model.text()


def test_a_session_goes_on_with_what_a_search_had_found_and_said(recording: Path, tmp_path: Path) -> None:
    first = Bench(kept_in=tmp_path / "sessions")
    first.session.open(str(recording))
    first.session.search()
    before = document(first.session)
    first.close()
    second = Bench(kept_in=tmp_path / "sessions")
    try:
        second.go_on("000001", quiet)
        after = document(second.session)
        assert second.document()["notes"] == []
        assert after["branches"][0]["steps"][-1]["added"] == before["branches"][0]["steps"][-1]["added"]
        assert after["rmse"] == pytest.approx(before["rmse"], rel=kept._ALIKE)
        for one in ("concluded", "verdict"):
            assert Said.of(after[one]) == Said.of(before[one])
        assert [after[one] for one in ("added", "record", "searched")] == [[], before["record"], True]
        ends = [[end for one in page["params"] for end in one["ci95"] or ()] for page in (before, after)]
        assert ends[1] == pytest.approx(ends[0], rel=1e-3)
        known = adding.story(second.session, quiet)
        for weighed in (known.before, known.first_diagnosis):
            assert weighed.fit.model.effects == known.ladder[0].effects
        with pytest.raises(InputError, match="in the model already"):
            second.session.search()
    finally:
        second.close()


@pytest.mark.parametrize(
    ("off", "rung", "noted"), [(1e-5, 0, 0), (1e-3, 0, 1), (1e-5, None, 1), (1e-7, None, 0)]
)
def test_a_fit_of_a_search_may_end_a_little_elsewhere_when_it_is_made_again(
    recording: Path, tmp_path: Path, off: float, rung: int | None, noted: int
) -> None:
    with_one = Bench(kept_in=tmp_path / "sessions")
    with_one.session.open(str(recording))
    with_one.close()
    told = kept.Told.of(tmp_path / "sessions" / "000001")
    for one in told.nodes.values():
        told.nodes[one["id"]] = {**one, "rung": rung, "rmse": (1.0 + off) * one["rmse"]}
    with Journal.taken(tmp_path / "sessions" / "000001") as journal:
        assert len(kept.again(told, journal, quiet).notes) == noted


def test_a_verdict_that_names_what_is_left_or_what_one_more_would_take_is_kept_word_for_word(
    sprung: kc.Capture,
) -> None:
    session = Session()
    session.take(sprung, "sprung")
    weighed, (node,) = session.weigh(), session.branch.done
    hint = said("a line at {hz} Hz, beside {what}", hz="50", what=OfEffect("detent"))
    for last in (weighed, diagnose(node.fit, only=())):
        first = LearningResult((LearningStep(node.fit),), (), last, Unexplained("time", 0.4, hint))
        told = json.loads(as_json(ended.of_search(node.id, first)))["searched"]
        again = ended.again(told, [node])
        assert again.headline.parts == first.headline.parts
        assert again.last.best is not None and again.last.best.effect == "return_spring"


def test_intervals_that_carry_a_choice_between_effects_are_kept(sprung: kc.Capture) -> None:
    session = Session()
    session.take(sprung, "sprung")
    weighed = session.weigh()
    session.add("return_spring")
    first, last = session.branch.done
    # Two that explain as much: how far they part is in the intervals.
    either = replace(weighed["unbalance"], word="alike", gain=weighed["return_spring"].gain)
    chosen = replace(weighed, candidates=(weighed["return_spring"], either))
    steps = (LearningStep(first.fit), LearningStep(last.fit, "return_spring", diagnosis=chosen))
    found = LearningResult(steps, ("return_spring",), diagnose(last.fit, only=()), None)
    again = ended.again(json.loads(as_json(ended.of_search(last.id, found)))["searched"], [first, last])
    for name, known in found.params.items():
        assert again.params[name].se == pytest.approx(known.se, rel=1e-9, nan_ok=True)
    assert any(again.params[name].se > 1.01 * one.se for name, one in last.fit.params.items())


def test_a_search_says_in_names_what_it_does_and_how_much_and_a_stop_changes_nothing(recording: Path) -> None:
    session = Session()
    session.open(str(recording))
    before, said, shares = document(session), [], []

    def until_something_is_added(what: str, done: float | None = None, *, last: bool = False) -> None:
        said.append(what)
        shares.append(done)
        if what.startswith("adding"):
            raise Cancelled

    with pytest.raises(Cancelled):
        session.search(until_something_is_added)
    assert document(session) == before
    assert {OfEffect("inertia"), OfEffect("return_spring")} <= {
        one for what in said for one in Said(what).parts
    }
    assert sum(done is not None for done in shares) >= 3


def test_the_page_asks_for_a_search_and_is_refused_another_one(client: httpx.Client, recording: Path) -> None:
    assert client.post("/api/open", json={"path": str(recording)}).status_code == 200
    assert client.post("/api/search").status_code == 200
    steps = client.get("/api/state").json()["branches"][0]["steps"]
    assert [one["added"] for one in steps] == [None, "return_spring"]
    again = client.post("/api/search")
    assert again.status_code == 400 and "in the model already" in again.json()["error"]


def test_detents_that_nobody_asked_for_go_with_what_makes_them_needless(motor: kc.Capture) -> None:
    session = Session()
    session.take(motor, "motor")
    assert "detent" in session.node.fit.model.effects
    session.add("cogging")
    assert "detent" not in session.node.fit.model.effects
    assert session.node.fit.rmse < 1.1 * session.node.fit.noise_floor
    (step,) = document(session)["branches"][0]["steps"][1:]
    assert (step["added"], step["dropped"]) == ("cogging", ["detent"])
    assert "fit.add('cogging').drop('detent')" in _script(session)


def test_detents_that_somebody_added_stay(motor: kc.Capture) -> None:
    session = Session()
    session.take(motor, "motor")
    session.drop("detent")
    session.add("detent")
    session.add("cogging")
    assert "detent" in session.node.fit.model.effects


def test_captures_that_disagree_are_said_by_names_with_units_once_they_are_weighed() -> None:
    knob = kc.Model.load("knob4")
    changed = knob.with_value("viscous.pos", 4.0 * knob.params["viscous.pos"].value)
    session = Session()
    for seed, one in enumerate([knob, changed]):
        session.take(kc.simulate(one, "sweep", seed=seed, duration_s=3.0, rate_hz=1000.0), f"day {seed}")
    assert document(session)["disagreements"] == []
    session.weigh()
    first = document(session)["disagreements"][0]
    assert first["param"] == "viscous.pos" and {"param": "viscous.pos"} in first["said"]
    units = [part["unit"] for part in first["said"] if isinstance(part, dict) and "unit" in part]
    assert units == ["N m s/rad"] * 2


def _script(session: Session) -> str:
    return saving.script(session.branch.done, session.captures, session.start)
