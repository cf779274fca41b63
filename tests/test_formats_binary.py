"""NumPy, MATLAB and Parquet files, sound and damaged."""

from __future__ import annotations

import io
import struct
import sys
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
from hostile import lying

from knobcam.capture import load
from knobcam.capture.formats import read_table
from knobcam.errors import InputError

T = np.arange(50) / 100.0
THETA = np.sin(T)
TAU = np.cos(T)


def test_a_matrix_is_read_along_its_longer_axis(tmp_path: Path) -> None:
    matrix = np.column_stack([T, THETA, TAU])
    for array in (matrix, matrix.T, np.asfortranarray(matrix), matrix.astype(">f8")):
        np.save(tmp_path / "run.npy", array)
        columns = read_table(tmp_path / "run.npy").columns
        assert list(columns) == ["c0", "c1", "c2"]
        np.testing.assert_array_equal(columns["c1"], THETA)


def test_a_vector_is_c0(tmp_path: Path) -> None:
    np.save(tmp_path / "run.npy", np.arange(4, dtype=np.int16))
    assert read_table(tmp_path / "run.npy").columns["c0"].tolist() == [0.0, 1.0, 2.0, 3.0]


def test_a_structured_array_is_read_by_its_names(tmp_path: Path) -> None:
    array = np.zeros(50, dtype=[("t_s", "f8"), ("theta_rad", "f4"), ("tau_Nm", "f8"), ("label", "U3")])
    array["t_s"], array["theta_rad"], array["tau_Nm"] = T, THETA, TAU
    np.save(tmp_path / "run.npy", array)
    assert load(tmp_path / "run.npy").samples == 50
    with pytest.raises(InputError, match="label holds text"):
        load(tmp_path / "run.npy", map="t=t_s, theta=label, tau=tau_Nm")


def test_an_npz_is_read_by_its_names(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "run.npz", t_s=T, theta_rad=THETA, tau_Nm=TAU, both=np.stack([T, TAU]))
    assert load(tmp_path / "run.npz").samples == 50
    again = load(tmp_path / "run.npz", map="t=both.c0, theta=theta_rad, tau=both.c1")
    np.testing.assert_array_equal(again.tau, TAU)


def test_pickles_are_never_read(tmp_path: Path) -> None:
    np.save(tmp_path / "run.npy", np.array([{}, 1], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="pickled objects"):
        read_table(tmp_path / "run.npy")


def npy_claiming(shape: tuple[int, ...]) -> bytes:
    """The header of an .npy of float64 of that shape, with 16 bytes behind it."""
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return file.getvalue() + bytes(16)


@pytest.mark.parametrize("shape", [(400_000_000,), (3, 10**9), (2**62, 2**62), (-4,)])
def test_a_header_that_claims_more_than_the_file_holds_is_refused(
    tmp_path: Path, shape: tuple[int, ...]
) -> None:
    (tmp_path / "run.npy").write_bytes(npy_claiming(shape))
    with pytest.raises(InputError, match="the header claims"):
        read_table(tmp_path / "run.npy")
    with zipfile.ZipFile(tmp_path / "run.npz", "w") as archive:
        archive.writestr("t_s.npy", npy_claiming(shape))
    with pytest.raises(InputError, match="t_s: the header claims"):
        read_table(tmp_path / "run.npz")


def test_a_zip_that_inflates_beyond_the_limit_is_refused(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "run.npz", t_s=np.zeros(10**6))
    with pytest.raises(InputError, match="inflates to more than 1000000"):
        load(tmp_path / "run.npz", max_bytes=1_000_000)


def test_a_zip_without_arrays_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "run.zip", "w") as archive:
        archive.mkdir("empty")
    with pytest.raises(InputError, match="without arrays"):
        read_table(tmp_path / "run.zip")


@pytest.mark.parametrize("sheet", ["xl/worksheets/sheet1.xml", "content.xml"])
def test_a_workbook_is_asked_for_as_text(tmp_path: Path, sheet: str) -> None:
    with zipfile.ZipFile(tmp_path / "run.xlsx", "w") as archive:
        archive.writestr(sheet, "<x/>")
    with pytest.raises(InputError, match="save its sheet as CSV"):
        load(tmp_path / "run.xlsx")


