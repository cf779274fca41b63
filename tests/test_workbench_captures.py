"""Captures of the workbench: they close and come back, masked samples are there, guesses are asked about."""

from __future__ import annotations

import dataclasses
import signal
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from measurements import SHARED, real
from scipy.signal import lfilter
from workbench_server import started

import knobcam as kc
from knobcam.base.said import Said
from knobcam.errors import InputError
from knobcam.workbench import arrays, state
from knobcam.workbench.bench import Bench
from knobcam.workbench.closing import close
from knobcam.workbench.preview import Unmapped, explained
from knobcam.workbench.session import Session
from knobcam.workbench.tell import quiet


def two(tmp_path: Path, session: Session) -> tuple[str, str]:
    """The ids of two captures of one knob, fitted together."""
    paths = [tmp_path / "one.npz", tmp_path / "other.npz"]
    for seed, path in enumerate(paths):
        kc.simulate("knob4", "sweep", duration_s=1.0, seed=seed).save(path)
    one, other = session.open(*map(str, paths))
    return one, other


def names(session: Session) -> list[str]:
    return [one["name"] for one in state.document(session)["captures"]]


def test_a_closed_capture_is_not_fitted_to_and_going_back_finds_it(tmp_path: Path) -> None:
    session = Session()
    one, other = two(tmp_path, session)
    close(session, other, quiet)
    assert (names(session), session.node.captures) == (["one.npz"], (one,))
    session.undo()
    assert (names(session), session.node.captures) == (["one.npz", "other.npz"], (one, other))
    session.redo()
    with pytest.raises(InputError, match=r"one\.npz is all that the model is fitted to; choose"):
        close(session, one, quiet)
    with pytest.raises(InputError, match="'c99' is not in this session"):
        close(session, "c99", quiet)
    assert names(session) == ["one.npz"]


def test_a_session_that_goes_on_leaves_closed_what_was_closed(tmp_path: Path) -> None:
    bench = Bench(kept_in=tmp_path / "sessions")
    _, other = two(tmp_path, bench.session)
    close(bench.session, other, quiet)
    bench.close()
    bench = Bench(kept_in=tmp_path / "sessions")
    try:
        bench.go_on("000001", quiet)
        assert names(bench.session) == ["one.npz"]
    finally:
        bench.close()


def test_what_is_masked_is_there_as_it_was_recorded_and_in_no_other_column() -> None:
    capture = kc.simulate("knob4", "sweep", duration_s=1.0)
    tau, mask = capture.tau.copy(), capture.mask.copy()
    tau[:20], mask[:20] = 7.0, False
    session = Session()
    session.take(dataclasses.replace(capture, tau=tau, mask=mask), "spoiled")
    told = arrays.columns(session.view, 0, ["t", "tau", "masked"])
    t, measured, masked = np.frombuffer(told[-3 * 4 * capture.samples :], dtype="<f4").reshape(3, -1)
    assert np.allclose(t, capture.t) and not np.any(np.isnan(t))
    assert np.all(masked[:20] == 7.0) and np.all(np.isnan(measured[:20]))
    assert np.all(np.isnan(masked) == ~np.isnan(measured))


def test_of_columns_without_names_the_roughest_is_guessed_to_be_the_torque(tmp_path: Path) -> None:
    t = np.arange(4000) / 1000.0
    position = 0.1 * np.sin(2.0 * t)
    volts = np.sign(np.cos(2.0 * t)) + 0.1 * np.random.default_rng(1).standard_normal(len(t))
    path = tmp_path / "log.npz"
    np.savez(path, qa=position, qb=position + 1e-4 * np.cos(40.0 * t), t=t, u0=volts)
    with pytest.raises(InputError) as refused:
        kc.load(path)
    told = explained(refused.value, path, {}, 10**8)
    assert isinstance(told, Unmapped)
    assert {name: one["expression"] for name, one in told.guess.items()} == {
        **{"t": "`t`", "theta": "`qb`", "tau": "`u0`"}  # of two alike `qa` is the smoother: it was asked for
    }
    assert {one["unit"] for one in told.guess.values()} == {None}  # nobody can know: metres are no radians


def test_a_file_of_one_column_is_said_to_be_no_capture_in_no_names_of_columns(tmp_path: Path) -> None:
    path = tmp_path / "map.npy"
    np.save(path, np.random.default_rng(1).standard_normal(500))
    with pytest.raises(InputError) as refused:
        kc.load(path)
    told = str(explained(refused.value, path, {}, 10**8))
    assert told.startswith("map.npy: this file has one column of numbers alone") and told.endswith(
        "open another file."
    )
    assert "_" not in told


def test_what_is_said_to_be_missing_is_not_said_to_be_needless_once_it_is_added() -> None:
    """Of few independent samples an effect cannot pay its price, though nothing else explains the rest."""
    path = real(SHARED / "dfki_pendulum" / "pd_system_identification.csv")
    session = Session()
    session.open(str(path))
    session.weigh()
    session.add("unbalance")
    session.weigh()
    page = state.document(session)
    assert Said.of(page["concluded"]).startswith("unbalance found")
    assert "too little" not in Said.of(page["verdict"])


