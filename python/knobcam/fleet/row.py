"""One capture's row: read, fitted, on demand learned, or why it cannot be."""

from __future__ import annotations

import hashlib
import sys
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.reading import digest as digest_of_file
from ..base.strict_json import plain, readable
from ..capture import load
from ..capture.capture import of_table
from ..capture.formats.document import digest as digest_of
from ..capture.reading import Reading
from ..errors import InputError
from ..fit import fit
from ..fit.hints import hints
from ..learn import learn
from . import places
from .curve import curve
from .dataset import table_of
from .sources import of_meta

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..capture import Capture
    from ..fit import Estimate, Fit
    from .settings import Settings
    from .sources import Source

Row = dict[str, Any]
"""A capture's row as JSON has it; `params` by name: value, low, high; `units` theirs; `hints` by effect.

Of those that are kept (`compact`) a `curve` has arrays, NaN where no sample is.
"""


def row_of(source: Source, settings: Settings, learned: bool, known: str | None) -> Row | None:
    """Return the row of a capture; None where its content is the one `known` by its digest.

    Whatever is wrong with one capture is said in its row: it never ends a batch.
    """
    row = _identity(source, settings, learned)
    try:
        if source.error is not None:
            raise InputError(source.error)
        if source.rows is None:
            with places.on_disk(source.place) as path:
                row["sha256"] = _digest(path)
                if row["sha256"] == known:
                    return None
                capture = _loaded(path, source, settings)
        else:
            table = table_of(source, *source.rows)
            row["sha256"] = digest_of(table.columns)
            if row["sha256"] == known:
                return None
            capture = of_table(Path(source.place), table, _reading(settings))
        row |= {name: label for name, label in of_meta(capture.meta).items() if row[name] is None}
        row |= _described(capture)
        row |= _learned(capture, settings) if learned else _fitted(capture, settings)
    except (KeyboardInterrupt, SystemExit):
        raise
    except InputError as error:
        said = readable(str(error))
        row["error"] = said if source.name in said else f"{source.name}: {said}"
    except BaseException as error:  # a panic of the core is no Exception
        what = " ".join(f"{type(error).__name__}: {error}".split())
        row["error"] = f"{source.name}: the program failed on it ({what}); please report it"
    told: Row = plain(row)
    return told


GONE, DUPLICATE = "gone", "duplicate"
"""Findings: the capture of a row is not there any more; its content is that of a capture before."""


def counts(row: Row) -> bool:
    """Whether lots are told by a row: it was read, its capture is there, and there but once."""
    return row["error"] is None and not {GONE, DUPLICATE} & set(row["findings"])


def compact(row: Row) -> Row:
    """Return a row that takes a third of its memory: its numbers in arrays, what rows share held once."""
    row = {sys.intern(name): value for name, value in row.items()}
    if row["curve"] is not None:
        row["curve"] = {name: np.array(column, dtype=np.float64) for name, column in row["curve"].items()}
    row["params"] = {sys.intern(name): values for name, values in row["params"].items()}
    row["units"] = _shared(tuple(row["units"].items()))
    for name in ("settings", "version", "verdict", "coordinate", "unit", "lot", "station"):
        row[name] = None if row[name] is None else sys.intern(row[name])
    return row


@cache
def _shared(units: tuple[tuple[str, str], ...]) -> dict[str, str]:
    return dict(units)


def is_known(source: Source, digest: str) -> bool:
    """Whether a file of this machine has the content of a digest."""
    if source.error is not None or source.rows is not None or places.is_address(source.place):
        return False
    try:
        return _digest(Path(source.place)) == digest
    except (InputError, OSError):
        return False


def lost(source: Source, settings: Settings, learned: bool, why: str) -> Row:
    """Return the row of a capture with which its worker ended."""
    return _identity(source, settings, learned) | {"error": f"{source.name}: {why}"}


def _identity(source: Source, settings: Settings, learned: bool) -> Row:
    time = None if source.modified is None else datetime.fromtimestamp(source.modified, UTC)
    return {
        "capture": source.name,
        "place": readable(source.place),
        "sha256": None,
        **{name: source.labels.get(name) for name in ("lot", "station", "part", "date")},
        "time": None if time is None else time.isoformat(timespec="seconds"),
        "verdict": None,
        "found": [],
        "weights": [],
        "findings": [],
        "error": None,
        "learned": learned,
        "settings": settings.digest,
        "version": settings.version,
        "headline": None,
        "first": None,
        **dict.fromkeys(("rmse", "rmse_heldout", "noise_floor", "coordinate", "unit", "samples")),
        "params": {},
        "units": {},
        "curve": None,
        "hints": {},
    }


def _digest(path: Path) -> str:
    if path.is_dir():  # a bag
        total = hashlib.sha256()
        for one in sorted(path.rglob("*")):
            if one.is_file():
                total.update(f"{one.relative_to(path).as_posix()} ".encode() + _digest(one).encode())
        return total.hexdigest()
    return digest_of_file(path)


def _reading(settings: Settings) -> Reading:
    given = {name: value for name, value in settings.reading.items() if name not in ("kt", "resistance_ohm")}
    return Reading(**given)


def _loaded(path: Path, source: Source, settings: Settings) -> Capture:
    try:
        return load(path, **settings.reading)
    except InputError as error:  # which names the copy of what lies elsewhere
        raise InputError(str(error).replace(str(path), source.name)) from error


def _described(capture: Capture) -> Row:
    return {
        "samples": capture.samples,
        "masked": int(np.sum(~capture.mask)),
        "duration_s": capture.duration_s,
        "sample_rate_hz": capture.rate_hz,
        "coordinate": capture.coordinate,
        "unit": capture.torque_unit,
        "findings": sorted({one.kind for one in capture.findings}),
    }


def _fitted(capture: Capture, settings: Settings) -> Row:
    fitted = fit(capture, settings.parsed(), **settings.how())
    # Whether anything is missing is only known where chance explains all that is left.
    complete = fitted.compare().complete and fitted.log_fault is None and fitted.impossible is None
    return {
        "verdict": "complete" if complete else None,
        "hints": hints(fitted) if settings.hints else {},
        **_numbers(fitted, fitted.params),
    }


def _learned(capture: Capture, settings: Settings) -> Row:
    story = learn(capture, settings.parsed(), **settings.how())
    weights = {step.added: step.weights.get(step.added or "") for step in story.ladder}
    base = story.ladder[0].fit
    first = _numbers(base, base.params)
    return {
        "verdict": story.verdict,
        "found": list(story.found),
        "weights": [weights.get(name) for name in story.found],
        "headline": story.headline,
        # By the first model a lot is compared: all of its captures have it.
        "first": {name: first[name] for name in ("rmse", "noise_floor", "params")},
        "hints": hints(base) if settings.hints else {},
        **_numbers(story.fit, story.params),
    }


def _numbers(fitted: Fit, params: Mapping[str, Estimate]) -> Row:
    return {
        "rmse": fitted.rmse,
        "rmse_heldout": fitted.rmse_heldout,
        "noise_floor": None if np.isnan(fitted.noise_floor) else fitted.noise_floor,
        "findings": sorted({one.kind for signals in fitted.prepared for one in signals.findings}),
        "effects": list(fitted.model.effects),
        "params": {name: _estimate(one) for name, one in params.items()},
        "units": {name: one.unit for name, one in params.items()},
        "curve": curve(fitted),
    }


def _estimate(one: Estimate) -> list[float | None]:
    """Value and interval; nothing of what the capture does not determine."""
    return [one.value, *one.ci95] if one.determined else [None, None, None]
