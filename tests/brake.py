"""A knob with a brake that no effect of the catalogue is, made without this program's laws."""

from __future__ import annotations

import dataclasses

import knobcam as kc
from knobcam.capture.motions import MotionTrack


def braked_knob(torque_Nm: float, at_rad_s: float) -> kc.Capture:
    """A sweep of knob 4 with an eddy-current brake: half of this torque at that speed, less elsewhere."""
    plain = kc.simulate("knob4", "sweep", duration_s=4.0, rate_hz=2000.0, seed=3)
    return braked(plain, kc.motion("sweep", 4.0, 2000.0), torque_Nm, at_rad_s)


def braked(capture: kc.Capture, track: MotionTrack, torque_Nm: float, at_rad_s: float) -> kc.Capture:
    """A capture of a motion with that brake beside all else."""
    speed = track.omega / at_rad_s
    return dataclasses.replace(capture, tau=capture.tau + torque_Nm * speed / (1.0 + speed**2))
