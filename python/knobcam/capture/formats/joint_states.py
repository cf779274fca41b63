"""`sensor_msgs/JointState` in its CDR bytes, and the motion of each joint that a bag of them holds.

The layout is that of the message's definition (ROS common_interfaces) in the Common Data Representation (OMG
DDS-RTPS 2.5, section 10; XTypes 1.3, section 7.4.1). It is read here, without the definition that an MCAP
file has and an SQLite one may not have, so that every length is held against what is there.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import FloatArray
from ...base.said import said
from ...errors import InputError
from ..finding import Finding
from .table import Table, choose

TYPES = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")
"""Names of the message."""

_ORDERS = {0: (">", 8), 1: ("<", 8), 6: (">", 4), 7: ("<", 4)}  # encapsulation: byte order, largest alignment
_NS = 1e-9
_PARTS = ("position", "velocity", "effort")


class _Reader:
    """Reads the parts of a message one after the other; struct.error where it ends early."""

    def __init__(self, data: bytes) -> None:
        if len(data) < 4 or data[1] not in _ORDERS:
            raise InputError("a JointState in an encoding that is not CDR")
        self.data = data
        self.at = 4
        self.order, self.widest = _ORDERS[data[1]]

    def _align(self, size: int) -> None:
        self.at += -(self.at - 4) % min(size, self.widest)

    def whole(self, kind: str = "I") -> int:
        self._align(4)
        (value,) = struct.unpack_from(self.order + kind, self.data, self.at)
        self.at += 4
        return int(value)

    def text(self) -> str:
        size = self.whole()
        if size > len(self.data) - self.at:
            raise struct.error(f"a text of {size} bytes")
        found = self.data[self.at : self.at + size].rstrip(b"\0").decode("utf-8", "replace")
        self.at += size
        return found

    def texts(self) -> list[str]:
        count = self.whole()
        if count > (len(self.data) - self.at) // 4:
            raise struct.error(f"{count} names")
        return [self.text() for _ in range(count)]

    def numbers(self) -> tuple[float, ...]:
        count = self.whole()
        if count == 0:
            return ()
        self._align(8)
        if count > (len(self.data) - self.at) // 8:
            raise struct.error(f"{count} numbers")
        found = struct.unpack_from(f"{self.order}{count}d", self.data, self.at)
        self.at += 8 * count
        return found


@dataclass
class _Joint:
    stamps: array[int] = field(default_factory=lambda: array("q"))
    logged: array[int] = field(default_factory=lambda: array("q"))
    parts: Mapping[str, array[float]] = field(default_factory=lambda: {name: array("d") for name in _PARTS})


class JointStates:
    """The messages of a bag, sorted into topics and joints."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.count = 0
        self.joints: dict[tuple[str, str], _Joint] = {}

    def add(self, topic: str, logged_ns: int, data: bytes) -> None:
        """Add a message; InputError where its bytes are no JointState."""
        self.count += 1
        try:
            reader = _Reader(data)
            stamp = reader.whole("i") * 10**9 + reader.whole()
            reader.text()  # frame_id
            names = reader.texts()
            values = [reader.numbers() for _ in _PARTS]
        except (struct.error, InputError) as error:
            raise InputError(
                f"{self.source}: message {self.count} of {topic} is damaged ({error}); record again"
            ) from error
        for index, name in enumerate(names):
            joint = self.joints.setdefault((topic, name), _Joint())
            joint.stamps.append(stamp)
            joint.logged.append(min(logged_ns, 2**63 - 1))
            for part, numbers in zip(_PARTS, values, strict=True):
                joint.parts[part].append(numbers[index] if index < len(numbers) else float("nan"))

    def table(self, kind: str, asked: str | None, notes: tuple[Finding, ...] = ()) -> Table:
        """Return the motion of the joint that was asked for, or of the only one."""
        if not self.joints:
            raise InputError(f"{self.source}: its messages of joints are empty; record them again")
        topics = {topic for topic, _ in self.joints}
        known = {
            name if len(topics) == 1 else f"{topic}:{name}": (topic, name) for topic, name in self.joints
        }
        topic, name = known[choose(self.source, asked, known)]
        joint = self.joints[topic, name]
        stamps = np.array(joint.stamps, dtype=np.int64)
        stamped = bool(stamps[0] > 0 and stamps[-1] > stamps[0])
        stamps = stamps if stamped else np.array(joint.logged, dtype=np.int64)
        columns: dict[str, FloatArray] = {"t": _NS * (stamps - stamps[0]).astype(np.float64)}
        for part, values in joint.parts.items():
            column = np.array(values)
            if np.isfinite(column).any():  # what a joint does not have is left empty, or not a number
                columns[part] = column
        found = said(
            "joint {name} of {topic}; {t} is {stamp}, from 0",
            name=name,
            topic=topic,
            stamp="its stamp" if stamped else "when it was logged",
        )
        note = Finding("joint", "t", len(stamps), (), found, "note")
        return Table(self.source, f"{kind}, {topic} {name}", columns, si=True, notes=(note, *notes))
