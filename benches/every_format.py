"""A sound file of every format that is read, simulated and real: what `study_mutated.py` spoils."""

from __future__ import annotations

import io
import json
import os
import sqlite3
import struct
import tempfile
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

import knobcam as kc
from knobcam import _core
from knobcam.capture.formats.wire import header_line
from knobcam.rig.calibration import Calibration
from knobcam.workbench import journal

SHARED = Path(os.environ.get("KNOBCAM_SHARED_DATA", Path(__file__).resolve().parents[2] / "shared" / "data"))
_FRAMES = Path(__file__).resolve().parents[1] / "tests" / "wire" / "vectors.toml"
MAP = "t=t_s, theta=theta_rad, tau=tau_Nm"
NAMES = ("t_s", "theta_rad", "omega_rad_s", "tau_Nm")
ROWS = 400

REAL: dict[str, tuple[str, dict[str, Any]]] = {
    "mat/emps": (
        "emps/DATA_EMPS.mat",
        {"map": "t=t, theta=qm, tau=35.1507*vir", "coordinate": "linear"},
    ),
    "npy/odrive": (
        "odrive_cogging/slow2_slower_nocomp_0.npy",
        {"map": "t=c0, theta=c1/8192 [turn], tau=0.0551*c2"},
    ),
    "csv/laas": (
        "laas_motor/acc_current.txt",
        {"map": "t=Time, theta=Position, omega=Velocity, tau=Iq"},
    ),
    "csv/dfki": ("dfki_pendulum/pd_system_identification.csv", {}),
    "json/bam": (
        "bam_xl330/2026-01-15_10h28m10.json",
        {"map": "t=timestamp, theta=position, tau=0.1*duty*input_volts"},
    ),
}
"""Real files in the shared folder, with what reads them."""
_UNDATED = b"MATLAB 5.0 MAT-file".ljust(116)
NATIVE = {"npz": "npz", "csv": "csv", "csv.gz": "csv.gz", "mat": "mat", "h5": "hdf5", "parquet": "parquet"}
"""Endings of captures, with their formats."""

Source = tuple[bytes, dict[str, Any]]
"""Content of a file, and the options that read it when it is sound."""


def sources(real: bool = True, rows: int = ROWS) -> dict[str, Source]:
    """Return sound files by `FORMAT/NAME`; with `real` also real ones, where they are, as any log."""
    run = kc.simulate(kc.Model.load("knob4"), duration_s=rows / 5000.0, seed=1)
    omega = np.gradient(run.theta, run.t)
    columns = dict(zip(NAMES, (run.t, run.theta, omega, run.tau), strict=True))
    found = {name: (content.encode(), options) for name, (content, options) in _texts(columns).items()}
    found |= _arrays(columns) | _logs("", run) | settings()
    for name, (path, options) in REAL.items() if real else ():
        if (SHARED / path).is_file():
            found[name] = ((SHARED / path).read_bytes(), options)
            found |= _logs(f"-{name.partition('/')[2]}", _first(kc.load(SHARED / path, **options), rows))
    return found


def _first(log: kc.Capture, rows: int) -> kc.Capture:
    """The start of a log, with its numbers as they are."""
    return kc.Capture.from_arrays(
        t=log.t[:rows], theta=log.theta[:rows], tau=log.tau[:rows], coordinate=log.coordinate
    )


def _logs(whose: str, run: kc.Capture) -> dict[str, Source]:
    """Return a log in the formats that every log can have."""
    found: dict[str, Source] = {}
    with tempfile.TemporaryDirectory() as folder:
        for ending, kind in NATIVE.items():
            found[f"{kind}/native{whose}"] = (run.save(Path(folder) / f"run.{ending}").read_bytes(), {})
        found[f"db3/bag{whose}"] = (_sqlite(Path(folder) / "run.db3", run), {"joint": "knob"})
    for kind in CompressionType:
        found[f"mcap/{kind.name}{whose}"] = (_mcap(run, kind), {"joint": "knob"})
    found[f"kcwire/rig{whose}"] = (_wire(run), {})
    lines = [
        {"time": t, "position": theta, "torque": tau}
        for t, theta, tau in zip(run.t.tolist(), run.theta.tolist(), run.tau.tolist(), strict=True)
    ]
    found[f"jsonl/lines{whose}"] = ("\n".join(map(json.dumps, lines)).encode(), {})
    found[f"json/rows{whose}"] = (json.dumps({"rig": 1.0, "samples": lines}).encode(), {})
    with io.BytesIO() as file:
        np.save(file, np.stack([run.t, run.theta, run.tau]))
        found[f"npy/matrix{whose}"] = (file.getvalue(), {"map": "t=c0, theta=c1, tau=c2"})
    return found


