"""The zero-phase filter beside SciPy and a compiled loop: the paper's torque filter, four channels.

`python benches/bench_filter.py` prints the ratios; `pytest benches/bench_filter.py` the groups.
"""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numba import njit
from ratio import Row, ratio, show
from scipy import signal

from knobcam import _core

RATE_HZ, EDGE_HZ, ORDER, STOPBAND_DB = 5000.0, 500.0, 3, 20.0
B, A = signal.cheby2(ORDER, STOPBAND_DB, EDGE_HZ, fs=RATE_HZ)
SOS = _core.cheby2_sos(ORDER, STOPBAND_DB, EDGE_HZ, RATE_HZ)
ZI = signal.lfilter_zi(B, A)
PADDING = 3 * max(len(A), len(B))
SIZES = {"25 000": 25_000, "10^6": 1_000_000}


def channels(samples: int) -> np.ndarray:
    """Torque, position, speed and acceleration of a knob, each of full scale 1, with noise."""
    t = np.arange(samples) / RATE_HZ
    noise = np.random.default_rng(1).normal(scale=0.05, size=(4, samples))
    phases = np.arange(4)[:, None]
    return np.sin(2 * np.pi * 0.7 * t + phases) + 0.2 * np.sin(2 * np.pi * 31.0 * t) + noise


@njit(fastmath=True)
def _recursion(b, a, x, z):
    """Order 3, transposed direct form II, its memory in registers."""
    y = np.empty_like(x)
    b0, b1, b2, b3 = b[0], b[1], b[2], b[3]
    a1, a2, a3 = a[1], a[2], a[3]
    z0, z1, z2 = z[0], z[1], z[2]
    for i in range(x.size):
        xi = x[i]
        yi = b0 * xi + z0
        z0 = b1 * xi + z1 - a1 * yi
        z1 = b2 * xi + z2 - a2 * yi
        z2 = b3 * xi - a3 * yi
        y[i] = yi
    return y


@njit
def _numba_filtfilt(b, a, zi, padding, rows):
    out = np.empty_like(rows)
    n = rows.shape[1]
    for c in range(rows.shape[0]):
        x = rows[c]
        padded = np.empty(n + 2 * padding)
        for i in range(padding):
            padded[i] = 2 * x[0] - x[padding - i]
            padded[padding + n + i] = 2 * x[n - 1] - x[n - 2 - i]
        padded[padding : padding + n] = x
        once = _recursion(b, a, padded, zi * padded[0])[::-1].copy()
        twice = _recursion(b, a, once, zi * once[0])[::-1]
        out[c] = twice[padding : padding + n]
    return out


def ours(x: np.ndarray) -> np.ndarray:
    return _core.zero_phase(x, SOS)


def scipy_filtfilt(x: np.ndarray) -> np.ndarray:
    return signal.filtfilt(B, A, x)


def scipy_filtfilt_by_channel(x: np.ndarray) -> list[np.ndarray]:
    return [signal.filtfilt(B, A, row) for row in x]


def scipy_sosfiltfilt(x: np.ndarray) -> np.ndarray:
    return signal.sosfiltfilt(SOS, x)


def numba_filtfilt(x: np.ndarray) -> np.ndarray:
    return _numba_filtfilt(B, A, ZI, PADDING, x)


PEERS: dict[str, Callable[[np.ndarray], object]] = {
    "scipy.signal.filtfilt": scipy_filtfilt,
    "scipy.signal.filtfilt, by channel": scipy_filtfilt_by_channel,
    "scipy.signal.sosfiltfilt": scipy_sosfiltfilt,
    "numba loop": numba_filtfilt,
}


def check_answers(x: np.ndarray) -> float:
    """Largest difference from `sosfiltfilt` in units of full scale; a peer must be nearly right too."""
    reference = signal.sosfiltfilt(SOS, x)
    full_scale = np.abs(x).max()
    for peer in PEERS.values():
        # The other peers pad by their own rule, which shows near the ends only.
        inner = np.asarray(peer(x))[:, 500:-500]
        assert np.abs(inner - reference[:, 500:-500]).max() < 1e-9 * full_scale
    difference = np.abs(ours(x) - reference).max() / full_scale
    assert difference <= 1e-12
    return difference


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["knobcam", *PEERS])
def test_filter(benchmark, name, size):
    x = channels(SIZES[size])
    check_answers(x)
    benchmark.group = f"zero-phase filter, 4 x {size}"
    benchmark(ours if name == "knobcam" else PEERS[name], x)


# What to reach against each peer, by the size of SIZES.
REACH = {
    ("25 000", "scipy.signal.filtfilt"): 10.0,
    ("25 000", "scipy.signal.sosfiltfilt"): 20.0,
    ("25 000", "numba loop"): 4.0,
    ("10^6", "scipy.signal.filtfilt"): 10.0,
}


def rows() -> Iterator[Row]:
    """Measured ratios, the answers checked first."""
    for size, samples in SIZES.items():
        x = channels(samples)
        check_answers(x)
        for name, peer in PEERS.items():
            times = ratio(lambda: ours(x), lambda: peer(x), 3_000_000 // samples + 12)  # noqa: B023
            yield Row(f"zero-phase filter, 4 x {size}", name, *times, REACH.get((size, name)))


if __name__ == "__main__":
    show(rows())
