"""What is computed does not depend on the processor: every instruction set gives the same numbers."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from knobcam import _core

SETS = ("sse2", "avx2", "avx512")

WORK = """
import json
import knobcam as kc
from knobcam import _core

knob = kc.Model.load("knob3").with_effect("stribeck")
knob = knob.with_value("stribeck.rise", 0.4).with_value("stribeck.vs", 0.3)
capture = kc.simulate(knob, "sweep", noise="paper", seed=7)
numbers = {}
for prepare in ("none", "smooth"):
    fit = kc.fit(capture, prepare=prepare)
    numbers |= {f"{prepare} {name}": [e.value, e.se] for name, e in fit.params.items()}
    numbers[f"{prepare} errors"] = [fit.rmse, fit.rmse_heldout, fit.noise_floor]
    numbers[f"{prepare} scan"] = fit.core.scan[1].tolist()
rendered = kc.Renderer(knob, 5000.0).along(capture.theta, capture.omega, capture.alpha)
numbers["rendered"] = rendered.tolist()
print(json.dumps([_core.instruction_set(), numbers]))
"""


def run(instruction_set: str, work: str = WORK) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "KNOBCAM_ISA": instruction_set}
    return subprocess.run([sys.executable, "-c", work], capture_output=True, text=True, env=environment)


@pytest.mark.skipif(_core.instruction_set() == "sse2", reason="this machine has one instruction set")
def test_every_instruction_set_gives_the_same_numbers() -> None:
    wanted = SETS[: SETS.index(_core.instruction_set()) + 1]
    answers = {name: json.loads(run(name).stdout) for name in wanted}
    assert [used for used, _ in answers.values()] == list(wanted)
    _, best = answers[wanted[-1]]
    for _, numbers in answers.values():
        for name, values in best.items():
            scale = float(np.abs(values).max())
            # Peaks of the scan are differences of large sums; a descent ends where they no longer matter.
            np.testing.assert_allclose(numbers[name], values, rtol=1e-7, atol=1e-9 * scale, err_msg=name)


def test_an_instruction_set_that_is_none_is_said_to_be_none() -> None:
    ended = run("mmx", "import knobcam._core")
    assert ended.returncode != 0
    assert "KNOBCAM_ISA=mmx" in ended.stderr
    assert "choose sse2, avx2, avx512" in ended.stderr
