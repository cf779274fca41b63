"""What one would write without knobcam: read a capture, fit Equation 1 from a good start, print as JSON."""

import json
import sys

import lmfit
import numpy as np

NAMES = ["M", "coulomb.neg", "coulomb.pos", "viscous.neg", "viscous.pos", "A", "P", "S"]


def torque(motion, m=0.4, c_neg=1.5, c_pos=2.0, b_neg=1.0, b_pos=1.5, a=1.0, p=0.204, s=0.9):
    theta, omega, alpha = motion
    friction = np.where(omega > 0.0, c_pos + b_pos * omega, b_neg * omega - c_neg)
    return m * alpha + friction + a * np.sin(theta / p + s)


_, theta, omega, alpha, tau = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1, unpack=True)
result = lmfit.Model(torque, independent_vars=["motion"]).fit(tau, motion=(theta, omega, alpha))
params = {
    name: {"value": q.value, "ci95": [q.value - 1.96 * q.stderr, q.value + 1.96 * q.stderr]}
    for name, q in zip(NAMES, result.params.values(), strict=True)
}
print(json.dumps({"params": params}))
