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


def draws(count: int) -> list[dict[str, Any]]:
    """Fits of `count` draws of the noise, by each preparation."""
    model = model_of(PAPER_KNOB)
    rows = []
    for method in METHODS:
        for seed in range(count):
            fit = kc.fit(kc.simulate(model, "sweep", noise="paper", seed=seed), prepare=method)
            error = {name: e.value - PAPER_KNOB[name] for name, e in fit.params.items()}
            error["detent.S"] = phase_error(fit.params["detent.S"].value, PAPER_KNOB["detent.S"])
            rows.append(
                {
                    "prepare": method,
                    "seed": seed,
                    "error": error,
                    "se": {name: e.se for name, e in fit.params.items()},
                    "iterations": fit.core.iterations,
                    "evaluations": fit.core.evaluations,
                }
            )
    return rows


def least_squares_sd() -> dict[str, float]:
    """Standard deviation that the least-squares estimate has under Equation 6, to first order."""
    capture = kc.simulate(model_of(PAPER_KNOB), "sweep", noise="none")
    columns = jacobian((capture.theta, capture.omega, capture.alpha), *[PAPER_KNOB[name] for name in NAMES])
    uniform = 4.0 / np.sqrt(12.0)
    sd = uniform * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    return dict(zip(NAMES, sd.tolist(), strict=True))


def run(count: int) -> dict[str, Any]:
    """Both parts."""
    return {"exact": exact(), "theory": least_squares_sd(), "draws": draws(count)}


def report(result: dict[str, Any]) -> Iterator[str]:
    """Tables of what came out."""
    for row in result["exact"]:
        yield (
            f"without noise, start {row['start']:9}: largest relative error {row['worst']:.1e}, "
            f"{row['iterations']} iterations, {row['evaluations']} evaluations "
            f"(the paper: {PAPER_ITERATIONS}, {PAPER_EVALUATIONS})"
        )
    for method in METHODS:
        rows = [row for row in result["draws"] if row["prepare"] == method]
        most = [max(row[key] for row in rows) for key in ("iterations", "evaluations")]
        yield f'{len(rows)} draws, prepare="{method}": at most {most[0]} iterations, {most[1]} evaluations'
        yield "  parameter    theory's sd  measured sd  mean se    bias/sd  covered %"
        for name, sd in result["theory"].items():
            error = np.array([row["error"][name] for row in rows])
            se = np.array([row["se"][name] for row in rows])
            covered = 100.0 * np.mean(np.abs(error) < 1.96 * se)
            yield (
                f"  {name:12} {sd:11.5f}  {np.std(error):11.5f}  {np.mean(se):9.5f} "
                f"{np.mean(error) / np.std(error):7.2f}  {covered:8.1f}"
            )
