"""Heavy packages are imported when a file asks for them, and their absence is a message, not a traceback."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ..errors import InputError


def require(module: str, purpose: str, extra: str = "formats") -> Any:
    """Import `module`, or raise InputError naming what it is for and how to install it."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise InputError(
            f'{purpose} needs the package {package}; run: pip install "knobcam[{extra}]" ({error})'
        ) from error
