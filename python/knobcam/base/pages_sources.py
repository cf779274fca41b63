"""What the pages are told of where captures come from: knobs, rigs that record, files and their columns.

The other half of the schema in `pages.py`, by the same rules.
"""

from typing import Literal, NotRequired, TypedDict

from .pages_next import Enough


class Knob(TypedDict):
    """A knob that can be simulated, and the effects that it can hide."""

    name: str
    words: str
    hideable: list[str]


class FoundPort(TypedDict):
    """A serial port, and what is plugged in there."""

    port: str
    words: str


class Sources(TypedDict):
    """The answer of `GET /api/sources`: what captures can be made of; names with words for them."""

    knobs: list[Knob]
    effects: dict[str, str]
    titles: dict[str, str]
    motions: dict[str, dict[str, str]]
    no_emulated_rig: str | None
    ports: list[FoundPort]
    folder: str


class Live(TypedDict):
    """How a recording goes; what is not required comes with the first figures."""

    what: str
    log: str
    every: int
    done: float | None
    ended: bool
    error: str | None
    capture: str | None
    elapsed_s: NotRequired[float]
    total_s: NotRequired[float]
    received: NotRequired[int]
    missing: NotRequired[int]
    rate_hz: NotRequired[float]
    peak_torque: NotRequired[float | None]
    torque_limit: NotRequired[float]
    clipped: NotRequired[dict[str, int]]
    temperature: NotRequired[float | None]


class ColumnsHead(TypedDict):
    """The line in front of columns of bytes: their names, their length; `live` of a recording."""

    names: list[str]
    n: int
    dtype: Literal["f32"]
    live: NotRequired[Live]


class FileColumn(TypedDict):
    """A column of a file that is no capture yet; `outline` is lowest and highest of its pieces, 0 to 1."""

    name: str
    rows: int
    low: float | None
    high: float | None
    outline: list[tuple[float, float]]


class Guess(TypedDict):
    """What a column of a capture may be, until a person says so; a unit that nobody knows is null."""

    expression: str
    unit: str | None


class Fault(TypedDict):
    """What a rig has latched, in words: its cause, and how long ago; `code` is by which it is cleared."""

    code: int
    told: str


class Why(TypedDict, total=False):
    """What more there may be to say: `columns` of a file that could not be taken for a capture, a `fault`.

    `guess` has the columns of a capture that the file's seem to be, `enough` the limit with which there would
    be a motion.
    """

    columns: list[FileColumn]
    guess: dict[str, Guess]
    fault: Fault
    enough: Enough


class Refused(Why):
    """What is wrong with a request."""

    error: str


class Challenge(TypedDict):
    """The answer of `GET /api/challenge`: how it goes with what a capture hides.

    `more`: whether there is another hint; `wrong` effects were added and are not there; of the `hidden` ones
    so many are `found`, and `solved` says that nothing else is in the model. While a challenge, which is
    `graded` and of a `level`, is `sealed`, what the program thinks is not shown; `given_up`: it was told
    before it was found.
    """

    hints: list[str]
    more: bool
    wrong: list[str]
    found: int
    hidden: int
    solved: bool
    given_up: bool
    graded: bool
    level: str
    sealed: bool
    score: int


class Found(TypedDict):
    """The answer of `GET /api/finding`: the samples of a finding, first and last of each run, from 0."""

    runs: list[tuple[int, int]]
