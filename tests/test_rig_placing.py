"""A motion file has its angles where the captures have theirs: the knob is brought there, within limits."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.capture.motion_plan import MotionPlan, Move, Rest
from knobcam.learn.limits import Limits
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.placing import stands_at

SPEED = 8.0
PLAN = MotionPlan(
    (Move(0.9, 2.0, 40.0), Rest(0.1), Move(0.5, 2.0, 40.0)), 0.7, "from 0.7 to 0.9 and back to 0.5"
)


@pytest.fixture
def rig() -> Iterator[EmulatedRig]:
    with EmulatedRig("knob3", speed=SPEED, noise=False) as rig:
        yield rig


@pytest.fixture(scope="module")
def still() -> Iterator[EmulatedRig]:
    """A rig whose knob nobody may move."""
    with EmulatedRig("knob3", speed=SPEED, noise=False) as rig:
        yield rig
        with kc.Link(rig.port) as link:
            assert stands_at(link) == pytest.approx(0.0, abs=2e-3)


def test_the_knob_is_brought_slowly_to_where_the_motion_begins(rig: EmulatedRig, tmp_path: Path) -> None:
    said: list[str] = []
    path = PLAN.save(tmp_path / "m.toml")
    first = kc.record(rig.port, str(path), output=tmp_path / "a.kcwire", told=said.append)
    assert "stands at 0 rad and goes first to 0.7 rad" in said[0]
    exact = PLAN.track(5000.0)
    np.testing.assert_allclose(first.theta[-len(exact.t) :], exact.theta, atol=1e-3)
    way = slice(0, first.samples - len(exact.t))
    assert first.omega is not None
    assert abs(first.omega[way]).max() < 1.01 and abs(np.diff(first.theta)).max() * 5000.0 < 2.1
    # It stands at 0.5 rad now, and knows it.
    with kc.Link(rig.port) as link:
        assert stands_at(link) == pytest.approx(0.5, abs=2e-3)
    second = kc.record(rig.port, PLAN, output=tmp_path / "b.kcwire", told=said.append)
    assert "stands at 0.5 rad" in said[1]
    np.testing.assert_allclose(second.theta[-len(exact.t) :], exact.theta, atol=1e-3)
    # Who stands there goes nowhere.
    back = MotionPlan((Move(0.8, 2.0, 40.0),), 0.5)
    kc.record(rig.port, back, output=tmp_path / "c.kcwire", told=said.append)
    assert len(said) == 2


def test_the_header_says_how_long_the_plan_takes(rig: EmulatedRig, tmp_path: Path) -> None:
    path = PLAN.save(tmp_path / "m.toml")
    capture = kc.record(rig.port, str(path), duration_s=60.0, output=tmp_path / "a.kcwire")
    header = kc.WireLog.load(tmp_path / "a.kcwire").header["motion"]
    assert header["name"] == str(path)
    assert header["duration_s"] == pytest.approx(PLAN.seconds, abs=1e-3)
    assert capture.meta["motion"]["samples"] == capture.samples


def test_limits_hold_on_the_way_there_and_for_the_motor(rig: EmulatedRig, tmp_path: Path) -> None:
    slow = MotionPlan((Move(0.9, 0.2, 2.0),), 0.7)
    tight = Limits(0.05, 0.25, 3.0, -0.1, 1.0)
    capture = kc.record(rig.port, slow, output=tmp_path / "a.kcwire", limits=tight)
    assert capture.omega is not None and capture.alpha is not None
    assert abs(capture.omega).max() < 0.2505
    assert abs(np.diff(capture.omega)).max() * 5000.0 < 40.0


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ("omega_rad_s = 1.5", "reaches 2 rad/s, beyond omega_rad_s = 1.5"),
        ("alpha_rad_s2 = 30.0", "beyond alpha_rad_s2 = 30"),
        ("theta_max_rad = 0.8", "reaches 0.9 rad, beyond theta_max_rad = 0.8"),
        ("theta_min_rad = 0.3", "turn it by +0.7 rad (+40 degrees)"),
        ("duration_s = 0.2", "longer than duration_s = 0.2"),
        ("omega = 1.5", "is no limit"),
        ("torque_Nm = -1.0", "give a number above 0"),
    ],
)
def test_what_goes_beyond_limits_is_one_line_and_the_motor_never_moves(
    still: EmulatedRig, tmp_path: Path, limits: str, said: str
) -> None:
    path, file = PLAN.save(tmp_path / "m.toml"), tmp_path / "l.toml"
    file.write_text(limits, "utf-8")
    with pytest.raises(kc.InputError) as refusal:
        kc.record(still.port, str(path), limits=file, output=tmp_path / "a.npz", told=pytest.fail)
    assert said in str(refusal.value) and "\n" not in str(refusal.value)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["l.toml", "m.toml"]


def test_a_motion_far_from_the_knob_says_by_how_much_to_turn(still: EmulatedRig, tmp_path: Path) -> None:
    path = MotionPlan((Move(12.5, 2.0, 40.0),), 12.0).save(tmp_path / "m.toml")
    words = ("capture", "--port", still.port, "--motion", path, "-o", tmp_path / "a.npz")
    refused(knobcam(*words), "turn it by +12 rad (+688 degrees)")


def test_a_hand_has_no_limits(still: EmulatedRig, tmp_path: Path) -> None:
    limits = Limits(0.05, 0.25, 3.0, -0.1, 1.0)
    with pytest.raises(kc.InputError, match="a hand has none"):
        kc.record(still.port, "hand", limits=limits, output=tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("sample_rate_hz = 5000.0\ntheta = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]", "theta jumps near row 3"),
        ("sample_rate_hz = 100.0\ntheta = [0.0, 0.0, 0.0, 0.0, 0.0]", "of 100 Hz"),
        ("parts = [{ move = { to = 50.0, speed = 500.0, acceleration = 1e6 } }]", "500 rad/s"),
        ("parts = [{ jump = 3 }]", "part 1 is none"),
    ],
)
def test_a_motion_file_that_jumps_is_one_line_and_the_motor_never_moves(
    still: EmulatedRig, tmp_path: Path, text: str, said: str
) -> None:
    path = tmp_path / "m.toml"
    path.write_text(f"schema = 'knobcam.motion/1'\n{text}", "utf-8")
    with pytest.raises(kc.InputError) as refusal:
        kc.record(still.port, str(path), output=tmp_path / "a.npz", told=pytest.fail)
    assert said in str(refusal.value) and "\n" not in str(refusal.value)
    assert [one.name for one in tmp_path.iterdir()] == ["m.toml"]


def test_the_command_says_that_it_brings_the_knob_there(rig: EmulatedRig, tmp_path: Path) -> None:
    path = PLAN.save(tmp_path / "m.toml")
    ran = knobcam("capture", "--port", rig.port, "--motion", path, "-o", tmp_path / "a.npz", "--json")
    assert ran.code == 0 and "goes first to 0.7 rad, where the motion begins" in ran.err
    assert ran.document["capture"]["samples"] > 5000.0 * PLAN.seconds
