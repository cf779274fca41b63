"""The workbench without its page: a session that adds, drops, undoes, forks, and is saved."""

from __future__ import annotations

import json
import runpy
import threading
from pathlib import Path

import numpy as np
import pytest
import told as told_as

import knobcam as kc
from knobcam.base import pages
from knobcam.base.said import Said
from knobcam.base.strict_json import as_json
from knobcam.errors import InputError
from knobcam.workbench import arrays, saving, state
from knobcam.workbench.jobs import Cancelled, Job, Worker
from knobcam.workbench.learned import ladder
from knobcam.workbench.session import Session
from knobcam.workbench.tell import quiet
from knobcam.workbench.tree import Start


@pytest.fixture
def session(recording: Path) -> Session:
    session = Session()
    session.open(str(recording))
    return session


@pytest.fixture(scope="module")
def weighed(recording: Path) -> Session:
    """With the first node weighed; whoever changes it goes back."""
    session = Session()
    session.open(str(recording))
    session.weigh()
    return session


def told(session: Session) -> dict:
    document: dict = json.loads(as_json(state.document(session)))
    told_as.check(document, pages.Session)
    return document


def test_a_capture_is_fitted_when_it_is_opened(session: Session, sprung: kc.Capture):
    assert session.node.fit.rmse == kc.fit(sprung).rmse
    assert [step["added"] for step in told(session)["branches"][0]["steps"]] == [None]


def test_without_a_capture_there_is_nothing_to_do():
    session = Session()
    assert told(session)["node"] is None
    for attempt in (session.undo, session.weigh, session.snap, lambda: session.add("stribeck")):
        with pytest.raises(InputError, match="open one first"):
            attempt()


def test_adding_the_missing_effect_brings_the_error_to_the_floor(weighed: Session):
    top = told(weighed)["candidates"]["rows"][0]
    assert top["effect"] == "return_spring"
    weighed.add(top["effect"])
    fit = weighed.node.fit
    assert fit.rmse < 1.05 * fit.noise_floor < weighed.branch.steps[0].fit.rmse
    assert [step["label"] for step in told(weighed)["ladder"]] == ["first model", "+ return_spring"]
    weighed.undo()


def test_an_effect_that_was_weighed_is_fitted_to_the_last_bit_as_one_that_was_not(weighed: Session):
    plain = weighed.node.fit.add("return_spring")
    weighed.add("return_spring")
    assert weighed.node.fit.model.text() == plain.model.text()
    assert weighed.node.diagnosis is not None
    assert weighed.node.p_value <= 0.05
    weighed.undo()


def test_undo_and_redo_restore_the_very_same_fits(session: Session):
    first = session.node
    before = told(session)["params"]
    session.add("return_spring")
    second = session.node
    session.undo()
    assert session.node is first
    assert told(session)["params"] == before
    session.redo()
    assert session.node is second
    with pytest.raises(InputError, match="nothing to redo"):
        session.redo()
    session.undo()
    with pytest.raises(InputError, match="nothing to undo"):
        session.undo()


def test_what_was_undone_is_gone_once_something_else_is_added(session: Session):
    session.add("return_spring")
    session.undo()
    session.add("offset" if "offset" in session.node.fit.model.effects else "quadratic_drag")
    assert [node.effect for node in session.branch.steps] == [None, "quadratic_drag"]


def test_dropping_what_was_added_gives_the_error_back(session: Session):
    first = session.node.fit.rmse
    session.add("return_spring")
    session.drop("return_spring")
    assert session.node.fit.rmse == pytest.approx(first, rel=1e-6)
    assert told(session)["branches"][0]["steps"][-1]["dropped"] == ["return_spring"]
    with pytest.raises(InputError, match="is not in the model"):
        session.drop("return_spring")


def test_a_model_keeps_its_last_effect(session: Session):
    *others, last = session.node.fit.model.effects
    for effect in others:
        if effect in session.node.fit.model.effects:
            session.drop(effect)
    with pytest.raises(InputError, match="all that the model has"):
        session.drop(last)


