"""Encoders that miss counts, sensors that are off for a time, torque that stands or has the other sign.

Knobs, motions and logs are of the simulator that shares nothing with the core.
"""

from __future__ import annotations

import zlib
from functools import cache
from pathlib import Path

import hidden
import numpy as np
import pytest
from hidden.faults import FAULTS, Columns

import knobcam as kc

SEED = 4711
COLUMNS = {"t_s": "t", "theta_rad": "theta", "omega_rad_s": "omega", "alpha_rad_s2": "alpha", "tau_Nm": "tau"}


@cache
def knob(
    motion: str = "chirp", effects: tuple[str, ...] = (), strength: float | None = None
) -> hidden.Hidden:
    return hidden.make(SEED, effects, motion, strength)


def spoiled(fault: str, motion: str = "chirp") -> kc.Capture:
    (one,) = FAULTS[fault]
    columns = {name: values.copy() for name, values in knob(motion).capture.items()}
    return capture(one.put(np.random.default_rng(SEED), columns))


def capture(columns: Columns) -> kc.Capture:
    return kc.Capture.from_arrays(**{COLUMNS[name]: values for name, values in columns.items()})


def off(fit: kc.Fit, motion: str = "chirp") -> float:
    """How far the inertia is from the truth, as a share, or 0 where its interval holds."""
    estimate, true = fit.params["inertia.M"], knob(motion).knob["inertia.M"]
    low, high = estimate.ci95
    return 0.0 if low <= true <= high else abs(estimate.value / true - 1.0)


@pytest.mark.parametrize("motion", ["chirp", "turns", "multisine"])
def test_counts_that_were_missed_are_put_back_and_the_floor_stays(motion: str) -> None:
    log = spoiled("missed counts", motion)
    (missed,) = [finding for finding in log.findings if finding.kind == "missed"]
    assert missed.severity == "mended" and missed.rows
    whole = knob(motion).capture["theta_rad"]
    written = FAULTS["missed counts"][0].put(np.random.default_rng(SEED), knob(motion).capture)["theta_rad"]
    before, after = (np.ptp((theta - whole)[log.mask]) for theta in (written, log.theta))
    assert after < 0.5 * before
    fit = kc.fit(log)
    assert fit.noise_floor == pytest.approx(knob(motion).noise_floor, rel=0.1)
    assert off(fit, motion) < 0.02


@pytest.mark.parametrize("seed", [1005, 1013, 1027])
def test_counts_that_a_slow_knob_misses_are_put_back_be_they_close_by_each_other(seed: int) -> None:
    # Less than a count a row: it stands for 20 to 90 rows; some leap meanwhile, or right after.
    slow = hidden.make(seed, (), "hand" if seed == 1027 else "multisine")
    rng = np.random.default_rng([seed, zlib.crc32(b"missed counts")])
    log = capture(FAULTS["missed counts"][0].put(rng, slow.capture))
    assert [finding.kind for finding in log.findings] == ["missed"]
    fit = kc.fit(log)
    estimate, true = fit.params["inertia.M"], slow.knob["inertia.M"]
    assert estimate.value == pytest.approx(true, rel=0.03)
    assert estimate.ci95[1] - estimate.ci95[0] < 0.15 * true
    assert fit.noise_floor == pytest.approx(slow.noise_floor, rel=0.05)


@pytest.mark.parametrize("motion", ["multisine", "turns"])
def test_a_torque_that_is_ahead_is_fitted_with_its_delay_and_both_are_right(motion: str) -> None:
    log = spoiled("torque ahead 5 rows", motion)
    fit = kc.fit(log)
    (late,) = [one for one in fit.document()["findings"] if one["kind"] == "late_column"]
    assert late["column"] == "tau" and late["done"] == "mended"
    assert late["message"] in repr(fit) and late["message"] not in fit.warnings
    delay = fit.params["actuation_delay.delay"]
    assert delay.ci95[0] < 1e-3 < delay.ci95[1] and delay.se < 1e-4  # 5 rows of 0.2 ms
    assert off(fit, motion) < 0.02
    # As the clean capture determines it, and better than the log as it stands.
    assert fit.before is not None
    widths = [one.params["inertia.M"].se for one in (kc.fit(capture(knob(motion).capture)), fit, fit.before)]
    assert widths[1] == pytest.approx(widths[0], rel=0.1) and widths[1] < widths[2]


