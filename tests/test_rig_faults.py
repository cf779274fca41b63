"""Whatever is wrong with a port, a rig or a disk is said in one line, and the samples that came are kept."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import tty
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import serial
from command import knobcam, refused
from peer import Nth, Peer, as_it_is, changed, kind
from wire.make_vectors import stuff

import knobcam as kc
from knobcam import _core
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.figures import Figures

KEPT = re.compile(r"(\d+) samples are kept in (\S+)$")


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody waits long for an answer that will not come, yet for one that is late on a busy machine."""
    monkeypatch.setattr("knobcam.rig.link._WAITS_S", (0.25, 0.25))


@pytest.fixture
def silent_port() -> Iterator[str]:
    """A port with nothing behind it."""
    master, slave = os.openpty()
    tty.setraw(slave)
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


def line_of(call: Callable[[], object]) -> str:
    """The one line with which a call is refused."""
    with pytest.raises(kc.InputError) as refusal:
        call()
    assert "\n" not in str(refusal.value)
    return str(refusal.value)


def kept(line: str) -> kc.Capture:
    """The capture of which a line says how many samples are kept."""
    found = KEPT.search(line)
    assert found, line
    log = kc.WireLog.load(found[2])
    assert log.samples == int(found[1]) > 0
    return log.capture()


def test_a_port_that_is_not_there_or_is_no_port_is_named(tmp_path: Path) -> None:
    absent, file = tmp_path / "ttyABSENT", tmp_path / "file"
    file.write_text("no port")
    output = tmp_path / "a.npz"
    refused(knobcam("capture", "--port", absent, "-o", output), str(absent), "no such port")
    refused(knobcam("capture", "--port", file, "-o", output), str(file), "no serial port")
    refused(knobcam("capture", "--port", tmp_path, "-o", output), str(tmp_path), "no serial port")
    assert list(tmp_path.glob("a.*")) == []


def test_a_port_without_permission_says_which_group_helps(
    silent_port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(*_: object, **__: object) -> None:
        raise serial.SerialException(13, f"could not open port {silent_port}: Permission denied")

    monkeypatch.setattr(serial, "Serial", denied)
    assert "dialout" in line_of(lambda: kc.Link(silent_port))


def test_a_baud_rate_that_cannot_be_is_refused(silent_port: str, tmp_path: Path) -> None:
    ended = knobcam("capture", "--port", silent_port, "--baud", 10**12, "-o", tmp_path / "a.npz")
    refused(ended, silent_port, "--baud")


def test_two_recorders_do_not_share_a_port(tmp_path: Path) -> None:
    with Peer() as peer, kc.Link(peer.port):
        line = line_of(lambda: kc.record(peer.port, "micro", output=tmp_path / "a.kcwire"))
        assert "busy" in line and "second recorder" in line


@pytest.mark.usefixtures("impatient")
def test_a_port_with_nothing_behind_it_is_no_rig(silent_port: str) -> None:
    assert "nothing answers" in line_of(lambda: kc.Link(silent_port))


@pytest.mark.usefixtures("impatient")
def test_garbage_is_a_wrong_baud_rate_or_no_rig() -> None:
    with Peer(says=lambda frame: os.urandom(40)) as peer:
        assert "baud rate" in line_of(lambda: kc.Link(peer.port))


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize(("version", "words"), [(0, "firmware"), (2, "update knobcam")])
def test_another_version_is_named_with_who_has_to_be_updated(version: int, words: str) -> None:
    def other(frame: bytes) -> bytes:
        plain = bytes([version, 0x81]) + bytes(120)
        return stuff(plain + zlib.crc32(plain).to_bytes(4, "little")) + b"\0"

    with Peer(says=other) as peer:
        line = line_of(lambda: kc.Link(peer.port))
    assert f"version {version}" in line and words in line


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("rate_hz", 0.0, "sample rate"),
        ("counts_per_rad", 0.0, "counts per rad"),
        ("torque_limit", -1.0, "torque limit"),
        ("window", 0, "window"),
        ("serial", "", "serial number"),
    ],
)
def test_a_descriptor_that_cannot_be_is_refused_by_name(field: str, value: Any, words: str) -> None:
    with Peer(says=changed(lambda device: device.update({field: value}))) as peer:
        line = line_of(lambda: kc.Link(peer.port))
    assert peer.port in line and words in line


