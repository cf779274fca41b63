"""Learning: effects added until the rest is chance or unexplained, and what the captures cannot tell."""

from .learning import Story, learn

__all__ = ["Story", "learn"]
