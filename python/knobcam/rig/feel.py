"""Feel a model on a device behind a port: the very same step runs on the device's own side."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import InputError
from ..render import Device, Stability, check_rotary, check_stability
from .asked import BY_HAND
from .link import Link
from .port import BAUD
from .record import record
from .wirelog import check_new

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from ..capture import Capture
    from ..model import Model
    from .figures import Figures
    from .link import Clears


class Felt(NamedTuple):
    """What was felt: the device, whether the model is stable on it, the capture of a person who turned it."""

    serial: str
    device: Device
    stability: Stability
    capture: Capture

    @property
    def samples_missing(self) -> int:
        """Samples of the run that did not come over the port, also before the first and after the last."""
        return int(self.capture.meta["account"]["missing"])


def device_of(descriptor: Any) -> Device:
    """Return what a rig says of its device, as the step takes it."""
    return Device(
        inertia_kg_m2=descriptor["inertia"],
        damping_Nms_rad=descriptor["damping"],
        delay_samples=descriptor["delay_samples"],
        torque_limit_Nm=descriptor["torque_limit"],
        torque_rate_limit_Nm_s=descriptor["torque_rate_limit"],
        encoder_step_rad=1.0 / abs(descriptor["counts_per_rad"]),
    )


def feel(
    port: str | Link,
    model: Model,
    seconds: float = 5.0,
    *,
    log: str | os.PathLike[str] | None = None,
    force: bool = False,
    clear_fault: Clears = False,
    baud: int = BAUD,
    progress: Callable[[Figures], object] | None = None,
) -> Felt:
    """Let the device behind `port` render `model` for some seconds while a person turns it, and record that.

    The wire log is kept where `log` says, or not at all. Raises InputError for a model that would feed a
    hand, or ring on this device, unless `force` is given; for a fault that the rig has latched, as `record`
    does; and for all that is wrong with port or rig. Torque is ended on every way out.
    """
    if not (math.isfinite(seconds) and seconds > 0.0):
        raise InputError(f"seconds={seconds:g}: give a finite time above 0")
    check_rotary(model)
    if log is not None:
        check_new(Path(log))
    with contextlib.ExitStack() as stack:
        link = port if isinstance(port, Link) else stack.enter_context(Link(port, baud=baud))
        device = device_of(link.device)
        stability = check_stability(model, device, rate_hz=link.rate_hz)
        if stability.refusal is not None and not force:
            raise InputError(f"{link.port}: {stability.refusal}")
        output = log or Path(stack.enter_context(tempfile.TemporaryDirectory())) / "felt.kcwire"
        capture = record(
            link,
            BY_HAND,
            output=output,
            duration_s=seconds,
            model=model,
            progress=progress,
            force=force,
            clear_fault=clear_fault,
            kept=log is not None,
        )
        return Felt(str(link.device["serial"]), device, stability, capture)
