"""Where a knob stands before a motion, the slow way to where the motion begins, and limits on both."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..errors import InputError
from ..learn.limits import Limits
from .leadin import behind, led_in, way
from .wirelog import WireLog, begin

if TYPE_CHECKING:
    import os

    from ..capture.motions import MotionTrack
    from .asked import Asked
    from .link import Link

_FAR_RAD = math.pi  # beyond a motion's angles: so far off its encoder counts from elsewhere
_THERE_RAD = 1e-3  # as good as there
_SLACK_RAD = 0.01  # beyond an angle's limit, where a knob that was let go there may stand
_LOOK_SAMPLES = 25  # a frame of DATA
_ROUNDING = 1e-6


def stands_at(link: Link) -> float:
    """Return the angle at which the knob stands, rad, as the captures of this rig count it.

    A few samples are recorded, without torque. Raises InputError for a rig that gives none.
    """
    with tempfile.TemporaryDirectory(prefix="knobcam-look-") as folder:
        log = Path(folder) / "look.kcwire"
        begin(log, {"motion": {"name": "look", "samples": _LOOK_SAMPLES}})
        link.log_to(log)
        try:
            link.start(_LOOK_SAMPLES)
            while link.stopped is None and link.wait(1.0):
                pass
        finally:
            link.stop()
            link.log_to(None)
        runs = WireLog.load(log).runs
    if not runs or not len(runs[-1]["count"]):
        raise InputError(f"{link.port}: the rig does not say where its knob stands; check its encoder")
    return float(runs[-1]["count"][-1]) / float(link.device["counts_per_rad"])


def limits_of(given: Limits | str | os.PathLike[str] | None, link: Link) -> Limits | None:
    """Return the limits of a call; what a file does not name is what the rig itself can."""
    if given is None or isinstance(given, Limits):
        return given
    own = {"torque_Nm": link.device["torque_limit"], "sample_rate_hz": link.rate_hz}
    usual = Limits.furthest().with_some(own)
    return Limits.load(given, usual)


class Way(NamedTuple):
    """A motion from where the knob stands, the torque that the motor may give, N m, and what to say of it."""

    track: MotionTrack
    torque_Nm: float | None = None
    words: str = ""


def from_here(asked: Asked, link: Link, limits: Limits | None) -> Way:
    """Return a motion from where the knob stands, within limits.

    Raises InputError for one that goes beyond limits, or begins where the knob had better be turned to.
    """
    track, rate = asked.track, link.rate_hz
    if limits is not None:  # what no place of the knob makes right, before anything is asked of the rig
        _check_length(asked, limits, rate)
        if asked.placed:
            _check_within(asked.name, track, limits)
    if limits is None and not asked.placed:
        return Way(led_in(track, rate))
    here = stands_at(link)
    led, words = _brought(asked, here, limits, rate) if asked.placed else (led_in(track, rate), "")
    if limits is None:
        return Way(led, None, words)
    _check_within(asked.name, led._replace(theta=here + led.theta), limits)
    own = link.device["inertia"] * float(np.max(np.abs(led.alpha)))
    own += link.device["damping"] * float(np.max(np.abs(led.omega)))
    return Way(led, min(float(link.device["torque_limit"]), limits.torque_Nm + own), words)


def fitted(track: MotionTrack, here: float, limits: Limits) -> MotionTrack:
    """Return a motion that counts from where the knob stands, smaller where limits ask for that.

    Raises InputError where the knob stands at the end of its angles, or beyond.
    """
    led = led_in(track, track.rate_hz)
    rooms = (
        (limits.theta_max_rad - here, float(np.max(led.theta))),
        (here - limits.theta_min_rad, -float(np.min(led.theta))),
        (limits.omega_rad_s, float(np.max(np.abs(led.omega)))),
        (limits.alpha_rad_s2, float(np.max(np.abs(led.alpha)))),
    )
    size = min(1.0, *(room / needs for room, needs in rooms if needs > 0.0))
    if size <= 0.0:
        by = limits.middle - here
        raise InputError(
            f"limits: the knob stands at {_shown(here)} rad, at the end of theta_min_rad to theta_max_rad or "
            f"beyond: turn it by {by:+.4g} rad ({math.degrees(by):+.0f} degrees), then try again"
        )
    return track._replace(theta=size * track.theta, omega=size * track.omega, alpha=size * track.alpha)


def _check_within(name: str, track: MotionTrack, limits: Limits) -> None:
    """Refuse a motion, its angles those of the captures, that goes beyond limits."""
    found = (
        ("omega_rad_s", "rad/s", float(np.max(np.abs(track.omega))), limits.omega_rad_s, 1.0),
        ("alpha_rad_s2", "rad/s^2", float(np.max(np.abs(track.alpha))), limits.alpha_rad_s2, 1.0),
        ("theta_max_rad", "rad", float(np.max(track.theta)), limits.theta_max_rad, 1.0),
        ("theta_min_rad", "rad", float(np.min(track.theta)), limits.theta_min_rad, -1.0),
    )
    for limit, unit, reached, allowed, sign in found:
        more = _SLACK_RAD if unit == "rad" else _ROUNDING * allowed
        if sign * reached > sign * allowed + more:
            raise InputError(
                f"{name}: reaches {reached:.4g} {unit}, beyond {limit} = {allowed:.4g}; design it within "
                "these limits, or change them"
            )


def _check_length(asked: Asked, limits: Limits, rate_hz: float) -> None:
    seconds = len(asked.track.t) / rate_hz
    if seconds > limits.duration_s * (1.0 + _ROUNDING) + 1.0 / rate_hz:
        raise InputError(
            f"{asked.name}: takes {seconds:.4g} s, longer than duration_s = {limits.duration_s:.4g}; "
            "design it within these limits, or change them"
        )


def _shown(angle: float) -> str:
    return f"{round(angle, 3) + 0.0:g}"


def _brought(asked: Asked, here: float, limits: Limits | None, rate_hz: float) -> tuple[MotionTrack, str]:
    """Return a motion behind the slow way to its beginning from where the knob stands, and words for that."""
    track = asked.track
    start = float(track.theta[0])
    by = start - here
    if limits is None:
        low, high = float(np.min(track.theta)) - _FAR_RAD, float(np.max(track.theta)) + _FAR_RAD
        where = "too far away for its encoder to count from where it did"
    else:
        low, high = limits.theta_min_rad - _SLACK_RAD, limits.theta_max_rad + _SLACK_RAD
        where = "outside theta_min_rad to theta_max_rad"
    at, begins = (f"{round(angle, 3) + 0.0:g} rad" for angle in (here, start))
    if not low <= here <= high:
        raise InputError(
            f"{asked.name}: begins at {begins}, and the knob stands at {at}, {where}: turn it by "
            f"{by:+.4g} rad ({math.degrees(by):+.0f} degrees), then try again"
        )
    motion = led_in(track._replace(theta=track.theta - start), rate_hz)
    if abs(by) < _THERE_RAD:
        return motion, ""
    speed, gain = (math.inf, math.inf) if limits is None else (limits.omega_rad_s, limits.alpha_rad_s2)
    before = way(by, rate_hz, speed, gain)
    words = f"the knob stands at {at} and goes first to {begins}, where the motion begins"
    return behind(before, motion, by, rate_hz), f"{words}, in {len(before.t) / rate_hz:.2g} s"
