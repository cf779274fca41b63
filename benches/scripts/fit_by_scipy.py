"""What one would write without knobcam: read a capture, fit Equation 1 from a good start, print as JSON."""

import json
import sys

import numpy as np
from scipy.optimize import curve_fit

NAMES = ["M", "coulomb.neg", "coulomb.pos", "viscous.neg", "viscous.pos", "A", "P", "S"]
START = [0.4, 1.5, 2.0, 1.0, 1.5, 1.0, 0.204, 0.9]


def torque(motion, m, c_neg, c_pos, b_neg, b_pos, a, p, s):
    theta, omega, alpha = motion
    friction = np.where(omega > 0.0, c_pos + b_pos * omega, b_neg * omega - c_neg)
    return m * alpha + friction + a * np.sin(theta / p + s)


_, theta, omega, alpha, tau = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1, unpack=True)
best, covariance = curve_fit(torque, (theta, omega, alpha), tau, START)
sd = np.sqrt(np.diag(covariance))
params = {
    name: {"value": value, "ci95": [value - 1.96 * e, value + 1.96 * e]}
    for name, value, e in zip(NAMES, best, sd, strict=True)
}
print(json.dumps({"params": params}))
