"""A law of one's own becomes an effect of the catalogue: its Rust file and the line of the registry."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import knobcam, refused

import knobcam as kc

EFFECTS = Path("crates/knobcore/src/effects")
SOURCE = Path(__file__).parent.parent / EFFECTS / "mod.rs"
LAWS = """schema = "knobcam.model/1"
name = "mine"
[effects.inertia]
M = 1e-4
"""
BRAKE = '[effects.brake]\nlaw = "2 a (omega/w) / (1 + (omega/w)^2)"\na = 0.004\nw = 2.0\n'
HUM = '[effects.hum]\nlaw = "a sin(v t)"\nacts = "sensor"\na = 1e-3\nv = 300.0\n'
WORN = '[effects.worn]\nlaw = "a exp(-s/b)"\na = 1e-3\nb = 0.1\n'


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """What of a checkout the command looks at."""
    folder = tmp_path / "checkout"
    (folder / EFFECTS).mkdir(parents=True)
    (folder / EFFECTS / "mod.rs").write_text(SOURCE.read_text("utf-8"), "utf-8")
    return folder


def model(folder: Path, *laws: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(LAWS + "".join(laws), "utf-8")
    return path


def test_a_law_becomes_a_file_and_the_last_line_of_its_list(checkout: Path, tmp_path: Path) -> None:
    mine = model(tmp_path, BRAKE, HUM)
    before = SOURCE.read_text("utf-8").splitlines()
    for name, law, line, part in (
        ("eddy_brake", "brake", "eddy_brake::EddyBrake(2),", "loads"),
        ("mains", "hum", "mains::Mains(2),", "sensors"),
    ):
        ended = knobcam("new-effect", name, "--from", mine, "--law", law, "--into", checkout, "--json")
        assert ended.code == 0, ended.err
        registry = (checkout / EFFECTS / "mod.rs").read_text("utf-8").splitlines()
        at = next(i for i, own in enumerate(registry) if own.strip() == line)
        heading = next(own for own in reversed(registry[:at]) if own.endswith(" {"))
        assert (heading.strip(), registry[at + 1]) == (f"{part} {{", "    }")
        files = ended.document["files"]
        assert Path(files["registry"]) == checkout / EFFECTS / "mod.rs"
        text = Path(files["effect"]).read_text("utf-8")
        assert f'const ID: &\'static str = "{name}";' in text and "#[test]" in text
    assert [own for own in registry if own in before] == before


def test_the_only_law_of_a_model_needs_no_name_and_people_are_told_what_is_left(
    checkout: Path, tmp_path: Path
) -> None:
    ended = knobcam("new-effect", "eddy_brake", "--from", model(tmp_path, BRAKE), "--into", checkout)
    assert ended.code == 0 and "fill in its source" in ended.out
    assert 'Param::linear("a", Unit::of(1, 0, 0)' in (checkout / EFFECTS / "eddy_brake.rs").read_text("utf-8")


def test_what_cannot_become_an_effect_is_refused_and_nothing_is_written(
    checkout: Path, tmp_path: Path
) -> None:
    before = {path: path.read_text("utf-8") for path in (checkout / EFFECTS).iterdir()}
    for name, laws, more, said in (
        ("Eddy", (BRAKE,), ("--into", checkout), ("Eddy", "small letters")),
        ("mod", (BRAKE,), ("--into", checkout), ("mod.rs", "another name")),
        ("viscous", (BRAKE,), ("--into", checkout), ("viscous", "catalogue")),
        ("two", (BRAKE, HUM), ("--into", checkout), ("brake, hum", "--law")),
        ("none", (), ("--into", checkout), ("mine", "no law")),
        ("worn", (WORN,), ("--into", checkout), ("worn", "by hand")),
        ("eddy", (BRAKE,), ("--into", tmp_path), ("no checkout", "--into")),
        ("eddy", (BRAKE,), ("--law", "inertia", "--into", checkout), ("'inertia'", "in the catalogue")),
    ):
        refused(knobcam("new-effect", name, "--from", model(tmp_path, *laws), *more), *said)
    assert {path: path.read_text("utf-8") for path in (checkout / EFFECTS).iterdir()} == before


def test_a_function_is_no_formula(checkout: Path, tmp_path: Path) -> None:
    @kc.own_effect("called", law="a omega", a=kc.OwnParameter("N m s/rad", linear=True))
    def called(motion: kc.OwnMotion, a: float) -> object:
        return a * motion.omega

    try:
        path = model(tmp_path, "[effects.called]\na = 1.0\n")
        refused(knobcam("new-effect", "mine", "--from", path, "--into", checkout), "only a formula")
    finally:
        kc.forget_effect("called")
