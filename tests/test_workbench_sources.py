"""Captures without a file at hand: simulated, from an emulated rig, from one on a port; watched, stopped."""

from __future__ import annotations

import json
import runpy
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from workbench_server import served

import knobcam as kc
from knobcam.workbench.bench import Bench

SPEED = 8.0
EMULATED = {"source": "emulated", "knob": "knob3", "duration_s": 4.0, "speed": SPEED}


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.fixture
def client(bench: Bench) -> Iterator[httpx.Client]:
    with served(bench) as client:
        yield client


def seen(client: httpx.Client, since: int = 0) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """What the page sees of a recording: the figures, and the columns from a sample on."""
    answer = client.get("/api/live", params={"since": since})
    assert answer.status_code == 200, answer.text
    line = answer.content.split(b"\n")[0]
    head = json.loads(line)
    floats = np.frombuffer(answer.content[-(-(len(line) + 1) // 4) * 4 :], dtype="<f4")
    return head["live"], dict(zip(head["names"], floats.reshape(len(head["names"]), head["n"]), strict=True))


def ended(client: httpx.Client) -> dict[str, Any]:
    """What is told of the recording when it has ended."""
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        live, _ = seen(client)
        if live["ended"]:
            return live
        time.sleep(0.02)
    raise AssertionError("the recording does not end")


def begun(client: httpx.Client, **body: Any) -> Path:
    """Begin a recording; its wire log."""
    answer = client.post("/api/record", json=body)
    assert answer.status_code == 200, answer.text
    return Path(answer.json()["log"])


def rows_of(client: httpx.Client) -> list[dict[str, Any]]:
    captures: list[dict[str, Any]] = client.get("/api/state").json()["captures"]
    return captures


def test_a_knob_is_simulated_and_the_script_makes_the_same_capture(
    client: httpx.Client, bench: Bench, tmp_path: Path
) -> None:
    body = {"knob": "knob4", "effects": ["return_spring"], "motion": "turns", "duration_s": 3.0, "seed": 7}
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
