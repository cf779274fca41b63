"""The sensor tests of section 3.1 of the haptic-camera paper, run on a rig."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from .calibration import Calibration, Run, anchored, spatial
from .link import Link
from .port import BAUD
from .record import make_plan, record

if TYPE_CHECKING:
    from collections.abc import Callable

    from .link import Clears

TESTS = {"spatial": (spatial, 1.0), "torque": (anchored, 0.02)}
"""What each test works out, and the amplitude of its swept sine, rad (Table 3 of the paper)."""
DURATION_S = 5.0
_MOST_RUNS = 100


def calibrate(
    port: str | Link,
    test: str = "spatial",
    *,
    runs: int = 3,
    logs: Path | None = None,
    baud: int = BAUD,
    clear_fault: Clears = False,
    progress: Callable[[str], object] | None = None,
) -> Calibration:
    """Run a sensor test and return what it says of the rig; it is not saved.

    `spatial` moves a gripper with nothing in it; `torque` pushes against an anchor that prevents any
    movement. The wire logs are kept in the folder `logs`, if that is given. `clear_fault` as in `record`.

    Raises InputError for an unknown test, everything that is wrong with port or rig, and a gripper that is
    not as the test needs it.
    """
    if test not in TESTS:
        raise InputError(f"test={test!r} is unknown; choose {' or '.join(TESTS)}")
    if not 1 <= runs <= _MOST_RUNS:
        raise InputError(f"runs={runs}: choose 1 to {_MOST_RUNS}; the paper made 3")
    work_out, amplitude = TESTS[test]
    tell = progress or (lambda _: None)
    with contextlib.ExitStack() as stack:
        link = port if isinstance(port, Link) else stack.enter_context(Link(port, baud=baud))
        folder = logs or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="knobcam-calibrate-")))
        folder.mkdir(parents=True, exist_ok=True)
        nominal = float(link.device["c_cal"])
        plain = Calibration(link.device["serial"], "", c_cal=nominal)
        plan = make_plan("sweep", DURATION_S, link.rate_hz, c=amplitude)
        if plan.track is None:
            raise InputError("motion: the sensor tests need one that the rig drives")
        done = []
        for number in range(1, runs + 1):
            tell(f"{test} test, run {number} of {runs}")
            recorded = record(
                link,
                "sweep",
                output=folder / f"{test}-{number}.kcwire",
                duration_s=DURATION_S,
                calibration=plain,
                clear_fault=clear_fault,
                kept=logs is not None,
                c=amplitude,
            )
            done.append(Run(plan.track, recorded, nominal))
    return work_out(plain.serial, done)
