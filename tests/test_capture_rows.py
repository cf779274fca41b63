"""Rows that a log repeats, loses or misreads: each is found where it is, and a clean log has none."""

from __future__ import annotations

import math

import numpy as np
import pytest

from knobcam import Capture, fit, load
from knobcam.base.arrays import FloatArray

RATE_HZ = 5000.0
N = 30_000
ANGLE_NOISE_RAD = 1e-5
TORQUE_NOISE_NM = 1.8e-3


def motion(seed: int = 0) -> dict[str, FloatArray]:
    """A knob with friction that is turned to and fro, its columns with the noise of their sensors."""
    rng = np.random.default_rng(seed)
    t = np.arange(N) / RATE_HZ
    theta, omega, alpha = np.zeros(N), np.zeros(N), np.zeros(N)
    for hz, size in ((0.4, 2.0), (1.3, 0.5), (3.1, 0.05)):
        w, phase = 2.0 * np.pi * hz, rng.uniform(0.0, 2.0 * np.pi)
        theta += size * np.sin(w * t + phase)
        omega += size * w * np.cos(w * t + phase)
        alpha -= size * w * w * np.sin(w * t + phase)
    tau = 5e-5 * alpha + 0.02 * np.sign(omega) + 1e-3 * omega
    return {
        "t": t,
        "theta": theta + ANGLE_NOISE_RAD * rng.standard_normal(N),
        "omega": omega + 5e-3 * rng.standard_normal(N),
        "alpha": alpha + 0.4 * rng.standard_normal(N),
        "tau": tau + TORQUE_NOISE_NM * rng.standard_normal(N),
    }


def fast(columns: dict[str, FloatArray], count: int, seed: int = 1) -> np.ndarray:
    """Rows at which the knob turns briskly, far from each other."""
    rng = np.random.default_rng(seed)
    brisk = np.flatnonzero(np.abs(np.gradient(columns["theta"], 1.0 / RATE_HZ)) > 2.0)
    brisk = brisk[(brisk > 200) & (brisk < N - 200)]
    return np.sort(rng.choice(brisk[::400], count, replace=False))


