"""How fast the workbench's page is in a browser: `python benches/study_page.py`.

A headless Chromium with software rendering goes through the story of `web/browser/story.js` once, does what
is done most five times (`often.js`; the middle counts), and adds effects while they are still being weighed,
which takes long enough on the longer capture alone. "painted" is from the deed to the beginning of the frame
after the one that drew it, "busy" how long the main thread drew; of a brush, the slowest of its moves. What
the machine did a fixed loop in is told beside it: figures of one day are not those of another.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
RESULT = ROOT / "benches" / "results" / "page.json"
SAMPLES = (25_000, 250_000)
LARGE = 2_000_000
LINEAR = "return_spring"
LARGE_WANTED = {"first": 2500, "brush": 60, "undo": 300, "redo": 300, "drag": 500, LINEAR: 3000}
UNWEIGHED = {"return_spring": 400, "quadratic_drag": 400, "stribeck": 1000, "friction_drift": 1000}
"""Effects that are added before they are weighed, two of them linear, and the milliseconds aimed at."""
DEEDS = {
    "first": ("first picture after opening the page", 600),
    "brush": ("brush moved, the others painted", 30),
    "look": ("hover a candidate, overlay painted", None),
    "add": ("add stribeck, weighed before", 1000),
    "undo": ("undo", 100),
    "redo": ("redo", 100),
    "beside": ("two branches side by side", None),
    "wheel": ("zoom by the wheel", None),
    "drag": ("drag a parameter", 100),
    "report": ("brush in the report's file", 250),
}


def measured(samples: int) -> dict[str, dict[str, float]]:
    """Milliseconds of each deed on a capture of so many samples; on the largest, of what is done most."""
    sys.path.insert(0, str(ROOT / "tests"))  # the browser is driven as the tests do it
    from test_browser import capture_with_stribeck, script, workbench

    with tempfile.TemporaryDirectory() as folder:
        capture = capture_with_stribeck(Path(folder), samples)

        def figures(name: str, *words: str) -> dict[str, dict[str, float]]:
            with workbench(capture) as address:
                told: dict[str, dict[str, float]] = script(name, address, *words)["figures"]
            return told

        story = figures("story.js", "stribeck", folder) if samples in SAMPLES else {}
        late = figures("adding.js", *UNWEIGHED) if samples == max(SAMPLES) else {}
        return story | figures("often.js", LINEAR) | late


def yardstick_ms() -> float:
    """Milliseconds that this machine takes for a fixed loop."""
    start = time.perf_counter()
    sum(i * i for i in range(5_000_000))
    return 1e3 * (time.perf_counter() - start)


def report(result: dict[str, Any]) -> Iterator[str]:
    """What came out, in lines."""
    few, many, large = (result[str(samples)] for samples in (*SAMPLES, LARGE))
    head = "ms until painted (busy; a frame has 16.7)"
    yield f"{head:<42} | wanted |   25 000 samples |  250 000 samples | wanted | 2 000 000 samples"
    wanted = DEEDS | {one: (f"add {one}, not weighed yet", most) for one, most in UNWEIGHED.items()}
    for deed, (words, most) in wanted.items():
        cells = [
            f"{t['painted']:.0f} ({t['script']:.0f})" if (t := one.get(deed)) else ""
            for one in (few, many, large)
        ]
        own = LARGE_WANTED.get(deed, "")
        yield f"{words:<42} | {most or '':>6} | {cells[0]:>16} | {cells[1]:>16} | {own:>6} | {cells[2]:>17}"
    yield f"load of the machine when it was measured: {result['load']:.1f}"
    loop = ", ".join(f"{one:.0f}" for one in result["loop"])
    yield f"ms that it took for a fixed loop, before and after: {loop}"


def main() -> None:
    result: dict[str, Any] = {"load": os.getloadavg()[0]}
    before = yardstick_ms()
    result |= {str(samples): measured(samples) for samples in (*SAMPLES, LARGE)}
    result["loop"] = [before, yardstick_ms()]
    lines = list(report(result))
    RESULT.write_text(json.dumps({"report": lines, **result}) + "\n")
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
