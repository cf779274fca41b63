"""Captures without a file at hand: simulated, from an emulated rig, from one on a port; watched, stopped."""

from __future__ import annotations

import json
import os
import runpy
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import numpy as np
import pytest
from workbench_server import HOSTILE, served, wrong

import knobcam as kc
from knobcam.model.hiding import hideable
from knobcam.rig import port as port_module
from knobcam.rig.calibration import Calibration
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.tail import Tail
from knobcam.workbench import sources
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER
from knobcam.workbench.thinning import Thinned

SPEED = 8.0
EMULATED = {"source": "emulated", "knob": "knob3", "duration_s": 4.0, "speed": SPEED}


@pytest.fixture
def rigs(monkeypatch: pytest.MonkeyPatch) -> list[EmulatedRig]:
    """The emulated rigs that the workbench starts."""
    started: list[EmulatedRig] = []

    def start(*args: Any, **options: Any) -> EmulatedRig:
        started.append(EmulatedRig(*args, **options))
        return started[-1]

    monkeypatch.setattr(sources, "EmulatedRig", start)
    return started


def seen(client: httpx.Client, since: int = 0) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """What the page sees of a recording: the figures, and the columns from a sample on."""
    answer = client.get("/api/live", params={"since": since})
    assert answer.status_code == 200, answer.text
    line = answer.content.split(b"\n")[0]
    head = json.loads(line)
    floats = np.frombuffer(answer.content[-(-(len(line) + 1) // 4) * 4 :], dtype="<f4")
    return head["live"], dict(zip(head["names"], floats.reshape(len(head["names"]), head["n"]), strict=True))


def until(true: Callable[[], bool]) -> None:
    """Wait until something is true."""
    end = time.monotonic() + 30.0
    while not true():
        assert time.monotonic() < end, "it does not come true"
        time.sleep(0.02)


def ended(client: httpx.Client) -> dict[str, Any]:
    """What is told of the recording when it has ended."""
    until(lambda: bool(seen(client)[0]["ended"]))
    return seen(client)[0]


def begun(client: httpx.Client, **body: Any) -> Path:
    """Begin a recording; its wire log."""
    answer = client.post("/api/record", json=body)
    assert answer.status_code == 200, answer.text
    return Path(answer.json()["log"])


def rows_of(client: httpx.Client) -> list[dict[str, Any]]:
    captures: list[dict[str, Any]] = client.get("/api/state").json()["captures"]
    return captures


@pytest.mark.parametrize("hidden", [[], ["return_spring", "unbalance"]])
def test_a_knob_is_simulated_and_the_script_makes_the_same_capture(
    client: httpx.Client, bench: Bench, tmp_path: Path, hidden: list[str]
) -> None:
    body = {"knob": "knob4", "effects": hidden, "motion": "turns", "duration_s": 3.0, "seed": 7}
    assert client.post("/api/simulate", json=body).status_code == 200
    state = client.get("/api/state").json()
    assert state["captures"][0]["name"] == "knob4, simulated turns"
    script = tmp_path / "session.py"
    script.write_bytes(client.get("/api/download", params={"what": "script"}).content)
    made, kept = runpy.run_path(str(script))["capture_1"], bench.session.captures["c1"].capture
    for name in ("t", "theta", "omega", "alpha", "tau"):
        np.testing.assert_array_equal(getattr(made, name), getattr(kept, name))


def test_a_recording_from_the_emulated_rig_is_seen_as_it_grows_and_taken_in(
    client: httpx.Client, tmp_path: Path
) -> None:
    log = begun(client, **EMULATED, effects=["stribeck"], folder=str(tmp_path))
    assert log.parent == tmp_path
    shares, shown = [], 0
    columns: dict[str, list[np.ndarray]] = {}
    while True:
        live, more = seen(client, shown)
        shares.append(live["done"])
        shown += len(more["t"])
        for name, column in more.items():
            columns.setdefault(name, []).append(column)
        if live["ended"]:
            break
        time.sleep(0.02)
    assert live["error"] is None and live["missing"] == 0
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert len({share for share in shares if 0.0 < share < 1.0}) > 2
    capture = kc.load(log)
    assert live["received"] == capture.samples
    assert live["elapsed_s"] == pytest.approx(live["total_s"]) == pytest.approx(capture.samples / 5000.0)
    at = np.searchsorted(capture.t, np.concatenate(columns["t"]) - 1e-4)
    for name in ("theta", "omega", "tau"):
        np.testing.assert_allclose(np.concatenate(columns[name]), getattr(capture, name)[at], atol=1e-5)
    state = client.get("/api/state").json()
    assert state["captures"][0]["name"] == log.name and state["captures"][0]["samples"] == capture.samples
    assert state["recording"] is False


def test_a_recording_is_stopped_and_what_came_is_taken_in(client: httpx.Client, tmp_path: Path) -> None:
    log = begun(client, **EMULATED | {"duration_s": 30.0}, motion="multisine", folder=str(tmp_path))
    until(lambda: seen(client)[0].get("received", 0) > 8000)
    assert client.post("/api/stop", json={"keep": True}).status_code == 200
    live = ended(client)
    assert live["error"] is None and live["done"] < 1.0
    account = kc.WireLog.load(log).runs[-1]["account"]
    assert account["produced"] is not None, "the rig itself has said that the run and its torque are over"
    assert account["missing"] == 0
    assert rows_of(client)[0]["samples"] == kc.load(log).samples == account["received"] > 8000
    wrong(client.post("/api/stop", json={}), 400, "nothing is being recorded")


def test_a_recording_that_nobody_wants_changes_nothing_and_is_kept_as_a_log(
    client: httpx.Client, tmp_path: Path
) -> None:
    log = begun(client, **EMULATED | {"duration_s": 30.0}, motion="multisine", folder=str(tmp_path))
    until(lambda: seen(client)[0].get("received", 0) > 2000)
    client.post("/api/stop", json={"keep": False})
    live = ended(client)
    kept = kc.WireLog.load(log)
    assert f"cancelled; nothing was changed; {kept.samples} samples are kept in {log}" == live["error"]
    assert kept.runs[-1]["account"]["produced"] is not None
    assert rows_of(client) == []


def test_a_rig_that_is_killed_while_it_records_is_told_and_what_came_can_be_opened(
    client: httpx.Client, tmp_path: Path, rigs: list[EmulatedRig]
) -> None:
    log = begun(client, **EMULATED | {"duration_s": 30.0}, motion="multisine", folder=str(tmp_path))
    until(lambda: seen(client)[0].get("received", 0) > 5000)
    os.kill(rigs[0].pid, signal.SIGKILL)
    live = ended(client)
    assert "gone" in live["error"] and "\n" not in live["error"]
    assert live["error"].endswith(f"{kc.WireLog.load(log).samples} samples are kept in {log}")
    assert rows_of(client) == []
    assert client.post("/api/open", json={"path": str(log)}).status_code == 200
    assert rows_of(client)[0]["samples"] > 5000


def test_the_script_of_a_recorded_capture_reads_its_wire_log(client: httpx.Client, tmp_path: Path) -> None:
    log = begun(client, **EMULATED | {"duration_s": 2.0}, folder=str(tmp_path))
    ended(client)
    script = client.get("/api/download", params={"what": "script"}).text
    assert f"capture_1 = kc.load({str(log)!r})" in script
    again = begun(client, **EMULATED | {"duration_s": 2.0}, folder=str(tmp_path))
    assert [log.name, again.name] == ["knob3-sweep-1.kcwire", "knob3-sweep-2.kcwire"]
    ended(client)


@pytest.mark.parametrize("knob", kc.KNOBS)
def test_whatever_is_offered_can_be_hidden(knob: str) -> None:
    bare = kc.Model.load(knob)
    for effect in hideable(knob):
        assert set(kc.hiding(knob, effect).effects) - set(bare.effects) == {effect}
    with pytest.raises(kc.InputError, match="a model has one of them"):
        kc.hiding(knob, "backlash", "compliance")


def test_a_surprise_leaves_a_trace() -> None:
    # Neither the lag nor the limit of the sensor shows in so slow a sweep of so light a knob.
    hidden = {sources.simulated({"surprise": True, "knob": "knob3"}).hidden[0] for _ in range(40)}
    assert len(hidden) > 5 and not hidden & {"torque_lag", "saturation"}


def test_a_surprise_is_told_to_who_asks_and_to_nobody_else(client: httpx.Client, bench: Bench) -> None:
    assert client.post("/api/simulate", json={"surprise": True, "duration_s": 2.0}).status_code == 200
    state = client.get("/api/state").json()
    (hidden,) = bench.session.captures["c1"].hidden
    assert state["captures"][0]["hides"] is True
    assert hidden not in json.dumps(state["captures"])
    assert client.post("/api/hidden", json={"capture": "c1"}).json()["hidden"] == [hidden]
    assert repr(hidden) in client.get("/api/download", params={"what": "script"}).text
    wrong(client.post("/api/hidden", json={"capture": HOSTILE}), 400, "is not in this session")


def test_a_capture_of_another_knob_is_fitted_for_itself(client: httpx.Client) -> None:
    for seed, (knob, together) in enumerate((("knob3", False), ("knob4", False), ("knob4", True))):
        body = {"knob": knob, "duration_s": 2.0, "motion": "multisine", "together": together, "seed": seed}
        assert client.post("/api/simulate", json=body).status_code == 200
    first, second, third = (one["id"] for one in rows_of(client))
    assert client.get("/api/state").json()["active"] == [second, third]
    client.post("/api/undo")
    client.post("/api/undo")
    assert client.get("/api/state").json()["active"] == [first]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"knob": "knob6"}, "none of the five"),
        ({"knob": "/etc/passwd"}, "none of the five"),
        ({"knob": 3}, "no text"),
        ({"effects": [HOSTILE]}, "not in the catalogue"),
        ({"effects": ["coulomb"]}, "has it anyway"),
        ({"effects": ["offset"]}, "nothing to hide"),
        ({"effects": "stribeck"}, "list of ids"),
        ({"effects": ["stribeck"], "surprise": True}, "surprise"),
        ({"surprise": 1}, "true or false"),
        ({"motion": HOSTILE}, "is unknown"),
        ({"duration_s": "6"}, "duration_s"),
        ({"duration_s": 1e9}, "0.1 to 600"),
        ({"duration_s": float("nan")}, "duration_s"),
        ({"duration_s": True}, "duration_s"),
        ({"seed": 1.5}, "whole number"),
        ({"seed": -1}, "seed"),
        ({"seed": 10**400}, "seed"),
        ({"together": "yes"}, "true or false"),
    ],
)
def test_a_wrong_choice_is_answered_with_one_line_and_nothing_is_recorded(
    client: httpx.Client, tmp_path: Path, change: dict[str, Any], words: str
) -> None:
    for verb, body in (("simulate", {}), ("record", EMULATED | {"folder": str(tmp_path)})):
        wrong(client.post(f"/api/{verb}", content=json.dumps(body | change)), 400, words)
    assert rows_of(client) == [] and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"source": HOSTILE}, "is unknown"),
        ({"source": "port", "port": "  "}, "port is empty"),
        ({"source": "port", "port": "a\0b"}, "no text"),
        ({"source": "port", "port": "/dev/ttyNONE"}, "no such port"),
        ({"source": "port", "port": HOSTILE}, "no such port"),
        ({"source": "port", "port": str(Path(__file__))}, "no serial port"),
        ({"source": "port", "port": "serial:NONE-1"}, "no rig NONE-1"),
        ({"source": "port", "port": "x", "baud": 0}, "baud"),
        ({"source": "port", "port": "x", "calibration": "/no/such.toml"}, "knobcam calibrate"),
        ({"source": "port", "port": "x", "model": "/no/such.toml"}, "/no/such.toml"),
        ({"source": "port", "port": "x", "motion": "push"}, "is unknown"),
        ({"source": "port", "port": "x", "folder": "/no/such/folder"}, "there is none"),
        ({"speed": 0}, "speed"),
        ({"duration_s": 60.0, "speed": 100.0}, "the rig measures up to"),
    ],
)
def test_what_is_wrong_with_a_rig_is_answered_with_one_line(
    client: httpx.Client,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    change: dict[str, Any],
    words: str,
) -> None:
    monkeypatch.setattr("knobcam.rig.link.ports", dict)  # whatever this computer has is none of the test's
    body = EMULATED | {"folder": str(tmp_path)} | change
    wrong(client.post("/api/record", content=json.dumps(body)), 400, words)
    state = client.get("/api/state").json()
    assert state["captures"] == [] and list(tmp_path.iterdir()) == []
    until(lambda: client.get("/api/state").json()["recording"] is False)


