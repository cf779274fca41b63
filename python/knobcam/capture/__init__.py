"""Captures: what was measured, from any file, checked, and prepared for a fit."""

from .capture import Capture, load

__all__ = ["Capture", "load"]
