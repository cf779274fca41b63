"""The cases of a study, examined beside one another, with a line that says how far it is."""

import sys
from collections.abc import Callable, Sequence
from multiprocessing import Pool
from typing import Any


def pooled(
    examine: Callable[[Any], dict[str, Any]], cases: Sequence[Any], jobs: int, name: str
) -> list[dict[str, Any]]:
    """Examine the cases in so many processes, in their order; `name` is the key by which a row is told."""
    rows = []
    with Pool(jobs) as pool:
        for count, row in enumerate(pool.imap(examine, cases), 1):
            rows.append(row)
            print(f"\r{count} of {len(cases)}: {row[name]:40}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return rows
