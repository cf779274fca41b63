"""The workbench's server: what it answers, and what it says of what is wrong."""

from __future__ import annotations

import base64
import contextlib
import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, get_args
from urllib.parse import quote

import httpx
import numpy as np
import pytest
from command import knobcam, refused
from workbench_server import HOSTILE, wrong

import knobcam as kc
from knobcam.base.pages_said import Along
from knobcam.base.said import Said
from knobcam.errors import InputError
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER
from knobcam.workbench.serving import listen


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture of 1 s."""
    folder = tmp_path_factory.mktemp("captures")
    return kc.simulate("knob4", "sweep", duration_s=1.0).save(folder / "small.npz")


def test_the_state_is_strict_json_before_and_after_a_capture(client: httpx.Client, small: Path):
    assert client.get("/api/state").json()["node"] is None
    assert client.post("/api/open", json={"path": str(small)}).json()["revision"] > 0
    document = client.get("/api/state").json()
    assert document["schema"] == "knobcam.workbench/1"
    assert [one["name"] for one in document["captures"]] == ["small.npz"]
    assert document["job"] is None or document["job"]["id"].startswith("j")


def test_an_effect_is_added_undone_and_redone(opened: httpx.Client):
    before = opened.get("/api/state").json()
    assert opened.post("/api/add", json={"effect": "return_spring"}).status_code == 200
    after = opened.get("/api/state").json()
    assert after["rmse"] < before["rmse"]
    opened.post("/api/undo")
    again = opened.get("/api/state").json()
    assert again["params"] == before["params"]  # numbers of JSON are those of the fit to the last bit
    assert again["node"] == before["node"]
    opened.post("/api/redo")
    assert opened.get("/api/state").json()["params"] == after["params"]
    opened.post("/api/branch", json={"name": "aside"})
    opened.post("/api/drop", json={"effect": "return_spring"})
    assert len(opened.get("/api/state").json()["branches"]) == 2
    opened.post("/api/switch", json={"branch": before["branch"]})
    assert opened.get("/api/state").json()["node"] == after["node"]


def test_candidates_come_by_themselves(opened: httpx.Client, bench: Bench):
    opened.post("/api/diagnose")
    job = bench.weighing.current
    if job is not None:
        job.result.result(60.0)
    state = opened.get("/api/state").json()
    assert state["candidates"]["ready"]
    top = state["candidates"]["rows"][0]
    assert top["effect"] == "return_spring"
    (place,) = [part for part in state["verdict"] if "low" in part]
    said = Said.of(state["verdict"])
    assert f"worst at {Said.of([place])}" in said and place["low"] < place["high"]
    assert f"most along {place['axis']}" in said and {"along": place["axis"]} in state["verdict"]
    query = {"node": state["node"], "capture": state["active"][0], "effect": top["effect"]}
    assert opened.get("/api/signature", params=query).status_code == 200
    wrong(opened.get("/api/signature", params=query | {"effect": HOSTILE}), 400, "is not weighed")


def test_samples_come_as_a_line_of_json_and_floats(opened: httpx.Client, sprung: kc.Capture):
    state = opened.get("/api/state").json()
    query = {"node": state["node"], "capture": state["active"][0], "names": "theta,residual"}
    content = opened.get("/api/arrays", params=query).content
    head = json.loads(content.split(b"\n")[0])
    assert head == {"names": ["theta", "residual"], "n": sprung.samples, "dtype": "f32"}
    assert len(content) % 4 == 0
    for change in ({"node": "n99"}, {"capture": HOSTILE}, {"names": HOSTILE}, {"names": ""}):
        wrong(opened.get("/api/arrays", params=query | change), 400, "")


def test_captures_of_one_name_are_told_apart(tmp_path: Path):
    files = [tmp_path / folder / "knob.npz" for folder in ("a", "b", "c")]
    for number, file in enumerate(files):
        file.parent.mkdir()
        kc.simulate("knob1", "sweep", duration_s=2, seed=number).save(file)
    session = Bench().session
    session.open(*map(str, files[:2]))
    session.open(str(files[2]))
    assert [one.name for one in session.captures.values()] == ["knob.npz", "knob.npz (2)", "knob.npz (3)"]


def test_where_the_error_lies_is_told_of_every_axis_that_samples_have(opened: httpx.Client):
    node = opened.get("/api/state").json()["node"]
    splits = opened.get("/api/splits", params={"node": node}).json()["splits"]
    assert {one["axis"] for one in splits} == set(get_args(Along))
    for one in splits:
        bins = zip(one["low"], one["high"], one["direction"], one["mean"], one["band"], strict=True)
        assert all(low <= high and side in (-1, 0, 1) and band > 0.0 for low, high, side, _, band in bins)
    opened.post("/api/params", json={"viscous.pos": 0.01})
    moved = opened.get("/api/state").json()["node"]
    assert opened.get("/api/splits", params={"node": moved}).json() == {"splits": []}
    wrong(opened.get("/api/splits", params={"node": HOSTILE}), 400, "")
    opened.post("/api/snap")


def test_a_dragged_parameter_has_a_node_of_its_own_to_fetch(opened: httpx.Client):
    fitted = opened.get("/api/state").json()
    opened.post("/api/params", json={"viscous.pos": 0.01})
    moved = opened.get("/api/state").json()
    assert moved["node"] != fitted["node"]
    assert moved["rmse"] > fitted["rmse"]
    assert moved["rmse_heldout"] is None
    query = {"capture": moved["active"][0], "names": "model"}
    model = [
        opened.get("/api/arrays", params=query | {"node": one["node"]}).content for one in (fitted, moved)
    ]
    assert model[0] != model[1]
    opened.post("/api/snap")
    assert opened.get("/api/state").json()["node"] == fitted["node"]


def test_the_share_of_a_region_is_told(opened: httpx.Client, sprung: kc.Capture):
    capture = opened.get("/api/state").json()["active"][0]
    every = np.arange(sprung.samples, dtype="<u4").tobytes()
    body = {"capture": capture, "indices": base64.b64encode(every).decode()}
    assert opened.post("/api/share", json=body).json()["share"] == pytest.approx(1.0)
    wrong(opened.post("/api/share", json=body | {"indices": "x"}), 400, "indices")
    wrong(opened.post("/api/share", json=body | {"indices": "AAA="}), 400, "indices")


@pytest.mark.parametrize(
    ("verb", "body"),
    [
        ("add", {}),
        ("add", {"effect": 3}),
        ("add", {"effect": HOSTILE}),
        ("add", {"effect": "coulomb"}),
        ("drop", {"effect": "stribeck"}),
        ("switch", {"branch": "b99"}),
        ("params", {"nope.x": 1.0}),
        ("params", {"detent.P": "1"}),
        ("open", {"path": "/no/such\nfile"}),
        ("open", {"path": "a\0b"}),
        ("open", {"path": ".", "rate_hz": "fast"}),
        ("open", {"path": "x", "coordinate": HOSTILE}),
        ("use", {"captures": "c1"}),
        ("use", {"captures": []}),
        ("save", {"what": "model", "path": "/no/such/folder/x"}),
        ("save", {"what": HOSTILE, "path": "x"}),
        ("undo", {}),
        ("redo", {}),
    ],
)
def test_a_wrong_input_is_answered_with_one_line_and_changes_nothing(
    opened: httpx.Client, verb: str, body: Any
):
    before = opened.get("/api/state").json()
    wrong(opened.post(f"/api/{verb}", json=body), 400, "")
    after = opened.get("/api/state").json()
    assert after["branches"] == before["branches"]
    assert after["captures"] == before["captures"]


@pytest.mark.parametrize("body", [b"{", b"[1]", b"\xff", b'"add"', b"[" * 100_000])
def test_a_body_that_is_no_object_is_answered_with_one_line(opened: httpx.Client, body: bytes):
    wrong(opened.post("/api/add", content=body), 400, "JSON")


def test_a_file_that_is_handed_over_becomes_a_capture(client: httpx.Client, small: Path):
    name = quote("../../my <b>knob</b>.npz")
    answer = client.post("/api/upload", content=small.read_bytes(), headers={"x-filename": name})
    assert answer.status_code == 200, answer.text
    # No folder of the name is left, and what is left of it is text.
    assert [one["name"] for one in client.get("/api/state").json()["captures"]] == ["b>.npz"]


def test_a_foreign_file_is_read_by_its_map(client: httpx.Client, tmp_path: Path):
    capture = kc.simulate("knob4", "sweep", duration_s=1.0)
    rows = np.column_stack([capture.t, np.degrees(capture.theta), capture.tau])
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header="time,deg,M", comments="")
    content = (tmp_path / "x.csv").read_bytes()
    wrong(client.post("/api/upload", content=content, headers={"x-filename": "x.csv"}), 400, "x.csv")
    query = {"map": "t=time, theta=deg [deg], tau=M"}
    answer = client.post("/api/upload", params=query, content=content, headers={"x-filename": "x.csv"})
    assert answer.status_code == 200, answer.text


def test_what_can_be_saved_can_be_fetched(opened: httpx.Client, tmp_path: Path):
    for what, start in (("model", b"axis"), ("script", b'"""A session'), ("report", b"<!DOCTYPE html>")):
        answer = opened.get("/api/download", params={"what": what})
        assert answer.status_code == 200
        assert start in answer.content[:300]
    target = tmp_path / "model.toml"
    saved = opened.post("/api/save", json={"what": "model", "path": str(target)}).json()
    assert saved["path"] == str(target)
    assert kc.Model.load(target).effects
    wrong(opened.post("/api/save", json={"what": "model", "path": str(target)}), 400, "exists already")
    long = str(tmp_path / ("x" * 300))
    wrong(opened.post("/api/save", json={"what": "model", "path": long}), 400, "name too long")
    wrong(opened.get("/api/download", params={"what": "../../x"}), 400, "cannot be saved")


