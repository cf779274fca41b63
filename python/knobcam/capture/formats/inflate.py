"""What is packed, with limits on what comes out: a small file must not be able to fill the memory."""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass

from ...errors import InputError

MAGIC = b"\x1f\x8b"

_ALWAYS = 2**26  # bytes that may come out of anything
_MOST_TIMES = 100  # that logs shrink beyond that; theirs is 3 to 20, of noise and digits
_FED = 2**13
_PIECE = 2**24
_PADDING = re.compile(rb"\0*")


@dataclass
class Budget:
    """What may come out of a file of `size` bytes: at most `max_bytes`, and no more than a log can hold."""

    source: str
    size: int
    max_bytes: int
    taken: int = 0

    def take(self, count: int) -> None:
        """Count what comes out, or is claimed to; InputError where it is too much."""
        self.taken += count
        if self.taken > self.max_bytes:
            raise InputError(
                f"{self.source}: inflates to more than {self.max_bytes} bytes; raise max_bytes to read it"
            )
        if self.taken > max(_ALWAYS, _MOST_TIMES * self.size):
            raise InputError(
                f"{self.source}: {self.size} bytes that inflate to {self.taken} or more hold no log; "
                f"unpack it by hand"
            )


def inflate(source: str, raw: bytes, max_bytes: int) -> bytes:
    """Return the content of the gzip members in `raw`; InputError when damaged or above `max_bytes`."""
    budget = Budget(source, len(raw), max_bytes)
    parts: list[bytes] = []
    at = 0
    while raw.startswith(MAGIC, at):
        member = zlib.decompressobj(wbits=31)
        try:
            part, at = unpack(member, raw, at, budget)
        except zlib.error as error:
            raise InputError(f"{source}: damaged gzip ({error}); copy the file again") from error
        if not member.eof:
            raise InputError(f"{source}: the gzip file ends in the middle; copy the file again")
        parts.append(part)
        padding = _PADDING.match(raw, at)
        at = padding.end() if padding else at
    return parts[0] if len(parts) == 1 else b"".join(parts)


def unpack(packer: zlib._Decompress, raw: bytes | memoryview, at: int, budget: Budget) -> tuple[bytes, int]:
    """Return what `packer` makes of `raw` from `at` on, and where that ended."""
    parts: list[bytes] = []
    while at < len(raw) and not packer.eof:
        fed = raw[at : at + _FED]  # little, as what is left of it is copied at the end of each member
        parts.append(packer.decompress(fed, _PIECE))
        at += len(fed) - len(packer.unconsumed_tail) - len(packer.unused_data)
        budget.take(len(parts[-1]))
    return b"".join(parts), at


def deflate(content: bytes) -> bytes:
    """Return `content` as gzip without a time stamp, so that equal captures are equal files."""
    packer = zlib.compressobj(6, wbits=31)
    return packer.compress(content) + packer.flush()
