"""The render step, the emulated handle and what a delay allows, from Python."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import knobcam as kc
from knobcam.errors import InputError
from knobcam.render.emulated import to_and_fro


def track(duration_s: float = 1.0) -> kc.MotionTrack:
    return kc.motion("multisine", duration_s)


def stepped(renderer: kc.Renderer, motion: kc.MotionTrack) -> np.ndarray:
    rows = zip(motion.theta.tolist(), motion.omega.tolist(), motion.alpha.tolist(), strict=True)
    return np.array([renderer.step(*row) for row in rows])


@pytest.mark.parametrize("knob", ["knob1", "knob4"])
def test_an_array_is_rendered_as_single_steps_are_to_the_last_bit(knob):
    motion = track()
    whole = kc.Renderer(knob).along(motion.theta, motion.omega, motion.alpha)
    assert whole.tobytes() == stepped(kc.Renderer(knob), motion).tobytes()


def test_a_state_that_went_through_json_goes_on_as_before():
    motion = track()
    half = len(motion.t) // 2
    first, second = (kc.MotionTrack(*(c[part] for c in motion)) for part in (slice(half), slice(half, None)))
    one, other = kc.Renderer("knob5"), kc.Renderer("knob5")
    stepped(one, first)
    other.set_state(json.loads(json.dumps(one.state)))
    assert stepped(one, second).tobytes() == stepped(other, second).tobytes()
    assert one.state == other.state


def test_what_cannot_be_true_gives_no_torque_until_a_reset():
    knob = kc.Renderer("knob4")
    assert knob.step(0.3, 5.0) > 0.0
    assert knob.step(math.nan, 5.0) == 0.0
    assert knob.step(0.3, 5.0) == 0.0
    assert "not finite" in knob.fault and "not finite" in repr(knob)
    knob.reset()
    assert knob.fault is None and knob.step(0.3, 5.0) > 0.0


def test_periods_that_were_missed_are_no_jump():
    def after_a_gap(told: int) -> kc.Renderer:
        knob = kc.Renderer("knob4", speed_limit=20.0)
        knob.step(0.0, 10.0)
        knob.missed(told)
        knob.step(0.1, 10.0)
        return knob

    assert "jumped" in after_a_gap(0).fault
    assert after_a_gap(50).fault is None
    assert after_a_gap(50).state["samples"] == 52


def test_torque_stays_within_the_limits_of_the_device_and_of_the_call():
    motion = kc.motion("turns", 1.0)
    device = kc.Device(torque_limit_Nm=0.01, torque_rate_limit_Nm_s=5.0)
    for renderer in (
        kc.Renderer("knob5", device=device),
        kc.Renderer("knob5", torque_limit=0.01, torque_rate_limit=5.0),
    ):
        tau = renderer.along(motion.theta, motion.omega, motion.alpha)
        assert np.abs(tau).max() == 0.01
        assert np.abs(np.diff(tau)).max() <= 5.0 / 5000.0 * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: kc.Renderer("knob9"), "knob9"),
        (lambda: kc.Renderer("knob4", 0.0), "rate"),
        (lambda: kc.Renderer("knob4", torque_limit=-1.0), "torque_limit"),
        (lambda: kc.Renderer("knob4", speed_limit=math.nan), "speed_limit"),
        (lambda: kc.Renderer("knob4", device=kc.Device(inertia_kg_m2=0.0)), "inertia"),
        (lambda: kc.Renderer("knob4", device=kc.Device(delay_samples=-1)), "delay"),
        (lambda: kc.Renderer("knob4").along([0.0, 1.0], [0.0]), "differ in length"),
        (lambda: kc.Renderer("knob4").set_state({"samples": 1}), "is missing"),
        (lambda: kc.check_stability("knob4", rate_hz=0.0), "rate"),
        (lambda: kc.check_stability("knob4", kc.Device(damping_Nms_rad=math.nan)), "damping"),
        (lambda: kc.EmulatedHandle(hand=kc.MotionTrack(*[np.zeros(1)] * 4)), "hand"),
        (lambda: kc.EmulatedHandle(hand=kc.MotionTrack(np.arange(3.0), *[np.full(3, np.nan)] * 3)), "hand"),
        (lambda: kc.EmulatedHandle(kc.Device(encoder_step_rad=-1.0)), "encoder"),
        (
            lambda: kc.run_loop(
                kc.Renderer("knob4", 2500.0), kc.EmulatedHandle(), 0.1, rt="off", time="virtual"
            ),
            "2500 Hz and the loop runs at 5000",
        ),
    ],
)
def test_a_wrong_call_says_in_one_line_what_is_wrong(call, said):
    with pytest.raises(InputError) as refused:
        call()
    assert said in str(refused.value) and "\n" not in str(refused.value)


def test_longer_delays_allow_less_and_what_is_stiffer_than_that_rings():
    knob = kc.Model.load("knob4")
    found = [kc.check_stability(knob, kc.Device(delay_samples=n)) for n in (0, 1, 5, 50)]
    allowed = [one.allowed_stiffness_Nm_rad for one in found]
    assert allowed == sorted(allowed, reverse=True)
    assert found[1].stable and "does not ring" in repr(found[1])
    stiff = kc.check_stability(knob.with_value("detent.A", 30.0), kc.Device(delay_samples=10))
    assert not stiff.stable and "It rings" in repr(stiff) and "It rings" in stiff._repr_html_()
    assert json.loads(json.dumps(found[1].document()))["schema"] == "knobcam.stability/1"


def rendered(delay: int = 1, hand: kc.MotionTrack | None = None, **options):
    device = kc.Device(delay_samples=delay)
    handle = kc.EmulatedHandle(device, to_and_fro() if hand is None else hand, **options)
    report = kc.run_loop(kc.Renderer("knob4", device=device), handle, 2.0, time="virtual")
    return report, handle, device


def test_a_hand_on_the_emulated_handle_feels_the_model():
    report, handle, device = rendered(0, measures_hand=True)
    last = report.last
    assert report.well and report.steps == 10_000
    felt = last.tau + device.inertia_kg_m2 * last.alpha + device.damping_Nms_rad * last.omega
    model = kc.Renderer("knob4").along(last.theta, last.omega, last.alpha)
    sliding = np.abs(last.omega) > 0.5
    assert np.sqrt(np.mean((felt - model)[sliding] ** 2)) < 0.1 * np.sqrt(np.mean(model[sliding] ** 2))
    assert handle.work_J > 0.0
    assert np.abs(last.hand).max() > 0.01
    assert handle.theta == pytest.approx(last.theta[-1], abs=1e-5)
    assert handle.omega == last.omega[-1]


def test_the_emulated_handle_stays_where_a_loop_left_it_and_the_renderer_as_it_was():
    device = kc.Device()
    handle = kc.EmulatedHandle(device, kc.motion("turns", 1.0, speed=2.0))
    renderer = kc.Renderer("knob2", device=device)
    before = renderer.state
    kc.run_loop(renderer, handle, 0.7, time="virtual")
    place = handle.theta
    assert abs(place) > 0.1 and renderer.state == before
    report = kc.run_loop(renderer, handle, 0.1, time="virtual")
    assert report.well and abs(report.last.theta[0] - place) < 1e-2


def test_in_real_time_the_handle_moves_on_while_periods_are_missed():
    device = kc.Device()
    handle = kc.EmulatedHandle(device, to_and_fro())
    renderer = kc.Renderer("knob4", device=device)
    report = kc.run_loop(renderer, handle, 0.5, rt="off", watchdog_s=1.0, missed_share=1.0)
    assert report.well and report.periods == 2500
    assert handle.work_J > 0.0


def test_a_renderer_whose_step_is_the_users_own_is_called():
    class Half(kc.Renderer):
        calls = 0

        def step(self, *sensed):
            self.calls += 1
            return 0.5 * super().step(*sensed)

    half = Half("knob4")
    report = kc.run_loop(half, kc.EmulatedHandle(), 0.01, time="virtual")
    assert report.well and half.calls == 50


def test_an_effect_of_the_users_own_that_fails_in_a_loop_ends_it():
    @kc.own_effect("fails_far_out", law="k theta", k=kc.OwnParameter("N m/rad"))
    def fails_far_out(motion, k):
        if abs(motion.theta[0]) > 0.2:
            raise ValueError("too far")
        return k * motion.theta

    try:
        model = kc.Model.load("knob4").with_effect("fails_far_out")
        handle = kc.EmulatedHandle(hand=to_and_fro())
        report = kc.run_loop(kc.Renderer(model), handle, 1.0, time="virtual", watchdog_s=1.0)
        assert report.ending == "fault" and "too far" in report.why
    finally:
        kc.forget_effect("fails_far_out")


def test_pictures_of_a_rendering_are_drawn():
    report, _, device = rendered()
    model = kc.Model.load("knob4")
    from knobcam import plot

    over_angle, over_time = plot.felt(report, model, device).axes
    assert len(over_angle.lines) == len(over_time.lines) == 2
    assert over_angle.lines[0].get_ydata().size == len(report.last.t)
    none = replace(report, last=type(report.last)(*[np.zeros(0)] * 7))
    assert plot.felt(none, model, device)._repr_png_().startswith(b"\x89PNG")
    assert kc.check_stability(model).plot()._repr_png_().startswith(b"\x89PNG")
