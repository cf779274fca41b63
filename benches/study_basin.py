"""Random knobs with no starting values: does the fit find the right detents, and what do its peers reach?

Knobs of the size of the paper's Equation 5 under its swept sine (Equations 3 and 4) with its noise
(Equation 6). A fit is in the right basin when its sum of squares is no larger than that of the true
parameters, which only a fit around them reaches, and its period is the true one within 2 % or, where noise
alone moves it further, within five standard deviations.
"""

import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from knobs import model_of, paper_like
from peers import (
    NAMES,
    PERIOD,
    Floats,
    equation_1,
    good_start,
    jacobian,
    lmfit_minimize,
    scipy_curve_fit,
    scipy_least_squares,
)

import knobcam as kc

PEERS: dict[str, Callable[[kc.Capture, Floats], Floats]] = {
    "scipy.optimize.least_squares": scipy_least_squares,
    "scipy.optimize.curve_fit": lambda capture, start: scipy_curve_fit(capture, start)[0],
    "lmfit": lambda capture, start: lmfit_minimize(capture, start, uncertainties=False)[0],
}
START_FACTORS = (0.3, 0.5, 0.8, 1.0, 1.25, 2.0, 3.0)


def one(seed: int, peers: bool) -> dict[str, Any]:
    """Fit one random knob; with `peers`, also by them from several starts."""
    truth = paper_like(np.random.default_rng(seed))
    capture = kc.simulate(model_of(truth), "sweep", noise="paper", seed=seed)
    motion = capture.theta, capture.omega, capture.alpha
    exact = np.array([truth[name] for name in NAMES])

    def cost(p: Floats) -> float:
        return float(np.sum((equation_1(motion, *p) - capture.tau) ** 2))

    columns = jacobian(motion, *exact)
    period_sd = float(np.sqrt(np.linalg.inv(columns.T @ columns)[PERIOD, PERIOD] * 16.0 / 12.0))

    def right(period: float) -> bool:
        return abs(period - exact[PERIOD]) < max(0.02 * exact[PERIOD], 5.0 * period_sd)

    row: dict[str, Any] = {"seed": seed, "P": truth["detent.P"], "P_sd": period_sd}
    for detents in ("yes", "auto"):
        for prepare in ("none", "smooth"):
            fit = kc.fit(capture, detents=detents, prepare=prepare)
            found = "detent" in fit.model.effects
            period = fit.params["detent.P"].value if found else float("nan")
            p = np.array([fit.params[name].value if name in fit.params else 0.0 for name in NAMES])
            low = prepare != "none" or (found and cost(p) <= cost(exact))
            row[f"{detents}, {prepare}"] = {"right": bool(right(period) and low), "P": period}
    for name, peer in PEERS.items() if peers else ():
        reached = []
        for factor in START_FACTORS:
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # peers warn where their covariance fails
                    p = peer(capture, good_start(capture, factor * exact[PERIOD]))
            except RuntimeError:  # out of evaluations
                reached.append(False)
                continue
            reached.append(bool(right(abs(p[PERIOD])) and cost(p) <= cost(exact)))
        row[name] = reached
    return row


def run(knobs: int, subset: int) -> list[dict[str, Any]]:
    """Fit `knobs` knobs, the first `subset` of them by the peers too."""
    return [one(seed, seed < subset) for seed in range(knobs)]


def report(rows: list[dict[str, Any]]) -> Iterator[str]:
    """Tables of what came out."""
    for detents in ("yes", "auto"):
        for prepare in ("none", "smooth"):
            key = f"{detents}, {prepare}"
            wrong = [row["seed"] for row in rows if not row[key]["right"]]
            count = f"{len(rows) - len(wrong)} of {len(rows)}"
            yield f'detents="{detents}", prepare="{prepare}": {count} right, wrong: seeds {wrong}'
    subset = [row for row in rows if "lmfit" in row]
    yield f"peers, {len(subset)} knobs, by the period that they start from, times the true one:"
    yield f"{'':30}" + "".join(f"{factor:>7}" for factor in START_FACTORS)
    for name in PEERS:
        reached = np.sum([row[name] for row in subset], axis=0)
        yield f"{name:30}" + "".join(f"{count:>7}" for count in reached)
