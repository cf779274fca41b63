#!/usr/bin/env python3
"""Fit a capture and print what it says: python examples/fit_a_capture.py [CAPTURE].

Without a file, a knob of the haptic-camera paper is simulated on its rig.
"""

from __future__ import annotations

import math
import sys

import knobcam as kc


def main() -> None:
    """Load or simulate, look at the findings, fit, save the model."""
    capture = kc.load(sys.argv[1]) if len(sys.argv) > 1 else kc.simulate(kc.Model.load("knob4"))
    print(capture)

    fit = kc.fit(capture)
    print(fit)

    period = fit.params.get("detent.P")
    if period is None:
        print("no detents")
    else:
        print(f"detents every {2.0 * math.pi * period.value:.4g} {period.unit}")
    print("written:", fit.model.renamed("fitted").save("fitted.toml"))


if __name__ == "__main__":
    main()
