"""Answers that are kept: what was computed against what a file of the repository says."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

FOLDER = Path(__file__).parent / "kept"
KEEP = "KNOBCAM_KEEP"  # the environment variable with which the files are made anew
RELATIVE, OF_LARGEST = 2e-6, 1e-8  # instruction sets and the last digit differ by less
ABOUT = "~"  # stands before a chance, a weight, or a gain in variances of the noise
NEAR = 0.05  # those are kept to this many of their own roots
LONGEST = 12  # columns longer than this are kept by sums and some of their numbers
CHANCES = ("p_value", "gain", "score", "chance", "D", "weight", "rivals")


class Answers:
    """What one test answers, a line each: what it is, a colon, numbers or words."""

    def __init__(self, name: str) -> None:
        self.path = FOLDER / f"{name}.txt"
        self.lines: list[str] = []

    def put(self, what: str, value: Any) -> None:
        """Keep a value: a number, a text, columns, or a document; one that has no other in it is a line."""
        if isinstance(value, Mapping) and any(
            _deep(own) or isinstance(own, Mapping) for own in value.values()
        ):
            for key, own in value.items():
                self.put(f"{what} {key}", own)
        elif _deep(value) and not isinstance(value, Mapping):
            for at, own in enumerate(value):
                self.put(f"{what} {at}", own)
        else:
            self.lines.append(f"{what.replace(': ', ' ')}: {' '.join(_words(what.split()[-1], value))}")

    def done(self) -> None:
        """Compare all with the file, or make it anew and print what changed."""
        before = self.path.read_text("utf-8").splitlines() if self.path.is_file() else []
        changes = []
        for at in range(max(len(before), len(self.lines))):
            was, now = (lines[at] if at < len(lines) else "" for lines in (before, self.lines))
            if not _alike(was, now):
                changes += [f"- {was}", f"+ {now}"]
        if KEEP in os.environ:
            self.path.write_text("".join(f"{line}\n" for line in self.lines), "utf-8")
            print(self.path, *changes, sep="\n")
            return
        said = "\n".join(changes)
        again = f"{KEEP}=1 python -m pytest -s tests -k kept"
        assert not changes, (
            f"other answers than are kept in {self.path}; meant so, make them anew by `{again}`:\n{said}"
        )


def _deep(value: Any) -> bool:
    """Whether a value has documents or columns of documents in it."""
    many = isinstance(value, Sequence | Mapping) and not isinstance(value, str)
    own = value.values() if isinstance(value, Mapping) else value
    return many and any(isinstance(one, Sequence | Mapping) and not isinstance(one, str) for one in own)


def _words(name: str, value: Any) -> list[str]:
    if isinstance(value, Mapping):
        own_names = {key: name if name in CHANCES else key for key in value}
        return [word for key, own in value.items() for word in (key, *_words(own_names[key], own))]
    if isinstance(value, np.ndarray) or (isinstance(value, Sequence) and not isinstance(value, str)):
        if all(isinstance(one, int | float | np.number) for one in value):
            return [_number(float(one)) for one in _short(np.asarray(value, float))]
        return [word for one in value for word in _words(name, one)]
    if isinstance(value, bool | str | None):
        return [str(value).replace("\n", " / ")]
    return [f"{ABOUT}{value:.3f}" if name in CHANCES else _number(float(value))]


def _short(column: np.ndarray) -> np.ndarray:
    """A column, or of a long one its length, sums that weigh each number differently, and some numbers."""
    if column.size <= LONGEST:
        return column
    flat = column.ravel()
    known = np.where(np.isfinite(flat), flat, 0.0)
    at = np.arange(flat.size)
    sums = [float(np.sum(known * (1.5 + np.sin(w * at)))) for w in (0.0, 0.37, 1.9)]
    return np.array([flat.size, *sums, flat[flat.size // 5], flat[3 * flat.size // 5]])


def _number(value: float) -> str:
    return f"{value:.0f}" if math.isfinite(value) and value == int(value) else f"{value:.6e}"


def _alike(was: str, now: str) -> bool:
    """Whether two lines say the same: their words exactly, their numbers nearly."""
    old, new = was.split(" "), now.split(" ")
    numbers = [abs(one) for word in old if (one := _parsed(word)) is not None and math.isfinite(one)]
    scale = max(numbers, default=0.0)
    return len(old) == len(new) and all(_same(a, b, scale) for a, b in zip(old, new, strict=True))


def _same(was: str, now: str, scale: float) -> bool:
    if was == now:
        return True
    about = was.startswith(ABOUT) and now.startswith(ABOUT)
    a, b = (_parsed(word.removeprefix(ABOUT) if about else word) for word in (was, now))
    if a is None or b is None:
        return False
    near = NEAR * math.sqrt(abs(a)) if about else RELATIVE * min(abs(a), abs(b)) + OF_LARGEST * scale
    return abs(a - b) <= near


def _parsed(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None
