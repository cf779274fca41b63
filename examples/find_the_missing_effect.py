#!/usr/bin/env python3
"""A knob with a Stribeck effect that the base model lacks: found in one call, and by hand.

python examples/find_the_missing_effect.py
"""

from __future__ import annotations

import knobcam as kc


def main() -> None:
    """Learn what is missing from two captures of one knob, then look at the evidence."""
    knob = kc.Model.load("knob1").with_effect("stribeck")
    knob = knob.with_value("stribeck.rise", 1.5).with_value("stribeck.vs", 0.4)
    captures = [
        kc.simulate(knob, "sweep", rate_hz=2000.0, seed=1),
        kc.simulate(knob, "multisine", rate_hz=2000.0, seed=2),
    ]

    story = kc.learn(captures, progress=print)
    print(story)
    print("verdict:", story.verdict, "found:", ", ".join(story.found))
    print("report in", story.report("knob.html"))

    by_hand = kc.fit(captures).add("stribeck")
    for name, move in by_hand.moved.items():
        print(f"{name} moved by {move.by_se:+.3g} standard errors")
    print("stribeck.vs =", by_hand.params["stribeck.vs"].interval)


if __name__ == "__main__":
    main()