def test_two_branches_go_their_own_ways_from_a_common_past(session: Session):
    session.add("return_spring")
    other = session.fork("with  drag")
    session.add("quadratic_drag")
    session.switch(next(iter(session.branches)))
    rows = told(session)["branches"]
    assert [[step["added"] for step in row["steps"]] for row in rows] == [
        [None, "return_spring"],
        [None, "return_spring", "quadratic_drag"],
    ]
    assert session.branches[other].name == "with drag"
    assert session.branches[other].steps[1] is session.branch.steps[1]
    with pytest.raises(InputError, match="is not in this session"):
        session.switch("b99")


def test_a_dragged_parameter_changes_the_error_and_snaps_back(session: Session):
    fitted = session.node.fit
    value = fitted.params["viscous.pos"].value
    session.drag({"viscous.pos": value + 1e-3})
    row = next(row for row in told(session)["params"] if row["name"] == "viscous.pos")
    assert (row["value"], row["fitted"], row["dragged"]) == (value + 1e-3, value, True)
    rest = session.view.residual(0)
    assert session.view.rmse == pytest.approx(np.sqrt(np.nanmean(np.square(rest))))
    assert session.view.rmse > 1.05 * fitted.rmse
    assert session.node.fit is fitted
    session.snap()
    assert session.view.model == fitted.model
    assert session.view.rmse == fitted.rmse


def test_a_view_that_was_dragged_away_is_still_itself(session: Session):
    session.drag({"viscous.pos": 0.01})
    first = session.view
    session.drag({"viscous.neg": 0.02})
    assert session.view.id != first.id
    assert session.view_of(first.id) is first
    assert dict(session.view.dragged) == {"viscous.pos": 0.01, "viscous.neg": 0.02}
    with pytest.raises(InputError, match="is not in this session"):
        session.view_of("n1000")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1", True, None, 1e300])
def test_a_parameter_cannot_be_dragged_to_what_is_no_number(session: Session, value: object):
    revision = session.revision
    with pytest.raises(InputError):
        session.drag({"detent.P": value})
    assert session.revision == revision


def test_captures_of_one_knob_are_fitted_together_and_one_can_be_left_out(
    session: Session, sprung: kc.Capture
):
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    session.add("return_spring")
    other = session.take(kc.simulate(knob, "sweep", seed=7, rate_hz=1000.0), "other")
    assert len(session.node.fit.prepared) == 2
    assert "return_spring" in session.node.fit.model.effects
    session.use([other])
    assert session.node.captures == (other,)
    known = told(session)
    # What came in before has its step on these captures, too, and says what it takes off there.
    assert [step["label"] for step in known["ladder"]] == ["first model", "+ return_spring"]
    assert [step["added"] for step in known["carried"]] == [None, "return_spring"]
    assert known["carried"][0]["rmse"] > 1.5 * known["carried"][1]["rmse"] == 1.5 * known["rmse"]
    assert known["branches"][0]["steps"][-1]["anew"] is False
    session.weigh()
    assert told(session)["concluded"][0] == {"effect": "return_spring"}
    session.take(kc.simulate(knob, "sweep", seed=8, rate_hz=1000.0), "a knob of its own", together=False)
    assert [step["label"] for step in told(session)["ladder"]] == ["first model"]
    assert told(session)["carried"] == [] and told(session)["branches"][0]["steps"][-1]["anew"]
    session.undo()
    session.undo()
    session.undo()
    assert len(session.node.fit.prepared) == 1
    with pytest.raises(InputError, match="is not in this session"):
        session.use(["c99"])
    with pytest.raises(InputError, match="captures 1 and 2 are the same"):
        session.take(sprung, "again")
    assert set(session.captures) == {one for step in session.branch.steps for one in step.captures}


