"""The emulated rig as a process, and what the sensor tests say of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.capture.motion_plan import MotionPlan, Move, Rest
from knobcam.rig.calibration import usual
from knobcam.rig.emulator import EmulatedRig, Emulation
from knobcam.rig.record import record

FAST = 20.0


def test_its_first_line_is_the_port_and_the_link_leads_there_until_it_ends(tmp_path: Path) -> None:
    link = tmp_path / "rig"
    words = [sys.executable, "-m", "knobcam", "emulate", "knob2", "--link", str(link)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None
    port = process.stdout.readline().strip()
    assert port.startswith("/dev/")
    assert str(link.readlink()) == port
    process.send_signal(signal.SIGTERM)
    assert process.wait(10) == 0
    assert not link.is_symlink()
    process.stdout.close()


def test_it_ends_with_the_process_that_started_it() -> None:
    rig = EmulatedRig("knob2")
    os.kill(rig.pid, 0)
    rig.close()
    with pytest.raises(ProcessLookupError):
        os.kill(rig.pid, 0)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--effect", "magic"], ["'magic'", "coulomb"]),
        (["--fixture", "glue"], ["'glue'", "anchor"]),
        (["--speed", "0"], ["speed", "0.01"]),
        (["--c-cal", "-1"], ["c_cal"]),
        (["no_such.toml"], ["no_such.toml"]),
        (["--motion", "no_such_motion.toml"], ["no_such_motion.toml"]),
        (["--motion", "magic"], ["motion='magic'", "motion file"]),
        (["--link", "/no/such/folder/rig"], ["/no/such/folder/rig", "--link"]),
    ],
)
def test_what_cannot_be_emulated_is_refused(words: list[str], said: list[str]) -> None:
    model = [] if words[0].endswith(".toml") else ["knob2"]
    refused(knobcam("emulate", *model, *words), *said)


def test_its_hand_makes_the_motion_of_a_file_at_its_angles(tmp_path: Path) -> None:
    plan = MotionPlan((Move(0.6, 2.0, 40.0), Rest(0.2), Move(0.4, 2.0, 40.0)), 0.3)
    with EmulatedRig("knob2", speed=FAST, noise=False, motion=plan.save(tmp_path / "m.toml")) as rig:
        capture = record(rig.port, "hand", duration_s=6.0, output=tmp_path / "a.kcwire")
    assert capture.theta[0] == pytest.approx(0.0, abs=1e-4)
    assert capture.theta.max() == pytest.approx(0.6, abs=1e-4)
    exact = plan.track(5000.0)
    first = int(np.argmax(capture.theta >= 0.6 - 1e-5)) - int(np.argmax(exact.theta >= 0.6 - 1e-5))
    np.testing.assert_allclose(capture.theta[first : first + len(exact.t)], exact.theta, atol=2e-3)
    # And back, and again.
    assert capture.samples == 30_000 and abs(np.diff(capture.theta)).max() * 5000.0 < 2.1


def test_two_rigs_have_two_serial_numbers() -> None:
    assert Emulation(seed=1).serial_number != Emulation(seed=2).serial_number


def test_both_sensor_tests_are_kept_and_captures_use_them(tmp_path: Path) -> None:
    options = {"speed": FAST, "seed": 42, "c_cal": 1160.0}
    with EmulatedRig("knob2", fixture="free", **options) as rig:
        ended = knobcam("calibrate", "--port", rig.port, "--plots", tmp_path / "plots", "--json")
    assert ended.document["c_cal"] == pytest.approx(1160.0, rel=2e-3)
    assert ended.document["omega_sd_rad_s"] == pytest.approx(0.0244, rel=0.05)
    assert ended.document["tau_sd_Nm"] == pytest.approx(0.0018, rel=0.05)
    assert (tmp_path / "plots" / "calibration.png").is_file()
    with EmulatedRig("knob2", fixture="anchor", **options) as rig:
        both = knobcam("calibrate", "--port", rig.port, "--test", "torque", "--json").document
    assert both["c_cal"] == ended.document["c_cal"]
    assert both["anchor_Nm_rad"] == pytest.approx(5.0, rel=0.01)
    kept = usual("EMU-0042")
    assert kept is not None
    with EmulatedRig("knob2", **options) as rig:
        captured = record(rig.port, "sweep", output=tmp_path / "a.kcwire")
    true = kc.motion("sweep").alpha
    assert captured.alpha is not None
    late = captured.samples - len(true)
    recorded = captured.alpha[late:]
    assert recorded @ true / (true @ true) == pytest.approx(1.0, rel=2e-3)


def test_a_gripper_that_is_not_anchored_is_refused(tmp_path: Path) -> None:
    with EmulatedRig("knob2", speed=FAST) as rig:
        ended = knobcam("calibrate", "--port", rig.port, "--test", "torque", "-o", tmp_path / "c.toml")
        refused(ended, "anchor it")
        refused(knobcam("calibrate", "--port", rig.port, "--runs", "0"), "runs=0")
    assert not (tmp_path / "c.toml").exists()


def test_a_learned_model_comes_back_from_the_device_that_renders_it(tmp_path: Path) -> None:
    """Emulate, capture, learn, render, capture, learn: by the command alone."""
    with EmulatedRig("knob2", effects=("quadratic_drag",), speed=FAST) as rig:
        first, again = tmp_path / "knob.npz", tmp_path / "felt.npz"
        assert knobcam("capture", "--port", rig.port, "-o", first).code == 0
        learned = knobcam("learn", first, "-o", tmp_path / "learned.toml", "--json").document
        model = ["--model", tmp_path / "learned.toml"]
        assert knobcam("capture", "--port", rig.port, *model, "-o", again).code == 0
        back = knobcam("learn", again, "--json").document
    assert learned["found"] == back["found"] == ["quadratic_drag"]
    for name, was in learned["ladder"][-1]["params"].items():
        now = back["ladder"][-1]["params"][name]
        close = abs(now["value"] / was["value"] - 1.0) < 0.05
        assert close or now["ci95"][0] <= was["value"] <= now["ci95"][1], name


def test_whoever_asks_for_its_state_while_its_time_goes_by_waits() -> None:
    rig = Emulation("knob2").rig()
    asked = threading.Event()

    def clock() -> None:
        now = 0
        while not asked.is_set():
            rig.advance(now := now + 1_000_000)

    ticking = threading.Thread(target=clock)
    ticking.start()
    try:
        for _ in range(200):
            assert (rig.state, rig.motor_torque) == ("idle", 0.0)
    finally:
        asked.set()
        ticking.join()
