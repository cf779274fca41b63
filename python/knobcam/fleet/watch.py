"""A station: each file of a folder becomes a row when it is complete, whatever ended the watch before."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import Any

from ..base.lock import is_written
from ..errors import InputError
from ..model import Model
from . import places
from .judged import judged
from .limits import Limits
from .result import BatchResult
from .row import GONE, Row, row_of
from .settings import Settings
from .sources import Source, is_results, nothing_in, sources, stands_still
from .store import Store, hinted

SETTLED_S = 0.25
"""A file is complete when it did not change for so long, no program has it open to write, and it is read."""
PATIENCE_S = 5.0
"""What stands still for so long is told as it is, read or not, open or not: a part is never kept back."""
_OLD_S = 60.0
"""What was written so long ago needs no second look; clocks of two machines do not differ by more."""
_LOOK_S = 0.05
_AMONG = 200
"""Parts before one that tell what is usual in its lot, which all of a shift need not be asked for."""
_WAITS: Row = {}
"""Stands for the row of a file that may still grow."""
_EACH = (
    *("capture", "sha256", "lot", "station", "part", "time", "verdict", "found", "ok", "failed_limits"),
    *("failed_why", "cause", "learned", "rmse", "noise_floor", "unit", "findings", "error"),
)


class Watch:
    """A folder that is watched, and the rows of what was in it."""

    def __init__(
        self, folder: Path, store: Store, limits: Limits | None, *, learn: str, patience_s: float
    ) -> None:
        self.folder, self.store, self.limits, self.learn = folder, store, limits, learn
        self.patience_s = patience_s
        self.fresh: set[str] = set()
        self._done: dict[str, str] = {}
        """The stamps of files whose rows are there."""
        self._seen: dict[str, tuple[str, float]] = {}
        """The stamps of those that may still grow, and since when they have been so."""
        self._unread: dict[str, str] = {}
        """The stamps with which files could not be read, which are waited for as long as patience lasts."""
        self._closer: list[Future[Row | None]] = []
        """What is being learned."""

    @classmethod
    def of(
        cls,
        folder: str | os.PathLike[str],
        results: str | os.PathLike[str],
        *,
        model: Model | str | os.PathLike[str] | None = None,
        limits: str | os.PathLike[str] | None = None,
        learn: str = "outliers",
        patience_s: float = PATIENCE_S,
        prepare: str = "smooth",
        reading: dict[str, Any] | None = None,
        **options: float,
    ) -> Watch:
        """Return a watch over a folder; arguments as of `batch`. InputError for a wrong call.

        `patience_s` is how long a file may stand still that cannot be read, or that a program still has open.
        """
        path = places.folder(folder)
        if not path.is_dir():
            raise InputError(f"{path}: is no folder; make it first, or name another one")
        if is_results(path):
            raise InputError(f"{path}: {nothing_in(path)}")
        if not patience_s >= 0.0:
            raise InputError(f"patience_s={patience_s:g}: is no time to wait; give 0 or more seconds")
        kept = places.folder(results)
        asked = Model.load(model) if isinstance(model, str | os.PathLike) else model
        known = hinted(kept) is not False
        settings = Settings(None if asked is None else asked.text(), reading or {}, prepare, options, known)
        checks = None if limits is None else Limits.load(limits, asked, learned=learn != "none")
        return cls(path, Store.open(kept, settings, checks), checks, learn=learn, patience_s=patience_s)

    def rows(self, *, once: bool = False) -> Iterator[Row]:
        """Yield the row of each file, judged, when it is complete; with `once` of those that are there now.

        What asks for a closer look is yielded again when it is learned, which other parts do not wait for.
        """
        closer = ThreadPoolExecutor(1)
        try:
            while True:
                waiting = False
                for source in self._found():
                    if self._done.get(source.name) == source.stamp:
                        continue
                    row = self._row(source) if self._complete(source) else _WAITS
                    waiting = waiting or row is _WAITS
                    if row is not _WAITS:
                        yield from self._told(source, row, closer)
                yield from self._learned()
                if once and not waiting and not self._closer:
                    return
                time.sleep(_LOOK_S)
        finally:  # what waits is learned when the watch goes on
            closer.shutdown(cancel_futures=True)

    def _found(self) -> list[Source]:
        try:
            return sources([self.folder], besides=self.store.folder)
        except (InputError, OSError):  # nothing is there yet, or went while it was looked at
            return []

    def _complete(self, source: Source) -> bool:
        """Whether a file stays as it is, and is worth to be read."""
        now = time.monotonic()
        stamp, since = self._seen.get(source.name, ("", now))
        if stamp != source.stamp:
            age = time.time() - (source.modified or math.inf)
            since = now - age if not stamp and age >= _OLD_S else now
            self._seen[source.name] = (source.stamp, since)
        still = now - since
        if still >= self.patience_s:
            return still >= SETTLED_S
        new = self._unread.get(source.name) != source.stamp
        return still >= SETTLED_S and new and not is_written(source.place)

    def _row(self, source: Source) -> Row | None:
        """Return the row of a file, None where its content is done, `_WAITS` where it may still grow."""
        known = self.store.rows.get(source.name)
        digest = None if known is None else known["sha256"]
        row = row_of(source, self.store.settings, self.learn == "all", digest)
        since = self._seen[source.name][1]
        bad = row is not None and row["error"] is not None and source.error is None
        if not stands_still(source):  # what was read is half of it
            return _WAITS
        if bad and time.monotonic() - since < self.patience_s:
            self._unread[source.name] = source.stamp
            return _WAITS
        return row

    def _told(self, source: Source, row: Row | None, closer: ThreadPoolExecutor) -> Iterator[Row]:
        """Yield the row of a complete file, which is kept first; none of what is done already."""
        self._done[source.name] = source.stamp
        for waits in (self._seen, self._unread):
            waits.pop(source.name, None)
        if row is not None:
            yield self._kept(row)
        if self.learn == "outliers" and self._unlike(self.store.rows[source.name]):
            self._closer.append(closer.submit(row_of, source, self.store.settings, True, None))

    def _learned(self) -> Iterator[Row]:
        """Yield the rows of what was learned meanwhile."""
        while self._closer and self._closer[0].done():
            if (row := self._closer.pop(0).result()) is not None:
                yield self._kept(row)

    def _kept(self, row: Row) -> Row:
        self.store.put([row])
        self.fresh.add(row["capture"])
        row = self.store.rows[row["capture"]]
        last = islice(reversed(self.store.rows.values()), _AMONG)
        return judged([row], self.limits, among=[one for one in last if one is not row] + [row])[0]

    def _unlike(self, row: Row) -> bool:
        """Whether a part asks for a closer look: it has more than chance left, or is beyond a limit."""
        if row["error"] is not None or row["learned"]:
            return False
        return row["verdict"] is None or (self.limits is not None and self.limits.beyond(row))

    def finish(self) -> BatchResult:
        """Make the table of all rows, as a batch does, and return it."""
        # Parts pass a station: those that were taken away count as before.
        before = {name for name, row in self.store.rows.items() if GONE in row["findings"]}
        rows = judged(list(self.store.rows.values()), self.limits, before - self._done.keys())
        self.store.finish(rows)
        self.store.close()
        asked = frozenset(self._done)  # others were there in a watch before
        return BatchResult(self.store.folder, tuple(rows), asked, len(self.fresh), self.limits)


def document(row: Row) -> dict[str, Any]:
    """Return what a line of JSON says of a part."""
    params = {
        name: {"value": value, "ci95": None if low is None else [low, high], "unit": row["units"][name]}
        for name, (value, low, high) in row["params"].items()
    }
    return {"schema": "knobcam.watch/1", **{name: row[name] for name in _EACH}, "params": params}
