"""Cases examined one by one in processes of their own; what was answered is kept, line by line.

A run that was killed goes on where it stopped. An examination yields its row in parts: what is known of the
case, then the marks. Who has not answered in time is stopped, and the row is closed without marks.
"""

import hashlib
import json
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

Row = dict[str, Any]
Examine = Callable[[Any], Iterator[Row]]
UNSTARTED_S = 900.0  # to make a case


def version(*paths: Path) -> str:
    """Twelve digits of what stands in the files, and in those under the folders."""
    digest = hashlib.sha256()
    for path in paths:
        inside = path.rglob("*") if path.is_dir() else [path]
        for file in sorted(file for file in inside if file.suffix in (".py", ".so")):
            digest.update(file.relative_to(path.parent).as_posix().encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:12]


def kept(path: Path, about: Row) -> list[Row]:
    """The rows of a file that are about this; a line that was cut off by a kill is left out."""
    rows = []
    for line in path.read_text("utf-8").splitlines() if path.is_file() else []:
        try:
            row = json.loads(line)
        except ValueError:
            continue
        if about.items() <= row.items():
            rows.append(row)
    return rows


def resumed(
    examine: Examine, cases: Sequence[Any], path: Path, about: Row, jobs: int, cap_s: float, silent: Row
) -> list[Row]:
    """Examine the cases that `path` has no row of yet, and add theirs; the rows of all, in the cases' order.

    `about` is said in each row and tells this run from others (who, which version); `silent` are the marks of
    who has not answered within `cap_s`.
    """
    known = {row["case"]: row for row in kept(path, about)}
    left = [case for case in cases if str(case) not in known]
    path.parent.mkdir(exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        cut = path.stat().st_size and not path.read_bytes().endswith(b"\n")
        file.write("\n" if cut else "")
        for count, row in enumerate(_answers(examine, left, jobs, cap_s, silent), 1):
            row = about | row
            known[row["case"]] = row
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(f"\r{count} of {len(left)}: {row['case']:50}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return [known[str(case)] for case in cases]


class _Desk(NamedTuple):
    """A process that examines, and the case that it has."""

    process: Any
    pipe: Connection
    case: Any
    until: float
    row: Row


def _answers(examine: Examine, cases: Iterable[Any], jobs: int, cap_s: float, silent: Row) -> Iterator[Row]:
    left = iter(cases)
    desks: list[_Desk] = []
    while True:
        while len(desks) < jobs and (case := next(left, None)) is not None:
            desks.append(_sat(examine, case))
        if not desks:
            return
        for desk in list(desks):
            now = time.monotonic()
            ready = wait([desk.pipe], max(min(desk.until - now, 0.2), 0.0))
            if not ready and now < desk.until:
                continue
            desks.remove(desk)
            try:
                part = desk.pipe.recv() if ready else silent | {"seconds": cap_s}
            except EOFError:  # the process has died
                part = silent
            row = {"case": str(desk.case)} | desk.row | (part or {})
            if ready and part is not None and part is not silent:
                desks.append(desk._replace(row=row, until=time.monotonic() + cap_s))
                continue
            if not ready:
                desk.process.kill()
            desk.process.join()
            desk.pipe.close()
            yield row


def _sat(examine: Examine, case: Any) -> _Desk:
    here, there = get_context("fork").Pipe(duplex=False)
    process = get_context("fork").Process(target=_examine, args=(examine, case, there), daemon=True)
    process.start()
    there.close()
    return _Desk(process, here, case, time.monotonic() + UNSTARTED_S, {})


def _examine(examine: Examine, case: Any, pipe: Connection) -> None:
    for part in examine(case):
        pipe.send(part)
    pipe.send(None)
