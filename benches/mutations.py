"""What can happen to a file: functions of its bytes and random numbers, so that a seed makes it again."""

from __future__ import annotations

import gzip
import io
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from every_format import MAP, NAMES, Source

MAGICS = (
    *(
        b"\x1f\x8b\x08",
        b"\x93NUMPY\x01\0",
        b"PK\x03\x04",
        b"MATLAB 5.0 MAT-file",
        b"\x89HDF\r\n\x1a\n",
        b"PAR1",
    ),
    *(
        b"\x89MCAP0\r\n",
        b"SQLite format 3\0",
        b"knobcam wire log\n",
        b"{",
        b"[{",
        b"\xff\xfe",
        b"#ROSBAG V2.0",
    ),
)
_LONGEST = 2**23
_QUICK = 1
EXTREMES = (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 2**40, 2**63 - 1, 2**64 - 1)
CELLS = (
    "",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "1e-320",
    "x",
    "'",
    '"',
    "9" * 400,
    "0x1F",
    "1,5",
    "é",
    "\0",
    "true",
)


def _flips(raw: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 1, 4, 40))):
        raw[rng.randrange(len(raw))] ^= 1 << rng.randrange(8)
    return bytes(raw)


def _head_flips(raw: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 4))):
        raw[rng.randrange(min(len(raw), 600))] = rng.randrange(256)
    return bytes(raw)


def _tail_flips(raw: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 4))):
        raw[-1 - rng.randrange(min(len(raw), 600))] = rng.randrange(256)
    return bytes(raw)


def _extreme(raw: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 3))):
        size = rng.choice((1, 2, 4, 8))
        at = rng.randrange(min(len(raw), rng.choice((256, 4096, len(raw)))))
        value = rng.choice(EXTREMES) % 256**size
        raw[at : at + size] = value.to_bytes(size, rng.choice(("little", "big")))
    return bytes(raw)


def _span(raw: bytearray, rng: random.Random) -> tuple[int, int]:
    start = rng.randrange(len(raw))
    return start, min(len(raw), start + 1 + int(len(raw) ** rng.random()))


def _blank(raw: bytearray, rng: random.Random) -> bytes:
    start, end = _span(raw, rng)
    raw[start:end] = rng.choice((b"\0", b"\xff", b" ")) * (end - start)
    return bytes(raw)


def _noise(raw: bytearray, rng: random.Random) -> bytes:
    start, end = _span(raw, rng)
    raw[start:end] = rng.randbytes(end - start)
    return bytes(raw)


def _cut_out(raw: bytearray, rng: random.Random) -> bytes:
    start, end = _span(raw, rng)
    return bytes(raw[:start] + raw[end:])


def _again(raw: bytearray, rng: random.Random) -> bytes:
    start, end = _span(raw, rng)
    return bytes(raw[:end] + raw[start:])


def _truncated(raw: bytearray, rng: random.Random) -> bytes:
    return bytes(raw[: rng.randrange(len(raw))])


def _doubled(raw: bytearray, rng: random.Random) -> bytes:
    return bytes(raw) * rng.choice((2, 2, 5))


def _magic(raw: bytearray, rng: random.Random) -> bytes:
    magic = rng.choice(MAGICS)
    return magic + bytes(raw[len(magic) if rng.random() < 0.5 else 0 :])


def _giant(raw: bytearray, rng: random.Random) -> bytes:
    at = rng.randrange(len(raw))
    field = rng.choice((b"9", b"x", b",", b"[", b'{"a":', b"-", b"\t", b"(", b'"', b"\n")) * rng.choice(
        (300, 200_000)
    )
    return bytes(raw[:at] + field + raw[at:])


def _packed(raw: bytearray, rng: random.Random) -> bytes:
    packed = bytearray(gzip.compress(bytes(raw), _QUICK))
    return _flips(packed, rng) if rng.random() < 0.5 else bytes(packed)


def _repacked(raw: bytearray, rng: random.Random) -> bytes:
    """A sound file inside gzip that was spoiled before it was packed."""
    try:
        inside = bytearray(gzip.decompress(bytes(raw)))
    except (OSError, EOFError, zlib.error):
        inside = raw
    return gzip.compress(_text(inside, rng) if inside else b"", _QUICK)


