"""How many times faster, on a machine that others share: minima over interleaved rounds."""

from collections.abc import Callable, Iterable
from time import perf_counter
from typing import NamedTuple


class Row(NamedTuple):
    """One measured ratio; times in seconds. `reach` is the least ratio that we set out for, None for none."""

    work: str
    peer: str
    ours_s: float
    peer_s: float
    reach: float | None

    @property
    def times(self) -> float:
        """How many times longer the peer takes."""
        return self.peer_s / self.ours_s


def ratio(ours: Callable[[], object], peer: Callable[[], object], rounds: int) -> tuple[float, float]:
    """Least time of each in seconds, measured in turn, so that both meet the same disturbances."""
    best = {ours: float("inf"), peer: float("inf")}
    for work in best:
        work()  # caches, and a peer that compiles itself at the first call
    for _ in range(rounds):
        for work in best:
            start = perf_counter()
            work()
            best[work] = min(best[work], perf_counter() - start)
    return best[ours], best[peer]


def show(rows: Iterable[Row]) -> None:
    """Print rows as they come."""
    for row in rows:
        reach = "" if row.reach is None else f" (to reach: {row.reach:g})"
        print(
            f"{row.work}: {1e3 * row.ours_s:.3f} ms, {row.peer} {1e3 * row.peer_s:.3f} ms, "
            f"{row.times:.1f} times{reach}",
            flush=True,
        )
