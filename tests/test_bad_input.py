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
from command import Ended, knobcam, process
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
    "one row": (lambda d: written(d, f"{HEAD}\n0,0,0\n"), ["bad.csv", "rows of data: 1", "at least 2"]),
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
    "all zeros": (
        lambda d: column(d, theta=np.zeros(N), tau=np.zeros(N)),
        ["bad.csv", "same in every sample"],
    ),
    "all-NaN column": (
        lambda d: column(d, tau=np.full(N, np.nan)),
        ["bad.csv", "column tau", "no finite number"],
    ),
    "all-NaN times": (lambda d: column(d, t=np.full(N, np.nan)), ["bad.csv", "column t", "no finite number"]),
    "infinite column": (
        lambda d: column(d, theta=np.full(N, np.inf)),
        ["bad.csv", "column theta", "no finite number"],
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


def refused(ended: Ended, *words: str) -> None:
    """Assert exit code 2, one line on standard error that holds the words, nothing on standard output."""
    assert ended.code == 2, ended
    assert ended.out == ""
    assert ended.err.startswith("knobcam: ") and ended.err.count("\n") == 1 and ended.err.endswith("\n"), (
        ended.err
    )
    for word in words:
        assert word in ended.err, f"{word!r} is not in {ended.err!r}"


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


OPTIONS: dict[str, tuple[list[str], list[str]]] = {
    "unknown column in the map": (
        ["--map", "t=t_s", "theta=angle", "tau=tau_Nm"],
        ["good.csv", "angle", "theta_rad"],
    ),
    "map without torque": (["--map", "t=t_s", "theta=theta_rad"], ["map", "tau is missing"]),
    "map of an unknown target": (["--map", "torque=tau_Nm"], ["'torque'", "tau"]),
    "map that calls code": (["--map", "t=t_s, theta=open(theta_rad), tau=tau_Nm"], ["open"]),
    "map without equals sign": (["--map", "theta_rad"], ["--map", "'theta_rad'"]),
    "map in an unknown unit": (["--map", "t=t_s", "theta=theta_rad [parsec_]", "tau=tau_Nm"], ["parsec_"]),
    "the other kind of axis": (["--coordinate", "linear"], ["good.csv", "theta_m", "tau_N"]),
    "an unknown kind of axis": (["--coordinate", "spiral"], ["--coordinate", "'spiral'", "rotary"]),
    "negative rate": (["--rate", "-5"], ["rate=-5", "Hz"]),
    "rate of zero": (["--rate", "0"], ["rate=0", "Hz"]),
    "rate that is no number": (["--rate", "fast"], ["--rate", "'fast'"]),
    "rate that contradicts the times": (["--rate", "5000"], ["good.csv", "1000", "5000"]),
    "an infinite rate": (["--rate", "inf"], ["rate=inf"]),
    "start behind the end": (["--start", "1.5", "--end", "1.0"], ["good.csv", "start=1.5", "end=1.0"]),
    "start behind the capture": (["--start", "100"], ["good.csv", "start=100"]),
    "edge above Nyquist": (["--option", "torque_edge_hz=4000"], ["good.csv", "4000", "Nyquist"]),
    "edge of zero": (["--option", "torque_edge_hz=0"], ["good.csv", "edge_hz", "0 Hz"]),
    "edge of nan": (["--option", "torque_edge_hz=nan"], ["good.csv", "edge_hz", "NaN"]),
    "motion edge above Nyquist": (
        ["--prepare", "paper", "--option", "motion_edge_hz=4000"],
        ["good.csv", "4000", "Nyquist"],
    ),
    "decimation of zero": (["--prepare", "differences", "--option", "decimate=0"], ["decimate"]),
    "decimation by half a sample": (["--prepare", "differences", "--option", "decimate=2.5"], ["decimate"]),
    "decimation of everything": (["--prepare", "differences", "--option", "decimate=1e9"], ["good.csv"]),
    "cutoff above Nyquist": (
        ["--prepare", "differences", "--option", "cutoff_hz=600"],
        ["good.csv", "600", "Nyquist"],
    ),
    "unknown preparation": (["--prepare", "magic"], ["prepare='magic'", "smooth"]),
    "unknown option": (["--option", "edge=4"], ["'edge'", "torque_edge_hz"]),
    "an argument of the library as option": (["--option", "model=4"], ["'model'", "torque_edge_hz"]),
    "option that is no number": (["--option", "torque_edge_hz=fast"], ["torque_edge_hz", "'fast'"]),
    "option given twice": (
        ["--option", "torque_edge_hz=50", "torque_edge_hz=60"],
        ["torque_edge_hz", "twice"],
    ),
    "unknown answer about detents": (["--detents", "maybe"], ["--detents", "'maybe'"]),
    "unknown argument": (["--frobnicate"], ["--frobnicate", "knobcam"]),
    "missing model": (["--model", "absent.toml"], ["absent.toml", "No such file"]),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_a_bad_option_is_refused_in_one_line_and_nothing_is_written(case: str, tmp_path: Path) -> None:
    options, words = OPTIONS[case]
    path = good(tmp_path)
    refused(
        knobcam("fit", path, "-o", tmp_path / "model.toml", "--plots", tmp_path / "plots", *options), *words
    )
    assert list(tmp_path.iterdir()) == [path]


MODEL = 'schema = "knobcam.model/1"\naxis = "rotary"\n'
MODELS: dict[str, tuple[str | bytes, list[str]]] = {
    "empty": ("", ["m.toml", "schema"]),
    "no TOML": ("knob = {", ["m.toml"]),
    "binary": (b"\xff\xfe\x00\x81", ["m.toml", "no text"]),
    "no effects": (MODEL, ["m.toml", "effects"]),
    "a newer schema": (MODEL.replace("/1", "/9"), ["m.toml", "knobcam.model/9"]),
    "an unknown axis": (MODEL.replace("rotary", "spiral"), ["m.toml", "axis", "rotary"]),
    "an unknown effect": (MODEL + "[effects.magic]\nM = 1.0\n", ["m.toml", "magic"]),
    "an unknown parameter": (MODEL + "[effects.inertia]\nJ = 1.0\n", ["m.toml", "inertia", "J"]),
    "a parameter out of bounds": (
        MODEL + "[effects.detent]\nA = 0.001\nP = -0.03\nS = 0.0\n",
        ["m.toml", "detent.P", "-0.03"],
    ),
    "a text for a number": (MODEL + '[effects.inertia]\nM = "heavy"\n', ["m.toml", "inertia.M"]),
    "a parameter of nan": (MODEL + "[effects.inertia]\nM = nan\n", ["m.toml", "inertia.M"]),
    "a parameter of inf": (MODEL + "[effects.inertia]\nM = inf\n", ["m.toml", "inertia.M"]),
    "a parameter given twice": (MODEL + "[effects.inertia]\nM = 1.0\nM = 2.0\n", ["m.toml"]),
}


@pytest.mark.parametrize("command", ["fit", "compare", "simulate"])
@pytest.mark.parametrize("case", MODELS)
def test_a_bad_model_is_refused_in_one_line_and_nothing_is_written(
    command: str, case: str, tmp_path: Path
) -> None:
    content, words = MODELS[case]
    path, model = good(tmp_path), written(tmp_path, content, "m.toml")
    calls = {
        "fit": ["fit", path, "--model", model, "-o", tmp_path / "fitted.toml"],
        "compare": ["compare", path, model, "--plots", tmp_path / "plots"],
        "simulate": ["simulate", model, "-o", tmp_path / "c.npz"],
    }
    refused(knobcam(*calls[command]), *words)
    assert sorted(tmp_path.iterdir()) == [path, model]


def test_a_model_of_the_other_kind_of_axis_is_refused(tmp_path: Path) -> None:
    linear = MODEL.replace("rotary", "linear") + "[effects.inertia]\nM = 1.0\n"
    path, model = good(tmp_path), written(tmp_path, linear, "m.toml")
    refused(knobcam("fit", path, "--model", model), "good.csv", "model", "axis")
    refused(knobcam("compare", path, model), "good.csv", "model", "axis")


CALLS: dict[str, tuple[list[str], list[str]]] = {
    "no command": ([], ["COMMAND", "knobcam --help"]),
    "unknown command": (["knit"], ["'knit'"]),
    "import without a file": (["import", "-o", "c.npz"], ["FILE"]),
    "import without an output": (["import", "good.csv"], ["-o"]),
    "import of a missing file": (["import", "absent.csv", "-o", "c.npz"], ["absent.csv"]),
    "import over its own input": (["import", "good.csv", "-o", "good.csv"], ["good.csv", "another file"]),
    "import into a missing folder": (["import", "good.csv", "-o", "no/such/c.npz"], ["no/such", "no folder"]),
    "import onto a folder": (["import", "good.csv", "-o", "."], ["is a folder"]),
    "import into a file as folder": (
        ["import", "good.csv", "-o", "good.csv/c.npz"],
        ["good.csv", "no folder"],
    ),
    "simulate an unknown knob": (["simulate", "knob9", "-o", "c.npz"], ["knob9", "knob1"]),
    "unknown motion": (["simulate", "knob3", "--motion", "waltz", "-o", "c.npz"], ["'waltz'", "sweep"]),
    "unknown noise": (["simulate", "knob3", "--noise", "loud", "-o", "c.npz"], ["'loud'", "rig"]),
    "negative seed": (["simulate", "knob3", "--seed", "-1", "-o", "c.npz"], ["--seed", "'-1'"]),
    "broken seed": (["simulate", "knob3", "--seed", "1.5", "-o", "c.npz"], ["--seed", "'1.5'"]),
    "no duration": (["simulate", "knob3", "--duration", "0", "-o", "c.npz"], ["duration=0"]),
    "negative duration": (["simulate", "knob3", "--duration", "-6", "-o", "c.npz"], ["duration=-6"]),
    "endless duration": (["simulate", "knob3", "--duration", "inf", "-o", "c.npz"], ["duration=inf"]),
    "duration of nan": (["simulate", "knob3", "--duration", "nan", "-o", "c.npz"], ["duration=nan"]),
    "a duration of years": (["simulate", "knob3", "--duration", "1e9", "-o", "c.npz"], ["duration=1", "1e8"]),
    "negative simulated rate": (["simulate", "knob3", "--rate", "-5", "-o", "c.npz"], ["rate"]),
    "both negative": (["simulate", "knob3", "--rate", "-5000", "--duration", "-6", "-o", "c.npz"], ["rate"]),
    "rate of nan": (["simulate", "knob3", "--rate", "nan", "-o", "c.npz"], ["rate"]),
    "a rate below any motion": (
        ["simulate", "knob3", "--rate", "1e-300", "--duration", "1e301", "-o", "c.npz"],
        ["rate=1e-300"],
    ),
    "fit into a missing folder": (["fit", "good.csv", "-o", "no/such/m.toml"], ["no/such", "no folder"]),
    "fit over its own input": (["fit", "good.csv", "-o", "good.csv"], ["good.csv", "another file"]),
    "pictures into a missing folder": (
        ["fit", "good.csv", "--plots", "no/such/plots"],
        ["no/such", "no folder"],
    ),
    "pictures into a file": (["fit", "good.csv", "--plots", "good.csv"], ["good.csv", "is a file"]),
    "pictures where the model goes": (["fit", "good.csv", "--plots", "p", "-o", "p"], ["p:", "two names"]),
    "compare without a model": (["compare", "good.csv"], ["MODEL"]),
    "compare with a capture for a model": (["compare", "good.csv", "good.csv"], ["good.csv", "line 1"]),
    "compare with a missing model": (["compare", "good.csv", "absent.toml"], ["absent.toml"]),
    "unknown effect": (["effects", "magic"], ["'magic'", "coulomb"]),
    "picture of no effect": (["effects", "-o", "e.png"], ["e.png", "--plots"]),
    "picture of unknown kind": (["effects", "coulomb", "-o", "e.doc"], ["e.doc", ".png"]),
    "demo of a sixth knob": (["demo", "--knob", "6"], ["'6'", "1 to 5"]),
    "demo of no knob": (["demo", "--knob", "²"], ["choose 1 to 5"]),
    "demo into a missing folder": (["demo", "-o", "no/such/demo"], ["no/such", "no folder"]),
    "demo into a file": (["demo", "-o", "good.csv"], ["good.csv", "is a file"]),
}


@pytest.mark.parametrize("case", CALLS)
def test_a_bad_call_is_refused_in_one_line_and_nothing_is_written(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    argv, words = CALLS[case]
    monkeypatch.chdir(tmp_path)
    path = good(tmp_path)
    content = path.read_bytes()
    refused(knobcam(*argv), *words)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == content


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


def test_stamps_that_repeat_or_run_backward_in_most_rows_are_refused_or_masked(tmp_path: Path) -> None:
    for name, times in {
        "repeated": stamps(lambda row: (row - row % 10) / 1000.0),
        "zigzag": stamps(lambda row: (row - 7 * (row % 10)) / 1000.0),
        "saw": stamps(lambda row: (row % 50) / 1000.0),
    }.items():
        ended = knobcam("fit", column(tmp_path, t=times))
        if ended.code == 0:
            assert "masked" in ended.err, name
        else:
            refused(ended, "bad.csv")


def test_a_capture_with_some_bad_samples_is_fitted_and_they_are_said(tmp_path: Path) -> None:
    spoilt = tau.copy()
    spoilt[700:720] = [np.nan, np.inf, -np.inf, 1e308] * 5
    ended = knobcam("fit", column(tmp_path, tau=spoilt), "--json")
    assert ended.code == 0
    assert ended.document["captures"][0]["masked"] == 20
    assert abs(ended.document["params"]["coulomb.pos"]["value"] - 0.002) < 1e-4
    assert "20 samples are not finite" in ended.err and "rows 701-720" in ended.err


NUMBERS = st.one_of(
    st.floats(width=64).map(repr),
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
)
@example(pattern=[("1e29", "1e29"), ("-1e29", "0")], rows=400, method="smooth")
@example(pattern=[("1e-320", "1e-320"), ("0", "0"), ("1e-320", "0")], rows=400, method="smooth")
def test_no_table_of_numbers_makes_the_program_fail(
    pattern: list[tuple[str, str]], rows: int, method: str, tmp_path: Path
) -> None:
    lines = [f"{row / 1000},{','.join(pattern[row % len(pattern)])}" for row in range(rows)]
    ended = knobcam("fit", written(tmp_path, "\n".join([HEAD, *lines])), "--prepare", method, "--json")
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
