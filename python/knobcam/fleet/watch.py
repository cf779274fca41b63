"""A station: each file of a folder becomes a row when it is complete, whatever ended the watch before."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..model import Model
from . import places
from .judged import judged
from .limits import Limits
from .result import BatchResult
from .row import Row, row_of
from .settings import Settings
from .sources import Source, sources
from .store import Store, hinted

SETTLED_S = 0.25
"""A file is complete when it did not change for so long, which one that was renamed into place did not."""
_LOOK_S = 0.05
_EACH = (
    *("capture", "sha256", "lot", "station", "part", "time", "verdict", "found", "ok", "failed_limits"),
    *("failed_why", "cause", "learned", "rmse", "noise_floor", "unit", "findings", "error"),
)


class Watch:
    """A folder that is watched, and the rows of what was in it."""

    def __init__(self, folder: Path, store: Store, limits: Limits | None, *, learn: str) -> None:
        self.folder, self.store, self.limits, self.learn = folder, store, limits, learn
        self.fresh: set[str] = set()
        self._done: dict[str, str] = {}
        """The stamps of files whose rows are there."""
        self._seen: dict[str, tuple[str, float]] = {}
        """The stamps of those that may still grow, and when they were first seen."""
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
        prepare: str = "smooth",
        reading: dict[str, Any] | None = None,
        **options: float,
    ) -> Watch:
        """Return a watch over a folder; arguments as of `batch`. InputError for a wrong call."""
        path = Path(folder)
        if not path.is_dir():
            raise InputError(f"{path}: is no folder; make it first, or name another one")
        kept = places.folder(results)
        asked = Model.load(model) if isinstance(model, str | os.PathLike) else model
        known = hinted(kept) is not False
        settings = Settings(None if asked is None else asked.text(), reading or {}, prepare, options, known)
        checks = None if limits is None else Limits.load(limits, asked, learned=learn != "none")
        return cls(path, Store.open(kept, settings), checks, learn=learn)

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
                    if not self._complete(source):
                        waiting = True
                        continue
                    yield from self._made(source, closer)
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
        """Whether a file stays as it is; one that was written long ago needs no second look."""
        now = time.time()
        stamp, since = self._seen.get(source.name, ("", now))
        if stamp != source.stamp:
            since = now if source.modified is None else min(source.modified, now)
            self._seen[source.name] = (source.stamp, since)
        return now - since >= SETTLED_S

    def _made(self, source: Source, closer: ThreadPoolExecutor) -> Iterator[Row]:
        """Yield the row of a complete file, which is kept first, if its content is not done already."""
        known = self.store.rows.get(source.name)
        digest = None if known is None else known["sha256"]
        row = row_of(source, self.store.settings, self.learn == "all", digest)
        self._done[source.name] = source.stamp
        self._seen.pop(source.name, None)
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
        return judged([self.store.rows[row["capture"]]], self.limits)[0]

    def _unlike(self, row: Row) -> bool:
        """Whether a part asks for a closer look: it has more than chance left, or is beyond a limit."""
        if row["error"] is not None or row["learned"]:
            return False
        return row["verdict"] is None or (self.limits is not None and self.limits.beyond(row))

    def finish(self) -> BatchResult:
        """Make the table of all rows, as a batch does, and return it."""
        rows = judged(list(self.store.rows.values()), self.limits)
        self.store.finish(rows, None if self.limits is None else self.limits.text)
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
