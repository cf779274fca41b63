"""An emulated rig behind a pseudo-terminal: a process that speaks the wire protocol.

It has the physics of the simulator, hidden effects included, and the noise of the paper's sensors.
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from .. import _core
from ..capture.motions import MotionTrack
from ..capture.motions import motion as make_motion
from ..errors import InputError
from ..model import Model
from ..model.effects import effect as catalogued
from ..model.simulate import RIG, SensorNoise, simulate
from ..model.typical import with_typical
from ..render import check_torque
from .leadin import there_and_back

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

FIXTURES = ("knob", "free", "anchor")
C_CAL = 1148.0
"""Sensitivity of the paper's accelerometer, (rad/s^2)/V (its Equation 7)."""
ANCHOR_NM_RAD = 5.0
"""Stiffness with which an anchored gripper holds against the position control."""
EMULATED = "EMU-"
"""How the serial number of an emulated rig begins."""
HEARTBEAT_MS = 100
_HAND_S = 30.0
_RATE_HZ = 5000.0
_READ = 1 << 16
# A pseudo-terminal holds about a page; what it does not take stays in the rig, which counts what it drops.
_WRITE = 1 << 12
_BEAT_S = 0.002
_LEAP_S = 0.01  # of a rig that runs faster than time
_END = b"\0"  # of a frame
_START_S = 30.0


class Emulation(NamedTuple):
    """What is emulated.

    `knob` is a model, or its file or name; `effects` are hidden in it, of typical sizes. `fixture` is what is
    in the gripper: the knob, nothing (free) or an anchor. `speed` is how much faster than real time it runs.
    `motion` is what its hand does again and again, a name or a motion file; None: slow, irregular turning.
    """

    knob: Model | str | os.PathLike[str] = "knob3"
    effects: tuple[str, ...] = ()
    fixture: str = "knob"
    seed: int = 0
    speed: float = 1.0
    c_cal: float = C_CAL
    noise: bool = True
    motion: str | os.PathLike[str] | None = None

    @property
    def serial_number(self) -> str:
        """As in its DESCRIPTOR."""
        return f"{EMULATED}{self.seed % 10**8:04d}"

    def model(self) -> Model:
        """Return the knob with what it hides."""
        model = self.knob if isinstance(self.knob, Model) else Model.load(self.knob)
        for effect in self.effects:
            model = with_typical(model, catalogued(effect))
        check_torque(model)
        return model

    def checked(self) -> Self:
        """Return it, or raise InputError for what cannot be emulated."""
        if self.fixture not in FIXTURES:
            raise InputError(f"fixture={self.fixture!r} is unknown; choose {', '.join(FIXTURES)}")
        if not 0.01 <= self.speed <= 1000.0:
            raise InputError(f"speed={self.speed:g}: choose 0.01 to 1000 times real time")
        if not (math.isfinite(self.c_cal) and self.c_cal > 0.0):
            raise InputError(f"c_cal={self.c_cal:g}: give a sensitivity above 0, such as {C_CAL:g}")
        if self.motion is not None:
            self.hand()
        return self

    def hand(self) -> MotionTrack:
        """Return what a hand does that turns the knob: from where that stands, and back to there."""
        if self.motion is None:
            return _resting(make_motion("hand", _HAND_S, seed=self.seed))
        name = os.fspath(self.motion)
        track = make_motion(name, rate_hz=_RATE_HZ)
        return there_and_back(track, _RATE_HZ) if name.lower().endswith(".toml") else _resting(track)

    def sensors(self) -> SensorNoise:
        """Return its sensors; that of the torque reaches as far as the knob asks for in a sweep."""
        if self.fixture != "knob":
            return RIG
        asked = simulate(self.model(), "sweep", noise="none").tau
        return RIG.reaching(float(np.max(np.abs(asked))))

    def rig(self) -> _core.Rig:
        """Return the rig itself, which hears and speaks bytes."""
        hand = self.hand()
        seen = self.sensors()
        noise = (seen.omega_sd, seen.alpha_sd, seen.tau_sd) if self.noise else (0.0, 0.0, 0.0)
        return _core.Rig(
            _descriptor(self),
            self.model().core if self.fixture == "knob" else None,
            ANCHOR_NM_RAD if self.fixture == "anchor" else None,
            (*noise, self.c_cal),
            (hand.theta, hand.omega, hand.alpha),
            self.seed,
        )


