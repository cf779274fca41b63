"""Bad input ends in exit code 2 and one line that names it; nothing is written, nothing is traced back."""

from __future__ import annotations

import gzip
import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from command import knobcam, process, refused
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

HEAD = "t_s,theta_rad,tau_Nm"
N = 2000
t = np.arange(1, N + 1) / 1000.0
theta = np.sin(5.0 * t)
tau = 0.002 * np.sign(np.cos(5.0 * t)) + 1e-4 * np.random.default_rng(1).standard_normal(N)


def csv(path: Path, *columns: Any, head: str = HEAD) -> Path:
    rows = [
        ",".join(f"{cell!r}" if isinstance(cell, float) else str(cell) for cell in row)
        for row in zip(*columns, strict=True)
    ]
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def good(folder: Path) -> Path:
    return csv(folder / "good.csv", t.tolist(), theta.tolist(), tau.tolist())


def written(folder: Path, content: str | bytes, name: str = "bad.csv") -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def column(folder: Path, **changed: Any) -> Path:
    columns = {"t": t, "theta": theta, "tau": tau} | changed
    return csv(folder / "bad.csv", *(np.asarray(values, dtype=float).tolist() for values in columns.values()))


def huge_npy(folder: Path) -> Path:
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': (134217728, 3), }"
    head = head.ljust(117) + b"\n"
    return written(folder, b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head, "huge.npy")


def nested_mat(folder: Path) -> Path:
    path = folder / "nested.mat"
    scipy.io.savemat(path, {"run": {"motion": {"theta": theta}, "torque": {"tau": tau}}})
    return path


def spoiled(at: int, text: str) -> list[Any]:
    return [text if row == at else value for row, value in enumerate(tau.tolist(), start=1)]


def stamps(step: Callable[[int], float]) -> list[float]:
    return [step(row) for row in range(N)]


