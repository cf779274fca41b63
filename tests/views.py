"""Views of the page held against kept pictures, coarsely: another font passes, a broken layout does not."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from answers import KEEP
from PIL import Image, ImageFilter

KEPT = Path(__file__).parent / "kept" / "views"
CELL = 10  # pixels of a view that are one of its kept picture
NEAR = 2  # cells by which text may have moved
OTHER = 26.0  # of 255: what differs more in any colour is something else
SHARE = 0.0075  # of the cells that may: a word more or less, a bar further on

Cells = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def coarse(view: Path) -> Image.Image:
    """A view as it is kept: what is printed on it is a shade of grey."""
    with Image.open(view) as picture:
        blurred = picture.convert("RGB").filter(ImageFilter.BoxBlur(CELL))
        return blurred.resize((picture.width // CELL, picture.height // CELL), Image.Resampling.BOX)


def share_that_differs(view: Path, kept: Path) -> float:
    """The share of a view's cells that are like none near them in a kept picture, nor the other way round."""
    seen = np.asarray(coarse(view), dtype=float)
    with Image.open(kept) as picture:
        known = np.asarray(picture.convert("RGB"), dtype=float)
    if seen.shape != known.shape:
        return 1.0
    return max(_unlike(seen, known), _unlike(known, seen))


def _unlike(one: Cells, other: Cells) -> float:
    """The share of cells of one picture that no cell of another, near the same place, is like."""
    rows, columns, _ = one.shape
    wide = np.pad(other, ((NEAR, NEAR), (NEAR, NEAR), (0, 0)), mode="edge")
    least = np.full((rows, columns), np.inf)
    for down in range(2 * NEAR + 1):
        for right in range(2 * NEAR + 1):
            there = wide[down : down + rows, right : right + columns]
            np.minimum(least, np.abs(one - there).max(axis=2), out=least)
    return float(np.mean(least > OTHER))


def as_kept(folder: Path, *names: str) -> None:
    """Hold views in a folder against those that are kept; the environment variable KEEP makes them anew."""
    KEPT.mkdir(parents=True, exist_ok=True)
    for name in names:
        kept = KEPT / f"{name}.png"
        if KEEP in os.environ:
            coarse(folder / f"{name}.png").save(kept, optimize=True)
        differs = share_that_differs(folder / f"{name}.png", kept)
        again = f"look at both, and if it is meant so: {KEEP}=1 python -m pytest tests/test_browser.py"
        assert differs <= SHARE, f"{name}: {100 * differs:.1f} % of it looks other than {kept}; {again}"