def _text(raw: bytearray, rng: random.Random) -> bytes:
    """What goes wrong with lines and cells; of a file that is no text, whatever looks like one."""
    lines = bytes(raw).split(b"\n")
    separator = next(
        (mark for mark in (b"\t", b";", b",") if mark in lines[-2 if len(lines) > 1 else 0]), b","
    )
    kind = rng.randrange(8)
    some = [rng.randrange(len(lines)) for _ in range(rng.choice((1, 3, len(lines) // 3 + 1)))]
    if kind == 0:  # cells
        for at in some:
            cells = lines[at].split(separator)
            cells[rng.randrange(len(cells))] = rng.choice(CELLS).encode()
            lines[at] = separator.join(cells)
    elif kind == 1:  # a column that trades places with another
        one, other = rng.randrange(6), rng.randrange(6)
        for at, line in enumerate(lines):
            cells = line.split(separator)
            if max(one, other) < len(cells) and (at or rng.random() < 0.5):
                cells[one], cells[other] = cells[other], cells[one]
            lines[at] = separator.join(cells)
    elif kind == 2:  # one that says nothing
        cell, value = rng.randrange(6), rng.choice(CELLS).encode()
        for at in range(1, len(lines)):
            cells = lines[at].split(separator)
            if cell < len(cells):
                cells[cell] = value
            lines[at] = separator.join(cells)
    elif kind == 3:
        rng.shuffle(lines)
    elif kind == 4:
        lines = [line for line in lines for _ in range(2)]
    elif kind == 5:
        for at in some:
            lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
    elif kind == 6:
        lines.insert(
            rng.randrange(len(lines)), rng.choice((b"#", b"# knobcam: {", b"\0", b"a,b,c", b"[]", b"{}"))
        )
    else:
        return bytes(raw).decode("latin-1").encode(rng.choice(("utf-16", "utf-8", "utf-32")), "replace")
    return rng.choice((b"\n", b"\n", b"\r\n")).join(lines)


def _words(raw: bytearray, rng: random.Random) -> bytes:
    """Names that are exchanged, made equal or spoiled."""
    found = [match.span() for match in re.finditer(rb"[A-Za-z_]{3,}", bytes(raw[:5000]))]
    if not found:
        return _flips(raw, rng)
    start, end = rng.choice(found)
    other = rng.choice(found)
    names = (b"tau_Nm", b"theta_rad", b"t_s", b"x [", b"\xb5", b"[[", b"NaN", bytes(raw[other[0] : other[1]]))
    return bytes(raw[:start] + rng.choice(names) + raw[end:])


def _nested(raw: bytearray, rng: random.Random) -> bytes:
    deep = rng.choice((1, 20, 2000, 200_000))
    front, back = rng.choice(((b"[", b"]"), (b'{"a":', b"}"), (b'[{"a":', b"}]")))
    return front * deep + bytes(raw) + back * rng.choice((deep, 0))


MUTATIONS: dict[str, Callable[[bytearray, random.Random], bytes]] = {
    function.__name__.strip("_"): function
    for function in (
        *(_flips, _head_flips, _tail_flips, _extreme, _blank, _noise, _cut_out, _again, _truncated, _doubled),
        *(_magic, _giant, _packed, _repacked, _text, _text, _words, _nested),
    )
}


def mutated(raw: bytes, rng: random.Random) -> tuple[bytes, list[str]]:
    """Return a spoiled file and what was done to it: one thing mostly, up to three."""
    done = []
    is_text = b"\0" not in raw[:2000]
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        name = rng.choice(("text", "words") if is_text and rng.random() < 0.4 else list(MUTATIONS))
        if raw:
            raw = MUTATIONS[name](bytearray(raw), rng)
            done.append(name)
    return raw[:_LONGEST], done


def sealed(raw: bytes) -> bytes:
    """Return the lines of a journal with check sums that are right."""
    parts = [line.partition(b" ")[2] for line in raw.split(b"\n")]
    return b"\n".join(f"{zlib.crc32(part):08x} ".encode() + part if part else part for part in parts)


def bombs() -> dict[str, Source]:
    """Return small files that claim, or unpack to, gigabytes."""
    zeros = bytes(2**24)
    found: dict[str, Source] = {"bomb/members.gz": (gzip.compress(zeros) * 200, {})}
    packer = zlib.compressobj(1, wbits=31)
    found["bomb/zeros.gz"] = (_long(packer, zeros, 32), {})
    found["bomb/gz.gz"] = (gzip.compress(found["bomb/zeros.gz"][0]), {})
    packer = zlib.compressobj(1, wbits=31)
    front = packer.compress(b"t_s,theta_rad,tau_Nm\n")
    found["bomb/rows.csv.gz"] = (front + _long(packer, b"0,0,0\n" * 2**20, 80), {})
    file = io.BytesIO()
    with h5py.File(file, "w") as inside:
        for name in NAMES:
            inside.create_dataset(name, shape=(2**29,), dtype="f8", chunks=(2**17,), compression="gzip")
    found["bomb/claims.h5"] = (file.getvalue(), {"map": MAP})
    file = io.BytesIO()
    table = pa.table(dict.fromkeys(NAMES, pa.array(np.zeros(2**23))))
    with pq.ParquetWriter(file, table.schema) as writer:
        writer.write_table(table)
    found["bomb/runs.parquet"] = (file.getvalue(), {"map": MAP})
    header = io.BytesIO()
    shape = {"descr": "<f8", "fortran_order": False, "shape": (len(zeros) // 8,)}
    np.lib.format.write_array_header_1_0(header, shape)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for index in range(40):
            archive.writestr(f"c{index}.npy", header.getvalue() + zeros)
    found["bomb/zeros.npz"] = (file.getvalue(), {"map": "theta=c0, tau=c1", "rate_hz": 1000.0})
    array = struct.pack("<IIIIIIii", 6, 8, 6, 0, 5, 8, len(zeros) // 8, 1) + struct.pack(
        "<HH4s", 1, 4, b"tau_"
    )
    array += struct.pack("<II", 9, len(zeros))
    packed = zlib.compress(struct.pack("<II", 14, len(array) + len(zeros)) + array + zeros, 1)
    element = struct.pack("<II", 15, len(packed)) + packed
    found["bomb/zeros.mat"] = (b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM" + element * 200, {"map": MAP})
    return found


def _long(packer: zlib._Compress, piece: bytes, times: int) -> bytes:
    return b"".join(packer.compress(piece) for _ in range(times)) + packer.flush()
