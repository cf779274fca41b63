"""The compiled render step for programs in C and for simulators, which comes with the package."""

from __future__ import annotations

import ctypes
import platform
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from .target import Options

_FOLDER = Path(__file__).parents[1] / "lib"
_SHARED = {"darwin": "libknobstep.dylib", "win32": "knobstep.dll"}
_STATIC = {"win32": "knobstep.lib"}
_ROOM = 400  # bytes of the line in which the library refuses a model


def shared() -> Path:
    """Return the shared library of this platform. InputError where the package came without."""
    path = _FOLDER / _SHARED.get(sys.platform, "libknobstep.so")
    if not path.is_file():
        raise InputError(
            f"{path}: is missing, and with it what runs a model outside of Python; `python3 dev.py setup` "
            "builds it in a checkout, and a wheel has it"
        )
    return path


def static() -> Path | None:
    """Return the static library of this platform; None where the package came without."""
    path = _FOLDER / _STATIC.get(sys.platform, "libknobstep.a")
    return path if path.is_file() else None


def fmi_platform(version: int) -> str:
    """Return the folder of an FMU of a version of FMI that this platform's library belongs in."""
    machine = platform.machine().lower()
    usual = machine in ("x86_64", "amd64")
    if usual and version == 2:
        return {"darwin": "darwin64", "win32": "win64"}.get(sys.platform, "linux64")
    machine = "x86_64" if usual else {"arm64": "aarch64"}.get(machine, machine)
    return f"{machine}-{ {'win32': 'windows'}.get(sys.platform, sys.platform) }"


@cache
def loaded() -> Any:
    """Return the shared library with the types of its functions."""
    library = ctypes.CDLL(str(shared()))
    text, number, whole, knob = ctypes.c_char_p, ctypes.c_double, ctypes.c_int, ctypes.c_void_p
    library.knobcam_needs.argtypes = [text]
    library.knobcam_needs.restype = ctypes.c_size_t
    library.knobcam_new.argtypes = [text, number, whole, text, ctypes.c_size_t]
    library.knobcam_new.restype = knob
    library.knobcam_step.argtypes = [knob, number, number, number]
    library.knobcam_step.restype = number
    library.knobcam_free.argtypes = [knob]
    library.knobcam_free.restype = None
    return library


def needs(model: str) -> int:
    """Return the bytes of memory with which a program without an operating system makes a model's knob."""
    return int(loaded().knobcam_needs(model.encode()))


class Knob:
    """A knob of the library: the step that a program in C calls. `held` where the motion is imposed."""

    def __init__(self, model: str, rate_hz: float, *, held: bool = False) -> None:
        """Make it of a model's text. InputError says why the library does not take it."""
        self._library = loaded()
        why = ctypes.create_string_buffer(_ROOM)
        self._knob = self._library.knobcam_new(model.encode(), rate_hz, int(held), why, _ROOM)
        if not self._knob:
            raise InputError(why.value.decode())

    def __del__(self) -> None:
        if getattr(self, "_knob", None):
            self._library.knobcam_free(self._knob)

    def step(self, theta: float, omega: float, alpha: float) -> float:
        """Return the torque of the model, N m; rad, rad/s, rad/s^2."""
        return float(self._library.knobcam_step(self._knob, theta, omega, alpha))


def torque_along(model: str, options: Options) -> FloatArray:
    """Return the torque that the library renders of a model's text along an imposed motion, N m."""
    knob = Knob(model, options.rate_hz, held=True)
    _, *motion = options.motion
    return np.array([knob.step(*row) for row in zip(*motion, strict=True)])