def test_what_is_asked_for_of_a_torque_that_is_ahead_is_left_as_it_is() -> None:
    log = spoiled("torque ahead 5 rows", "multisine")
    asked = kc.fit(log, kc.fit(capture(knob("multisine").capture)).model)
    assert "actuation_delay" not in asked.model.effects
    (late,) = [one for one in asked.document()["findings"] if one["kind"] == "late_column"]
    assert late["done"] == "none" and late["message"] in asked.warnings
    story = kc.learn(log)  # which finds by itself what is missing
    assert (story.verdict, story.found) == ("missing", ("actuation_delay",))
    assert [one["done"] for one in story.document()["findings"] if one["kind"] == "late_column"] == ["mended"]


@pytest.mark.parametrize("motion", ["multisine", "turns"])
def test_a_torque_that_is_read_late_is_fitted_with_its_delay_and_the_inertia_is_right(motion: str) -> None:
    fit = kc.fit(spoiled("torque late 5 rows", motion))
    (late,) = [one for one in fit.document()["findings"] if one["kind"] == "late_column"]
    assert late["column"] == "tau" and late["done"] == "mended" and "ms after the motion" in late["message"]
    later = fit.params["torque_lag.lag"].value + fit.params["torque_lag.delay"].value
    assert later == pytest.approx(1e-3, rel=0.02) and off(fit, motion) < 0.02  # 5 rows of 0.2 ms
    assert fit.before is not None and fit.params["inertia.M"].se < fit.before.params["inertia.M"].se


@pytest.mark.parametrize("effects", [(), ("stribeck",), ("presliding",), ("directional_detent",)])
def test_a_torque_that_is_in_its_place_is_not_said_to_be_ahead_or_late(effects: tuple[str, ...]) -> None:
    log = capture(knob("multisine", effects, 6.0 if effects else None).capture)
    assert kc.fit(log).ahead is None


def test_rows_that_repeat_a_count_and_a_torque_are_told_where_the_angle_never_stands() -> None:
    # At 4 to 7 counts a row; the torque, in steps of its own, repeats by chance now and then.
    turning = hidden.make(1134, (), "turns")
    columns = FAULTS["16384 counts, angle only"][0].put(np.random.default_rng(1), turning.capture)
    fast = np.flatnonzero(np.abs(turning.capture["omega_rad_s"][:-1]) > 4.0)
    at = np.sort(np.random.default_rng(2).choice(fast[::25], 30, replace=False)) + 1
    for name in ("theta_rad", "tau_Nm"):
        columns[name][at] = columns[name][at - 1]
    log = capture(columns)
    (stale,) = [finding for finding in log.findings if finding.kind == "stale"]
    rows = {row for first, last in stale.spans for row in range(first, last + 1)}
    assert rows == set((at + 1).tolist())


@pytest.mark.parametrize("motion", ["hand", "multisine", "chirp", "turns"])
def test_a_slow_encoder_that_misses_none_is_not_said_to(motion: str) -> None:
    for seed in (1005, 1027, 1033):
        counts = FAULTS["16384 counts, angle only"][0].put
        log = capture(counts(np.random.default_rng(seed), hidden.make(seed, (), motion).capture))
        assert not [finding for finding in log.findings if finding.kind in ("missed", "jump", "spike")]


def test_a_turn_that_is_slower_than_a_count_in_twenty_rows_is_no_count_that_was_missed() -> None:
    slow = hidden.make(1082, ["torque_lag"], "hand", 3.0)
    log = capture(FAULTS["16384 counts, angle only"][0].put(np.random.default_rng(0), slow.capture))
    assert not [finding for finding in log.findings if finding.kind == "missed"]


def test_a_slip_of_the_knob_itself_is_no_count_that_was_missed() -> None:
    for effects in (("backlash",), ("compliance",)):
        log = capture(knob("hand", effects, 10.0).capture)
        assert not [finding for finding in log.findings if finding.kind in ("missed", "dead", "jump")]


