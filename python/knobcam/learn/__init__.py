"""Learning: effects added until the rest is chance or unexplained, and what the captures cannot tell."""

from .cut import Interrupted
from .learning import LearningResult, learn

__all__ = ["Interrupted", "LearningResult", "learn"]
