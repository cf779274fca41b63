"""Knobs with a hidden effect: an independent simulator of richer physics than the catalogue's formulas.

Nothing here uses knobcam: its laws, its filter and its motions are written a second time, so that a
diagnosis is examined on physics and not on its own equations.
"""

from .faults import FAULTS, Fault
from .likeness import ALIKE, BUILDS_UP
from .make import ACCEPTED, KINDS, Hidden, make
from .motions import MOTIONS
from .series import SERIES
from .shapes import NAMED
from .strange import STRANGE
from .stranger import STRANGER

__all__ = [
    "ACCEPTED",
    "ALIKE",
    "BUILDS_UP",
    "FAULTS",
    "KINDS",
    "MOTIONS",
    "NAMED",
    "SERIES",
    "STRANGE",
    "STRANGER",
    "Fault",
    "Hidden",
    "make",
]
