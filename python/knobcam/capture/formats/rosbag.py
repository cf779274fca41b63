"""Bags of ROS 2: MCAP through the package mcap, SQLite through Python's own, and the folder around either."""

from __future__ import annotations

import dataclasses
import re
import sqlite3
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from ...base.optional import require
from ...base.reading import open_file
from ...base.said import said
from ...errors import InputError
from ..finding import Finding
from . import magic
from .inflate import Budget
from .joint_states import TYPES, JointStates
from .table import Table

_LARGEST_CHUNK = 2**26  # bytes when inflated; recorders write a megabyte or a few
_CUT = "{t}: the bag ends in the middle, as where a recorder was killed; what came before is used"


def files_in(folder: Path) -> list[Path]:
    """Return the parts of a bag in their order."""
    parts = [path for path in folder.iterdir() if path.suffix in (".mcap", ".db3")]
    if not parts:
        held = ", ".join(sorted(path.name for path in folder.iterdir())[:10])
        raise InputError(f"{folder}: a bag without .mcap or .db3 in it ({held}); unpack what is compressed")
    return sorted(parts, key=lambda path: [int(word) for word in re.findall(r"\d+", path.stem)[-1:]])


def read_bag(source: str, paths: list[Path], max_bytes: int, joint: str | None) -> Table:
    """Return the motion of a joint in a bag of one or several files."""
    states = JointStates(source)
    topics: dict[str, str] = {}
    whole = True
    for path in paths:
        with open_file(path) as file:
            is_sqlite = file.read(len(magic.SQLITE)) == magic.SQLITE
        if is_sqlite:
            _read_sqlite(path, states, topics)
        else:
            whole = _read_mcap(path, states, topics, max_bytes) and whole
    if not states.count:
        shown = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(topics.items())[:10]) or "no topics"
        raise InputError(f"{source}: no messages of sensor_msgs/JointState; it has {shown}")
    cut = () if whole else (Finding("cut", "t", 1, (), said(_CUT), "warning"),)
    return states.table("ROS 2 bag", joint, cut)


def _read_mcap(path: Path, states: JointStates, topics: dict[str, str], max_bytes: int) -> bool:
    """Add the messages of a file; return whether it was whole."""
    kinds: dict[int, str] = {}
    channels: dict[int, Any] = {}
    exceptions = require("mcap.exceptions", "an MCAP file")
    records = require("mcap.records", "an MCAP file")
    try:
        for record in _records(path, max_bytes):
            if isinstance(record, records.Schema):
                kinds[record.id] = record.name
            elif isinstance(record, records.Channel):
                channels[record.id] = record
                topics[record.topic] = kinds.get(record.schema_id, "no type")
            elif isinstance(record, records.Message):
                channel = channels[record.channel_id]
                if kinds.get(channel.schema_id) in TYPES:
                    if channel.message_encoding != "cdr":
                        raise InputError(
                            f"{path}: {channel.topic} is encoded as {channel.message_encoding}, not cdr; "
                            f"convert the bag to ROS 2"
                        )
                    states.add(channel.topic, record.log_time, record.data)
    except (exceptions.EndOfFile, struct.error):
        if not states.count:
            raise InputError(f"{path}: the bag ends before a message; copy it again") from None
        return False
    return True


def _records(path: Path, max_bytes: int) -> Iterator[Any]:
    reader = require("mcap.stream_reader", "an MCAP file")
    chunk = require("mcap.records", "an MCAP file").Chunk
    with open_file(path) as file:
        size = path.stat().st_size
        budget, held = Budget(str(path), size, max_bytes), _Bounded(file, size)
        for record in reader.StreamReader(held, emit_chunks=True, record_size_limit=size).records:
            if not isinstance(record, chunk):
                yield record
                continue
            budget.take(record.uncompressed_size)
            if record.uncompressed_size > _LARGEST_CHUNK:
                raise InputError(f"{path}: a chunk of {record.uncompressed_size} bytes; record smaller ones")
            data = _inflated(path, record)
            inside = dataclasses.replace(record, compression="", data=data)
            yield from reader.breakup_chunk(inside, validate_crc=True)


class _Bounded:
    """A file of which no more is asked than it holds: a length in it may be anything."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self.file = file
        self.size = size

    def read(self, count: int) -> bytes:
        """Return the next bytes."""
        return self.file.read(min(count, self.size))


def _inflated(path: Path, chunk: Any) -> bytes:
    """Return the content of a chunk, never more than it says that it has."""
    if chunk.compression == "zstd":
        packer = require("zstandard", "an MCAP file")
        stated = packer.get_frame_parameters(chunk.data).content_size
        if stated > chunk.uncompressed_size and stated < 2**63:  # the largest numbers say that it is unknown
            raise InputError(f"{path}: a chunk of {chunk.uncompressed_size} bytes inflates to {stated}")
        data = packer.ZstdDecompressor().decompress(chunk.data, max_output_size=chunk.uncompressed_size)
    elif chunk.compression == "lz4":
        packer = require("lz4.frame", "an MCAP file")
        data = packer.LZ4FrameDecompressor().decompress(chunk.data, max_length=chunk.uncompressed_size)
    else:
        data = chunk.data
    return bytes(data)


def _read_sqlite(path: Path, states: JointStates, topics: dict[str, str]) -> None:
    base = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)
    try:
        base.execute("PRAGMA trusted_schema = OFF")
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LARGEST_CHUNK)  # a table may compute what is in it
        tables = {name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"topics", "messages"} <= tables:
            raise InputError(f"{path}: an SQLite file that is no bag of ROS 2; export it as CSV")
        kinds = {
            number: (str(name), str(kind), str(form))
            for number, name, kind, form in base.execute(
                "SELECT id, name, type, serialization_format FROM topics"
            )
        }
        topics |= {name: kind for name, kind, _ in kinds.values()}
        for number, logged, data in base.execute("SELECT topic_id, timestamp, data FROM messages"):
            name, kind, form = kinds.get(number, ("", "", ""))
            if kind in TYPES and form == "cdr" and isinstance(data, bytes):
                states.add(name, int(logged), data)
    except MemoryError:  # what SQLite says of a row that claims to be longer than one can be
        raise InputError(f"{path}: a row of it is damaged; copy or export the bag again") from None
    finally:
        base.close()
