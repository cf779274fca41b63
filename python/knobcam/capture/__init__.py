"""Captures: what was measured, from any file, checked, and prepared for a fit."""

from .capture import Capture, load
from .finding import Finding

__all__ = ["Capture", "Finding", "load"]
