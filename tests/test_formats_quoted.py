"""Cells in quotes that go on in the next line, as a serial port and a spreadsheet leave them in CSV."""

from __future__ import annotations

from pathlib import Path

import pytest

from knobcam.capture.formats import Table, read_table
from knobcam.errors import InputError


def table(tmp_path: Path, content: str) -> Table:
    path = tmp_path / "log.csv"
    path.write_bytes(content.encode())
    return read_table(path)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_reading_that_was_logged_with_its_line_break_is_one_cell(tmp_path: Path, end: str) -> None:
    """`str(reading)` of a serial port, with the line break that it ends with: "row 1 has 4 cells"."""
    rows = [f'{at},{at * 0.5},"+{at}.5E-06{end}",{at - 3}' for at in range(3000)]
    read = table(tmp_path, end.join(["t,theta,volts,tau", *rows]) + end)
    assert {name: len(values) for name, values in read.columns.items()} == dict.fromkeys(read.columns, 3000)
    assert read.columns["volts"][7] == 7.5e-6 and read.columns["tau"][2999] == 2996.0 and not read.broken


def test_a_name_with_a_line_break_in_it_is_one_name(tmp_path: Path) -> None:
    """Headers that were wrapped in a spreadsheet; units stand on their second line."""
    rows = "".join(f"{at},{at},{at}\n" for at in range(5))
    for titles in ("", 'Run 7\n"of a\nlong day"\n'):
        read = table(tmp_path, f'{titles}Time,"Position\n[deg]","Torque ""raw""\n[Nm]"\n{rows}')
        assert list(read.columns) == ["Time", "Position [deg]", 'Torque "raw" [Nm]']
        assert read.columns["Position [deg]"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_a_quote_that_nothing_closes_is_named_with_its_row(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"row 2 has 2 cells.*with a quote that nothing closes; close"):
        table(tmp_path, 'a,b,c\n1,2,3\n4,"5,6\n' + "7,8,9\n" * 200)
    # In the midst of a cell a quote is no more than a sign, of inches say.
    read = table(tmp_path, 'a (3"),b\n1,2\n3,4\n')
    assert [values.tolist() for values in read.columns.values()] == [[1.0, 3.0], [2.0, 4.0]]
