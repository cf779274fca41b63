"""Pictures of captures, models and fits: each call returns a matplotlib figure and leaves no global state."""

from __future__ import annotations

from .failures import comparison
from .gallery import save_all
from .laws import model
from .over_time import capture, overlay, prepared
from .profile import haptic_profile
from .rest import residual, scan
from .signature import effect
from .standstill import stiction
from .torques import fit, position, velocity, zoom

__all__ = [
    "capture",
    "comparison",
    "effect",
    "fit",
    "haptic_profile",
    "model",
    "overlay",
    "position",
    "prepared",
    "residual",
    "save_all",
    "scan",
    "stiction",
    "velocity",
    "zoom",
]
