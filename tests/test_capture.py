"""A capture is immutable, says what it is, and reads back exactly what was saved."""

from __future__ import annotations

import dataclasses
import pickle
import re
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from knobcam.capture import Capture, load
from knobcam.errors import InputError, KnobcamError

EXTENSIONS = ["npz", "knob", "csv", "csv.gz", "parquet", "mat", "h5"]


def swing(samples: int = 400, **changes: object) -> Capture:
    """A knob swung as a sine, theta = sin(2 pi t), with a torque in quadrature."""
    t = np.arange(samples) / 1000.0
    phase = 2.0 * np.pi * 2.0 * t
    columns: dict[str, object] = {
        "t": t,
        "theta": np.sin(phase),
        "omega": 4.0 * np.pi * np.cos(phase),
        "alpha": -16.0 * np.pi**2 * np.sin(phase),
        "tau": 0.01 * np.sin(phase + 0.3) + 0.001 * t,
    }
    return Capture.from_arrays(**(columns | changes))  # type: ignore[arg-type]


def same(a: Capture, b: Capture) -> bool:
    """Whether two captures hold the same numbers, to the last bit and sign, and say the same of them."""
    return (
        set(a.columns) == set(b.columns)
        and all(np.array_equal(a.columns[name], b.columns[name], equal_nan=True) for name in a.columns)
        and all(
            np.array_equal(np.signbit(values[a.mask]), np.signbit(b.columns[name][a.mask]))
            for name, values in a.columns.items()
        )
        and np.array_equal(a.mask, b.mask)
        and (a.coordinate, a.rate_hz, dict(a.meta), a.findings)
        == (b.coordinate, b.rate_hz, dict(b.meta), b.findings)
    )


def test_a_healthy_capture_has_no_findings_and_loses_no_sample() -> None:
    capture = swing()
    assert capture.findings == ()
    assert capture.mask.all()
    assert capture.rate_hz == 1000.0
    assert capture.samples == 400
    assert capture.duration_s == pytest.approx(0.399)


def test_arrays_cannot_be_changed_and_the_callers_stay_writable() -> None:
    theta = np.sin(np.arange(400) / 100.0)
    capture = swing(theta=theta, omega=None, alpha=None)
    with pytest.raises(ValueError, match="read-only"):
        capture.theta[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        capture.coordinate = "linear"  # type: ignore[misc]
    with pytest.raises(TypeError):
        capture.meta["notes"] = "changed"  # type: ignore[index]
    theta[0] = 7.0
    assert capture.theta[0] == 0.0


def test_units_follow_the_axis() -> None:
    assert swing().units["tau"] == "N m"
    assert swing().units["alpha"] == "rad/s^2"
    assert swing(coordinate="linear").units["tau"] == "N"
    assert swing(coordinate="linear").units["theta"] == "m"


def test_a_capture_shows_itself_and_escapes_what_it_shows() -> None:
    capture = swing(meta={"source": "<script>alert(1)</script>"})
    assert "0.399 s at 1000 Hz" in repr(capture)
    assert "<script>" not in capture._repr_html_()
    assert "&lt;script&gt;" in capture._repr_html_()


def test_a_capture_survives_pickling() -> None:
    capture = swing(meta={"notes": "bench 2"})
    assert same(capture, pickle.loads(pickle.dumps(capture)))


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_what_is_saved_reads_back_exactly(tmp_path: Path, extension: str) -> None:
    tau = 0.01 * np.sin(np.arange(400) / 7.0)
    tau[[3, 17]] = np.nan
    capture = swing(
        tau=tau, alpha=None, coordinate="linear", meta={"notes": "µ, \n two lines", "gain": 35.1507}
    )
    again = load(capture.save(tmp_path / f"capture.{extension}"))
    assert same(capture, again)
    assert same(again, load(again.save(tmp_path / f"again.{extension}")))


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_what_was_found_when_a_log_was_read_is_kept_by_every_format(tmp_path: Path, extension: str) -> None:
    t = np.arange(4000) / 1000.0
    angle = np.rad2deg(np.cumsum(0.02 + 0.001 * np.sin(t))) % 360.0  # wraps at the turn
    tau = 0.02 * np.sin(9.0 * t) + 1e-4 * np.random.default_rng(2).standard_normal(4000)
    tau[700:705] = np.nan
    rows = "\n".join(f"{a!r},{b!r},{c!r}" for a, b, c in np.stack([t, angle, tau], axis=1).tolist())
    (tmp_path / "log.csv").write_text("time,pos_deg,torque\n" + rows)
    capture = load(tmp_path / "log.csv")
    assert {"columns", "wrap", "non-finite"} <= {one.kind for one in capture.findings}
    again = load(capture.save(tmp_path / f"capture.{extension}"))
    assert same(capture, again)


def test_a_file_that_was_changed_since_is_checked_again(tmp_path: Path) -> None:
    path = swing().save(tmp_path / "capture.csv")
    lines = path.read_text().splitlines()
    lines[41] = ",".join([*lines[41].split(",")[:-1], "nan"])
    path.write_text("\n".join(lines))
    (found,) = load(path).findings
    assert (found.kind, found.rows) == ("non-finite", (40,))


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_a_mask_set_by_hand_is_kept(tmp_path: Path, extension: str) -> None:
    mask = np.ones(400, dtype=bool)
    mask[[0, 5, 6, 399]] = False
    capture = dataclasses.replace(swing(), mask=mask)
    assert np.array_equal(load(capture.save(tmp_path / f"capture.{extension}")).mask, mask)


def test_equal_captures_are_equal_files(tmp_path: Path) -> None:
    first = swing().save(tmp_path / "a.csv.gz").read_bytes()
    assert first == swing().save(tmp_path / "b.csv.gz").read_bytes()


def test_a_capture_that_cannot_be_saved_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="meta"):
        swing(meta={"notes": object()}).save(tmp_path / "capture.csv")
    with pytest.raises(InputError, match="there is no folder"):
        swing().save(tmp_path / "nowhere" / "capture.csv")
    (tmp_path / "taken").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        swing().save(tmp_path / "taken")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_start_and_end_keep_a_part_and_rows_still_count_the_file(tmp_path: Path) -> None:
    tau = 0.01 * np.sin(np.arange(400) / 7.0)
    tau[299] = np.nan
    path = swing(tau=tau).save(tmp_path / "capture.csv")
    part = load(path, start=0.1, end=0.35)
    assert (part.t[0], part.t[-1]) == (0.1, 0.35)
    assert part.findings[0].rows == (300,)
    assert np.flatnonzero(~part.mask).tolist() == [199]
    with pytest.raises(InputError, match="no sample lies from"):
        load(path, start=5.0)


