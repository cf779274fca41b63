"""How each result shows itself: the one place where results meet pictures, linked plots and reports."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..capture import Capture
from ..capture.prepare import Prepared
from ..fit import Fit
from ..fit.compare import Comparison
from ..fit.diagnose import Diagnosis
from ..fit.forward import Forward
from ..fit.stiction import Stiction
from ..fleet import BatchResult
from ..learn import LearningResult
from ..learn.experiment import Experiment
from ..learn.proposals import Proposals
from ..model import Model
from ..model.effects import Effect
from ..render import Stability
from ..render.convert import Conversion
from ..render.loop_report import LoopReport
from ..rig.calibration import Calibration
from .linked import Look
from .samples import Shown, steps
from .tables import html as html

if TYPE_CHECKING:
    import os
    from pathlib import Path

    from matplotlib.figure import Figure


def plot(result: object) -> Figure:
    """Return the picture of a result."""
    from . import plot as pictures  # loads matplotlib, which nothing else here needs

    match result:
        case Capture():
            return pictures.capture(result)
        case Prepared():
            return pictures.prepared(result)
        case Model():
            return pictures.model(result)
        case Effect():
            return pictures.effect(result)
        case Fit():
            return pictures.fit(result)
        case Comparison():
            return pictures.comparison(result)
        case Forward():
            return pictures.forward(result)
        case Stiction():
            return pictures.stiction(result.fit, result)
        case Diagnosis():
            return pictures.diagnosis(result)
        case LearningResult():
            return pictures.learned(result)
        case Experiment():
            return pictures.experiment(result)
        case Proposals():
            return pictures.proposals(result)
        case Stability():
            return pictures.stability(result)
        case LoopReport():
            return pictures.timing(result)
        case Conversion():
            return pictures.converted(result)
        case Calibration():
            return pictures.calibration(result)
        case BatchResult():
            return pictures.batch_parameters(result)
    raise TypeError(f"{type(result).__name__} has no picture")


def look(result: object) -> Look:
    """Return the linked plots of a result."""
    match result:
        case Fit():
            return Look((Shown("fit", result),))
        case Diagnosis():
            return Look((Shown("fit", result.fit, result),))
        case LearningResult():
            return Look(steps(result))
    raise TypeError(f"{type(result).__name__} has no linked plots")


def report(result: object, path: str | os.PathLike[str]) -> Path:
    """Write the report of what was learned and return its path."""
    match result:
        case LearningResult():
            from .report import write

            return write(result, path)
        case BatchResult():
            from .batch_report import write as write_batch

            return write_batch(result, path)
    raise TypeError(f"{type(result).__name__} has no report")
