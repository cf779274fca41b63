"""The linked plots of a notebook and of a file: the page of a report, alone."""

from __future__ import annotations

import base64
import json
import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest

import knobcam as kc
from knobcam import linked


def kept(page: str) -> dict[str, object]:
    found: dict[str, object] = json.loads(re.findall(r'id="look-samples">(.*?)</script>', page, re.DOTALL)[0])
    return found


def test_a_notebook_shows_the_same_page_as_the_file(story: kc.Story, tmp_path: Path) -> None:
    look = story.look()
    shown = re.findall(r'srcdoc="([^"]*)"', look._repr_html_())
    assert [unescape(one) for one in shown] == [look.save(tmp_path / "look.html").read_text("utf-8")]
    assert 'sandbox="allow-scripts"' in look._repr_html_()


def test_a_page_holds_the_columns_in_the_order_that_it_names(story: kc.Story) -> None:
    held = kept(story.fit.look().html())
    floats = np.frombuffer(base64.b64decode(str(held["floats"])), "<f4").reshape(5, -1)
    assert held["columns"] == ["t", "theta", "omega", "tau"]
    signals = story.fit.signals
    for row, name in zip(floats[1:], ("theta", "omega", "tau"), strict=False):
        assert row == pytest.approx(signals.on_capture(getattr(signals, name)), rel=1e-5, nan_ok=True)


def test_a_long_capture_is_thinned_and_its_error_stays(
    story: kc.Story, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(linked, "SHOWN", 4000)
    held = kept(story.fit.look().html())
    floats = np.frombuffer(base64.b64decode(str(held["floats"])), "<f4").reshape(5, 4000)
    assert np.all(np.diff(floats[0]) > 0.0)
    assert np.sqrt(np.nanmean(floats[4] ** 2)) == pytest.approx(story.fit.rmse, rel=0.1)


def test_a_hostile_label_cannot_end_the_element_it_stands_in(story: kc.Story) -> None:
    page = linked.Look((("</script><script>alert(1)</script>", story.fit),)).html()
    assert page.count("<script") == 2 and page.count("</script") == 2
