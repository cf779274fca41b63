"""The serial port of a rig: opening it, and finding the one behind which a rig is."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
import threading

import serial
from serial.tools import list_ports

from .. import _core
from ..errors import InputError

BAUD = 1_000_000
"""Bits a second: twice what 5 kHz need. USB and pseudo-terminals do not care."""

READS_ITSELF = sys.platform == "linux"
"""Whether the recorder reads the port on a thread of its own; elsewhere a thread of Python carries bytes."""

_READ_S = 0.01


def ports() -> dict[str, str]:
    """Return the serial ports of this computer, by name, with what is plugged in there."""
    found = sorted(list_ports.comports(), key=lambda port: port.device)
    return {port.device: str(port.description or "") for port in found}


class Port:
    """An open port of which nobody else has the use; a recorder reads it.

    Raises InputError, one line, for a port that cannot be opened.
    """

    def __init__(self, name: str, baud: int = BAUD) -> None:
        self.name = name
        self._serial = _opened(name, baud)
        self._open = True
        self._pump: threading.Thread | None = None
        try:
            self.recorder = _core.Recorder(self._serial.fileno() if READS_ITSELF else None)
        except BaseException:
            self._serial.close()
            raise
        if not READS_ITSELF:
            self._serial.timeout = _READ_S
            self._pump = threading.Thread(target=self._carry, name="knobcam-port", daemon=True)
            self._pump.start()

    def close(self) -> None:
        """Let go of the port; may be called again."""
        self._open = False
        if self._pump is not None:
            self._pump.join()
        self.recorder.stop()
        self._serial.close()

    def _carry(self) -> None:
        """Carry bytes between port and recorder, where the recorder cannot read the port itself."""
        try:
            while self._open:
                received = self._serial.read(max(1, self._serial.in_waiting))
                if outgoing := self.recorder.push(received):
                    self._serial.write(outgoing)
        except (serial.SerialException, OSError) as error:
            self.recorder.end(f"the device is gone ({error})")


def _opened(name: str, baud: int) -> serial.Serial:
    try:
        return serial.Serial(name, baud, timeout=0, exclusive=True if os.name == "posix" else None)
    except (serial.SerialException, OSError, ValueError, OverflowError) as error:
        raise InputError(f"{name}: {_why(name, baud, error)}") from None


def _why(name: str, baud: int, error: Exception) -> str:
    """What is the matter with a port, and the way out."""
    code = getattr(error, "errno", None)
    said = str(error)
    if code == errno.ENOENT or "FileNotFoundError" in said or "\0" in name:
        return f"there is no such port; {_listed()}"
    if "exclusively lock" in said or code == errno.EBUSY:
        return "the port is busy: another program has it, perhaps a second recorder; end that one first"
    if code in (errno.EACCES, errno.EPERM) or "PermissionError" in said:
        return (
            "no permission to open it, or another program has it; on Linux join the group of the port "
            "(often dialout) and log in again"
        )
    with contextlib.suppress(OSError):
        looked_at = os.open(name, os.O_RDONLY | os.O_NONBLOCK)
        try:
            if not os.isatty(looked_at):
                return f"is no serial port; {_listed()}"
        finally:
            os.close(looked_at)
    if isinstance(error, ValueError | OverflowError):
        return f"the port cannot do {baud} baud ({said}); choose another --baud"
    return f"cannot be opened ({said}); {_listed()}"


def _listed() -> str:
    found = ports()
    if found:
        return f"this computer has {', '.join(list(found)[:8])}"
    return "this computer has no serial port; plug the rig in, or run `knobcam emulate`"
