#!/usr/bin/env python3
"""Make the pictures of the documentation: python docs/make_pictures.py [FOLDER], by default docs/pictures.

    python docs/make_pictures.py --page      those of the workbench alone; needs `python3 dev.py browser`

Those of simulated knobs are made anywhere. The others are of real measurements, which are not part of this
repository: KNOBCAM_SHARED_DATA names the folder that holds them; without it these pictures stay as they are.
"""

from __future__ import annotations

import contextlib
import dataclasses
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

import knobcam as kc
from knobcam import plot
from knobcam.model.typical import with_typical

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOCS = Path(__file__).resolve().parent
EMPS = Path("emps", "DATA_EMPS.mat")
MOTOR = Path("odrive_cogging", "slow2_slower_nocomp_0.npy")
COGGING = Path("odrive_cogging", "map_a_16.npy")


def main() -> None:
    """Make every picture but those of the page."""
    if "--page" in sys.argv:
        page(DOCS / "pictures")
        return
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS / "pictures"
    keep(folder / "story.png", plot.learned(kc.learn(hidden_spring())), 80)
    keep(
        folder / "stability.png", plot.stability(kc.check_stability("knob4", kc.Device(delay_samples=1))), 90
    )
    keep(folder / "proposals.png", kc.learn(braked(), without=["backlash", "compliance"]).propose().plot())
    five_knobs(folder)
    shared = Path(os.environ.get("KNOBCAM_SHARED_DATA", "."))
    absent = [str(name) for name in (EMPS, MOTOR, COGGING) if not (shared / name).is_file()]
    if absent:
        print(f"no {', '.join(absent)} in KNOBCAM_SHARED_DATA={shared}: no picture made of them")
        return
    axis(folder, shared / EMPS)
    motor(folder, shared / MOTOR, shared / COGGING)


def page(folder: Path) -> None:
    """Take pictures of the workbench in Chromium: a region and what would explain it, and a law."""
    chrome = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    knob = with_typical(kc.Model.load("knob3"), kc.effects()["stribeck"])
    with contextlib.ExitStack() as stack:
        place = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        addresses = []
        for capture, name in ((kc.simulate(knob, "sweep", seed=3), "knob.npz"), (braked(), "braked.npz")):
            command = [sys.executable, "-m", "knobcam", "workbench", "--no-browser"]
            command.append(str(capture.save(place / name)))
            server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
            stack.callback(server.wait)
            stack.callback(server.terminate)
            assert server.stdout is not None
            addresses.append(server.stdout.readline().strip())
        script = DOCS.parent / "web" / "browser" / "pictures.js"
        subprocess.run(["node", script, chrome, place, *addresses], check=True)
        for one in ("workbench.png", "workbench-law.png"):
            few = Image.open(place / one).convert("RGB").quantize(256, kmeans=2)
            few.save(folder / one, optimize=True)
            print(folder / one)


def keep(target: Path, figure: Figure, dpi: int = 80) -> None:
    """Save a picture and say so."""
    figure.savefig(target, dpi=dpi)
    print(target)


def hidden_spring() -> kc.Capture:
    """Return the capture of the knob of docs/learn.md."""
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    return kc.simulate(knob, "sweep")


def braked() -> kc.Capture:
    """Return the capture of the knob of docs/propose.md."""
    plain = kc.simulate("knob4", "sweep", duration_s=4.0, rate_hz=2000.0, seed=3)
    x = kc.motion("sweep", 4.0, 2000.0).omega / 1.3
    return dataclasses.replace(plain, tau=plain.tau + 0.016 * x / (1.0 + x**2))


def five_knobs(folder: Path) -> None:
    """Draw what docs/paper.md draws of its knobs."""
    fits = {
        name: kc.fit(kc.simulate(name, "sweep", noise="rig", duration_s=5.0, seed=1)) for name in kc.KNOBS
    }
    for name in ("knob1", "knob2"):
        keep(folder / f"paper-{name}-velocity.png", plot.velocity(fits[name]))
    for name in ("knob3", "knob4", "knob5"):
        keep(folder / f"paper-{name}-position.png", plot.position(fits[name]))
    pushes = kc.simulate("knob3", "push", duration_s=12.0)
    sticking = kc.fit([kc.simulate("knob3", "sweep", duration_s=5.0), pushes])
    keep(folder / "paper-knob3-stiction.png", sticking.stiction().plot())


def axis(folder: Path, data: Path) -> None:
    """Draw friction of the EMPS axis (Janot, Gautier & Brunot 2019), and where its model fails."""
    capture = kc.load(data, map="t=t, theta=qm, tau=35.1507*vir", coordinate="linear")
    keep(folder / "emps-velocity.png", plot.velocity(kc.fit(capture, detents="no")), 110)
    fit = kc.fit(capture)
    keep(folder / "emps-compared.png", plot.comparison(fit.compare()))
    keep(folder / "emps-forward.png", plot.forward(fit.forward()))


def motor(folder: Path, data: Path, cogging: Path) -> None:
    """Draw the three fits of the motor in docs/real-captures.md, as the page makes them."""
    capture = kc.load(data, map="t=c0, theta=c1/8192 [turn], tau=c2 [A]", start=1.0)
    keep(folder / "motor-first.png", plot.position(kc.fit(capture)))
    page = (DOCS / "real-captures.md").read_text("utf-8")
    names: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place):
        capture.save("motor.npz")
        Path(cogging.name).symlink_to(cogging.absolute())
        with contextlib.redirect_stdout(io.StringIO()):
            exec("\n".join(re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)), names)
    keep(folder / "motor-map.png", plot.position(names["better"]))
    keep(folder / "motor-story.png", plot.learned(names["story"]))


if __name__ == "__main__":
    main()