FILES: dict[str, tuple[Callable[[Path], Path], list[str]]] = {
    "empty file": (lambda d: written(d, ""), ["bad.csv", "empty"]),
    "only a header": (lambda d: written(d, HEAD + "\n"), ["bad.csv", "no rows"]),
    "only blank lines": (lambda d: written(d, "\n \n\n"), ["bad.csv", "empty"]),
    "one row": (lambda d: written(d, f"{HEAD}\n0,0,0\n"), ["bad.csv", "1 rows of data", "at least 2"]),
    "two rows": (lambda d: written(d, f"{HEAD}\n0,0,0\n1,1,1\n"), ["bad.csv"]),
    "twelve rows": (
        lambda d: csv(d / "bad.csv", t[:12].tolist(), theta[:12].tolist(), tau[:12].tolist()),
        ["bad.csv"],
    ),
    "constant torque": (
        lambda d: column(d, tau=np.full(N, 0.25)),
        ["bad.csv", "tau", "same in every sample"],
    ),
    "no torque": (lambda d: column(d, tau=np.zeros(N)), ["bad.csv", "tau", "same in every sample"]),
    "zero motion": (lambda d: column(d, theta=np.full(N, 0.5)), ["bad.csv", "theta", "never moves"]),
    "a clock that leaps beyond any multiple of its step": (
        lambda d: column(d, t=np.append(1e-300 * np.arange(N - 1), 1e25)),
        ["bad.csv", "column t spans more than a float64 can hold"],
    ),
    "all zeros": (
        lambda d: column(d, theta=np.zeros(N), tau=np.zeros(N)),
        ["bad.csv", "same in every sample"],
    ),
    "all-NaN column": (
        lambda d: column(d, tau=np.full(N, np.nan)),
        ["bad.csv", "column tau", "no number"],
    ),
    "all-NaN times": (lambda d: column(d, t=np.full(N, np.nan)), ["bad.csv", "column t", "no number"]),
    "infinite column": (
        lambda d: column(d, theta=np.full(N, np.inf)),
        ["bad.csv", "column theta", "no number"],
    ),
    "huge torque": (lambda d: column(d, tau=tau * 1e308), ["bad.csv", "column tau", "1e+30"]),
    "huge angle": (lambda d: column(d, theta=np.sign(theta) * 1e308), ["bad.csv", "column theta", "1e+30"]),
    "huge times": (lambda d: column(d, t=t * 5e307), ["bad.csv", "column t", "1e+30"]),
    "a string in a column": (
        lambda d: csv(d / "bad.csv", t.tolist(), theta.tolist(), spoiled(7, "saturated")),
        ["bad.csv", "row 7", "tau_Nm", "'saturated'"],
    ),
    "columns of different length": (
        lambda d: csv(d / "bad.csv", t.tolist(), theta.tolist(), [*tau.tolist()[:1500], *[""] * 500]),
        ["bad.csv", "different length", "2000", "1500"],
    ),
    "a line cut short": (
        lambda d: written(d, good(d).read_text().rsplit(",", 1)[0] + "\n"),
        ["bad.csv", "row 2000"],
    ),
    ".mat with nested structs": (nested_mat, ["nested.mat", "run.motion.theta"]),
    "3 GB claimed by a small header": (huge_npy, ["huge.npy", "3221225472", "cut short"]),
    "binary garbage": (
        lambda d: written(d, np.random.default_rng(0).bytes(5000), "noise.bin"),
        ["noise.bin", "neither text nor a format"],
    ),
    "garbage behind the magic of a .mat": (
        lambda d: written(
            d, b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM" + b"\x0e\0\0\0\xff\xff\xff\x7f", "x.mat"
        ),
        ["x.mat"],
    ),
    "gz cut short": (
        lambda d: written(d, gzip.compress(good(d).read_bytes())[:-400], "short.csv.gz"),
        ["short.csv.gz"],
    ),
    "one line of commas": (
        lambda d: written(d, "," * 5_000_000, "commas.csv"),
        ["commas.csv", "a line of 5000000 characters"],
    ),
    "one JSON document that would fill the memory": (
        lambda d: written(d, "[" + "[]," * 2**24 + "[]]", "lists.json"),
        ["lists.json", "50331652 bytes in one JSON document"],
    ),
    "missing file": (lambda d: d / "absent.csv", ["absent.csv", "No such file"]),
    "a folder": (lambda d: d, ["a folder, not a file"]),
    "one stamp for all": (lambda d: column(d, t=np.full(N, 1.0)), ["bad.csv", "t", "does not advance"]),
    "backward times": (lambda d: column(d, t=t[::-1]), ["bad.csv", "t"]),
    "stamps rounded to seconds": (lambda d: column(d, t=stamps(lambda row: row // 1000)), ["bad.csv"]),
    "no known column": (
        lambda d: csv(d / "bad.csv", t.tolist(), theta.tolist(), tau.tolist(), head="a,b,c"),
        ["bad.csv", "a, b, c", "--map"],
    ),
    "two columns of one name": (
        lambda d: csv(d / "bad.csv", t.tolist(), theta.tolist(), tau.tolist(), head="t_s,tau_Nm,tau_Nm"),
        ["bad.csv", "tau_Nm"],
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_a_bad_capture_is_refused_in_one_line_and_nothing_is_written(case: str, tmp_path: Path) -> None:
    build, words = FILES[case]
    source = tmp_path / "in"
    source.mkdir()
    path = build(source)
    out = tmp_path / "out"
    out.mkdir()
    refused(knobcam("fit", path, "-o", out / "model.toml", "--plots", out / "pictures"), *words)
    assert list(out.iterdir()) == []


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["fit", "absent.csv"], ["absent.csv"]),
        (["fit", "empty.csv"], ["empty.csv", "empty"]),
        (["fit", "good.csv", "--option", "torque_edge_hz=4000"], ["Nyquist"]),
        (["compare", "good.csv", "empty.csv"], ["schema"]),
        (["simulate", "knob3", "--motion", "waltz", "-o", "c.npz"], ["waltz"]),
        (["fit"], ["CAPTURE"]),
    ],
)
def test_a_process_refuses_in_one_line_too(argv: list[str], words: list[str], tmp_path: Path) -> None:
    good(tmp_path)
    written(tmp_path, "", "empty.csv")
    refused(process(*argv, cwd=tmp_path), *words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty.csv", "good.csv"]


@pytest.mark.skipif(os.name != "posix", reason="names are text elsewhere")
def test_a_file_name_that_is_no_text_is_refused_in_one_line(tmp_path: Path) -> None:
    refused(process("fit", os.fsdecode(os.fsencode(tmp_path) + b"/\xff\n\x1b.csv")), "No such file")


def test_an_hour_of_zeros_is_refused_in_seconds(tmp_path: Path) -> None:
    path = tmp_path / "zeros.npy"
    np.save(path, np.zeros((3_600_000, 2)))
    refused(
        knobcam("fit", path, "--map", "theta=c0", "tau=c1", "--rate", "1000"),
        "zeros.npy",
        "same in every sample",
    )


def test_stamps_that_repeat_or_run_backward_in_most_rows_are_refused_masked_or_spread(tmp_path: Path) -> None:
    for name, times in {
        "repeated": stamps(lambda row: (row - row % 10) / 1000.0),
        "zigzag": stamps(lambda row: (row - 7 * (row % 10)) / 1000.0),
        "saw": stamps(lambda row: (row % 50) / 1000.0),
    }.items():
        ended = knobcam("fit", column(tmp_path, t=times))
        if ended.code == 0:
            assert ("spread evenly" if name == "repeated" else "masked") in ended.err, name
        else:
            refused(ended, "bad.csv")


def test_a_capture_with_some_bad_samples_is_fitted_and_they_are_said(tmp_path: Path) -> None:
    spoilt = tau.copy()
    spoilt[700:720] = [np.nan, np.inf, -np.inf, 1e308] * 5
    ended = knobcam("fit", column(tmp_path, tau=spoilt), "--json")
    assert ended.code == 0
    assert ended.document["captures"][0]["masked"] == 20
    (finding,) = ended.document["findings"]
    assert (finding["kind"], finding["rows"], finding["done"]) == ("non-finite", [[701, 720]], "masked")
    assert abs(ended.document["params"]["coulomb.pos"]["value"] - 0.002) < 1e-4
    assert "20 samples are not finite" in ended.err and "rows 701-720" in ended.err


@pytest.mark.parametrize("size", [1e9, 1e15])
def test_an_angle_in_counts_is_fitted_within_memory(size: float, tmp_path: Path) -> None:
    ended = process("fit", column(tmp_path, theta=size * theta), "--json")
    assert ended.code == 0, ended.err
    assert ended.document["rmse"] is not None


NUMBERS = st.one_of(
    st.floats(-1e3, 1e3).map(repr),
    st.floats(width=64).filter(lambda x: not 1e3 < abs(x) < 1e30).map(repr),
    st.integers(-3, 3).map(str),
    st.sampled_from(["", "nan", "inf", "-inf", "1e308", "1e-320", "x", "1,5"]),
)
# Enough rows for a fit, of a pattern that repeats: what is drawn is the pattern.
PATTERNS = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=8)
few = settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@few
@given(
    pattern=PATTERNS,
    rows=st.sampled_from([1, 3, 140, 400]),
    method=st.sampled_from(["smooth", "paper", "none", "differences"]),
    command=st.sampled_from(["fit", "compare"]),
)
@example(
    pattern=[("1e-320", "1e-320"), ("0", "0"), ("1e-320", "0")], rows=400, method="smooth", command="compare"
)
@example(
    pattern=[("0.0", "0.0"), ("1.0", "0.0"), ("1e-320", "0.0")], rows=140, method="smooth", command="fit"
)
@example(pattern=[("0.0", "0.0"), ("inf", "0.0"), ("inf", "0.0")], rows=140, method="smooth", command="fit")
def test_no_table_of_numbers_makes_the_program_fail(
    pattern: list[tuple[str, str]], rows: int, method: str, command: str, tmp_path: Path
) -> None:
    lines = [f"{row / 1000},{','.join(pattern[row % len(pattern)])}" for row in range(rows)]
    path = written(tmp_path, "\n".join([HEAD, *lines]))
    call = ["fit", path] if command == "fit" else ["compare", path, "knob3"]
    ended = knobcam(*call, "--prepare", method, "--json")
    if ended.code == 0:
        assert ended.document["rmse"] is not None
    else:
        refused(ended)


@few
@given(text=st.text(max_size=300))
@example(text="0,0,0\n" * 200)
def test_no_text_makes_the_program_fail(text: str, tmp_path: Path) -> None:
    path = written(tmp_path, f"{HEAD}\n{text}".encode("utf-8", "surrogatepass"))
    refused(knobcam("fit", path))