def settings() -> dict[str, Source]:
    """Return what is no log: models, a calibration and the journal of a session."""
    fitted = kc.fit(kc.simulate("knob3", duration_s=0.5, seed=1)).model
    models = {name: kc.Model.load(name) for name in ("knob3", "knob5")} | {"fitted": fitted}
    many = fitted.with_effect("stribeck").with_effect("compliance").with_effect("return_spring")
    models["many"] = many
    found: dict[str, Source] = {f"model/{name}": (one.text().encode(), {}) for name, one in models.items()}
    tested = Calibration(
        "KNOB-1", "2026-11-23T12:00:00+00:00", 101.5, 0.25, (101.0, 102.0), 1e-5, tau_sd_Nm=1e-4
    )
    node = {"id": "n1", "after": None, "how": "fitted", "effect": None, "captures": ["c1"], "onward": False}
    branch = {"id": "b1", "name": "first", "steps": ["n1"], "at": 0, "dragged": {"viscous.pos": 0.01}}
    capture = {"id": "c1", "name": "a.npz", "path": "/a.npz", "made": "", "options": {}, "sha256": "0" * 64}
    records: list[dict[str, Any]] = [
        {"schema": journal.SCHEMA, "start": {"model": None, "name": "", "options": {}}, "time": 1.8e9},
        {"capture": capture | {"hidden": [], "simulated": None}},
        {"node": node | {"p_value": None, "equivalent": [], "rmse": 0.004, "model": fitted.text()}},
        {"place": {"branches": [branch], "branch": "b1", "made": 3, "looked": None}, "time": 1.8e9},
    ]
    with tempfile.TemporaryDirectory() as folder:
        found["calibration/tested"] = (tested.save(Path(folder) / "tested.toml").read_bytes(), {})
    found["session/journal"] = (b"".join(map(journal.line, records)), {})
    return found


def _texts(columns: dict[str, np.ndarray]) -> dict[str, tuple[str, dict[str, Any]]]:
    t, theta, omega, tau = columns.values()
    turns = (theta / (2.0 * np.pi), omega / (2.0 * np.pi))

    def table(names: list[str], *parts: np.ndarray, sep: str = ",") -> str:
        rows = [sep.join(f"{cell:.9g}" for cell in row) for row in zip(*parts, strict=True)]
        return "\n".join([*([sep.join(names)] if names else []), *rows]) + "\n"

    def rows(**parts: np.ndarray) -> list[dict[str, float]]:
        return [dict(zip(parts, map(float, row), strict=True)) for row in zip(*parts.values(), strict=True)]

    registers = ["time", "MODE", "POSITION", "VELOCITY", "TORQUE", "FAULT"]
    odrive = ["time", "axis0.pos_estimate", "axis0.vel_estimate", "axis0.motor.torque_estimate"]
    measured = rows(position=turns[0], velocity=turns[1], torque_Nm=tau, q_A=tau, d_A=tau)
    stats = [
        {"controller": "1", "timestamp": float(stamp), "channel": "servo_stats", "data": one}
        for stamp, one in zip(t, measured, strict=True)
    ]
    servo = rows(position=theta, speed=omega, load=np.round(885 * tau) % 65536, input_volts=7.4 + 0 * t)
    entries = [
        one | {"timestamp": float(stamp), "goal_position": 0.0, "torque_enable": True}
        for stamp, one in zip(t, servo, strict=True)
    ]
    return {
        "csv/units": (table(["time_ms", "pos_deg", "torque_mNm"], 1e3 * t, np.rad2deg(theta), 1e3 * tau), {}),
        "csv/semicolons": (table(list(columns), *columns.values(), sep=";").replace(".", ","), {}),
        "csv/moteus": (table(registers, t, 10 + 0 * t, *turns, tau, 0 * t), {}),
        "csv/odrive": (table(odrive, t, *turns, tau), {}),
        "csv/monitor": (
            table([], 0 * t, tau, omega, theta, sep="\t"),
            {"map": "theta=c3, omega=c2, tau=c1", "rate_hz": 5000.0},
        ),
        "json/arrays": (json.dumps({name: values.tolist() for name, values in columns.items()}), {}),
        "jsonl/tview": ("\n".join(map(json.dumps, stats)), {}),
        "json/entries": (
            json.dumps({"motor": "xl330", "kp": 100, "entries": entries}),
            {"map": "t=timestamp, theta=position, tau=0.1*duty*input_volts"},
        ),
    }


