"""Fits: parameters from captures, where they fail, and what each effect that is missing would change."""

from .estimate import Estimate
from .fitting import Fit, fit

__all__ = ["Estimate", "Fit", "fit"]
