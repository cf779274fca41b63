"""CSV as instruments, spreadsheets and scripts write it."""

from __future__ import annotations

import gzip
import time
from pathlib import Path

import numpy as np
import pytest

from knobcam.capture import load
from knobcam.capture.formats import Table, read_table
from knobcam.errors import InputError


def table(tmp_path: Path, content: str | bytes, name: str = "data.bin") -> Table:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_table(path)


def as_lists(read: Table) -> dict[str, list[float]]:
    return {name: values.tolist() for name, values in read.columns.items()}


PLAIN = {"a": [1.0, 3.0], "b": [2.5, -4.0]}


@pytest.mark.parametrize(
    "content",
    [
        "a,b\n1,2.5\n3,-4\n",
        "a, b\r\n1, 2.5\r\n3, -4",
        "a;b\n1;2,5\n3;-4,0\n",
        "a;b\r1;2.5\r3;-4\r",
        "a\tb\n1\t2.5\n3\t-4\n",
        "a\tb\n1\t2,5\n3\t-4\n",
        "  a   b\n 1  2.5\n 3   -4\n",
        "\ufeffa,b\n1,2.5\n3,-4\n",
        '"a","b"\n"1","2.5"\n"3","-4"\n',
        "# a log\n\na,b\n# more\n1,2.5\n\n3,-4\n\n",
        "# a,b\n1,2.5\n3,-4\n",
        "a,b\n1e0,25e-1\n+3,-4.0\n",
    ],
)
def test_the_same_numbers_in_any_dialect_are_the_same_table(tmp_path: Path, content: str) -> None:
    assert as_lists(table(tmp_path, content)) == PLAIN
    assert as_lists(table(tmp_path, gzip.compress(content.encode()))) == PLAIN
    assert as_lists(table(tmp_path, content.lstrip("\ufeff").encode("utf-16"))) == PLAIN


def test_columns_without_a_header_are_counted_from_c0(tmp_path: Path) -> None:
    assert as_lists(table(tmp_path, "1,2.5\n3,-4\n")) == {"c0": [1.0, 3.0], "c1": [2.5, -4.0]}


def test_a_latin_1_header_is_read(tmp_path: Path) -> None:
    assert "Moment µNm" in table(tmp_path, "t,Moment µNm\n1,2\n3,4\n".encode("latin-1")).columns


def test_gzip_in_several_members_is_one_file(tmp_path: Path) -> None:
    content = gzip.compress(b"a,b\n1,2.5\n") + gzip.compress(b"3,-4\n")
    assert as_lists(table(tmp_path, content)) == PLAIN


def test_the_extension_does_not_matter(tmp_path: Path) -> None:
    assert as_lists(table(tmp_path, gzip.compress(b"a,b\n1,2.5\n3,-4\n"), "data.mat")) == PLAIN


def test_a_blank_cell_is_nan(tmp_path: Path) -> None:
    read = table(tmp_path, "a,b\n1,2\n,3\n4,5\n")
    np.testing.assert_array_equal(read.columns["a"], [1.0, np.nan, 4.0])


def test_a_text_in_a_column_of_numbers_is_named_with_row_and_column(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("# bench\nt_s,theta_rad,tau_Nm\n0,0,0\n1,1,1\n2,oops,2\n3,worse,3\n")
    with pytest.raises(InputError, match=r"run.csv: row 3, column theta_rad: 'oops' is not a number"):
        load(path)


def test_a_text_column_that_nobody_asks_for_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t_s,state,theta_rad,tau_Nm\n0,idle,0,0\n1,run,1,2\n2,run,2,1\n")
    assert load(path).samples == 3
    with pytest.raises(InputError, match="column state: 'idle' is not a number"):
        load(path, map="t=t_s, theta=state, tau=tau_Nm")


@pytest.mark.parametrize("cell", ["1_000", "0x10", "1,5,6", "--1", "1e", "²"])
def test_what_only_looks_like_a_number_is_a_text(tmp_path: Path, cell: str) -> None:
    read = table(tmp_path, f'a,b\n1,2\n"{cell}",3\n')
    assert "a" in read.broken
    assert read.columns["b"].tolist() == [2.0, 3.0]


def test_a_short_row_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="row 2 has 2 cells, the first line has 3"):
        table(tmp_path, "a,b,c\n1,2,3\n4,5\n")
    with pytest.raises(InputError, match="row 1 has 2 cells, the first line has 3"):
        table(tmp_path, "a,b,c\n1,2\n4,5\n")


def test_rows_above_a_broken_one_are_no_titles(tmp_path: Path) -> None:
    """Half of a row in the first hundred: all above it, names and readings, went without a word."""
    rows = [f"{row},{row},{row}" for row in range(60)]
    broken = [*rows[:40], "40,4", *rows[41:]]
    for header in ([], ["a,b,c"]):
        with pytest.raises(InputError, match="row 41 has 2 cells, the first line has 3"):
            table(tmp_path, "\n".join([*header, *broken]))
    # Half a row at the very beginning, where a logger was switched on in the midst of it, is a title.
    assert len(table(tmp_path, "\n".join(["7,7", *rows])).columns["c0"]) == 60


