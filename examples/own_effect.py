#!/usr/bin/env python3
"""Teach knobcam an effect that its catalogue lacks: python examples/own_effect.py.

A magnet beside the knob's rim brakes it, in proportion to the speed, where its steel tooth passes. The base
model leaves an error over position; the effects of the catalogue that act over position do not explain it;
with the brake in the model, what is left is noise.
"""

from __future__ import annotations

import numpy as np

import knobcam as kc


@kc.own_effect(
    "sector_brake",
    law="b omega exp(-((theta - c)/w)^2)",
    source="viscous damping, within a sector",
    shows="at one position, more the faster",
    starts=[{"c": c} for c in np.linspace(-3.0, 3.0, 13)],
    b=kc.OwnParameter("N m s/rad", linear=True, meaning="damping at the centre"),
    c=kc.OwnParameter("rad", meaning="centre"),
    w=kc.OwnParameter("rad", 0.05, 3.0, 0.3, meaning="width"),
)
def sector_brake(motion: kc.OwnMotion, b: float, c: float, w: float) -> np.ndarray:
    """The torque of the brake, N m."""
    return b * motion.omega * np.exp(-(((motion.theta - c) / w) ** 2))


def main() -> None:
    """Simulate a knob with the brake, fit it without, with another effect, and with the brake."""
    knob = kc.Model.load("knob4").with_effect("sector_brake")
    knob = knob.with_value("sector_brake.b", 0.002).with_value("sector_brake.c", 0.7)
    capture = kc.simulate(knob)

    base = kc.fit(capture)
    worst = base.compare().worst
    assert worst is not None
    print(f"the base model fails along {worst.axis}, at {worst.where()}")

    # The middle of where it fails is a start that is close enough.
    region = worst.regions[0]
    other = base.model.with_effect("position_friction")
    braked = base.model.with_effect("sector_brake")
    braked = braked.with_value("sector_brake.c", 0.5 * (region.start + region.end))
    for name, model in (("base", base.model), ("position_friction", other), ("sector_brake", braked)):
        fit = kc.fit(capture, model)
        print(f"{name:18} RMS error {1e3 * fit.rmse:.2f} mN m, noise floor {1e3 * fit.noise_floor:.2f} mN m")
    print(fit)
    print("complete" if fit.compare().complete else "something is still missing")


if __name__ == "__main__":
    main()
