"""The paper's Equation 1 fitted by the tools that one would otherwise reach for.

Each takes a capture and a start, an array in the order of NAMES. The motion is taken as it is, no filter.
"""

from typing import Any

import lmfit
import numpy as np
from knobs import PAPER_KNOB
from scipy.optimize import curve_fit, least_squares

import knobcam as kc

NAMES = list(PAPER_KNOB)
PERIOD = NAMES.index("detent.P")
Floats = np.ndarray[Any, np.dtype[np.float64]]


def equation_1(motion: tuple[Floats, Floats, Floats], *p: float) -> Floats:
    """Torque of the paper's Equation 1, N m; parameters in the order of NAMES."""
    theta, omega, alpha = motion
    m, c_neg, c_pos, b_neg, b_pos, a, period, shift = p
    friction = np.where(omega > 0.0, c_pos + b_pos * omega, b_neg * omega - c_neg)
    return m * alpha + friction + a * np.sin(theta / period + shift)


def linear_columns(motion: tuple[Floats, Floats, Floats]) -> Floats:
    """Columns of the five parameters that enter linearly, shape (5, samples)."""
    _, omega, alpha = motion
    forward = omega > 0.0
    zero = np.zeros_like(omega)
    return np.stack(
        [
            alpha,
            np.where(forward, zero, -1.0),
            np.where(forward, 1.0, zero),
            np.where(forward, zero, omega),
            np.where(forward, omega, zero),
        ]
    )


def jacobian(motion: tuple[Floats, Floats, Floats], *p: float) -> Floats:
    """Derivatives of `equation_1`, shape (samples, 8)."""
    a, period, shift = p[5:]
    phase = motion[0] / period + shift
    sin, cos = np.sin(phase), a * np.cos(phase)
    return np.column_stack([linear_columns(motion).T, sin, -cos * motion[0] / period**2, cos])


def good_start(capture: kc.Capture, period: float) -> Floats:
    """What a careful user would hand over: the linear part solved, the amplitude from what it leaves."""
    columns = linear_columns(motion_of(capture)).T
    linear, *_ = np.linalg.lstsq(columns, capture.tau, rcond=None)
    rest = capture.tau - columns @ linear
    return np.array([*linear, np.sqrt(2.0) * np.std(rest), period, 0.0])


def motion_of(capture: kc.Capture) -> tuple[Floats, Floats, Floats]:
    """Position, speed and acceleration of a capture that has all three."""
    assert capture.omega is not None and capture.alpha is not None
    return capture.theta, capture.omega, capture.alpha


def scipy_least_squares(capture: kc.Capture, start: Floats) -> Floats:
    """Parameters by `scipy.optimize.least_squares`."""
    motion = motion_of(capture)
    # Without `x_scale` it creeps: thousands of evaluations even from the true period.
    work = least_squares(lambda p: equation_1(motion, *p) - capture.tau, start, x_scale="jac", max_nfev=200)
    return work.x


def scipy_curve_fit(capture: kc.Capture, start: Floats) -> tuple[Floats, Floats]:
    """Parameters and standard errors by `scipy.optimize.curve_fit`."""
    p, covariance = curve_fit(equation_1, motion_of(capture), capture.tau, start)
    return p, np.sqrt(np.diag(covariance))


def lmfit_minimize(
    capture: kc.Capture, start: Floats, uncertainties: bool = True
) -> tuple[Floats, Floats | None]:
    """Parameters and standard errors by `lmfit.minimize`."""
    motion = motion_of(capture)
    names = [name.replace(".", "_") for name in NAMES]
    parameters = lmfit.create_params(**dict(zip(names, start.tolist(), strict=True)))

    def residual(p: lmfit.Parameters) -> Floats:
        return equation_1(motion, *p.valuesdict().values()) - capture.tau

    result = lmfit.minimize(residual, parameters, calc_covar=uncertainties)
    values = np.array([result.params[name].value for name in names])
    if not uncertainties:
        return values, None
    return values, np.array([result.params[name].stderr for name in names])


def numpy_variable_projection(capture: kc.Capture, start: Floats) -> tuple[Floats, Floats]:
    """Parameters and standard errors by variable projection (Golub & Pereyra 1973, Kaufman 1975) in NumPy.

    The products of the five linear columns are made once; a step costs a sine, a cosine and their products,
    all by BLAS. The detent is a sin(theta/P) + b cos(theta/P), so the period alone is searched, by
    Gauss-Newton.
    """
    motion, tau = motion_of(capture), capture.tau
    theta, n = motion[0], len(tau)
    rows = np.empty((9, n))  # linear columns, sine, cosine, derivative by the period, torque
    rows[:5], rows[8] = linear_columns(motion), tau
    gram = np.empty((9, 9))
    fixed = [0, 1, 2, 3, 4, 8]
    gram[np.ix_(fixed, fixed)] = rows[fixed] @ rows[fixed].T
    period = start[PERIOD]
    turning = np.empty(n)
    for _ in range(50):
        np.divide(theta, period, out=turning)
        np.sin(turning, out=rows[5])
        np.cos(turning, out=rows[6])
        products = rows[5:7] @ rows.T
        gram[5:7, :7], gram[5:7, 8] = products[:, :7], products[:, 8]
        gram[:7, 5:7], gram[8, 5:7] = gram[5:7, :7].T, gram[5:7, 8]
        linear = np.linalg.solve(gram[:7, :7], gram[:7, 8])
        a, b = linear[5:]
        np.multiply(theta, -a / period**2, out=rows[7])
        rows[7] *= rows[6]
        np.multiply(theta, b / period**2, out=turning)
        turning *= rows[5]
        rows[7] += turning
        gram[7] = rows @ rows[7]
        gram[:, 7] = gram[7]
        step = np.linalg.solve(gram[:8, :8], gram[:8, 8] - gram[:8, :7] @ linear)[7]
        period += step
        if abs(step) < 1e-9 * period:
            break
    amplitude, shift = np.hypot(a, b), np.arctan2(b, a)
    rest = gram[8, 8] - linear @ gram[:7, 8]
    covariance = np.linalg.inv(gram[:8, :8]) * (rest / (n - 8))
    # From (a, b) to amplitude and phase.
    turn = np.eye(8)
    turn[5:7, 5:7] = [[a / amplitude, b / amplitude], [-b / amplitude**2, a / amplitude**2]]
    sd = np.sqrt(np.diag(turn @ covariance @ turn.T))
    p = np.array([*linear[:5], amplitude, period, shift])
    return p, sd[[0, 1, 2, 3, 4, 5, 7, 6]]
