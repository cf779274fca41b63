"""The core and a second implementation of docs/wire-protocol.md write and read the same bytes."""

from __future__ import annotations

import math
import re
import tomllib
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from wire import make_vectors

from knobcam import _core
from knobcam.errors import InputError

DOCUMENT = Path(__file__).parents[1] / "docs" / "wire-protocol.md"
FRAMES: list[dict[str, Any]] = tomllib.loads(make_vectors.VECTORS.read_text())["frame"]
IDS = [frame["name"] for frame in FRAMES]


def unstuffed(wire: bytes) -> bytes:
    """COBS undone as the document says."""
    assert wire[-1] == 0 and 0 not in wire[:-1]
    plain, at = bytearray(), 0
    while at < len(wire) - 1:
        code = wire[at]
        plain += wire[at + 1 : at + code]
        at += code
        if code < 255 and at < len(wire) - 1:
            plain.append(0)
    return bytes(plain)


def same(one: Any, other: Any) -> bool:
    """Equality in which a number that is none equals itself."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[name], other[name]) for name in one)
    if isinstance(one, float) and math.isnan(one):
        return math.isnan(other)
    return bool(one == other)


def data(first: int, samples: int, run: int = 1) -> bytes:
    rows = [{"count": i, "omega": 1, "alpha": -2, "tau": 3} for i in range(first, first + samples)]
    message = {"type": "DATA", "run": run, "samples": rows}
    return make_vectors.frame(first, 200 * first, message)


def test_the_vectors_are_those_that_their_maker_makes() -> None:
    assert make_vectors.VECTORS.read_text() == make_vectors.vectors()


@pytest.mark.parametrize("frame", FRAMES, ids=IDS)
def test_the_core_writes_what_the_second_implementation_writes(frame: dict[str, Any]) -> None:
    written = _core.wire_encode(frame["message"], frame["sequence"], frame["time_us"])
    assert written.hex() == frame["hex"]


@pytest.mark.parametrize("frame", FRAMES, ids=IDS)
def test_the_core_reads_what_the_second_implementation_writes(frame: dict[str, Any]) -> None:
    [event] = _core.WireDecoder().push(bytes.fromhex(frame["hex"]))
    expected = {key: frame[key] for key in ("sequence", "time_us", "message")}
    assert same(event, expected | {"event": "frame"})


@pytest.mark.parametrize("frame", FRAMES, ids=IDS)
def test_a_frame_is_a_header_a_body_and_a_check_sum_in_stuffing(frame: dict[str, Any]) -> None:
    plain = unstuffed(bytes.fromhex(frame["hex"]))
    assert zlib.crc32(plain[:-4]).to_bytes(4, "little") == plain[-4:]
    assert plain[0] == 1 and len(plain) <= 1024
    assert int.from_bytes(plain[2:6], "little") == frame["sequence"]
    assert int.from_bytes(plain[6:14], "little") == frame["time_us"]


def test_the_frames_in_the_document_are_those_of_the_vectors() -> None:
    shown = re.findall(r"^((?:[0-9a-f]{2} )+00)$", DOCUMENT.read_text(), re.M)
    known = {frame["hex"] for frame in FRAMES}
    assert len(shown) >= 5
    assert [line for line in shown if line.replace(" ", "") not in known] == []


def test_the_document_numbers_every_message_as_the_core_does() -> None:
    numbered = re.findall(r"^\| 0x([0-9A-F]{2}) \| ([A-Z]+) \|", DOCUMENT.read_text(), re.M)
    assert {name: int(number, 16) for number, name in numbered} == {
        name: number for name, (number, _) in make_vectors.LAYOUTS.items()
    }


def test_a_log_gives_raw_columns_with_gaps_and_books() -> None:
    log = make_vectors.frame(100, 20_000, {"type": "STARTED", "run": 1, "first": 100})
    log += data(100, 25) + data(150, 25) + b"noise\0" + data(150, 25)
    log += make_vectors.frame(200, 40_000, {"type": "STOPPED", "run": 1, "produced": 100, "sent": 75})
    read = _core.wire_log(log + b"cut")
    assert (read["frames"], read["corrupt"], read["pending"]) == (5, 1, 3)
    assert [frame["message"]["type"] for frame in read["said"]] == ["STARTED", "STOPPED"]
    [run] = read["runs"]
    assert run["index"].tolist() == [*range(25), *range(50, 75)]
    assert run["count"].tolist() == (run["index"] + 100).tolist()
    assert [run[name].dtype for name in ("count", "omega", "alpha", "tau")] == [np.int32] + 3 * [np.int16]
    assert run["gaps"] == [(25, 50), (75, 100)]
    assert run["frame_time_us"].tolist() == [20_000, 30_000]
    assert run["account"] == {
        "received": 50,
        "late": 0,
        "duplicate": 25,
        "stray": 0,
        "contradicted": 0,
        "missing": 50,
        "gaps": 2,
        "missing_head": 0,
        "missing_tail": 25,
        "produced": 100,
        "dropped_on_device": 25,
        "lost_on_the_way": 25,
    }


def test_an_upload_is_cut_into_frames_that_fit() -> None:
    theta = np.linspace(0.0, 1.0, 200)
    frames = _core.wire_motion(theta, np.ones(200), np.zeros(200), 7)
    events = [event for frame in frames for event in _core.WireDecoder().push(frame)]
    assert [event["sequence"] for event in events] == [7, 8, 9, 10]
    points = [point for event in events for point in event["message"]["points"]]
    assert [point["theta"] for point in points] == theta.tolist()
    text = 'name = "knob"\n' * 100
    chunks = [event["message"] for event in _core.WireDecoder().push(b"".join(_core.wire_model(text, 1)))]
    assert b"".join(bytes(chunk["bytes"]) for chunk in chunks).decode() == text
    assert {chunk["check"] for chunk in chunks} == {zlib.crc32(text.encode())}


@pytest.mark.parametrize(
    ("message", "named"),
    [
        ({"type": "LAUNCH"}, "LAUNCH"),
        ({"type": "START"}, "samples"),
        ({"type": "START", "samples": -1}, "-1"),
        ({"type": "ARM", "mode": "drive", "torque_limit": "much", "torque_rate_limit": 1.0}, "much"),
    ],
)
def test_a_message_that_is_none_is_refused_by_name(message: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        _core.wire_encode(message, 1)
