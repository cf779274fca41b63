"""knobcam: a haptic camera. Measure a knob, fit its physics, learn which effect is missing.

>>> import knobcam as kc
>>> cap = kc.simulate(kc.Model.load("knob3"), "sweep")
>>> fit = kc.fit(cap)
>>> round(fit.params["detent.P"].value, 3)
0.034

The packages stand in one order, and each imports only from those above it (`.importlinter` holds that):

errors          what is raised
base            files written whole, JSON and what pages are told, tables, arrays, how a result shows itself
capture         captures: formats, faults of logs, motions, prepared signals
model           models, the catalogue of effects, effects of one's own, the five knobs, simulated captures
fit             the fit, where it fails, what each effect more would change
learn           the loop to a verdict: what comes in, when to stop, what the captures cannot tell
fleet           batches of many captures, limits, lots, a station that watches a folder
render          the step of a rendered model, its loop, what a device allows; models for other programs
rig             the port, the wire log, recording, calibration, an emulated rig
show            pictures, linked plots, tables, reports: what results are shown by, and know nothing of
workbench       the page's server
cli             the command, a subcommand for each stage

A sample is recorded by `rig` or read by `capture`, fitted and weighed by `fit`; `learn` comes to the verdict,
`show` tells it, and `render` gives what was learned back to a hand.
"""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from .base import leaving, moved, showing

if TYPE_CHECKING:
    from collections.abc import Callable

    from ._core import __version__
    from .capture import Capture, load
    from .capture.motions import MOTIONS, MotionTrack, motion
    from .capture.prepare import Prepared, prepare
    from .errors import InputError, KnobcamError, KnobcamWarning
    from .fit import Estimate, Fit, fit
    from .fit.compare import Comparison, compare
    from .fit.constants import fit_constants
    from .fit.diagnose import Candidate, Diagnosis, diagnose
    from .fit.forward import Forward
    from .fit.refit import Moved
    from .fit.stiction import Stiction, stiction
    from .fleet import BatchResult, batch
    from .learn import LearningResult, learn
    from .learn.agreement import Disagreement
    from .learn.cut import Cut, Interrupted
    from .learn.designing import next_experiment
    from .learn.experiment import Experiment
    from .learn.ladder import LearningStep, Unexplained
    from .learn.limitations import Limitation
    from .learn.limits import Limits
    from .model import KNOBS, Model, Parameter
    from .model.effects import Effect, effects
    from .model.hiding import hiding
    from .model.own import OwnJoint, OwnMotion, OwnParameter, forget_effect, own_effect
    from .model.own_law import own_law
    from .model.simulate import SensorNoise, simulate
    from .render import Device, Renderer, Stability, check_stability
    from .render.emulated import EmulatedHandle
    from .render.loop import run_loop, start_loop
    from .render.loop_report import LoopReport
    from .rig.link import Link
    from .rig.record import record
    from .rig.wirelog import WireLog
    from .show import plot

__all__ = [
    "KNOBS",
    "MOTIONS",
    "BatchResult",
    "Candidate",
    "Capture",
    "Comparison",
    "Cut",
    "Device",
    "Diagnosis",
    "Disagreement",
    "Effect",
    "EmulatedHandle",
    "Estimate",
    "Experiment",
    "Fit",
    "Forward",
    "InputError",
    "Interrupted",
    "KnobcamError",
    "KnobcamWarning",
    "LearningResult",
    "LearningStep",
    "Limitation",
    "Limits",
    "Link",
    "LoopReport",
    "Model",
    "MotionTrack",
    "Moved",
    "OwnJoint",
    "OwnMotion",
    "OwnParameter",
    "Parameter",
    "Prepared",
    "Renderer",
    "SensorNoise",
    "Stability",
    "Stiction",
    "Unexplained",
    "WireLog",
    "__version__",
    "batch",
    "check_stability",
    "compare",
    "diagnose",
    "effects",
    "fit",
    "fit_constants",
    "forget_effect",
    "hiding",
    "learn",
    "load",
    "motion",
    "next_experiment",
    "own_effect",
    "own_law",
    "plot",
    "prepare",
    "record",
    "run_loop",
    "simulate",
    "start_loop",
    "stiction",
]

