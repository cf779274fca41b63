"""Texts as loggers write them: units below the header, names at each number, dates, several motors a file."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

import knobcam as kc
from knobcam.errors import InputError

T = np.arange(400) / 200.0
THETA = 0.9 * np.sin(2.5 * T) + 0.3 * np.sin(7.0 * T)
TAU = 0.2 * np.sign(np.gradient(THETA, T)) + 0.01 * np.cos(40.0 * T)


def written(path: Path, head: list[str], row: Callable[[float, float, float], str]) -> Path:
    lines = [row(t, theta, tau) for t, theta, tau in zip(T, THETA, TAU, strict=True)]
    path.write_text("\n".join([*head, *lines]) + "\n", encoding="utf-8")
    return path


def close(capture: kc.Capture) -> bool:
    assert capture.t is not None and capture.theta is not None and capture.tau is not None
    off = [np.ptp(capture.t - T), np.ptp(capture.theta - THETA), np.ptp(capture.tau - TAU)]
    return max(float(one) for one in off) < 1e-4


@pytest.mark.parametrize("units", ["(ms),(deg),(mN m)", "[ms],[deg],[mNm]", "ms,deg,mNm"])
def test_units_in_a_line_below_the_header_are_taken(tmp_path: Path, units: str) -> None:
    file = written(
        tmp_path / "log.csv",
        ["Time,Position,Torque", units],
        lambda t, theta, tau: f"{1e3 * t:.3f},{np.degrees(theta):.6f},{1e3 * tau:.6f}",
    )
    assert close(kc.load(file))


def test_units_of_which_some_are_strange_are_units_all_the_same(tmp_path: Path) -> None:
    """A dynamometer logs `Deg C`, `W` and `N.mm`: its units were the header, and their names lost."""
    path = tmp_path / "run.csv"
    lines = ["Time, Angle, Torque, Drive temperature, Brake temperature, Drive current, Brake current"]
    lines += ["s, deg, N.mm, Deg C, Deg C, A, A"]
    lines += [f"{at / 100}, {at % 7}, {at % 3}, 25, 26, 1, 2" for at in range(40)]
    path.write_text("\n".join(["2019-05-11 15:22:21.215576", *lines]))
    capture = kc.load(path)
    assert capture.tau[2] == pytest.approx(2e-3) and capture.theta[1] == pytest.approx(np.radians(1.0))
    with pytest.raises(InputError, match=r"Deg C.*unknown unit"):
        kc.load(path, map="tau=`Drive temperature [Deg C]` [Deg C]")


def test_a_line_below_the_header_that_holds_no_units_is_refused_by_its_cell(tmp_path: Path) -> None:
    file = written(
        tmp_path / "log.csv", ["t,theta,tau", "start,of,test"], lambda t, theta, tau: f"{t},{theta},{tau}"
    )
    with pytest.raises(InputError, match="'start' is not a number"):
        kc.load(file)


def test_a_header_behind_a_percent_sign_names_the_columns(tmp_path: Path) -> None:
    file = written(
        tmp_path / "log.dat",
        ["% recorded on the second day", "%", "% time angle torque"],
        lambda t, theta, tau: f"{t:.6f} {theta:.6f} {tau:.6f}",
    )
    assert close(kc.load(file))


@pytest.mark.parametrize("between", [" ", ",", "\t"])
def test_names_at_each_number_name_the_columns(tmp_path: Path, between: str) -> None:
    file = written(
        tmp_path / "serial.txt",
        [],
        lambda t, theta, tau: between.join([f"t:{t:.6f}", f"pos:{theta:.6f}", f"torque:{tau:.6f}"]),
    )
    assert close(kc.load(file))


@pytest.mark.parametrize("zone", ["", "Z", "+02:00"])
def test_dates_and_times_of_the_day_are_seconds(tmp_path: Path, zone: str) -> None:
    dates = np.datetime64("2026-03-29T00:59:59") + (1e6 * T).round().astype("timedelta64[us]")
    stamps = dict(
        zip(T, (str(date) for date in dates), strict=True)
    )  # across the hour that summer takes away
    dated = written(
        tmp_path / "dated.csv",
        ["timestamp,position,torque,status"],
        lambda t, theta, tau: f"{stamps[t]}{zone},{theta:.6f},{tau:.6f},OK",
    )
    assert close(kc.load(dated))
    daily = written(
        tmp_path / "daily.csv",
        ["time,position,torque"],
        lambda t, theta, tau: f"{stamps[t][11:]},{theta:.6f},{tau:.6f}",
    )
    assert close(kc.load(daily))


def test_a_measurement_file_of_labview_has_its_clock_under_another_name(tmp_path: Path) -> None:
    """NI, "Specification for the LabVIEW Measurement File": two headers, then X_Value and a comment."""
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t."]
    head += ["***End_of_Header***\t", "\t", "Channels\t2\t", "Samples\t400\t400", "Y_Unit_Label\trad\tN m"]
    head += ["Delta_X\t0.005\t0.005", "***End_of_Header***\t\t", "X_Value\tAngle\tTorque\tComment"]
    file = written(tmp_path / "run.lvm", head, lambda t, theta, tau: f"{t:.6f}\t{theta:.6f}\t{tau:.6f}\t")
    assert close(kc.load(file))


@pytest.mark.parametrize(
    ("form", "decimal"),
    [("%d.%m.%Y %H:%M:%S.%f", ","), ("%m/%d/%Y %I:%M:%S.%f %p", "."), ("%d/%m/%Y %H:%M:%S.%f", ".")],
)
def test_dates_as_spreadsheets_write_them_are_seconds(tmp_path: Path, form: str, decimal: str) -> None:
    """Through midnight, and the noon of a clock of twelve hours."""
    for hour in (23, 11):
        start = datetime(2025, 3, 30, hour, 59, 59)

        def row(t: float, theta: float, tau: float, start: datetime = start) -> str:
            stamp = (start + timedelta(seconds=t)).strftime(form)
            day, _, clock = stamp.partition(" ")
            return f"{day} " + f"{clock};{theta:.6f};{tau:.6f}".replace(".", decimal)

        assert close(kc.load(written(tmp_path / "dated.csv", ["time;position;torque"], row)))
    no_day = written(
        tmp_path / "no.csv", ["time,position,torque"], lambda t, q, u: f"31.02.2025 1:02:03,{q},{u}"
    )
    with pytest.raises(InputError, match="is not a number"):
        kc.load(no_day)


@pytest.mark.parametrize("name", ["id", "motor_id", "Joint ID", "canId", "servo_no"])
def test_of_several_motors_one_below_the_other_one_has_to_be_chosen(tmp_path: Path, name: str) -> None:
    """Taken as one they were a capture whose motion leaps at every row, and nothing was said."""
    file = written(
        tmp_path / "bus.csv",
        [f"time,{name},position,torque"],
        lambda t, theta, tau: f"{t},1,{theta:.6f},{tau:.6f}\n{t + 1e-3},7,{0.5 - theta:.6f},{-tau:.6f}",
    )
    with pytest.raises(InputError, match=r"2 motors, 1, 7; choose one, for example --joint 1"):
        kc.load(file)
    assert close(kc.load(file, joint="1"))
    assert not close(kc.load(file, joint="7"))
    with pytest.raises(InputError, match="no motor '2'; there are 1, 7"):
        kc.load(file, joint="2")


def test_a_number_that_stays_or_counts_rows_is_that_of_no_motor(tmp_path: Path) -> None:
    for number in ("7", "{row}"):
        rows = iter(range(len(T)))
        file = written(
            tmp_path / "one.csv",
            ["id,time,position,torque"],
            lambda t, theta, tau, number=number, rows=rows: (  # type: ignore[misc]
                f"{number.format(row=next(rows))},{t},{theta:.6f},{tau:.6f}"
            ),
        )
        assert close(kc.load(file))


def test_a_map_that_is_shown_for_matrices_is_of_one_joint(tmp_path: Path) -> None:
    """It took the position of one and the velocity of another for a torque."""
    other = np.cos(3.0 * T)
    both = {"q": np.c_[THETA, other], "qd": np.c_[other, THETA], "tau_measured": np.c_[other, TAU]}
    np.savez(tmp_path / "arm.npz", time=T, q_cmd=both["q"], **both)
    with pytest.raises(InputError, match=r"t=time, theta=q.c0, omega=qd.c0, tau=tau_measured.c0") as refused:
        kc.load(tmp_path / "arm.npz")
    assert "q.c0 and q.c1 could each be theta" in str(refused.value)
