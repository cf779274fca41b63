"""`diagnose`, `add` and `learn` from the command line: documents of the contract, files, progress."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, BinaryIO

import pytest
from command import knobcam, process
from matplotlib.figure import Figure

import knobcam as kc
from knobcam.learn import search
from knobcam.show import report


@pytest.fixture(scope="module")
def recorded(sprung: kc.Capture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same knob at the paper's rate, of which nothing is noted, and not for long."""
    again = kc.simulate(kc.Model.parse(sprung.meta["model"]), "multisine", duration_s=1.2)
    return again.save(tmp_path_factory.mktemp("captures") / "sprung.npz")


@pytest.fixture(scope="module")
def document(recorded: Path) -> dict[str, Any]:
    """What `learn` says of it."""
    return knobcam("learn", recorded, "--json").document


@pytest.fixture(scope="module")
def base(recorded: Path) -> Path:
    """The base model as `knobcam fit -o` leaves it."""
    path = recorded.with_name("base.toml")
    assert knobcam("fit", recorded, "-o", path).code == 0
    return path


def test_diagnose_ranks_what_is_missing_from_the_base_model_or_from_a_given_one(
    recorded: Path, base: Path
) -> None:
    alone = knobcam("diagnose", recorded, "--json").document
    given = knobcam("diagnose", recorded, base, "--json").document
    assert alone["schema"] == "knobcam.diagnose/1"
    best = alone["candidates"][0]
    assert "return_spring" in (best["effect"], *best["equivalent"])
    assert given["candidates"][0]["effect"] == best["effect"]
    assert given["effects"] == alone["effects"] == ["inertia", "coulomb", "viscous", "detent"]
    told = knobcam("diagnose", recorded, "--without", "return_spring")
    assert "return_spring" not in told.out and "Could be missing" in told.out


def test_diagnose_draws_the_candidates_and_where_the_model_fails(recorded: Path, tmp_path: Path) -> None:
    plots = tmp_path / "plots"
    document = knobcam("diagnose", recorded, "--plots", plots, "--json").document
    assert document["files"]["pictures"] == [str(plots / "diagnosis.png"), str(plots / "comparison.png")]
    assert all(Path(path).read_bytes().startswith(b"\x89PNG") for path in document["files"]["pictures"])


