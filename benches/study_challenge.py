"""Whether every challenge of the workbench can be solved: `knobcam.learn` ends with what is hidden, alone.

    python benches/study_challenge.py [LEVEL...]

Prints a line each: the level, the knob, what is hidden, what was found, by how much the error fell, seconds
of the processor. Exit code 1 where one is not found, or not told from another effect.
"""

from __future__ import annotations

import sys
import time

import knobcam as kc
from knobcam.workbench.challenge import SECONDS, levels
from knobcam.workbench.sources import Simulated


def solved(knob: str, hidden: tuple[str, ...], seed: int) -> tuple[bool, kc.LearningResult]:
    """Whether what a knob hides is found alone and told from all else, and how."""
    story = kc.learn(Simulated(knob, hidden, "sweep", SECONDS, seed).capture())
    told = not any(step.equivalent for step in story.ladder)
    return told and story.verdict == "missing" and sorted(story.found) == sorted(hidden), story


def main() -> None:
    """Try those of the levels that are asked for."""
    unsolved = 0
    for level in sys.argv[1:] or levels():
        for knob, hidden, seed in levels()[level]:
            start = time.process_time()
            well, story = solved(knob, hidden, seed)
            unsolved += not well
            fall = 1.0 - story.fit.rmse / story.ladder[0].fit.rmse
            found = " and ".join(story.found) or "nothing"
            words = f"{level} {knob} hides {' and '.join(hidden)}: found {found}, error -{fall:.0%}"
            print(f"{'solved  ' if well else 'UNSOLVED'} {words}, {time.process_time() - start:.1f} s")
    sys.exit(unsolved > 0)


if __name__ == "__main__":
    main()
