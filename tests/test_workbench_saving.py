"""What a session leaves behind: model, report and pictures."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

import knobcam as kc
from knobcam.base.writing import make_folder
from knobcam.errors import InputError
from knobcam.show import plot
from knobcam.workbench import saving
from knobcam.workbench.session import Session
from knobcam.workbench.tell import quiet


def test_a_model_a_report_and_pictures_are_saved(
    sprung: kc.Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What is drawn, and that it is PNG, is the business of other tests, and takes seconds.
    def drawn(_: object, folder: Path, *__: object) -> None:
        make_folder(folder)
        (folder / "01-one.png").write_bytes(folder.name.encode())

    monkeypatch.setattr(plot, "save_all", drawn)
    monkeypatch.setattr(plot, "save_learning", drawn)
    session = Session()
    session.take(sprung, "sprung")
    session.add("return_spring")
    model = saving.save(session, "model", tmp_path / "knob.toml", quiet)
    assert kc.Model.load(model) == session.node.fit.model
    report = saving.save(session, "report", tmp_path / "report.html", quiet).read_text()
    assert "Return spring was missing" in report
    pictures = saving.save(session, "figures", tmp_path / "figures.zip", quiet)
    with zipfile.ZipFile(pictures) as archive:
        saved = {name: archive.read(name) for name in archive.namelist()}
    assert saved == {"fit/01-one.png": b"fit", "story/01-one.png": b"story"}
    with pytest.raises(InputError, match="exists already"):
        saving.save(session, "model", model, quiet)
    with pytest.raises(InputError, match="cannot be saved"):
        saving.save(session, "pickle", tmp_path / "x", quiet)
    with pytest.raises(InputError, match="there is no folder"):
        saving.save(session, "model", tmp_path / "none" / "x", quiet)
