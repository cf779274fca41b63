"""The report is one file: it asks no network, names its evidence, and nothing in it becomes markup."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import re
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from carried import carried
from small import COUPLINGS

import knobcam as kc
from knobcam.base.said import OfAxis, said
from knobcam.fit.estimate import Estimate
from knobcam.show import report
from knobcam.show.plot.failures import of_excess
from knobcam.show.tables import html_table
from knobcam.show.values import with_doubt
from knobcam.show.words import effect_word, param_phrase, sentence, worded

HOSTILE = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)> $headline ${else} &amp; knob.csv"
VOID = {"meta", "img", "br", "link", "input", "hr"}


class Page(HTMLParser):
    """The tags, attributes and text of a page; fails where tags do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("style", "script"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def motor() -> kc.LearningResult:
    """A motor whose ripple has several orders, and so many parameters."""
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 20.0, 1.0 / 400.0)
    theta = 2.5 * np.pi * np.sin(2.0 * np.pi * t / 10.0) + 0.02 * np.sin(9.0 * t)
    ripple = 0.02 * np.sin(7.0 * theta) + 0.012 * np.sin(12.0 * theta + 1.0) + 0.009 * np.sin(21.0 * theta)
    tau = ripple + 0.01 * np.sign(np.gradient(theta, t)) + 0.0006 * rng.standard_normal(len(t))
    return kc.learn(kc.Capture.from_arrays(t=t, theta=theta, tau=tau), without=COUPLINGS)


@pytest.fixture(scope="module")
def page(story: kc.LearningResult) -> str:
    return report.html(story)


def test_a_report_answers_its_questions_in_order(page: str, story: kc.LearningResult) -> None:
    text = Page(page).text
    asked = [
        "What it is made of",
        "What cannot be told",
        "What to record next",
        "Look for yourself",
        "What was found",
        "Why",
        "What else it could be",
        "What remains",
        "How sure",
    ]
    places = [text.index(f" {question} ") for question in asked]
    assert places == sorted(places)
    assert sentence(story.headline, "rotary") in text
    for name in story.fit.params:
        assert param_phrase(name, "rotary") in text
    for one in story.last.candidates:
        assert effect_word(one.effect, "rotary") in text
    assert f'data-latex="{escape(kc.effects()[story.found[0]].latex)}"' in page


def test_a_report_has_no_ids_where_effects_have_names(page: str) -> None:
    words = Page(page).text
    ids = [one.id for one in kc.effects().values() if "_" in one.id]
    assert not [one for one in ids if one in words]
    assert not re.search(r"\b(\w+(?: \w+)*) from \1: either", words)


def test_an_error_that_falls_has_a_true_minus_in_the_words_of_a_report(page: str) -> None:
    assert re.search(r"the RMS error changes by −\d", Page(page).text)


def test_a_report_needs_no_network_and_no_other_file(page: str) -> None:
    parsed = Page(page)
    assert {"link", "iframe", "object", "base", "form", "a"}.isdisjoint(parsed.tags)
    sources = [value for _, name, value in parsed.attributes if name in ("src", "href", "srcset", "action")]
    assert len(sources) >= 4
    assert all(value.startswith("data:image/svg+xml;base64,") for value in sources)
    assert "http://" not in page and "https://" not in page
    assert "@import" not in page and "url(" not in page
    assert "default-src 'none'" in page


