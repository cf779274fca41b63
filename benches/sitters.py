"""Peers who sit the examination in strata: the tools that one would otherwise reach for.

stepwise: effects enter a regression one by one and leave it again, as long as BIC falls.
stlsq: sparse regression over all columns, PySINDy's own optimizer, its threshold chosen by BIC.
bam: the six friction models of Duclusaud & Passault (github.com/Rhoban/bam, `bam/model.py`), chosen by BIC.

Each names only what its vocabulary has; what each is given beyond a capture is in `terms`.
"""

import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from hidden import Hidden
from scipy.optimize import least_squares
from strata import Stratum
from terms import Terms, terms

Floats = np.ndarray
SILENT: dict[str, Any] = {"verdict": "no answer", "found": [], "exact": False, "wrong": False}


def sat(who: str, case: Stratum) -> Iterator[dict[str, Any]]:
    """A peer's row: what is known of the knob, then the marks."""
    knob = case.make()
    yield {"sitting": case.sitting, "topic": case.topic, "accepted": knob.accepted}
    yield marked(who, knob)


def marked(who: str, knob: Hidden) -> dict[str, Any]:
    """Ask a peer, and judge the answer."""
    start = time.perf_counter()
    found = _PEERS[who](terms(knob))
    right = set().union(*knob.accepted)
    exact = len(found) == len(knob.accepted) and all(set(found) & set(names) for names in knob.accepted)
    return {
        "seconds": round(time.perf_counter() - start, 2),
        "verdict": "missing" if found else "complete",
        "found": found,
        "exact": exact,
        "wrong": not set(found) <= right,
    }


def bic(rest: Floats, parameters: int) -> float:
    """Schwarz 1978, for independent normal residuals."""
    n = len(rest)
    return n * float(np.log(np.mean(rest**2))) + parameters * float(np.log(n))


def stepwise(given: Terms) -> list[str]:
    """Forward and backward selection of whole effects."""
    torque = given.rest(given.torque)
    columns = {name: given.rest(group) for name, group in given.effects.items()}

    def worth(names: list[str]) -> float:
        if not names:
            return bic(torque, 0)
        chosen = np.hstack([columns[name] for name in names])
        fitted, _, rank, _ = np.linalg.lstsq(chosen, torque, rcond=1e-9)
        return bic(torque - chosen @ fitted, int(rank))

    found: list[str] = []
    while True:
        added = [[*found, name] for name in columns if name not in found]
        dropped = [[other for other in found if other != name] for name in found]
        best = min([found, *added, *dropped], key=worth)
        if best == found:
            return found
        found = best


def stlsq(given: Terms) -> list[str]:
    """Sequentially thresholded least squares (Brunton, Proctor & Kutz 2016) on columns of one length."""
    from pysindy.optimizers import STLSQ

    torque = given.rest(given.torque)
    names = [name for name, group in given.effects.items() for _ in range(group.shape[1])]
    columns = given.rest(np.hstack(list(given.effects.values())))
    columns = columns / np.linalg.norm(columns, axis=0)
    best, found = bic(torque, 0), []
    for threshold in np.geomspace(0.02, 1.0, 14) * np.linalg.norm(torque):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that the threshold leaves nothing, as the largest should
            model = STLSQ(threshold=threshold, alpha=1e-6, max_iter=20).fit(columns, torque[:, None])
        kept = np.flatnonzero(model.coef_[0])
        now = bic(torque - columns @ model.coef_[0], len(kept))
        if now < best:
            best, found = now, list(dict.fromkeys(names[i] for i in kept))
    return found


def bam(given: Terms) -> list[str]:
    """M1 to M6; their friction is added to Equation 1, so that each direction has its own as our knobs do."""
    worths = {model: _bam(given, *laws) for model, laws in _BAM.items()}
    return _BAM_NAMES[min(worths, key=lambda model: worths[model])]


# Whether the friction has Stribeck terms, loads, loads that differ by side, and their squares.
_BAM = {
    "m1": (False, False, False, False),
    "m2": (True, False, False, False),
    "m3": (False, True, False, False),
    "m4": (True, True, False, False),
    "m5": (True, True, True, False),
    "m6": (True, True, True, True),
}
_BOTH = ["stribeck", "load_friction"]
_BAM_NAMES = {"m1": [], "m2": ["stribeck"], "m3": ["load_friction"], "m4": _BOTH, "m5": _BOTH, "m6": _BOTH}


def _bam(given: Terms, stribeck: bool, loaded: bool, sided: bool, squared: bool) -> float:
    """BIC of one model; what enters linearly is solved for, the rest searched by scipy."""
    sign, speed = np.sign(given.omega), np.abs(given.omega)
    torque = given.rest(given.torque)
    # A load that was made of the very torque that is to be explained would explain its noise.
    motor, external = given.torque - torque, -given.detent

    def columns(p: Floats) -> Floats:
        fall = np.exp(-((speed / np.exp(p[0])) ** p[1]))
        gear = np.abs(np.cos(p[2]) * external - np.sin(p[2]) * motor) if sided else np.abs(external - motor)
        still = np.abs(np.cos(p[3]) * external - np.sin(p[3]) * motor) if sided else gear
        made = [fall] if stribeck else []
        made += [gear] if loaded else []
        made += [still * fall] if stribeck and loaded else []
        if squared:
            against = fall * (np.sign(external) != np.sign(motor))
            made += [against * (np.abs(external) < np.abs(motor)) * external**2]
            made += [against * (np.abs(external) > np.abs(motor)) * motor**2]
        return given.rest(np.stack([sign * law for law in made], 1))

    def left(p: Floats) -> Floats:
        law = columns(p)
        return torque - law @ np.linalg.lstsq(law, torque, rcond=1e-9)[0]

    if not (stribeck or loaded):
        return bic(torque, 0)
    hard = 2 * stribeck + 2 * sided
    start = np.array([np.log(0.2), 1.35, 0.7, 0.7])
    if not stribeck:
        return bic(left(start), 1)
    bounds = ([np.log(0.02), 0.5, -0.1, -0.1], [np.log(3.0), 10.0, 1.7, 1.7])  # BAM's, and slower speeds
    found = least_squares(left, start, bounds=bounds, diff_step=1e-3, max_nfev=25)
    return bic(found.fun, hard + columns(start).shape[1])


_PEERS: dict[str, Callable[[Terms], list[str]]] = {"stepwise": stepwise, "stlsq": stlsq, "bam": bam}
