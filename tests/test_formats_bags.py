"""Bags of ROS 2, sound and damaged, as the package of MCAP's own makers writes them."""

from __future__ import annotations

import sqlite3
import struct
from pathlib import Path
from typing import Any

import mcap_ros2.writer
import numpy as np
import pytest
from command import knobcam, refused
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

import knobcam as kc
from knobcam.errors import InputError

DEFINITION = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
N = 300
T = np.arange(N) / 200.0
THETA = np.sin(7.0 * T)
OMEGA = 7.0 * np.cos(7.0 * T)
TAU = 0.01 * OMEGA + 0.002 * np.sign(OMEGA) + 1e-5 * np.random.default_rng(3).standard_normal(N)
START = 1_700_000_000


def message(index: int, names: list[str], stamped: bool = True, **changed: Any) -> dict[str, Any]:
    at_ns = round(1e9 * T[index])
    stamp = {"sec": START + at_ns // 10**9, "nanosec": at_ns % 10**9} if stamped else {"sec": 0, "nanosec": 0}
    values = {"position": THETA, "velocity": OMEGA, "effort": TAU}
    motion = {
        part: [sign * float(column[index]) for sign in (1.0, -1.0, 0.5)[: len(names)]]
        for part, column in values.items()
    }
    return {"header": {"stamp": stamp, "frame_id": "base"}, "name": names, **motion, **changed}


def bag(
    path: Path,
    names: list[str],
    topics: tuple[str, ...] = ("/joint_states",),
    compression: CompressionType = CompressionType.ZSTD,
    rows: range = range(N),
    **changed: Any,
) -> Path:
    with path.open("wb") as file:
        writer = mcap_ros2.writer.Writer(file, chunk_size=4096, compression=compression)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", DEFINITION)
        words = writer.register_msgdef("std_msgs/msg/String", "string data")
        for index in rows:
            logged = round(1e9 * (START + T[index])) + 1_000_000
            writer.write_message("/rosout", words, {"data": "moving"}, log_time=logged)
            for topic in topics:
                writer.write_message(topic, schema, message(index, names, **changed), log_time=logged)
        writer.finish()
    return path


def as_sqlite(source: Path, path: Path) -> Path:
    """Write the messages of an MCAP bag as rosbag2_storage_sqlite3 does."""
    base = sqlite3.connect(path)
    base.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)"
    )
    base.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
    )
    with source.open("rb") as file:
        for schema, channel, one in make_reader(file).iter_messages():
            assert schema is not None
            topic = (channel.id, channel.topic, schema.name, "cdr")
            base.execute("INSERT OR IGNORE INTO topics VALUES (?, ?, ?, ?)", topic)
            values = (channel.id, one.log_time, one.data)
            base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", values)
    base.commit()
    base.close()
    return path


def assert_motion(capture: kc.Capture, sign: float = 1.0) -> None:
    assert capture.rate_hz == pytest.approx(200.0)
    np.testing.assert_allclose(capture.t, T, atol=2e-9)
    np.testing.assert_array_equal(capture.theta, sign * THETA)
    np.testing.assert_array_equal(capture.omega, sign * OMEGA)
    np.testing.assert_array_equal(capture.tau, sign * TAU)


@pytest.mark.parametrize("compression", list(CompressionType))
def test_the_only_joint_of_a_bag_is_read_exactly(compression: CompressionType, tmp_path: Path) -> None:
    capture = kc.load(bag(tmp_path / "run.mcap", ["knob"], compression=compression))
    assert_motion(capture)
    assert "joint knob of /joint_states; t is its stamp, from 0" in str(capture.findings[0])


def test_a_bag_in_sqlite_is_read_exactly(tmp_path: Path) -> None:
    path = as_sqlite(bag(tmp_path / "run.mcap", ["knob"]), tmp_path / "run.db3")
    assert_motion(kc.load(path))


def test_one_of_several_joints_is_chosen_by_name(tmp_path: Path) -> None:
    path = bag(tmp_path / "run.mcap", ["knee", "hip", "ankle"])
    out = tmp_path / "run.npz"
    refused(knobcam("import", path, "-o", out), "3 joints, ankle, hip, knee; choose one", "--joint ankle")
    refused(
        knobcam("import", path, "-o", out, "--joint", "toe"), "no joint 'toe'; there are ankle, hip, knee"
    )
    assert_motion(kc.load(path, joint="hip"), -1.0)
    assert knobcam("import", path, "-o", out, "--joint", "knee").code == 0
    assert_motion(kc.load(out))


def test_one_joint_in_two_topics_is_named_with_its_topic(tmp_path: Path) -> None:
    path = bag(tmp_path / "run.mcap", ["knob"], topics=("/wanted", "/states"))
    with pytest.raises(InputError, match="2 joints, /states:knob, /wanted:knob"):
        kc.load(path)
    assert_motion(kc.load(path, joint="/states:knob"))


@pytest.mark.parametrize("form", ["mcap", "db3"])
def test_a_folder_of_a_bag_in_parts_is_one_recording(form: str, tmp_path: Path) -> None:
    folder = tmp_path / "rosbag2"
    folder.mkdir()
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {}\n")
    for part, rows in enumerate((range(100), range(100, 200), range(200, N))):
        name = f"rosbag2_{part + 9}"  # the tenth comes behind the ninth
        path = bag(tmp_path / "part.mcap", ["knob"], rows=rows)
        if form == "mcap":
            path.rename(folder / f"{name}.mcap")
        else:
            as_sqlite(path, folder / f"{name}.db3")
    assert_motion(kc.load(folder))


