"""What logs of others' machines had and no simulated one, made again in small without the simulator."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal  # type: ignore[import-untyped]

import knobcam as kc
from knobcam.fit.coarse import within_rounding
from knobcam.model.effects import effects

RATE_HZ = 200.0
T = np.arange(6_000) / RATE_HZ
Column = NDArray[np.float64]


def swung(reach: float, *hertz: float) -> tuple[Column, Column, Column]:
    """Position, velocity and acceleration of sines over about `reach` to either side, equal parts of each."""
    theta, omega, alpha = np.zeros((3, len(T)))
    for at, hz in enumerate(hertz):
        rate, phase = 2.0 * np.pi * hz, 0.7 * at
        theta += reach / len(hertz) * np.sin(rate * T + phase)
        omega += reach / len(hertz) * rate * np.cos(rate * T + phase)
        alpha -= reach / len(hertz) * rate**2 * np.sin(rate * T + phase)
    return theta, omega, alpha


def normal(seed: int) -> Column:
    return np.random.default_rng(seed).standard_normal(len(T))


def capture(theta: Column, tau: Column) -> kc.Capture:
    return kc.Capture.from_arrays(t=T, theta=theta + 1e-5 * normal(1), tau=tau)


def test_a_torque_that_was_smoothed_before_it_was_logged_has_no_known_floor() -> None:
    """Drives log what they have filtered: how loud the noise was nobody can tell then."""
    theta, omega, alpha = swung(0.8, 0.11, 0.35)
    raw = 0.02 * alpha + 0.3 * np.sign(omega) * (1.0 + 0.5 * np.exp(-np.abs(omega) / 0.1)) + 0.05 * normal(2)
    smooth = signal.sosfiltfilt(signal.butter(4, 20.0, fs=RATE_HZ, output="sos"), raw)
    story = kc.learn(capture(theta, smooth))
    assert math.isnan(story.noise_floor) and story.verdict == "unexplained"
    assert story.headline.startswith("Whether anything is missing cannot be told")
    assert kc.fit(capture(theta, raw)).noise_floor > 0.0


def test_a_floor_above_what_is_left_is_none() -> None:
    """The ripple of a gear that turns fast fills the band in which noise is heard, and no other."""
    theta, omega, alpha = swung(0.8, 0.11, 0.35)
    theta, omega = theta + 3.0 * T, omega + 3.0  # no place comes again, whose repeats would tell
    fast = np.diff(normal(3), prepend=0.0)
    fit = kc.fit(capture(theta, 0.02 * alpha + 0.3 * np.sign(omega) + 0.05 * fast))
    assert math.isnan(fit.noise_floor)
    level = kc.fit(capture(theta, 0.02 * alpha + 0.3 * np.sign(omega) + 0.05 * normal(3)))
    assert level.noise_floor == pytest.approx(level.rmse, rel=0.1)


def cogged(seed: int) -> kc.Capture:
    """A motor that turns forth and back over 0.85 of a turn, as a log that was cut shows it."""
    theta, omega, alpha = swung(0.85 * np.pi, 0.06)
    ripple = 0.5 * np.sin(7.0 * theta + 0.4) + 0.3 * np.sin(12.0 * theta) + 0.1 * np.sin(36.0 * theta + 2.0)
    tau = 0.05 * alpha + 0.2 * np.sign(omega) + ripple + 0.05 * normal(seed)
    return capture(theta, tau)


def test_a_motor_that_did_not_quite_turn_once_shows_its_orders_and_its_repeat_is_told() -> None:
    story = kc.learn(cogged(4))
    assert story.found == ("cogging",)
    orders = {round(e.value) for name, e in story.params.items() if name.startswith("cogging.n") and e.value}
    assert orders == {7, 12, 36}
    assert story.fit.compare(cogged(5)).figures.relative < 0.15


def test_gravity_that_was_exchanged_keeps_what_it_explains() -> None:
    """Over a third of a turn a detent wider than that draws gravity as well, with a parameter more."""
    theta, omega, alpha = swung(1.0, 0.1, 0.23)
    weight = 10.0 * np.sin(theta - 1.57)
    rubs = (1.0 + 0.08 * np.abs(weight)) * np.sign(omega)
    story = kc.learn(capture(theta, 1.5 * alpha + weight + rubs + 1.5 * omega + 0.05 * normal(6)))
    assert "unbalance" in story.found and "load_friction" in story.found


def test_a_delay_at_the_end_of_its_range_is_no_cause() -> None:
    (delay,) = effects("rotary")["actuation_delay"].params
    assert delay.plausible[1] < delay.upper


def test_a_torque_of_one_commanded_step_is_none_that_was_off() -> None:
    theta, _, _ = swung(0.8, 0.11, 0.35)
    stepped = capture(theta, np.where(T < 10.0, -0.03, -0.04))
    assert stepped.mask.all() and not [one for one in stepped.findings if one.kind == "dead"]


def test_what_loses_on_unseen_blocks_what_it_wins_on_the_others_does_not_come_in() -> None:
    theta, omega, alpha = swung(0.8, 0.11, 0.35)
    fit = kc.fit(
        capture(theta, 0.02 * alpha + 0.3 * np.sign(omega) * (1.0 + 0.3 * (T > 29.0)) + 0.05 * normal(9))
    )
    for one in fit.diagnose().candidates:
        won, lost = 1.0 - one.rmse / fit.rmse, one.rmse_heldout / fit.rmse_heldout - 1.0
        said = any("did not see" in words for words in one.implausible)
        assert said == (lost > max(won, 0.0)), one.effect


def test_of_a_joint_that_is_held_it_is_said_that_it_does_not_move() -> None:
    """A stalled motor of a test bench: its angle is noise, so that no sample has a known direction."""
    with pytest.raises(kc.InputError, match="its direction is not known anywhere, as it moves too little"):
        kc.fit(capture(1e-5 * normal(5), 0.3 * np.sin(T) + 0.01 * normal(6)))
    # One jerk of it is not much of a motion either, and "mask less" no way out.
    jerk = 0.5 * np.tanh((T - 15.0) / 0.02)
    held = kc.Capture.from_arrays(t=T, theta=jerk + 1e-4 * normal(5), tau=0.3 * np.sin(T) + 0.01 * normal(6))
    with pytest.raises(kc.InputError, match=r"\d rows nobody knows which way it goes, as of what is held"):
        kc.fit(held)


@pytest.mark.parametrize("late_s", [-0.002, 0.0, 0.001, 0.002])
def test_a_torque_that_is_computed_of_an_angle_a_moment_ago_is_of_no_other_sign(late_s: float) -> None:
    """Gravity that a controller makes up for, while a hand moves the arm: all of it is of position.

    Read a little late that gives power back, which was "the torque has the other sign".
    """
    theta, omega, alpha = swung(1.6, 0.23, 0.41)
    before = theta - late_s * omega + 0.5 * late_s**2 * alpha
    fit = kc.fit(kc.Capture.from_arrays(t=T, theta=theta + 1e-5 * normal(1), tau=3.3 * np.sin(before)))
    assert fit.log_fault is None
    rubs = 0.05 * np.sign(omega) + 0.2 * omega + 0.03 * alpha
    tau = -(3.3 * np.sin(before) + rubs + 1e-3 * normal(2))
    fit = kc.fit(kc.Capture.from_arrays(t=T, theta=theta + 1e-5 * normal(1), tau=tau))
    assert fit.log_fault is not None and "other sign" in fit.log_fault


def test_what_a_coarse_torque_was_rounded_by_is_no_missing_effect() -> None:
    """Readings in steps that are wide beside their noise: "something is missing", along the load."""
    theta, omega, alpha = swung(1.6, 0.23, 0.41)
    tau = 0.02 * alpha + 0.3 * np.sign(omega) + 0.05 * omega + 2e-3 * normal(4)
    for step_nm, told in ((0.04, True), (1e-3, False)):
        story = kc.learn(capture(theta, np.round(tau / step_nm) * step_nm))
        rounding = f"cannot be told from the rounding of the torque, which is read in steps of {step_nm:.4g}"
        assert (rounding in story.headline) is told
        assert (story.verdict == "complete") is not told and story.found == ()
    # What is more than rounding is said to be missing, however coarse its readings are.
    more = tau + 0.3 * np.sign(omega) * np.exp(-np.abs(omega) / 0.3)
    story = kc.learn(capture(theta, np.round(more / 0.04) * 0.04))
    assert "stribeck" in story.found and within_rounding(story.ladder[0].fit) is None


def steps(rest_s: float) -> kc.Capture:
    """A motor that is sent from place to place at 1 kHz: brisk starts, and a slow end of each.

    Velocity and current are read with noise; an inertia of 0.016 kg m^2, friction of 0.2 N m.
    """
    t = np.arange(8_000) / 1e3
    since = t % 1.0 - rest_s
    fast = np.where(since > 0.0, (1.0 - np.exp(-since / 0.006)) * np.exp(-since / 0.08), 0.0)
    omega = 12.0 * fast * (np.abs(fast) > 2e-3)
    rng = np.random.default_rng(9)
    tau = 0.016 * np.gradient(omega, t) + 0.2 * np.sign(omega) + 0.02 * rng.standard_normal(len(t))
    theta = np.cumsum(omega) / 1e3
    noisy = omega + 0.04 * rng.standard_normal(len(t))
    counts = 2.0 * np.pi / 2**15
    return kc.Capture.from_arrays(t=t, theta=np.round(theta / counts) * counts, omega=noisy, tau=tau)


def test_starts_from_rest_that_do_not_count_are_said_to_be_lost() -> None:
    """Nine tenths of the torque was in rows that nobody knew of, and the inertia a thirtieth of itself."""
    fit = kc.fit(steps(0.5))
    (said,) = [one for one in fit.warnings if "rows that do not count" in one]
    assert "--prepare paper" in said
    story = kc.learn(steps(0.5))
    assert (story.verdict, story.found) == ("unexplained", ())
    assert story.headline.startswith("Whether anything is missing cannot be told: 9")
    told = kc.fit(steps(0.5), prepare="paper")
    assert told.params["inertia.M"].value == pytest.approx(0.016, rel=0.1)
    assert not [one for one in told.warnings if "do not count" in one]
    theta, omega, alpha = swung(1.6, 0.23, 0.41)
    moved = kc.fit(capture(theta, 0.016 * alpha + 0.2 * np.sign(omega) + 0.02 * normal(4)))
    assert not [one for one in moved.warnings if "do not count" in one]


def test_a_torque_that_returns_once_a_turn_is_gravity_and_no_detent() -> None:
    """A hand leads an arm whose controller makes up for gravity: a sinusoid of 0.998 turns was a detent."""
    theta, omega, alpha = swung(1.6, 0.23, 0.41, 0.9)
    theta = theta - 1.0
    tau = 3.3 * np.sin(theta) + 0.01 * np.sin(2.0 * theta + 0.5) + 4e-3 * normal(2)
    assert kc.learn(capture(theta, tau)).found[:1] == ("unbalance",)
    twice = 3.3 * np.sin(2.0 * theta) + 0.02 * alpha + 0.1 * np.sign(omega) + 4e-3 * normal(2)
    two = kc.learn(capture(theta, twice))
    assert two.fit.params["detent.P"].value == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("keeps", [0.0, 0.75])
def test_beside_friction_that_gives_power_back_nothing_is_named_however_small_the_way(keeps: float) -> None:
    """An exoskeleton that pushes its wearer: "torque_lag was missing", of 0.018 rad, or nothing at all."""
    theta, omega, alpha = swung(9e-3, 0.9, 2.3, 3.7)
    tau = signal.lfilter([1.0 - keeps], [1.0, -keeps], 0.15 * alpha - 1.5 * np.sign(omega))  # 15 ms later
    story = kc.learn(kc.Capture.from_arrays(t=T, theta=theta + 1e-7 * normal(1), tau=tau + 0.25 * normal(2)))
    assert (story.verdict, story.found) == ("unexplained", ())
    assert "friction gives power back, which no knob does" in story.headline
    bent = [one for one in story.fit.warnings if one.startswith("coulomb.pos is negative")]
    assert not any("falls with speed" in one for one in bent)


@pytest.mark.parametrize(("hertz", "off"), [((0.23, 0.41), True), ((0.023, 0.041), False)])
def test_waves_that_the_filter_takes_off_are_no_names(hertz: tuple[float, ...], off: bool) -> None:
    """`detent_harmonics` of a wrist at 125 Hz came at 80 Hz, its filter ends at 12.5 Hz."""
    theta, omega, alpha = swung(1.6, *hertz)
    waves = 0.2 * np.sin(20.0 * theta) + 0.3 * np.sin(100.0 * theta + 1.0)
    tau = 0.02 * alpha + 0.3 * np.sign(omega) + 0.05 * omega + waves + 0.02 * normal(2)
    model = kc.Model.of(["inertia", "coulomb", "viscous", "detent"], detent__P=0.05)
    fit = kc.fit(capture(theta, tau), model, torque_edge_hz=12.5)
    (shape,) = fit.diagnose(only=["detent_harmonics"]).candidates
    assert any("torque filter takes off" in why for why in shape.implausible) is off


def third_repeats(theta: Column, omega: Column, tau: Column, times: float = 1.0) -> kc.Capture:
    """A log in which every third row is the one before it once more, as a bus that was late left it."""
    read = np.arange(len(T)) - (np.arange(len(T)) % 3 == 2)
    noisy = omega * times + 1e-4 * normal(4)
    return kc.Capture.from_arrays(
        t=T, theta=(theta + 1e-5 * normal(1))[read], omega=noisy[read], tau=tau[read]
    )


def test_units_are_held_against_each_other_where_every_third_row_is_none() -> None:
    """No stretch of such a log is whole: a velocity in any unit passed, and a rate that was guessed."""
    theta, omega, alpha = swung(1.6, 0.23, 0.41)
    tau = 0.02 * alpha + 0.3 * np.sign(omega) + 0.02 * normal(2)
    assert not [one for one in third_repeats(theta, omega, tau).findings if one.kind == "unit"]
    (wrong,) = [one for one in third_repeats(theta, omega, tau, 0.5).findings if one.kind == "unit"]
    assert "omega: 0.5" in wrong.message and "the rate" in wrong.message


@pytest.mark.parametrize("every", [2, 3])
def test_a_velocity_that_was_computed_row_by_row_of_a_held_angle_is_none(every: int) -> None:
    """A controller's: nothing between the readings of the angle, and two or three times as much with each."""
    theta, omega, alpha = swung(1.6, 0.23, 0.41)
    tau = 0.02 * alpha + 0.3 * np.sign(omega) + 0.02 * normal(2)
    held = np.repeat((theta + 1e-4 * normal(1))[::every], every)[: len(T)]
    steps = np.diff(held, prepend=held[0]) * RATE_HZ
    found = kc.Capture.from_arrays(t=T, theta=held, omega=steps, tau=tau)
    (said,) = [one for one in found.findings if (one.kind, one.column) == ("held", "omega")]
    assert found.omega is None and "computed row by row" in said.message
    assert not [one for one in found.findings if one.kind == "unit"]
    # Whoever rests has no velocity either, and that is one.
    rests = np.where((T % 10.0 < 5.0), theta, theta[np.searchsorted(T, T - T % 5.0)])
    still = np.where(np.diff(rests, prepend=rests[0]) == 0.0, 0.0, omega)
    assert kc.Capture.from_arrays(t=T, theta=rests, omega=still, tau=tau).omega is not None


