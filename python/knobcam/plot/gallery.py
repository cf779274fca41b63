"""The standard set of pictures of a fit, as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .failures import comparison as draw_comparison
from .laws import model
from .over_time import capture, prepared
from .profile import haptic_profile
from .rest import residual, scan
from .standstill import stiction
from .torques import fit as draw_fit
from .torques import position, velocity, zoom

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from ..compare import Comparison
    from ..fit import Fit
    from .style import Picture

_DPI = 130


def save_all(fit: Fit, folder: str | os.PathLike[str], comparison: Comparison | None = None) -> list[Path]:
    """Write the standard pictures of a fit as PNG into a folder, made if need be, and return their paths.

    Of several captures the first is shown over time.
    """
    first = fit.prepared[0]
    pictures: dict[str, Callable[[], Picture]] = {
        "capture": lambda: capture(first.capture),
        "prepared": lambda: prepared(first),
        "fit": lambda: draw_fit(fit),
        "position": lambda: position(fit),
        "velocity": lambda: velocity(fit),
        "zoom": lambda: zoom(fit),
        "model": lambda: model(fit.model),
        "stiction": lambda: stiction(fit),
        "haptic-profile": lambda: haptic_profile(fit),
        "residual": lambda: residual(fit),
    }
    if fit.core.scan is not None:
        pictures["scan"] = lambda: scan(fit)
    if comparison is not None:
        pictures["comparison"] = lambda: draw_comparison(comparison)
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, (name, draw) in enumerate(pictures.items(), start=1):
        path = target / f"{number:02d}-{name}.png"
        draw().savefig(path, dpi=_DPI)
        paths.append(path)
    return paths
