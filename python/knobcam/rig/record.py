"""A capture over the port: the motion goes to the rig, what comes back goes into the wire log."""

from __future__ import annotations

import contextlib
import os
import platform
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..base.door import checked
from ..base.ended import Ended, by_exception
from ..capture.formats.wire import RATE_TOLERANCE
from ..errors import InputError
from ..model import Model
from ..render import check_rotary
from .asked import asked
from .calibration import Calibration, usual
from .leadin import led_in
from .link import Link
from .placing import from_here, limits_of
from .port import BAUD
from .wirelog import SUFFIX, WireLog, begin, check_new

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..capture import Capture
    from ..capture.motion_plan import MotionPlan
    from ..capture.motions import MotionTrack
    from ..learn.limits import Limits
    from .asked import Asked
    from .figures import Figures
    from .link import Clears

    Watch = Callable[[Figures], object]

_LISTENS_S = 0.1  # how often figures are looked at, and Ctrl-C is listened for
_SILENT_S = 2.0  # without a sample in a run
_LAST_WORD_S = 0.5  # for STOPPED, when all samples are there
_SPAN_S = 0.2  # of the device's clock, before its rate is judged
_HOLD_S = 10.0  # beyond the length of a run that the rig may stay armed


class Enough(Exception):
    """Raised by who watches a recording: the run ends here, and what has come is the capture."""


class Plan(NamedTuple):
    """A run to be made: its samples, the motion (None: by hand), the model to render (None: the knob).

    `torque_Nm` is what the motor may give; None: what the rig allows.
    """

    samples: int
    track: MotionTrack | None
    model: Model | None
    torque_Nm: float | None = None

    @property
    def mode(self) -> str | None:
        """Mode of ARM; None where nothing gives torque."""
        if self.track is None:
            return None if self.model is None else "render"
        return "drive" if self.model is None else "render_driven"


class Latched(InputError):
    """The rig has latched a fault, which nobody has cleared: `told` in words, `code` its number."""

    def __init__(self, port: str, code: int, told: str) -> None:
        super().__init__(f"{port}: {told}; see to its cause, then clear it with --clear-fault")
        self.code = code
        self.told = told


def log_path(output: str | os.PathLike[str]) -> Path:
    """Return where the wire log of this output is: itself, or its neighbour."""
    path = Path(output)
    if not path.name:
        raise InputError(f"output={str(output)!r}: is no name of a file; give one")
    name = path.name.removesuffix(".gz")
    return path.with_name(Path(name).stem + SUFFIX)


@checked
def record(
    port: str | Link,
    motion: str | MotionTrack | MotionPlan = "sweep",
    *,
    output: str | os.PathLike[str],
    duration_s: float = 6.0,
    model: Model | str | os.PathLike[str] | None = None,
    calibration: Any = None,
    limits: Limits | str | os.PathLike[str] | None = None,
    progress: Watch | None = None,
    told: Callable[[str], object] | None = None,
    baud: int = BAUD,
    force: bool = False,
    clear_fault: Clears = False,
    overwrite: bool = False,
    kept: bool = True,
    **options: float,
) -> Capture:
    """Record a run of the rig behind `port` and return its capture.

    The wire log (.kcwire) is `output`, or stands beside it; any other `output` is the capture, saved in the
    format of its extension. `motion` is a name (sweep, multisine, turns, micro, with the `options` of its
    function) or a track, both led in from rest where the knob stands; `hand` records what a person does. Of a
    motion file (.toml) or a `MotionPlan` the angles are those of the rig's captures: the knob goes slowly
    from where it stands to where the motion begins, which `told` is told. `limits`, a file of them or
    `Limits`, hold for the motion and the way there, or nothing moves; the motor gives no more than their
    torque and what the rig's own parts take. With `model` the rig renders that model while the motion moves
    it, or a person does. `calibration` is anything with a `c_cal`, or a file of it; by default the one that
    is kept of this rig. `port` may be `serial:NUMBER`. `progress` is called some ten times a second and may
    raise `Enough`.

    A fault that the rig has latched is cleared only where `clear_fault` says so: True, or a function that
    is told the fault and answers. `force` lets the rig render a `model` that may feed a hand, as long as
    its energy tank lasts. A capture that is there is written over with `overwrite` alone, a log never.
    `kept`: whether the log outlives the call, so that it may be named.

    Raises InputError for everything that is wrong with call, port or rig, KeyboardInterrupt for Ctrl-C and
    `Ended`, a SystemExit, for SIGTERM and SIGHUP: torque is off then, and the samples that had come are in
    the log.
    """
    log = log_path(output)
    check_new(log)
    if Path(output).exists() and not overwrite:
        raise InputError(f"{output}: is there already; choose another name, or --overwrite it")
    if model is not None and not isinstance(model, Model):
        model = Model.load(model)
    if isinstance(calibration, str | os.PathLike):
        calibration = Calibration.load(calibration)
    with by_exception(), contextlib.ExitStack() as stack:
        link = port if isinstance(port, Link) else stack.enter_context(Link.at(port, baud=baud))
        wanted = asked(motion, duration_s, link.rate_hz, **options)
        within = limits_of(limits, link)
        _look_at_fault(link, clear_fault)
        plan, words = _plan_here(link, wanted, within, model)
        upload(link, plan, force=force)
        known = calibration if calibration is not None else usual(link.device["serial"])
        begin(log, _header(link, plan, wanted.header, known))
        if words and told is not None:
            told(words)
        try:
            run(link, plan, log, progress)
        except Enough:
            pass
        except InputError as error:
            raise InputError(f"{error}; {_what_is_kept(log, kept)}") from error
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_what_is_kept(log, kept)) from None
        except Ended as ended:
            raise Ended(ended.number, _what_is_kept(log, kept)) from None
    recorded = WireLog.load(log).capture()
    if Path(output) != log:
        recorded.save(output)
    return recorded