def test_a_log_whose_columns_have_to_be_named_is_asked_about_on_the_page(tmp_path: Path) -> None:
    t = np.arange(0.0, 2.0, 1e-3)
    log = tmp_path / "log.csv"
    columns = np.column_stack([t, np.sin(9.0 * t), np.cos(9.0 * t) + 0.1 * np.sign(np.cos(9.0 * t))])
    np.savetxt(log, columns, delimiter=",", header="zeit,qm,u", comments="")
    with started(log) as (client, process):
        state = client.get("/api/state").json()
        assert state["unread"] == [str(log)] and state["captures"] == []
        asked = client.post("/api/open", json={"path": str(log)})
        assert asked.status_code == 400 and [one["name"] for one in asked.json()["columns"]]
        mapped = {"map": "t=zeit [s], theta=qm [rad], tau=u [N m]"}
        assert client.post("/api/open", json={"path": str(log), **mapped}).status_code == 200
        assert client.get("/api/state").json()["unread"] == []
        process.send_signal(signal.SIGTERM)
        process.wait(20.0)
        assert process.stderr is not None and "the page asks for it, too" in process.stderr.read()
    refused(knobcam("workbench", "--no-browser", log, "--map", "t=zeit"), "theta is missing")


def test_a_unit_of_time_that_nobody_knows_is_left_for_the_page_to_ask(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    t = np.arange(200.0)
    columns = np.column_stack([t, np.sin(0.09 * t), np.cos(0.09 * t)])
    np.savetxt(log, columns, delimiter=",", header="time [samples],angle [rad],torque [Nm]", comments="")
    with pytest.raises(InputError) as refusal:
        kc.load(log)
    asked = explained(refusal.value, log, {}, 10**9)
    assert isinstance(asked, Unmapped) and asked.guess["t"] == {
        "expression": "`time [samples]`",
        "unit": None,
    }
    assert asked.guess["theta"]["unit"] == "rad"


def test_columns_that_are_all_guessed_are_asked_to_be_looked_at_in_no_names_of_the_command(
    tmp_path: Path,
) -> None:
    log = tmp_path / "messung.csv"
    t = np.arange(0.0, 4.0, 1e-3)
    rows = np.column_stack([1e3 * t, 60.0 * np.sin(9.0 * t), 20.0 * np.cos(9.0 * t)])
    np.savetxt(log, rows, delimiter=";", header="Kanal 1;Kanal 2;Kanal 3\nms;°;mNm", comments="", fmt="%.4f")
    with pytest.raises(InputError, match="not plain enough") as refusal:
        kc.load(log)
    asked = explained(refusal.value, log, {}, 10**9)
    assert isinstance(asked, Unmapped) and {*asked.guess} == {"t", "theta", "tau"}
    assert "fields hold what they seem to be" in str(asked) and "theta" not in str(asked)


def test_what_came_in_stays_in_the_headline_while_something_else_is_missing() -> None:
    session = Session()
    knob = kc.hiding("knob4", "return_spring", "stribeck", motion="sweep", duration_s=4.0)
    session.take(kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0), "both")
    session.weigh()
    assert state.document(session)["added"] == []
    session.add("stribeck")
    assert state.document(session)["added"] == ["stribeck"]
    session.weigh()
    page = state.document(session)
    assert page["candidates"]["rows"][0]["could_be"] and page["added"] == ["stribeck"]
    session.add("return_spring")
    session.weigh()
    page = state.document(session)
    assert "stribeck and return_spring" in Said.of(page["concluded"]) and page["added"] == []


def test_an_error_like_chances_does_not_hide_values_that_no_knob_has() -> None:
    session = Session()
    knob = kc.Model.load("knob4").with_value("viscous.pos", -4e-4).with_value("viscous.neg", -4e-4)
    session.take(kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0, seed=1), "gives power back")
    session.weigh()
    said = Said.of(state.document(session)["verdict"])
    assert "chance explains it. But viscous." in said and "which no real knob has" in said


def test_a_floor_that_was_read_from_what_the_model_left_is_told_of_each_step() -> None:
    """What is wrong in every stretch of a slow turn passes for coloured noise until the model has it."""
    t = np.arange(20000) / 1000.0
    theta = 0.5 * t + 0.02 * np.sin(3.0 * t)
    white = np.random.default_rng(1).normal(size=t.size) * 2e-4
    noise = lfilter([1.0], [1.0, -0.9], white)
    pull = 0.01 + 0.002 * np.gradient(theta, t) + 0.01 * np.sin(24.0 * theta) + 0.003 * np.sin(48.0 * theta)
    session = Session()
    session.take(kc.Capture.from_arrays(t=t, theta=theta, tau=pull + noise), "slow")
    session.add("cogging")
    first, now = (one["noise_floor"] for one in state.document(session)["branches"][0]["steps"])
    assert (
        first is not None
        and now is not None
        and now < 0.9 * first
        and now == pytest.approx(noise.std(), rel=0.2)
    )
