"""What the pages say is what happens: their snippets run, their links lead somewhere, the examples work."""

from __future__ import annotations

import contextlib
import functools
import io
import math
import re
import runpy
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from command import knobcam
from measurements import ROOT, SHARED, real
from small import COUPLINGS

import knobcam as kc
from knobcam.fleet.limits import Limits as PartLimits
from knobcam.learn import designing, learning
from knobcam.rig.emulator import EmulatedRig
from knobcam.show import batch_report, report

README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs").glob("*.md"))]
OTHERS = [ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]  # about the sources: nothing in them is run here
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NOT_RUN = "<!-- not run: builds -->"
"""Stands above a snippet that builds or installs; any other is run."""
PRINTED = "<!-- printed -->"
"""Stands above a text that the Python snippet before it prints."""
CLOSE = 0.02
"""How far (relative) a number may be from the one that a page shows: last digits are the machine's."""


class Snippet(NamedTuple):
    """A fenced block of a page."""

    language: str
    text: str
    line: int
    above: str


class Call(NamedTuple):
    """A command of a console snippet and what it shows."""

    command: str
    shown: list[str]


def snippets(page: Path) -> list[Snippet]:
    text = page.read_text("utf-8")
    fence = re.compile(r"^(?P<above>[^\n]*)\n+```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)
    return [
        Snippet(
            found["language"],
            found["text"],
            text.count("\n", 0, found.start("text")) + 1,
            found["above"],
        )
        for found in fence.finditer(text)
    ]


def calls(text: str) -> list[Call]:
    found: list[Call] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append(Call(line[2:], []))
        else:
            found[-1].shown.append(line)
    return found


def same_word(shown: str, printed: str) -> bool:
    try:
        return math.isclose(float(shown), float(printed), rel_tol=CLOSE)
    except ValueError:
        return shown == printed


def same_line(shown: str, printed: str) -> bool:
    return matches(words(shown), words(printed), same_word)


def words(line: str) -> list[str]:
    return [word.strip("(),;:") for word in line.split()]


def matches(shown: list[str], printed: list[str], same: Callable[[str, str], bool]) -> bool:
    """Whether words or lines are those shown, where `...` stands for any number of them."""
    if not shown:
        return not printed
    if shown[0].strip() == "...":
        return any(matches(shown[1:], printed[at:], same) for at in range(len(printed) + 1))
    return bool(printed) and same(shown[0], printed[0]) and matches(shown[1:], printed[1:], same)


def run_call(call: Call, where: str) -> None:
    program, *words = shlex.split(call.command)
    assert program == "knobcam", f"{where}: only knobcam is run; mark what builds with {NOT_RUN}"
    ended = knobcam(*words)
    refused = any(line.startswith("knobcam: ") for line in call.shown)
    assert ended.code == (2 if refused else 0), f"{where}: {call.command}\n{ended.err}"
    if call.shown:
        check_printed(call.shown, (ended.err + ended.out).splitlines(), where)


def check_printed(shown: list[str], printed: list[str], where: str) -> None:
    assert matches(shown, printed, same_line), "\n".join([where, *shown, "is not", *printed])


def lay_out(page: Path) -> None:
    """Put the measurements that a page is about into the current folder, or skip it where they are absent."""
    for listed in re.findall(r"^<!-- data: (.*) -->$", page.read_text("utf-8"), re.M):
        for name in listed.split():
            Path(Path(name).name).symlink_to(real(SHARED / name))


def read_toml(text: str, where: str) -> None:
    """Write the file that a snippet is, under the name of its kind, and read it."""
    if "knobcam.motion/" in text:
        Path("motion.toml").write_text(text)
        assert len(kc.motion("motion.toml").t) > 0, where
    elif "schema" in text:
        assert kc.Model.parse(text).effects, where
        Path("model.toml").write_text(text)
    elif "[parameters]" in text:  # of parts, in a batch
        Path("limits.toml").write_text(text)
        assert PartLimits.load("limits.toml", None, learned=True).checks, where
    else:
        Path("limits.toml").write_text(text)
        usual = kc.Limits(1.0, 1.0, 1.0, 0.0, 1.0, sample_rate_hz=1000.0)
        assert kc.Limits.load("limits.toml", usual) != usual, where


def run_page(page: Path) -> None:
    """Run a page from top to bottom as its reader would, in the current folder."""
    lay_out(page)
    names: dict[str, Any] = {}
    printed = io.StringIO()
    for snippet in snippets(page):
        where = f"{page.name}:{snippet.line}"
        if snippet.above == NOT_RUN:
            builds = re.compile(r"\$ (python3 dev\.py|pip install) .*")
            assert all(builds.fullmatch(line) for line in snippet.text.splitlines()), where
        elif snippet.language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(snippet.text, where, "exec"), names)
        elif snippet.language == "console":
            for call in calls(snippet.text):
                run_call(call, where)
        elif snippet.language == "toml":
            read_toml(snippet.text, where)
        elif snippet.above == PRINTED:
            check_printed(snippet.text.splitlines(), printed.getvalue().splitlines(), where)
        else:
            assert snippet.language in ("rust", "text"), f"{where}: a snippet that nobody runs"


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The log that the README supposes, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    run = kc.simulate(kc.Model.load("knob4"), duration_s=4.0)
    table = np.column_stack([1e3 * run.t, np.rad2deg(run.theta), 1e3 * run.tau])
    np.savetxt("log.csv", table, delimiter=",", header="ms,deg,mNm", comments="")
    return tmp_path / "log.csv"