def _descriptor(emulation: Emulation) -> dict[str, Any]:
    """What the rig says of itself: the paper's sensors (Tables 1 and 8), and a motor to render with."""
    seen = emulation.sensors()

    def channel(scale: float, unit: str, most: int) -> dict[str, Any]:
        return {"scale": scale, "offset": 0.0, "unit": unit, "lower": -most, "upper": most}

    device = {
        "serial": emulation.serial_number,
        "firmware_major": 1,
        "firmware_minor": 0,
        "rate_hz": _RATE_HZ,
        "counts_per_rad": 1.0 / RIG.theta_step,
        # Twice the paper's step, so that 16 bits reach to 13 rad/s.
        "omega": channel(2.0 * RIG.omega_step, "rad_per_second", 32767),
        "alpha": channel(20.0 / 65536.0, "volt", 32767),
        "tau": channel(seen.tau_step, "newton_metre", round(seen.tau_limit / seen.tau_step)),
        "c_cal": C_CAL,
        # Enough to drive the knob along a motion, at least 0.5 N m.
        "torque_limit": max(0.5, seen.tau_limit),
        "torque_rate_limit": 4000.0 * max(0.5, seen.tau_limit),
        "inertia": 5e-5,
        "damping": 1e-4,
        "anchor_stiffness": 250.0,
        "delay_samples": 0,
        # In the time of the device, which may go faster than the host's.
        "heartbeat_ms": min(round(HEARTBEAT_MS * max(emulation.speed, 1.0)), 65535),
        "motion_capacity": 1_000_000,
        "model_capacity": 65536,
        "window": 8,
        "capabilities": 31,
    }
    return {"type": "DESCRIPTOR", "device": device}


def _resting(track: MotionTrack, ramp_s: float = 0.5) -> MotionTrack:
    """A motion that begins and ends at rest where it began, so that it can be repeated."""
    u = np.clip(np.minimum(track.t - track.t[0], track.t[-1] - track.t) / ramp_s, 0.0, 1.0)
    sign = np.where(track.t < 0.5 * (track.t[0] + track.t[-1]), 1.0, -1.0) / ramp_s
    # The smoothest polynomial that goes from 0 to 1 with both its derivatives 0 at the ends.
    w = u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    dw = 30.0 * u**2 * (1.0 - u) ** 2 * sign
    ddw = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) * sign**2
    theta = track.theta * w
    omega = track.omega * w + track.theta * dw
    alpha = track.alpha * w + 2.0 * track.omega * dw + track.theta * ddw
    return MotionTrack(track.t, theta, omega, alpha)


def absent() -> str | None:
    """Why no rig can be emulated on this system; None where one can."""
    if os.name != "posix":
        return "this system has no pseudo-terminals; use Linux, macOS or WSL"
    return None


def serve(
    emulation: Emulation,
    *,
    link: Path | None = None,
    tell: Callable[[str], None] = print,
    leash: int | None = None,
) -> None:
    """Run the rig behind a pseudo-terminal until Ctrl-C, or until the file descriptor `leash` is closed.

    `tell` is called once with the path of the port; `link` becomes a symbolic link to it.
    Raises InputError where there are no pseudo-terminals, or the link cannot be made.
    """
    if why := absent():
        raise InputError(f"emulate: {why}")
    import tty

    rig = emulation.checked().rig()
    master, slave = os.openpty()
    port = os.ttyname(slave)
    tty.setraw(slave)
    os.set_blocking(master, False)
    if link is not None:
        _make_link(link, port)
    try:
        tell(port)
        # From here on the port is open when the host has it open.
        os.close(slave)
        _go_on(rig, master, emulation.speed, leash)
    finally:
        os.close(master)
        if link is not None and link.is_symlink() and str(link.readlink()) == port:
            link.unlink()


