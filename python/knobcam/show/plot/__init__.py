"""Pictures of captures, models and fits: each call returns a matplotlib figure and leaves no global state."""

from __future__ import annotations

import warnings
from typing import Any

from .calibration import calibration
from .candidates import diagnosis
from .change import before_after
from .converted import converted
from .experiment import experiment
from .failures import comparison
from .felt import felt
from .forward import forward
from .gallery import save_all, save_learning
from .ladder import ladder
from .laws import model
from .learned import learned, remaining
from .lots import batch, batch_charts, batch_curves, batch_hints, batch_parameters
from .movements import movements
from .over_time import capture, overlay, prepared
from .profile import haptic_profile
from .proposed import proposals
from .rest import residual, scan
from .signature import effect
from .stability import stability
from .standstill import stiction
from .timing import timing
from .torques import fit, position, velocity, zoom

__all__ = [
    "batch",
    "batch_charts",
    "batch_curves",
    "batch_hints",
    "batch_parameters",
    "before_after",
    "calibration",
    "capture",
    "comparison",
    "converted",
    "diagnosis",
    "effect",
    "experiment",
    "felt",
    "fit",
    "forward",
    "haptic_profile",
    "ladder",
    "learned",
    "model",
    "movements",
    "overlay",
    "position",
    "prepared",
    "proposals",
    "remaining",
    "residual",
    "save_all",
    "save_learning",
    "scan",
    "stability",
    "stiction",
    "timing",
    "velocity",
    "zoom",
]

_RENAMED = {"save_story": "save_learning", "story": "learned"}  # older names, for one version


def __getattr__(name: str) -> Any:
    if name not in _RENAMED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn(f"kc.plot.{name} is now called {_RENAMED[name]}", DeprecationWarning, stacklevel=2)
    return globals()[_RENAMED[name]]
