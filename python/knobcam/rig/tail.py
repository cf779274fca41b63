"""A wire log while it grows: what there is to see of a run before it has ended."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .. import _core
from ..capture.formats import wire
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from ..base.arrays import FloatArray

_END = b"\0"  # of a frame
_WRAP = 2**32  # of the device's count of samples


class Tail:
    """The samples of a log that is being written; `device` is the DESCRIPTOR, once it has come.

    It reads the file that the recorder writes, and so can neither delay nor lose anything.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        raw = log.read_bytes()
        self.planned = int(wire.parse(str(log), raw).header["motion"]["samples"])
        """Samples that the run is to have."""
        self.device: Mapping[str, Any] | None = None
        self._origin: int | None = None
        self._read = raw.index(b"\n", len(wire.MAGIC)) + 1

    def more(self) -> dict[str, FloatArray]:
        """Return the columns of the samples that came since the last call, in SI; none for no sample.

        Raises InputError where the log cannot be read any more.
        """
        try:
            with self._log.open("rb") as file:
                file.seek(self._read)
                came = file.read()
        except OSError as error:
            raise InputError(f"{self._log}: cannot be read ({error.strerror or error})") from None
        whole = came[: came.rfind(_END) + 1]
        self._read += len(whole)
        found = _core.wire_log(whole)
        for said in found["said"]:
            if said["message"]["type"] == "DESCRIPTOR":
                self.device = said["message"]["device"]
        if self.device is None or not found["runs"]:
            return {}
        raw = found["runs"][-1]
        # A stretch without the word that the run started counts from its own first sample.
        self._origin = raw["first"] if self._origin is None else self._origin
        raw = raw | {"index": raw["index"] + (raw["first"] - self._origin) % _WRAP}
        columns, _ = wire.in_si(raw, self.device, self.device["rate_hz"], self.device["c_cal"])
        return columns
