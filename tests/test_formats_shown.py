"""The map that a refusal shows is copied as it stands: what it may not say, seen in logs of strangers."""

from __future__ import annotations

import struct
from pathlib import Path

import h5py  # type: ignore[import-untyped]
import numpy as np
import pytest
import scipy.io  # type: ignore[import-untyped]
from numpy.typing import NDArray

from knobcam.capture import load
from knobcam.errors import InputError

T = np.arange(400) / 100.0
THETA = np.sin(2.0 * T) + 0.3 * np.sin(5.1 * T)
OMEGA = 2.0 * np.cos(2.0 * T) + 1.53 * np.cos(5.1 * T)
TAU = -THETA + 0.2 * np.sign(OMEGA)
ROWS = np.arange(400.0)


def csv(path: Path, header: str, *columns: NDArray[np.float64]) -> Path:
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    return path


def shown(path: Path) -> str:
    with pytest.raises(InputError) as refusal:
        load(path)
    return str(refusal.value).partition("--map ")[2]


def test_the_number_of_a_row_is_no_clock_and_no_angle(tmp_path: Path) -> None:
    """Which pandas writes without a name: it was shown as a time in ms."""
    path = tmp_path / "run.csv"
    known = shown(csv(path, ",my angle (deg),M (Nm)", ROWS, THETA, TAU))
    assert "t=" not in known and "--rate HZ" in known
    twice = np.concatenate([ROWS[:300], ROWS[:100]])  # two runs, one behind the other
    known = shown(csv(path, "Sample,PWM,Motor Speed (RPM)", twice, TAU, OMEGA))
    assert "theta=COLUMN" in known and "theta: of a log without an angle cumsum(" in known


def test_a_clock_that_cannot_be_in_seconds_is_not_shown_as_one(tmp_path: Path) -> None:
    assert "t=c0 [ms]" in shown(csv(tmp_path / "run.csv", "", 10.0 * ROWS + 82e3, THETA, TAU))


def test_a_clock_that_cannot_be_in_seconds_is_not_taken_for_one_by_a_map_that_says_no_unit(
    tmp_path: Path,
) -> None:
    """Of a log in ms that was mapped as it stood all that came was a verdict."""
    path = csv(tmp_path / "run.csv", "", 10.0 * ROWS, THETA, TAU)
    with pytest.raises(
        InputError, match=r"map: 'c0' has no unit and advances by 10 a row.*t=c0 \[ms\], theta=c1"
    ):
        load(path, map="t=c0, theta=c1, tau=c2")
    assert load(path, map="t=c0 [s], theta=c1, tau=c2").t[-1] == pytest.approx(3990.0)
    assert load(path, map="t=c0/1000, theta=c1, tau=c2").t[-1] == pytest.approx(3.99)


@pytest.mark.parametrize(("unit", "per_s"), [("min", 1 / 60), ("minutes", 1 / 60), ("h", 1 / 3600)])
def test_minutes_and_hours_are_times(tmp_path: Path, unit: str, per_s: float) -> None:
    """They were refused, with a map without a unit, which takes them for seconds."""
    path = csv(tmp_path / "run.csv", f"Time ({unit}),angle (rad),torque (Nm)", T * per_s, THETA, TAU)
    assert load(path).t[-1] == pytest.approx(T[-1])
    least = csv(
        tmp_path / "least.csv", "time (s),angle (rad),torque (Nm),torque (min)", T, THETA, TAU, TAU - 1
    )
    np.testing.assert_allclose(load(least).tau, TAU)


def test_a_unit_of_time_that_nobody_knows_is_asked_for(tmp_path: Path) -> None:
    """Hundredths and samples were shown as ms, ten times too slow."""
    known = shown(csv(tmp_path / "run.csv", "time [samples],angle [rad],torque [Nm]", ROWS, THETA, TAU))
    assert "[UNIT]" in known and "UNIT: what it counts in" in known
    with pytest.raises(InputError, match=r"UNIT.*unknown unit"):
        load(tmp_path / "run.csv", map="t=`time [samples]` [UNIT], theta=`angle [rad]`, tau=`torque [Nm]`")
    known = shown(csv(tmp_path / "run.csv", "time [centiseconds],angle [rad],torque [Nm]", ROWS, THETA, TAU))
    assert "t=`time [centiseconds]` [centiseconds]" in known


def test_a_torque_that_fits_the_angle_is_shown_before_a_force(tmp_path: Path) -> None:
    path = csv(tmp_path / "run.csv", "Force (N),my angle (deg),Moment (Nm)", TAU, THETA, TAU)
    assert "tau=`Moment (Nm)` [N m]" in shown(path)


def test_of_columns_without_names_a_velocity_is_not_shown_as_the_torque(tmp_path: Path) -> None:
    """A surgeon's robot logged angle, velocity and torque at 200 Hz without a header."""
    assert "theta=c0, omega=c1, tau=c2" in shown(csv(tmp_path / "run.csv", "", THETA, OMEGA, TAU))


def test_parameters_beside_a_log_are_none_of_its_columns(tmp_path: Path) -> None:
    """A .mat of a robot has the gains of its six loops, `K_pos`, beside 2501 rows of every joint."""
    path = tmp_path / "run.mat"
    scipy.io.savemat(
        path, {"time": T, "pos": THETA, "torque": TAU, "k": {"pos": np.ones(3), "vel": np.ones(3)}}
    )
    capture = load(path)
    np.testing.assert_allclose(capture.theta, THETA)
    assert capture.samples == len(T)


