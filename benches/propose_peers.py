"""Peers who look for the law in the same residuals: `python benches/propose_peers.py [--samples 2000]`.

gplearn (BSD, symbolic regression by genetic programming) and the sparse regression of PySINDy (MIT) over a
library of friction, waves and powers, its threshold chosen by BIC. Neither is needed by anything else here:
install them beside this for that sitting, `pip install gplearn pysindy`. Each is given what Equation 1 leaves
of a capture of `study_propose.py`, with the smoothed motion, and judged by the same measure as knobcam's
first law: right where it differs from the truth by less than 3 % of its RMS beyond what Equation 1 can absorb
of either.
"""

import argparse
import time
import warnings

import hidden
import numpy as np
from hidden.base import Base
from hidden.lawful import VARIABLES
from hidden.motions import Floats
from study_propose import RIGHT, STRENGTHS

import knobcam as kc

THRESHOLDS = np.geomspace(0.003, 0.3, 13)


def features(t: Floats, theta: Floats, omega: Floats, alpha: Floats) -> Floats:
    return np.column_stack([theta, omega, alpha, t, np.sign(omega), np.abs(omega)])


def gplearn(x: Floats, y: Floats, motion: Floats, samples: int) -> Floats:
    """Its defaults but for the functions that mechanics needs, and twice the usual price of length."""
    from gplearn.genetic import SymbolicRegressor

    some = np.random.default_rng(0).choice(len(y), min(samples, len(y)), replace=False)
    search = SymbolicRegressor(
        population_size=1000,
        generations=20,
        function_set=("add", "sub", "mul", "div", "sin", "cos", "abs", "sqrt", "inv", "neg"),
        const_range=(-10.0, 10.0),
        parsimony_coefficient=0.002,
        metric="rmse",
        random_state=0,
    )
    search.fit(x[some], y[some])
    return np.asarray(search.predict(motion))


def library(x: Floats) -> Floats:
    """Powers and products to the third, waves of the angle and of time, and the usual laws of friction."""
    theta, omega, alpha, t, sign, size = x.T
    columns = [np.ones_like(t), theta, omega, alpha, t, sign, sign * omega**2, sign * size**0.5]
    columns += [
        theta**2,
        theta**3,
        omega**2,
        omega**3,
        theta * omega,
        theta * alpha,
        omega * alpha,
        t * omega,
    ]
    columns += [theta * omega**2, theta**2 * alpha, theta**2 * omega, t * sign, theta * sign, theta**2 * sign]
    columns += [f(k * theta) for k in range(1, 13) for f in (np.sin, np.cos)]
    columns += [omega**2 * f(k * theta) for k in (1, 2) for f in (np.sin, np.cos)]
    columns += [alpha * f(k * theta) for k in (1, 2) for f in (np.sin, np.cos)]
    columns += [
        np.exp(-t / T) * f(k * theta) for T in (1.0, 3.0) for k in range(1, 9) for f in (np.sin, np.cos)
    ]
    columns += [f(2.0 * np.pi * hertz * t) for hertz in (50.0, 60.0, 100.0) for f in (np.sin, np.cos)]
    columns += [np.tanh(omega / w) for w in (0.1, 1.0)] + [sign * np.exp(-size / w) for w in (0.1, 0.3, 1.0)]
    columns += [omega / (1.0 + (omega / w) ** 2) for w in (0.5, 1.0, 2.0, 4.0)]
    columns += [omega * np.exp(-(((theta - c) / 0.3) ** 2)) for c in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    columns += [sign * np.exp(-(((theta - c) / 0.3) ** 2)) for c in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    return np.column_stack(columns)


def pysindy(x: Floats, y: Floats, motion: Floats, _: int) -> Floats:
    """STLSQ over the library, columns of one size."""
    from pysindy.optimizers import STLSQ

    columns = library(x)
    size = np.sqrt(np.mean(columns**2, axis=0))
    best, chosen = np.inf, np.zeros(columns.shape[1])
    for threshold in THRESHOLDS:
        sparse = STLSQ(threshold=threshold, alpha=1e-6).fit(columns / size, y[:, None])
        found = np.asarray(sparse.coef_)[0]
        left = np.mean((y - columns / size @ found) ** 2)
        bic = len(y) * np.log(left) + np.log(len(y)) * np.count_nonzero(found)
        if bic < best:
            best, chosen = bic, found
    return library(motion) / size @ chosen


def main() -> None:
    """Examine, and print a line a law and the shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--laws", type=int, default=1, help="knobs of each law")
    parser.add_argument("--first", type=int, default=51_006)
    parser.add_argument("--samples", type=int, default=2000, help="of which gplearn evolves its formulas")
    args = parser.parse_args()
    right: dict[str, list[bool]] = {"gplearn": [], "pysindy": []}
    spent: dict[str, list[float]] = {"gplearn": [], "pysindy": []}
    for kind in VARIABLES:
        for seed in range(args.first, args.first + args.laws):
            try:
                knob = hidden.make(seed, [kind], strength=STRENGTHS)
            except ValueError:
                continue
            columns = {name.split("_")[0]: column for name, column in knob.capture.items()}
            fit = kc.fit(kc.Capture.from_arrays(**columns))
            signals, rest = fit.prepared[0], fit.residuals[0]
            used = np.isfinite(rest)
            t, theta, omega, alpha = (
                signals.on_capture(getattr(signals, name))[used] for name in ("t", "theta", "omega", "alpha")
            )
            track, size = knob.track, float(np.std(rest[used]))
            truth, base = knob.chain.strange, Base(knob.track, knob.chain.loads)
            exact = features(track.t, track.theta, track.omega, track.alpha)
            said = []
            for name, peer in (("gplearn", gplearn), ("pysindy", pysindy)):
                before = time.process_time()
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    law = size * peer(
                        features(t, theta, omega, alpha), rest[used] / size, exact, args.samples
                    )
                spent[name].append(time.process_time() - before)
                off = base.left(law - truth) / base.left(truth)
                right[name].append(bool(off < RIGHT))
                said.append(f"{name} off by {100.0 * off:.0f} % in {spent[name][-1]:.1f} s")
            print(f"{kind}:{seed}  {'  '.join(said)}", flush=True)
    for name, marks in right.items():
        print(
            f"{name}: right form {sum(marks)} of {len(marks)}, {np.median(spent[name]):.1f} s in the middle"
        )


if __name__ == "__main__":
    main()
