"""What the pages are told, as JSON: one schema for Python, which writes it, and for `web/`, which reads it.

`python3 dev.py page` makes `web/src/types.js` of it, of `pages_said.py` and of `pages_sources.py`.
A number that may be none (NaN) is `float | None`, as JSON has null for it. Torques in N m, or forces in N
on a linear axis; all else in SI too.
"""

from typing import Literal, TypedDict

from .pages_left import Curve, Disagreement, Limitation, Surface
from .pages_next import Experiment
from .pages_said import Advice, Along, Letters, Part

Word = Literal["missing", "part", "alike", "less", "implausible", "too_little", "unpaid", "chance", "untold"]
"""What is said of an effect that could be missing; those first that speak most for it."""


class Finding(TypedDict):
    """What the quality check found in a capture, and whether a person has `overruled` it, by its `key`.

    `stands` is why nobody can, `seen` whether it names samples; a "note" changes nothing.
    """

    key: str
    said: list[Part]
    advice: Advice | None
    severity: Literal["note", "masked", "mended", "warning"]
    overruled: bool
    stands: str
    seen: bool


class CaptureInfo(TypedDict):
    """A capture that is open; `hides`: whether something in it is to be found."""

    id: str
    name: str
    samples: int
    rate_hz: float
    coordinate: Literal["rotary", "linear"]
    findings: list[Finding]
    hides: bool


class Step(TypedDict):
    """A fit on the way of a branch; `anew` of a model of its own, not that of the step before.

    `along` is what came in by itself beside what was `added`.
    `noise_floor`, where it is known, is read from what the model leaves too: it may fall with that.
    """

    node: str
    anew: bool
    added: str | None
    along: list[str]
    dropped: list[str]
    rmse: float
    rmse_heldout: float | None
    noise_floor: float | None
    captures: list[str]


class Branch(TypedDict):
    """A branch, and at which of its steps it is."""

    id: str
    name: str
    at: int
    steps: list[Step]


class Carried(TypedDict):
    """A step to what a model brought along to other captures, fitted to these."""

    added: str | None
    rmse: float
    rmse_heldout: float | None
    noise_floor: float | None


class LadderStep(TypedDict):
    """A step of the error ladder: what came in, and the error with it."""

    label: str
    rmse: float
    rmse_heldout: float | None


class Param(TypedDict):
    """A parameter; `doubt` is what is doubtful about its fitted value, `dragged` whether a hand moved it."""

    name: str
    value: float
    ci95: tuple[float, float] | None
    unit: str
    role: str
    fitted: float
    dragged: bool
    lower: float | None
    upper: float | None
    meaning: str
    doubt: list[Part] | None


class Together(TypedDict):
    """Two fitted parameters that the captures do not tell apart well, and their correlation."""

    names: list[str]
    correlation: float


class Effect(TypedDict):
    """An effect of the catalogue, in words; `letters` are those of its law."""

    effect: str
    place: str
    law: str
    source: str
    shows: str
    confused: list[str]
    title: str
    name: str
    about: str
    causes: list[str]
    remedies: list[str]
    latex: str
    letters: list[Letters]
    over: str
    section: str | None
    friction: bool


class Movement(TypedDict):
    """How far a parameter went when an effect came in."""

    by_se: float
    by_percent: float | None
    by: float


class Candidate(Effect):
    """An effect that could be missing, with what speaks for it and against it; `said` is `word` in words.

    `unsettled` says which of its values are not determined, where that is most of them.
    """

    word: Word
    said: list[Part]
    could_be: bool
    beyond_chance: bool
    p_value: float
    error_fall: float
    rmse_heldout: float | None
    moved: dict[str, Movement]
    equivalent: list[str]
    implausible: list[list[Part]]
    unsettled: str
    note: str


class Unexplained(TypedDict):
    """What no effect explains: along which axis, which share of the error, of what shape."""

    axis: str
    share: float
    hint: list[Part]


class Candidates(TypedDict):
    """What was weighed, best first, once it is `ready`; `left_out` is what could not be, and why."""

    ready: bool
    rows: list[Candidate]
    unexplained: Unexplained | None
    left_out: dict[str, str]


class Law(LadderStep):
    """What would explain what no effect does, in words; `law` and its values as one types them to `start`.

    `variables` are what it is of, `doubt` which values nobody knows, `fall` of the error it was sought in.
    """

    law: str
    fall: float
    variables: list[str]
    words: list[str]
    doubt: str
    start: str


class Job(TypedDict):
    """What is being done, for how many `seconds`; `done` from 0 to 1, null while nobody can tell.

    `takes_s`: from how many seconds to how many it usually takes, where that is known. One that `stops` can
    be ended with what it has found by then.
    """

    id: str
    what: list[Part]
    done: float | None
    takes_s: tuple[float, float] | None
    seconds: float
    stops: bool
    recording: bool


