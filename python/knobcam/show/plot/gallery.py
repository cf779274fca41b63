"""The standard set of pictures of a fit, as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...base.writing import make_folder, together
from .candidates import diagnosis
from .change import before_after
from .failures import comparison as draw_comparison
from .forward import forward as draw_forward
from .ladder import ladder
from .laws import model
from .learned import learned as draw_learned
from .learned import remaining
from .movements import movements
from .over_time import capture, prepared
from .profile import haptic_profile
from .rest import residual, scan
from .standstill import stiction
from .torques import fit as draw_fit
from .torques import position, velocity, zoom

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping

    from ...fit import Fit
    from ...fit.compare import Comparison
    from ...fit.forward import Forward
    from ...learn import LearningResult
    from .style import Picture

_DPI = 130


def save_all(
    fit: Fit,
    folder: str | os.PathLike[str],
    comparison: Comparison | None = None,
    forward: Forward | None = None,
    kind: str = "png",
) -> list[Path]:
    """Write the standard pictures of a fit into a folder, made if need be, and return their paths.

    `kind` is png, svg or pdf. Of several captures the first is shown over time.
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
    if forward is not None:
        pictures["forward"] = lambda: draw_forward(forward)
    return _save(pictures, Path(folder), kind)


def save_learning(
    learned: LearningResult,
    folder: str | os.PathLike[str],
    rendered: Fit | None = None,
    kind: str = "png",
) -> list[Path]:
    """Write the pictures of what was learned into a folder, made if need be, and return their paths.

    `rendered` is the fit of what a device rendered of it, if one did; `kind` is png, svg or pdf.
    """
    pictures: dict[str, Callable[[], Picture]] = {
        "story": lambda: draw_learned(learned),
        "ladder": lambda: ladder(learned),
        "before-after": lambda: before_after(learned),
        "movements": lambda: movements(learned),
        "diagnosis-first": lambda: diagnosis(learned.first_diagnosis),
        "diagnosis-last": lambda: diagnosis(learned.last),
        "remaining": lambda: remaining(learned),
    }
    if rendered is not None:
        pictures["rendered"] = lambda: position(rendered)
    if len(learned.ladder) == 1:
        del pictures["movements"], pictures["diagnosis-first"]
    return _save(pictures, Path(folder), kind)


def _save(pictures: Mapping[str, Callable[[], Picture]], folder: Path, kind: str) -> list[Path]:
    paths = [folder / f"{number:02d}-{name}.{kind}" for number, name in enumerate(pictures, start=1)]
    with together():
        make_folder(folder)
        for path, draw in zip(paths, pictures.values(), strict=True):
            draw().savefig(path, dpi=_DPI)
    return paths
