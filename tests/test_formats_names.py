"""Columns that are taken without a map: by plain and unique names, and of loggers that are known."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from numpy.typing import NDArray

import knobcam as kc
from knobcam.capture.formats.header import Label, read_label
from knobcam.errors import InputError

N = 400
T = np.arange(N) / 500.0
THETA = np.sin(7.0 * T)
OMEGA = 7.0 * np.cos(7.0 * T)
TAU = 0.01 * OMEGA + 0.002 * np.sign(OMEGA) + 1e-5 * np.random.default_rng(3).standard_normal(N)
TURN = 2.0 * np.pi
ZERO = np.zeros(N)


def log(folder: Path, header: str, *columns: NDArray[np.float64], sep: str = ",") -> Path:
    path = folder / "run.csv"
    rows = [sep.join(f"{cell:.12g}" for cell in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([*([header] if header else []), *rows]) + "\n")
    return path


def assert_taken(path: Path, coordinate: str = "rotary") -> str:
    """Assert that a log is taken as the motion above, and return what is said of it."""
    capture = kc.load(path)
    assert capture.coordinate == coordinate
    assert capture.rate_hz == pytest.approx(500.0)
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-9)
    np.testing.assert_allclose(capture.tau, TAU, atol=1e-9)
    if capture.omega is not None:
        np.testing.assert_allclose(capture.omega, OMEGA, atol=1e-7)
    (said,) = [one for one in capture.findings if one.kind == "columns"]
    assert said.severity == "note"
    return said.message


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("Iq [A]", Label("current", "A", True)),
        ("pos_deg", Label("theta", "deg", True)),
        ("Velocity (rpm)", Label("omega", "rpm", True)),
        ("torque_mNm", Label("tau", "mN m", True)),
        ("time_ms", Label("t", "ms", True)),
        ("Time / s", Label("t", "s", True)),
        ("motorPosition", Label("theta", None, True)),
        ("theta_dot [rad/s]", Label("omega", "rad/s", True)),
        ("measured_velocity_deg_s", Label("omega", "deg/s", True)),
        ("current_position", Label("theta", None, True)),
        ("torque_cmd", Label("tau", None, True, measured=False)),
        ("q3", Label("theta", None, True, joint="3")),
        ("actual_current_0", Label("current", None, True, joint="0")),
        ("t1", Label(None)),
        ("reference.position", Label("theta", None, True, measured=False)),
        ("left_torque", Label("tau", None, False)),
        ("torque_a", Label("tau", None, False)),
        ("M [Nm]", Label("tau", "N m", False)),
        ("current_q", Label("current", None, True)),
        ("u_q", Label("voltage", None, True)),
        ("d_current", Label(None)),
        ("T_motor", Label(None)),
        ("pwm", Label("duty", None, True)),
        ("enc", Label(None)),
        ("M", Label(None)),
    ],
)
def test_a_name_says_what_its_words_and_its_unit_say(name: str, label: Label) -> None:
    assert read_label(name) == label


def test_units_in_a_header_are_taken_and_said(tmp_path: Path) -> None:
    path = log(
        tmp_path,
        "time_ms,pos_deg,Velocity (rpm),torque_mNm",
        *(1e3 * T, np.rad2deg(THETA), 60.0 * OMEGA / TURN, 1e3 * TAU),
    )
    said = assert_taken(path)
    assert "t = time_ms [ms], theta = pos_deg [deg], omega = Velocity (rpm) [rpm], tau = torque_mNm" in said


def test_plain_words_without_units_are_taken_as_si_and_that_is_said(tmp_path: Path) -> None:
    said = assert_taken(log(tmp_path, "Time, Position, Velocity, Torque", T, THETA, OMEGA, TAU))
    assert "theta = Position (no unit said: rad)" in said


def test_what_was_asked_of_a_machine_is_not_what_it_did(tmp_path: Path) -> None:
    header = "timestamp,target_position,position,torque,torque_cmd"
    assert_taken(log(tmp_path, header, T, ZERO, THETA, TAU, ZERO))


def test_the_time_of_a_loop_beside_the_time_is_no_second_clock(tmp_path: Path) -> None:
    assert_taken(log(tmp_path, "time,loop_time_us,position,torque", T, 200.0 + ZERO, THETA, TAU))


def test_lengths_and_forces_make_a_linear_axis(tmp_path: Path) -> None:
    assert_taken(log(tmp_path, "t;Position [mm];Force (N)", T, 1e3 * THETA, TAU, sep=";"), "linear")
    with pytest.raises(InputError, match=r"tau in \[N m\] is for a rotary axis, but it is linear"):
        kc.load(log(tmp_path, "t,position_mm,torque_Nm", T, THETA, TAU))


@pytest.mark.parametrize(
    ("header", "why", "right"),
    [
        ("time,motor_pos,joint_pos,torque", "motor_pos and joint_pos could each be theta", "theta=motor_pos"),
        ("time,position,vel,speed", "no column is a torque", "tau=COLUMN"),
        ("time,velocity,x,torque", "no column is an angle", "theta=x, omega=velocity, tau=torque"),
        ("time,position,left_torque,x", "'left_torque' is not plain", "tau=left_torque"),
        ("time,position,vel,Iq", "no torque; Iq is a current that says no unit", "tau=Iq [A]"),
        ("time,position,vel,Uq", "no torque; Uq is a voltage in V", "tau=Uq [V]"),
        ("time,position,vel,Uq_mV", "no torque; Uq_mV is a voltage in mV", "tau=Uq_mV [mV]"),
        ("time,position,vel,duty", "no torque; duty is a duty cycle", "tau=duty [duty]"),
        ("time,pos [counts],vel,torque", "'pos [counts]' holds counts", "theta=`pos [counts]`/COUNTS [turn]"),
    ],
)
def test_what_is_not_plain_or_not_unique_is_refused_with_the_columns_and_a_map(
    header: str, why: str, right: str, tmp_path: Path
) -> None:
    path = log(tmp_path, header, T, THETA, OMEGA, TAU)
    names = header.replace(",", ", ")
    refused(knobcam("import", path, "-o", tmp_path / "run.npz"), why, f"the file has {names}", right)
    assert not (tmp_path / "run.npz").exists()


def test_the_map_that_a_refusal_shows_is_one_that_works(tmp_path: Path) -> None:
    path = log(tmp_path, "time,motor pos,joint_pos,Iq [mA]", T, THETA, ZERO, 1e3 * TAU)
    said = knobcam("import", path, "-o", tmp_path / "run.npz").err
    shown = re.search("--map '(.*)'", said)
    assert shown is not None
    capture = kc.load(path, map=shown[1])
    np.testing.assert_allclose(capture.tau, TAU, atol=1e-9)
    assert capture.torque_unit == "A"


@pytest.mark.parametrize(("step", "unit"), [(1.0, "ms"), (2000.0, "us"), (2e6, "ns")])
def test_a_clock_without_a_unit_that_cannot_be_seconds_is_refused(
    step: float, unit: str, tmp_path: Path
) -> None:
    path = log(tmp_path, "time,position,torque", step * np.arange(N), THETA, TAU)
    with pytest.raises(InputError, match=rf"'time' has no unit and advances by .*t=time \[{unit}\]"):
        kc.load(path)


def test_an_angle_of_whole_numbers_is_not_taken_for_radians(tmp_path: Path) -> None:
    path = log(tmp_path, "time,position,torque", T, np.round(8192 * THETA), TAU)
    with pytest.raises(InputError, match=r"holds counts of an encoder.*theta=position/COUNTS \[turn\]"):
        kc.load(path)


def test_an_angle_that_leaps_by_360_is_not_taken_for_radians(tmp_path: Path) -> None:
    path = log(tmp_path, "time,angle,torque", T, np.rad2deg(9.0 * THETA) % 360.0, TAU)
    with pytest.raises(InputError, match=r"'angle' has no unit and leaps by 360.*theta=angle \[deg\]"):
        kc.load(path)


def test_a_cell_that_is_no_number_is_named_where_its_column_is_taken(tmp_path: Path) -> None:
    path = log(tmp_path, "time,position,torque", T, THETA, TAU)
    path.write_text(path.read_text() + "0.8,0,saturated\n")
    with pytest.raises(InputError, match="row 401, column torque: 'saturated' is not a number"):
        kc.load(path)


def test_columns_without_names_are_shown_with_the_clock_that_is_among_them(tmp_path: Path) -> None:
    np.save(tmp_path / "run.npy", np.stack([T, 8192.3 * THETA, TAU]))
    with pytest.raises(
        InputError, match=r'theta=c1/COUNTS \[turn\], tau=c2" \(COUNTS: .*c2 \[A\] of a current'
    ):
        kc.load(tmp_path / "run.npy")


@pytest.mark.parametrize("columns", [("qg", "qm", "vir"), ("qm", "qg", "vir"), ("vir", "qg", "qm")])
def test_of_a_position_that_was_asked_and_one_that_was_measured_the_measured_one_is_shown(
    tmp_path: Path, columns: tuple[str, ...]
) -> None:
    asked = 0.1 * np.sin(3.0 * T)
    encoder = 1e-5 * np.round(1e5 * 0.1 * np.sin(3.0 * (T - 2e-3)))
    held = {"qg": asked, "qm": encoder, "vir": np.sin(3.0 * T) + 0.1 * np.sin(70.0 * T)}
    path = log(tmp_path, ",".join(("t", *columns)), T, *(held[name] for name in columns))
    refused(knobcam("learn", path), "theta=qm, tau=vir")


def test_the_word_that_stands_for_the_counts_of_a_turn_is_told_from_a_column(tmp_path: Path) -> None:
    np.save(tmp_path / "run.npy", np.stack([T, 8192.3 * THETA, TAU]))
    with pytest.raises(InputError, match=r"stands for the counts of a turn.*theta=c1/8192 \[turn\]"):
        kc.load(tmp_path / "run.npy", map="t=c0, theta=c1/COUNTS [turn], tau=c2")


def test_registers_of_moteus_are_in_turns(tmp_path: Path) -> None:
    header = "time,MODE,POSITION,VELOCITY,TORQUE,VOLTAGE,TEMPERATURE,FAULT"
    turns = (THETA / TURN, OMEGA / TURN, TAU)
    said = assert_taken(log(tmp_path, header, T, ZERO + 10, *turns, ZERO + 24, ZERO + 30, ZERO))
    assert "moteus" in said and "theta = POSITION [turn], omega = VELOCITY [turn/s]" in said


def test_servo_stats_of_moteus_are_in_turns(tmp_path: Path) -> None:
    header = "timestamp,control_position,control_velocity,d_A,pid_position.p,position,q_A,torque_Nm,velocity"
    columns = (ZERO, ZERO, ZERO, ZERO, THETA / TURN, ZERO, TAU, OMEGA / TURN)
    assert "moteus" in assert_taken(log(tmp_path, header, T, *columns))


def test_estimates_of_an_odrive_are_in_turns(tmp_path: Path) -> None:
    header = "time,axis0.pos_estimate,axis0.vel_estimate,axis0.motor.torque_estimate,axis0.pos_setpoint"
    assert "ODrive" in assert_taken(log(tmp_path, header, T, THETA / TURN, OMEGA / TURN, TAU, ZERO))


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("time,odrv0.axis0.encoder.pos_estimate,odrv0.axis0.motor.current_control.Iq_measured", 1.0),
        ("time,position [turn],Iq [A]", 1.0),
        ("time,position [turn],Iq_mA", 1e-3),
    ],
)
def test_a_current_that_says_its_unit_stands_for_a_torque_in_a(
    header: str, factor: float, tmp_path: Path
) -> None:
    capture = kc.load(log(tmp_path, header, T, THETA / TURN, TAU))
    assert (capture.torque_unit, capture.units["tau"]) == ("A", "A")
    np.testing.assert_allclose(capture.tau, factor * TAU, atol=1e-12)
    assert "mA]" in capture.findings[0].message or "[A]" in capture.findings[0].message


def test_two_axes_of_an_odrive_are_not_chosen_between(tmp_path: Path) -> None:
    header = "time,axis0.pos_estimate,axis1.pos_estimate,axis0.torque_estimate"
    with pytest.raises(InputError, match=r"axis0\.pos_estimate and axis1\.pos_estimate could each be theta"):
        kc.load(log(tmp_path, header, T, THETA, THETA, TAU))


@pytest.mark.parametrize(
    ("before", "right"),
    [(2, "theta=c3 [rad], omega=c2 [rad/s], tau=c1 [V]"), (5, "omega=c5 [rad/s], tau=c3 [mA]")],
)
def test_a_simplefoc_monitor_asks_for_its_rate_and_its_torque(
    before: int, right: str, tmp_path: Path
) -> None:
    path = log(tmp_path, "", *[TAU] * before, OMEGA, THETA, sep="\t")
    said = knobcam("import", path, "-o", tmp_path / "run.npz")
    refused(said, "SimpleFOC", "500", "--rate HZ", right)
    asked = {"map": f"theta=c{before + 1}, omega=c{before}, tau=c1"}
    with pytest.raises(InputError, match=r"no column of times.*--rate"):
        kc.load(path, **asked)  # type: ignore[arg-type]
    np.testing.assert_allclose(kc.load(path, rate_hz=500.0, **asked).theta, THETA, atol=1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "place", ["/joint_states/joint1/{}", "/joint_states/shoulder_pan/{}", "/arm/joint_states/{}[0]"]
)
def test_joints_that_plotjuggler_writes_are_known_by_their_place_in_a_message(
    place: str, tmp_path: Path
) -> None:
    names = [place.format(part) for part in ("position", "velocity", "effort")]
    path = log(tmp_path, ",".join(["__time", *names]), T, THETA, OMEGA, TAU)
    assert f"columns of PlotJuggler: t = __time [s], theta = {names[0]}" in assert_taken(path)


def test_of_several_joints_that_plotjuggler_writes_one_is_chosen_or_mapped(tmp_path: Path) -> None:
    places = [
        f"/joint_states/{joint}/{part}" for joint in "ab" for part in ("position", "velocity", "effort")
    ]
    path = log(tmp_path, ",".join(["__time", *places]), T, ZERO, ZERO, ZERO, THETA, OMEGA, TAU)
    with pytest.raises(InputError, match="a/position and /joint_states/b/position could each be theta"):
        kc.load(path)
    with pytest.raises(InputError, match="no joint 'c'; there are a, b"):
        kc.load(path, joint="c")
    np.testing.assert_allclose(kc.load(path, joint="b").theta, THETA, atol=1e-9)
    own = ["t=__time", "theta=`/joint_states/b/position`", "tau=`/joint_states/b/effort`"]
    mapped = kc.load(path, map=own)
    np.testing.assert_allclose(mapped.tau, TAU, atol=1e-9)


def test_the_numbers_of_joints_part_the_columns_of_a_robot(tmp_path: Path) -> None:
    one = log(tmp_path, "time,q3,dq3,tau3", T, THETA, OMEGA, TAU)
    assert "theta = q3" in assert_taken(one)
    several = log(tmp_path, "time,pos1,pos2,vel1,vel2,tau1,tau2", T, THETA, ZERO, OMEGA, ZERO, TAU, ZERO)
    asked = r"pos1 and pos2 could each be theta.*theta=pos1, omega=vel1, tau=tau1"
    with pytest.raises(InputError, match=asked):
        kc.load(several)


def test_a_map_that_is_shown_survives_a_shell(tmp_path: Path) -> None:
    """Between double quotes a shell would run what stands in backquotes."""
    path = log(tmp_path, "time [s],a1 position [rad],a2 position [rad],torque [Nm]", T, THETA, ZERO, TAU)
    said = knobcam("import", path, "-o", tmp_path / "run.npz").err
    shown = shlex.split(said[said.index("--map") :])[1]
    np.testing.assert_allclose(kc.load(path, map=shown).tau, TAU, atol=1e-9)


def test_a_column_of_a_map_keeps_the_unit_that_its_name_says(tmp_path: Path) -> None:
    path = log(tmp_path, "t,pos_deg,Torque [mNm],Iq [A]", T, np.rad2deg(THETA), 1e3 * TAU, TAU)
    capture = kc.load(path, map="t=t, theta=pos_deg, tau=Torque [mNm]")
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-9)
    np.testing.assert_allclose(capture.tau, TAU, atol=1e-9)
    (said,) = [one.message for one in capture.findings if one.kind == "columns"]
    assert said.startswith("columns: theta = pos_deg [deg], as their names say")
    stated = kc.load(path, map="t=t, theta=pos_deg [rad], tau=Iq [A]")
    np.testing.assert_allclose(stated.theta, np.rad2deg(THETA), atol=1e-9)
    assert stated.torque_unit == "A"
    computed = kc.load(path, map="t=t, theta=pos_deg*pi/180, tau=`Torque [mNm]`/1000")
    np.testing.assert_allclose(computed.theta, THETA, atol=1e-9)
    np.testing.assert_allclose(computed.tau, TAU, atol=1e-9)


def test_what_was_taken_is_printed_and_kept(tmp_path: Path) -> None:
    path = log(tmp_path, "time,pos_deg,torque_mNm", T, np.rad2deg(THETA), 1e3 * TAU)
    ended = knobcam("import", path, "-o", tmp_path / "run.npz", "--json")
    assert "note: columns: t = time (no unit said: s), theta = pos_deg [deg]" in ended.err
    assert ended.document["findings"][0]["kind"] == "columns"
    again = kc.load(tmp_path / "run.npz")
    assert [one.kind for one in again.findings] == ["columns"]
    assert again.meta["calibration"]["theta"] == "`pos_deg` [deg]"


@pytest.mark.parametrize(
    "name", [" " * 50_000, "tau" + " " * 50_000 + "[", "a_" * 50_000, "/ " * 50_000, "A" * 50_000]
)
def test_a_name_of_a_damaged_file_is_not_read_for_minutes(name: str) -> None:
    assert read_label(name).quantity is None


def test_the_letters_of_a_slide_are_asked_for_as_such(tmp_path: Path) -> None:
    path = log(tmp_path, "t,x,v,a,F,F_fric", T, THETA, OMEGA, -49.0 * THETA, TAU, TAU)
    with pytest.raises(InputError) as asked:
        kc.load(path)
    assert "t=t, theta=x [m], omega=v [m/s], alpha=a [m/s^2], tau=F [N]" in str(asked.value)
    # Those of a control loop: what was asked for is no angle, and what was put in no velocity.
    with pytest.raises(InputError, match=r"t=t, theta=y, tau=u. .tau: in N m, or u .A."):
        kc.load(log(tmp_path, "t,r,y,u", T, np.round(THETA), THETA, TAU))
    assert not read_label("commanded_deg_s").measured and read_label("feedback_deg_s").measured


def test_a_clock_that_no_name_tells_is_in_the_map_that_is_shown(tmp_path: Path) -> None:
    path = log(tmp_path, "Zeit,position,Drehmoment", 1e3 * T, THETA, TAU)
    with pytest.raises(InputError) as asked:
        kc.load(path)
    assert '--map "t=Zeit [ms], theta=position, tau=Drehmoment"' in str(asked.value)


def test_a_log_without_an_angle_is_told_how_to_make_one_of_its_speed(tmp_path: Path) -> None:
    path = log(tmp_path, "t,motor_speed,tau", T, OMEGA, TAU)
    with pytest.raises(InputError, match=re.escape("cumsum(motor_speed)/RATE, RATE in Hz")):
        kc.load(path)
    made = kc.load(path, map="t=t, theta=cumsum(motor_speed)/500, omega=motor_speed, tau=tau")
    assert np.ptp(made.theta) == pytest.approx(np.ptp(THETA), rel=0.01)


@pytest.mark.parametrize(
    ("unit", "times"),
    [("rpm", 30.0 / np.pi), ("deg/s", 180.0 / np.pi), ("rad/s", 1.0), ("rev/s", 0.5 / np.pi)],
)
def test_the_angle_that_it_is_told_to_make_is_one(tmp_path: Path, unit: str, times: float) -> None:
    """A map with a unit within the sum was proposed, and refused."""
    path = log(tmp_path, f"t,motor speed ({unit}),tau", T, times * OMEGA, TAU)
    with pytest.raises(InputError) as asked:
        kc.load(path)
    told = re.search(r"without an angle (.*), RATE in Hz", str(asked.value))
    assert told is not None
    made = kc.load(path, map=f"t=t, theta={told[1].replace('RATE', '500')}, tau=tau")
    assert np.ptp(made.theta) == pytest.approx(np.ptp(THETA), rel=0.01)


def test_a_column_may_be_named_without_the_unit_in_its_name(tmp_path: Path) -> None:
    path = log(tmp_path, "time [s],a1 position [deg],a1 torque (mNm),b torque (Nm)", T, THETA, TAU, TAU)
    whole = kc.load(path, map="t=`time [s]`, theta=`a1 position [deg]`, tau=`a1 torque (mNm)`")
    short = kc.load(path, map=["t=time", "theta=a1 position", "tau=a1 torque"])
    assert np.array_equal(short.theta, whole.theta) and np.array_equal(short.tau, whole.tau)
    own = kc.load(path, map=["t=time", "theta=a1 position [rad]", "tau=a1 torque [N m]"])
    assert np.allclose(own.theta, np.rad2deg(whole.theta)) and np.allclose(own.tau, 1e3 * whole.tau)


def test_words_that_are_no_column_are_answered_with_those_there_are(tmp_path: Path) -> None:
    path = log(tmp_path, "time [s],a1 position [deg],a1 torque (mNm)", T, THETA, TAU)
    with pytest.raises(InputError, match=re.escape("no column 'trd605 torque'; the file has time [s],")):
        kc.load(path, map=["t=time", "theta=a1 position", "tau=trd605 torque"])


@pytest.mark.parametrize(
    ("name", "quantity"),
    [("torques.c1", "tau"), ("torAct", "tau"), ("positions.c0", "theta"), ("velocities.c0", "omega")],
)
def test_many_of_a_quantity_and_short_words_for_it_are_understood(name: str, quantity: str) -> None:
    assert read_label(name).quantity == quantity