USUAL: tuple[Along, ...] = ("position", "velocity", "time")
"""What they are drawn over before a person chooses."""


class Split(TypedDict):
    """The mean residual in bins of an axis, and the half-width of the 95 % band that chance gives it.

    Along frequency `mean` is the RMS per bin, `band` what chance stays below.
    `direction` is whose motion a bin holds: 1 forward, -1 backward, 0 both.
    """

    axis: Along
    low: list[float]
    high: list[float]
    direction: list[int]
    mean: list[float]
    band: list[float | None]


class Splits(TypedDict):
    """The answer of `GET /api/splits`: the error of a fit along every axis."""

    splits: list[Split]


class Session(TypedDict):
    """What a session has; before the first capture there is no node, `proposed` is null until it is asked.

    Of each of `untold` one is in the model, not known which; what is `needless` does what came in since does.
    `added` is not named in what is said: what is `concluded`, if anything, be it by a search for everything
    that ended here (`searched`), and the `verdict`; only a search weighs `sets`. What to `record` shows more
    of what has no name, a motion `shown_along` its axis, in `limits`; `below_hz` is the edge of the filter.
    """

    schema: str
    revision: int
    captures: list[CaptureInfo]
    branches: list[Branch]
    active: list[str]
    branch: str | None
    node: str | None
    noise_floor: float | None
    unit: str
    peak: float
    below_hz: float | None
    params: list[Param]
    together: list[Together]
    rmse: float | None
    rmse_heldout: float | None
    added: list[str]
    concluded: list[Part]
    sets: bool
    searched: bool
    verdict: list[Part]
    record: str | None
    carried: list[Carried]
    ladder: list[LadderStep]
    candidates: Candidates
    warnings: list[str]
    limitations: list[Limitation]
    disagreements: list[Disagreement]
    titles: dict[str, str]
    absent: list[Effect]
    untold: list[list[str]]
    proposed: list[Law] | None
    proposed_said: list[Part]
    curve: Curve | None
    surface: Surface | None
    limits: dict[str, float] | None
    experiment: Experiment | None
    needless: list[str]
    shown_along: str | None


class Seen(TypedDict):
    """What is drawn: along which axes, isolated parts, the 95 % band, residuals held at one scale."""

    axes: list[Along]
    isolated: bool
    band: bool
    held: bool


class Brush(TypedDict):
    """A rectangle in one of the plots, by its number, in units of the data."""

    plot: int
    x: tuple[float, float]
    y: tuple[float, float]


class Looked(TypedDict):
    """How a page looks at a session: what is drawn, the branch beside, the brush."""

    view: Seen
    beside: str | None
    brush: Brush | None


class Left(TypedDict):
    """A session that was left and can go on; `when`: its last change, s since 1970; else what is `wrong`."""

    id: str
    when: float | None
    ended: bool
    captures: list[str]
    steps: int
    wrong: str | None


class State(Session):
    """The answer of `GET /api/state`: a session, what is being done to it, and what can go on."""

    job: Job | None
    recording: bool
    looked: Looked | None
    unread: list[str]
    left: list[Left]
    notes: list[str]


class More(TypedDict, total=False):
    """What an answer may say besides the revision."""

    job: str
    path: str
    log: str
    share: float
    hidden: list[str]
    cancelled: bool
    cut: list[Part]
    tried: Law
    unfinished: str


class Answer(More):
    """What a request is answered that changes or asks something, and where the session is now."""

    revision: int
    node: str | None


class ShownStep(TypedDict):
    """A model that linked plots show, and what could be missing from it where that was weighed."""

    label: str
    rmse: float
    candidates: Candidates | None


class Shown(TypedDict):
    """What linked plots show: models held against so many captures of `all` samples, torques up to `peak`.

    `titles` are those of all effects; `below_hz` as of `Session`.
    """

    unit: str
    peak: float
    below_hz: float | None
    coordinate: Literal["rotary", "linear"]
    noise: float | None
    titles: dict[str, str]
    captures: int
    all: int
    steps: list[ShownStep]


class Packed(TypedDict):
    """A column in few letters: `deflated` is base64 of n 32-bit differences, all lowest bytes first.

    A difference has its sign in its lowest bit; of the steps that they sum up to, 0 is NaN and 1 is `low`.
    """

    low: float
    step: float
    deflated: str


class Head(Shown):
    """The same where `n` of the samples are carried along."""

    n: int


class Kept(Head):
    """What a page holds in itself: columns, of each step its residual and what each candidate explains."""

    columns: dict[str, Packed]
    residuals: list[Packed]
    signatures: list[dict[str, Packed]]