def make_plan(
    motion: str | MotionTrack, duration_s: float, rate_hz: float, model: Model | None = None, **options: float
) -> Plan:
    """Return the run of a motion at the rate of a rig, from where the knob stands."""
    wanted = asked(motion, duration_s, rate_hz, **options)
    if wanted.by_hand:
        return Plan(len(wanted.track.t), None, model)
    led = led_in(wanted.track, rate_hz)
    return Plan(len(led.t), led, model)


def _plan_here(link: Link, wanted: Asked, within: Limits | None, model: Model | None) -> tuple[Plan, str]:
    """Return the run of a motion on the rig as it stands, within limits, and what is to be said of it."""
    if wanted.by_hand:
        if within is not None:
            raise InputError("limits: are for what a motor does, and a hand has none; leave them out")
        return Plan(len(wanted.track.t), None, model), ""
    _check_speed(link, wanted.track)
    way = from_here(wanted, link, within)
    return Plan(len(way.track.t), way.track, model, way.torque_Nm), way.words


def _look_at_fault(link: Link, clear: Clears) -> None:
    """Clear a latched fault if whoever asks for the run says so; else InputError tells it."""
    if link.fault is None:
        return
    code, text = link.fault
    told = f"the rig has latched fault {code}: {text}"
    if not (clear(told) if callable(clear) else clear):
        raise Latched(link.port, code, told)
    link.clear()


def upload(link: Link, plan: Plan, *, force: bool = False) -> None:
    """Send ahead what the run needs; InputError for a motion or a model that is not for this rig."""
    if plan.model is not None:
        check_rotary(plan.model)
    if plan.track is not None:
        _check_speed(link, plan.track)
        link.upload_motion(plan.track)
    if plan.model is not None:
        link.upload_model(plan.model, force=force)


def run(link: Link, plan: Plan, log: Path, progress: Watch | None = None) -> None:
    """Make the run, whose motion and model the rig has, and record it into `log`, which has its header.

    Torque and run are ended on every way out.
    """
    link.log_to(log)
    try:
        if plan.mode is not None:
            hold_s = plan.samples / link.rate_hz + _HOLD_S
            link.arm(plan.mode, hold_s, torque_limit=plan.torque_Nm)
        link.start(plan.samples)
        _follow(link, plan.samples, progress or (lambda figures: None))
    finally:
        with contextlib.suppress(InputError):
            link.stop()
        link.log_to(None)


def _follow(link: Link, samples: int, progress: Watch) -> None:
    """Watch a run until it has ended."""
    before, since = -1, time.monotonic()
    while link.stopped is None:
        link.wait(_LISTENS_S)
        figures = link.figures()
        progress(figures)
        link.check()
        ours = link.run is not None and figures.run == link.run
        if ours:
            _check_rate(link, figures)
        if not ours or figures.received == before:
            silent = time.monotonic() - since
            if ours and figures.received + figures.missing >= samples and silent > _LAST_WORD_S:
                return  # all is there but the word that it is all
            if silent > _SILENT_S:
                raise InputError(f"{link.port}: the rig fell silent in the run; check its cable and power")
        else:
            before, since = figures.received, time.monotonic()
    produced = link.stopped["produced"]
    if produced < samples:
        while link.wait(_LAST_WORD_S) and link.fault is None:
            pass
        code, text = link.fault or (0, "it does not say why")
        raise InputError(
            f"{link.port}: the rig ended the run after {produced} of {samples} samples: {text} ({code})"
        )


def _check_speed(link: Link, track: MotionTrack) -> None:
    channel, fastest = link.device["omega"], float(np.max(np.abs(track.omega)))
    ends = (channel["scale"] * channel[end] + channel["offset"] for end in ("lower", "upper"))
    most = min(abs(end) for end in ends)
    if channel["unit"] != "absent" and fastest > most:
        raise InputError(
            f"motion: reaches {fastest:.3g} rad/s, the rig measures up to {most:.3g} rad/s; "
            "choose a shorter or slower one"
        )


def _check_rate(link: Link, figures: Figures) -> None:
    measured = figures.device_rate_hz
    if measured is None or figures.device_span_s < _SPAN_S:
        return
    if abs(measured / link.rate_hz - 1.0) > RATE_TOLERANCE:
        raise InputError(
            f"{link.port}: the rig says that it samples at {link.rate_hz:.6g} Hz, its clock says "
            f"{measured:.6g} Hz; its firmware must be corrected"
        )


def _header(link: Link, plan: Plan, motion: dict[str, Any], calibration: Any) -> dict[str, Any]:
    c_cal = getattr(calibration, "c_cal", None)
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "host": platform.node(),
        "port": link.port,
        "motion": {**motion, "samples": plan.samples},
        "model": None if plan.model is None else plan.model.text(),
        "calibration": None if c_cal is None else {"c_cal": c_cal, "date": getattr(calibration, "date", "")},
    }


def _what_is_kept(log: Path, kept: bool) -> str:
    if not kept:
        return "nothing is kept of it without --log"
    return f"{WireLog.load(log).samples} samples are kept in {log}"