def test_a_spring_whose_rest_is_far_is_not_ruled_out_for_its_offset() -> None:
    """A spring over 0.26 rad: "unbalance was missing" alone, as a spring bent the friction of one direction.

    The pull at the zero of the angle is an offset, and that is what the two directions differ in.
    """
    theta, omega, alpha = swung(0.13, 0.11, 0.35)
    tau = 2.0 * theta + 0.002 * alpha + 0.01 * np.sign(omega) + 0.01 * normal(2)
    story = kc.learn(capture(theta - 0.8, tau))
    (step,) = story.ladder[1:]
    assert {"return_spring", "unbalance"} <= {step.added, *step.equivalent}, story.headline


def test_what_pushes_away_from_a_position_is_no_return_spring() -> None:
    """A pendulum that a motor drives at one frequency: "return_spring found", of -0.3 N m/rad."""
    theta, omega, alpha = swung(0.4, 0.11, 0.35)
    tau = -2.0 * np.sin(theta) + 0.002 * alpha + 0.01 * np.sign(omega) + 0.01 * normal(2)
    story = kc.learn(capture(theta, tau))
    (step,) = story.ladder[1:]
    assert step.added == "unbalance" and "return_spring" not in step.equivalent, story.headline
    (spring,) = story.ladder[0].fit.diagnose(only=["return_spring"]).candidates
    assert any("return_spring.k = -" in why and "at least 0" in why for why in spring.implausible)