# Where each name lives. A name is imported when it is first used (PEP 562), so `knobcam --help` waits for
# neither NumPy nor the core.
_HOME = {
    "KNOBS": "model",
    "MOTIONS": "capture.motions",
    "BatchResult": "fleet",
    "Candidate": "fit.diagnose",
    "Capture": "capture",
    "Comparison": "fit.compare",
    "Device": "render",
    "Diagnosis": "fit.diagnose",
    "Cut": "learn.cut",
    "Disagreement": "learn.agreement",
    "Interrupted": "learn.cut",
    "Effect": "model.effects",
    "EmulatedHandle": "render.emulated",
    "Experiment": "learn.experiment",
    "Estimate": "fit",
    "Fit": "fit",
    "Forward": "fit.forward",
    "InputError": "errors",
    "KnobcamError": "errors",
    "KnobcamWarning": "errors",
    "LearningResult": "learn",
    "LearningStep": "learn.ladder",
    "Limits": "learn.limits",
    "Limitation": "learn.limitations",
    "Link": "rig.link",
    "LoopReport": "render.loop_report",
    "Model": "model",
    "MotionTrack": "capture.motions",
    "Moved": "fit.refit",
    "OwnJoint": "model.own",
    "OwnMotion": "model.own",
    "OwnParameter": "model.own",
    "Parameter": "model",
    "Prepared": "capture.prepare",
    "Renderer": "render",
    "SensorNoise": "model.simulate",
    "Stability": "render",
    "Stiction": "fit.stiction",
    "Unexplained": "learn.ladder",
    "WireLog": "rig.wirelog",
    "__version__": "_core",
    "batch": "fleet",
    "check_stability": "render",
    "compare": "fit.compare",
    "diagnose": "fit.diagnose",
    "effects": "model.effects",
    "fit": "fit",
    "fit_constants": "fit.constants",
    "forget_effect": "model.own",
    "hiding": "model.hiding",
    "learn": "learn",
    "load": "capture",
    "motion": "capture.motions",
    "next_experiment": "learn.designing",
    "own_effect": "model.own",
    "own_law": "model.own_law",
    "plot": "show.plot",
    "prepare": "capture.prepare",
    "record": "rig.record",
    "run_loop": "render.loop",
    "simulate": "model.simulate",
    "start_loop": "render.loop",
    "stiction": "fit.stiction",
}


# Older names, for one version.
_RENAMED = {"Lack": "Limitation", "Rung": "LearningStep", "Story": "LearningResult"}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        warnings.warn(f"knobcam.{name} is now called {_RENAMED[name]}", DeprecationWarning, stacklevel=2)
        return getattr(sys.modules[__name__], _RENAMED[name])
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = import_module(f".{_HOME[name]}", __name__)
    value = home if name == "plot" else getattr(home, name)  # the pictures are a module of their own
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _show() -> showing.Shows:
    from .show import results

    return results


def _leave() -> Callable[..., leaving.Left]:
    from .render.convert import convert

    return convert


class _Package(ModuleType):
    """Keeps `knobcam.fit` the function: the import system would bind the package of that name over it."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
showing.answered_by(_show)
leaving.answered_by(_leave)
moved.found_under(
    {
        "knobcam.compare": "knobcam.fit.compare",
        "knobcam.effects": "knobcam.model.effects",
        "knobcam.finding": "knobcam.capture.finding",
        "knobcam.linked": "knobcam.show.linked",
        "knobcam.loop": "knobcam.render.loop",
        "knobcam.loop_report": "knobcam.render.loop_report",
        "knobcam.plot": "knobcam.show.plot",
    }
)