def test_work_is_cancelled_and_nothing_changed(opened: httpx.Client, bench: Bench):
    before = opened.get("/api/state").json()
    job = bench.work.start("waiting", lambda job: [job.rest(60.0)])
    now = opened.get("/api/state").json()["job"]
    assert 0.0 <= now.pop("seconds") < 60.0
    assert now == {
        **{"id": job.id, "what": ["waiting"], "done": None, "recording": False},
        **{"takes_s": None, "stops": False},
    }
    assert opened.post("/api/cancel").status_code == 200
    with pytest.raises(InputError, match="cancelled"):
        job.result.result(10.0)
    after = opened.get("/api/state").json()
    assert (after["node"], after["params"]) == (before["node"], before["params"])


def test_weighing_says_how_far_it_is_rests_while_a_person_waits_and_ends_when_it_is_given_up(
    opened: httpx.Client, bench: Bench, monkeypatch: Any
):
    weighed = bench.session.weigh

    def slowly(tell: Any, node: Any) -> None:
        # On any machine it has far to go where it is given up.
        for step in range(1, 1000):
            tell("weighing", 1e-3 * step)
            time.sleep(0.01)
        weighed(tell, node)

    monkeypatch.setattr(bench.session, "weigh", slowly)
    job = bench.weigh()

    def told_before(share: float) -> None:
        while job.active and not (job.done is not None and job.done > share):
            time.sleep(0.005)

    told_before(0.0)
    waited = bench.work.start("waiting", lambda work: work.rest(1.5))
    share, since = job.done, time.monotonic()
    while waited.active and time.monotonic() - since < 0.3:
        if job.done != share:  # it has not noticed yet
            share, since = job.done, time.monotonic()
        time.sleep(0.005)
    assert waited.active and job.active and share is not None and 0.0 < share < 1.0
    waited.result.result(5.0)
    told_before(share)
    assert opened.post("/api/cancel").status_code == 200
    assert not job.active
    deadline = time.monotonic() + 5.0
    while bench.busy and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not bench.busy
    assert bench.session.diagnosis_of(bench.session.node.id) is None


