"""The order of the house: what the sources of the project promise about themselves."""

from __future__ import annotations

import ast
import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import knobcam
from knobcam import _core

ROOT = Path(__file__).parents[1]
CRATES = ROOT / "crates"
RUST = CRATES / "knobcore" / "src"
PYTHON = ROOT / "python" / "knobcam"

CRATE_ORDER = ["knobcore", "knobrender", "knobrig", "knobstep", "knobpy"]
"""A crate knows those before it, by its Cargo.toml."""
RUST_ORDER = [
    *("prelude", "local", "error", "isa", "random", "scalar", "special", "threads", "algebra"),
    *("order", "spans", "fourier", "periodogram", "motion", "param"),
    *("effects", "model", "model_file", "chain", "filter", "signals", "smooth", "prepare", "predict"),
    *("forward", "carry", "noise", "rule", "floor", "fit", "diagnose", "propose", "stiction"),
]
"""Modules of knobcore, each of which knows those before it."""
MOST = 12
"""Names at the top of the Python package that a reader can still hold in mind."""
LONGEST = 400
QUOTED = 15
"""Names of effects and parameters that Python may quote: the rest is asked of the effects."""


def rust_code(path: Path) -> str:
    """The code of a Rust file without comments and without its tests, which come last."""
    text = re.sub(r"#\[cfg\(test\)\]\s*mod \w+;", "", path.read_text())
    code, _, tests = text.partition("#[cfg(test)]")
    assert not tests or re.fullmatch(r"\nmod tests \{\n(?:(?:[ #].*)?\n)*\}\n", tests), (
        f"{path}: tests come last"
    )
    return re.sub(r"//.*", "", code)


def rust_files(*crates: str) -> list[Path]:
    found = [path for crate in crates for path in sorted((CRATES / crate / "src").rglob("*.rs"))]
    return [path for path in found if "tests" not in path.relative_to(CRATES).parts]


def written_files() -> list[Path]:
    """What people wrote; the page of the workbench is built, from `web/`."""
    folders = ("crates", "python", "tests", "benches", "docs", "examples", ".ci")
    folders = (*folders, "web/src", "web/tests", "web/browser")
    found = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file()]
    found = [path for path in found if not path.is_relative_to(PYTHON / "workbench" / "page")]
    texts = {".rs", ".py", ".pyi", ".toml", ".md", ".js", ".css", ".html", ""}
    return [
        *ROOT.glob("*.py"),
        *ROOT.glob("web/*.py"),
        *ROOT.glob("*.md"),
        *(path for path in found if path.suffix in texts),
    ]


def imported_by_rust(code: str) -> set[str]:
    """The top modules of the crate that some code names."""
    grouped = " ".join(re.findall(r"crate::\{([^;]*)\};", code))
    while re.search(r"::\{[^{}]*\}", grouped):
        grouped = re.sub(r"::\{[^{}]*\}", "", grouped)
    return {*re.findall(r"crate::(\w+)", code), *re.findall(r"(?:^|,)\s*(\w+)", grouped)}


def taken_from_the_package(path: Path) -> set[str]:
    """What a file imports from the package itself, `from .. import name`, wherever it does."""
    up = len(path.relative_to(PYTHON).parts)
    lines = [line for line in ast.walk(ast.parse(path.read_text())) if isinstance(line, ast.ImportFrom)]
    lines = [line for line in lines if (line.level, line.module) in [(up, None), (0, "knobcam")]]
    return {alias.name for line in lines for alias in line.names}


def module(path: Path, root: Path) -> str:
    return path.relative_to(root).parts[0].removesuffix(path.suffix)


def test_the_python_crates_are_named_in_the_bindings_alone():
    outside = rust_files(*CRATE_ORDER[:-1])
    assert [path for path in outside if re.search(r"\b(pyo3|numpy)\b", rust_code(path))] == []


def test_crates_use_only_those_before_them():
    for place, crate in enumerate(CRATE_ORDER):
        manifest = tomllib.loads((CRATES / crate / "Cargo.toml").read_text())
        used = {name for name in manifest["dependencies"] if name in CRATE_ORDER}
        assert used <= set(CRATE_ORDER[:place]), crate


def test_rust_modules_use_only_those_before_them():
    backward, place = set(), {name: at for at, name in enumerate(RUST_ORDER)}
    for path in rust_files("knobcore"):
        user = module(path, RUST)
        if user != "lib":
            used = imported_by_rust(rust_code(path)) - {user}
            backward |= {(user, name) for name in used if place[name] > place[user]}
    assert backward == set()


def packages() -> list[str]:
    """Packages and modules at the top of the Python package."""
    found = {path.stem for path in PYTHON.glob("*.py")} | {
        path.parent.name for path in PYTHON.glob("*/__init__.py")
    }
    return sorted(name for name in found if not name.startswith("__"))


def test_the_top_of_the_python_package_is_seen_at_a_glance():
    assert len(packages()) <= MOST


