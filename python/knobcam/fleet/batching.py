"""A batch: each capture once, whatever ends it, and a table that says the same however often that was."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import cache
from typing import Any, Literal, get_args

from ..base.door import checked
from ..errors import InputError
from ..model import Model
from . import cluster, places
from .judged import judged
from .limits import Limits
from .outliers import outliers
from .result import BatchResult
from .row import Row, is_known
from .settings import Settings
from .sources import Source, gone, sources
from .store import Store, hinted

Learn = Literal["none", "outliers", "all"]
_PART_S = 1.0  # of work, that is lost at most
_PART_ROWS = 256
_HINTED = 2000
"""Captures of a batch up to which hints are asked for by themselves: of more they take minutes."""
_QUICK_BYTES = 2**30  # that are read again sooner than workers are there


@checked
def batch(
    captures: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    results: str | os.PathLike[str],
    *,
    model: Model | str | os.PathLike[str] | None = None,
    limits: str | os.PathLike[str] | None = None,
    scheduler: str | None = None,
    learn: str = "outliers",
    hints: bool | None = None,
    count_gone: bool = False,
    prepare: str = "smooth",
    progress: Callable[[str], object] | None = None,
    reading: dict[str, Any] | None = None,
    **options: float,
) -> BatchResult:
    """Fit many captures, learn what is missing from some, and keep a row of each in a Parquet dataset.

    `captures` are folders, patterns, files, Parquet datasets with a column `capture`, or addresses such as
    `s3://bucket/folder`; `results` is a folder, which a batch that was ended goes on in. `model` is fitted to
    each, by default the base model; `limits` is a file of limits (see `docs/fleet.md`). With `learn` "all"
    the loop of `knobcam.learn` goes over every capture, with "outliers" over those that are unlike their lot
    or beyond a limit, with "none" over none. `scheduler` is the address of one of Dask; by default the cores
    of this machine work. With `hints` each row says how much its capture speaks for every effect that the
    model lacks, which lots are compared by; by default where a batch begins with up to 2000 captures. Rows of
    captures that are not there any more tell nothing of lots, but with `count_gone`.
    `reading` has what `knobcam.load` takes, `prepare` and `options` are as in `fit`.

    Raises InputError for a wrong call. A capture that cannot be read is a row that says why.
    """
    if learn not in get_args(Learn):
        raise InputError(f"learn={learn!r}: choose none, outliers or all")
    folder = places.folder(results)
    asked = Model.load(model) if isinstance(model, str | os.PathLike) else model
    checks = None if limits is None else Limits.load(limits, asked, learned=learn != "none")
    given = [captures] if isinstance(captures, str | os.PathLike) else list(captures)
    hints = hinted(folder) if hints is None else hints
    text = None if asked is None else asked.text()
    settings = Settings(text, reading or {}, prepare, options, hints is not False)
    store = Store.open(folder, settings, checks)
    found = sources(given, besides=folder)
    if hints is None and len(found) > _HINTED:
        store.settings = settings = replace(settings, hints=False)
    known = {name: row.get("place") for name, row in store.rows.items()}
    missing = frozenset[str]() if count_gone else gone(known, found, given)
    work = _Work(store, settings, found, progress or (lambda _: None))
    with ExitStack() as stack:
        stack.callback(store.close)
        client = cache(lambda: stack.enter_context(cluster.workers(scheduler)))  # when there is work for it
        work.do(client, found, learned=learn == "all")
        if learn == "outliers":
            fails = checks.beyond if checks else (lambda row: False)
            here = [row for name, row in store.rows.items() if name not in missing]
            unlike = outliers(here, fails)
            some = [one for one in found if one.name in unlike and not store.rows[one.name]["learned"]]
            work.do(client, some, learned=True)
        rows = judged(list(store.rows.values()), checks, missing)
        store.finish(rows)
    return BatchResult(folder, tuple(rows), frozenset(one.name for one in found), len(work.fresh), checks)


class _Work:
    """What is done of a batch, and what of it is kept."""

    def __init__(
        self, store: Store, settings: Settings, found: list[Source], tell: Callable[[str], object]
    ) -> None:
        self.store, self.settings, self.tell = store, settings, tell
        self.every = len(found)
        self.fresh: set[str] = set()
        """Captures that were fitted or learned by this call, and not by one before."""
        self._held: list[Row] = []
        self._last = time.monotonic()

    def do(self, client: Callable[[], Any], some: Sequence[Source], *, learned: bool) -> None:
        """Have the rows of captures made and kept, but for those whose content is done already."""
        tasks = [(one, self._known(one, learned)) for one in some]
        if sum(one.bytes for one, known in tasks if known is not None) <= _QUICK_BYTES:
            tasks = [(one, known) for one, known in tasks if known is None or not is_known(one, known)]
        if not tasks:
            return
        begun, ready = time.monotonic(), 0
        what = "learning" if learned else "fitting"
        self.tell(f"{what} {len(tasks)} captures")

        def take(_: list[cluster.Task], rows: cluster.Rows) -> None:
            nonlocal ready
            ready += len(rows)
            new = [row for row in rows if row is not None]
            self.fresh |= {row["capture"] for row in new}
            self._held += new
            if len(self._held) >= _PART_ROWS or time.monotonic() - self._last >= _PART_S:
                self._keep()
            left = (time.monotonic() - begun) * (len(tasks) - ready) / ready
            self.tell(f"{what} {ready} of {len(tasks)} captures, {_in_words(left)} left")

        try:
            cluster.run(client(), tasks, self.settings, learned, take)
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(f"{self._so_far()}; the same command goes on from there") from interrupt
        except cluster.Gone as gone:
            raise cluster.Gone(f"{gone}; {self._so_far()}, and the same command goes on from there") from gone
        finally:
            self._keep()

    def _known(self, source: Source, learned: bool) -> str | None:
        """Return the digest of the content of which there is a row already, as it is asked for."""
        row = self.store.rows.get(source.name)
        if row is None or (learned and not row["learned"]):
            return None
        known: str | None = row["sha256"]
        return known

    def _keep(self) -> None:
        held, self._held, self._last = self._held, [], time.monotonic()
        self.store.put(held)

    def _so_far(self) -> str:
        self._keep()
        return f"the rows of {len(self.store.rows)} of {self.every} captures are kept"


def _in_words(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
