"""Rendering: the step that answers a hand with the model's torque, its loop, and what a device allows."""
