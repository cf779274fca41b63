"""How fast the workbench's page is in a browser: `python benches/study_page.py [SAMPLES...]`.

A headless Chromium with software rendering goes through the story of `web/browser/story.js`. "painted" is
from the deed to the beginning of the frame after the one that drew it, "script" how long the main thread was
busy with drawing; of a brush, the slowest of its moves.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from test_browser import capture_with_stribeck, script, workbench

UNWEIGHED = ("return_spring", "quadratic_drag", "stribeck", "friction_drift", "presliding")
"""Two linear effects and three others, added while what is missing is being weighed."""


def main() -> None:
    for samples in [int(word) for word in sys.argv[1:]] or [25_000, 250_000]:
        with tempfile.TemporaryDirectory() as folder:
            capture = capture_with_stribeck(Path(folder), samples)
            with workbench(capture) as address:
                seen = script("story.js", address, "stribeck", folder)
            with workbench(capture) as address:
                unweighed = script("adding.js", address, *UNWEIGHED)
        print(f"{samples} samples; the other branch has {seen['other']}")
        for what, times in seen["figures"].items():
            print(f"  {what:<8} painted {times['painted']:6.0f} ms, script {times['script']:5.0f} ms")
        for effect, times in unweighed["figures"].items():
            print(f"  add {effect}, not weighed yet: painted {times['painted']:6.0f} ms")


if __name__ == "__main__":
    main()