def test_add_refits_with_the_effect_and_says_what_that_changed(
    recorded: Path, base: Path, tmp_path: Path
) -> None:
    target = tmp_path / "with.toml"
    document = knobcam("add", "return_spring", recorded, base, "-o", target, "--json").document
    assert document["schema"] == "knobcam.add/1" and document["added"] == ["return_spring"]
    assert document["error_fall"] == pytest.approx(1.0 - document["rmse"] / document["before"]["rmse"])
    assert document["moved"]["inertia.M"].keys() == {"by_se", "by_percent", "by"}
    assert document["files"] == {"model": str(target)}
    assert "return_spring" in kc.Model.load(target).effects
    assert "return_spring" not in kc.Model.load(base).effects
    assert "With return_spring: RMS error" in knobcam("add", "return_spring", recorded, base).out


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures that are made and then not painted, which takes seconds and is the business of other tests."""

    def saved(figure: Figure, file: BinaryIO, **_: object) -> None:
        file.write(b"\x89PNG")

    monkeypatch.setattr(Figure, "savefig", saved)
    monkeypatch.setattr(report, "figure", lambda drawn, caption: f"<figure>{caption}</figure>")


@pytest.mark.usefixtures("undrawn")
def test_learn_writes_report_model_and_pictures_and_names_them(recorded: Path, tmp_path: Path) -> None:
    written, model, plots = tmp_path / "r.html", tmp_path / "m.toml", tmp_path / "plots"
    ended = knobcam("learn", recorded, "--report", written, "-o", model, "--plots", plots)
    assert ended.code == 0 and ended.err == ""
    assert "was missing" in ended.out and f"report: {written}" in ended.out
    assert written.read_text().startswith("<!DOCTYPE html>")
    assert {"return_spring", "position_polynomial"} & set(kc.Model.load(model).effects)
    assert (plots / "01-story.png").read_bytes().startswith(b"\x89PNG")


def test_learn_prints_the_document_of_the_contract(recorded: Path, document: dict[str, Any]) -> None:
    assert document["schema"] == "knobcam.learn/1" and document["verdict"] == "missing"
    assert document["capture"]["path"] == str(recorded)
    assert document["ladder"][0]["added"] is None
    assert document["files"] == {}


def test_learn_starts_from_a_model_and_takes_several_captures(
    recorded: Path, sprung: kc.Capture, tmp_path: Path
) -> None:
    knob = tmp_path / "knob.toml"
    knob.write_text(sprung.meta["model"])
    again = kc.simulate(knob, "sweep", duration_s=1.0, seed=5).save(tmp_path / "again.npz")
    document = knobcam("learn", recorded, again, "--model", knob, "--json").document
    assert document["verdict"] == "complete" and document["found"] == []
    assert [one["path"] for one in document["captures"]] == [str(recorded), str(again)]


def test_every_command_on_captures_takes_several_and_lists_them(
    recorded: Path, base: Path, tmp_path: Path
) -> None:
    knob = kc.Model.parse(kc.load(recorded).meta["model"])
    again = kc.simulate(knob, "multisine", duration_s=1.0, seed=6)
    both = [recorded, again.save(tmp_path / "again.npz")]
    calls = [
        ["diagnose", *both],
        ["diagnose", *both, base],
        ["compare", *both, "--model", "knob4", "--forward", "--horizon", "0.05"],
        ["add", "return_spring", *both, base],
    ]
    told = [knobcam(*call, "--json").document for call in calls]
    for document in told:
        assert [one["path"] for one in document["captures"]] == [str(path) for path in both]
    for diagnosis in told[:2]:
        found = diagnosis["candidates"][0]
        assert "return_spring" in (found["effect"], *found["equivalent"])


@pytest.mark.usefixtures("undrawn")
def test_compare_simulates_forward_when_it_is_asked(recorded: Path, tmp_path: Path) -> None:
    call = ["compare", recorded, "knob4", "--forward", "--horizon", "0.05"]
    document = knobcam(*call, "--plots", tmp_path / "p", "--json").document
    said = document["forward"]
    assert said["horizon_s"] == 0.05 and said["unit"] == "rad" and 0.0 < said["rmse"] < said["largest"]
    assert said["captures"][0]["path"] == str(recorded)
    assert document["files"]["pictures"][-1].endswith("-forward.png")
    first, *_ = knobcam(*call).out.splitlines()
    assert first.startswith("Position simulated from the measured torque: RMSE ") and " rad, R2 " in first
    assert "forward" not in knobcam("compare", recorded, "knob4", "--json").document


def test_a_process_that_learns_says_nothing_but_its_document(
    recorded: Path, document: dict[str, Any]
) -> None:
    ended = process("learn", recorded, "--json")
    assert (ended.code, ended.err) == (0, "")
    assert ended.document == document


def test_learn_that_is_interrupted_prints_what_it_knew_and_ends_with_130(
    recorded: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "worth_adding", interrupted)
    ended = knobcam("learn", recorded, "--json")
    assert ended.code == 130 and "interrupted" in ended.err
    document = json.loads(ended.out)
    assert document["verdict"] == "unexplained" and document["cut"]["by"] == "interrupt"


def test_learn_with_a_budget_says_what_it_did_not_weigh(recorded: Path) -> None:
    document = knobcam("learn", recorded, "--budget-s", "1e-6", "--json").document
    assert document["verdict"] == "unexplained" and document["cut"]["not_weighed"]
    assert knobcam("learn", recorded, "--budget-s", "-1").code == 2
