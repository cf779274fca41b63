"""Makes `vectors.toml` from what docs/wire-protocol.md says, with nothing of knobcam.

It is a second implementation of the document, without any code of the first.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

VECTORS = Path(__file__).with_name("vectors.toml")

CHANNEL = "ff B hh"
DESCRIPTOR = f"16s HH dd {CHANNEL} {CHANNEL} {CHANNEL} ffffff HH II B H"
LAYOUTS = {
    "PING": (0x01, ""),
    "DESCRIBE": (0x02, ""),
    "START": (0x03, "I"),
    "STOP": (0x04, ""),
    "EXCITE": (0x05, "III"),
    "MODEL": (0x06, "III"),
    "ARM": (0x07, "Bff"),
    "DISARM": (0x08, ""),
    "HEARTBEAT": (0x09, ""),
    "TORQUE": (0x0A, "f"),
    "CLEAR": (0x0B, ""),
    "DESCRIPTOR": (0x81, DESCRIPTOR),
    "DATA": (0x82, "H"),
    "STARTED": (0x83, "HI"),
    "STOPPED": (0x84, "HII"),
    "STATUS": (0x85, "BfH"),
    "ACK": (0x86, "I"),
    "NAK": (0x87, "IH"),
    "FAULT": (0x88, "H"),
    "PONG": (0x89, "I"),
}
"""Number and fixed part of the body of each message."""
LISTS = {"points": "dff", "samples": "ihhh", "bytes": "B"}
"""Layout of an item of what fills the rest of a body."""
CHOICES = {
    "unit": ["absent", "rad_per_second", "volt", "newton_metre"],
    "mode": ["drive", "render", "render_driven", "commanded"],
    "state": ["idle", "recording", "armed", "rendering", "fault"],
}


def stuff(plain: bytes) -> bytes:
    """COBS: every zero byte becomes the distance to the next; a run of 254 others has none at its end."""
    blocks = plain.split(b"\0")
    out = bytearray()
    for place, block in enumerate(blocks):
        at = 0
        while len(block) - at >= 254:
            out += b"\xff" + block[at : at + 254]
            at += 254
        if at and at == len(block) and place == len(blocks) - 1:
            break
        out += bytes([len(block) - at + 1]) + block[at:]
    return bytes(out)


def numbers(name: str, value: Any) -> Iterable[Any]:
    """The value, a record's values or a choice's number, in the order of the layout."""
    if isinstance(value, dict):
        for inner, part in value.items():
            yield from numbers(inner, part)
    elif name in CHOICES:
        yield CHOICES[name].index(value)
    else:
        yield value.encode() if name == "serial" else value


def packed(name: str, items: list[Any]) -> bytes:
    """The items of a list, one after another."""
    each = (item.values() if isinstance(item, dict) else [item] for item in items)
    return b"".join(struct.pack("<" + LISTS[name], *values) for values in each)


def frame(sequence: int, time_us: int, message: dict[str, Any]) -> bytes:
    """The bytes of a frame on the wire."""
    kind, fixed = LAYOUTS[message["type"]]
    plain = struct.pack("<BBIQ", 1, kind, sequence, time_us)
    fields = {name: value for name, value in message.items() if name != "type"}
    rest = fields.pop("text", "").encode()
    for name in [name for name, value in fields.items() if isinstance(value, list)]:
        rest += packed(name, fields.pop(name))
    values = [number for name, value in fields.items() for number in numbers(name, value)]
    plain += struct.pack("<" + fixed, *values) + rest
    return stuff(plain + struct.pack("<I", zlib.crc32(plain))) + b"\0"


def upload(kind: str, **content: Any) -> dict[str, Any]:
    """A motion or a model that fits one chunk."""
    [(name, items)] = content.items()
    return {
        "type": kind,
        "total": len(items),
        "first": 0,
        "check": zlib.crc32(packed(name, items)),
        name: items,
    }


def channel(scale: float, unit: str) -> dict[str, Any]:
    """A channel of the rig of the examples."""
    return {"scale": scale, "offset": 0.0, "unit": unit, "lower": -32000, "upper": 32000}


DEVICE = {
    "serial": "KC-0007",
    "firmware_major": 1,
    "firmware_minor": 2,
    "rate_hz": 5000.0,
    "counts_per_rad": 102400.0,
    "omega": channel(2**-10, "rad_per_second"),
    "alpha": channel(2**-13, "volt") | {"offset": -0.25},
    "tau": channel(2**-16, "newton_metre"),
    "c_cal": 512.0,
    "torque_limit": 0.5,
    "torque_rate_limit": 250.0,
    "inertia": 2**-16,
    "damping": 2**-15,
    "anchor_stiffness": 16.0,
    "delay_samples": 2,
    "heartbeat_ms": 100,
    "motion_capacity": 300000,
    "model_capacity": 65536,
    "window": 4,
    "capabilities": 31,
}
SAMPLES = [
    {"count": 257 * i - 3000, "omega": 1000 - 80 * i, "alpha": -(i**2), "tau": 17 * i} for i in range(25)
]
FULL = [{"count": 0x01020304 + i, "omega": 0x0101, "alpha": -1, "tau": 0x0202} for i in range(25)]
EDGES = [
    {"count": 2**31 - 1, "omega": 32767, "alpha": -32767, "tau": -32768},
    {"count": -(2**31), "omega": 0, "alpha": 0, "tau": 0},
]
POINTS = [
    {"theta": 0.0, "omega": 0.0, "alpha": 50.0},
    {"theta": 1e-06, "omega": 0.0078125, "alpha": 49.5},
    {"theta": -4e-06, "omega": -0.015625, "alpha": -49.0},
]
ABSENT = {"scale": 0.0, "offset": 0.0, "unit": "absent", "lower": 0, "upper": 0}
LIMITS = {"torque_limit": 0.25, "torque_rate_limit": 100.0}
MESSAGES: list[tuple[str, int, int, dict[str, Any]]] = [
    ("ping", 1, 0, {"type": "PING"}),
    ("describe", 2, 1000, {"type": "DESCRIBE"}),
    ("start a counted run", 3, 2000, {"type": "START", "samples": 25000}),
    ("start until stop", 4, 3000, {"type": "START", "samples": 0}),
    ("stop", 5, 4000, {"type": "STOP"}),
    ("excite, a whole motion", 6, 5000, upload("EXCITE", points=POINTS)),
    ("excite, a later chunk", 7, 6000, upload("EXCITE", points=POINTS) | {"first": 2, "points": POINTS[2:]}),
    ("model, a whole file", 8, 7000, upload("MODEL", bytes=list(b'name = "knob"\n'))),
    ("model, the longest chunk", 9, 8000, upload("MODEL", bytes=[1 + i % 255 for i in range(994)])),
    *(
        (f"arm, {mode}", 10 + place, 9000, {"type": "ARM", "mode": mode, **LIMITS})
        for place, mode in enumerate(CHOICES["mode"])
    ),
    ("disarm", 14, 10_000, {"type": "DISARM"}),
    ("heartbeat", 15, 11_000, {"type": "HEARTBEAT"}),
    ("torque", 16, 12_000, {"type": "TORQUE", "torque": -0.125}),
    ("clear", 2**32 - 1, 2**62, {"type": "CLEAR"}),
    ("descriptor", 0, 1_500_000, {"type": "DESCRIPTOR", "device": DEVICE}),
    (
        "descriptor of a rig without a torque sensor, serial number in full",
        77,
        1_600_000,
        {"type": "DESCRIPTOR", "device": DEVICE | {"serial": "KC-0123456789ABC", "tau": ABSENT}},
    ),
    ("data, 25 samples", 10_000, 2_000_000, {"type": "DATA", "run": 41, "samples": SAMPLES}),
    ("data that end with a full block", 10_025, 2_005_000, {"type": "DATA", "run": 41, "samples": FULL}),
    ("data at the edges of its numbers", 2**32 - 1, 1, {"type": "DATA", "run": 65535, "samples": EDGES}),
    ("started", 9_975, 1_995_000, {"type": "STARTED", "run": 41, "first": 9_975}),
    ("stopped", 34_975, 6_995_000, {"type": "STOPPED", "run": 41, "produced": 25000, "sent": 24950}),
    ("status", 34_975, 6_995_100, {"type": "STATUS", "state": "idle", "temperature": 36.5, "flags": 3}),
    (
        "status without a thermometer",
        34_980,
        6_996_000,
        {"type": "STATUS", "state": "rendering", "temperature": float("nan"), "flags": 12},
    ),
    ("acknowledged", 34_975, 6_995_200, {"type": "ACK", "command": 3}),
    ("refused", 34_990, 6_998_000, {"type": "NAK", "command": 9, "code": 2, "text": "not while recording"}),
    ("fault", 40_000, 8_000_000, {"type": "FAULT", "code": 1, "text": "no heartbeat for 100 ms"}),
    ("fault without words", 40_000, 8_000_000, {"type": "FAULT", "code": 256, "text": ""}),
    ("pong", 40_001, 8_000_200, {"type": "PONG", "command": 1}),
]


def toml(value: Any) -> str:
    """A value as TOML writes it in one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {toml(part)}" for name, part in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml(part) for part in value) + "]"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(value)


def vectors() -> str:
    """The text of the file."""
    head = "# Frames of docs/wire-protocol.md, byte for byte; made by make_vectors.py.\n"
    return head + "".join(
        f"\n[[frame]]\nname = {toml(name)}\nsequence = {sequence}\ntime_us = {time_us}\n"
        f"message = {toml(message)}\nhex = {toml(frame(sequence, time_us, message).hex())}\n"
        for name, sequence, time_us, message in MESSAGES
    )


if __name__ == "__main__":
    VECTORS.write_text(vectors())
