"""A conversation with a rig: who it is, what it is told, what it answers."""

from __future__ import annotations

import contextlib
import time
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from .. import _core
from ..base.door import checked
from ..errors import InputError
from ..render import check_passive
from .figures import Figures
from .port import BAUD, Port, ports

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

    from ..capture.motions import MotionTrack
    from ..model import Model

    Clears = bool | Callable[[str], bool]
    """Whether a latched fault is cleared: yes, no, or what a function says that is told the fault."""

VERSION = 1
"""Version of the wire protocol that is spoken."""

CAPABILITIES = {"drive": 1, "render": 2, "render_driven": 4, "commanded": 8}
"""What a rig may be able to do, by mode of ARM."""

_WAITS_S = (0.1, 0.1, 0.2, 0.4, 0.8, 1.6)  # for an answer; the command is repeated after each but the last
_TAIL_S = 0.5  # for what a rig still has to say of a run
_QUIET_S = 0.03  # nothing more comes of what was said before
_ORDER, _STATE = 6, 2  # codes of NAK
_RUNNING = ("recording", "armed", "rendering")
_FASTEST_RAD_S = 100.0  # 16 turns in a second: no knob is driven faster, and what is faster is a jump


class Link:
    """A rig on a port, as `with Link(port) as link`: on every way out torque and run are ended.

    `device` is its DESCRIPTOR, `fault` what it has latched (code, text), `run` the number of the newest run.
    Nothing but `arm` arms it. Raises InputError, one line, for whatever is wrong with port or rig.
    """

    @checked
    def __init__(self, port: str, *, baud: int = BAUD) -> None:
        self.port = port
        self.device: Mapping[str, Any] = {}
        self.state: str | None = None
        self.fault: tuple[int, str] | None = None
        self.run: int | None = None
        self.stopped: Mapping[str, Any] | None = None
        self._number = 0
        self._busy = self._running = False
        self._port = Port(port, baud)
        self._recorder = self._port.recorder
        try:
            self._recorder.send(b"\0")
            self.describe()
            if self.state in _RUNNING:
                self.command("DISARM")
                self.command("STOP")
        except BaseException:
            self._port.close()
            raise

    @classmethod
    def at(cls, place: str, *, baud: int = BAUD) -> Self:
        """Return the link to a port, or to the rig of a serial number, which is written `serial:NUMBER`."""
        scheme, _, serial = place.partition(":")
        return cls.to(serial, baud=baud) if scheme == "serial" else cls(place, baud=baud)

    @classmethod
    def to(cls, serial: str, among: Sequence[str] | None = None, *, baud: int = BAUD) -> Self:
        """Return the link to the rig of this serial number; `among`: the ports to look at, by default all."""
        tried = []
        for port in ports() if among is None else among:
            try:
                link = cls(port, baud=baud)
            except InputError as error:
                tried.append(str(error))
                continue
            if link.device["serial"] == serial:
                return link
            tried.append(f"{port}: is {link.device['serial']}")
            link.close()
        looked = "; ".join(tried) or "this computer has no serial port"
        raise InputError(f"no rig {serial} is found ({looked}); plug it in and switch it on")

    @property
    def rate_hz(self) -> float:
        """Samples per second that the rig claims, Hz."""
        return float(self.device["rate_hz"])

    def figures(self) -> Figures:
        """Return what can be told of the recording at this moment."""
        return Figures(**self._recorder.figures())

    def describe(self) -> None:
        """Ask the rig what it is, and check what it says."""
        number, wire = self._framed({"type": "DESCRIBE"})
        device: Mapping[str, Any] | None = None
        for wait in _WAITS_S:
            self._recorder.send(wire)
            until = time.monotonic() + wait
            while said := self._hear(until):
                if said["type"] == "DESCRIPTOR":
                    device = said["device"]
                elif device is not None and (
                    said["type"] == "FAULT" or (said["type"] == "STATUS" and self.state != "fault")
                ):
                    self._accept(device)
                    return
                elif said["type"] == "NAK" and said["command"] == number:
                    raise self._refused("DESCRIBE", said)
        if device is None:
            raise InputError(f"{self.port}: {self._stranger()}")
        if self.state == "fault":
            self.fault = self.fault or (0, "it does not say which")
        self._accept(device)

    def _accept(self, device: Mapping[str, Any]) -> None:
        try:
            _core.wire_check({"type": "DESCRIPTOR", "device": dict(device)})
        except InputError as error:
            raise InputError(f"{self.port}: {error}") from None
        self.device = MappingProxyType(dict(device))

    def _stranger(self) -> str:
        """Why whatever is on the port is no rig to talk to."""
        figures = self.figures()
        if figures.ended:
            return f"{figures.ended}; plug the rig in again"
        foreign = figures.foreign_version
        if foreign is not None:
            older = foreign < VERSION
            way_out = "the firmware of the rig is older and must be updated" if older else "update knobcam"
            return f"speaks version {foreign} of the wire protocol, this program version {VERSION}; {way_out}"
        if figures.bytes > 0:
            return (
                f"sends {figures.bytes} bytes that are no frames: a wrong baud rate, or no rig; "
                "check --baud, or choose another port"
            )
        return "nothing answers: no rig, or it is switched off; switch it on, or choose another port"

    def command(self, kind: str, **fields: Any) -> None:
        """Give a command and wait until it is carried out; InputError where the rig refuses or is silent."""
        number, wire = self._framed({"type": kind, **fields})
        for wait in _WAITS_S:
            self._recorder.send(wire)
            until = time.monotonic() + wait
            while said := self._hear(until):
                if said.get("command") == number:
                    if said["type"] == "NAK":
                        raise self._refused(kind, said)
                    return
            self.check()
        raise InputError(f"{self.port}: the rig does not answer {kind} any more; check its cable and power")

    def check(self) -> None:
        """Raise InputError where the device is gone or the log cannot be written any more."""
        figures = self.figures()
        if figures.ended:
            raise InputError(f"{self.port}: {figures.ended}; plug the rig in again")
        if figures.log_error:
            raise InputError(
                f"the wire log cannot be written any more ({figures.log_error}); free some space"
            )

    def wait(self, seconds: float) -> bool:
        """Listen for so long, or until the rig says something; return whether it did."""
        return self._hear(time.monotonic() + seconds) is not None

    def log_to(self, path: str | os.PathLike[str] | None) -> None:
        """Append everything that comes to this file, beginning with what the rig is; None ends that."""
        self._recorder.log_to(path)
        if path is not None:
            self.describe()

    def upload_motion(self, track: MotionTrack) -> None:
        """Send a motion ahead; its first point must be at rest, at angle 0, and none may jump."""
        _check_motion(track, self.rate_hz)
        most = self.device["motion_capacity"]
        if len(track.t) > most:
            longest = most / self.rate_hz
            raise InputError(
                f"motion: {len(track.t)} points, the rig keeps {most}; choose up to {longest:.3g} s"
            )
        first = self._number + 1
        self._upload(
            "EXCITE", _core.wire_motion(track.theta, track.omega, track.alpha, first, self._recorder.now_us)
        )

    def upload_model(self, model: Model, *, force: bool = False) -> None:
        """Send a model to render; `force`: though it may feed a hand, as long as its tank lasts."""
        if not force:
            check_passive(model, rate_hz=self.rate_hz)
        text, most = model.text(), self.device["model_capacity"]
        if force:
            schema, _, rest = text.partition("\n")
            text = f"{schema}\nforced = true\n{rest}"
        if len(text.encode()) > most:
            raise InputError(f"model: {len(text.encode())} bytes, the rig keeps {most}; shorten its name")
        self._upload("MODEL", _core.wire_model(text, self._number + 1, self._recorder.now_us))

    def _upload(self, kind: str, frames: list[bytes]) -> None:
        """Send chunks, at most a window of them without an answer; go back to the first one that got lost."""
        before, window = self._number, self.device["window"]
        self._number += len(frames)
        done = sent = tries = 0
        while done < len(frames):
            if sent < min(done + window, len(frames)):
                self._recorder.send(frames[sent])
                sent += 1
                continue
            until = time.monotonic() + _WAITS_S[tries]
            said = self._answer(range(before + done + 1, before + sent + 1), until)
            if said is not None and said["type"] == "ACK":
                done, tries = said["command"] - before, 0
                continue
            if said is not None and said["code"] != _ORDER:
                raise self._refused(kind, said)
            self.check()
            tries += 1
            if tries == len(_WAITS_S):
                raise InputError(f"{self.port}: the rig does not take {kind}; check its cable")
            while self.wait(_QUIET_S):
                pass
            sent = done

    def _answer(self, numbers: range, until: float) -> Mapping[str, Any] | None:
        while said := self._hear(until):
            if said.get("command") in numbers:
                return said
        return None

    def arm(
        self, mode: str, hold_s: float, *, torque_limit: float | None = None, rate_limit: float | None = None
    ) -> None:
        """Allow torque from the next `start` on, for at most `hold_s`, within limits (N m, N m/s).

        By default those of the rig; higher ones are refused.
        """
        if not self.device["capabilities"] & CAPABILITIES[mode]:
            raise InputError(f"{self.port}: the rig {self.device['serial']} cannot do {mode}")
        limits = {"torque_limit": torque_limit, "torque_rate_limit": rate_limit}
        for name, asked in limits.items():
            most = self.device[name]
            if asked is not None and not 0.0 < asked <= most:
                raise InputError(f"{self.port}: {name}={asked:g}: the rig allows above 0, up to {most:g}")
            limits[name] = most if asked is None else asked
        self._busy = True
        self._recorder.beat(hold_s)
        self.command("ARM", mode=mode, **limits)

    def start(self, samples: int) -> None:
        """Start a run of so many samples; 0: until `stop`."""
        self._busy = self._running = True
        self.stopped = None
        self.command("START", samples=samples)

    def stop(self) -> None:
        """End torque and run."""
        self.command("DISARM")
        self.command("STOP")
        self._recorder.beat(0.0)
        # The rest of the samples, and how many there should be, come behind the answer.
        until = time.monotonic() + _TAIL_S
        while self._running and self.stopped is None and self._hear(until) is not None:
            pass
        self._busy = self._running = False

    def clear(self) -> None:
        """Forget a latched fault, because a person or a program asked for it."""
        self.command("CLEAR")
        self.fault = None

    def close(self) -> None:
        """End torque and run, and let go of the port; may be called again."""
        try:
            if self._busy:
                self._busy = False
                with contextlib.suppress(InputError):
                    self.stop()
        finally:
            self._port.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _framed(self, message: dict[str, Any]) -> tuple[int, bytes]:
        self._number += 1
        return self._number, _core.wire_encode(message, self._number, self._recorder.now_us)

    def _hear(self, until: float) -> Mapping[str, Any] | None:
        """The next message before this moment; what it says of the rig's state is kept."""
        frame = self._recorder.next_message(max(0.0, until - time.monotonic()))
        if frame is None:
            return None
        said: Mapping[str, Any] = frame["message"]
        if said["type"] == "STATUS":
            self.state = said["state"]
            if self.state != "fault":
                self.fault = None
        elif said["type"] == "FAULT":
            self.fault = (said["code"], said["text"])
        elif said["type"] == "STARTED":
            self.run = said["run"]
        elif said["type"] == "STOPPED":
            self.stopped = said
        return said

    def _refused(self, kind: str, said: Mapping[str, Any]) -> InputError:
        why = said["text"] or "no reason given"
        hint = ""
        if said["code"] == _STATE and self.fault is not None:
            hint = f"; it has latched a fault: {self.fault[1]}"
        return InputError(f"{self.port}: the rig refuses {kind} ({why}{hint})")


def _check_motion(track: MotionTrack, rate_hz: float) -> None:
    """Refuse what no knob can follow from where it stands."""
    if not len(track.t):
        raise InputError("motion: has no point; give one a sample")
    if not all(np.isfinite(column).all() for column in track[1:]):
        raise InputError(
            "motion: has points that are not finite; give finite angles, speeds and accelerations"
        )
    if track.theta[0] != 0.0 or track.omega[0] != 0.0:
        raise InputError(
            f"motion: begins at {track.theta[0]:g} rad and {track.omega[0]:g} rad/s; it must begin at rest "
            "at angle 0, where the knob stands"
        )
    jumps = np.abs(np.diff(track.theta, prepend=0.0)) > _FASTEST_RAD_S / rate_hz
    jumps |= np.abs(track.omega) > _FASTEST_RAD_S
    if jumps.any():
        at = int(np.argmax(jumps))
        raise InputError(
            f"motion: jumps at point {at} (to {track.theta[at]:.4g} rad, {track.omega[at]:.4g} rad/s); a "
            f"knob is driven at up to {_FASTEST_RAD_S:g} rad/s"
        )
