"""The whole job without hardware: one of the paper's five knobs on its rig, recorded, fitted and compared."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .capture import load
from .errors import InputError
from .fit import fit
from .model import KNOBS, Model
from .simulate import simulate
from .tables import text_table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from .compare import Comparison
    from .fit import Fit


@dataclass(frozen=True, repr=False)
class Demo:
    """What the demonstration made: the emulated knob, its fit, the comparison, and the files."""

    knob: Model
    fit: Fit
    comparison: Comparison
    files: Mapping[str, Any]

    def __repr__(self) -> str:
        true = _with_positive_amplitude(self.knob)
        rows = [
            (name, f"{true[name]:.5g}" if name in true else "-", f"{e.value:.5g}", e.interval, e.unit)
            for name, e in self.fit.params.items()
        ]
        head = ("parameter", "emulated", "fitted", "95 % interval", "unit")
        return f"{self.knob.name}\n{text_table(head, rows)}\n{self.comparison.summary}"


def _with_positive_amplitude(knob: Model) -> dict[str, float]:
    """Parameter values, the detents as a fit writes them: -A sin(x + S) is A sin(x + S + pi)."""
    values = {name: parameter.value for name, parameter in knob.params.items()}
    if values.get("detent.A", 0.0) < 0.0:
        values["detent.A"] *= -1.0
        values["detent.S"] += math.pi if values["detent.S"] <= 0.0 else -math.pi
    return values


def knob_name(text: str) -> str:
    """Return the name of one of the five knobs from its name or number.

    Raises InputError for any other.
    """
    name = f"knob{text}" if text.isdecimal() else text
    if name not in KNOBS:
        raise InputError(f"knob={text!r} is none of the five; choose 1 to {len(KNOBS)}")
    return name


def run(knob: str, folder: Path, status: Callable[[str], None]) -> Demo:
    """Simulate a knob on the paper's rig, write the capture, read it back, fit, compare, draw.

    Everything is written to `folder`, made if need be; `status` is told each step.
    """
    status(f"recording {knob} on the emulated rig")
    model = Model.load(knob)
    folder.mkdir(exist_ok=True)
    capture = load(simulate(model, "sweep").save(folder / "capture.npz"))

    status("fitting")
    fitted = fit(capture)
    fitted_path = fitted.model.renamed(f"{knob}, fitted").save(folder / "model.toml")
    status("comparing")
    comparison = fitted.compare()

    status("drawing")
    from . import plot

    pictures = plot.save_all(fitted, folder, comparison=comparison)
    files = {
        "folder": str(folder.absolute()),
        "capture": str(folder / "capture.npz"),
        "model": str(fitted_path),
        "pictures": [str(path) for path in pictures],
    }
    return Demo(model, fitted, comparison, files)