@pytest.fixture
def port(request: pytest.FixtureRequest, log: Path) -> Iterator[None]:
    """The port that pages on rigs suppose, beside the log: its rig computes as long as it is there."""
    page = request.getfixturevalue("page").read_text("utf-8")
    if "--port rig" not in page:
        yield
        return
    with EmulatedRig("knob4", speed=20.0) as rig:
        log.with_name("rig").symlink_to(rig.port)
        yield


SEARCHED: dict[Any, kc.LearningResult] = {}
PROPOSED: dict[int, Any] = {}


@pytest.fixture
def searched_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What pages learn of the same samples, by the command, in Python or for a picture, is one search.

    So are the laws that are proposed for it.
    """
    package = sys.modules["knobcam.learn"]
    search = package.learn

    def learn(captures: Any, model: Any = None, *, progress: Any = None, **how: Any) -> kc.LearningResult:
        every = [captures] if isinstance(captures, kc.Capture | str | Path) else captures
        loaded = [one if isinstance(one, kc.Capture) else kc.load(one) for one in every]
        how = {"prepare": "smooth", "detents": "auto", "budget_s": None, "without": ()} | how
        how["without"] = tuple(how["without"])
        samples = tuple(values.tobytes() for one in loaded for values in one.columns.values())
        asked = (samples, repr(model), tuple(sorted(how.items())), tuple(kc.effects()))
        if asked not in SEARCHED:
            SEARCHED[asked] = search(loaded, model, progress=progress, **how)
        return SEARCHED[asked]

    def proposing(story: kc.LearningResult, progress: Any = None) -> Any:
        if story not in SEARCHED.values():  # of another the identity may come again
            return propose(story, progress)
        if id(story) not in PROPOSED:
            PROPOSED[id(story)] = propose(story, progress)
        return PROPOSED[id(story)]

    propose = learning.propose
    monkeypatch.setattr(learning, "propose", proposing)
    # Of a motion it is the first ones that pages show, not how good the best is.
    quick = functools.partial(designing.next_experiment, search_s=0.5)
    monkeypatch.setattr(designing, "next_experiment", quick)
    monkeypatch.setattr(designing, "_CHANGE_S", 0.5)
    monkeypatch.setattr(package, "learn", learn)
    monkeypatch.setattr(kc, "learn", learn)


@pytest.mark.usefixtures("log", "port", "searched_once")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_snippet_of_a_page_runs_and_prints_what_is_shown(
    page: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def undrawn(_: object, caption: str) -> str:
        return f"<figure>{caption}</figure>"

    # The pictures that --plots makes and those in reports are the business of other tests, and take seconds.
    monkeypatch.setattr(report, "figure", undrawn)
    monkeypatch.setattr(batch_report, "figure", undrawn)
    monkeypatch.setattr("knobcam.show.plot.save_all", lambda fit, folder, *_, **__: [folder / "fit.png"])
    run_page(page)


@pytest.mark.usefixtures("searched_once")
def test_the_servo_of_a_page_that_let_go_is_said_to_and_without_that_its_run_is_at_odds() -> None:
    """Four runs of one servo; in one of them it swings free for four seconds, which no voltage tells."""
    runs = sorted(real(SHARED / "bam_xl330").glob("*.json"))
    captures = [kc.load(run) for run in runs]
    let_go = [[one.count for one in run.findings if one.kind == "let_go"] for run in captures]
    assert let_go == [[], [1138], [], []]
    right = kc.learn(captures)
    assert right.verdict == "unexplained" and "negative" not in right.headline
    assert not [one for one in right.fit.warnings if "negative" in one]
    captures[1] = kc.load(runs[1], overrule=["let_go:tau"])
    odd = kc.learn(captures, without=COUPLINGS)
    assert odd.verdict == "unexplained"
    assert [one for one in odd.fit.warnings if one.startswith("coulomb.neg is negative")]
    friction = next(one for one in odd.disagreements if one.param.startswith("viscous"))
    assert runs[1].name in str(friction)


def test_a_page_that_shows_something_else_is_noticed() -> None:
    def right(*shown: str) -> bool:
        return matches(list(shown), ["a 1.001", "b (3 of 4)", "c", "z"], same_line)

    assert right("a 1.00", "b (3 of 4)", "c", "z") and right("a 1.0", "...", "z") and right("a ...", "...")
    assert right("...", "b (... of 4)", "...") and right("...", "z", "...")
    assert not (right("a 1.05", "...") or right("a 1.00", "z") or right("...", "c") or right("b ...", "..."))


@pytest.mark.parametrize("page", [*PAGES, *OTHERS], ids=lambda page: page.name)
def test_links_lead_to_files_of_the_repository(page: Path) -> None:
    links = re.findall(r"\]\(([^)\s#]+)", page.read_text("utf-8"))
    inside = [link for link in links if not link.startswith("https://")]
    assert [link for link in inside if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", [*PAGES, *OTHERS], ids=lambda page: page.name)
def test_files_that_a_page_names_exist(page: Path) -> None:
    named = re.findall(r"`((?:examples|docs|tests|benches|crates)/[\w./-]+)`", page.read_text("utf-8"))
    named = [name for name in named if not name.endswith("effects/drag.rs")]  # the one that is to be written
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_readme_leads_to_every_page_and_is_short() -> None:
    text = README.read_text("utf-8")
    assert [page.name for page in PAGES[1:] if f"(docs/{page.name})" not in text] == []
    assert len(text.splitlines()) <= 150


def test_what_the_readme_says_of_the_catalogue_is_all_that_there_is() -> None:
    text = README.read_text("utf-8").partition("## What may be missing")[2].partition("\n## ")[0]
    listed = re.findall(r"`(\w+)`", text)
    assert sorted(listed) == sorted(kc.effects())


def test_pictures_are_small_enough_to_be_kept() -> None:
    pictures = list((ROOT / "docs" / "pictures").iterdir())
    assert pictures and all(path.stat().st_size <= 250_000 for path in pictures)


def test_every_picture_is_shown_by_a_page() -> None:
    shown = "".join(page.read_text("utf-8") for page in PAGES)
    pictures = (ROOT / "docs" / "pictures").iterdir()
    assert [path.name for path in pictures if f"pictures/{path.name})" not in shown] == []


@pytest.mark.usefixtures("searched_once")
def test_the_maker_of_the_pictures_says_so_where_the_data_are_absent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def simulate(*knob: Any, **how: Any) -> kc.Capture:
        """Fewer samples than pictures have, but for those that a page has learned already."""
        return whole(*knob, **({"rate_hz": 1000.0} if "duration_s" in how else {}) | how)

    whole = kc.simulate
    monkeypatch.setattr(kc, "simulate", simulate)
    monkeypatch.setenv("KNOBCAM_SHARED_DATA", str(tmp_path))
    maker = str(ROOT / "docs" / "make_pictures.py")
    monkeypatch.setattr(sys, "argv", [maker, str(tmp_path)])
    runpy.run_path(maker, run_name="__main__")
    assert "no picture made" in capsys.readouterr().out
    made = {path.name for path in tmp_path.iterdir()}
    assert made and made <= {path.name for path in (ROOT / "docs" / "pictures").iterdir()}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_every_example_runs(
    example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def simulate(*knob: Any, **how: Any) -> kc.Capture:
        """Fewer samples than these examples take, which say the same."""
        return whole(*knob, **how | {"rate_hz": 1000.0})

    whole = kc.simulate
    if example.name in ("find_the_missing_effect.py", "stiction_from_pushes.py"):
        monkeypatch.setattr(kc, "simulate", simulate)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(example)])
    runpy.run_path(str(example), run_name="__main__")
    said = capsys.readouterr().out
    expected = {
        "fit_a_capture.py": ["detents every 0.477", "written: fitted.toml"],
        "compare_and_plot.py": ["It shows most along position", "chance explains it", "pictures in"],
        "find_the_missing_effect.py": ["verdict: missing found: stribeck", "report in knob.html"],
        "own_effect.py": ["fails along position", "sector_brake       RMS error 0.61", "complete"],
        "stiction_from_pushes.py": ["breakaways", "karnopp.D_pos"],
        "emps.py": ["KNOBCAM_SHARED_DATA"]
        if "is absent" in said
        else ["published 95.1089", "It shows most along"],
    }
    assert [words for words in expected[example.name] if words not in said] == []
