"""A capture as one of several runs of a knob: what to call it, and how to know it again."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from .capture import Capture

_DIGITS = 12  # of a fingerprint: two captures of one knob never share so many
_known: WeakKeyDictionary[Capture, str] = WeakKeyDictionary()  # every candidate of a diagnosis asks


def name(capture: Capture) -> str:
    """Return the name of the file that a capture comes from; nothing where it comes from none."""
    return Path(str(capture.meta.get("source", ""))).name


def same(capture: Capture, other: Capture) -> Capture:
    """Return a capture that is known as another one: the same run, of which something was mended."""
    _known[capture] = fingerprint(other)
    return capture


def fingerprint(capture: Capture) -> str:
    """Return digits that no other capture has: of its angle and its torque, whatever its file is called."""
    if capture not in _known:
        digest = hashlib.sha256(capture.theta.tobytes())
        digest.update(capture.tau.tobytes())
        _known[capture] = digest.hexdigest()[:_DIGITS]
    return _known[capture]
