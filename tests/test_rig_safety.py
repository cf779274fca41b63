"""Torque ends with whoever asked for it; the watchdog's time is held in virtual time, in the core's tests."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.errors import InputError
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.link import Link

RENDERS = """
import sys, time
from knobcam.model import Model
from knobcam.rig.link import Link
link = Link(sys.argv[1])
link.upload_model(Model.load("knob4"))
link.arm("render", 60.0)
link.start(0)
print("rendering", flush=True)
time.sleep(60.0)
"""
WITHIN_S = 0.12


def test_a_host_that_is_killed_leaves_a_rig_without_torque_and_no_reconnection_arms_it() -> None:
    with EmulatedRig("knob4") as rig:
        words = [sys.executable, "-c", RENDERS, rig.port]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as host:
            assert host.stdout is not None
            assert host.stdout.readline() == "rendering\n"
            host.kill()
        time.sleep(WITHIN_S)
        for _ in range(3):
            with Link.to(rig.serial_number, [rig.port]) as link:
                assert link.state == "fault"
                assert link.fault is not None
                with pytest.raises(InputError, match="fault"):
                    link.arm("render", 1.0)
        with Link(rig.port) as link:
            link.clear()
            link.describe()
            assert link.state == "idle", "a fault that is cleared arms nothing"


def test_a_program_that_ends_the_link_ends_the_torque_without_a_fault() -> None:
    with EmulatedRig("knob4") as rig:
        with Link(rig.port) as link:
            link.arm("commanded", 10.0)
            link.start(0)
        with Link(rig.port) as link:
            assert (link.state, link.fault) == ("idle", None)


def test_a_rig_that_is_unplugged_is_said_to_be_gone() -> None:
    rig = EmulatedRig("knob4")
    link = Link(rig.port)
    rig.kill()
    with pytest.raises(InputError, match="plug"):
        link.command("PING")
    link.close()


def test_a_person_feels_a_model_on_the_device_and_it_is_recorded(tmp_path: Path) -> None:
    log = tmp_path / "felt.kcwire"
    with EmulatedRig("knob4", speed=10.0) as rig:
        ended = knobcam("render", "knob4", "--port", rig.port, "--seconds", "2", "--log", log, "--json")
        assert ended.document["on"]["serial"] == rig.serial_number
        assert (ended.document["samples"], ended.document["samples_missing"]) == (10_000, 0)
        assert ended.document["work_J"] > 0.0
        refused(knobcam("render", "knob4", "--port", rig.port, "--plots", tmp_path / "p"), "--plots")
        refused(knobcam("render", "knob4", "--port", rig.port, "--seconds", "-1"), "seconds")
    refused(knobcam("render", "knob4", "--log", log), "--port")
    assert kc.load(log).samples == 10_000


def test_a_model_that_would_ring_is_not_rendered_unless_forced(tmp_path: Path) -> None:
    stiff = kc.Model.load("knob4").with_value("detent.A", 200.0).save(tmp_path / "stiff.toml")
    with EmulatedRig("knob4", speed=10.0) as rig:
        refused(knobcam("render", stiff, "--port", rig.port, "--seconds", "1"), "rings", "--force")
