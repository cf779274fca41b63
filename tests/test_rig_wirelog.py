"""The wire log is the capture of record: it survives its recorder and opens wherever it was cut."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from faults_rig import retimed
from peer import Nth, Peer, changed

import knobcam as kc
from knobcam import _core
from knobcam.capture.formats import wire
from knobcam.rig.emulator import EmulatedRig

FORMATS = ("npz", "csv", "csv.gz", "mat", "h5", "parquet")
LONGEST_FRAME = 1030


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of two short runs, the second with a gap in it."""
    path = tmp_path_factory.mktemp("log") / "two.kcwire"
    with Peer() as peer:
        kc.record(peer.port, "hand", duration_s=0.2, output=path)
    first = path.read_bytes()
    with Peer(says=Nth("DATA", {2}), seed=1) as peer:
        other = path.with_name("other.kcwire")
        kc.record(peer.port, "hand", duration_s=0.2, output=other)
    # One rig, two runs.
    name = {"serial": "EMU-0000"}
    rest = other.read_bytes().split(b"\n", 2)[2]
    spoil = changed(lambda device: device.update(name))
    path.write_bytes(first + b"".join(spoil(frame + b"\0") for frame in rest.split(b"\0") if frame))
    return path


def test_every_run_of_a_log_is_a_capture_of_its_own(log: Path) -> None:
    read = kc.WireLog.load(log)
    assert [len(run["index"]) for run in read.runs] == [1000, 975] and read.samples == 1975
    assert read.capture(0).samples == 1000 and read.capture(0).findings == ()
    assert kc.load(log).samples == read.capture().samples == 975
    assert "2 runs (1000 samples, 975 samples)" in repr(read)


def test_a_gap_is_a_step_of_time_and_never_filled(log: Path) -> None:
    capture = kc.load(log)
    steps = np.rint(np.diff(capture.t) * 5000.0)
    assert np.count_nonzero(steps == 26.0) == 1 and np.count_nonzero(steps == 1.0) == 973
    assert "25 samples are missing" in str(capture.findings)


def test_part_of_a_log_is_read_as_of_any_file(log: Path) -> None:
    part = kc.load(log, start=0.1)
    assert 0 < part.samples < 975 and part.t[0] >= 0.1 and part.meta["format"] == "wire log"


