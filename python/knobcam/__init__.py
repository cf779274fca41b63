"""knobcam: a haptic camera. Measure a knob, fit its physics, learn which effect is missing.

>>> import knobcam as kc
>>> cap = kc.simulate(kc.Model.load("knob3"), "sweep")
>>> fit = kc.fit(cap)
>>> round(fit.params["detent.P"].value, 3)
0.034
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._core import __version__
    from .agreement import Disagreement
    from .capture import Capture, load
    from .compare import Comparison, compare
    from .diagnose import Candidate, Diagnosis, diagnose
    from .effects import Effect, effects
    from .emulated import EmulatedHandle
    from .errors import InputError, KnobcamError, KnobcamWarning
    from .fit import Estimate, Fit, fit
    from .hiding import hiding
    from .lacks import Lack
    from .ladder import Rung, Unexplained
    from .learn import Story, learn
    from .loop import run_loop, start_loop
    from .loop_report import LoopReport
    from .model import KNOBS, Model, Parameter
    from .motions import MOTIONS, MotionTrack, motion
    from .own import OwnMotion, OwnParameter, forget_effect, own_effect
    from .prepare import Prepared, prepare
    from .refit import Moved
    from .render import Device, Renderer, Stability, check_stability
    from .rig.link import Link
    from .rig.record import record
    from .rig.wirelog import WireLog
    from .simulate import SensorNoise, simulate
    from .stiction import Stiction, stiction

__all__ = [
    "KNOBS",
    "MOTIONS",
    "Candidate",
    "Capture",
    "Comparison",
    "Device",
    "Diagnosis",
    "Disagreement",
    "Effect",
    "EmulatedHandle",
    "Estimate",
    "Fit",
    "InputError",
    "KnobcamError",
    "KnobcamWarning",
    "Lack",
    "Link",
    "LoopReport",
    "Model",
    "MotionTrack",
    "Moved",
    "OwnMotion",
    "OwnParameter",
    "Parameter",
    "Prepared",
    "Renderer",
    "Rung",
    "SensorNoise",
    "Stability",
    "Stiction",
    "Story",
    "Unexplained",
    "WireLog",
    "__version__",
    "check_stability",
    "compare",
    "diagnose",
    "effects",
    "fit",
    "forget_effect",
    "hiding",
    "learn",
    "load",
    "motion",
    "own_effect",
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
    "MOTIONS": "motions",
    "Candidate": "diagnose",
    "Capture": "capture",
    "Comparison": "compare",
    "Device": "render",
    "Diagnosis": "diagnose",
    "Disagreement": "agreement",
    "Effect": "effects",
    "EmulatedHandle": "emulated",
    "Estimate": "fit",
    "Fit": "fit",
    "InputError": "errors",
    "KnobcamError": "errors",
    "KnobcamWarning": "errors",
    "Lack": "lacks",
    "Link": "rig.link",
    "LoopReport": "loop_report",
    "Model": "model",
    "MotionTrack": "motions",
    "Moved": "refit",
    "OwnMotion": "own",
    "OwnParameter": "own",
    "Parameter": "model",
    "Prepared": "prepare",
    "Renderer": "render",
    "Rung": "ladder",
    "SensorNoise": "simulate",
    "Stability": "render",
    "Stiction": "stiction",
    "Story": "learn",
    "Unexplained": "ladder",
    "WireLog": "rig.wirelog",
    "__version__": "_core",
    "check_stability": "render",
    "compare": "compare",
    "diagnose": "diagnose",
    "effects": "effects",
    "fit": "fit",
    "forget_effect": "own",
    "hiding": "hiding",
    "learn": "learn",
    "load": "capture",
    "motion": "motions",
    "own_effect": "own",
    "prepare": "prepare",
    "record": "rig.record",
    "run_loop": "loop",
    "simulate": "simulate",
    "start_loop": "loop",
    "stiction": "stiction",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """Keeps `knobcam.fit` the function: the import system binds the module of that name over it."""

    def __setattr__(self, name: str, value: Any) -> None:
        if _HOME.get(name) == name and isinstance(value, ModuleType):
            value = getattr(value, name)
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