@pytest.mark.parametrize("compressed", [False, True])
def test_nested_matlab_structs_have_dotted_names(tmp_path: Path, compressed: bool) -> None:
    data = {"qm": THETA[:, None], "motor": {"vir": TAU[None, :], "unit": "V"}, "gtau": 35.0}
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"data": data, "t": T}, do_compression=compressed)
    capture = load(path, map="t=t, theta=data.qm, tau=data.gtau*data.motor.vir")
    np.testing.assert_array_equal(capture.tau, 35.0 * TAU)
    with pytest.raises(InputError, match=r"no column 'data.q'; the file has data.qm, data.motor.vir, .*t"):
        load(path, map="t=t, theta=data.q, tau=data.motor.vir")
    with pytest.raises(InputError, match=r"data\.motor\.unit holds text"):
        load(path, map="t=t, theta=data.motor.unit, tau=data.motor.vir")


MATLAB_FILES = sorted((Path(scipy.io.__file__).parent / "matlab" / "tests" / "data").glob("test*_*.mat"))


@pytest.mark.skipif(not MATLAB_FILES, reason="this SciPy was installed without its MATLAB files")
def test_files_that_matlab_wrote_hold_what_scipy_reads() -> None:
    compared = 0
    for path in MATLAB_FILES:
        if not path.read_bytes().startswith(b"MATLAB 5.0"):
            continue
        table = read_table(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            peer = scipy.io.loadmat(path)
        for name, values in peer.items():
            if name in table.columns:
                np.testing.assert_array_equal(table.columns[name].ravel(), values.ravel())
                compared += 1
            elif f"{name}.c0" in table.columns:
                longer = values if values.shape[0] >= values.shape[1] else values.T
                np.testing.assert_array_equal(table.columns[f"{name}.c0"], longer[:, 0])
                compared += 1
    assert compared >= 10


def test_the_structs_of_an_array_are_read_each_by_its_number(tmp_path: Path) -> None:
    """Trials of one experiment are kept so; they were refused, as "an array of 2 structs"."""
    trials = np.zeros((1, 2), dtype=[("t", object), ("q", object), ("tau", object)])
    for number, size in enumerate((1.0, 0.5)):
        trials[0, number] = (T, size * THETA, size * TAU)
    scipy.io.savemat(tmp_path / "run.mat", {"trials": trials, "one": trials[:, :1]})
    table = read_table(tmp_path / "run.mat")
    np.testing.assert_array_equal(table.columns["trials.s2.q"], 0.5 * THETA)
    np.testing.assert_array_equal(table.columns["one.q"], THETA)
    second = load(tmp_path / "run.mat", map="t=trials.s2.t, theta=trials.s2.q, tau=trials.s2.tau")
    np.testing.assert_array_equal(second.tau, 0.5 * TAU)
    scipy.io.savemat(tmp_path / "many.mat", {"runs": np.zeros((1, 2000), dtype=[("q", object)])})
    with pytest.raises(InputError, match="runs holds an array of 2000 structs"):
        load(tmp_path / "many.mat", map="t=runs, theta=runs, tau=runs")


def test_matlab_columns_of_different_length_are_named(tmp_path: Path) -> None:
    scipy.io.savemat(tmp_path / "run.mat", {"t": T, "q": THETA, "u": TAU[:-1]})
    with pytest.raises(InputError, match="t=t has 50 rows, tau=u has 49"):
        load(tmp_path / "run.mat", map="t=t, theta=q, tau=u")
    with pytest.raises(InputError, match="q has 50 rows, u has 49"):
        load(tmp_path / "run.mat", map="t=t, theta=q, tau=q*u")


MAT5_HEADER = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"


def test_a_matlab_element_that_claims_3_gb_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    path.write_bytes(MAT5_HEADER + struct.pack("<II", 14, 3_000_000_000) + bytes(100))
    with pytest.raises(InputError, match="an array claims 3000000000 bytes, the file holds 100"):
        read_table(path)
    packed = zlib.compress(struct.pack("<II", 14, 3_000_000_000) + bytes(100))
    path.write_bytes(MAT5_HEADER + struct.pack("<II", 15, len(packed)) + packed)
    with pytest.raises(InputError, match="an array claims 3000000000 bytes"):
        read_table(path)


def test_a_matlab_bomb_is_refused(tmp_path: Path) -> None:
    scipy.io.savemat(tmp_path / "run.mat", {"t": np.zeros(10**6)}, do_compression=True)
    with pytest.raises(InputError, match="inflates to more than 1000000"):
        load(tmp_path / "run.mat", max_bytes=1_000_000)


def write_mat73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"] = T[None, :]
        file["data/qm"] = THETA[None, :]
        file["data/vir"] = TAU[:, None]
        file["gtau"] = np.array([[2.0]])
        name = file.create_dataset("name", data=np.frombuffer(b"knob", dtype=np.uint8).astype(np.uint16))
        name.attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM")


def test_matlab_7_3_is_read_like_matlab_5(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    write_mat73(path)
    capture = load(path, map="t=t, theta=data.qm, tau=gtau*data.vir")
    np.testing.assert_array_equal(capture.tau, 2.0 * TAU)
    assert capture.meta["format"] == "MATLAB 7.3 .mat"
    with pytest.raises(InputError, match="name holds text"):
        load(path, map="t=t, theta=name, tau=data.vir")


@pytest.mark.parametrize("chunks", [None, (1000,)])
def test_a_dataset_that_claims_more_than_the_file_holds_is_refused(
    tmp_path: Path, chunks: tuple[int] | None
) -> None:
    with h5py.File(tmp_path / "run.mat", "w") as file:
        file.create_dataset("t", shape=(400_000_000,), dtype="f8", chunks=chunks)
    with pytest.raises(InputError, match="t claims 3200000000 bytes and holds 0"):
        read_table(tmp_path / "run.mat")


def test_parquet_is_read_by_its_names_and_a_null_is_nan(tmp_path: Path) -> None:
    table = pa.table(
        {
            "t_s": T,
            "theta_rad": THETA.astype(np.float32),
            "tau_Nm": [None, *TAU[1:].tolist()],
            "count": np.arange(50),
            "label": ["x"] * 50,
        }
    )
    pq.write_table(table, tmp_path / "run.parquet")
    capture = load(tmp_path / "run.parquet")
    assert np.flatnonzero(~capture.mask).tolist() == [0]
    with pytest.raises(InputError, match="label holds string"):
        load(tmp_path / "run.parquet", map="t=t_s, theta=label, tau=tau_Nm")


def test_a_parquet_bomb_is_refused(tmp_path: Path) -> None:
    pq.write_table(pa.table({"t_s": np.zeros(10**6)}), tmp_path / "run.parquet")
    with pytest.raises(InputError, match="inflates to more than 1000000 bytes"):
        load(tmp_path / "run.parquet", max_bytes=1_000_000)


@pytest.mark.parametrize("module", ["pyarrow", "h5py"])
def test_a_missing_package_is_named_with_the_way_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == module]:
        monkeypatch.setitem(sys.modules, name, None)  # type: ignore[arg-type]
    monkeypatch.setitem(sys.modules, module, None)  # type: ignore[arg-type]
    magic: Any = {"pyarrow": b"PAR1", "h5py": b"\x89HDF\r\n\x1a\n"}
    (tmp_path / "run").write_bytes(magic[module] + bytes(100))
    with pytest.raises(InputError, match=rf'{module}; run: pip install "knobcam\[formats\]"'):
        read_table(tmp_path / "run")


@pytest.mark.parametrize(("module", "name"), [("pyarrow", "p.parquet"), ("h5py", "p.h5"), ("scipy", "p.mat")])
def test_what_cannot_be_written_for_want_of_a_package_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, name: str
) -> None:
    for loaded in [loaded for loaded in sys.modules if loaded.partition(".")[0] == module]:
        monkeypatch.setitem(sys.modules, loaded, None)  # type: ignore[arg-type]
    np.savez(tmp_path / "run.npz", t_s=T, theta_rad=THETA, tau_Nm=TAU)
    capture = load(tmp_path / "run.npz")
    with pytest.raises(InputError, match=rf'{module}; run: pip install "knobcam\[formats\]"'):
        capture.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == [tmp_path / "run.npz"]