def element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def test_an_object_of_matlab_says_what_it_is_and_how_its_numbers_are_saved(tmp_path: Path) -> None:
    """Of what `sim` returns it was said that the file has c0 and (unnamed), and theta=c0/COUNTS was shown."""
    flags, size = element(6, struct.pack("<II", 17, 0)), element(5, struct.pack("<ii", 6, 1))
    words = b"".join(element(1, word) for word in (b"out", b"MCOS", b"Simulink.SimulationOutput"))
    inside = element(
        14, element(6, struct.pack("<II", 13, 0)) + size + element(1, b"") + element(6, bytes(24))
    )
    plain = element(6, struct.pack("<II", 9, 0)) + element(5, struct.pack("<ii", 1, 64)) + element(1, b"")
    own = plain + element(2, bytes(64))
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    path = tmp_path / "run.mat"
    path.write_bytes(head + element(14, flags + words + inside) + element(14, own))
    with pytest.raises(InputError, match=r"out holds an object of Simulink.SimulationOutput.*t = out.tout"):
        load(path)


def test_an_object_in_a_file_of_version_7_3_says_so_too(tmp_path: Path) -> None:
    """Of a `timeseries` six numbers are in the file, and theta=data/COUNTS was shown for them."""
    path = tmp_path / "run.mat"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("data", data=np.zeros((1, 6), dtype=np.uint32))
        data.attrs["MATLAB_class"] = np.bytes_(b"timeseries")
        data.attrs["MATLAB_object_decode"] = np.int32(3)
    with pytest.raises(InputError, match=r"data holds an object of timeseries.*t = out.tout"):
        load(path)


def test_counts_of_one_of_several_motors_are_shown_as_counts(tmp_path: Path) -> None:
    """A bus of servos: `pos (1)` was shown as rad, and `speed (1)`, whose first bit is its sign, as rad/s."""
    counts = np.round(2000.0 + 300.0 * THETA)
    path = tmp_path / "run.csv"
    header = "timestamp,pos (1),speed (1),current (1),pos (2),speed (2),current (2)"
    known = shown(csv(path, header, T, counts, np.round(OMEGA), TAU, counts, np.round(OMEGA), TAU))
    assert "theta=`pos (1)`/COUNTS [turn]" in known and "omega" not in known


def test_a_map_of_one_column_leaves_the_others_to_their_names(tmp_path: Path) -> None:
    """Whoever knows that an effort is a current had to say what an angle is, of a log that was understood."""
    path = csv(tmp_path / "run.csv", "time,position,velocity,effort", T, THETA, OMEGA, TAU)
    capture = load(path, map="tau=effort [A]")
    assert capture.torque_unit == "A" and capture.omega is not None
    (note,) = [one for one in capture.findings if one.kind == "columns"]
    assert "t = time, theta = position, omega = velocity, by their names beside the map" in note.message
    own = csv(tmp_path / "own.csv", "t_s,theta_rad,tau_Nm", T, THETA, TAU)
    np.testing.assert_allclose(load(own, map="tau=-tau_Nm").tau, -TAU)
    unnamed = csv(tmp_path / "unnamed.csv", "zeit,qm,u", T, THETA, TAU)
    with pytest.raises(InputError, match=r"map: theta is missing; .*--map .t=zeit.*tau=u \[N m\]"):
        load(unnamed, map="tau=u [N m]")
    two = csv(tmp_path / "two.csv", "time,position,angle,effort", T, THETA, THETA, TAU)
    with pytest.raises(InputError, match=r"map: theta is missing; .*theta=position, tau=effort \[A\]"):
        load(two, map="tau=effort [A]")


def test_what_never_changes_is_not_shown_for_what_moves(tmp_path: Path) -> None:
    """A haptic paddle logs flags, gains and an encoder that is not connected beside the angle that moves."""
    head = "start_time,log:timestamp,enable angle,encoder_angle [deg],paddle_angle_filt [deg],torque [Nm]"
    still = np.zeros(400)
    known = shown(csv(tmp_path / "run.csv", head, still, 7.0 + T, still, still + 0.5, THETA, TAU))
    assert "theta=`paddle_angle_filt [deg]`" in known and "t=`log:timestamp`" in known


def test_a_separator_behind_the_last_column_makes_no_column(tmp_path: Path) -> None:
    """A drive's monitor writes a tab at the end of each line: a map with an empty torque was shown."""
    path = tmp_path / "run.txt"
    rows = [f"{t:.3f}\t{angle:.5f}\t" for t, angle in zip(T, THETA, strict=True)]
    path.write_text("\n".join(["Time [s]\tMon.angle (deg)\t", *rows, ""]))
    known = shown(path)
    assert "tau=COLUMN" in known and "c2" not in known
    path.write_text("\n".join(rows))
    assert "c2" not in shown(path)


def test_short_words_for_an_angle_and_its_velocity_are_understood(tmp_path: Path) -> None:
    """Of `baseAng` and `baseAngVel` the command was shown for the angle, a velocity for the torque."""
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"u": TAU, "baseAng": THETA, "baseAngVel": OMEGA, "other": -TAU, "t": T})
    assert "theta=baseAng, omega=baseAngVel, tau=COLUMN" in shown(path)


def test_arrays_of_another_length_are_no_clock(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"units": np.arange(1.0, 4.0), "force": TAU, "force_times": 1e9 + T})
    assert "t=force_times" in shown(path)
