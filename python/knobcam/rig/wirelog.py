"""The wire log: what came over the port as it came; everything else is worked out from it, any time."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base.door import checked
from ..base.reading import is_folder, open_file
from ..base.writing import RECORDING_SUFFIX, is_recording
from ..capture.capture import of_table
from ..capture.formats import wire
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture import Capture

SUFFIX = RECORDING_SUFFIX


class WireLog:
    """A wire log that was read: `header`, `device` (the DESCRIPTOR), `runs`, and `counts` of frames.

    A log that was cut off anywhere opens; at most its last frame is incomplete.
    """

    def __init__(self, path: Path, content: wire.Content) -> None:
        self.path = path
        self._content = content

    @classmethod
    @checked
    def load(cls, path: str | os.PathLike[str]) -> WireLog:
        """Read a log. Raises InputError for a file that cannot be read or is no log."""
        file = Path(path)
        with open_file(file) as stream:
            raw = stream.read()
        return cls(file, wire.parse(str(file), raw))

    @property
    def header(self) -> Mapping[str, Any]:
        """When, where and why it was recorded."""
        return self._content.header

    @property
    def device(self) -> Mapping[str, Any] | None:
        """The DESCRIPTOR of the rig; None where the log ends before it."""
        return self._content.device

    @property
    def runs(self) -> Sequence[Mapping[str, Any]]:
        """Raw samples of each run, its gaps and its account."""
        return self._content.runs

    @property
    def counts(self) -> Mapping[str, int]:
        """Whole frames, stretches that were no frame, and bytes at the end that are not yet one."""
        read = self._content.read
        return {name: read[name] for name in ("frames", "corrupt", "corrupt_bytes", "unknown", "pending")}

    @property
    def samples(self) -> int:
        """Samples of all runs."""
        return sum(len(run["index"]) for run in self.runs)

    def capture(self, run: int = -1, calibration: Any = None) -> Capture:
        """Return the capture of a run by its place, by default the last.

        `calibration` is anything with a `c_cal`, (rad/s^2)/V; by default the one of the recording, else the
        nominal one of the rig. Raises InputError for a run without samples.
        """
        c_cal = getattr(calibration, "c_cal", None)
        return of_table(self.path, wire.table(self._content, run, c_cal))

    def __repr__(self) -> str:
        who = "no rig" if self.device is None else f"rig {self.device['serial']}"
        runs = ", ".join(f"{len(run['index'])} samples" for run in self.runs) or "no samples"
        cut = f", cut off in a frame of {self.counts['pending']} bytes" if self.counts["pending"] else ""
        return (
            f"WireLog {self.path}: {who}, {len(self.runs)} runs ({runs}), {self.counts['frames']} frames{cut}"
        )


def is_log(path: str | os.PathLike[str]) -> bool:
    """Whether the file begins as a wire log does."""
    return is_recording(path)


def check_new(path: Path) -> None:
    """Refuse a log that cannot be begun: one that is there, or that has no folder to stand in."""
    if os.path.lexists(path):
        raise InputError(
            f"{path}: is there already, and a recording is not written over; choose another name"
        )
    if not is_folder(path.parent):
        raise InputError(f"{path}: there is no folder {path.parent}; make it first, or choose another place")
    if not os.access(path.parent, os.W_OK):
        raise InputError(f"{path}: the folder {path.parent} cannot be written to; choose another place")


def begin(path: Path, header: Mapping[str, Any]) -> None:
    """Make a log that holds its header alone. It appears whole; a log that is there is never written over."""
    check_new(path)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_bytes(wire.header_line({"knobcam": _core.__version__, **header}))
        part.rename(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise InputError(
            f"{path}: cannot be written ({error.strerror or error}); choose another place"
        ) from None
