"""The paper's fit beside SciPy, lmfit and variable projection in NumPy.

Table 2 of the paper: its swept sine, its knob, its noise, 30 000 samples. We get no starting values, the
peers a good start; everybody returns standard errors. `python benches/bench_fit.py` prints the ratios;
`pytest benches/bench_fit.py` the group.
"""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from knobs import PAPER_KNOB, model_of
from peers import (
    NAMES,
    PERIOD,
    Floats,
    good_start,
    lmfit_minimize,
    numpy_variable_projection,
    scipy_curve_fit,
)
from ratio import Row, ratio, show

import knobcam as kc

CAPTURE = kc.simulate(model_of(PAPER_KNOB), "sweep", noise="paper", seed=1)
# The right period within 2 %, and the linear part solved.
START = good_start(CAPTURE, 1.02 * PAPER_KNOB["detent.P"])
PEERS: dict[str, tuple[Callable[[kc.Capture, Floats], tuple[Floats, Floats]], float]] = {
    "scipy.optimize.curve_fit": (scipy_curve_fit, 20.0),
    "lmfit with uncertainties": (lmfit_minimize, 25.0),
    "variable projection in NumPy": (numpy_variable_projection, 4.0),
}


def ours() -> tuple[Floats, Floats]:
    """No starting values; whether there are detents at all is found out as well."""
    fit = kc.fit(CAPTURE, prepare="none")
    estimates = [fit.params[name] for name in NAMES]
    return np.array([e.value for e in estimates]), np.array([e.se for e in estimates])


def check_answers() -> None:
    """All reach the same optimum and the same standard errors."""
    p, se = ours()
    assert abs(p[PERIOD] - PAPER_KNOB["detent.P"]) < 4 * se[PERIOD]
    for peer, _ in PEERS.values():
        q, sd = peer(CAPTURE, START)
        # Peers stop at a relative change of 1e-8 of the error, which leaves them this far from the optimum.
        assert np.abs(p - q).max() < 1e-3 * se.min()
        np.testing.assert_allclose(se, sd, rtol=0.1)


@pytest.mark.parametrize("name", ["knobcam", *PEERS])
def test_fit(benchmark, name):
    check_answers()
    benchmark.group = "the paper's fit, 30 000 samples"
    benchmark(ours if name == "knobcam" else lambda: PEERS[name][0](CAPTURE, START))


def rows() -> Iterator[Row]:
    """Measured ratios, the answers checked first."""
    check_answers()
    for name, (peer, reach) in PEERS.items():
        times = ratio(ours, lambda: peer(CAPTURE, START), 40)  # noqa: B023
        yield Row("the paper's fit, 30 000 samples, no start", name, *times, reach)


if __name__ == "__main__":
    show(rows())