def test_the_one_script_of_a_report_is_the_package_s_own(page: str) -> None:
    samples, code = re.findall(r"<script([^>]*)>(.*?)</script>", page, re.DOTALL)
    assert samples[0] == ' type="application/json" id="look-samples"'
    assert code[0] == ""
    digest = base64.b64encode(hashlib.sha256(code[1].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in page
    for word in ("fetch(", "XMLHttpRequest", "WebSocket", "EventSource", "innerHTML", "eval("):
        assert word not in code[1]


def test_a_report_carries_what_its_story_looks_at(page: str, story: kc.LearningResult) -> None:
    assert carried(page) == carried(story.look().html())


def test_the_pictures_in_a_report_hold_no_script_and_fetch_nothing(page: str) -> None:
    for data in re.findall(r"base64,([A-Za-z0-9+/=]+)", page):
        svg = base64.b64decode(data).decode()
        assert "<script" not in svg and "onerror" not in svg
        references = re.findall(r'(?:href|src)="([^"]+)"', svg)
        assert all(one.startswith(("#", "data:")) for one in references)


def test_a_report_has_light_dark_and_paper(page: str) -> None:
    assert "prefers-color-scheme: dark" in page and "@media print" in page


@pytest.fixture(scope="module")
def brief() -> kc.Capture:
    """Of a knob with nothing missing, for what is asked of any report."""
    return kc.simulate("knob4", "sweep", duration_s=1.5, rate_hz=1000.0)


def test_hostile_names_are_printed_and_never_interpreted(brief: kc.Capture) -> None:
    named = dataclasses.replace(brief, meta={"source": HOSTILE})
    text = report.html(kc.learn(named))
    parsed = Page(text)
    assert parsed.tags.count("script") == 2
    assert not [name for _, name, _ in parsed.attributes if name.startswith("on")]
    assert HOSTILE in parsed.text
    assert parsed.tags.count("h1") == 1


@pytest.mark.usefixtures("undrawn")
def test_a_report_says_what_a_capture_cannot_tell_and_what_is_unexplained() -> None:
    story = kc.learn(kc.simulate(kc.Model.load("knob4"), "micro", duration_s=2.0, rate_hz=1000.0))
    assert story.limitations
    text = Page(report.html(story)).text
    assert all(one.message in text and one.record in text for one in story.limitations)
    left = dataclasses.replace(story, unexplained=kc.Unexplained("time", 0.4, "a line at 50.0 Hz"))
    assert left.verdict == "unexplained"
    assert (
        "40 % of the remaining error variance lies along time; a line at 50.0 Hz"
        in Page(report.html(left)).text
    )


@pytest.mark.usefixtures("undrawn")
def test_beside_an_error_that_is_unexplained_no_report_says_that_nothing_is_untold(
    story: kc.LearningResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest, vague_spring = (
        "what the error that is left comes of",
        "return spring: none of its values is determined",
    )
    text = Page(report.html(story)).text
    assert rest not in text and vague_spring not in text
    monkeypatch.setattr(report, "untold_of_each", lambda _: {})
    monkeypatch.setattr(type(story.fit), "undetermined", {})
    nothing = "Nothing: what was weighed is told apart"
    assert not story.limitations and nothing in Page(report.html(story)).text
    left = dataclasses.replace(story, unexplained=kc.Unexplained("time", 0.4, "a line at 50.0 Hz"))
    text = Page(report.html(left)).text
    assert nothing not in text and rest in text
    # A spring whose every value may be nothing is not determined, whatever chance explains.
    vague = dataclasses.replace(story)
    wide = {name: one.widened(100.0 * one.value**2) for name, one in story.params.items()}
    vague.__dict__["params"] = wide
    text = Page(report.html(vague)).text
    assert nothing not in text and vague_spring in text


@pytest.mark.usefixtures("undrawn")
def test_a_report_says_the_name_of_a_file_and_not_where_it_lies(brief: kc.Capture, tmp_path: Path) -> None:
    np.savetxt(
        tmp_path / "knob.csv",
        np.column_stack([brief.t, brief.theta, brief.tau]),
        **{"delimiter": ",", "header": "t_s,theta_rad,tau_Nm", "comments": ""},
    )
    text = report.html(kc.learn(tmp_path / "knob.csv"))
    assert "knob.csv" in Page(text).text
    assert str(tmp_path) not in text


def test_the_same_story_gives_the_same_report(story: kc.LearningResult, page: str) -> None:
    assert report.html(story) == page


def test_a_report_appears_whole_at_its_path(
    story: kc.LearningResult, page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "html", lambda told: page if told is story else "")
    path = story.report(tmp_path / "knob.html")
    assert path.read_text("utf-8") == page
    assert [one.name for one in tmp_path.iterdir()] == ["knob.html"]
    with pytest.raises(kc.InputError, match="there is no folder"):
        story.report(tmp_path / "no" / "such" / "knob.html")


def test_no_line_ends_between_a_number_and_its_per_cent() -> None:
    told = html_table("Ladder", ("error",), [("-8.8 %",), ("of 8 <b>%",)])
    assert "-8.8\u00a0%" in told and "of 8 &lt;b&gt;%" in told


def test_shares_that_overlap_are_said_to_and_bins_beyond_their_band_do_not_contradict_chance() -> None:
    knob = kc.hiding("knob4", "return_spring", motion="sweep", duration_s=4.0)
    fit = kc.fit(kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0, seed=5))
    compared = fit.compare()
    assert sum(one.share for one in compared.splits if one.fails) > 1.0
    (bars, *_) = compared.plot().axes
    assert "they overlap" in bars.get_xlabel()
    calm = kc.fit(kc.simulate("knob4", "sweep", duration_s=4.0, rate_hz=1000.0, seed=5)).compare()
    noisy = dataclasses.replace(calm["frequency"], mean=1.2 * calm["frequency"].band)
    quiet = dataclasses.replace(calm["frequency"], mean=0.8 * calm["frequency"].band)
    assert not noisy.fails and of_excess(noisy) == "no line stands out"
    assert of_excess(quiet) == "no more than chance"


def test_effects_that_came_in_together_have_what_was_weighed_beside_them_once(
    story: kc.LearningResult,
) -> None:
    step = next(one for one in story.ladder if one.added is not None)
    twice = dataclasses.replace(story, ladder=(*story.ladder, dataclasses.replace(step, added="stribeck")))
    told = report._alternatives(twice)
    title = kc.effects()[step.added or ""].title
    assert told.count("<h3>Instead of") == 1 and f"Instead of {title} and Stribeck friction" in told


def test_a_candidate_that_is_far_worse_does_not_push_the_others_aside() -> None:
    knob = kc.hiding("knob4", "return_spring", motion="sweep", duration_s=4.0)
    fit = kc.fit(kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0, seed=5))
    weighed = kc.diagnose(fit, only=["return_spring", "quadratic_drag"])
    spring, drag = weighed.candidates
    worse = dataclasses.replace(drag, fit=dataclasses.replace(fit, before=spring.fit))
    assert worse.error_fall < -1.5
    drawn = dataclasses.replace(weighed, candidates=(spring, worse)).plot().axes[0]
    left, right = drawn.get_xlim()
    assert right > -left
    assert any(f"{100.0 * worse.error_fall:.0f} %".replace("-", "−") in one.get_text() for one in drawn.texts)


@pytest.mark.usefixtures("undrawn")
def test_as_many_parameters_stand_on_the_sheet_as_there_is_room_for_and_all_of_them_behind_it(
    motor: kc.LearningResult,
) -> None:
    whole = report.html(motor)
    sheet, appendix = whole.split("</section>", 1)
    count = len(motor.params)
    assert count > 12
    assert f"of the {count} parameters of the last model" in sheet and sheet.count("<tr>") <= 13
    assert appendix.count("All parameters of the last model") == 1
    assert (
        "fixed"
        not in Page(sheet + "</section></main></body></html>").text.partition("parameter letter value")[2]
    )


@pytest.mark.usefixtures("undrawn")
def test_a_report_has_the_intervals_that_the_document_has(story: kc.LearningResult) -> None:
    """They carry what the choice among effects adds, which those of the last fit do not."""
    wider = dataclasses.replace(story)
    wider.__dict__["params"] = {name: one.widened(one.se**2) for name, one in story.params.items()}
    whole = report.html(wider)
    told = re.findall(r"<td>([^<]*)</td><td>[^<]*</td><td>([^<]*) ± ([\d.]+)(?:\)·10[^<]*)?</td>", whole)
    halves = {name: float(half) for name, _, half in told}
    for name, one in wider.document()["ladder"][-1]["params"].items():
        if one["ci95"] is None:
            continue  # not determined
        low, high = one["ci95"]
        half = 0.5 * (high - low)
        digits = halves[param_phrase(name, "rotary")] / half
        # But for the unit and its power of ten, two digits are the same.
        assert abs(digits / 10.0 ** round(np.log10(digits)) - 1.0) < 0.06, name


def test_a_value_has_as_many_digits_as_its_interval_justifies() -> None:
    def told(value: float, half: float, factor: float = 1.0) -> str:
        return with_doubt(Estimate(value, (value - half, value + half), "N m", half / 2.0), factor)

    assert told(0.01234567, 0.00021, 1000.0) == "12.35 ± 0.21"
    assert told(-123456.0, 4321.0) == "(−1.235 ± 0.043)·10⁵"
    assert told(1.23456e-5, 9.96e-7) == "(1.23 ± 0.10)·10⁻⁵"
    assert told(0.4, 230.0) == "0 ± 230"
    assert told(12.5, 0.0) == "12.5"
    unknown = Estimate(3.0, (float("nan"), float("nan")), "rad", float("nan"))
    assert with_doubt(unknown) == "not determined"


def test_letters_stand_beside_what_they_mean_and_where_several_mean_the_same_with_it(page: str) -> None:
    assert "<td>viscous coefficient moving forward (viscous friction)</td><td>pos</td>" in page
    assert param_phrase("inertia.M", "rotary") == "moment of inertia"
    assert param_phrase("cogging.a2", "rotary") == "its amplitude a2 (cogging)"
    assert param_phrase("brake.w", "rotary") == "w (brake)"
    every = [f"{one.id}.{row.name}" for one in kc.effects().values() for row in one.params]
    assert len({param_phrase(name, "rotary") for name in every}) == len(every)


@pytest.mark.usefixtures("undrawn")
def test_what_no_real_knob_has_stands_on_the_first_page_and_is_marked_where_its_value_is() -> None:
    knob = kc.hiding("knob3", "stribeck", motion="sweep", duration_s=4.0)
    capture = kc.simulate(knob, "sweep", duration_s=4.0, rate_hz=1000.0, seed=3)
    story = kc.learn(capture, without=kc.effects())
    assert any("viscous.pos is negative" in one for one in story.fit.warnings)
    sheet, appendix = report.html(story).split("</section>", 1)
    said = "Viscous coefficient moving forward (viscous friction) is negative, which no real knob has"
    assert "What is doubtful" in sheet and said in sheet and said not in appendix
    (row,) = re.findall(
        r"<td>viscous coefficient moving forward[^<]*</td><td>pos</td><td>([^<]*)</td>", sheet
    )
    assert row.startswith("−") and row.endswith("⚠")


@pytest.mark.usefixtures("undrawn")
def test_a_report_whose_values_are_all_plausible_has_nothing_doubtful(story: kc.LearningResult) -> None:
    assert not story.fit.warnings and "What is doubtful" not in report.html(story)
    strange = dataclasses.replace(story)
    name, one = next((name, one) for name, one in story.params.items() if name == "coulomb.pos")
    below = one._replace(value=-one.value, ci95=(-one.ci95[1], -one.ci95[0]))
    strange.__dict__["params"] = {**story.params, name: below}
    text = Page(report.html(strange)).text
    assert "Dry friction moving forward:" in text and "is implausible: it should be at least 0" in text


def test_the_headline_stands_once_on_the_sheet(story: kc.LearningResult, page: str) -> None:
    said = sentence(story.headline, "rotary")
    picture = re.search(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    assert picture is not None and said in page
    assert said.split()[0].encode() not in base64.b64decode(picture[1]).split(b"Error ladder")[0]


def test_what_depends_on_the_way_since_a_reversal_is_said_so_and_no_error_falls_by_more_than_all(
    story: kc.LearningResult,
) -> None:
    assert worded(said("along {along}", along=OfAxis("history")), "rotary") == "along distance since reversal"
    assert max(story.first_diagnosis.plot().axes[0].get_xticks()) <= 100.0
