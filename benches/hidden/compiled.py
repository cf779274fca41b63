"""Functions that Numba compiles: once for all processes, anew when any source of the simulator changes."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numba

HERE = Path(__file__).parent

# Numba itself looks for changes in a function's own file alone, and not in those of whom it calls.
_sources = b"".join(path.read_bytes() for path in sorted(HERE.glob("*.py")))
numba.config.CACHE_DIR = str(HERE / "__pycache__" / f"numba-{hashlib.sha256(_sources).hexdigest()[:16]}")

njit = numba.njit(cache=True)
