"""How many times faster, on a machine that others share: minima over interleaved rounds."""

from collections.abc import Callable
from time import perf_counter


def ratio(ours: Callable[[], object], peer: Callable[[], object], rounds: int) -> tuple[float, float, float]:
    """Time `ours` and `peer` in turn, so that both meet the same disturbances.

    Returns the least time of each in seconds, and how many times longer the peer's is.
    """
    best = {ours: float("inf"), peer: float("inf")}
    for work in best:
        work()  # caches, and a peer that compiles itself at the first call
    for _ in range(rounds):
        for work in best:
            start = perf_counter()
            work()
            best[work] = min(best[work], perf_counter() - start)
    return best[ours], best[peer], best[peer] / best[ours]