def test_a_log_that_is_cut_anywhere_behind_its_header_opens(log: Path, tmp_path: Path) -> None:
    whole, cut = log.read_bytes(), tmp_path / "cut.kcwire"
    header = len(whole) - len(whole.split(b"\n", 2)[2])
    samples = []
    for length in sorted({header, header + 1, *random.Random(1).sample(range(header, len(whole)), 60)}):
        cut.write_bytes(whole[:length])
        read = kc.WireLog.load(cut)
        assert read.counts["pending"] < LONGEST_FRAME
        samples.append(read.samples)
        if read.runs and len(read.runs[-1]["index"]) > 1:
            assert read.capture().samples == len(read.runs[-1]["index"])
        else:
            with pytest.raises(kc.InputError, match=r"cut\.kcwire"):
                read.capture()
    assert samples == sorted(samples) and samples[0] == 0 and samples[-1] > 1900


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"knobcam wire log\n", "header is missing"),
        (b"knobcam wire log\n{\n", "damaged"),
        (b'knobcam wire log\n{"schema": "knobcam.wirelog/9"}\n', "update knobcam"),
        (wire.header_line({}), "DESCRIPTOR"),
        (b"something else\n", "a header and no rows"),
    ],
)
def test_what_is_no_whole_log_is_refused_in_one_line(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.kcwire"
    path.write_bytes(content)
    refused(knobcam("export", path, "-o", tmp_path / "a.npz"), "bad.kcwire", words)


def test_a_run_that_is_not_there_and_options_of_logs_for_other_files_are_refused(
    log: Path, tmp_path: Path
) -> None:
    refused(knobcam("export", log, "--run", "2", "-o", tmp_path / "a.npz"), "2 runs", "no run 2")
    assert knobcam("export", log, "--run", "0", "-o", tmp_path / "a.npz").code == 0
    refused(knobcam("export", tmp_path / "a.npz", "--run", "0", "-o", tmp_path / "b.npz"), "no wire log")


@pytest.mark.parametrize("extension", FORMATS)
def test_exports_are_equal_bytes_whenever_they_are_made(log: Path, extension: str, tmp_path: Path) -> None:
    capture = kc.load(log)
    first, second = (tmp_path / f"{name}.{extension}" for name in ("first", "second"))
    assert knobcam("export", log, "-o", first).code == 0
    time.sleep(0.01 if extension in ("csv", "npz") else 1.05)  # others have been known to write the second
    assert knobcam("export", log, "-o", second).code == 0
    assert first.read_bytes() == second.read_bytes()
    back = kc.load(first)
    for name, values in capture.columns.items():
        np.testing.assert_array_equal(back.columns[name], values)
    assert dict(back.meta) == dict(capture.meta) and back.meta["account"]["missing"] == 25


def samples_at(values: list[tuple[int, int, int]], lower: int = -1000, upper: int = 1000) -> bytes:
    """A log of one run with these raw omega, alpha and tau."""
    with Peer() as peer, kc.Link(peer.port) as link:
        device = dict(link.device)
    device["tau"] = {**device["tau"], "lower": lower, "upper": upper}
    rows = [
        {"count": 10 * i, "omega": omega, "alpha": alpha, "tau": tau}
        for i, (omega, alpha, tau) in enumerate(values)
    ]
    messages = [
        {"type": "DESCRIPTOR", "device": device},
        {"type": "STARTED", "run": 1, "first": 0},
        {"type": "DATA", "run": 1, "samples": rows},
    ]
    frames = [_core.wire_encode(message, 0, 0) for message in messages]
    stopped = {"type": "STOPPED", "run": 1, "produced": len(rows), "sent": len(rows)}
    frames.append(_core.wire_encode(stopped, len(rows), 200 * len(rows)))
    return wire.header_line({}) + b"".join(frames)


def test_a_clipped_sample_is_masked_and_one_without_a_reading_is_no_number(tmp_path: Path) -> None:
    path = tmp_path / "a.kcwire"
    values = [(i, i, 7 * i) for i in range(40)]
    values[10], values[20], values[30] = (10, 10, 1000), (20, -32768, 20), (32767, 30, 30)
    path.write_bytes(samples_at(values))
    capture = kc.load(path)
    assert np.flatnonzero(~capture.mask).tolist() == [10, 20, 30]
    assert capture.alpha is not None and np.isnan(capture.alpha[20])
    kinds = {finding.kind: finding.column for finding in capture.findings if finding.severity == "masked"}
    assert kinds == {"non-finite": "alpha", "limit": "omega", "clipped": "tau"}


def test_a_recorder_that_is_killed_loses_no_more_than_the_frame_that_was_coming(tmp_path: Path) -> None:
    rng = random.Random(7)
    with EmulatedRig(speed=5.0) as rig:
        for attempt in range(3):
            log = tmp_path / f"{attempt}.kcwire"
            words = [sys.executable, "-m", "knobcam", "capture", "--port", rig.port, "--motion", "hand"]
            words += ["--duration", "600", "-o", str(log)]
            with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as recorder:
                while not log.exists():
                    assert recorder.poll() is None, recorder.stderr.read()  # type: ignore[union-attr]
                    time.sleep(0.01)
                time.sleep(rng.uniform(0.05, 0.5))
                recorder.kill()
            read = kc.WireLog.load(log)
            assert read.counts["corrupt"] == 0 and read.counts["pending"] < LONGEST_FRAME
            assert read.samples > 0 and read.runs[-1]["account"]["missing"] == 0
            exports = [tmp_path / f"{attempt}-{name}.npz" for name in "ab"]
            for path in exports:
                assert knobcam("export", log, "-o", path).code == 0
            assert exports[0].read_bytes() == exports[1].read_bytes()


def test_a_thread_that_holds_the_gil_costs_no_sample(tmp_path: Path) -> None:
    numbers, stop = [random.random() for _ in range(500_000)], threading.Event()

    def hog() -> None:
        while not stop.is_set():
            sorted(numbers)

    thread = threading.Thread(target=hog)
    with EmulatedRig(noise=False) as rig:
        thread.start()
        try:
            capture = kc.record(rig.port, "hand", duration_s=2.0, output=tmp_path / "a.kcwire")
        finally:
            stop.set()
            thread.join()
    account = capture.meta["account"]
    assert (account["received"], account["missing"], account["dropped_on_device"]) == (10_000, 0, 0)


def test_the_header_says_when_where_and_why(log: Path) -> None:
    header = json.loads(log.read_bytes().split(b"\n", 2)[1])
    assert header["schema"] == "knobcam.wirelog/1" and header["knobcam"] == kc.__version__
    assert header["motion"] == {"name": "hand", "duration_s": 0.2, "samples": 1000}
    assert {"date", "host", "port", "model", "calibration"} <= header.keys()


@pytest.mark.parametrize("by_us", [3_600_000_000, -30_000, 2**64 - 10_000_000])
def test_a_device_whose_clock_leaps_keeps_its_samples_where_they_were_counted(
    log: Path, tmp_path: Path, by_us: int
) -> None:
    head, schema, body = log.read_bytes().split(b"\n", 2)
    frames, path = [frame + b"\0" for frame in body.split(b"\0") if frame], tmp_path / "leapt.kcwire"
    whole = by_us > 2**63  # the numbers are near their end all along

    def leapt(place: int, frame: bytes) -> bytes:
        late = whole or place > len(frames) * 3 // 4
        return retimed(frame, lambda us: us + by_us) if late else frame

    path.write_bytes(b"\n".join((head, schema, b"".join(leapt(*one) for one in enumerate(frames)))))
    capture, sound = kc.load(path), kc.load(log)
    np.testing.assert_array_equal(capture.t, sound.t)
    told = [one.message for one in capture.findings if one.kind == "clock"]
    assert len(told) == (0 if whole else 1)
    assert all("the samples are counted" in one for one in told)
