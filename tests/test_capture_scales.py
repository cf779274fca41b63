"""Columns that contradict each other are named, and mended where two of three leave no doubt."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from recordings import RATE, N, only, recording, times

import knobcam as kc

UNITS = [
    (1e3, "thousandths"),
    (180.0 / math.pi, "degrees"),
    (60.0 / (2.0 * math.pi), "rpm"),
    (1.0 / (2.0 * math.pi), "turns"),
    (0.0985, "tens"),
    (-1.0, "sign"),
    (3.3, "check the units"),
    (50.0, "one side of the gear"),  # near the degrees of a radian, and none
]


@pytest.mark.parametrize("name", ["omega", "alpha"])
@pytest.mark.parametrize(("factor", "word"), UNITS)
def test_a_derivative_in_another_unit_is_left_out_where_two_others_agree(
    name: str, factor: float, word: str
) -> None:
    capture = recording(**{name: recording().columns[name] * factor})
    finding = only(capture)
    assert (finding.kind, finding.severity) == ("sign" if factor < 0.0 else "unit", "mended")
    assert finding.column == name and word in finding.message
    if factor < 0.0:
        assert np.array_equal(capture.columns[name], recording().columns[name])
    else:
        assert name not in capture.columns


@pytest.mark.parametrize("factor", [180.0 / math.pi, math.pi / 180.0, -1.0])
def test_of_two_columns_that_contradict_each_other_either_may_be_wrong(factor: float) -> None:
    capture = recording(omega=recording().columns["omega"] * factor, alpha=None)
    finding = only(capture)
    assert (finding.column, finding.severity) == ("omega", "warning")
    assert np.array_equal(capture.columns["omega"], recording().columns["omega"] * factor)
    assert "to be mended first" in kc.learn(capture).headline


def test_an_angle_is_not_taken_for_a_speed() -> None:
    capture = recording(omega=recording().columns["omega"] * 0.0985, alpha=None)
    assert "may be in tens where rad/s" in only(capture).message


def test_an_angle_in_degrees_is_seen_by_both_derivatives() -> None:
    finding = only(recording(theta=np.rad2deg(recording().theta)))
    assert (finding.kind, finding.column, finding.severity) == ("unit", "theta", "warning")
    assert "theta may be in degrees" in finding.message


def test_a_reversed_angle_is_turned_where_both_derivatives_say_so() -> None:
    capture = recording(theta=-recording().theta)
    finding = only(capture)
    assert (finding.kind, finding.column, finding.severity) == ("sign", "theta", "mended")
    assert np.array_equal(capture.theta, recording().theta)


def test_a_clock_in_milliseconds_is_told_by_both_derivatives() -> None:
    (finding,) = (one for one in recording(t=1e3 * times()).findings if one.kind == "unit")
    assert finding.column == "t" and "t=... [ms]" in finding.message


@pytest.mark.parametrize(
    ("one", "other"), [("theta", "omega"), ("omega", "alpha"), ("alpha", "tau"), ("theta", "tau")]
)
def test_columns_in_each_others_place_are_named_both(one: str, other: str) -> None:
    there = recording().columns
    found = [
        finding
        for finding in recording(**{one: there[other], other: there[one]}).findings
        if finding.kind == "swapped"
    ]
    assert [(finding.column, finding.severity) for finding in found] == [(one, "warning")]
    assert f"{one} what {other} should be" in found[0].message


@pytest.mark.parametrize(("rows", "which"), [(3, "after"), (-3, "before")])
def test_an_angle_that_is_late_against_the_velocity_is_named_with_its_delay(rows: int, which: str) -> None:
    finding = only(recording(theta=np.interp(times() - rows / RATE, times(), recording().theta)))
    assert (finding.kind, finding.column, finding.severity) == ("late_column", "theta", "mended")
    assert re.search(rf"stands (2\.9|3|3\.0)\d* ms .* {which} the omega", finding.message)


def test_a_velocity_that_belongs_to_another_motion_is_a_contradiction() -> None:
    other = 50.0 * np.cos(2.0 * np.pi * 0.7 * times() + 1.0)
    assert [one.kind for one in recording(omega=other).findings] == ["contradiction"]


def test_an_angle_that_is_late_against_both_its_derivatives_is_put_back() -> None:
    true = recording().theta
    capture = recording(theta=np.interp(times() - 3 / RATE, times(), true))
    inside = slice(10, -10)
    assert np.abs(capture.theta - true)[inside].max() < 1e-3  # 0.03 off as it was
    assert not capture.mask[-2:].any()


def test_a_velocity_behind_a_filter_is_left_out_where_nothing_else_tells() -> None:
    omega = np.interp(times() - 5 / RATE, times(), recording().columns["omega"])
    capture = recording(omega=omega, alpha=None)
    assert only(capture).kind == "late_column" and "omega is left out" in only(capture).message
    assert capture.omega is None


def test_the_rows_of_a_clock_that_ticks_more_slowly_are_spread_evenly_unless_they_are_the_same_row() -> None:
    ticks = np.floor(times() * 200.0) / 200.0
    capture = recording(t=ticks)
    finding = only(capture)
    assert (finding.kind, finding.column, finding.severity) == ("duplicate", "t", "mended")
    assert capture.mask.all() and capture.rate_hz == pytest.approx(RATE, rel=1e-3)
    assert np.ptp(capture.t - times()) < 1e-4
    same = {
        name: values[np.arange(N) // 5 * 5] for name, values in recording().columns.items() if name != "t"
    }
    assert (~recording(t=ticks, **same).mask).sum() == pytest.approx(0.8 * N, rel=0.01)


def test_a_clock_in_milliseconds_is_told_by_a_velocity_of_a_motion_that_mostly_rests() -> None:
    """Of a pendulum, its `t` in ms taken for s, `saturation` was missing "and the rest is chance"."""
    rng = np.random.default_rng(3)
    t = np.arange(3000) / 100.0
    omega = 4.0 * np.exp(-10.0 * (t % 5.0 - 2.5) ** 2) * np.where(t // 5.0 % 2.0 == 0.0, 1.0, -1.0)
    theta = np.cumsum(omega) / 100.0 + 2e-3 * rng.standard_normal(len(t))
    read = omega + 0.05 * rng.standard_normal(len(t))
    tau = 0.02 * np.gradient(omega, t) + 0.1 * omega + 0.01 * rng.standard_normal(len(t))
    found = kc.Capture.from_arrays(t=1e3 * t, theta=theta, omega=read, tau=tau).findings
    (unit,) = [one for one in found if one.kind == "unit"]
    assert unit.column == "omega" and "(or t is not in s)" in unit.message
    right = kc.Capture.from_arrays(t=t, theta=theta, omega=read, tau=tau).findings
    assert not [one for one in right if one.kind == "unit"]


@pytest.mark.parametrize(("unit", "word", "seconds"), [("min", "minutes", 60.0), ("h", "hours", 3600.0)])
def test_a_clock_in_minutes_is_told_by_the_motion(unit: str, word: str, seconds: float) -> None:
    """A sixtieth is near the radians of a degree, and was taken for them; of hours nothing was said."""
    plain = {name: values for name, values in recording().columns.items() if name not in ("t", "alpha")}
    found = kc.Capture.from_arrays(t=times() / seconds, **plain).findings
    (told,) = [one for one in found if one.kind == "unit"]
    assert told.column == "omega" and f"t may be in {word}" in told.message
    found = kc.Capture.from_arrays(t=times() / seconds, **plain, alpha=recording().columns["alpha"]).findings
    (clock,) = [one for one in found if one.kind == "unit"]
    assert clock.column == "t" and f"it is in {unit}" in clock.message
