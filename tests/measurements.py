"""Measurements that somebody else made, no part of this repository: a test without them skips, saying so."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SHARED = Path(os.environ.get("KNOBCAM_SHARED_DATA", ROOT.parent / "shared" / "data"))
"""The folder that holds them."""


def real(path: Path) -> Path:
    """A file or folder of them."""
    if not path.exists():
        pytest.skip(f"{path} is absent; set KNOBCAM_SHARED_DATA to the folder of real measurements")
    return path
