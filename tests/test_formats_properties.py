"""Any file ends in a capture or in an InputError; what is written reads back exactly."""

from __future__ import annotations

import gzip
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from test_capture import EXTENSIONS, same

from knobcam.capture import Capture, load
from knobcam.capture.formats import read_table
from knobcam.capture.formats.columnmap import parse_map
from knobcam.capture.formats.expression import evaluate
from knobcam.errors import InputError

few = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])

MAGICS = [
    b"",
    b"\x1f\x8b\x08\x00",
    b"\x93NUMPY\x01\x00v\x00",
    b"PK\x03\x04",
    b"PAR1",
    b"\x89HDF\r\n\x1a\n",
    b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM",
    b"\xff\xfe",
]


def is_handled(path: Path, **options: object) -> bool:
    """Whether loading ends in a capture or in one line of InputError."""
    try:
        return isinstance(load(path, **options), Capture)  # type: ignore[arg-type]
    except InputError as error:
        return "\n" not in str(error) and str(path) in str(error)


@few
@given(magic=st.sampled_from(MAGICS), tail=st.binary(max_size=300))
def test_random_bytes_end_in_an_input_error(tmp_path: Path, magic: bytes, tail: bytes) -> None:
    path = tmp_path / "noise"
    path.write_bytes(magic + tail)
    assert is_handled(path, map="t=c0, theta=c1, tau=c2")


@few
@given(text=st.text(alphabet="0123456789.,;-+eE#\"' \t\r\n\x1cabnif_\u2028", max_size=200))
def test_random_text_ends_in_a_table_or_an_input_error(tmp_path: Path, text: str) -> None:
    path = tmp_path / "noise.csv"
    path.write_bytes(gzip.compress(text.encode()))
    assert is_handled(path, map="t=c0, theta=c1, tau=c2")


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """A small sound file of each format, by its name."""
    folder = tmp_path_factory.mktemp("sound")
    t = np.arange(20) / 100.0
    capture = Capture.from_arrays(t=t, theta=np.sin(t), tau=np.cos(t))
    files = {}
    for extension in EXTENSIONS:
        files[extension] = capture.save(folder / f"capture.{extension}").read_bytes()
    packed = io.BytesIO()
    scipy.io.savemat(packed, {"t_s": t, "theta_rad": np.sin(t), "tau_Nm": np.cos(t)}, do_compression=True)
    return files | {"compressed mat": packed.getvalue()}


@settings(few, max_examples=200)
@given(data=st.data())
def test_a_damaged_file_ends_in_a_capture_or_an_input_error(
    tmp_path: Path, sound: dict[str, bytes], data: st.DataObject
) -> None:
    content = bytearray(sound[data.draw(st.sampled_from(sorted(sound)))])
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at] = data.draw(st.integers(0, 255))
    keep = data.draw(st.integers(1, len(content)))
    path = tmp_path / "damaged"
    path.write_bytes(bytes(content[:keep] if data.draw(st.booleans()) else content))
    assert is_handled(path)


finite = st.floats(allow_nan=False, allow_infinity=False, width=64)
anything = st.floats(width=64)


@settings(few, max_examples=100)
@given(
    extension=st.sampled_from(EXTENSIONS),
    columns=st.integers(2, 30).flatmap(
        lambda n: st.tuples(
            arrays(np.float64, n, elements=anything),
            arrays(np.float64, n, elements=anything),
            st.none() | arrays(np.float64, n, elements=anything),
        )
    ),
    step=st.floats(1e-6, 1e3),
    axis=st.sampled_from(["rotary", "linear"]),
    notes=st.text(st.characters(codec="utf-8"), max_size=20),
)
def test_any_numbers_read_back_exactly(
    tmp_path: Path, extension: str, columns: tuple[np.ndarray, ...], step: float, axis: str, notes: str
) -> None:
    theta, tau, omega = columns
    t = step * np.arange(len(theta))
    try:
        capture = Capture.from_arrays(
            t=t, theta=theta, tau=tau, omega=omega, coordinate=axis, meta={"notes": notes, "step": step}
        )
    except InputError:
        return
    assert same(capture, load(capture.save(tmp_path / f"capture.{extension}")))


@few
@given(rows=st.lists(st.tuples(finite, finite), min_size=2, max_size=30), mark=st.sampled_from(",;\t "))
def test_any_finite_csv_reads_to_the_numbers_that_python_reads(
    tmp_path: Path, rows: list[tuple[float, float]], mark: str
) -> None:
    path = tmp_path / "run.csv"
    path.write_text("a" + mark + "b\n" + "".join(f"{a!r}{mark}{b!r}\n" for a, b in rows))
    columns = read_table(path).columns
    assert columns["a"].tolist() == [a for a, _ in rows]
    assert columns["b"].tolist() == [b for _, b in rows]


@few
@given(
    shape=st.tuples(st.integers(2, 12), st.integers(1, 4)).filter(lambda s: s[0] > s[1]),
    dtype=st.sampled_from(["<f8", ">f8", "<f4", "<i2", "|u1", "|b1"]),
    turned=st.booleans(),
)
def test_any_numeric_npy_is_read_along_its_longer_axis(
    tmp_path: Path, shape: tuple[int, int], dtype: str, turned: bool
) -> None:
    matrix = np.arange(shape[0] * shape[1]).reshape(shape).astype(dtype)
    np.save(tmp_path / "run.npy", matrix.T if turned else matrix)
    columns = read_table(tmp_path / "run.npy").columns
    np.testing.assert_array_equal(np.column_stack(list(columns.values())), matrix.astype(np.float64))


@few
@given(
    name=st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=10),
    content=st.binary(max_size=200),
)
def test_any_zip_member_ends_in_a_table_or_an_input_error(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{name}.npy", content)
    assert is_handled(path)


@settings(few, max_examples=200)
@given(expression=st.text(alphabet="ab01.+-*/()`_ ,[]'\"=\\\n:@" + "sinpqrt", max_size=40))
def test_any_text_as_an_expression_gives_numbers_or_an_input_error(expression: str) -> None:
    def column(name: str) -> np.ndarray:
        if name == "a":
            return np.arange(4.0)
        raise InputError(f"no column {name}")

    try:
        assert evaluate(expression, column).dtype == np.float64
    except InputError as error:
        assert str(error)


@few
@given(text=st.text(max_size=60))
def test_any_text_as_a_map_gives_entries_or_an_input_error(text: str) -> None:
    try:
        assert {"theta", "tau"} <= parse_map(text).keys()
    except InputError as error:
        assert str(error).startswith("map:")
