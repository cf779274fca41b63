#!/usr/bin/env python3
"""Make the pictures of the documentation: python docs/make_pictures.py.

The story is that of a simulated knob. The fit is one to real measurements, which are not part of this
repository: KNOBCAM_SHARED_DATA names the folder that holds them; without it that picture stays as it is.
"""

from __future__ import annotations

import os
from pathlib import Path

import knobcam as kc
from knobcam import plot

PICTURES = Path(__file__).parent / "pictures"
EMPS = Path("emps", "DATA_EMPS.mat")


def main() -> None:
    """Make every picture."""
    story()
    stability()
    emps()


def story() -> None:
    """Draw how the spring is found that is hidden in the knob of docs/learn.md."""
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    capture = kc.simulate(knob, "sweep")
    target = PICTURES / "story.png"
    kc.learn(capture).plot().savefig(target, dpi=80)
    print(target)


def stability() -> None:
    """Draw what a delay allows on the handle of docs/render.md."""
    target = PICTURES / "stability.png"
    kc.check_stability("knob4", kc.Device(delay_samples=1)).plot().savefig(target, dpi=90)
    print(target)


def emps() -> None:
    """Draw friction over velocity of the EMPS axis (Janot, Gautier & Brunot 2019)."""
    folder = os.environ.get("KNOBCAM_SHARED_DATA")
    data = Path(folder or ".") / EMPS
    if not data.is_file():
        print(f"no {EMPS} in KNOBCAM_SHARED_DATA={folder}: no picture made")
        return
    capture = kc.load(data, map="t=t, theta=qm, tau=35.1507*vir", axis="linear")
    target = PICTURES / "emps-velocity.png"
    plot.velocity(kc.fit(capture, detents="no")).savefig(target, dpi=110)
    print(target)


if __name__ == "__main__":
    main()
