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
_BUILD = "cargo build --release --package knobstep"
_ROOM = 400  # bytes of the line in which the library refuses a model


def shared() -> Path:
    """Return the shared library of this platform. InputError where the package came without."""
    path = _FOLDER / _SHARED.get(sys.platform, "libknobstep.so")
    if not path.is_file():
        raise InputError(
            f"{path}: is missing, and with it what runs a model outside of Python; build it in a checkout "
            f"with `{_BUILD}` and put it there"
        )
    return path


def static() -> Path | None:
    """Return the static library of this platform; None where the package came without."""
    path = _FOLDER / _STATIC.get(sys.platform, "libknobstep.a")
    return path if path.is_file() else None


def fmi_platform() -> str:
    """Return the folder of an FMU of FMI 2.0 that this platform's library belongs in."""
    machine = platform.machine().lower()
    if machine in ("x86_64", "amd64"):
        return {"darwin": "darwin64", "win32": "win64"}.get(sys.platform, "linux64")
    return f"{machine}-{ {'win32': 'windows'}.get(sys.platform, sys.platform) }"


@cache
def loaded() -> Any:
    """Return the shared library with the types of its functions."""
    library = ctypes.CDLL(str(shared()))
    text, number, whole, knob = ctypes.c_char_p, ctypes.c_double, ctypes.c_int, ctypes.c_void_p
    library.knobcam_new.argtypes = [text, number, whole, text, ctypes.c_size_t]
    library.knobcam_new.restype = knob
    library.knobcam_step.argtypes = [knob, number, number, number]
    library.knobcam_step.restype = number
    library.knobcam_free.argtypes = [knob]
    library.knobcam_free.restype = None
    return library


def torque_along(model: str, options: Options) -> FloatArray:
    """Return the torque that the library renders of a model's text along an imposed motion, N m."""
    library = loaded()
    why = ctypes.create_string_buffer(_ROOM)
    knob = library.knobcam_new(model.encode(), options.rate_hz, 1, why, _ROOM)
    if not knob:
        raise InputError(why.value.decode())
    try:
        _, *motion = options.motion
        return np.array([library.knobcam_step(knob, *row) for row in zip(*motion, strict=True)])
    finally:
        library.knobcam_free(knob)
