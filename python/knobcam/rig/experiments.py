"""Record, learn, design, record again: until what was learned is told from all else, or so many times."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.door import checked
from ..base.writing import make_folder
from ..errors import InputError
from ..learn import LearningResult, learn
from ..learn.contenders import contenders
from ..learn.designing import design
from ..learn.experiment import Experiment
from ..learn.limits import Limits
from .asked import asked
from .link import Link
from .placing import fitted, limits_of, stands_at
from .record import record
from .wirelog import SUFFIX, WireLog

if TYPE_CHECKING:
    from ..capture import Capture
    from .link import Clears

_LEAST_S = 1.0  # of a recording that broke off, to be of use


@dataclass(frozen=True)
class Experiments:
    """What was learned, the motions that were designed on the way, the recordings, and why it ended."""

    learned: LearningResult
    designed: tuple[Experiment, ...]
    logs: tuple[Path, ...]
    ended: str

    def document(self) -> dict[str, Any]:
        """Return the document of what was learned, with a row for each motion."""
        rows = []
        for one in self.designed:
            row = one.document()
            rows.append(row | {"motion": {"about": one.plan.about, "seconds": one.seconds}})
        return self.learned.document() | {
            "experiments": rows,
            "recordings": [str(log) for log in self.logs],
            "ended": self.ended,
        }

    def __repr__(self) -> str:
        lines = [repr(self.learned)]
        lines += [f"experiment {n}: {one.headline}" for n, one in enumerate(self.designed, 1)]
        return "\n".join([*lines, *(f"recording: {log}" for log in self.logs), f"Ended: {self.ended}."])


@checked
def experiments(
    port: str,
    count: int,
    folder: str | os.PathLike[str],
    *,
    motion: str = "sweep",
    duration_s: float = 6.0,
    limits: str | os.PathLike[str] | None = None,
    clear_fault: Clears = False,
    progress: Callable[[str], None] | None = None,
    **options: Any,
) -> Experiments:
    """Record the knob on the rig behind `port`, learn, and record up to `count` motions more.

    Each further motion is the one that would tell apart what was learned and what else it could be
    (`next_experiment`), within `limits` (a file; by default what the recordings reached), for which the first
    is made smaller where it has to be. It ends where nothing is left to be told apart, or where no motion
    would. The wire logs are in `folder`; `options` are those of `learn`. A rig that stops half-way ends it:
    what came is used, and why is said.

    Raises InputError where the first recording fails, for limits that are none, before anything moves, and
    for a count below 1.
    """
    if count < 1:
        raise InputError(f"experiments={count}: give a number from 1")
    tell = progress or (lambda _: None)
    make_folder(folder)
    first = _free(Path(folder))
    tell("recording the first motion")
    captures = [_first(port, motion, duration_s, limits, output=first, clear_fault=clear_fault)]
    logs, designed = [first], []
    learned = learn(captures, progress=tell, **options)
    broken = None
    for number in range(1, count + 1):
        tell(f"designing experiment {number}")
        rivals = contenders(learned, ())
        if not rivals:
            broken = "nothing is left that could be taken for what was found"
            break
        try:
            one = design(rivals, Limits.within(limits, learned.fit.prepared))
        except InputError as none:
            broken = str(none)
            break
        if not one.useful:
            broken = one.headline.removesuffix(".")
            break
        designed.append(one)
        log = _free(Path(folder))
        tell(f"recording experiment {number}")
        try:
            kept = None if limits is None else one.limits
            captures.append(
                record(port, one.plan, output=log, limits=kept, clear_fault=clear_fault, told=tell)
            )
            logs.append(log)
        except InputError as error:
            broken = str(error)
            if (cut := _what_came(log)) is None:
                break
            captures.append(cut)
            logs.append(log)
        learned = learn(captures, progress=tell, **options)
        if broken is not None:
            break
    ended = broken or f"{count} experiments were made"
    return Experiments(learned, tuple(designed), tuple(logs), ended)


def _first(
    port: str, motion: str, duration_s: float, limits: str | os.PathLike[str] | None, **how: Any
) -> Capture:
    """Record the first motion, as large as it is, or as limits let it be from where the knob stands."""
    if limits is None:
        return record(port, motion, duration_s=duration_s, **how)
    with Link.at(port) as link:
        within = limits_of(limits, link)
        assert within is not None
        seconds = min(duration_s, within.duration_s)
        track = asked(motion, seconds, link.rate_hz).track
        return record(link, fitted(track, stands_at(link), within), limits=within, **how)


def _free(folder: Path) -> Path:
    """Return a name that no recording has."""
    taken = {path.name for path in folder.glob(f"experiment-*{SUFFIX}")}
    numbers = (number for number in range(len(taken) + 1) if f"experiment-{number}{SUFFIX}" not in taken)
    return folder / f"experiment-{next(numbers)}{SUFFIX}"


def _what_came(log: Path) -> Capture | None:
    """Return the capture of a recording that broke off, if it is of use."""
    try:
        capture = WireLog.load(log).capture()
    except InputError:
        return None
    return capture if capture.duration_s >= _LEAST_S else None
