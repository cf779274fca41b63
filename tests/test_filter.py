"""The zero-phase filter: laws it keeps, SciPy's numbers, and refusals that say what to do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from knobcam import _core

RATE_HZ = 5000.0
PAPER = _core.cheby2_sos(3, 20.0, 500.0, RATE_HZ)

kinds = st.sampled_from(["cheby2", "butter"])
orders = st.integers(1, 8)
edges = st.floats(0.002, 0.9)  # of the Nyquist frequency
seeds = st.integers(0, 2**32 - 1)


def designed(kind: str, order: int, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """The same design by knobcam and by SciPy."""
    edge_hz = edge * RATE_HZ / 2
    if kind == "cheby2":
        scipy = signal.cheby2(order, 20.0, edge_hz, fs=RATE_HZ, output="sos")
        return _core.cheby2_sos(order, 20.0, edge_hz, RATE_HZ), scipy
    scipy = signal.butter(order, edge_hz, fs=RATE_HZ, output="sos")
    return _core.butter_sos(order, edge_hz, RATE_HZ), scipy


def channels(seed: int, count: int, samples: int) -> np.ndarray:
    """Noise with offsets and trends of up to a hundred times its size."""
    rng = np.random.default_rng(seed)
    offset, trend = rng.uniform(-100, 100, (2, count, 1))
    return rng.standard_normal((count, samples)) + offset + trend * np.linspace(0, 1, samples)


@settings(max_examples=300, deadline=None)
@given(kinds, orders, edges, seeds, st.integers(1, 9), st.integers(28, 1500))
def test_every_design_and_any_channels_give_scipys_result(kind, order, edge, seed, count, samples):
    ours, scipy = designed(kind, order, edge)
    x = channels(seed, count, samples)
    reference = signal.sosfiltfilt(scipy, x)
    scale = np.abs(reference).max(axis=1, keepdims=True)
    assert np.all(np.abs(_core.zero_phase(x, ours) - reference) <= 1e-10 * scale)


@settings(max_examples=200, deadline=None)
@given(kinds, st.integers(1, 12), edges)
def test_every_design_has_scipys_coefficients(kind, order, edge):
    ours, scipy = designed(kind, order, edge)
    gain = scipy[0, 0]
    np.testing.assert_allclose(ours[0, :3] / gain, scipy[0, :3] / gain, rtol=0, atol=1e-11)
    np.testing.assert_allclose(ours[1:], scipy[1:], rtol=0, atol=1e-11)
    np.testing.assert_allclose(ours[0, 3:], scipy[0, 3:], rtol=0, atol=1e-11)


@settings(deadline=None)
@given(seeds, st.floats(-10, 10), st.floats(-10, 10))
def test_a_sum_is_filtered_as_the_sum_of_the_filtered(seed, p, q):
    x, y = channels(seed, 2, 400)
    both = p * _core.zero_phase(x, PAPER) + q * _core.zero_phase(y, PAPER)
    np.testing.assert_allclose(_core.zero_phase(p * x + q * y, PAPER), both, rtol=0, atol=1e-10)


@settings(deadline=None)
@given(seeds)
def test_time_reversed_and_filtered_is_filtered_and_time_reversed(seed):
    # The ends are not symmetric: which pass comes first matters there, and nowhere else.
    x = channels(seed, 1, 1000)[0]
    forward, backward = _core.zero_phase(x, PAPER), _core.zero_phase(x[::-1].copy(), PAPER)[::-1]
    np.testing.assert_allclose(forward[300:-300], backward[300:-300], rtol=0, atol=1e-10)


@settings(deadline=None)
@given(kinds, orders, edges, st.floats(1e-6, 1e6))
def test_a_constant_passes_unchanged(kind, order, edge, value):
    ours, _ = designed(kind, order, edge)
    np.testing.assert_allclose(_core.zero_phase(np.full(100, value), ours), value, rtol=1e-9)


def test_a_sine_at_the_edge_keeps_its_phase_and_a_hundredth_of_its_size():
    t = np.arange(5000) / RATE_HZ
    sine = np.sin(2 * np.pi * 500.0 * t)
    inner = slice(500, -500)
    filtered = _core.zero_phase(sine, PAPER)
    np.testing.assert_allclose(filtered[inner], 0.01 * sine[inner], rtol=0, atol=1e-12)


def test_the_input_is_left_alone():
    x = channels(1, 4, 100)
    before = x.copy()
    _core.zero_phase(x, PAPER)
    np.testing.assert_array_equal(x, before)


@pytest.mark.parametrize("edge_hz", [500.0, 750.0, 0.0, -1.0, float("nan"), float("inf")])
def test_a_bad_edge_is_refused_by_name_with_the_nyquist_frequency(edge_hz):
    with pytest.raises(ValueError, match=r"edge_hz: .* Hz must lie .* Nyquist frequency 500 Hz"):
        _core.cheby2_sos(3, 20.0, edge_hz, 1000.0)
    with pytest.raises(ValueError, match=r"cutoff_hz: .* Nyquist frequency 500 Hz"):
        _core.butter_sos(3, edge_hz, 1000.0)


@settings(deadline=None)
@given(kinds, orders, st.integers(1, 60))
def test_a_record_is_too_short_exactly_where_scipy_says_so(kind, order, samples):
    ours, scipy = designed(kind, order, 0.2)
    x = np.ones(samples)
    try:
        signal.sosfiltfilt(scipy, x)
    except ValueError:
        with pytest.raises(ValueError, match=r"samples are too few .* at least \d+"):
            _core.zero_phase(x, ours)
    else:
        assert _core.zero_phase(x, ours).shape == x.shape


def test_rows_that_are_not_sections_are_refused():
    with pytest.raises(ValueError, match="sos: rows of 5 values"):
        _core.zero_phase(np.ones(100), np.ones((2, 5)))
