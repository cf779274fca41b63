"""Gzip, with a limit on what comes out: a small file must not be able to fill the memory."""

from __future__ import annotations

import zlib

from ...errors import InputError

MAGIC = b"\x1f\x8b"


def inflate(source: str, raw: bytes, max_bytes: int) -> bytes:
    """Return the content of the gzip members in `raw`; InputError when damaged or above `max_bytes`."""
    parts: list[bytes] = []
    room = max_bytes
    while raw[:2] == MAGIC:
        member = zlib.decompressobj(wbits=31)
        try:
            part = member.decompress(raw, room + 1)
        except zlib.error as error:
            raise InputError(f"{source}: damaged gzip ({error}); copy the file again") from error
        room -= len(part)
        if room < 0:
            raise InputError(f"{source}: inflates to more than {max_bytes} bytes; raise max_bytes to read it")
        if not member.eof:
            raise InputError(f"{source}: the gzip file ends in the middle; copy the file again")
        parts.append(part)
        raw = member.unused_data.lstrip(b"\0")
    return parts[0] if len(parts) == 1 else b"".join(parts)


def deflate(content: bytes) -> bytes:
    """Return `content` as gzip without a time stamp, so that equal captures are equal files."""
    packer = zlib.compressobj(6, wbits=31)
    return packer.compress(content) + packer.flush()