def test_an_unknown_binary_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.bin").write_bytes(bytes(range(256)) * 4)
    with pytest.raises(InputError, match="neither text nor a format"):
        read_table(tmp_path / "run.bin")


@pytest.mark.parametrize("dictionary", [False, True])
@pytest.mark.parametrize("version", ["1.0", "2.0"])
@pytest.mark.parametrize("compression", ["none", "snappy", "gzip", "zstd"])
def test_a_parquet_page_that_claims_more_than_its_rows_can_take_is_refused_before_it_is_read(
    tmp_path: Path, compression: str, version: str, dictionary: bool
) -> None:
    rng = np.random.default_rng(0)
    columns = {name: pa.array(rng.normal(size=3000)) for name in ("theta_rad", "tau_Nm")}
    table = pa.table({"t_s": pa.array(np.arange(3000) / 1000.0), **columns})
    file = io.BytesIO()
    pq.write_table(
        table,
        file,
        compression=compression,
        use_dictionary=dictionary,
        data_page_version=version,
    )
    path = tmp_path / "a.parquet"
    path.write_bytes(file.getvalue())
    assert load(path).samples == 3000
    path.write_bytes(lying(file.getvalue()))
    with pytest.raises(InputError, match=r"a\.parquet: column tau_Nm has a page that claims \d+ bytes"):
        load(path)
