"""knobcam: a haptic camera. Measure a knob, fit its physics, learn which effect is missing.

>>> import knobcam as kc
>>> cap = kc.simulate(kc.Model.load("knob3"), "sweep")
>>> fit = kc.fit(cap)
>>> round(fit.params["detent.P"].value, 3)
0.034
"""

from __future__ import annotations

from ._core import __version__
from .capture import Capture, load
from .compare import Comparison, compare
from .effects import Effect, effects
from .errors import InputError, KnobcamError
from .fit import Estimate, Fit, fit
from .model import KNOBS, Model, Parameter
from .motions import MOTIONS, MotionTrack, motion
from .prepare import Prepared, prepare
from .simulate import SensorNoise, simulate
from .stiction import Stiction, stiction

__all__ = [
    "KNOBS",
    "MOTIONS",
    "Capture",
    "Comparison",
    "Effect",
    "Estimate",
    "Fit",
    "InputError",
    "KnobcamError",
    "Model",
    "MotionTrack",
    "Parameter",
    "Prepared",
    "SensorNoise",
    "Stiction",
    "__version__",
    "compare",
    "effects",
    "fit",
    "load",
    "motion",
    "prepare",
    "simulate",
    "stiction",
]
