"""Many captures: a batch over the cores of one machine or of many, limits, lots, a station that watches."""

from .batching import batch
from .result import BatchResult

__all__ = ["BatchResult", "batch"]
