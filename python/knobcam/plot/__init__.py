"""Pictures of captures, models and fits; each call returns a matplotlib figure and touches no global state."""

from __future__ import annotations

from .over_time import capture, overlay, prepared
from .torques import fit, position, velocity, zoom

__all__ = [
    "capture",
    "fit",
    "overlay",
    "position",
    "prepared",
    "velocity",
    "zoom",
]
