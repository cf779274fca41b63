"""A loop started from Python keeps its beat, says what it reached, and ends with zero torque."""

from __future__ import annotations

import _thread
import json
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from knobcam.errors import InputError, KnobcamError, KnobcamWarning
from knobcam.render.loop import run_loop, start_loop


class Knob:
    """A device that senses how often it was read, and remembers every torque."""

    def __init__(self, hand: float | None = None, fails_at: int | None = None) -> None:
        self.reads, self.written = 0, []
        self.hand, self.fails_at = hand, fails_at

    def read(self) -> tuple[float, float, float, float | None]:
        self.reads += 1
        if self.reads == self.fails_at:
            raise OSError("unplugged")
        return 0.01 * self.reads, 0.0, 0.0, self.hand

    def write(self, tau: float) -> None:
        self.written.append(tau)


class Spring:
    def __init__(self, fails_beyond: float = np.inf) -> None:
        self.fails_beyond = fails_beyond
        self.hands: set[float | None] = set()

    def step(self, theta: float, omega: float, alpha: float, hand: float | None) -> float:
        self.hands.add(hand)
        if theta > self.fails_beyond:
            raise ValueError("theta is beyond the spring")
        return 0.5 * theta


def virtual(device: Knob, seconds: float = 1.0, controller: Spring | None = None, **options):
    return run_loop(controller or Spring(), device, seconds, time="virtual", **options)


def test_in_virtual_time_every_period_is_a_step():
    knob = Knob()
    report = virtual(knob, 2.0, rate_hz=1000.0)
    assert (report.steps, report.missed, report.periods) == (2000, 0, 2000)
    assert (report.ending, report.well, report.running) == ("time", True, False)
    assert report.reached_hz == 1000.0
    assert knob.written == [0.5 * (0.01 * n) for n in range(1, 2001)] + [0.0]


def test_the_last_second_is_what_was_sensed_and_written():
    last = virtual(Knob(hand=0.25), 2.0, rate_hz=1000.0).last
    np.testing.assert_allclose(last.t, np.arange(1000, 2000) / 1000.0)
    np.testing.assert_allclose(last.theta, 0.01 * np.arange(1001, 2001))
    np.testing.assert_allclose(last.tau, 0.5 * last.theta)
    assert np.all(last.hand == 0.25)
    assert np.all(last.late == 0.0)


def test_a_hand_that_is_not_measured_is_none_to_the_controller_and_nan_in_the_report():
    spring = Spring()
    report = virtual(Knob(), 0.1, spring)
    assert spring.hands == {None}
    assert np.all(np.isnan(report.last.hand))


@pytest.mark.parametrize(
    ("knob", "spring", "ending", "why"),
    [
        (Knob(fails_at=11), Spring(), "device", "device.read: OSError: unplugged"),
        (Knob(), Spring(0.105), "fault", "controller.step: ValueError: theta is beyond"),
    ],
)
def test_what_raises_ends_the_loop_with_zero_torque(knob, spring, ending, why):
    report = virtual(knob, 1.0, spring)
    assert (report.ending, report.steps, report.well) == (ending, 10, False)
    assert why in report.why
    assert report.not_relieved is None
    assert len(knob.written) == 11
    assert knob.written[-1] == 0.0


def test_a_device_that_senses_no_state_ends_the_loop():
    knob = Knob()
    knob.read = lambda: (1.0, 2.0)
    report = virtual(knob)
    assert report.ending == "device"
    assert knob.written == [0.0]


def test_a_device_that_never_takes_zero_torque_is_told_in_the_report():
    knob = Knob()

    def refuse(tau: float) -> None:
        raise OSError("buffer full")

    knob.write = refuse
    report = virtual(knob)
    assert report.ending == "device"
    assert not report.well
    assert "buffer full" in report.not_relieved
    assert "did not take the zero torque" in repr(report)


def test_in_real_time_every_period_is_a_step_or_a_miss():
    knob = Knob()
    report = run_loop(Spring(), knob, 0.3, rt="off", rate_hz=500.0, watchdog_s=1.0, missed_share=1.0)
    assert report.ending == "time"
    assert report.periods == 150
    assert report.late.counts.sum() == report.busy.counts.sum() == report.steps
    assert len(knob.written) == report.steps + 1
    assert knob.written[-1] == 0.0


def test_a_python_thread_that_holds_the_loop_up_ends_it_by_the_watchdog():
    knob = Knob()
    knob.read = lambda: time.sleep(0.05) or (0.0, 0.0, 0.0, None)
    report = run_loop(Spring(), knob, 1.0, rt="off")
    assert (report.ending, report.steps) == ("stalled", 0)
    assert "ready to write" in report.why
    assert knob.written == [0.0]


