"""Random knobs with no starting values: does the fit find the right detents, and what do its peers reach?

Knobs of the size of the paper's Equation 5 under its swept sine (Equations 3 and 4) with its noise
(Equation 6). A fit is in the right basin when its sum of squares is no larger than that of the true
parameters, which only a fit around them reaches, and its period is the true one within 2 % or, where noise
alone moves it further, within five standard deviations.
"""

import warnings
from collections.abc import Callable, Iterator
from typing import Any

import lmfit
import numpy as np
from knobs import model_of, paper_like
from scipy.optimize import curve_fit, least_squares

import knobcam as kc

START_FACTORS = (0.3, 0.5, 0.8, 1.0, 1.25, 2.0, 3.0)
NAMES = list(paper_like(np.random.default_rng(0)))
PERIOD = NAMES.index("detent.P")
Floats = np.ndarray[Any, np.dtype[np.float64]]


def equation_1(motion: tuple[Floats, Floats, Floats], *p: float) -> Floats:
    """Torque of the paper's Equation 1; parameters in the order of NAMES."""
    theta, omega, alpha = motion
    m, c_neg, c_pos, b_neg, b_pos, a, period, shift = p
    forward = omega > 0.0
    friction = np.where(forward, c_pos + b_pos * omega, b_neg * omega - c_neg)
    return m * alpha + friction + a * np.sin(theta / period + shift)


def jacobian(motion: tuple[Floats, Floats, Floats], *p: float) -> Floats:
    """Derivatives of `equation_1`, shape (samples, parameters)."""
    theta, omega, alpha = motion
    a, period, shift = p[5:]
    forward = omega > 0.0
    phase = theta / period + shift
    sin, cos = np.sin(phase), np.cos(phase)
    return np.stack(
        [
            alpha,
            np.where(forward, 0.0, -1.0),
            np.where(forward, 1.0, 0.0),
            np.where(forward, 0.0, omega),
            np.where(forward, omega, 0.0),
            sin,
            -a * cos * theta / period**2,
            a * cos,
        ],
        axis=1,
    )


def good_start(capture: kc.Capture, period: float) -> Floats:
    """What a careful user would hand to a peer: the linear part solved, the rest as the amplitude."""
    theta, omega, alpha = capture.theta, capture.omega, capture.alpha
    columns = jacobian((theta, omega, alpha), *np.ones(8))[:, :5]
    linear, *_ = np.linalg.lstsq(columns, capture.tau, rcond=None)
    rest = capture.tau - columns @ linear
    return np.array([*linear, np.sqrt(2.0) * np.std(rest), period, 0.0])


def _least_squares(capture: kc.Capture, start: Floats) -> Floats:
    motion = capture.theta, capture.omega, capture.alpha
    # Without `x_scale` it creeps: thousands of evaluations even from the true period.
    work = least_squares(lambda p: equation_1(motion, *p) - capture.tau, start, x_scale="jac", max_nfev=200)
    return work.x


def _curve_fit(capture: kc.Capture, start: Floats) -> Floats:
    motion = capture.theta, capture.omega, capture.alpha
    return curve_fit(equation_1, motion, capture.tau, start)[0]


def _lmfit(capture: kc.Capture, start: Floats) -> Floats:
    motion = capture.theta, capture.omega, capture.alpha
    names = [name.replace(".", "_") for name in NAMES]
    parameters = lmfit.create_params(**dict(zip(names, start.tolist(), strict=True)))

    def residual(p: lmfit.Parameters) -> Floats:
        return equation_1(motion, *p.valuesdict().values()) - capture.tau

    result = lmfit.minimize(residual, parameters, calc_covar=False)
    return np.array(list(result.params.valuesdict().values()))


PEERS: dict[str, Callable[[kc.Capture, Floats], Floats]] = {
    "scipy.optimize.least_squares": _least_squares,
    "scipy.optimize.curve_fit": _curve_fit,
    "lmfit": _lmfit,
}


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

    row: dict[str, Any] = {"seed": seed, "truth": truth, "period_sd": period_sd}
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