def test_a_descriptor_that_lies_about_its_rate_is_found_out_by_the_rigs_own_clock(tmp_path: Path) -> None:
    with Peer(says=changed(lambda device: device.update(rate_hz=4000.0))) as peer:
        line = line_of(lambda: kc.record(peer.port, "hand", output=tmp_path / "a.kcwire", duration_s=20.0))
        assert "4000" in line and "5000" in line
        capture = kept(line)
    assert capture.rate_hz == pytest.approx(5000.0, rel=1e-3)
    assert any(finding.kind == "rate" for finding in capture.findings)


def test_a_rig_that_cannot_drive_says_so(tmp_path: Path) -> None:
    with Peer(says=changed(lambda device: device.update(capabilities=0))) as peer:
        line = line_of(lambda: kc.record(peer.port, "micro", output=tmp_path / "a.kcwire", duration_s=0.5))
    assert "cannot do drive" in line


def test_a_motion_that_the_rig_cannot_keep_or_measure_is_refused_before_it_moves(tmp_path: Path) -> None:
    output = tmp_path / "a.kcwire"
    with Peer(says=changed(lambda device: device.update(motion_capacity=1000))) as peer:
        assert "keeps 1000" in line_of(lambda: kc.record(peer.port, "sweep", output=output))
    with Peer() as peer:
        line = line_of(lambda: kc.record(peer.port, "turns", speed=50.0, output=output))
        assert "rad/s" in line and peer.state == "idle"
    assert not output.exists()


def test_a_model_that_the_rig_cannot_render_is_refused_in_its_words(tmp_path: Path) -> None:
    heard: list[str] = []

    def hears(frame: bytes) -> bytes:
        heard.append(kind(frame))
        return frame

    def says(frame: bytes) -> bytes:
        if kind(frame) != "ACK" or "MODEL" not in heard:
            return frame
        [event] = _core.WireDecoder().push(frame)
        command = event["message"]["command"]
        nak = {"type": "NAK", "command": command, "code": 9, "text": "effect 'magnet' is not in the firmware"}
        return _core.wire_encode(nak, event["sequence"], event["time_us"])

    with Peer(hears=hears, says=says) as peer:
        line = line_of(lambda: kc.record(peer.port, "micro", model="knob1", output=tmp_path / "a.kcwire"))
    assert "refuses MODEL" in line and "magnet" in line


def test_a_plug_that_is_pulled_in_a_run_leaves_the_samples(tmp_path: Path) -> None:
    with Peer() as peer:

        def pull(figures: Figures) -> None:
            peer._plugged = figures.received == 0

        how: dict[str, Any] = {"duration_s": 60.0, "output": tmp_path / "a.kcwire", "progress": pull}
        line = line_of(lambda: kc.record(peer.port, "hand", **how))
    assert "gone" in line and "plug" in line
    kept(line)


def test_a_rig_that_falls_silent_in_a_run_leaves_the_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("knobcam.rig.record._SILENT_S", 1.5)
    with Peer(says=Nth("DATA", set(range(20, 100_000)))) as peer:
        line = line_of(lambda: kc.record(peer.port, "hand", duration_s=60.0, output=tmp_path / "a.kcwire"))
        assert "silent" in line and peer.state == "idle"
    assert kept(line).samples == 500


