"""Pictures of captures, models and fits: each call returns a matplotlib figure and leaves no global state."""

from __future__ import annotations

from .calibration import calibration
from .candidates import diagnosis
from .change import before_after
from .failures import comparison
from .felt import felt
from .gallery import save_all, save_story
from .ladder import ladder
from .laws import model
from .movements import movements
from .over_time import capture, overlay, prepared
from .profile import haptic_profile
from .rest import residual, scan
from .signature import effect
from .stability import stability
from .standstill import stiction
from .story import remaining, story
from .timing import timing
from .torques import fit, position, velocity, zoom

__all__ = [
    "before_after",
    "calibration",
    "capture",
    "comparison",
    "diagnosis",
    "effect",
    "felt",
    "fit",
    "haptic_profile",
    "ladder",
    "model",
    "movements",
    "overlay",
    "position",
    "prepared",
    "remaining",
    "residual",
    "save_all",
    "save_story",
    "scan",
    "stability",
    "stiction",
    "story",
    "timing",
    "velocity",
    "zoom",
]
