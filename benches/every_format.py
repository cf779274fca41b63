"""A sound log in every format that is read, simulated and real: what `study_mutated.py` spoils."""

from __future__ import annotations

import io
import json
import os
import sqlite3
import struct
import tempfile
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

SHARED = Path(os.environ.get("KNOBCAM_SHARED_DATA", Path(__file__).resolve().parents[2] / "shared" / "data"))
MAP = "t=t_s, theta=theta_rad, tau=tau_Nm"
NAMES = ("t_s", "theta_rad", "omega_rad_s", "tau_Nm")
ROWS = 1500

REAL: dict[str, dict[str, Any]] = {
    "emps/DATA_EMPS.mat": {"map": "t=t, theta=qm, tau=35.1507*vir", "coordinate": "linear"},
    "odrive_cogging/slow2_slower_nocomp_0.npy": {"map": "t=c0, theta=c1/8192 [turn], tau=0.0551*c2"},
    "laas_motor/acc_current.txt": {"map": "t=Time, theta=Position, omega=Velocity, tau=Iq"},
    "dfki_pendulum/pd_system_identification.csv": {},
    "bam_xl330/2026-01-15_10h28m10.json": {"map": "t=timestamp, theta=position, tau=0.1*duty*input_volts"},
}
"""Real files in the shared folder, with what reads them."""

Source = tuple[bytes, dict[str, Any]]
"""Content of a file, and the options that read it when it is sound."""


def sources(real: bool = True) -> dict[str, Source]:
    """Return a sound file of every format, by its name, and the real ones where they are."""
    found: dict[str, Source] = {}
    if real:
        for name, options in REAL.items():
            if (SHARED / name).is_file():
                found[name] = ((SHARED / name).read_bytes(), options)
    run = kc.simulate(kc.Model.load("knob4"), duration_s=ROWS / 5000.0, seed=1)
    omega = np.gradient(run.theta, run.t)
    columns = dict(zip(NAMES, (run.t, run.theta, omega, run.tau), strict=True))
    with tempfile.TemporaryDirectory() as folder:
        for name in ("npz", "csv", "csv.gz", "mat", "h5", "parquet"):
            found[f"native.{name}"] = (run.save(Path(folder) / f"run.{name}").read_bytes(), {})
        found["bag.db3"] = (_sqlite(Path(folder) / "run.db3", run), {"joint": "knob"})
    found |= {name: (content.encode(), options) for name, (content, options) in _texts(columns).items()}
    found |= {name: (content, options) for name, (content, options) in _arrays(columns).items()}
    found |= {f"bag.{kind.name}.mcap": (_mcap(run, kind), {"joint": "knob"}) for kind in CompressionType}
    found["rig.kcwire"] = (_wire(), {})
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
    lines = rows(time=t, position=theta, torque=tau)
    return {
        "units.csv": (table(["time_ms", "pos_deg", "torque_mNm"], 1e3 * t, np.rad2deg(theta), 1e3 * tau), {}),
        "semicolons.csv": (table(list(columns), *columns.values(), sep=";").replace(".", ","), {}),
        "moteus.csv": (table(registers, t, 10 + 0 * t, *turns, tau, 0 * t), {}),
        "odrive.csv": (table(odrive, t, *turns, tau), {}),
        "monitor.txt": (
            table([], 0 * t, tau, omega, theta, sep="\t"),
            {"map": "theta=c3, omega=c2, tau=c1", "rate_hz": 5000.0},
        ),
        "lines.jsonl": ("\n".join(map(json.dumps, lines)), {}),
        "rows.json": (json.dumps({"rig": 1.0, "samples": lines}), {}),
        "arrays.json": (json.dumps({name: values.tolist() for name, values in columns.items()}), {}),
        "tview.jsonl": ("\n".join(map(json.dumps, stats)), {}),
        "bam.json": (
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
        "matrix.npy": (written(lambda file: np.save(file, matrix)), {"map": "t=c0, theta=c1, tau=c3"}),
        "arrays.npz": (written(lambda file: np.savez_compressed(file, **columns)), {}),  # type: ignore[arg-type]
        "version5.mat": (
            written(lambda file: scipy.io.savemat(file, {"run": columns}, do_compression=True)),
            {"map": f"{inside}, tau=run.tau_Nm"},
        ),
        "version73.mat": (written(hdf5), {"map": f"{inside}, tau=run.tau_Nm"}),
        "foreign.parquet": (written(lambda file: pq.write_table(arrow, file, compression="snappy")), {}),
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


def _wire() -> bytes:
    from knobcam.rig.emulator import EmulatedRig

    with tempfile.TemporaryDirectory() as folder, EmulatedRig(speed=5.0) as rig:
        path = Path(folder) / "run.kcwire"
        kc.record(rig.port, "hand", duration_s=0.3, output=path)
        return path.read_bytes()
