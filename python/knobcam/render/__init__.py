"""Rendering: the step that answers a hand with the model's torque, its loop, and what a device allows."""

from .renderer import (
    Device,
    Renderer,
    Stability,
    check_passive,
    check_rotary,
    check_stability,
    check_torque,
)

__all__ = [
    "Device",
    "Renderer",
    "Stability",
    "check_passive",
    "check_rotary",
    "check_stability",
    "check_torque",
]
