"""The whole job without hardware: a knob that hides an effect, recorded, the effect found, the model felt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..base.tables import text_table
from ..base.writing import make_folder, together
from ..errors import InputError
from ..fit import fit
from ..learn import learn
from ..model import Model
from ..model.hiding import hiding
from ..rig.emulator import EMULATED, EmulatedRig
from ..rig.record import record
from ..rig.wirelog import WireLog

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from ..fit import Fit
    from ..learn import LearningResult
    from ..rig.figures import Figures

HIDDEN = "stribeck"
"""What the knob hides when nothing else is asked for."""
FASTER = 10.0
"""Times real time that the emulated rig of a demonstration runs at."""


@dataclass(frozen=True, repr=False)
class Demo:
    """What the demonstration made: the emulated knob, what it hides, what was learned of it, the files.

    `rendered` is the learned model, fitted again to a capture of the device that rendered it.
    """

    knob: Model
    hidden: tuple[str, ...]
    learned: LearningResult
    rendered: Fit
    files: Mapping[str, Any]

    def __repr__(self) -> str:
        true, again = _with_positive_amplitude(self.knob), self.rendered.params
        rows = [
            (
                name,
                f"{true[name]:.5g}" if name in true else "-",
                f"{e.value:.5g}" if e.determined else "-",
                e.interval,
                f"{again[name].value:.5g}" if name in again and again[name].determined else "-",
                e.unit,
            )
            for name, e in self.learned.fit.params.items()
        ]
        head = ("parameter", "emulated", "learned", "95 % interval", "felt on the device", "unit")
        hides = f"{self.knob.name}, which hides {', '.join(self.hidden)}"
        return f"{hides}\n{self.learned!r}\n{text_table(head, rows)}"


def _with_positive_amplitude(knob: Model) -> dict[str, float]:
    """Parameter values, the detents as a fit writes them: -A sin(x + S) is A sin(x + S + pi)."""
    values = {name: parameter.value for name, parameter in knob.params.items()}
    if values.get("detent.A", 0.0) < 0.0:
        values["detent.A"] *= -1.0
        values["detent.S"] += math.pi if values["detent.S"] <= 0.0 else -math.pi
    return values


def run(knob: str, effect: str, folder: Path, status: Callable[[str], None]) -> Demo:
    """Hide an effect in a knob on an emulated rig, record it over the port, learn what is missing, feel it.

    Everything is written to `folder`, made if need be; `status` is told each step.
    """
    model = hiding(knob, effect)
    make_folder(folder)
    for log in (folder / "capture.kcwire", folder / "rendered.kcwire"):
        if log.exists():
            _remove(log)

    def watch(doing: str) -> Callable[[Figures], None]:
        return lambda figures: status(f"{doing}: {figures.received} samples, {figures.missing} lost")

    with EmulatedRig(model, speed=FASTER) as rig:
        status(f"recording {knob} over {rig.port}")
        seen = watch(f"recording {knob} over {rig.port}")
        capture = record(rig.port, "sweep", output=folder / "capture.npz", progress=seen, overwrite=True)
        learned = learn(capture, progress=status)
        felt = feelable(learned.model)
        seen = watch("recording the learned model, which the device renders")
        # No hand is on an emulated rig: what was learned is shown as it is.
        again = record(
            rig.port,
            "sweep",
            output=folder / "rendered.npz",
            model=felt,
            progress=seen,
            force=True,
            overwrite=True,
        )
    rendered = fit(again, model=felt)

    status("drawing")
    from ..show import plot

    with together():
        fitted = learned.model.renamed(f"{knob}, fitted").save(folder / "model.toml")
        pictures = plot.save_learning(learned, folder, rendered)
        status("writing the report")
        report = learned.report(folder / "report.html")
    files = {
        "folder": str(folder.absolute()),
        "log": str(folder / "capture.kcwire"),
        "capture": str(folder / "capture.npz"),
        "model": str(fitted),
        "rendered": str(folder / "rendered.npz"),
        "report": str(report),
        "pictures": [str(path) for path in pictures],
    }
    return Demo(model, (effect,), learned, rendered, files)


def _remove(log: Path) -> None:
    """Remove the recording of a demonstration before this one, and nobody else's."""
    device = WireLog.load(log).device
    if device is None or not device["serial"].startswith(EMULATED):
        raise InputError(f"{log}: is a recording of another rig, which is kept; choose another folder")
    log.unlink()


def feelable(model: Model) -> Model:
    """Return the model without the effects of the sensor: no hand feels them, they are the rig's."""
    places = model.catalogue()
    return Model(model.core.only([name for name in model.effects if places[name].place != "sensor"]))
