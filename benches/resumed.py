"""Cases examined one by one in processes of their own; what was answered is kept, line by line.

A run that was killed goes on where it stopped. An examination yields its row in parts: what is known of the
case, then the marks. Who has not answered in time is stopped, and the row is closed without marks. A case
that dies before its first part has no row.
"""

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

Row = dict[str, Any]
Examine = Callable[[Any], Iterator[Row]]
UNSTARTED_S = 300.0  # of the processor, to make a case


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
    who has not answered within `cap_s` of the processor.
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
    return [known[str(case)] for case in cases if str(case) in known]


class _Desk(NamedTuple):
    """A process that examines, the case that it has, and the processor's seconds when it was known."""

    process: Any
    pipe: Connection
    case: Any
    started_s: float = 0.0
    row: Row = {}  # noqa: RUF012  never changed

    @property
    def spent_s(self) -> float:
        """Processor's seconds since then, of all threads: a busy machine makes nobody slower."""
        return max(_processor_s(self.process.pid) - self.started_s, 0.0)


def _answers(examine: Examine, cases: Iterable[Any], jobs: int, cap_s: float, silent: Row) -> Iterator[Row]:
    left = iter(cases)
    desks: list[_Desk] = []
    while True:
        while len(desks) < jobs and (case := next(left, None)) is not None:
            desks.append(_sat(examine, case))
        if not desks:
            return
        for desk in list(desks):
            ready = wait([desk.pipe], 0.2)
            spent_s = desk.spent_s
            if not ready and spent_s < (cap_s if desk.row else UNSTARTED_S):
                continue
            desks.remove(desk)
            part = _received(desk.pipe) if ready else None
            if part:
                started_s = desk.started_s if desk.row else _processor_s(desk.process.pid)
                desks.append(desk._replace(row=desk.row | part, started_s=started_s))
                continue
            desk.process.kill()
            desk.process.join()
            desk.pipe.close()
            if desk.row:  # else there is no such case
                unmarked = silent if part is None else {}
                yield {"case": str(desk.case)} | desk.row | unmarked | {"processor_s": round(spent_s, 2)}


def _processor_s(pid: int) -> float:
    """What a process has had of the processor; of one that has ended none, once it was joined."""
    try:
        after_name = Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()
    except FileNotFoundError:
        return 0.0
    return sum(map(int, after_name[11:13])) / os.sysconf("SC_CLK_TCK")


def _received(pipe: Connection) -> Row | None:
    """The next part of a row, empty at its end; None from a process that has died."""
    try:
        part: Row = pipe.recv()
    except EOFError:
        return None
    return part


def _sat(examine: Examine, case: Any) -> _Desk:
    here, there = get_context("fork").Pipe(duplex=False)
    process = get_context("fork").Process(target=_examine, args=(examine, case, there), daemon=True)
    process.start()
    there.close()
    return _Desk(process, here, case)


def _examine(examine: Examine, case: Any, pipe: Connection) -> None:
    for part in examine(case):
        pipe.send(part)
    pipe.send({})