def _make_link(link: Path, port: str) -> None:
    if link.exists():
        raise InputError(f"{link}: is there already, maybe of another emulated rig; choose another --link")
    try:
        # What leads nowhere is of a rig that was killed.
        link.unlink(missing_ok=True)
        link.symlink_to(port)
    except OSError as error:
        raise InputError(f"{link}: {error.strerror or error}; choose another --link") from None


def _go_on(rig: _core.Rig, master: int, speed: float, leash: int | None) -> None:
    clock, waiting, plugged, before = time.monotonic(), b"", False, 0.0
    watched = [master] if leash is None else [master, leash]
    while True:
        ready, _, _ = select.select(watched if plugged else watched[1:], [], [], _BEAT_S)
        if leash in ready and not os.read(leash, _READ):
            return
        heard = _read(master)
        if heard is None and plugged:
            rig.unplugged()
            waiting = b""
        plugged = heard is not None
        passed, clock = time.monotonic() - clock, time.monotonic()
        # A rig that runs faster than time waits for a host that is behind; in real time it drops samples.
        if speed > 1.0:
            passed = 0.0 if waiting else min(passed, _LEAP_S)
        now = before + passed * speed * 1e6
        # A process that was kept from running finds what came meanwhile all at once; it came one by one.
        frames = heard.split(_END) if heard else []
        for number, frame in enumerate(frames, 1):
            rig.advance(int(before + (now - before) * number / len(frames)))
            rig.hear(frame if number == len(frames) else frame + _END)
        rig.advance(int(now))
        before = now
        waiting = waiting or rig.speak(_WRITE)
        while waiting and plugged:
            try:
                waiting = waiting[os.write(master, waiting) :] or rig.speak(_WRITE)
            except BlockingIOError:
                break


def _read(master: int) -> bytes | None:
    """What the host has said; None while nobody has the port open."""
    try:
        return os.read(master, _READ)
    except BlockingIOError:
        return b""
    except OSError as error:
        if error.errno == errno.EIO:
            return None
        raise


class EmulatedRig:
    """An emulated rig in a process of its own; use it in a `with` statement.

    `port` is what to open, `pid` the process, `serial_number` what its DESCRIPTOR says; options as in
    `Emulation`.
    """

    def __init__(self, knob: Model | str | os.PathLike[str] = "knob3", **options: Any) -> None:
        emulation = Emulation(knob, **options).checked()
        self.serial_number = emulation.serial_number
        self._files = tempfile.TemporaryDirectory(prefix="knobcam-rig-")
        model = emulation.model().save(Path(self._files.name) / "knob.toml")
        words = [sys.executable, "-m", "knobcam", "emulate", str(model), "--leashed"]
        words += ["--fixture", emulation.fixture, "--seed", str(emulation.seed)]
        words += ["--speed", repr(emulation.speed), "--c-cal", repr(emulation.c_cal)]
        words += [] if emulation.noise else ["--noise", "none"]
        words += [] if emulation.motion is None else ["--motion", os.fspath(emulation.motion)]
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None  # it is a pipe
        self.port = self._process.stdout.readline().strip()
        if not self.port:
            self.close()
            raise InputError("emulated rig: did not start; run `knobcam emulate` to see why")

    @property
    def pid(self) -> int:
        """Its process."""
        return self._process.pid

    def kill(self) -> None:
        """End it at once, as if its plug were pulled."""
        self._process.send_signal(signal.SIGKILL)
        self.close()

    def close(self) -> None:
        """End it, and wait until it has."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        self._process.wait(_START_S)
        self._files.cleanup()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
