#!/usr/bin/env python3
"""See where a model fails, and what becomes of it: python examples/compare_and_plot.py [FOLDER].

The knob has a spring that the base model does not know. The error lies over position and is beyond chance;
with the spring in the model, what is left is noise.
"""

from __future__ import annotations

import sys
from pathlib import Path

import knobcam as kc


def main() -> None:
    """Fit without the spring and with it, compare both, draw both."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "pictures")
    folder.mkdir(exist_ok=True)
    knob = kc.Model.load("knob2").with_effect("return_spring").with_value("return_spring.k", 0.004)
    capture = kc.simulate(knob, "turns")

    base = kc.fit(capture)
    better = kc.fit(capture, base.model.with_effect("return_spring"))
    for name, fit in (("base", base), ("with-spring", better)):
        comparison = fit.compare()
        print(f"{name}: {comparison}\n")
        comparison.plot().savefig(folder / f"{name}-compared.png")
        fit.plot().savefig(folder / f"{name}-fit.png")
    print(f"pictures in {folder.absolute()}")


if __name__ == "__main__":
    main()