def test_work_that_is_given_up_between_rounds_changes_nothing(session: Session):
    before, revision = session.node, session.revision

    def stop(what: str, *, last: bool = False) -> None:
        if what.startswith("putting"):
            raise Cancelled

    for attempt in (
        lambda: session.add("return_spring", stop),
        lambda: session.drop("viscous", stop),
        lambda: session.take(kc.simulate("knob4", seed=3, rate_hz=1000.0), "other", tell=stop),
    ):
        with pytest.raises(Cancelled):
            attempt()
    assert (session.node, session.revision, len(session.captures)) == (before, revision, 1)


def test_a_fit_that_comes_after_the_session_moved_on_is_not_put_in_place(session: Session):
    session.add("return_spring")

    def meanwhile(what: str, *, last: bool = False) -> None:
        if what.startswith("putting"):
            session.undo()

    with pytest.raises(InputError, match="has moved on"):
        session.add("quadratic_drag", meanwhile)
    assert session.node is session.branch.steps[0]


def test_columns_are_those_of_the_fit(session: Session):
    names = ["theta", "residual", "model", "tau", "position_part", "band", "history"]
    content = arrays.columns(session.view, 0, names)
    line, _, _ = content.partition(b"\n")
    head = json.loads(line)
    start = -(-(len(line) + 1) // 4) * 4
    values = np.frombuffer(content[start:], dtype="<f4").reshape(len(head["names"]), head["n"])
    found = dict(zip(head["names"], values, strict=True))
    fit = session.node.fit
    assert head["dtype"] == "f32"
    np.testing.assert_array_equal(found["residual"], fit.residuals[0].astype("f4"))
    counts = np.isfinite(fit.residual)
    np.testing.assert_allclose((found["tau"] - found["model"])[counts], fit.residual[counts], atol=1e-7)
    assert np.nanstd(found["position_part"]) > 0.0
    assert np.isnan(found["history"][0]) and 0.0 <= np.nanmin(found["history"]) < 0.1 * np.ptp(found["theta"])
    for names in (["nope"], []):
        with pytest.raises(InputError, match="names"):
            arrays.columns(session.view, 0, names)


def test_a_signature_is_what_the_effect_takes_off_the_residual(weighed: Session):
    diagnosis = weighed.diagnosis_of(weighed.node.id)
    assert diagnosis is not None
    content = arrays.signature(diagnosis["return_spring"], weighed.view, 0)
    line, _, _ = content.partition(b"\n")
    head = json.loads(line)
    column = np.frombuffer(content[-4 * head["n"] :], dtype="<f4")
    before, after = weighed.node.fit.residual, diagnosis["return_spring"].fit.residual
    counts = np.isfinite(before)
    np.testing.assert_allclose(column[counts], (before - after)[counts], atol=1e-7)
    assert head["names"] == ["return_spring"]


def test_all_samples_hold_the_whole_error_and_none_hold_none(session: Session):
    capture = session.node.captures[0]
    n = session.captures[capture].capture.samples
    assert session.share(capture, range(n)) == pytest.approx(1.0)
    assert session.share(capture, []) == 0.0
    halves = [session.share(capture, range(n // 2)), session.share(capture, range(n // 2, n))]
    assert sum(halves) == pytest.approx(1.0)
    assert session.share(capture, [5, 5, 5]) == session.share(capture, [5])
    with pytest.raises(InputError, match="from 0 to"):
        session.share(capture, [n])


def test_the_script_of_a_session_makes_the_same_model_to_the_last_bit(
    weighed: Session, tmp_path: Path, capsys
):
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    second = kc.simulate(knob, "sweep", seed=7, rate_hz=1000.0).save(tmp_path / 'a "quoted" name.npz')
    weighed.fork("scripted")
    weighed.add("return_spring")
    weighed.add("quadratic_drag")
    weighed.drop("quadratic_drag")
    weighed.open(str(second))
    path = saving.save(weighed, "script", tmp_path / "session.py", quiet)
    made = runpy.run_path(str(path))["fit"]
    assert "return_spring" in capsys.readouterr().out
    assert made.model.text() == weighed.node.fit.model.text()
    weighed.switch(next(iter(weighed.branches)))


def test_a_session_starts_from_a_model_and_its_script_does_too(recording: Path, tmp_path: Path, capsys):
    path = kc.Model.load("knob4").with_effect("quadratic_drag").save(tmp_path / "start.toml")
    start = Start(kc.Model.load(path), str(path), {"prepare": "paper", "torque_edge_hz": 400.0})
    session = Session(start=start)
    session.open(str(recording))
    assert "quadratic_drag" in session.node.fit.model.effects
    assert session.node.fit.prepared[0].method == "paper"
    session.add("return_spring")
    session.open(str(kc.load(recording).save(tmp_path / "other.npz")), end=2.0)
    script = saving.save(session, "script", tmp_path / "session.py", quiet)
    assert runpy.run_path(str(script))["fit"].model.text() == session.node.fit.model.text()
    assert "quadratic_drag" in capsys.readouterr().out


def test_an_effect_that_takes_off_no_more_than_chance_was_not_missing(weighed: Session):
    weighed.fork("useless")
    weighed.add("return_spring")
    weighed.add("stribeck")
    assert Said.of(told(weighed)["verdict"]).startswith(
        "stribeck was added, and it took off too little to have been missing."
    )
    weighed.weigh()
    concluded = Said.of(told(weighed)["concluded"])
    assert "return_spring was missing" in concluded and "stribeck was missing" not in concluded
    assert saving.told(weighed, quiet).found == ("return_spring",)
    weighed.switch(next(iter(weighed.branches)))


def test_a_coupling_that_explains_nothing_is_refused_in_one_line():
    session = Session()
    session.take(kc.simulate(kc.Model.load("knob5"), "hand", rate_hz=1000.0), "whole")
    for coupling in ("backlash", "compliance"):
        with pytest.raises(InputError, match=f"effect '{coupling}': .* explains too little"):
            session.add(coupling)


def test_a_step_that_lost_an_effect_says_so(session: Session):
    session.add("return_spring")
    session.drop("viscous")
    steps = ladder(session.branch.done)
    assert [(step.added, step.dropped) for step in steps] == [(None, ()), ("return_spring", ("viscous",))]
    assert steps[1].fit.before is steps[0].fit


def test_a_job_that_is_cancelled_ends_at_its_next_round_and_the_next_one_is_done():
    begun, go_on, rounds = threading.Event(), threading.Event(), []
    worker = Worker("test", lambda _: None)

    def work(job: Job) -> None:
        begun.set()
        go_on.wait(10.0)
        job.tell("second round")
        rounds.append("second")

    job = worker.start("first", work)
    assert begun.wait(10.0)
    assert worker.current is job
    worker.cancel()
    with pytest.raises(Cancelled):
        job.result.result(10.0)
    assert worker.current is None
    go_on.set()
    assert worker.start("next", lambda _: "done").result.result(10.0) == "done"
    assert rounds == []
    worker.close()


def test_a_job_that_fails_tells_why_and_the_thread_lives_on():
    worker = Worker("test", lambda _: None)

    def broken(_: Job) -> None:
        raise ZeroDivisionError("by nought")

    with pytest.raises(ZeroDivisionError, match="by nought"):
        worker.start("broken", broken).result.result(10.0)
    assert worker.start("next", lambda _: 1).result.result(10.0) == 1
    worker.close()


def test_a_parameter_that_is_dragged_beyond_all_measure_has_an_error_without_measure(session: Session):
    session.drag({"viscous.pos": 1e200})
    assert session.view.rmse == np.inf
    assert told(session)["rmse"] is None
    capture = session.node.captures[0]
    assert session.share(capture, [0]) == 0.0
