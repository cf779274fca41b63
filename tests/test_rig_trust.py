"""A hand on the rig: what feeds it is refused, a fault is told, whoever ends the host ends the torque."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from peer import Nth, Peer

import knobcam as kc
from knobcam import _core
from knobcam.capture.motions import MotionTrack
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.feel import feel
from knobcam.rig.link import Link
from knobcam.rig.record import Enough

SLOW = 0.25
"""A rig for which time goes by so slowly that a computer with much to do is not late."""
CODES = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}


def pushing() -> kc.Model:
    """Knob 4 with a spring that pushes."""
    return kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", -5.0)


def test_a_model_that_feeds_the_hand_is_refused_by_host_and_rig_alike(tmp_path: Path) -> None:
    model = pushing()
    with Peer() as peer:
        for refuse in (
            lambda: feel(peer.port, model, 0.5),
            lambda: kc.record(peer.port, "turns", model=model, output=tmp_path / "a.kcwire"),
        ):
            with pytest.raises(kc.InputError, match=r"return_spring\.k: is -5 N m/rad"):
                refuse()
        assert not (tmp_path / "a.kcwire").exists()
        with Link(peer.port) as link:
            text = model.text()
            number = link._number + 1
            frames = _core.wire_model(text, number, link._recorder.now_us)
            with pytest.raises(kc.InputError, match=r"refuses MODEL \(return_spring\.k"):
                link._upload("MODEL", frames)
            with pytest.raises(kc.InputError, match="no whole motion or model"):
                link.arm("render", 1.0)
                link.start(0)


def test_a_forced_model_is_ended_by_the_tank_of_the_rig() -> None:
    with Peer() as peer:
        with pytest.raises(kc.InputError, match=r"gave out 0\.1 J more .*\(256\)") as told:
            feel(peer.port, pushing(), 5.0, force=True)
        assert peer.state == "fault"
        assert "nothing is kept of it without --log" in str(told.value) and "tmp" not in str(told.value)


def leave_silent(rig: EmulatedRig) -> None:
    """Leave a rig armed by a host that says nothing more, until its watchdog has latched a fault."""
    link = Link(rig.port)
    link.arm("commanded", 0.01)
    time.sleep(0.3 / SLOW)
    link._busy = False
    link.close()


@pytest.mark.parametrize("command", ["capture", "render"])
def test_a_latched_fault_is_told_with_cause_and_time_and_cleared_by_its_option_alone(
    command: str, tmp_path: Path
) -> None:
    words = {
        "capture": ("capture", "--motion", "micro", "--duration", "0.2", "-o", tmp_path / "a.kcwire"),
        "render": ("render", "knob4", "--seconds", "0.2"),
    }[command]
    with EmulatedRig("knob4", speed=SLOW) as rig:
        leave_silent(rig)
        for _ in range(2):
            refused(
                knobcam(*words, "--port", rig.port),
                "fault 1",
                "s ago: the host was silent",
                "--clear-fault",
            )
        assert knobcam(*words, "--port", rig.port, "--clear-fault").code == 0
        with Link(rig.port) as link:
            assert (link.state, link.fault) == ("idle", None)
    refused(knobcam("render", "knob4", "--clear-fault"), "--port")


@pytest.mark.parametrize(("answer", "code"), [("y", 0), ("n", 2)])
def test_at_a_terminal_a_person_is_asked_whether_a_fault_is_cleared(
    answer: str, code: int, tmp_path: Path
) -> None:
    ours, theirs = os.openpty()
    with EmulatedRig("knob4", speed=SLOW) as rig:
        leave_silent(rig)
        words = ["capture", "--motion", "hand", "--duration", "0.2", "-o", str(tmp_path / "a.kcwire")]
        program = [sys.executable, "-m", "knobcam", *words, "--port", rig.port]
        with subprocess.Popen(program, stdin=theirs, stderr=theirs, stdout=subprocess.DEVNULL) as host:
            os.close(theirs)
            said = b""
            while b"[y/N]" not in said:
                said += os.read(ours, 1 << 12)
            assert b"the host was silent" in said
            os.write(ours, answer.encode() + b"\n")
            with contextlib.suppress(OSError):  # that nobody has the terminal any more
                while os.read(ours, 1 << 12):
                    pass
        os.close(ours)
        assert host.returncode == code
        with Link(rig.port) as link:
            assert (link.state == "idle") == (answer == "y")


@pytest.mark.parametrize("name", list(CODES))
@pytest.mark.parametrize("command", ["capture", "render"])
def test_a_signal_disarms_first_and_has_its_own_exit_code(name: str, command: str, tmp_path: Path) -> None:
    log = tmp_path / "a.kcwire"
    words = {
        "capture": ("capture", "--motion", "turns", "--duration", "60", "-o", str(log)),
        "render": ("render", "knob4", "--seconds", "60", "--log", str(log)),
    }[command]
    with EmulatedRig("knob4", speed=SLOW) as rig:
        program = [sys.executable, "-m", "knobcam", *words, "--port", rig.port]
        with subprocess.Popen(program, stderr=subprocess.PIPE, text=True) as host:
            while not log.exists() or log.stat().st_size < 5000:
                assert host.poll() is None
                time.sleep(0.01)
            host.send_signal(getattr(signal, name))
            assert host.stderr is not None
            said = host.stderr.read().splitlines()[-1]
        assert host.returncode == CODES[name], said
        assert "samples are kept in" in said and "Traceback" not in said
        if name != "SIGINT":
            assert f"ended by {name}; " in said
        with Link(rig.port) as link:
            assert (link.state, link.fault) == ("idle", None)
    assert kc.WireLog.load(log).samples > 100


def test_a_program_of_ones_own_that_is_terminated_disarms_too(tmp_path: Path) -> None:
    program = "import sys, knobcam as kc; kc.record(sys.argv[1], 'turns', output=sys.argv[2], duration_s=60)"
    log = tmp_path / "a.kcwire"
    with EmulatedRig("knob4", speed=SLOW) as rig:
        with subprocess.Popen([sys.executable, "-c", program, rig.port, str(log)]) as host:
            while not log.exists() or log.stat().st_size < 5000:
                time.sleep(0.01)
            host.terminate()
        assert host.returncode == 143
        with Link(rig.port) as link:
            assert (link.state, link.fault) == ("idle", None)


def turns(host: subprocess.Popen[str]) -> bool:
    """Whether the thread of a loop is there, where a system tells."""
    threads = Path(f"/proc/{host.pid}/task")
    return not threads.is_dir() or "knobcam-loop\n" in [
        (one / "comm").read_text() for one in threads.iterdir()
    ]


def test_a_loop_that_is_interrupted_answers_with_its_report_and_130() -> None:
    words = [sys.executable, "-u", "-m", "knobcam", "render", "knob4", "--time", "virtual"]
    words += ["--seconds", "1e6", "--json"]
    for name, code in CODES.items():
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as host:
            while host.poll() is None and not turns(host):
                time.sleep(0.05)
            time.sleep(0.5 if sys.platform == "linux" else 2.0)  # by now somebody waits for its end
            host.send_signal(getattr(signal, name))
            out, err = host.communicate()
        assert host.returncode == code, err
        assert ('"ending": "interrupted"' in out) == (name == "SIGINT")


def test_a_run_without_a_log_names_no_file_when_it_is_cut() -> None:
    class OwnError(Exception):
        pass

    with Peer() as peer:

        def pull(figures: object) -> None:
            peer._plugged = False

        with pytest.raises(kc.InputError, match="nothing is kept of it without --log") as told:
            feel(peer.port, kc.Model.load("knob4"), 5.0, progress=pull)
        assert "/tmp" not in str(told.value) and ".kcwire" not in str(told.value)


def test_what_is_lost_is_one_number_also_at_head_and_tail() -> None:
    with Peer(says=Nth("DATA", {0, 1, 5, 39})) as peer:
        felt = feel(peer.port, kc.Model.load("knob4"), 0.2)
        assert felt.samples_missing == felt.capture.meta["account"]["missing"] == 100
        assert felt.capture.samples == 900


def test_a_motion_that_no_knob_can_follow_is_refused_before_it_is_sent() -> None:
    t = np.arange(100) / 5000.0
    good = MotionTrack(t, 0.01 * t, 0.0 * t, 0.0 * t)
    jump = 0.01 * t
    jump[50:] += 100.0
    with Peer() as peer, Link(peer.port) as link:
        for track, why in (
            (good._replace(theta=good.theta + 0.1), "begins at 0.1 rad"),
            (good._replace(omega=good.omega + 1.0), "1 rad/s; it must begin at rest"),
            (good._replace(theta=jump), "jumps at point 50"),
            (good._replace(alpha=np.full(100, np.nan)), "not finite"),
            (MotionTrack(*[np.zeros(0)] * 4), "no point"),
        ):
            with pytest.raises(kc.InputError, match=why):
                link.upload_motion(track)
        link.upload_motion(good)
        # The rig says the same to a host that does not look.
        frames = _core.wire_motion(jump, 0.0 * t, 0.0 * t, link._number + 1, 0)
        with pytest.raises(kc.InputError, match="motion jumps"):
            link._upload("EXCITE", frames)
        for limit in (0.0, -1.0, 1e3, float("nan")):
            with pytest.raises(kc.InputError, match="torque_limit"):
                link.arm("drive", 1.0, torque_limit=limit)


def test_a_motor_that_may_not_give_what_a_motion_asks_for_gives_up_and_says_so(tmp_path: Path) -> None:
    with Peer(noise=False) as peer, Link(peer.port) as link:
        track = kc.motion("sweep", 1.0)
        from knobcam.rig.leadin import led_in

        link.upload_motion(led_in(track, link.rate_hz))
        link.arm("drive", 10.0, torque_limit=1e-3)
        link.start(0)
        while link.fault is None:
            assert link.wait(5.0)
        assert link.fault[0] == 4 and "fell behind" in link.fault[1]
        assert 0.0 < (link.figures().peak_torque or 0.0) <= 1e-3 + 1.8e-4  # a step of its sensor


def frame_with(frame: bytes, change: int) -> bytes:
    """A DATA frame once more, as another one of the same index says it."""
    for event in _core.WireDecoder().push(frame):
        message = event["message"]
        message["samples"][0]["tau"] += change
        return frame + _core.wire_encode(message, event["sequence"], event["time_us"])
    return frame


def test_frames_that_contradict_each_other_and_frames_that_are_none_are_told(tmp_path: Path) -> None:
    other = Nth("DATA", {3, 7}, lambda frame: frame_with(frame, 5))
    with Peer(says=other) as peer:
        capture = kc.record(peer.port, "hand", duration_s=0.4, output=tmp_path / "a.kcwire")
    assert capture.meta["account"]["contradicted"] == 2 and capture.meta["account"]["missing"] == 0
    assert [finding.kind for finding in capture.findings] == ["contradicted"]
    noise = Nth("DATA", {4}, lambda frame: frame + b"no frame" + bytes(1))
    with Peer(says=noise) as peer:
        capture = kc.record(peer.port, "hand", duration_s=0.4, output=tmp_path / "b.kcwire")
    assert capture.meta["account"]["missing"] == 0
    [finding] = capture.findings
    assert finding.kind == "corrupt" and "1 stretches" in finding.message
    ended = knobcam("export", tmp_path / "b.kcwire", "-o", tmp_path / "b.npz")
    assert ended.code == 0 and "no frames" in ended.err


def test_an_export_of_a_log_that_was_cut_says_how_many_samples_were_planned(tmp_path: Path) -> None:
    def enough(figures: object) -> None:
        raise Enough

    whole = tmp_path / "whole.kcwire"
    with Peer() as peer:
        kc.record(peer.port, "hand", duration_s=0.4, output=whole)
        kc.record(peer.port, "hand", duration_s=4.0, output=tmp_path / "early.kcwire", progress=enough)
    cut = tmp_path / "cut.kcwire"
    cut.write_bytes(whole.read_bytes()[:15_000])
    ended = knobcam("export", cut, "-o", tmp_path / "a.csv", "--json")
    assert ended.document["capture"]["planned"] == 2000 > ended.document["capture"]["samples"]
    assert "of the 2000 samples that were planned came" in ended.err
    ended = knobcam("export", tmp_path / "early.kcwire", "-o", tmp_path / "b.csv")
    assert "of the 20000 samples that were planned" in ended.err


@pytest.mark.parametrize("c_cal", ["-5.0", "0.0", "1e300", "1e-9"])
def test_a_calibration_that_no_accelerometer_has_is_refused(c_cal: str, tmp_path: Path) -> None:
    log = tmp_path / "a.kcwire"
    with Peer() as peer:
        kc.record(peer.port, "hand", duration_s=0.2, output=log)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(
        f'schema = "knobcam.calibration/1"\nserial = "EMU-0000"\ndate = "2026-01-01"\nc_cal = {c_cal}\n'
    )
    words = ("export", log, "-o", tmp_path / "a.npz", "--calibration", wrong)
    refused(knobcam(*words), "wrong.toml", "c_cal", "calibrate` again")
    assert not (tmp_path / "a.npz").exists()

    class Made:
        pass

    made = Made()
    made.c_cal = float(c_cal)  # type: ignore[attr-defined]
    with pytest.raises(kc.InputError, match="c_cal"):
        kc.WireLog.load(log).capture(calibration=made)
