"""A thousand block-bootstrap refits beside a SciPy loop and the best NumPy form.

Table 2 of the paper, 30 000 samples in 200 blocks, drawn with replacement. The NumPy form does what we do:
the products of each block once, then a matrix product and one batched solve for all draws. The SciPy loop
refits the drawn samples by `curve_fit` from the optimum; a few refits are measured and scaled to 1000.
"""

from collections.abc import Iterator

import numpy as np
import pytest
from bench_fit import CAPTURE
from peers import NAMES, Floats, equation_1, jacobian, motion_of
from ratio import Row, ratio, show
from scipy.optimize import curve_fit

import knobcam as kc

DRAWS, BLOCKS, MEASURED = 1000, 200, 5
FIT = kc.fit(CAPTURE, prepare="none")
BEST = np.array([FIT.params[name].value for name in NAMES])


def ours() -> Floats:
    refits = FIT.bootstrap(DRAWS, seed=1)
    return np.column_stack([refits[name] for name in NAMES])


def block_products() -> Floats:
    """J'J and J'r of every block at the optimum, shape (blocks, 8 * 9)."""
    motion = motion_of(CAPTURE)
    columns = jacobian(motion, *BEST).reshape(BLOCKS, -1, len(BEST))
    rest = (CAPTURE.tau - equation_1(motion, *BEST)).reshape(BLOCKS, -1)
    gram = np.einsum("bni,bnj->bij", columns, columns)
    slope = np.einsum("bni,bn->bi", columns, rest)
    return np.concatenate([gram, slope[:, :, None]], axis=2).reshape(BLOCKS, -1)


PRODUCTS = block_products()  # our fit has made its own as well, so neither side is timed for them


def numpy_block_moments() -> Floats:
    """One Gauss-Newton step from the optimum per draw, all draws at once."""
    rng = np.random.default_rng(1)
    drawn_blocks = rng.integers(0, BLOCKS, (DRAWS, BLOCKS)) + BLOCKS * np.arange(DRAWS)[:, None]
    counts = np.bincount(drawn_blocks.ravel(), minlength=DRAWS * BLOCKS).reshape(DRAWS, BLOCKS)
    drawn = (counts.astype(float) @ PRODUCTS).reshape(DRAWS, len(BEST), len(BEST) + 1)
    return BEST + np.linalg.solve(drawn[:, :, :-1], drawn[:, :, -1:])[:, :, 0]


def scipy_loop(draws: int = MEASURED) -> Floats:
    rng = np.random.default_rng(1)
    motion, tau = np.stack(motion_of(CAPTURE)), CAPTURE.tau
    starts = np.arange(len(tau)).reshape(BLOCKS, -1)
    refits = []
    for _ in range(draws):
        rows = starts[rng.integers(0, BLOCKS, BLOCKS)].ravel()
        drawn = (motion[0, rows], motion[1, rows], motion[2, rows])
        refits.append(curve_fit(equation_1, drawn, tau[rows], BEST)[0])
    return np.array(refits)


def check_answers() -> None:
    """The same centre and the same scatter, within what a thousand (or thirty) draws can tell."""
    a, b, c = ours(), numpy_block_moments(), scipy_loop(30)
    scatter = b.std(axis=0)
    np.testing.assert_allclose(a.std(axis=0), scatter, rtol=0.15)
    np.testing.assert_allclose(c.std(axis=0), scatter, rtol=0.5)
    assert np.all(np.abs(a.mean(axis=0) - b.mean(axis=0)) < 0.2 * scatter)
    assert np.all(np.abs(c.mean(axis=0) - b.mean(axis=0)) < scatter)


PEERS = {"block moments in NumPy": numpy_block_moments, "scipy refit loop (5 refits)": scipy_loop}


@pytest.mark.parametrize("name", ["knobcam", *PEERS])
def test_bootstrap(benchmark, name):
    check_answers()
    benchmark.group = "1000 block-bootstrap refits"
    benchmark(ours if name == "knobcam" else PEERS[name])


def rows() -> Iterator[Row]:
    """Measured ratios, the answers checked first."""
    check_answers()
    work = "1000 block-bootstrap refits"
    ours_s, loop_s = ratio(ours, scipy_loop, 5)
    yield Row(work, f"scipy refit loop, scaled from {MEASURED}", ours_s, loop_s * DRAWS / MEASURED, 1000.0)
    yield Row(work, "block moments in NumPy", *ratio(ours, numpy_block_moments, 60), 2.0)


if __name__ == "__main__":
    show(rows())