def _arrays(columns: dict[str, np.ndarray]) -> dict[str, Source]:
    matrix = np.stack(list(columns.values()))

    def written(write: Callable[[io.BytesIO], object]) -> bytes:
        file = io.BytesIO()
        write(file)
        return file.getvalue()

    def hdf5(file: io.BytesIO) -> None:
        with h5py.File(file, "w", userblock_size=512) as inside:
            for name, values in columns.items():
                inside.create_dataset(f"run/{name}", data=values, compression="gzip", chunks=(256,))

    inside = ", ".join(f"{target}=run.{name}" for target, name in zip(("t", "theta"), NAMES, strict=False))
    arrow = pa.table({name: pa.array(values) for name, values in columns.items()})
    return {
        "npy/wide": (written(lambda file: np.save(file, matrix)), {"map": "t=c0, theta=c1, tau=c3"}),
        "npz/arrays": (written(lambda file: np.savez_compressed(file, **columns)), {}),  # type: ignore[arg-type]
        "mat/version5": (
            _UNDATED
            + written(lambda file: scipy.io.savemat(file, {"run": columns}, do_compression=True))[116:],
            {"map": f"{inside}, tau=run.tau_Nm"},
        ),
        "hdf5/version73": (written(hdf5), {"map": f"{inside}, tau=run.tau_Nm"}),
        "parquet/foreign": (written(lambda file: pq.write_table(arrow, file, compression="snappy")), {}),
    }


def _message(stamp_ns: int, values: tuple[float, ...]) -> bytes:
    """A JointState of one joint, little-endian CDR, where each list of one number begins at 4 modulo 8."""
    seconds, rest = divmod(stamp_ns, 10**9)
    head = struct.pack("<iII4sII5s3x", seconds, rest, 4, b"arm", 1, 5, b"knob")
    return b"\0\1\0\0" + head + b"".join(struct.pack("<I4xd", 1, value) for value in values)


def _messages(run: kc.Capture) -> list[tuple[int, bytes]]:
    omega = np.gradient(run.theta, run.t)
    stamps = [10**18 + round(1e9 * stamp) for stamp in run.t]
    motion = zip(run.theta, omega, run.tau, strict=True)
    return [(stamp, _message(stamp, values)) for stamp, values in zip(stamps, motion, strict=True)]


def _mcap(run: kc.Capture, kind: CompressionType) -> bytes:
    file = io.BytesIO()
    writer = McapWriter(file, chunk_size=16384, compression=kind)
    writer.start(profile="ros2")
    schema = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", b"float64[] position")
    channel = writer.register_channel("/joint_states", "cdr", schema)
    for stamp, message in _messages(run):
        writer.add_message(channel, stamp, message, stamp)
    writer.finish()
    return file.getvalue()


def _sqlite(path: Path, run: kc.Capture) -> bytes:
    base = sqlite3.connect(path)
    base.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)"
    )
    base.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
    )
    base.execute("INSERT INTO topics VALUES (1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr')")
    rows = [(1, stamp, message) for stamp, message in _messages(run)]
    base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", rows)
    base.commit()
    base.close()
    return path.read_bytes()


def _wire(run: kc.Capture) -> bytes:
    """A log as the rig of the wire protocol's examples would have made it, with readings as large as its."""
    examples = [one["message"] for one in tomllib.loads(_FRAMES.read_text("utf-8"))["frame"]]
    descriptor = next(one for one in examples if one["type"] == "DESCRIPTOR")
    counts = np.rint((run.theta - run.theta[0]) * descriptor["device"]["counts_per_rad"])
    readings = (np.gradient(run.theta), np.gradient(np.gradient(run.theta)), run.tau)
    raw = [np.rint(20_000.0 * one / np.abs(one).max()) for one in readings]
    samples = [
        dict(zip(("count", "omega", "alpha", "tau"), map(int, row), strict=True))
        for row in zip(counts, *raw, strict=True)
    ]
    ended = {"type": "STOPPED", "run": 1, "produced": len(samples), "sent": len(samples)}
    parts = [(first, samples[first : first + 25]) for first in range(0, len(samples), 25)]
    messages = [
        (0, descriptor),
        (0, {"type": "STARTED", "run": 1, "first": 0}),
        *((first, {"type": "DATA", "run": 1, "samples": part}) for first, part in parts),
        (len(samples), ended),
    ]
    frames = [_core.wire_encode(message, index, 200 * index) for index, message in messages]
    return header_line({}) + b"".join(frames)