def test_a_column_that_ends_early_has_another_length(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t_s,theta_rad,tau_Nm\n0,0,0\n1,1,\n2,2,\n")
    with pytest.raises(InputError, match=r"t=`t_s` has 3 rows, tau=`tau_Nm` has 1"):
        load(path)


def test_of_columns_of_one_name_none_is_meant_by_it(tmp_path: Path) -> None:
    several = as_lists(table(tmp_path, "a,b,a\n1,2,3\n"))
    assert several == {"a #1": [1.0], "b": [2.0], "a #3": [3.0]}
    assert list(as_lists(table(tmp_path, "a,a #2,a\n1,2,3\n"))) == ["a #1", "a #2", "a #3"]
    assert len(as_lists(table(tmp_path, "a,a #3,a\n1,2,3\n"))) == 3
    path = tmp_path / "run.csv"
    path.write_text("t_s,theta_rad,theta_rad,tau_Nm\n0,0,1,0\n1,1,2,0\n")
    with pytest.raises(InputError, match="theta_rad #2"):
        load(path)


def test_a_table_without_names_that_lies_on_its_side_is_turned(tmp_path: Path) -> None:
    upright = np.random.default_rng(1).standard_normal((40, 3))
    text = "\n".join(",".join(map(str, row)) for row in upright.T)
    read = table(tmp_path, text)
    assert list(read.columns) == ["c0", "c1", "c2"]
    assert np.array_equal(np.column_stack(list(read.columns.values())), upright)
    wide = table(tmp_path, "\n".join(",".join(map(str, row)) for row in upright.T[:, :29]))
    assert len(wide.columns) == 29, "three rows of so many are short, and may be meant"


TITLES = ["Axis1", "Number of samples,3", "Interval (ms),0.667"]


@pytest.mark.parametrize("names", [["a,b,c"], ["Time,Analog 1,Analog 2", "a,b,c"], ["a,b,c", "s,,rad"]])
def test_titles_above_a_table_are_none_of_it(tmp_path: Path, names: list[str]) -> None:
    rows = [f"{row},{2 * row},{3 * row}" for row in range(5)]
    read = table(tmp_path, "\n".join([*TITLES, *names, *rows]))
    wanted = ["a [s]", "b", "c [rad]"] if "s,,rad" in names else ["a", "b", "c"]
    assert list(read.columns) == wanted
    assert [values.tolist() for values in read.columns.values()] == [
        [float(times * row) for row in range(5)] for times in (1, 2, 3)
    ]


def test_a_table_of_other_widths_than_its_first_line_is_none_for_its_last_two_rows(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="row 3 has 3 cells, the first line has 2"):
        table(tmp_path, "a,b\n1,2\n3,4\n5,6,7\n8,9,0\n")


def test_a_table_that_is_wider_than_any_log_is_refused_in_seconds(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    header = ",".join(f"name{index}" for index in range(50_000))
    path.write_text("\n".join([header, *[",".join(["1.5"] * 50_000)] * 3]))
    start = time.monotonic()
    with pytest.raises(InputError, match=r"has 50000 columns or more, the most is 4096"):
        load(path)
    assert time.monotonic() - start < 15.0


def test_an_unknown_header_lists_the_columns_and_an_example(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,my angle,M\n0,0,0\n0.1,1,1\n")
    with pytest.raises(InputError) as caught:
        load(path)
    assert "the file has time, my angle, M" in str(caught.value)
    assert "--map 't=time, theta=`my angle`, tau=M'" in str(caught.value)


def test_a_linear_axis_is_known_by_its_columns(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t_s,theta_m,tau_N\n0,0,0\n1,1,2\n2,3,1\n")
    assert load(path).coordinate == "linear"
    with pytest.raises(InputError, match="is for a linear axis, but it is rotary"):
        load(path, coordinate="rotary")


@pytest.mark.parametrize("content", ["", "\n\n", "# only a comment\n", "a,b,c\n"])
def test_a_file_without_rows_is_refused(tmp_path: Path, content: str) -> None:
    with pytest.raises(InputError, match=r"the file is empty|a header and no rows"):
        table(tmp_path, content)


def test_one_row_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t_s,theta_rad,tau_Nm\n0,0,0\n")
    with pytest.raises(InputError, match="1 rows of data"):
        load(path)


def test_a_bomb_is_refused_before_it_is_inflated(tmp_path: Path) -> None:
    path = tmp_path / "bomb.csv.gz"
    path.write_bytes(gzip.compress(b"0" * 10_000_000))
    with pytest.raises(InputError, match="inflates to more than 100000 bytes"):
        load(path, max_bytes=100_000)
    path.write_bytes(b"1,2,3\n" * 1000)
    with pytest.raises(InputError, match="6000 bytes, the limit is 100"):
        load(path, max_bytes=100)


def test_damaged_gzip_is_refused(tmp_path: Path) -> None:
    whole = gzip.compress(b"a,b\n1,2\n3,4\n" * 100)
    with pytest.raises(InputError, match="ends in the middle"):
        table(tmp_path, whole[:-4])
    with pytest.raises(InputError, match="damaged gzip"):
        table(tmp_path, whole[:12] + b"\xff\xff\xff" + whole[15:])


def test_a_path_that_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        load(tmp_path / "absent.csv")
    with pytest.raises(InputError, match="a folder"):
        load(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        load("a\0b")


def test_a_file_without_times_needs_a_rate(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("theta_rad,tau_Nm\n0,0\n1,1\n2,0\n")
    with pytest.raises(InputError, match="give the sampling rate in Hz"):
        load(path)
    assert load(path, rate_hz=100.0).t.tolist() == [0.0, 0.01, 0.02]
    assert load(path, rate_hz=100.0).meta["rate_hz"] == 100.0


def test_a_capture_says_where_it_came_from(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("0,0,0\n1,1,1\n2,0,3\n")
    meta = load(path, map="t=c0 [s], theta=c1/8192 [turn], tau=0.0551*c2").meta
    assert meta["source"] == str(path)
    assert meta["format"] == "CSV"
    assert meta["calibration"] == {"t": "c0 [s]", "theta": "c1/8192 [turn]", "tau": "0.0551*c2"}
