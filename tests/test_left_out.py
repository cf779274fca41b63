"""Samples that a person leaves out: in a call, on the command line, at the workbench."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from command import knobcam, refused
from workbench_server import wrong

import knobcam as kc
from knobcam.errors import InputError
from knobcam.workbench import ruling, saving
from knobcam.workbench.bench import Bench
from knobcam.workbench.tell import quiet

TOUCHED = slice(1000, 1501)  # samples that a hand spoilt


def touched(folder: Path) -> Path:
    """A log in which a hand held the knob for half a second."""
    capture = kc.simulate("knob4", "sweep", duration_s=4.0, rate_hz=1000.0, seed=2)
    tau = capture.tau.copy()
    tau[TOUCHED] += 0.02
    path = folder / "touched.csv"
    columns = np.column_stack([capture.t, capture.theta, tau])
    np.savetxt(path, columns, delimiter=",", header="t_s,theta_rad,tau_Nm", comments="")
    return path


def stretch(capture: kc.Capture) -> tuple[float, float]:
    return ruling.around(capture.t, TOUCHED.start, TOUCHED.stop - 1)


def test_what_lies_in_a_stretch_is_masked_and_said_and_comes_back_where_that_is_overruled(
    tmp_path: Path,
) -> None:
    log = touched(tmp_path)
    whole = kc.load(log)
    capture = kc.load(log, leave_out=[stretch(whole)])
    assert np.flatnonzero(~capture.mask & whole.mask).tolist() == list(range(TOUCHED.start, TOUCHED.stop))
    assert (capture.tau == whole.tau).all()
    (found,) = (one for one in capture.findings if one.key == "left_out:t")
    assert found.severity == "masked" and found.count == 501 and capture.where(found) == [(1000, 1500)]
    assert "1.000 to 1.502 s" in found.message
    counted = kc.load(log, leave_out=[stretch(whole)], overrule=["left_out:t"])
    assert (counted.mask == whole.mask).all() and counted.overrules("left_out", "t")
    saved = capture.save(tmp_path / "saved.npz")
    assert (kc.load(saved).mask == capture.mask).all()
    assert kc.load(saved, overrule=["left_out:t"]).mask[TOUCHED].all()
    assert (whole.leave_out(stretch(whole)).mask == capture.mask).all()


def test_the_command_leaves_out_the_same(tmp_path: Path) -> None:
    log = touched(tmp_path)
    first, last = stretch(kc.load(log))
    told = knobcam("fit", log, "--model", "knob4", "--leave-out", f"{first}:{last}", "--json")
    assert told.code == 0, told.err
    assert "501 samples are left out" in told.out
    refused(knobcam("fit", log, "--model", "knob4", "--leave-out", "1.0"), "is no stretch of time")


@pytest.mark.parametrize(
    ("stretches", "said"),
    [
        ([(7.0, 9.0)], r"no sample lies from 7 to 9 s, to be left out; the capture runs from 0\.001 to 4 s"),
        ([(2.0, 1.0)], "is no stretch; give two times in s"),
        ([(1.0, float("inf"))], "is no stretch"),
        ([(-1.0, 9.0)], "leaves fewer than 2 usable samples"),
    ],
)
def test_a_stretch_that_is_none_is_refused(tmp_path: Path, stretches: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        kc.load(touched(tmp_path), leave_out=stretches)


def test_at_the_workbench_it_is_undone_goes_into_the_script_and_report_and_goes_on(tmp_path: Path) -> None:
    bench = Bench(kept_in=tmp_path / "sessions")
    session = bench.session
    (first,) = session.open(str(touched(tmp_path)))
    before = session.node
    second = ruling.leave_out(session, {first: [(1000, 1200)]}, bench.file_of, quiet)
    ruling.leave_out(session, {second: [(1180, 1500)]}, bench.file_of, quiet)
    (now,) = (session.captures[one] for one in session.node.captures)
    assert len(now.options["leave_out"]) == 1 and not now.capture.mask[TOUCHED].any()
    assert session.node.fit.rmse < 0.5 * before.fit.rmse
    left = session.node.fit.rmse
    script = saving.save(session, "script", tmp_path / "again.py", quiet)
    assert runpy.run_path(str(script))["fit"].rmse == pytest.approx(left, rel=1e-9)
    report = saving.save(session, "report", tmp_path / "report.html", quiet).read_text()
    assert "501 samples are left out because a person said so" in report
    bench.close()
    bench = Bench(kept_in=tmp_path / "sessions")
    try:
        bench.go_on("000001", quiet)
        session = bench.session
        assert session.node.fit.rmse == pytest.approx(left, rel=1e-9)
        session.undo()
        session.undo()
        assert session.node.fit.rmse == pytest.approx(before.fit.rmse, rel=1e-9)
    finally:
        bench.close()


def test_of_a_simulated_capture_samples_are_left_out_too_and_taken_in_again(
    client: httpx.Client, bench: Bench, tmp_path: Path
) -> None:
    made = {"knob": "knob4", "effects": [], "motion": "sweep", "duration_s": 2.0}
    assert client.post("/api/simulate", json=made).status_code == 200
    (capture,) = client.get("/api/state").json()["captures"]
    body: dict[str, Any] = {"runs": {capture["id"]: [[100, 400], [600, 700]]}}
    assert client.post("/api/leave-out", json=body).status_code == 200
    (now,) = bench.session.node.captures
    assert int((~bench.session.captures[now].capture.mask).sum()) == 402
    script = saving.save(bench.session, "script", tmp_path / "again.py", quiet)
    assert ".leave_out((" in script.read_text()
    assert runpy.run_path(str(script))["fit"].rmse == pytest.approx(bench.session.node.fit.rmse, rel=1e-9)
    body = {"capture": now, "finding": "left_out:t", "on": True}
    assert client.post("/api/overrule", json=body).status_code == 200
    (again,) = bench.session.node.captures
    assert bench.session.captures[again].capture.mask.all()
    for runs, said in (
        ({}, "runs: give"),
        ({again: [[5, 3]]}, "samples are from 0 to"),
        ({again: [[0, 10**9]]}, "samples are from 0 to"),
        ({again: [[0.5, 3]]}, "runs: give"),
        ({"c99": [[0, 3]]}, "is not in this session"),
    ):
        wrong(client.post("/api/leave-out", json={"runs": runs}), 400, said)
