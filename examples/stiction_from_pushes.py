#!/usr/bin/env python3
"""Static friction from a knob that is pushed until it slips: python examples/stiction_from_pushes.py.

A sweep never rests, so it says nothing about sticking. Here a hand pushes the knob through a spring, slowly,
forth and back. Both captures are fitted jointly: the sweep determines the sliding knob, which is taken off
the torque of the pushes.
"""

from __future__ import annotations

import sys

import knobcam as kc


def main() -> None:
    """Simulate both, fit them jointly, read static friction, complete the model."""
    knob = kc.Model.load(sys.argv[1] if len(sys.argv) > 1 else "knob2")
    pushes = kc.simulate(knob, "push", duration_s=12.0)
    sweep = kc.simulate(knob, "sweep")

    stiction = kc.fit([sweep, pushes]).stiction()
    print(stiction)
    for side in ("D_neg", "D_pos"):
        print(f"emulated karnopp.{side}: {knob.params[f'karnopp.{side}'].value:.6g} N m")
    if stiction.determined:
        print(stiction.model)
    stiction.plot().savefig("stiction.png")


if __name__ == "__main__":
    main()
