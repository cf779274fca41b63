"""What is packed, with limits on what comes out: a small file must not be able to fill the memory."""

from __future__ import annotations

import codecs
import gzip
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import IO

import numpy as np

from ...errors import InputError
from .table import DEFAULT_MAX_BYTES

_ALWAYS = 2**26  # bytes that may come out of anything
_MOST_TIMES = 100  # that logs shrink beyond that; theirs is 3 to 20, of noise and digits
_FED = 2**13
_PIECE = 2**24
_HELD, _HELD_TIMES = 2**28, 3  # bytes, or times the file's, that are held
_READ = 2**20
_LINE_FEED = 10
_NUMBERS = 2**25  # that may come out of anything; with what is made of them they take most of a gigabyte
_BYTES_A_NUMBER = 3  # in files whose numbers are more: text has ten, what is packed at least four


@dataclass
class Budget:
    """What may come out of a file of `size` bytes: at most `max_bytes`, and no more than a log can hold."""

    source: str
    size: int
    max_bytes: int
    taken: int = 0
    counted: int = 0

    def take(self, count: int) -> None:
        """Count bytes that come out, or are claimed to; InputError where they are too many."""
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

    def numbers(self, count: int, itemsize: int = 1) -> None:
        """Count numbers before they are read; InputError where they would fill the memory, 8 bytes each."""
        self.counted += max(count, count * itemsize // 8)
        most = max(_NUMBERS, self.size // _BYTES_A_NUMBER) * max(1, self.max_bytes // DEFAULT_MAX_BYTES)
        if self.counted > most:
            raise InputError(
                f"{self.source}: {self.counted} numbers in {self.size} bytes, the limit is {most}; leave "
                f"columns out, cut it in parts, or double max_bytes"
            )

    def held(self) -> Budget:
        """Return the budget of a format whose content is held in memory as a whole."""
        most = max(_HELD, _HELD_TIMES * self.size) * max(1, self.max_bytes // DEFAULT_MAX_BYTES)
        return replace(self, max_bytes=min(self.max_bytes, most))


@dataclass(frozen=True)
class Survey:
    """What was seen of a text that was read once: whether it is UTF-8, its lines, and the longest (bytes)."""

    utf8: bool
    lines: int
    longest: int


def survey(stream: IO[bytes], budget: Budget) -> Survey:
    """Read a text to its end, a piece at a time, and go back; InputError where it is damaged or too long."""
    decoder = codecs.getincrementaldecoder("utf-8-sig")()
    utf8, lines, longest, since = True, 1, 0, 0
    for piece in _pieces(stream, budget):
        marks = np.flatnonzero(np.frombuffer(piece, np.uint8) == _LINE_FEED)
        lines += max(len(marks), piece.count(b"\r"))
        if len(marks):
            longest = max(longest, since + int(marks[0]), int(np.diff(marks).max(initial=0)))
            since = len(piece) - 1 - int(marks[-1])
        else:
            since += len(piece)
        try:
            utf8 and decoder.decode(piece)
        except UnicodeDecodeError:
            utf8 = False
    stream.seek(0)
    return Survey(utf8, lines, max(longest, since))


def peek(stream: IO[bytes], count: int, budget: Budget) -> bytes:
    """Return the first bytes of a text, and go back."""
    head = next(_pieces(stream, replace(budget), count), b"")
    stream.seek(0)
    return head


def _pieces(stream: IO[bytes], budget: Budget, size: int = _READ) -> Iterator[bytes]:
    try:
        while piece := stream.read(size):
            budget.take(len(piece))
            yield piece
    except (zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"{budget.source}: damaged gzip ({error}); copy the file again") from error
    except EOFError:
        raise InputError(f"{budget.source}: packed, and it ends in the middle; copy it again") from None


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
