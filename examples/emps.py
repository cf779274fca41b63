#!/usr/bin/env python3
"""Fit a real linear axis: python examples/emps.py [DATA_EMPS.mat].

EMPS is the electro-mechanical positioning system of Janot, Gautier & Brunot (2019): a ball screw, 1 kHz,
position and motor voltage. Without an argument the file is looked for in KNOBCAM_SHARED_DATA/emps.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import knobcam as kc

PUBLISHED = {"inertia.M": 95.1089, "coulomb.pos": 20.3935, "viscous.pos": 203.5034, "offset.tau0": -3.1648}


def main() -> None:
    """Fit as its authors did, beside what they published, then with the smoother and per direction."""
    given = sys.argv[1] if len(sys.argv) > 1 else None
    path = Path(given or os.environ.get("KNOBCAM_SHARED_DATA", ".")) / ("" if given else "emps/DATA_EMPS.mat")
    if not path.is_file():
        print(f"{path} is absent: name DATA_EMPS.mat, or set KNOBCAM_SHARED_DATA")
        return
    capture = kc.load(path, map="t=t, theta=qm, tau=35.1507*vir", coordinate="linear")

    model = kc.Model.of(["inertia", "coulomb", "viscous", "offset"], "linear")
    model = model.with_tie("coulomb.neg", "coulomb.pos").with_tie("viscous.neg", "viscous.pos")
    published = kc.fit(capture, model, prepare="differences", cutoff_hz=100.0, decimate=10.0)
    for name, value in PUBLISHED.items():
        ours = published.params[name]
        print(f"{name:<12} {ours.value:10.4f} {ours.unit}, published {value:.4f}")

    fit = kc.fit(capture, detents="no")
    print(fit)
    print(fit.compare())


if __name__ == "__main__":
    main()
