"""The column map: expressions, units, and what it refuses."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from knobcam.capture import Capture, load
from knobcam.capture.formats.columnmap import parse_map
from knobcam.capture.formats.expression import evaluate
from knobcam.capture.formats.units import to_si
from knobcam.errors import InputError

COLUMNS = {"a": np.array([1.0, 2.0, 3.0]), "data.qm": np.array([4.0, 5.0, 6.0]), "my col, 1": np.arange(3.0)}
COLUMNS["scale"] = np.array(10.0)
COLUMNS["short"] = np.array([1.0, 2.0])


def value(expression: str) -> list[float]:
    return evaluate(expression, COLUMNS.__getitem__).tolist()  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("a", [1.0, 2.0, 3.0]),
        ("-a + 2*a", [1.0, 2.0, 3.0]),
        ("(a + 1)**2 / 2", [2.0, 4.5, 8.0]),
        ("scale*data.qm", [40.0, 50.0, 60.0]),
        ("`my col, 1` - `data.qm`", [-4.0, -4.0, -4.0]),
        ("cumsum(a)", [1.0, 3.0, 6.0]),
        ("abs(-a) + sqrt(a*a)", [2.0, 4.0, 6.0]),
        ("deg2rad(180*a)/pi", [1.0, 2.0, 3.0]),
        ("sin(a)**2 + cos(a)**2 - 1 + a", [1.0, 2.0, 3.0]),
        ("a/0", [math.inf] * 3),
    ],
)
def test_an_expression_is_arithmetic_over_columns(expression: str, expected: list[float]) -> None:
    assert value(expression) == pytest.approx(expected, rel=1e-14)


def test_unwrapping_goes_across_a_sample_that_is_missing() -> None:
    wrapped = np.array([3.0, np.nan, -3.0, -2.9])
    unwrapped = evaluate("unwrap(a)", {"a": wrapped}.__getitem__)
    np.testing.assert_allclose(unwrapped, [3.0, np.nan, 2 * np.pi - 3.0, 2 * np.pi - 2.9])


@pytest.mark.parametrize(
    "expression",
    [
        "__import__('os').system('true')",
        "().__class__",
        "a.__class__.__mro__ if a else a",
        "[x for x in a]",
        "lambda: a",
        "a[0]",
        "a == a",
        "'a'",
        "True",
        "1j",
        "open(a)",
        "sin(a, a)",
        "sin(x=a)",
        "sin",
        "a +",
        "(a).b + 1(2)",
        "9" * 400,
        "(" * 300 + "a" + ")" * 300,
        "a" + "+a" * 400,
        "",
    ],
)
def test_anything_else_is_refused_and_nothing_runs(expression: str) -> None:
    def column(name: str) -> Any:
        if name not in COLUMNS:
            raise InputError(f"no column {name}")
        return COLUMNS[name]

    if expression == "9" * 400:
        expression += "*a"
    with pytest.raises(InputError):
        evaluate(expression, column)


def test_columns_of_different_length_in_one_expression_are_named() -> None:
    with pytest.raises(InputError, match="a has 3 rows, short has 2"):
        value("a + short")


@pytest.mark.parametrize(
    "column_map",
    [
        "t=t, theta=q/8192 [turn], tau=35.1507*vir",
        "t=t theta=q/8192 [turn] tau=35.1507*vir",
        ["t=t", "theta=q/8192 [turn]", "tau=35.1507*vir"],
        ("t=t, theta=q/8192 [turn]", "tau=35.1507*vir"),
        {"t": "t", "theta": "q/8192 [turn]", "tau": "35.1507*vir"},
        "  t = t ;theta = q/8192[turn],\n tau = 35.1507*vir, ",
    ],
)
def test_a_map_may_be_text_a_list_or_a_dict(column_map: Any) -> None:
    entries = {target: str(entry) for target, entry in parse_map(column_map).items()}
    assert entries == {"t": "t", "theta": "q/8192 [turn]", "tau": "35.1507*vir"}


def test_names_in_backquotes_may_hold_anything() -> None:
    entries = parse_map("theta=`pos, tau=1 [x]` [deg], tau=`M [Nm]`")
    assert entries["theta"].expression == "`pos, tau=1 [x]`"
    assert entries["theta"].unit == "deg"
    assert (entries["tau"].expression, entries["tau"].unit) == ("`M [Nm]`", None)


@pytest.mark.parametrize(
    ("column_map", "message"),
    [
        ("theta=a, tau=b, force=c", "'force' is not a column of a capture"),
        ("theta=a, tau=b, tau=c", "tau is assigned twice"),
        ("theta=a, tau=", "tau is assigned nothing"),
        ("theta=a, tau=b []", "empty unit"),
        ("theta", "cannot be read"),
        ("", "cannot be read"),
    ],
)
def test_a_map_that_cannot_be_read_says_why(column_map: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_map(column_map)


@pytest.mark.parametrize(
    ("target", "unit", "factor", "axis"),
    [
        ("t", "ms", 1e-3, None),
        ("t", "µs", 1e-6, None),
        ("theta", "deg", math.pi / 180, "rotary"),
        ("theta", "turn", 2 * math.pi, "rotary"),
        ("theta", "mm", 1e-3, "linear"),
        ("omega", "rpm", 2 * math.pi / 60, "rotary"),
        ("omega", "rev/min", 2 * math.pi / 60, "rotary"),
        ("omega", "deg/s", math.pi / 180, "rotary"),
        ("alpha", "rad/s²", 1.0, "rotary"),
        ("alpha", "m/s**2", 1.0, "linear"),
        ("tau", "mNm", 1e-3, "rotary"),
        ("tau", "N m", 1.0, "rotary"),
        ("tau", "Nm", 1.0, "rotary"),
        ("tau", "mN·m", 1e-3, "rotary"),
        ("tau", "Ncm", 1e-2, "rotary"),
        ("tau", "kgf cm", 0.0980665, "rotary"),
        ("tau", "mN", 1e-3, "linear"),
        ("tau", "mA", 1e-3, None),
        ("tau", "V", 1.0, None),
        ("tau", "%", 1e-2, None),
        ("tau", "duty", 1.0, None),
    ],
)
def test_units_become_si_and_tell_the_axis(target: str, unit: str, factor: float, axis: str | None) -> None:
    found, implied, _ = to_si(target, unit)
    assert found == pytest.approx(factor, rel=1e-12)
    assert implied == axis


@pytest.mark.parametrize(
    ("target", "unit", "message"),
    [
        ("tau", "K", "wrong dimension; expected for example .*mNm"),
        ("tau", "kg", "write lbf for lb and kgf for kg"),
        ("theta", "s", "wrong dimension"),
        ("theta", "percent", "wrong dimension"),
        ("omega", "Hz", "wrong dimension"),
        ("theta", "counts", "a count is not a unit"),
        ("theta", "flurb", "unknown unit"),
        ("theta", "deg/(", "unknown unit"),
    ],
)
def test_a_wrong_unit_says_what_was_expected(target: str, unit: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        to_si(target, unit)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    t = np.arange(100.0)
    path = tmp_path / "run.csv"
    columns = np.column_stack([t, 10 * np.sin(t / 9), np.cos(t / 5), np.cos(t / 9)])
    np.savetxt(path, columns, delimiter=",", header="ms,pos,ch3,w", fmt="%.17g")
    return path


def test_a_map_with_units_gives_si(recording: Path) -> None:
    raw = np.loadtxt(recording, delimiter=",")
    capture = load(recording, map="t=ms [ms], theta=pos/360 [turn], tau=ch3 [mNm]")
    np.testing.assert_allclose(capture.t, raw[:, 0] * 1e-3, rtol=1e-15)
    np.testing.assert_allclose(capture.theta, np.deg2rad(raw[:, 1]), rtol=1e-14)
    np.testing.assert_allclose(capture.tau, raw[:, 2] * 1e-3, rtol=1e-15)
    assert capture.coordinate == "rotary"
    assert capture.omega is None


def test_a_length_makes_a_linear_axis(recording: Path) -> None:
    assert load(recording, map="t=ms [ms], theta=pos [mm], tau=ch3").coordinate == "linear"


@pytest.mark.parametrize(
    ("column_map", "axis"),
    [
        ("t=ms, theta=pos [mm], tau=ch3 [Nm]", None),
        ("t=ms, theta=pos [deg], tau=ch3", "linear"),
        ("t=ms, theta=pos, tau=ch3 [N]", "rotary"),
    ],
)
def test_units_that_contradict_the_axis_are_refused(recording: Path, column_map: str, axis: Any) -> None:
    with pytest.raises(InputError, match="change the unit or the coordinate"):
        load(recording, map=column_map, coordinate=axis)


def test_an_unknown_axis_is_refused(recording: Path) -> None:
    with pytest.raises(InputError, match="choose rotary or linear"):
        load(recording, map="t=ms, theta=pos, tau=ch3", coordinate="round")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="choose rotary or linear"):
        Capture.from_arrays(t=[0, 1], theta=[0, 1], tau=[0, 1], coordinate="round")  # type: ignore[arg-type]


def test_a_single_value_is_no_column(recording: Path) -> None:
    with pytest.raises(InputError, match=r"theta=3\.5 is a single value"):
        load(recording, map="t=ms, theta=3.5, tau=ch3")


def test_an_absent_column_lists_those_there(recording: Path) -> None:
    with pytest.raises(InputError, match="no column 'position'; the file has ms, pos, ch3, w"):
        load(recording, map="t=ms, theta=position, tau=ch3")
