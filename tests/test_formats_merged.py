"""Tables of signals that have each their own times: a row for each reading, and blanks for all others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import knobcam as kc

RATE_HZ = 500.0
N = 5000
RNG = np.random.default_rng(8)


def at(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle and velocity (rad, rad/s) of a motion, and the torque (N m) of a knob that makes it."""
    theta, omega, alpha = np.zeros((3, len(t)))
    for size, hz, phase in ((1.2, 0.37, 0.0), (0.5, 1.1, 0.8), (0.1, 3.3, 2.0)):
        rate = 2.0 * np.pi * hz
        theta += size * np.sin(rate * t + phase)
        omega += size * rate * np.cos(rate * t + phase)
        alpha -= size * rate**2 * np.sin(rate * t + phase)
    return theta, omega, 2e-4 * alpha + 0.02 * np.sign(omega) + 0.004 * omega


def table(path: Path, late_s: float, *, together: int = 0, velocity: bool = False) -> Path:
    """Write angle and torque in rows of their own, `together` of them in one."""
    t = np.arange(N) / RATE_HZ
    theta = at(t)[0] + 1e-5 * RNG.standard_normal(N)
    tau = at(t + late_s)[2] + 1e-3 * RNG.standard_normal(N)
    rows = [
        (one, f"{q:.9g}", f"{at(np.array([one]))[1][0]:.9g}" if velocity else "", "")
        for one, q in zip(t, theta, strict=True)
    ]
    rows += [(one + late_s, "", "", f"{u:.9g}") for one, u in zip(t, tau, strict=True)]
    for k in range(together):
        rows[k] = (*rows[k][:3], rows[N + k][3])
    rows.sort(key=lambda row: row[0])
    text = "\n".join(f"{one[0]:.9f},{','.join(one[1:])},7" for one in rows)
    path.write_text("time_s,position_rad,velocity_rad_s,torque_Nm,other\n" + text + "\n")
    return path


@pytest.mark.parametrize("late_s", [0.0003, 0.0011, 0.0017])
@pytest.mark.parametrize("velocity", [False, True])
def test_an_angle_is_taken_at_the_times_of_the_torque(tmp_path: Path, late_s: float, velocity: bool) -> None:
    """It was refused, as columns of different length: the last angle stands a row before the last torque."""
    capture = kc.load(table(tmp_path / "run.csv", late_s, velocity=velocity))
    (found,) = [one for one in capture.findings if one.kind == "merged"]
    assert found.severity == "mended" and "at the 5000 times of tau" in found.message
    assert capture.rate_hz == pytest.approx(RATE_HZ, rel=1e-3) and capture.mask.mean() > 0.99
    theta, omega, _ = at(capture.t)
    assert np.abs(capture.theta - theta)[capture.mask].max() < 1e-4
    assert (capture.omega is not None) is velocity
    if capture.omega is not None:
        assert np.abs(capture.omega - omega)[capture.mask].max() < 1e-3
    fit = kc.fit(capture)
    for name, true in (("inertia.M", 2e-4), ("coulomb.pos", 0.02), ("viscous.pos", 0.004)):
        assert fit.params[name].value == pytest.approx(true, rel=0.03)


def test_a_gap_of_the_angle_is_not_bridged(tmp_path: Path) -> None:
    path = table(tmp_path / "run.csv", 0.001)
    rows = path.read_text().splitlines(keepends=True)
    lost = [row for row in rows if not (row[0] == "3" and row.split(",")[1])]
    path.write_text("".join(lost))
    capture = kc.load(path)
    away = (capture.t > 3.01) & (capture.t < 3.99)
    assert not capture.mask[away].any() and capture.mask[~away].mean() > 0.98


def test_readings_that_lack_in_rows_that_have_others_are_left_out_and_not_made(tmp_path: Path) -> None:
    t = np.arange(N) / RATE_HZ
    theta, _, tau = at(t)
    cells = [[f"{q:.9g}", f"{u:.9g}"] for q, u in zip(theta, tau, strict=True)]
    for row in range(7, N, 50):
        cells[row][row // 50 % 2] = ""
    cells[-1][0] = ""
    text = "\n".join(f"{one:.9f},{','.join(row)}" for one, row in zip(t, cells, strict=True))
    (tmp_path / "run.csv").write_text("time,position,torque\n" + text + "\n")
    capture = kc.load(tmp_path / "run.csv")
    assert not [one for one in capture.findings if one.kind == "merged"]
    assert capture.samples == N and np.sum(~capture.mask) == len(range(7, N, 50)) + 1


def test_a_command_that_is_logged_where_it_changes_holds_until_then(tmp_path: Path) -> None:
    """Six commands in 36 430 rows of a pendulum: "fewer than 2 usable samples", and no way out."""
    t = np.arange(N) / RATE_HZ
    theta = at(t)[0]
    sent = np.arange(0.0, 10.0, 2.0) + 3e-4
    rows = [(one, f"{one:.9f},{q:.9g},") for one, q in zip(t, theta, strict=True)]
    rows += [(one, f"{one:.9f},,{k + 0.5}") for k, one in enumerate(sent)]
    text = "\n".join(row for _, row in sorted(rows))
    (tmp_path / "run.csv").write_text("time,position,command\n" + text + "\n")
    with pytest.raises(kc.InputError, match=r"a command that holds until the next one, map tau=hold\(COL"):
        kc.load(tmp_path / "run.csv", map="t=time, theta=position, tau=command [V]")
    capture = kc.load(tmp_path / "run.csv", map="t=time, theta=position, tau=hold(command) [V]")
    after = capture.t > 3e-4
    held = np.floor((capture.t[after] - 3e-4) / 2.0) + 0.5
    np.testing.assert_array_equal(capture.tau[after][capture.mask[after]], held[capture.mask[after]])
    assert capture.mask.mean() > 0.99


def test_of_a_torque_that_is_there_always_the_rows_with_an_angle_are_taken(tmp_path: Path) -> None:
    t = np.sort(np.concatenate([np.arange(N) / RATE_HZ, np.arange(N) / RATE_HZ + 7e-4]))
    theta, _, tau = at(t)
    cells = [
        f"{one:.9f},{q if k % 2 == 0 else ''},{u}"
        for k, (one, q, u) in enumerate(zip(t, theta, tau, strict=True))
    ]
    (tmp_path / "run.csv").write_text("time,position,torque\n" + "\n".join(cells) + "\n")
    capture = kc.load(tmp_path / "run.csv")
    (found,) = [one for one in capture.findings if one.kind == "merged"]
    assert "stands in 5000 of 10000 rows beside tau" in found.message
    assert capture.samples == N and capture.mask.all()
    np.testing.assert_allclose(capture.theta, theta[::2], atol=1e-9)