def test_a_part_of_a_native_capture_keeps_its_mask(tmp_path: Path) -> None:
    mask = np.ones(400, dtype=bool)
    mask[200] = False
    path = dataclasses.replace(swing(), mask=mask).save(tmp_path / "capture.npz")
    assert np.flatnonzero(~load(path, start=0.1).mask).tolist() == [100]


def test_a_native_capture_keeps_its_axis(tmp_path: Path) -> None:
    path = swing().save(tmp_path / "capture.npz")
    with pytest.raises(InputError, match="rotary axis, not linear"):
        load(path, coordinate="linear")


def test_a_newer_schema_is_refused(tmp_path: Path) -> None:
    path = swing().save(tmp_path / "capture.csv")
    path.write_text(path.read_text().replace("knobcam.capture/1", "knobcam.capture/9"))
    with pytest.raises(InputError, match=r"knobcam\.capture/9"):
        load(path)


def test_a_damaged_description_is_an_input_error(tmp_path: Path) -> None:
    path = swing().save(tmp_path / "capture.csv")
    text = path.read_text()
    path.write_text(text.replace('"masked_rows": []', '"masked_rows": [["a"]]'))
    with pytest.raises(InputError, match="damaged"):
        load(path)
    found = '{"kind": "x", "column": "t", "count": 1, "message": "", "severity": "note", "rows": %s}'
    for said in (found % "[[]]", found.replace("note", "loud") % "[]", found.replace("1", "[]", 1) % "[]"):
        path.write_text(text.replace('"findings": []', f'"findings": [{said}]'))
        with pytest.raises(InputError, match="damaged"):
            load(path)
    for rate in ("-5", "Infinity", "1e308"):
        path.write_text(re.sub('"rate_hz": [^,]*', f'"rate_hz": {rate}', text))
        with pytest.raises(InputError, match="damaged"):
            load(path)
    path.write_text(text.replace('{"schema"', '{schema"'))
    with pytest.raises(InputError, match="damaged"):
        load(path)


def test_arrays_of_different_length_are_named() -> None:
    with pytest.raises(InputError, match="theta has 400 samples, tau has 3"):
        swing(tau=[1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="mask has shape"):
        dataclasses.replace(swing(), mask=[True])  # type: ignore[arg-type]


def test_without_times_a_rate_numbers_the_samples() -> None:
    capture = swing(t=None, rate_hz=1000.0)
    assert capture.t[1] == 0.001
    assert capture.rate_hz == 1000.0
    with pytest.raises(InputError, match="give the sampling rate"):
        swing(t=None)
    with pytest.raises(InputError, match="no sampling rate"):
        swing(t=None, rate_hz=-1.0)


def test_a_rate_that_contradicts_the_times_is_refused() -> None:
    with pytest.raises(InputError, match="1000 Hz, a rate of 5000"):
        swing(rate_hz=5000.0)


def test_input_errors_are_one_line_with_exit_code_2() -> None:
    error = InputError("a cell\nwith\r\ttwo lines")
    assert str(error) == "a cell with two lines"
    assert error.exit_code == 2
    assert isinstance(error, KnobcamError)
    assert isinstance(error, ValueError)


def test_preparing_and_plotting_are_delegated(monkeypatch: pytest.MonkeyPatch) -> None:
    prepare = types.SimpleNamespace(prepare=lambda capture, method, **options: (capture, method, options))
    monkeypatch.setitem(sys.modules, "knobcam.capture.prepare", prepare)  # type: ignore[arg-type]
    monkeypatch.setattr("knobcam.show.plot.capture", lambda capture: capture)
    capture = swing()
    assert capture.prepare("paper", edge=3) == (capture, "paper", {"edge": 3})
    assert capture.plot() is capture


def test_a_picture_is_refused_with_all_that_could_be_given(tmp_path: Path) -> None:
    path = tmp_path / "plot.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(range(256)))
    with pytest.raises(
        InputError, match=r"give CSV \(\.gz\), JSON, \.mat, .* HDF5, Parquet, a wire log or a ROS 2 bag"
    ):
        load(path)