def without_motion(columns: dict[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: columns[name] for name in ("t", "theta", "tau")}


def measured(columns: dict[str, FloatArray]) -> Capture:
    return Capture.from_arrays(**columns)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("counts", [0, 4096, 65536])
def test_a_clean_log_has_no_faults(seed: int, counts: int) -> None:
    columns = motion(seed)
    assert measured(columns).findings == ()
    if counts:
        step = 2.0 * np.pi / counts
        columns["theta"] = step * np.round(columns["theta"] / step)
    assert measured(without_motion(columns)).findings == ()


@pytest.mark.parametrize("angle_alone", [False, True])
def test_a_row_that_repeats_the_one_before_is_masked(angle_alone: bool) -> None:
    columns = motion()
    at = fast(columns, 20)
    for values in (columns[name] for name in ("theta", "omega", "alpha", "tau")):
        values[at] = values[at - 1]
    capture = measured(without_motion(columns) if angle_alone else columns)
    (finding,) = capture.findings
    assert (finding.kind, finding.count, finding.severity) == ("stale", 20, "masked")
    np.testing.assert_array_equal(np.flatnonzero(~capture.mask), at)
    assert finding.document()["rows"] == [[row + 1, row + 1] for row in at]


def test_a_row_that_repeats_one_at_the_sensors_limit_stays_masked_where_those_are_counted() -> None:
    columns = motion()
    limit = 0.7 * np.abs(columns["tau"]).max()
    columns["tau"] = np.clip(columns["tau"], -limit, limit)
    at = np.flatnonzero((np.abs(columns["tau"]) == limit) & (np.abs(columns["omega"]) > 3.0))[10::300]
    for values in (columns[name] for name in ("theta", "omega", "alpha", "tau")):
        values[at] = values[at - 1]
    at = at[np.abs(columns["tau"][at]) == limit]
    assert at.size
    counted = measured(columns).with_clipped()
    assert not counted.mask[at].any() and counted.mask.mean() > 0.99


def test_rows_that_are_lost_while_the_clock_counts_on_are_found_and_the_times_moved() -> None:
    columns = motion()
    at, lost = fast(columns, 5), (1, 2, 3, 1, 7)
    gone = np.concatenate([np.arange(row, row + many) for row, many in zip(at, lost, strict=True)])
    kept = {name: np.delete(values, gone) for name, values in columns.items()}
    capture = measured(kept | {"t": columns["t"][: len(kept["t"])]})
    (finding,) = capture.findings
    assert (finding.kind, finding.count, finding.severity) == ("lost", sum(lost), "mended")
    np.testing.assert_allclose(capture.t, kept["t"], atol=1e-9)


def test_a_third_of_the_rows_that_is_lost_by_a_pause_in_every_fifty_is_found() -> None:
    """A program that prints every 50 rows, for 40 ms: the velocity was "0.70 times d theta/dt".

    So many steps in one are no whole number of those beside it where the speed is another one behind; some
    were "counts that an encoder missed". Where the motion turns, its velocity says how far a row goes.
    """
    rng, t = np.random.default_rng(5), np.arange(N) / 500.0
    swings = [(0.5, 0.63), (0.1, 2.3)]
    theta = sum(size * np.sin(rate * t) for size, rate in swings)
    omega = sum(size * rate * np.cos(rate * t) for size, rate in swings)
    pause = rng.integers(17, 23, N // 50)
    ends = np.cumsum(50 + pause)
    gone = np.concatenate([np.arange(end - many, end) for end, many in zip(ends, pause, strict=True)])
    gone = gone[gone < N]
    kept = np.setdiff1d(np.arange(N), gone)
    found = Capture.from_arrays(
        t=t[: len(kept)],
        theta=(theta + ANGLE_NOISE_RAD * rng.standard_normal(N))[kept],
        omega=(omega + 1e-3 * rng.standard_normal(N))[kept],
        tau=(np.sign(omega) + 0.1 * rng.standard_normal(N))[kept],
    )
    (lost,) = found.findings
    assert lost.kind == "lost" and 0.95 < lost.count / len(gone) < 1.0
    assert found.t[-1] == pytest.approx(t[kept[-1]], rel=0.01)
    assert found.omega is not None


def test_rows_that_the_clock_says_are_missing_are_a_gap_alone() -> None:
    columns = motion()
    gone = fast(columns, 3)
    capture = measured({name: np.delete(values, gone) for name, values in columns.items()})
    assert [finding.kind for finding in capture.findings] == ["gap"]


def test_a_clock_that_jitters_over_an_even_motion_has_lost_nothing() -> None:
    columns = without_motion(motion())
    rng = np.random.default_rng(3)
    columns["t"] = columns["t"] + rng.uniform(-0.2, 0.2, N) / RATE_HZ * (rng.random(N) < 0.05)
    assert {finding.kind for finding in measured(columns).findings} == {"jitter"}


def test_an_angle_that_wraps_is_taken_on() -> None:
    columns = motion()
    wrapped = np.mod(columns["theta"] + 6.0, 2.0 * np.pi)
    capture = measured(columns | {"theta": wrapped})
    (finding,) = capture.findings
    assert (finding.kind, finding.severity) == ("wrap", "mended")
    np.testing.assert_allclose(capture.theta - capture.theta[0], columns["theta"] - columns["theta"][0])


@pytest.mark.parametrize("name", ["tau", "theta"])
def test_a_reading_that_leaps_for_one_row_is_masked(name: str) -> None:
    columns = motion()
    at = fast(columns, 6)
    columns[name][at] += {"tau": 0.03, "theta": 0.02}[name] * np.array([1, -1, 1, 1, -1, -1])
    capture = measured(columns)
    (finding,) = capture.findings
    assert (finding.kind, finding.column, finding.severity) == ("spike", name, "masked")
    np.testing.assert_array_equal(np.flatnonzero(~capture.mask), at)


@pytest.mark.parametrize("lasting", [1, 5])
@pytest.mark.parametrize("name", ["tau", "theta"])
def test_where_one_reading_in_twenty_is_anything_these_are_masked_and_the_fit_is_as_it_was(
    name: str, lasting: int
) -> None:
    rng = np.random.default_rng(5)
    columns = motion()
    wild = np.zeros(N, dtype=np.bool_)
    while wild.sum() < N // 20:
        first = rng.integers(10, N - 20)
        wild[first : first + rng.integers(1, lasting + 1)] = True
    size = rng.uniform(0.03, 0.1, wild.sum()) * rng.choice([-1.0, 1.0], wild.sum())
    before = fit(measured(columns))
    columns[name][wild] += size
    capture = measured(columns)
    (finding,) = capture.findings
    assert (finding.kind, finding.column, finding.severity) == ("spike", name, "masked")
    assert np.mean(~capture.mask[wild]) > 0.99
    assert np.mean(~capture.mask[~wild]) < 0.002
    after = fit(capture)
    true = 5e-5
    assert abs(after.params["inertia.M"].value / true - 1.0) < 0.02
    assert abs(after.noise_floor / before.noise_floor - 1.0) < 0.1
    # The straight lines that stand for them have more slow noise than what was measured, and no fast one.
    assert abs(after.rmse / after.noise_floor - before.rmse / before.noise_floor) < 0.03


def test_pulses_of_a_knob_and_angles_that_are_read_late_are_not_wild() -> None:
    columns = without_motion(motion())
    at = 100 + 290 * np.arange(100)
    side = np.sign(columns["tau"][at])
    columns["tau"][at] += 0.05 * side
    columns["tau"][at + 1] += 0.03 * side
    assert measured(columns).findings == ()
    late = motion()
    late["theta"][at] -= 0.3 * late["omega"][at] / RATE_HZ
    assert sum(finding.count for finding in measured(late).findings) <= len(at)


def test_where_many_are_wild_those_close_together_and_beside_a_step_are_found_too() -> None:
    rng = np.random.default_rng(8)
    columns = motion()
    columns["tau"] += 0.04 * np.sign(columns["omega"])
    wild = np.zeros(N, dtype=np.bool_)
    wild[rng.choice(np.arange(20, N - 20), N // 25, replace=False)] = True
    turns = np.flatnonzero(np.diff(np.sign(columns["omega"])))
    dense = 15_000 + 7 * np.arange(12)
    wild[np.concatenate((turns - 3, turns + 4, dense, dense[5:6] + 1))] = True
    columns["tau"][wild] += rng.uniform(0.05, 0.1, wild.sum()) * rng.choice([-1.0, 1.0], wild.sum())
    capture = measured(columns)
    # At one reversal six of ten are: there it cannot be told.
    assert capture.mask[wild].sum() <= 3
    assert (~capture.mask[~wild]).sum() <= 10
    after = fit(capture)
    assert after.rmse < 1.1 * after.noise_floor


def test_friction_that_turns_round_in_a_row_and_an_impact_that_the_knob_feels_are_no_spikes() -> None:
    columns = motion()
    columns["tau"] += 0.1 * np.sign(columns["omega"])
    at = fast(columns, 6)
    columns["tau"][at] += 0.05
    columns["alpha"][at] += 1000.0
    assert measured(columns).findings == ()


def test_what_was_found_survives_saving(tmp_path) -> None:
    columns = motion()
    at = fast(columns, 4)
    columns["tau"][at] += 0.05
    capture = measured(columns)
    assert load(capture.save(tmp_path / "capture.npz")).findings == capture.findings


def test_a_fault_of_a_few_rows_costs_those_rows_alone() -> None:
    columns = motion()
    whole = measured(columns)
    lacking = np.random.default_rng(4).random(N) < 0.01
    columns["tau"][lacking] = np.nan
    broken = measured(columns)
    assert abs(broken.prepare().used.sum() / (whole.prepare().used.sum() - lacking.sum()) - 1.0) < 0.01
    before, after = fit(whole), fit(broken)
    low, high = before.params["inertia.M"].ci95
    assert low < after.params["inertia.M"].value < high
    assert abs(after.noise_floor / before.noise_floor - 1.0) < 0.03


def test_a_blow_on_a_knob_is_no_leap_of_its_angle() -> None:
    """At 200 Hz a push forth and back takes a few rows: the steps beside the largest are off too."""
    rate, rows = 200.0, 2000
    t = np.arange(rows) / rate
    rng = np.random.default_rng(4)
    push = np.zeros(rows)
    push[1000:1008] = [3.0, 3.0, 3.0, 3.0, -2.6, -5.6, -5.7, 2.0]
    omega = np.sin(t) + push
    theta = np.cumsum(omega) / rate + 1e-5 * rng.standard_normal(rows)
    columns = {"theta": theta, "tau": 0.01 * np.sin(t) + 1e-3 * rng.standard_normal(rows)}
    capture = Capture.from_arrays(**columns, rate_hz=rate)
    assert not [one for one in capture.findings if one.kind == "spike"] and capture.mask.all()
    leapt = theta.copy()
    leapt[500] += 0.02
    spoiled = Capture.from_arrays(**columns | {"theta": leapt}, rate_hz=rate)
    assert [(one.kind, one.spans) for one in spoiled.findings if one.kind == "spike"] == [
        ("spike", ((501, 501),))
    ]


def test_an_encoder_that_rests_now_and_then_is_not_slow_for_that() -> None:
    # A motor on and off at 250 Hz: it stands for a seventh of the time, and else goes up to 600 counts a row.
    t = np.arange(3000) / 250.0
    alpha = np.where(t % 1.4 < 0.6, 300.0, np.where(t % 1.4 < 1.2, -300.0, 0.0))
    omega = np.cumsum(alpha) / 250.0
    theta = np.cumsum(omega - alpha / 500.0) / 250.0
    count = 2.0 * np.pi / 4096
    log = Capture.from_arrays(
        t=t, theta=np.round(theta / count) * count, tau=1e-4 * alpha + 1e-3 * np.sign(omega)
    )
    moved = log.prepare()
    inner = moved.used
    rows = np.asarray(moved.rows)
    assert np.std((moved.omega - omega[rows])[inner]) < 0.01 * np.std(omega)
    assert moved.alpha[inner] @ alpha[rows][inner] > 0.98 * (alpha[rows][inner] @ alpha[rows][inner])


@pytest.mark.parametrize(("reach", "said"), [(12.5, "jumps by 25, from one end"), (math.pi, "whole turns")])
def test_an_angle_that_wraps_at_the_ends_of_a_register_goes_on_by_its_width(reach: float, said: str) -> None:
    """A drive counts from -12.5 to 12.5 rad: by four whole turns it was 0.13 rad off behind each wrap."""
    rate, rows = 200.0, 12_000
    t = np.arange(rows) / rate
    true = 9.0 * np.sin(0.37 * t) + 8.0 * np.sin(0.11 * t) + 1.3 * t
    read = np.round((true + reach) % (2.0 * reach) / (2.0 * reach) * 65536.0) / 65536.0 * 2.0 * reach - reach
    tau = np.random.default_rng(3).standard_normal(rows)
    found = Capture.from_arrays(t=t, theta=read, tau=tau)
    (wrap,) = [one for one in found.findings if one.kind == "wrap"]
    assert wrap.severity == "mended" and said in wrap.message
    away = found.theta - true
    assert np.ptp(away) < 2e-3