def test_a_running_loop_shows_what_it_reached_and_stops_with_its_block():
    knob = Knob()
    with start_loop(Spring(), knob, rt="off", rate_hz=500.0, watchdog_s=1.0, missed_share=1.0) as loop:
        while loop.report().steps < 20:
            time.sleep(0.005)
        now = loop.report()
        assert now.running
        assert len(now.last.t) == 1
        assert "still running" in repr(now)
    report = loop.report()
    assert report.ending == "asked"
    assert report.well
    assert knob.written[-1] == 0.0
    assert loop.stop().steps == report.steps


def test_ctrl_c_takes_the_torque_off_and_keeps_the_report():
    knob = Knob()
    threading.Timer(0.2, _thread.interrupt_main).start()
    report = run_loop(Spring(), knob, rt="off", rate_hz=200.0, watchdog_s=1.0, missed_share=1.0)
    assert report.ending == "interrupted"
    assert report.steps > 0
    assert knob.written[-1] == 0.0


def test_a_device_that_hangs_is_told_when_the_loop_is_stopped(monkeypatch):
    monkeypatch.setattr("knobcam.render.loop._ANSWERS_S", 0.1)
    knob, entered, release = Knob(), threading.Event(), threading.Event()

    def hang() -> tuple[float, float, float, None]:
        entered.set()
        release.wait(20.0)
        return 0.0, 0.0, 0.0, None

    knob.read = hang
    loop = start_loop(Spring(), knob, rt="off", watchdog_s=0.1)
    assert entered.wait(20.0)
    with pytest.raises(KnobcamError, match="switch the device off"):
        loop.stop()
    release.set()
    assert loop.wait(20.0)
    assert loop.report().ending == "stalled"
    assert knob.written == [0.0]


def test_without_real_time_priority_the_loop_warns_and_the_report_is_stamped():
    def run(rt: str):
        return run_loop(Spring(), Knob(), 0.02, rt=rt, rate_hz=500.0, watchdog_s=1.0, missed_share=1.0)

    assert "rt='off'" in run("off").why_not_realtime
    try:
        assert run("enforce").realtime
    except InputError as refused:
        assert "ulimit -r" in str(refused)
        with pytest.warns(KnobcamWarning, match="ulimit -r"):
            report = run("warn")
        assert not report.realtime
        assert "without real-time priority" in repr(report)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"rt": "always"}, "enforce, warn or off"),
        ({"time": "later"}, "real or virtual"),
        ({"time": "virtual", "rt": "enforce"}, "no priority to enforce"),
        ({"rate_hz": 0.0}, "rate_hz"),
        ({"seconds": -1.0}, "seconds"),
        ({"watchdog_s": 1e-6}, "one period"),
        ({"missed_share": 0.0}, "missed_share"),
        ({"missed_run": -1}, "missed_run"),
        ({"device": object()}, r"device: a object has no read\(...\)"),
        ({"controller": object()}, r"controller: a object has no step\(...\)"),
    ],
)
def test_a_call_that_cannot_be_followed_is_refused_before_the_device_is_touched(options, said):
    knob = Knob()
    with pytest.raises(InputError, match=said):
        run_loop(**{"controller": Spring(), "device": knob, "seconds": 0.1} | options)
    assert (knob.reads, knob.written) == (0, [])


def test_the_report_is_a_table_a_page_and_a_document():
    report = virtual(Knob(), 0.5)
    assert "2500 steps at 5000 Hz, 0 periods missed" in repr(report)
    assert "99.9 %" in repr(report)
    assert "<table>" in report._repr_html_()
    document = json.loads(json.dumps(report.document()))
    assert document["steps"] == 2500
    assert document["late_s"]["max"] == 0.0
    assert document["realtime"] is False
    assert document["why_not_realtime"] == "its time is virtual"


def test_the_end_of_python_takes_the_torque_off(tmp_path):
    torques = tmp_path / "torques"
    script = f"""
import os, time
from knobcam.loop import start_loop

class Knob:
    file = os.open({str(torques)!r}, os.O_WRONLY | os.O_CREAT)

    def read(self):
        return 1.0, 0.0, 0.0, None

    def write(self, tau):
        os.write(self.file, f"{{tau}}\\n".encode())

class Spring:
    def step(self, theta, omega, alpha, hand):
        return 0.5 * theta

loop = start_loop(Spring(), Knob(), rt="off", rate_hz=500.0, watchdog_s=1.0, missed_share=1.0)
while loop.report().steps == 0:
    time.sleep(0.01)
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60.0)
    *before, last = torques.read_text().split()
    assert set(before) == {"0.5"}
    assert last == "0.0"
