"""What is left open: what captures do not tell, and what no effect explains, over one variable and over two.

A part of the schema in `pages.py`, by the same rules.
"""

from typing import TypedDict

from .pages_said import Part


class Limitation(TypedDict):
    """What captures cannot tell; `sharpen` is the parameter, if one, that a motion of its own tells."""

    said: list[Part]
    sharpen: str | None


class Disagreement(TypedDict):
    """A parameter on which captures disagree, and by how much."""

    param: str
    said: list[Part]


class Curve(TypedDict):
    """What no effect explains over a variable, as a factor of `times`, and half the width of its 95 % band.

    Null where the motion hardly went. `laws`: each law in their order, null for one that is not drawn.
    """

    over: str
    times: str
    x: list[float]
    value: list[float | None]
    band: list[float | None]
    laws: list[list[float | None] | None]


class Surface(TypedDict):
    """What no effect explains over two variables, as a factor of `times`: a row for each `y` of the second.

    Null where the motion did not go. `laws`: each law in their order, null for one of fewer variables.
    """

    over: tuple[str, str]
    times: str
    x: list[float]
    y: list[float]
    value: list[list[float | None]]
    laws: list[list[list[float | None]] | None]
