"""Writes filter.toml beside this script: designs and zero-phase outputs of SciPy.

Run with `python make_filter_golden.py`; needs NumPy and SciPy.
"""

from pathlib import Path

import numpy as np
from scipy import signal

RATE_HZ = 5000.0
DESIGNS = [
    (kind, order, edge_hz)
    for kind in ("cheby2", "butter")
    for order, edge_hz in [(1, 40.0), (2, 5.0), (3, 500.0), (4, 1250.0), (5, 2250.0), (8, 150.0), (12, 700.0)]
]


def numbers(values: np.ndarray) -> str:
    """Write a TOML array that reads back exactly."""
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


def main() -> None:
    """Write every design with its steady state and its output for one input."""
    lines = [f"# By make_filter_golden.py with the functions of scipy.signal; rate {RATE_HZ} Hz."]
    n = np.arange(90)
    # A drift with an offset, a sine and a step: the ends and the middle all matter.
    x = 3.0 + 0.02 * n + np.sin(0.3 * n) + (n > 40)
    lines.append(f"input = {numbers(x)}")
    for kind, order, edge_hz in DESIGNS:
        if kind == "cheby2":
            sos = signal.cheby2(order, 20.0, edge_hz, fs=RATE_HZ, output="sos")
        else:
            sos = signal.butter(order, edge_hz, fs=RATE_HZ, output="sos")
        lines += ["", "[[design]]", f'kind = "{kind}"', f"order = {order}", f"edge_hz = {edge_hz}"]
        lines.append(f"sos = [{', '.join(numbers(row) for row in sos)}]")
        lines.append(f"zi = [{', '.join(numbers(row) for row in signal.sosfilt_zi(sos))}]")
        lines.append(f"output = {numbers(signal.sosfiltfilt(sos, x))}")
    Path(__file__).with_name("filter.toml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
