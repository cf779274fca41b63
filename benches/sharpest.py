"""How well a parameter could be known at most: a bound that no motion within limits goes below.

A recording tells of a model's parameters what the states tell that it passes through (the derivatives of the
torque there), each as often as it is there. Of all shares of states, whatever motion would have them, that
which leaves the least error of one parameter is a convex problem (c-optimal design: Elfving 1952), solved by
conditional gradients (Frank & Wolfe 1956), whose gap gives a bound that holds even where they have not
ended. That a motion has to come back from where it goes is kept as far as mean rates of change tell it: over
a recording, that of any function of angle and speed is at most the function's range over the time it takes.
"""

import numpy as np
from scipy.optimize import linprog

import knobcam as kc
from knobcam.learn.telling import Rival, Telling
from knobcam.model.simulate import exact

STATES = 3000
STEPS = 60
TIGHT = 0.01
"""Of the variance, the gap at which a bound is near enough."""


def sharpest(fit: kc.Fit, param: str, limits: kc.Limits) -> float:
    """The least standard error that a fit's captures and any one recording within limits could leave."""
    states = states_of(limits)
    free = list(fit.core.free)
    slopes = derivatives(fit, free, states)
    white = Telling((Rival((), fit),)).white
    count = limits.duration_s * limits.sample_rate_hz
    # In units of the errors so far.
    scale = np.array([fit.params[name].se for name in free])
    told = slopes * scale * np.sqrt(count / white)
    before = np.linalg.inv(np.asarray(fit.core.correlation))
    at = free.index(param)
    rates, most = rates_of(states, limits)
    keep = {"A_ub": np.vstack([rates, -rates]), "b_ub": np.concatenate([most, most])}
    one = {"A_eq": np.ones((1, len(told))), "b_eq": [1.0]}

    def corner(gain: np.ndarray) -> np.ndarray:
        return np.asarray(linprog(-gain, **keep, **one, bounds=(0.0, None), method="highs").x)

    share = corner(told[:, at] ** 2)
    bound = 0.0
    for _ in range(STEPS):
        row = np.linalg.inv(before + (told * share[:, None]).T @ told)[at]
        variance, gain = row[at], (told @ row) ** 2
        best = corner(gain)
        gap = float(gain @ (best - share))
        bound = max(bound, variance - gap)
        if gap < TIGHT * variance:
            break
        share = along(before, told, at, share, best)
    return float(np.sqrt(max(bound, 0.0)) * scale[at])


def along(before: np.ndarray, told: np.ndarray, at: int, here: np.ndarray, there: np.ndarray) -> np.ndarray:
    """The shares between two at which the variance is least."""
    both = [(told * one[:, None]).T @ told for one in (here, there)]
    steps = np.linspace(0.0, 1.0, 101)[1:]
    left = [np.linalg.inv(before + (1.0 - by) * both[0] + by * both[1])[at, at] for by in steps]
    by = float(steps[int(np.argmin(left))])
    return (1.0 - by) * here + by * there


def states_of(limits: kc.Limits) -> kc.MotionTrack:
    """States within limits, at their corners too: no motion, each stands for itself."""
    rng = np.random.default_rng(0)
    ends = rng.choice((-1.0, 0.0, 1.0), (3, STATES // 2))
    far = np.hstack([ends, rng.uniform(-1.0, 1.0, (3, STATES - STATES // 2))])
    far[0, : STATES // 2] = rng.uniform(-1.0, 1.0, STATES // 2)  # detents have no corner
    slow = np.where(rng.random(STATES) < 0.3, 1e-3, 1.0)
    return kc.MotionTrack(
        np.arange(STATES) / limits.sample_rate_hz,
        limits.middle + limits.half * far[0],
        limits.omega_rad_s * (far[1] * slow + 1e-4 * rng.choice((-1.0, 1.0), STATES)),
        limits.alpha_rad_s2 * far[2],
    )


def derivatives(fit: kc.Fit, free: list[str], states: kc.MotionTrack) -> np.ndarray:
    """The derivatives of the torque by the parameters, shape (states, parameters)."""
    signals = exact(fit.model.coordinate, states)
    columns = []
    for name in free:
        value, step = fit.model.params[name].value, 0.01 * fit.params[name].se
        less, more = (
            fit.model.with_value(name, value + by).core.torque(signals, filtered=False)
            for by in (-step, step)
        )
        columns.append((more - less) / (2.0 * step))
    return np.stack(columns, axis=1)


def rates_of(states: kc.MotionTrack, limits: kc.Limits) -> tuple[np.ndarray, np.ndarray]:
    """How fast functions of the state change in each, and the most that the mean of it can be."""
    theta = (states.theta - limits.middle) / limits.half
    omega = states.omega / limits.omega_rad_s
    swift, hard = limits.omega_rad_s / limits.half, limits.alpha_rad_s2 / limits.omega_rad_s
    onward, faster = swift * omega, hard * states.alpha / limits.alpha_rad_s2
    forth, back = np.maximum(omega, 0.0), np.minimum(omega, 0.0)
    rows = [theta**k * onward for k in range(6)]  # of theta^(k + 1) / (k + 1)
    rows += [one**k * (one != 0.0) * faster for one in (forth, back) for k in range(3)]
    rows += [onward * forth + theta * (forth > 0.0) * faster, onward * back + theta * (back < 0.0) * faster]
    rows += [theta * onward * omega + 0.5 * theta**2 * faster]
    return np.stack(rows), np.full(len(rows), 2.0 / limits.duration_s)
