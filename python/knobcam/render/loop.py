"""The render loop: a device is sensed and driven on a fixed beat by a thread of the core.

The thread needs no Python: what holds the GIL holds up neither a renderer nor a device of the core. A device
or a controller that is written in Python takes the GIL in each call, and waits while other Python code holds
it; it does for tests and for slow rates.
"""

from __future__ import annotations

import warnings
import weakref
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

from .. import _core
from ..base.door import checked
from ..base.ended import Ended, by_exception
from ..errors import InputError, KnobcamError, KnobcamWarning
from .loop_report import Durations, LastSecond, LoopReport

if TYPE_CHECKING:
    from types import TracebackType

_LISTENS_S = 0.05  # how often Ctrl-C is listened for
_ANSWERS_S = 2.0  # longer than any watchdog allows a step to take
_TIMES = ("real", "virtual")


class Handle(Protocol):
    """Anything that can be sensed and driven; both calls return well within a period."""

    def read(self) -> tuple[float, float, float, float | None]:
        """Return theta (rad), omega (rad/s), alpha (rad/s²) and the torque of the hand (N m), if measured."""

    def write(self, tau: float, /) -> object:
        """Take the torque by which the knob answers, N m; the device applies its negative to the hand."""


class Controller(Protocol):
    """Anything that answers a sensed state with a torque."""

    def step(self, theta: float, omega: float, alpha: float, hand: float | None, /) -> float:
        """Return the torque by which the knob answers, N m; what this raises ends the loop."""


class RunningLoop:
    """A loop that was started; `with` stops it at the end of the block, and so does the end of Python."""

    def __init__(self, core: _core.Loop, rate_hz: float, watchdog_s: float, virtual: bool) -> None:
        self._core = core
        self._rate_hz, self._watchdog_s = rate_hz, watchdog_s
        self._why_not = "its time is virtual" if virtual else core.why_not_realtime
        # Python must not end while the thread may still call into it.
        weakref.finalize(self, _halt, core)

    def report(self) -> LoopReport:
        """Return what it reached so far, at most some hundredths of a second ago, or what became of it."""
        told: dict[str, Any] = self._core.report()
        return LoopReport(
            rate_hz=self._rate_hz,
            watchdog_s=self._watchdog_s,
            steps=told["steps"],
            missed=told["missed"],
            longest_run=told["longest_run"],
            late=Durations(**told["late"]),
            busy=Durations(**told["busy"]),
            last=LastSecond(*told["last"]),
            ending=told.get("ending"),
            why=told.get("why", ""),
            not_relieved=told.get("not_relieved"),
            why_not_realtime=self._why_not,
        )

    def wait(self, longest_s: float) -> bool:
        """Wait for its end, but no longer than this, s; return whether it ended."""
        return self._core.wait(longest_s)

    def stop(self) -> LoopReport:
        """Stop it, wait until the device had zero torque, and return the report.

        Raises KnobcamError where the loop does not come back from a call of its device or controller.
        """
        if not _halt(self._core):
            raise KnobcamError(
                f"the loop does not come back from its device or controller within {_ANSWERS_S:g} s, so zero "
                "torque could not be written: switch the device off"
            )
        return self.report()

    def __enter__(self) -> RunningLoop:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def _halt(core: _core.Loop) -> bool:
    """Ask a loop to stop and wait for its end; whether it came."""
    core.stop()
    return core.wait(_ANSWERS_S)


@checked
def start_loop(
    controller: Controller,
    device: Handle | _core.EmulatedHandle,
    seconds: float | None = None,
    *,
    rate_hz: float = 5000.0,
    rt: str = "warn",
    time: str = "real",
    watchdog_s: float = 0.02,
    missed_share: float = 0.2,
    missed_run: int | None = None,
) -> RunningLoop:
    """Start a loop on a thread of its own and return at once.

    Every period of 1/`rate_hz` the device is read, the controller answers and its torque is written, for
    `seconds` or until it is stopped. A period whose deadline has passed when a step ends is skipped and
    counted as missed. The loop ends with zero torque, also when

    - a step is later than `watchdog_s` after its deadline (one period to 1 s),
    - more than `missed_share` of the periods of the last second were missed, or more than `missed_run` in a
      row,
    - the device or the controller raises, or the answer is not finite.

    A `Renderer` is stepped by the core as a copy of what it is now: it has to be made for the loop's rate. It
    is told of the periods that were missed, so that they are no jump of the handle to it. An `EmulatedHandle`
    needs no Python either.

    A process that the system stops cannot write: a device that holds its last torque needs its own watchdog.

    `rt`: `enforce` refuses to run without real-time priority, `warn` runs, warns and stamps the report, `off`
    does not ask for it. `time`: `real`, or `virtual`, where nothing is waited for.

    Raises InputError for options that cannot be followed, and for `rt="enforce"` where the system refuses.
    """
    if time not in _TIMES:
        raise InputError(f"time={time!r} is unknown; choose {' or '.join(_TIMES)}")
    if time == "virtual" and rt == "enforce":
        raise InputError("rt='enforce': virtual time has no priority to enforce; leave rt out")
    core_device = isinstance(device, _core.EmulatedHandle)
    for name, taker, calls in (
        ("device", device, () if core_device else ("read", "write")),
        ("controller", controller, ("step",)),
    ):
        missing = [call for call in calls if not callable(getattr(taker, call, None))]
        if missing:
            raise InputError(f"{name}: a {type(taker).__name__} has no {missing[0]}(...)")
    if missed_run is not None and missed_run < 0:
        raise InputError(f"missed_run={missed_run}: periods in a row are counted from 0")
    core = _core.start_loop(
        controller, device, rate_hz, seconds, rt, time == "virtual", watchdog_s, missed_share, missed_run
    )
    loop = RunningLoop(core, rate_hz, watchdog_s, time == "virtual")
    if time == "real" and rt == "warn" and core.why_not_realtime is not None:
        warnings.warn(core.why_not_realtime, KnobcamWarning, stacklevel=2)
    return loop


def run_loop(
    controller: Controller,
    device: Handle | _core.EmulatedHandle,
    seconds: float | None = None,
    **options: Any,
) -> LoopReport:
    """Run a loop to its end and return the report; options as in `start_loop`.

    Ctrl-C takes the torque off and returns the report too, its `ending` then `interrupted`. SIGTERM and
    SIGHUP take it off and raise `Ended`, a SystemExit.
    """
    loop = start_loop(controller, device, seconds, **options)
    try:
        with by_exception():
            while not loop.wait(_LISTENS_S):
                pass
    except Ended:
        loop.stop()
        raise
    except KeyboardInterrupt:
        report = loop.stop()
        return replace(report, ending="interrupted", why="it was interrupted (Ctrl-C)")
    return loop.report()
