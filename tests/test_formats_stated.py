"""Units that a file states beside the names of its columns, or that its format defines."""

from __future__ import annotations

from pathlib import Path

import h5py  # type: ignore[import-untyped]
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from test_formats_bags import bag
from test_formats_names import TAU, THETA, T, log

import knobcam as kc
from knobcam.errors import InputError

DEG = np.degrees(THETA)


def assert_motion(capture: kc.Capture) -> None:
    np.testing.assert_allclose(capture.t - capture.t[0], T, atol=1e-9)
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-9)
    np.testing.assert_allclose(capture.tau, TAU, atol=1e-9)


@pytest.mark.parametrize("kind", [str, np.bytes_])
@pytest.mark.parametrize("key", ["units", "unit"])
def test_the_attributes_of_hdf5_say_what_its_numbers_are_in(
    tmp_path: Path, key: str, kind: type[str | bytes]
) -> None:
    """They were passed over: degrees and millinewtonmetres were radians and newtonmetres."""
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        columns = {"time": (1e3 * T, "ms"), "angle": (DEG, "deg"), "torque": (1e3 * TAU, "mNm")}
        for name, (values, unit) in columns.items():
            file.create_dataset(f"run/{name}", data=values).attrs[key] = kind(unit)
    assert_motion(kc.load(path))
    mapped = kc.load(path, map="t=run.time, theta=run.angle, tau=run.torque")
    assert_motion(mapped)
    (said,) = [one.message for one in mapped.findings if one.kind == "columns"]
    assert "theta = run.angle [deg]" in said and "as the file says" in said
    # Who maps another unit knows better.
    other = kc.load(path, map="t=run.time, theta=run.angle [rad], tau=run.torque")
    np.testing.assert_allclose(other.theta, DEG, atol=1e-9)


def test_a_unit_beside_a_name_that_has_another_quantity_is_asked_about(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        for name, values, unit in (("time", T, "s"), ("angle", DEG, "deg"), ("torque", TAU, "A")):
            file.create_dataset(name, data=values).attrs["units"] = unit
    with pytest.raises(InputError, match=r"tau=torque \[A\]"):
        kc.load(path)


def test_the_fields_of_parquet_say_what_their_numbers_are_in(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    columns = {"time": (1e3 * T, "ms"), "angle": (DEG, "deg"), "torque": (1e3 * TAU, "mN m")}
    fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, (_, unit) in columns.items()]
    arrays = [pa.array(values) for values, _ in columns.values()]
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), path)
    assert_motion(kc.load(path))


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
@pytest.mark.parametrize("span", [False, True])
def test_a_date_or_a_span_in_parquet_is_a_clock(tmp_path: Path, unit: str, span: bool) -> None:
    path = tmp_path / "run.parquet"
    ticks = np.round(T * {"ms": 1e3, "us": 1e6, "ns": 1e9}[unit]).astype(np.int64)
    start = 0 if span else 1_700_000_000 * {"ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    kind = pa.duration(unit) if span else pa.timestamp(unit, tz="UTC")
    clock = pa.array(ticks + start).cast(kind)
    pq.write_table(pa.table({"timestamp": clock, "angle_rad": THETA, "torque_Nm": TAU}), path)
    assert_motion(kc.load(path))


def test_a_joint_state_of_a_large_machine_is_in_newton_metres(tmp_path: Path) -> None:
    """So its message defines it (REP 103): no unit is in doubt, and a verdict is given."""
    path = bag(tmp_path / "run.mcap", ["hip"])
    said = [one.message for one in kc.load(path).findings if one.kind == "columns"]
    assert "tau = effort [N m]" in said[0]
    slide = kc.load(path, coordinate="linear")
    assert slide.coordinate == "linear" and slide.units["tau"] == "N"


def test_what_plotjuggler_wrote_of_a_large_machine_is_in_newton_metres(tmp_path: Path) -> None:
    names = "__time,/joint_states/hip/position,/joint_states/hip/effort"
    path = log(tmp_path, names, T, THETA, 3e3 * TAU)
    assert not [one for one in kc.load(path).findings if one.kind == "unit"]
