"""What TwinCAT's scope exports as text: a block of keys, then channels beside times of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import knobcam as kc
from knobcam.errors import InputError

T = np.arange(600) / 500.0
THETA = 0.9 * np.sin(5.0 * T)
OMEGA = 4.5 * np.cos(5.0 * T)
TAU = 0.2 * np.sign(OMEGA) + 0.05 * np.sin(31.0 * T)
SLOW = T[::5]

Group = tuple[NDArray[np.float64], dict[str, tuple[str, NDArray[np.float64]]]]
KEYS = ("Name", "SymbolComment", "Data-Type", "SampleTime[ms]", "SymbolName", "ScaleFactor", "Unit")
AXIS: Group = (T, {"ActPos": ("deg (Angle)", np.degrees(THETA)), "ActVelo": ("(None)", OMEGA)})
DRIVE: Group = (T, {"ActTorque": ("Nm (Torque)", TAU)})


def exported(path: Path, *groups: Group, mark: str = "\t", decimal: str = ".", tail: str = "") -> Path:
    """A scope's export: groups of channels, each behind a column of times; what has ended is blank."""

    def line(key: str) -> str:
        cells: list[str] = []
        for _, channels in groups:
            axis = len(cells) + 1
            cells.append(key)
            for name, (unit, _) in channels.items():
                said = {"Name": name, "Unit": unit, "SymbolName": f"MAIN.Axis{axis}.{name}"}
                cells.append(said.get(key, "2"))
        return mark.join(cells) + tail

    lines = [
        f"Name{mark}scope",
        f"File{mark}scope.csv",
        f"Starttime of export{mark}132959733843760000",
        "",
        "",
    ]
    lines += [*map(line, KEYS), ""]
    for row in range(max(len(t) for t, _ in groups)):
        cells: list[str] = []
        for t, channels in groups:
            columns = [1e3 * t, *(values for _, values in channels.values())]
            cells += [f"{c[row]:.9g}".replace(".", decimal) if row < len(c) else " " for c in columns]
        while cells[-1] == " ":
            del cells[-1]
        lines.append(mark.join(cells))
    path.write_text("\r\n".join([*lines, "EOF", ""]), encoding="utf-8")
    return path


@pytest.mark.parametrize("mark", ["\t", ";", ":"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_channels_with_a_unit_and_times_of_each_are_a_capture(
    tmp_path: Path, mark: str, decimal: str
) -> None:
    """The first line has two cells and the last fewer than the first: it was refused as cut short."""
    capture = kc.load(exported(tmp_path / "s.csv", AXIS, DRIVE, mark=mark, decimal=decimal, tail=mark))
    np.testing.assert_allclose(capture.t, T, atol=1e-9)
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-7)
    np.testing.assert_allclose(capture.omega, OMEGA, atol=1e-7)
    np.testing.assert_allclose(capture.tau, TAU, atol=1e-7)


def test_of_channels_that_end_a_row_later_the_last_row_is_none(tmp_path: Path) -> None:
    longer: Group = (np.append(T, 1.2), {"ActTorque": ("Nm", np.append(TAU, 0.0))})
    assert kc.load(exported(tmp_path / "s.txt", AXIS, longer)).samples == len(T)


def test_a_torque_that_was_read_at_every_fifth_time_of_the_motion_is_taken_where_both_were(
    tmp_path: Path,
) -> None:
    """Channels with sample times of their own; row by row their readings are of other moments."""
    path = exported(tmp_path / "s.csv", AXIS, (SLOW, {"Load": ("Nm", TAU[::5])}), DRIVE)
    assert kc.load(path, map="t=t, theta=ActPos, tau=ActTorque").samples == len(T)
    slow = kc.load(path, map="t=t, theta=ActPos, omega=ActVelo, tau=Load")
    np.testing.assert_allclose(slow.t, SLOW, atol=1e-9)
    np.testing.assert_allclose(slow.theta, THETA[::5], atol=1e-7)
    np.testing.assert_allclose(slow.omega, OMEGA[::5], atol=1e-7)
    np.testing.assert_allclose(slow.tau, TAU[::5], atol=1e-7)
    assert "stands in 120 of 600 rows beside tau" in str([str(one.message) for one in slow.findings])


def test_a_torque_of_a_clock_of_its_own_has_the_motion_that_was_between_its_readings(tmp_path: Path) -> None:
    late = T[:-1] + 7e-4
    found = kc.load(exported(tmp_path / "s.csv", AXIS, (late, {"ActTorque": ("Nm", np.cos(9.0 * late))})))
    np.testing.assert_allclose(found.t, late, atol=1e-9)
    np.testing.assert_allclose(found.theta, 0.9 * np.sin(5.0 * late), atol=1e-4)
    np.testing.assert_allclose(found.tau, np.cos(9.0 * late), atol=1e-7)


def test_two_axes_of_which_channels_are_called_alike_are_told_apart_by_their_variables(
    tmp_path: Path,
) -> None:
    """Of two columns of one name the first was the axis, without a word."""
    path = exported(tmp_path / "s.csv", AXIS, (T, {"ActPos": ("deg", THETA), "ActTorque": ("Nm", TAU)}))
    asked = r"MAIN\.Axis1\.ActPos and MAIN\.Axis4\.ActPos could each be theta"
    with pytest.raises(InputError, match=asked):
        kc.load(path)
    own = "t=t, theta=MAIN.Axis4.ActPos, tau=MAIN.Axis4.ActTorque"
    np.testing.assert_allclose(kc.load(path, map=own).theta, np.radians(THETA), atol=1e-9)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("Name\tActPos", "Name\tAct\tPos"), "names hold the separator"),
        (("\n0\t", "\n?\t"), "row 1: '.' is not a number"),
        (("\nUnit", "\n\nUnit"), "without the lines of Name and Unit|is not a number"),
    ],
)
def test_an_export_that_is_damaged_is_refused_with_the_way_out(
    tmp_path: Path, change: tuple[str, str], said: str
) -> None:
    path = exported(tmp_path / "s.csv", AXIS, DRIVE)
    path.write_bytes(path.read_bytes().replace(change[0].encode(), change[1].encode()))
    with pytest.raises(InputError, match=said):
        kc.load(path)


def test_an_export_with_blanks_between_its_cells_is_asked_for_with_others(tmp_path: Path) -> None:
    """Units and names hold blanks too; titles that do are quoted."""
    path = exported(tmp_path / "s.csv", AXIS, DRIVE, mark=" ")
    path.write_text(path.read_text().replace("Starttime of export", '"Starttime of export"'))
    with pytest.raises(InputError, match="names hold the separator ' '; export it with tabs or semicolons"):
        kc.load(path)