def test_the_order_of_the_packages_is_said_as_it_is_held():
    """`python3 dev.py lint` holds it; here it is only compared with what the package tells its reader."""
    held = (ROOT / ".importlinter").read_text().partition("layers =\n")[2]
    layers = re.match(r"(?:    \w+\n)+", held)
    told = re.findall(r"(?m)^(\w+) {2,}\S", knobcam.__doc__ or "")
    assert layers is not None
    assert layers.group().split() == ["__main__", *reversed(told)]
    assert sorted(told) == packages()


def test_python_modules_take_only_the_core_and_packages_from_the_package_itself():
    """Its `__init__` names what stands in every layer: by it each of them could reach all."""
    files = [path for path in PYTHON.rglob("*.py") if path.parent != PYTHON]
    taken = {path: taken_from_the_package(path) - {"_core", *packages()} for path in files}
    assert {path: names for path, names in taken.items() if names} == {}


def test_no_file_is_too_long_to_be_read_at_once():
    lengths = {path: len(path.read_text().splitlines()) for path in written_files()}
    assert {path: lines for path, lines in lengths.items() if lines > LONGEST} == {}


def test_nothing_is_left_for_later():
    later = re.compile(r"\b(TO[D]O|FIX[M]E|XX[X]|HAC[K])\b")
    assert [path for path in written_files() if later.search(path.read_text())] == []


def test_the_core_never_panics_on_purpose():
    panics = re.compile(r"\.unwrap\(\)|\.expect\(|\b(panic|unreachable|todo|unimplemented|assert(_eq|_ne)?)!")
    found = {
        path: match.group() for path in rust_files(*CRATE_ORDER) if (match := panics.search(rust_code(path)))
    }
    assert found == {}


def test_every_effect_is_a_file_of_its_own_with_its_tests_in_it():
    ids = set(knobcam.effects())
    files = {path.stem: path.read_text() for path in (RUST / "effects").glob("*.rs") if path.stem != "mod"}
    assert ids <= files.keys()
    for name in ids:
        assert f'const ID: &\'static str = "{name}";' in files[name]
        assert "#[test]" in files[name], f"effects/{name}.rs has no test"


def quoted_effects() -> dict[str, list[str]]:
    """Effects and parameters that Python quotes by name; fields of a device's message are none of them."""
    ids = "|".join(knobcam.effects())
    one = re.compile(rf"""(["'])((?:{ids})(?:\.[\w{{}}]*)?)\1""")
    elsewhere = {"rig/emulator.py", "rig/feel.py", "rig/record.py", "capture/formats/wire.py"}
    of_the_demonstration = {"model/typical.py", "model/hiding.py", "cli/demonstration.py"}
    found = {}
    for path in PYTHON.rglob("*.py"):
        name = path.relative_to(PYTHON).as_posix()
        if name not in elsewhere | of_the_demonstration:
            found[name] = [match.group(2) for match in one.finditer(path.read_text())]
    return {name: quoted for name, quoted in found.items() if quoted}


def test_what_is_known_of_an_effect_stands_in_its_own_file():
    quoted = quoted_effects()
    assert sum(map(len, quoted.values())) <= QUOTED, quoted
    named = re.compile(r"\bId::(?!User\b|BUILT_IN\b)[A-Z]\w*|\"(?:" + "|".join(knobcam.effects()) + r")[.\"]")
    for name in ("screen", "candidates", "coupled", "implausible", "null"):
        code = rust_code(RUST / "diagnose" / f"{name}.rs")
        assert named.findall(code) == [], f"diagnose/{name}.rs"


def test_the_package_has_the_version_of_the_crate():
    cargo = (ROOT / "Cargo.toml").read_text()
    assert f'version = "{knobcam.__version__}"' in cargo
    assert version("knobcam") == knobcam.__version__


def public(names: list[str]) -> set[str]:
    return {name for name in names if not name.startswith("_")}


def declared(body: list[ast.stmt]) -> dict[str, list[ast.stmt]]:
    """What a stub declares, and what is inside of it; type aliases are none of the module's names."""
    kinds = (ast.FunctionDef, ast.ClassDef)
    return {node.name: node.body for node in body if isinstance(node, kinds) and node.name[0] != "_"}


def test_the_stub_declares_what_the_compiled_module_exports():
    stub = declared(ast.parse((PYTHON / "_core.pyi").read_text()).body)
    assert public(dir(_core)) == stub.keys()
    for name, body in stub.items():
        if isinstance(getattr(_core, name), type):
            assert public(dir(getattr(_core, name))) == declared(body).keys(), f"members of {name}"


def test_the_guide_to_a_new_effect_shows_the_tested_example():
    contract = (RUST / "effects" / "mod.rs").read_text()
    tested = re.search(r"//! ```\n((?://!.*\n)*?)//! ```", contract)
    shown = re.search(r"```rust\n(.*?)```", (ROOT / "docs" / "add-an-effect.md").read_text(), re.DOTALL)
    assert tested is not None
    assert shown is not None
    assert shown.group(1) == re.sub(r"(?m)^//! ?", "", tested.group(1))
