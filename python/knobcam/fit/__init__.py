"""Fits: parameters from captures, where they fail, and what each effect that is missing would change."""

from .fitting import Estimate, Fit, fit

__all__ = ["Estimate", "Fit", "fit"]