@pytest.mark.parametrize("every", [4, 10])
def test_a_torque_that_stands_is_compared_where_it_was_read(every: int) -> None:
    columns = dict(knob().capture)
    columns["tau_Nm"] = columns["tau_Nm"][np.arange(len(columns["t_s"])) // every * every]
    log = capture(columns)
    assert [(one.kind, one.column, one.severity) for one in log.findings] == [("held", "tau", "mended")]
    prepared = kc.prepare(log)
    assert prepared.core.rate_hz == pytest.approx(5000.0 / every)
    assert (prepared.rows % every == 0).all()
    story = kc.learn(log)
    assert (story.verdict, story.found) == ("complete", ())
    assert off(story.fit) < 0.02


@pytest.mark.parametrize("fault", ["wild runs of alpha", "angle away for ms"])
def test_a_sensor_that_is_off_for_a_time_does_not_pull_the_motion(fault: str) -> None:
    fit, clean = kc.fit(spoiled(fault)), kc.fit(capture(knob().capture))
    assert any(one.kind == "spike" for one in fit.prepared[0].findings)
    assert fit.params["inertia.M"].value == pytest.approx(clean.params["inertia.M"].value, rel=0.01)


@pytest.mark.parametrize("stuck", [False, True])
def test_torque_that_is_garbage_for_tens_of_rows_is_masked(stuck: bool) -> None:
    columns = {name: values.copy() for name, values in knob().capture.items()}
    rng = np.random.default_rng(3)
    columns["tau_Nm"][9000:9080] = 0.15 if stuck else rng.uniform(-0.15, 0.15, 80)
    log = capture(columns)
    assert [(one.kind, one.column) for one in log.findings] == [("dead" if stuck else "spike", "tau")]
    assert not log.mask[9002:9078].any() and log.mask[:8980].all() and log.mask[9100:].all()


@pytest.mark.parametrize("motion", ["multisine", "hand"])
def test_a_reversed_torque_is_told_beside_a_spring(motion: str) -> None:
    columns = dict(knob(motion, ("return_spring",), 30.0).capture)
    upright, reversed_ = kc.fit(capture(columns)), kc.fit(capture(columns | {"tau_Nm": -columns["tau_Nm"]}))
    assert upright.log_fault is None
    assert reversed_.log_fault is not None and "other sign" in reversed_.log_fault


def held_log(folder: Path, every: int, jitter: int = 0) -> Path:
    """A log that is written `every` rows for each reading of the machine, or so many more or fewer."""
    columns = knob().capture
    rng = np.random.default_rng(SEED)
    length = len(columns["t_s"])
    reads = np.cumsum(every + rng.integers(-jitter, jitter + 1, length // every))
    last = np.concatenate(([0], reads[reads < length]))[
        np.searchsorted(reads, np.arange(length), side="right").clip(max=np.sum(reads < length))
    ]
    path = folder / "held.npz"
    np.savez(path, **{name: at if name == "t_s" else at[last] for name, at in columns.items()})
    return path


@pytest.mark.parametrize(("every", "jitter"), [(2, 0), (5, 0), (5, 1)])
def test_a_log_written_more_often_than_the_machine_was_read_is_taken_as_it_was_read(
    tmp_path: Path, every: int, jitter: int
) -> None:
    log = kc.load(held_log(tmp_path, every, jitter))
    (found,) = [one for one in log.findings if one.kind == "held"]
    assert (found.column, found.severity) == ("t", "mended")
    assert log.samples == pytest.approx(30_000 / every, rel=0.02) and log.mask.mean() > 0.95
    assert log.rate_hz == pytest.approx(5000.0 / every, rel=0.02)
    fit = kc.fit(log)
    assert off(fit) < 0.02 and fit.compare().complete


def test_who_says_that_rows_that_repeat_were_measured_keeps_them(tmp_path: Path) -> None:
    log = kc.load(held_log(tmp_path, 5), overrule=["held:t"])
    assert log.samples == 30_000 and any(one.key == "held:t" and one.overruled for one in log.findings)


def test_a_knob_at_rest_repeats_what_it_says(tmp_path: Path) -> None:
    """Its motor off, half of the time: these rows were measured, and stay."""
    columns = {name: values.copy() for name, values in knob("turns").capture.items()}
    rest = np.zeros(len(columns["t_s"]), dtype=bool)
    for start in range(1000, 28_000, 6000):
        rest[start : start + 3500] = True
    for name, values in columns.items():
        if name != "t_s":
            values[rest] = 0.0 if name != "theta_rad" else values[999]
    path = tmp_path / "rests.npz"
    np.savez(path, **columns)
    log = kc.load(path)
    assert log.samples == 30_000 and not [one for one in log.findings if one.key == "held:t"]


def test_a_machine_asked_at_other_times_than_it_reads_has_lost_no_rows() -> None:
    """It repeats a reading here and skips one there: the clock of the log was right."""
    columns = {name: values.copy() for name, values in knob().capture.items()}
    length = len(columns["t_s"])
    rng = np.random.default_rng(SEED)
    asked = np.floor(
        np.arange(length) + 0.5 + 0.05 * rng.standard_normal(length) + 0.2 * np.sin(0.003 * np.arange(length))
    )
    late = rng.random(length) < 0.04
    read = np.where(late, asked - 1, asked).astype(int).clip(0, length - 1)
    log = capture({name: at if name == "t_s" else at[read] for name, at in columns.items()})
    assert not [one for one in log.findings if one.kind == "lost"]
    assert log.t[-1] == columns["t_s"][-1]
    (asked_for,) = [one for one in log.findings if one.kind == "asked"]
    twice = (
        np.flatnonzero(read[1:] < np.arange(1, length)) + 1
    )  # a reading too late, and not as the one before
    twice = twice[read[twice] != read[twice - 1]]
    assert set(asked_for.rows) <= set(twice + 1)


@pytest.mark.parametrize("derived", [False, True])
def test_readings_that_a_clock_runs_ahead_of_and_behind_are_taken_at_their_own_times(derived: bool) -> None:
    """An arm over UDP: a row without a reading here, two readings in one there, by one clock or the other."""
    columns = {name: values.copy() for name, values in knob().capture.items()}
    rng = np.random.default_rng(SEED)
    length = len(columns["t_s"]) - 100
    slips = np.cumsum(rng.integers(40, 120, 400))
    ahead = np.zeros(length, dtype=int)
    for at in slips[slips < length - 200]:
        ahead[at:] += rng.choice([-1, 1])
    read = (np.arange(length) + ahead).clip(0)
    kept = ("t_s", "theta_rad", "tau_Nm") if derived else tuple(columns)
    log = capture({name: columns[name][slice(length) if name == "t_s" else read] for name in kept})
    (asked,) = [one for one in log.findings if one.kind == "asked"]
    assert asked.severity == "mended"
    fit = kc.fit(log)
    assert fit.prepared[0].core.used > 0.95 * length
    assert fit.noise_floor == pytest.approx(knob().noise_floor, rel=0.05)
    assert fit.params["inertia.M"].value == pytest.approx(knob().knob["inertia.M"], rel=0.01)


def test_of_a_log_that_lost_rows_here_and_there_nearly_all_others_count() -> None:
    """Each such row cost what the torque's filter needs to settle, on both sides."""
    rng = np.random.default_rng(SEED)
    stays = np.ones(len(knob().capture["t_s"]), dtype=bool)
    stays[rng.choice(np.arange(10, len(stays) - 10), 600, replace=False)] = False
    log = capture({name: values[stays] for name, values in knob().capture.items()})
    fit = kc.fit(log)
    used = fit.prepared[0].core.used
    assert used > 0.97 * stays.sum()
    assert fit.noise_floor == pytest.approx(knob().noise_floor, rel=0.03)
    assert fit.params["inertia.M"].value == pytest.approx(knob().knob["inertia.M"], rel=0.005)
    assert len(fit.residual) == stays.sum() and np.isfinite(fit.residual).sum() == used


def test_a_torque_that_changes_fast_while_the_knob_sticks_was_measured() -> None:
    """A joint at 100 Hz, its torque smoothed and read a little more seldom than it is logged."""
    t = np.arange(4000) / 100.0
    rests = np.zeros(len(t), dtype=bool)
    for turn in (262, 826, 1389):  # where it turns back it stands for 0.4 s
        rests[turn : turn + 40] = True
    theta = np.sin(0.006 * np.cumsum(~rests))
    tau = 0.4 * np.cos(0.006 * np.cumsum(~rests))
    tau[rests] += np.tile(np.repeat(np.linspace(0.0, 0.5, 20), 2), 3)
    for turn in (302, 866, 1429):
        tau[turn : turn + 400] += 0.5 * np.cos(np.linspace(0.0, np.pi / 2.0, 400))
    tau += 2e-5 * np.random.default_rng(SEED).standard_normal(len(t))
    counts = np.round(theta / 1.5e-3) * 1.5e-3
    log = kc.Capture.from_arrays(t=t, theta=counts, tau=tau)
    assert not [one for one in log.findings if one.column == "tau" and one.severity == "masked"]


def test_noise_that_grows_with_the_torque_is_no_garbage() -> None:
    """As of a current that is measured: a part of the torque where that is large, next to none elsewhere."""
    sprung = knob("turns", ("return_spring",), 30.0).capture
    columns = {name: values.copy() for name, values in sprung.items()}
    tau, rng = columns["tau_Nm"], np.random.default_rng(4)
    at = np.argmax(np.abs(tau[2000:28_000])) + 2000
    tau[at : at + 90] += 0.1 * np.std(tau) * rng.standard_normal(90)
    assert not [one for one in capture(columns).findings if one.kind == "spike"]


def test_a_loop_that_chatters_is_no_garbage() -> None:
    """A controller that makes its torque of the velocity, six rows a swing: the motion has it too."""
    columns = {name: values.copy() for name, values in knob("hand").capture.items()}
    rng, many = np.random.default_rng(5), 60
    loud = 9000 + np.arange(many)
    swing = 0.1 * np.sin(2.0 * np.pi * np.arange(many) / 6.0 + 0.3 * rng.standard_normal(many).cumsum())
    columns["tau_Nm"][loud] += swing
    columns["omega_rad_s"][loud - 1] += 0.15 * swing
    assert not [one for one in capture(columns).findings if one.kind == "spike"]
