"""What the numbers of a row depend on beside the capture itself: by its digest a row is known to be done."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .._core import __version__
from ..capture.prepare import check_options
from ..model import Model


@dataclass(frozen=True)
class Settings:
    """How captures are read, prepared and fitted; `model` is the text of a model file, None for the base.

    With `hints` a row says how much its capture speaks for each effect that the model lacks.
    """

    model: str | None = None
    reading: Mapping[str, Any] = field(default_factory=dict)
    prepare: str = "smooth"
    options: Mapping[str, float] = field(default_factory=dict)
    hints: bool = True
    version: str = __version__

    def __post_init__(self) -> None:
        check_options(self.prepare, self.options)

    @property
    def digest(self) -> str:
        """What tells these settings from any others."""
        known = {
            "model": self.model,
            "reading": {name: value for name, value in self.reading.items() if value is not None},
            "prepare": self.prepare,
            "options": dict(self.options),
            "hints": self.hints,
            "version": self.version,
        }
        return hashlib.sha256(json.dumps(known, sort_keys=True, default=str).encode()).hexdigest()

    def how(self) -> dict[str, Any]:
        """Return how a capture is prepared, as `fit` and `learn` take it."""
        return {"prepare": self.prepare, **self.options}

    def parsed(self) -> Model | None:
        """Return the model to be fitted; None for the base model."""
        return None if self.model is None else Model.parse(self.model)