def driven(noise: float, ramp: float = 0.0) -> kc.Capture:
    """A motor whose torque is commanded: friction that builds up, and what disturbs it slowly."""
    rate_hz, count = 1000.0, 6000
    t = np.arange(count) / rate_hz
    tau = np.round(ramp * t if ramp > 0.0 else 0.05 * signal.sawtooth(2.0 * np.pi * t + 1.6, 0.5), 6)
    theta, slow = np.zeros(count), np.zeros(count)
    rng = np.random.default_rng(5)
    place = omega = held = 0.0
    for at in range(count):
        theta[at] = place
        slow[at] = 0.99 * slow[at - 1] + 2e-4 * rng.standard_normal()
        for _ in range(4):
            held += (omega - abs(omega) * held) / 0.1 / (4.0 * rate_hz)
            omega += (tau[at] - 0.012 * held - 4e-4 * omega + slow[at]) / 2.4e-4 / (4.0 * rate_hz)
            place += omega / (4.0 * rate_hz)
    counts = np.round(theta / (2.0 * np.pi) * 1e4)
    read = np.round(tau + noise * rng.standard_normal(count), 6)
    return kc.Capture.from_arrays(t=t, theta=2.0 * np.pi * counts / 1e4, tau=read)


def test_the_noise_of_a_torque_that_was_commanded_is_not_what_a_model_leaves() -> None:
    """Of ten runs of a motor on a bench five had stops, drifts and lags, "and the rest is chance"."""
    read = 1e-6  # N m, as much as its last digit
    assert kc.fit(driven(read)).noise_floor < 2.0 * read
    assert kc.fit(driven(100.0 * read)).noise_floor < 100.0 * read