def test_a_failure_of_the_program_is_one_line_as_well(opened: httpx.Client, bench: Bench, monkeypatch: Any):
    def broken(*_: Any) -> None:
        raise ZeroDivisionError("by\nnought")

    monkeypatch.setattr(bench.session, "add", broken)
    wrong(opened.post("/api/add", json={"effect": "stribeck"}), 500, "ZeroDivisionError: by nought")


def test_a_port_that_is_taken_is_told_in_one_line():
    with listen(0) as taken, pytest.raises(InputError, match="cannot be had"):
        listen(taken.getsockname()[1])
    with pytest.raises(InputError, match="cannot be had"):
        listen(70_000)


def test_a_capture_that_is_not_there_ends_the_command(tmp_path: Path):
    refused(knobcam("workbench", "--no-browser", tmp_path / "none.csv"), "none.csv")


def test_without_its_packages_the_workbench_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    refused(knobcam("workbench", "--no-browser"), 'pip install "knobcam[all]"')


def test_the_command_prints_its_address_tells_what_happens_and_ends_by_an_interrupt(small: Path):
    words = [sys.executable, "-m", "knobcam", "workbench", "--no-browser", str(small)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            address = process.stdout.readline().strip()
            base, token = address.split("/?token=")
            assert base.startswith("http://127.0.0.1:")
            headers = {HEADER: token}
            assert httpx.get(address).status_code == 200
            assert httpx.get(f"{base}/").status_code == 403
            assert httpx.get(f"{base}/api/state", headers=headers).json()["node"] is not None
            with httpx.stream("GET", f"{base}/api/events?token={token}", timeout=30.0) as events:
                lines = (line for line in events.iter_lines() if line.startswith("event:"))
                assert next(lines) == "event: state"
                httpx.post(f"{base}/api/diagnose", headers=headers)
                assert "event: progress" in (next(lines), next(lines), next(lines))
                started = time.monotonic()
                process.send_signal(signal.SIGINT)
                with contextlib.suppress(httpx.HTTPError):
                    list(lines)
            assert process.wait(20.0) == 0
            assert time.monotonic() - started < 10.0
            assert process.stderr.read() == ""
        finally:
            process.kill()


def test_a_file_with_other_columns_is_refused_with_what_they_look_like(client: httpx.Client, tmp_path: Path):
    path = tmp_path / "log.npz"
    t = np.arange(6000) / 6000.0
    turned = np.where(t < 0.5, np.nan, np.sin(40.0 * t))
    np.savez(
        path,
        zeit=t,
        winkel=turned,
        still=np.full(6000, 3.0),
        empty=np.full(6000, np.nan),
        one=np.float64(1.0),
    )
    answers = [
        client.post("/api/open", json={"path": str(path)}),
        client.post("/api/upload", content=path.read_bytes(), headers={"x-filename": HOSTILE.encode()}),
    ]
    for answer in answers:
        assert answer.status_code == 400
        # What never changes is no torque: the fields cannot hold what they seem to be.
        assert "say which column is which" in answer.json()["error"]
        told = {column["name"]: column for column in answer.json()["columns"]}
        assert list(told) == ["zeit", "winkel", "still", "empty"]
        assert (told["zeit"]["low"], told["zeit"]["rows"]) == (0.0, 6000)
        assert told["zeit"]["outline"][0][0] == 0.0 and told["zeit"]["outline"][-1][1] == 1.0
        assert len(told["winkel"]["outline"]) == 30  # of 60 pieces half are gaps
        assert told["still"]["outline"][0] == [0.0, 0.0] and told["empty"]["outline"] == []
    wrong(client.post("/api/open", json={"path": str(tmp_path / "none.npz")}), 400, "cannot be read")
    assert "columns" not in client.post("/api/open", json={"path": str(tmp_path / "none.npz")}).json()


def test_a_file_that_is_handed_over_is_refused_by_its_own_name_once(client: httpx.Client):
    rows = "\n".join(f"{0.001 * i:.3f},{np.sin(0.01 * i):.6f},{np.cos(0.01 * i):.6f}" for i in range(2000))
    log = f"Time,Position,Iq\n{rows}\n".encode()
    answer = client.post("/api/upload", content=log, headers={"x-filename": "motor.csv"})
    said = answer.json()["error"]
    assert answer.status_code == 400 and "say which column is which, and in what unit" in said
    assert said.startswith("motor.csv: Iq seems to be the motor's current") and said.count("motor.csv") == 1
