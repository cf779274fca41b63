"""Table 2 of the paper: its own knob under its own motion and noise, over many draws of the noise."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from knobs import PAPER_KNOB, model_of, phase_error
from peers import NAMES, jacobian

import knobcam as kc

# What the paper needed without noise.
PAPER_ITERATIONS, PAPER_EVALUATIONS = 7, 43
METHODS = ("none", "smooth")


def exact() -> list[dict[str, Any]]:
    """The fit without noise, from no start and from starts 50 % off with the period unknown."""
    model = model_of(PAPER_KNOB)
    capture = kc.simulate(model, "sweep", noise="none")
    rows = []
    for start, factor in (("none", None), ("50 % low", 0.5), ("50 % high", 1.5)):
        given = model_of({name: factor * value for name, value in PAPER_KNOB.items()}) if factor else None
        fit = kc.fit(capture, given, prepare="none")
        worst = max(abs(fit.params[name].value / value - 1.0) for name, value in PAPER_KNOB.items())
        core = fit.core
        rows.append(
            {"start": start, "worst": worst, "iterations": core.iterations, "evaluations": core.evaluations}
        )
    return rows


def draws(method: str, count: int) -> dict[str, Any]:
    """Fits of `count` draws of the noise by one preparation: per parameter the spread of the estimates, the
    mean standard error, the bias and how often the interval covers the truth.
    """
    model = model_of(PAPER_KNOB)
    fits = [
        kc.fit(kc.simulate(model, "sweep", noise="paper", seed=seed), prepare=method) for seed in range(count)
    ]
    parameters = {}
    for name, truth in PAPER_KNOB.items():
        # Phases within half a turn of the truth; the other errors are far below pi.
        error = np.array([phase_error(fit.params[name].value, truth) for fit in fits])
        se = np.array([fit.params[name].se for fit in fits])
        parameters[name] = {
            "sd": float(np.std(error)),
            "se": float(np.mean(se)),
            "bias": float(np.mean(error)),
            "covered": float(np.mean(np.abs(error) < 1.96 * se)),
        }
    return {
        "draws": count,
        "parameters": parameters,
        "iterations": max(fit.core.iterations for fit in fits),
        "evaluations": max(fit.core.evaluations for fit in fits),
    }


def least_squares_sd() -> dict[str, float]:
    """Standard deviation that the least-squares estimate has under Equation 6, to first order."""
    capture = kc.simulate(model_of(PAPER_KNOB), "sweep", noise="none")
    columns = jacobian((capture.theta, capture.omega, capture.alpha), *[PAPER_KNOB[name] for name in NAMES])
    uniform = 4.0 / np.sqrt(12.0)
    sd = uniform * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    return dict(zip(NAMES, sd.tolist(), strict=True))


def run(count: int) -> dict[str, Any]:
    """Both parts."""
    by_method = {method: draws(method, count) for method in METHODS}
    return {"exact": exact(), "theory": least_squares_sd(), "draws": by_method}


def report(result: dict[str, Any]) -> Iterator[str]:
    """Tables of what came out."""
    for row in result["exact"]:
        yield (
            f"without noise, start {row['start']:9}: largest relative error {row['worst']:.1e}, "
            f"{row['iterations']} iterations, {row['evaluations']} evaluations "
            f"(the paper: {PAPER_ITERATIONS}, {PAPER_EVALUATIONS})"
        )
    for method, drawn in result["draws"].items():
        yield (
            f'{drawn["draws"]} draws, prepare="{method}": at most {drawn["iterations"]} iterations, '
            f"{drawn['evaluations']} evaluations"
        )
        yield "  parameter    theory's sd  measured sd  mean se    bias/sd  covered %"
        for name, sd in result["theory"].items():
            own = drawn["parameters"][name]
            yield (
                f"  {name:12} {sd:11.5f}  {own['sd']:11.5f}  {own['se']:9.5f} "
                f"{own['bias'] / own['sd']:7.2f}  {100.0 * own['covered']:8.1f}"
            )
