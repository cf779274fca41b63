"""What is wrong with a capture is found, said and masked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from recordings import RATE, N, masked, only, recording, times

import knobcam as kc
from knobcam.capture import Capture, Finding
from knobcam.capture.quality.order import quantiles
from knobcam.errors import InputError


def test_a_sample_that_is_not_finite_is_masked_in_every_column_and_kept_as_it_is() -> None:
    good = recording()
    for name in ("theta", "omega", "alpha", "tau", "t"):
        values = good.columns[name].copy()
        values[[9, 10, 700]] = np.nan, np.inf, -np.inf
        capture = recording(**{name: values})
        assert only(capture).kind == "non-finite"
        assert only(capture).column == name
        assert "rows 10-11, 701" in only(capture).message
        assert masked(capture) == [10, 11, 701]
        assert np.array_equal(capture.columns[name], values, equal_nan=True)


@pytest.mark.parametrize("kind", ["all differ", "counts", "half the same", "some are missing"])
@pytest.mark.parametrize("many", [1, 2, 64, 65, 1000, 5000])
def test_a_quantile_is_that_of_what_is_sorted_however_many_are_the_same(kind: str, many: int) -> None:
    rng = np.random.default_rng(many)
    values = rng.standard_normal(many)
    if kind == "counts":
        values = rng.integers(0, 9, many) / 3.0
    elif kind != "all differ":
        values[: many // 2] = 0.25 if kind == "half the same" else np.nan
    shares = (0.5, 0.0, 0.9, 0.5, 1.0)
    ranked = np.sort(values)
    expected = [ranked[round(share * (many - 1))] for share in shares]
    np.testing.assert_array_equal(quantiles(values, *shares), expected)


def test_a_repeated_time_stamp_is_masked() -> None:
    t = times()
    t[100] = t[99]
    finding = only(recording(t=t))
    assert (finding.kind, finding.rows, finding.severity) == ("duplicate", (101,), "masked")
    assert masked(recording(t=t)) == [101]


def test_one_stamp_that_leaps_ahead_costs_one_sample() -> None:
    t = times()
    t[50] = 1e6
    assert only(recording(t=t)).kind == "backward"
    assert masked(recording(t=t)) == [51]


def test_one_stamp_that_falls_back_costs_one_sample() -> None:
    t = times()
    t[50] = 0.0123
    assert masked(recording(t=t)) == [51]


def test_a_clock_that_begins_anew_is_taken_on() -> None:
    t = times()
    t[2000:] -= 2.0
    capture = recording(t=t)
    finding = only(capture)
    assert (finding.kind, finding.rows, finding.severity) == ("restart", (2001,), "mended")
    assert np.allclose(capture.t, times(), atol=1e-9)
    assert capture.rate_hz == RATE


def test_the_stamps_in_use_always_rise() -> None:
    rng = np.random.default_rng(3)
    t = times() + rng.normal(0.0, 2e-3, N)
    t[rng.integers(0, N, 20)] = np.nan
    capture = recording(t=t)
    assert np.all(np.diff(capture.t[capture.mask]) > 0.0)


def test_missing_samples_are_counted_and_not_filled_in() -> None:
    keep = np.ones(N, dtype=bool)
    keep[500:510] = False
    good = recording()
    capture = Capture.from_arrays(**{name: values[keep] for name, values in good.columns.items()})
    finding = only(capture)
    assert (finding.kind, finding.count, finding.rows) == ("gap", 10, (500,))
    assert capture.samples == N - 10
    assert capture.rate_hz == RATE


def test_a_masked_stamp_is_not_counted_as_a_gap() -> None:
    t = times()
    t[40:45] = np.nan
    assert only(recording(t=t)).kind == "non-finite"


def test_an_uneven_clock_is_noted_and_used_as_it_is() -> None:
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.6e-3, 1.4e-3, N))
    capture = Capture.from_arrays(t=t, theta=np.sin(t), tau=np.cos(t) + rng.standard_normal(N))
    assert (only(capture).kind, only(capture).severity) == ("jitter", "note")
    assert capture.mask.all()
    assert np.array_equal(capture.t, t)
    assert capture.rate_hz == pytest.approx(RATE, rel=0.02)


def test_times_rounded_to_a_twentieth_of_the_interval_pass_as_even() -> None:
    assert recording(t=np.round(times() + 0.12345, 5)).findings == ()


@pytest.mark.parametrize(("factor", "word"), [(1e3, "ms"), (1e6, "us"), (1e-4, "clock")])
def test_times_in_another_unit_make_an_unusual_rate(factor: float, word: str) -> None:
    t = times() * factor
    finding = only(Capture.from_arrays(t=t, theta=np.sin(times()), tau=np.cos(times())))
    assert (finding.kind, finding.severity) == ("rate", "note")
    assert word in finding.message


@pytest.mark.parametrize("low", [-0.04, -1.0])
@pytest.mark.parametrize("high", [0.04, 1.0])
def test_a_saturated_torque_is_masked_on_each_side_on_its_own(low: float, high: float) -> None:
    free = recording().tau
    tau = np.clip(free, low, high)
    capture = recording(tau=tau)
    assert masked(capture) == (np.flatnonzero(tau != free) + 1).tolist()
    assert [finding.kind for finding in capture.findings] == ["clipped"] * ((low == -0.04) + (high == 0.04))


@pytest.mark.parametrize("step", [1e-5, 1e-3, 4e-3])
def test_a_quantised_torque_is_not_called_clipped(step: float) -> None:
    assert recording(tau=np.round(recording().tau / step) * step).findings == ()


@pytest.mark.parametrize("step", [1e-3, 2e-3, 3e-3])
def test_a_quantised_noise_free_sine_is_not_called_clipped(step: float) -> None:
    tau = 0.05 * np.cos(2.0 * np.pi * 1.5 * times())
    assert recording(tau=np.round(tau / step) * step).findings == ()


def test_a_quantised_and_saturated_torque_is_called_clipped() -> None:
    tau = np.clip(np.round(recording().tau / 1e-4) * 1e-4, -1.0, 0.045)
    assert only(recording(tau=tau)).kind == "clipped"


def test_a_motor_that_is_off_is_not_called_clipped() -> None:
    assert recording(tau=np.maximum(recording().tau, 0.0)).findings == ()


def test_dry_friction_alone_is_not_called_clipped_but_computed() -> None:
    torque = 0.02 * np.sign(np.cos(2.0 * np.pi * 1.5 * times()))
    finding = only(recording(tau=torque))
    assert (finding.kind, finding.severity) == ("few-values", "warning")
    assert "2 values alone (-0.02, 0.02)" in finding.message
    noise = 1e-5 * np.random.default_rng(2).standard_normal(N)
    assert recording(tau=torque + noise).findings == ()
    assert recording(tau=torque, torque_unit="V").findings == ()


@pytest.mark.parametrize("name", ["theta", "omega", "alpha", "tau"])
def test_a_column_that_never_changes_is_warned_about(name: str) -> None:
    findings = recording(**{name: np.full(N, 0.25)}).findings
    stuck = [finding for finding in findings if finding.kind == "stuck"]
    assert [(finding.column, finding.severity) for finding in stuck] == [(name, "warning")]


def test_a_derivative_of_pure_noise_is_not_judged() -> None:
    rng = np.random.default_rng(11)
    assert recording(omega=rng.standard_normal(N), alpha=rng.standard_normal(N)).findings == ()


def test_a_torque_beyond_any_hand_is_warned_about_until_its_unit_is_stated(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    columns = np.column_stack([times(), recording().theta, 1000.0 * recording().tau])
    np.savetxt(log, columns, delimiter=",", header="t_s,theta_rad,tau_Nm", comments="")
    finding = only(kc.load(log))
    assert (finding.kind, finding.column, finding.severity) == ("unit", "tau", "warning")
    assert "[mNm]" in finding.message
    assert kc.load(log, map="t=t_s, theta=theta_rad, tau=tau_Nm [Nm]").findings == ()
    assert kc.learn(kc.load(log)).verdict == "unexplained"


def test_an_angle_in_degrees_is_warned_about(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    columns = np.column_stack([times(), np.degrees(recording().theta), recording().tau])
    np.savetxt(log, columns, delimiter=",", header="t_s,theta_rad,tau_Nm", comments="")
    finding = only(kc.load(log))
    assert (finding.kind, finding.column) == ("unit", "theta") and "[deg]" in finding.message


def degrees(tmp_path: Path, angle_deg: NDArray[np.float64], header: str = "theta_rad") -> tuple[Finding, ...]:
    log = tmp_path / "log.csv"
    columns = np.column_stack([times(), angle_deg, recording().tau])
    np.savetxt(log, columns, delimiter=",", header=f"t_s,{header},tau_Nm", comments="", fmt="%.7g")
    return tuple(one for one in kc.load(log).findings if one.kind == "unit")


def test_degrees_are_warned_about_where_only_moments_are_beyond_hands(tmp_path: Path) -> None:
    slow = 0.75 * np.sin(2.0 * np.pi * 0.5 * times()) + 1e-5 * np.random.default_rng(5).standard_normal(N)
    (finding,) = degrees(tmp_path, np.degrees(slow))
    assert finding.column == "theta" and "to and fro" in finding.message
    assert degrees(tmp_path, slow) == ()
    # A motor that runs one way as fast is faster for good or not at all.
    assert degrees(tmp_path, 50.0 * times() ** 2 / times()[-1]) == ()


def test_steps_of_a_binary_encoder_in_degrees_are_warned_about_however_slow(tmp_path: Path) -> None:
    slow = 0.05 * np.sin(2.0 * np.pi * 0.5 * times())
    for full, found in ((360.0, True), (2.0 * np.pi, False), (6.0, False)):
        step = full / 16384
        angle = step * np.floor(full / (2.0 * np.pi) * slow / step)
        assert bool(degrees(tmp_path, angle)) is found, full
    assert degrees(tmp_path, np.round(slow, 3)) == ()


def test_a_torque_that_stands_still_while_the_knob_moves_is_masked() -> None:
    tau = recording().tau.copy()
    tau[: N // 2] = 0.0
    finding = only(recording(tau=tau))
    assert (finding.kind, finding.spans, finding.severity) == ("dead", ((1, N // 2),), "masked")


def test_a_motor_that_is_switched_off_is_no_dead_sensor() -> None:
    inertia, damping = 5e-5, 5e-4  # kg m^2, N m s/rad
    t = times()
    driven = t < t[-1] / 2
    omega = np.where(driven, 8.0 * np.sin(30.0 * t), 0.0)
    omega[~driven] = omega[driven][-1] * np.exp(-damping / inertia * (t[~driven] - t[driven][-1]))
    theta = np.cumsum(omega) * (t[1] - t[0])
    drive = inertia * 240.0 * np.cos(30.0 * t) + damping * omega
    tau = np.where(driven, drive + 1e-5 * np.random.default_rng(3).standard_normal(N), 0.0)
    noisy = theta + 1e-5 * np.random.default_rng(4).standard_normal(N)
    capture = recording(theta=noisy, omega=None, alpha=None, tau=tau)
    assert not [finding for finding in capture.findings if finding.kind == "dead"]


def test_an_angle_held_between_readings_counts_where_it_is_new() -> None:
    held = recording().theta[np.arange(N) // 10 * 10]
    capture = recording(theta=held, omega=None, alpha=None)
    finding = only(capture)
    assert (finding.kind, finding.column, finding.severity) == ("held", "theta", "mended")
    assert finding.count == pytest.approx(0.9 * N, rel=0.01)
    true, prepared = recording().theta, capture.prepare()
    assert np.abs(prepared.theta - true)[prepared.used].max() < 1e-3


def test_counts_of_a_slow_encoder_are_not_held() -> None:
    counts = np.round(recording().theta / 2e-3) * 2e-3
    assert recording(theta=counts, omega=None, alpha=None).findings == ()


def test_counts_of_an_encoder_repeat_by_themselves_and_rows_that_repeat_torque_as_well_are_told() -> None:
    count = 2.0 * np.pi / 16384
    theta = count * np.floor(recording().theta / count)
    assert not recording(theta=theta, omega=None, alpha=None).findings
    tau = recording().tau.copy()
    at = 20 + 97 * np.arange(30)
    theta[at], tau[at] = theta[at - 1], tau[at - 1]
    finding = only(recording(theta=theta, omega=None, alpha=None, tau=tau))
    assert finding.kind == "stale"
    assert {row for first, last in finding.spans for row in range(first, last + 1)} <= set((at + 1).tolist())
    assert finding.count >= 25


def test_of_an_angle_that_leaps_once_and_goes_on_the_longer_part_is_kept() -> None:
    theta = recording().theta + np.where(times() > 1.0, 1.2, 0.0)
    capture = recording(theta=theta, omega=None, alpha=None)
    finding = only(capture)
    assert (finding.kind, finding.severity) == ("jump", "masked")
    assert finding.spans == ((1, 1001),) and finding.count == 1001
    assert "rows 1002" in finding.message or "row 1002" in finding.message
    assert not capture.mask[:1001].any() and capture.mask[1003:].all()


def test_an_angle_that_leaps_again_and_goes_on_splits_the_log() -> None:
    theta = recording().theta + 1.2 * (times() > 1.0) + 0.8 * (times() > 2.0)
    capture = recording(theta=theta, omega=None, alpha=None)
    finding = only(capture)
    assert (finding.kind, finding.count, finding.severity) == ("jump", 2, "warning")
    assert (~capture.mask).sum() == 8


def test_an_angle_that_leaps_by_more_than_half_a_turn_but_no_whole_one_does_not_wrap() -> None:
    theta = recording().theta + np.where(times() > 1.0, 4.0, 0.0)
    finding = only(recording(theta=theta))
    assert (finding.kind, finding.severity) == ("jump", "masked")


@pytest.mark.parametrize("name", ["omega", "alpha"])
def test_an_optional_column_without_a_number_counts_as_absent(name: str) -> None:
    capture = recording(**{name: np.full(N, np.nan)})
    assert getattr(capture, name) is None
    assert only(capture).kind == "empty"
    assert capture.mask.all()


@pytest.mark.parametrize("name", ["t", "theta", "tau"])
def test_a_needed_column_without_a_number_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=f"column {name} has no number"):
        recording(**{name: np.full(N, np.nan)})


def test_time_that_stands_still_is_refused() -> None:
    with pytest.raises(InputError, match="t does not advance"):
        recording(t=np.zeros(N))
    with pytest.raises(InputError, match="more than a float64"):
        Capture.from_arrays(t=[0.0, 1e-310], theta=[0, 1], tau=[0, 1])


def test_one_row_is_refused() -> None:
    with pytest.raises(InputError, match="1 rows of data"):
        Capture.from_arrays(t=[0.0], theta=[0.0], tau=[0.0])


def test_columns_that_are_never_finite_together_are_refused() -> None:
    with pytest.raises(InputError, match="fewer than 2 usable samples"):
        Capture.from_arrays(t=[0, 1, 2, 3], theta=[0, 1, np.nan, np.nan], tau=[np.nan, np.nan, 0, 1])


def test_findings_print_their_severity_first() -> None:
    t = times()
    t[100] = t[99]
    assert str(only(recording(t=t))).startswith("masked: t: 1 samples repeat")