def test_a_fault_of_the_rig_ends_the_run_in_its_words_and_is_cleared_by_who_says_so_alone(
    tmp_path: Path,
) -> None:
    with Peer(hears=Nth("HEARTBEAT", set(range(8, 60)))) as peer:
        line = line_of(lambda: kc.record(peer.port, "turns", duration_s=50.0, output=tmp_path / "a.kcwire"))
        assert "ended the run after" in line and "heartbeat" in line and peer.state == "fault"
        kept(line)
        with kc.Link(peer.port) as link:
            assert link.fault is not None and link.fault[0] == 1
        assert peer.state == "fault"  # a reconnection neither clears nor arms
        line = line_of(lambda: kc.record(peer.port, "micro", output=tmp_path / "b.kcwire"))
        assert "fault 1" in line and "s ago: the host was silent" in line and "--clear-fault" in line
        assert peer.state == "fault" and not (tmp_path / "b.kcwire").exists()
        told: list[str] = []
        line_of(
            lambda: kc.record(
                peer.port,
                "micro",
                output=tmp_path / "b.kcwire",
                clear_fault=lambda fault: bool(told.append(fault)),
            )
        )
        assert "the host was silent" in told[0] and peer.state == "fault"
        again = kc.record(peer.port, "micro", duration_s=0.5, output=tmp_path / "b.kcwire", clear_fault=True)
        assert again.meta["account"]["missing"] == 0


def test_a_rig_that_is_found_in_a_run_is_stopped() -> None:
    with Peer() as peer:
        first = kc.Link(peer.port)
        first.start(0)
        first._port.close()  # as a program that was killed leaves it
        with kc.Link(peer.port):
            assert peer.state == "idle"


@pytest.mark.parametrize("size", [30_000, 100_001])
def test_a_full_disk_keeps_what_was_written(size: int, tmp_path: Path) -> None:
    log = tmp_path / "a.kcwire"
    limited = (
        "import resource, sys; from knobcam import cli; "
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size})); sys.exit(cli.main())"
    )
    with EmulatedRig(speed=10.0) as rig:
        words = ["capture", "--port", rig.port, "--motion", "hand", "--duration", "60", "-o", str(log)]
        ended = subprocess.run(
            [sys.executable, "-c", limited, *words], capture_output=True, text=True, check=False
        )
    assert ended.returncode == 2 and ended.stdout == ""
    line = ended.stderr.splitlines()[-1]
    assert "File too large" in line and "free some space" in line
    kept(line)
    assert log.stat().st_size == size


def test_ctrl_c_keeps_the_samples_and_takes_the_torque_away(tmp_path: Path) -> None:
    with EmulatedRig(speed=5.0) as rig:
        words = [sys.executable, "-m", "knobcam", "capture", "--port", rig.port, "--motion", "turns"]
        words += ["--duration", "100", "-o", str(tmp_path / "a.npz")]
        with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as recorder:
            assert recorder.stderr is not None and "samples" in recorder.stderr.readline()
            recorder.send_signal(signal.SIGINT)
            said = recorder.stderr.read()
        assert recorder.returncode == 130 and said.splitlines()[-1].startswith("knobcam: interrupted; ")
        capture = kept(said.splitlines()[-1])
        assert capture.meta["account"]["lost_on_the_way"] == 0  # also what came after the command to stop
        with kc.Link(rig.port) as link:
            assert link.state == "idle" and link.fault is None


def test_an_exception_of_the_caller_ends_torque_and_run(tmp_path: Path) -> None:
    class OwnError(Exception):
        pass

    def fail(figures: object) -> None:
        raise OwnError

    with Peer() as peer:
        with pytest.raises(OwnError):
            kc.record(peer.port, "turns", duration_s=50.0, output=tmp_path / "a.kcwire", progress=fail)
        assert peer.state == "idle"


def test_the_document_of_a_capture_is_json_also_with_findings(tmp_path: Path) -> None:
    with Peer(says=Nth("DATA", {3})) as peer:
        ended = knobcam(
            *("capture", "--port", peer.port, "--motion", "hand", "--duration", "1"),
            *("-o", tmp_path / "a.kcwire", "--json"),
        )
    assert ended.code == 0 and json.loads(ended.out)["capture"]["missing"] == 25
    assert "25 samples are missing" in ended.err


def test_a_peer_that_spoils_nothing_is_the_rig_itself() -> None:
    assert as_it_is(b"\1\0") == b"\1\0"
    start = time.monotonic()
    with Peer() as peer, kc.Link(peer.port) as link:
        assert link.state == "idle" and time.monotonic() - start < 5.0
