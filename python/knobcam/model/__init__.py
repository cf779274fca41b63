"""Models: chains of effects with values; the catalogue they are made of, and captures simulated from them."""

from .model import KNOBS, Model, Parameter

__all__ = ["KNOBS", "Model", "Parameter"]