def test_a_rig_on_a_port_is_recorded_from_as_the_command_does(client: httpx.Client, tmp_path: Path) -> None:
    calibration = tmp_path / "rig.toml"
    with EmulatedRig("knob4", speed=SPEED) as rig:
        Calibration(rig.serial_number, "2026-01-01", c_cal=1200.0).save(calibration)
        body = {"source": "port", "port": rig.port, "duration_s": 2.0, "calibration": str(calibration)}
        log = begun(client, **body, folder=str(tmp_path))
        busy = client.post("/api/record", json=body | {"folder": str(tmp_path)})
        live = ended(client)
    wrong(busy, 400, "a recording is under way")
    assert live["error"] is None
    assert log.name == "rig-sweep-1.kcwire"
    assert kc.load(log).meta["calibration"]["c_cal"] == 1200.0


def test_what_there_is_to_choose_from_is_told_and_names_of_ports_are_text(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    odd = SimpleNamespace(device=HOSTILE, description="</option><script>")
    monkeypatch.setattr(port_module.list_ports, "comports", lambda: [odd])
    told = client.get("/api/sources").json()
    assert told["ports"] == [{"port": HOSTILE, "words": "</option><script>"}]
    assert [one["name"] for one in told["knobs"]] == list(kc.KNOBS)
    assert "stribeck" in told["knobs"][0]["hideable"]
    assert set(told["motions"]["port"]) == set(told["motions"]["emulated"]) == set(kc.MOTIONS)
    assert told["folder"] == str(Path.cwd())
    assert told["no_emulated_rig"] is None


def test_where_there_are_no_pseudo_terminals_it_is_said(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sources, "absent", lambda: "this system has no pseudo-terminals; use Linux")
    assert "pseudo-terminals" in client.get("/api/sources").json()["no_emulated_rig"]
    wrong(client.post("/api/record", json=EMULATED), 400, "pseudo-terminals")


def test_what_is_asked_of_a_recording_is_checked(client: httpx.Client) -> None:
    wrong(client.get("/api/live"), 400, "nothing was recorded yet")
    for since in ("-1", "1.5", HOSTILE, "9" * 5000):
        wrong(client.get("/api/live", params={"since": since}), 400, "since")
    wrong(client.post("/api/stop", json={}), 400, "nothing is being recorded")
    wrong(client.post("/api/stop", json={"keep": "yes"}), 400, "true or false")


def test_a_workbench_that_closes_while_a_rig_records_disarms_it_and_ends_it(
    tmp_path: Path, rigs: list[EmulatedRig]
) -> None:
    bench = Bench()
    with served(bench) as client:
        log = begun(client, **EMULATED | {"duration_s": 30.0}, motion="multisine", folder=str(tmp_path))
        until(lambda: seen(client)[0].get("received", 0) > 1000)
    assert bench.recorder.live is not None and bench.recorder.live.ended.is_set()
    with pytest.raises(ProcessLookupError):
        os.kill(rigs[0].pid, 0)
    assert kc.WireLog.load(log).runs[-1]["account"]["produced"] is not None


@pytest.mark.skipif(sys.platform != "linux", reason="looks for the emulated rig in /proc")
def test_the_command_that_is_interrupted_while_a_rig_records_disarms_it_and_ends_it(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "knobcam", "workbench", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None and process.stderr is not None
            base, token = process.stdout.readline().strip().split("/?token=")
            with httpx.Client(base_url=base, headers={HEADER: token}, timeout=30.0) as client:
                body = EMULATED | {"duration_s": 30.0, "motion": "multisine", "folder": str(tmp_path)}
                log = begun(client, **body)
                until(lambda: seen(client)[0].get("received", 0) > 1000)
            children = Path(f"/proc/{process.pid}/task").glob("*/children")
            (rig,) = {int(pid) for one in children for pid in one.read_text().split()}
            process.send_signal(signal.SIGINT)
            assert process.wait(20.0) == 0
            assert process.stderr.read() == ""
        finally:
            process.kill()
    assert not Path(f"/proc/{rig}").exists()
    assert kc.WireLog.load(log).runs[-1]["account"]["produced"] is not None


def test_a_log_is_followed_while_it_grows_whatever_the_pieces(tmp_path: Path) -> None:
    log, growing = tmp_path / "a.kcwire", tmp_path / "b.kcwire"
    with EmulatedRig("knob3", speed=SPEED) as rig:
        capture = kc.record(rig.port, "sweep", duration_s=1.0, output=log)
    raw = log.read_bytes()
    header = raw.index(b"\n", raw.index(b"\n") + 1) + 1
    growing.write_bytes(raw[:header])
    tail, times, torques = Tail(growing), [np.zeros(0)], [np.zeros(0)]
    for start in range(header, len(raw), 997):
        with growing.open("ab") as file:
            file.write(raw[start : start + 997])
        more = tail.more()
        times.append(more.get("t_s", np.zeros(0)))
        torques.append(more.get("tau_Nm", np.zeros(0)))
    assert tail.planned == capture.samples
    np.testing.assert_allclose(np.concatenate(times), capture.t, atol=1e-12)
    np.testing.assert_array_equal(np.concatenate(torques), capture.tau)
    growing.unlink()
    with pytest.raises(kc.InputError, match="cannot be read"):
        tail.more()


def test_thinned_samples_are_every_so_many_whatever_the_pieces() -> None:
    thinned, values = Thinned(7), np.arange(100.0)
    for piece in np.split(values, [3, 4, 50, 50, 93]):
        thinned.add({"a": piece, "b": -piece})
    np.testing.assert_array_equal(thinned.since(0)["a"], values[::7])
    np.testing.assert_array_equal(thinned.since(5)["b"], -values[::7][5:])
