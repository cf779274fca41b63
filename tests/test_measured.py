"""The pages of figures are written anew without losing what somebody wrote there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import report


def test_what_was_written_by_hand_beside_a_table_stays(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    results = tmp_path / "benches" / "results"
    results.mkdir(parents=True)
    monkeypatch.setattr(report, "ROOT", tmp_path)
    for name, lines in {"rig": ["new rig  ", "of two\nlines "], "logs": ["new logs"]}.items():
        (results / f"{name}.json").write_text(json.dumps({"report": lines}))
    page = "# Page\n\n## By hand\n\nwords\n\n## Rig\n\nbefore\n\n```\nold\n```\n\nafter\n\n```\nown\n```\n"
    titles = {"rig": "Rig", "logs": "Logs", "gone": "Of a study that was not held"}
    once = report.renewed(page, titles, "report", "```")
    assert once == (
        "# Page\n\n## By hand\n\nwords\n\n## Rig\n\nbefore\n\n```\nnew rig\nof two\nlines\n```\n\n"
        "after\n\n```\nown\n```\n\n## Logs\n\n```\nnew logs\n```\n"
    )
    assert report.renewed(once, titles, "report", "```") == once