def test_without_stamps_the_time_is_that_of_the_log(tmp_path: Path) -> None:
    capture = kc.load(bag(tmp_path / "run.mcap", ["knob"], stamped=False))
    np.testing.assert_allclose(capture.t, T, atol=2e-7)
    assert "t is when it was logged" in str(capture.findings[0])


def test_a_joint_without_effort_is_refused_with_what_it_has(tmp_path: Path) -> None:
    for effort in ([], [float("nan")]):
        path = bag(tmp_path / "run.mcap", ["knob"], effort=effort)
        with pytest.raises(InputError, match="no column is a torque; the file has t, position, velocity"):
            kc.load(path)


def test_a_bag_without_joints_is_refused_with_its_topics(tmp_path: Path) -> None:
    path = bag(tmp_path / "run.mcap", ["knob"], topics=())
    with pytest.raises(InputError, match=r"no messages of sensor_msgs/JointState; it has /rosout \(std_msgs"):
        kc.load(path)
    with pytest.raises(InputError, match="no bag of ROS 2"):
        base = sqlite3.connect(tmp_path / "other.db")
        base.execute("CREATE TABLE notes(id INTEGER)")
        base.close()
        kc.load(tmp_path / "other.db")
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(100))
    with pytest.raises(InputError, match="a bag of ROS 1; convert it"):
        kc.load(tmp_path / "old.bag")


def test_messages_in_another_encoding_are_refused(tmp_path: Path) -> None:
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", "json", schema)
        writer.add_message(channel, 1, b"{}", 1)
        writer.finish()
    with pytest.raises(InputError, match="is encoded as json, not cdr"):
        kc.load(tmp_path / "run.mcap")


def test_a_bag_that_was_cut_short_is_used_to_there_and_that_is_said(tmp_path: Path) -> None:
    raw = bag(tmp_path / "run.mcap", ["knob"], compression=CompressionType.NONE).read_bytes()
    (tmp_path / "run.mcap").write_bytes(raw[: len(raw) // 2])
    capture = kc.load(tmp_path / "run.mcap")
    assert 50 < capture.samples < N
    assert any(one.kind == "cut" and one.severity == "warning" for one in capture.findings)
    (tmp_path / "run.mcap").write_bytes(raw[:60])
    with pytest.raises(InputError, match="ends before a message"):
        kc.load(tmp_path / "run.mcap")


def test_a_flipped_bit_in_a_chunk_is_noticed(tmp_path: Path) -> None:
    raw = bytearray(bag(tmp_path / "run.mcap", ["knob"], compression=CompressionType.NONE).read_bytes())
    raw[raw.index(struct.pack("<d", THETA[40])) + 3] ^= 1
    (tmp_path / "run.mcap").write_bytes(raw)
    refused(knobcam("import", tmp_path / "run.mcap", "-o", tmp_path / "o.npz"), "run.mcap", "damaged")


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("widest", [8, 4])
def test_messages_of_either_byte_order_and_alignment_are_read(
    order: str, widest: int, tmp_path: Path
) -> None:
    def encoded(index: int) -> bytes:
        body = b""

        def put(form: str, value: float) -> None:
            nonlocal body
            size = struct.calcsize(form)
            body += bytes(-len(body) % min(size, widest)) + struct.pack(order + form, value)

        def text(value: bytes) -> None:
            nonlocal body
            put("I", len(value) + 1)
            body += value + b"\0"

        put("i", START)
        put("I", round(1e9 * T[index]) % 10**9)
        text(b"ba")
        put("I", 1)
        text(b"knob")
        for column in (THETA, OMEGA, TAU):
            put("I", 1)
            put("d", column[index])
        kind = {("<", 8): 1, (">", 8): 0, ("<", 4): 7, (">", 4): 6}[order, widest]
        return bytes([0, kind, 0, 0]) + body

    source = bag(tmp_path / "run.mcap", ["knob"], rows=range(200))
    base = sqlite3.connect(as_sqlite(source, tmp_path / "run.db3"))
    (topic,) = base.execute("SELECT id FROM topics WHERE name = '/joint_states'").fetchone()
    base.execute("DELETE FROM messages")
    for index in range(200):
        base.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", (topic, 1, encoded(index))
        )
    base.commit()
    base.close()
    np.testing.assert_array_equal(kc.load(tmp_path / "run.db3").tau, TAU[:200])


@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
@pytest.mark.parametrize("claimed", [10, 2**40])
def test_a_chunk_that_lies_about_its_size_is_refused(
    claimed: int, compression: CompressionType, tmp_path: Path
) -> None:
    raw = bytearray(bag(tmp_path / "run.mcap", ["knob"], compression=compression).read_bytes())
    at = 8
    while raw[at] != 6:  # the records before the first chunk
        at += 9 + int.from_bytes(raw[at + 1 : at + 9], "little")
    raw[at + 25 : at + 33] = claimed.to_bytes(8, "little")
    (tmp_path / "run.mcap").write_bytes(raw)
    refused(knobcam("import", tmp_path / "run.mcap", "-o", tmp_path / "o.npz"), "run.mcap")