@pytest.mark.parametrize("keeps", [0.9, 0.97])
@pytest.mark.parametrize("waves", [7.0, 12.0, 24.0])
def test_a_strong_wave_over_position_is_not_read_as_noise_nor_instead_of_it(
    waves: float, keeps: float
) -> None:
    """A motor that turns evenly: its floor was a tenth of what it is, or five times as much."""
    t = np.arange(20_000) / 1000.0
    theta, omega = 0.5 * t + 0.02 * np.sin(3.0 * t), 0.5 + 0.06 * np.cos(3.0 * t)
    slow = signal.lfilter([1.0], [1.0, -keeps], np.random.default_rng(8).standard_normal(len(t)))
    smooth = 0.01 + 0.002 * omega + 4.5e-4 / slow.std() * slow
    wave = 0.01 * np.sin(waves * theta) + 0.003 * np.sin(2.0 * waves * theta)
    read = theta + 1e-5 * np.random.default_rng(9).standard_normal(len(t))
    alone, beside = (kc.fit(kc.Capture.from_arrays(t=t, theta=read, tau=smooth + w)) for w in (0.0, wave))
    assert beside.rmse > 4.0 * alone.rmse
    assert 0.7 < beside.noise_floor / alone.noise_floor < 1.5


def test_of_a_torque_that_was_commanded_to_rise_nothing_is_told_that_changes_with_time() -> None:
    """Of ten runs of a motor six lacked `torque_drift`, "and the rest is chance"; two had the other sign."""
    story = kc.learn(driven(0.0, ramp=0.0167))
    assert story.verdict == "unexplained" and not story.found
    assert "a straight line over time" in story.headline and "rise and fall" in story.headline
