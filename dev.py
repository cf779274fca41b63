#!/usr/bin/env python3
"""The project's own commands. Needs Python >= 3.11 and a Rust toolchain; sets up everything else itself.

python3 dev.py demo [OPTION...]   build, then run `knobcam demo`
python3 dev.py test [OPTION...]   build, then the Rust tests and pytest (OPTION: for pytest)
python3 dev.py lint               formatting, clippy, ruff, types, the order of the packages
python3 dev.py check              lint, then test
python3 dev.py orders             every order in which recorder and host can meet (loom)
python3 dev.py bench [OPTION...]  the benchmarks against their peers; --quick: each once, untimed
python3 dev.py docs               the documentation site, in site/html
python3 dev.py page [--check]     the workbench's page; --check: are the committed files what is built?
python3 dev.py browser            Chromium and what drives it, for the tests in a browser
python3 dev.py setup              only the set-up: .venv, pinned dependencies, the extension
python3 dev.py wheel [--all]      a source archive and a wheel from it in dist/; --all: for every processor
python3 dev.py firmware TARGET    the render step for a microcontroller (rustc --print target-list), in dist/
python3 dev.py lock [--upgrade]   bring the requirements-*.lock files to pyproject.toml; --upgrade: all to the
                                  newest; --check: are they what pyproject.toml asks for?
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent
WEB = ROOT / "web"
PAGE = ROOT / "python" / "knobcam" / "workbench" / "page"
LIBRARY = ROOT / "python" / "knobcam" / "render" / "lib"
SHARED = ("libknobstep.so", "libknobstep.dylib", "knobstep.dll")
STATIC = ("libknobstep.a", "knobstep.lib")
DEVELOP = ("--profile", "develop", "--locked")
BARE = ("--package", "knobstep", "--no-default-features", "--features", "bare", "--profile", "bare")
VENV = ROOT / ".venv"
BIN = VENV / ("Scripts" if os.name == "nt" else "bin")
PYTHON = BIN / ("python.exe" if os.name == "nt" else "python")
LOCKS = {  # what each lock file pins, of pyproject.toml
    "uv": ("--group", "uv"),
    "dev": ("pyproject.toml", "--extra", "dev"),
    "demo": ("pyproject.toml", "--extra", "build"),  # no more than a first look needs
    "bench": ("pyproject.toml", "--extra", "bench"),
    "wheel": ("--group", "wheel"),
}
PROCESSORS = ("x86_64", "aarch64")  # computers that rigs hang on: PCs, Raspberry Pi, Jetson
OLDEST = "manylinux_2_17"  # glibc 2.17, of 2012: what the Rust library itself asks for


def run(*command: str | Path, silent: bool = False, place: Path = ROOT) -> str:
    """Run in the checkout and inside .venv; a command that fails ends this one with its exit code.

    What a silent one prints is returned.
    """
    words = [str(word) for word in command]
    print("+", shlex.join(word.replace(f"{ROOT}{os.sep}", "") for word in words), flush=True)
    environment = os.environ | {"VIRTUAL_ENV": str(VENV), "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
    environment |= {"PIP_QUIET": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    # A conda environment that happens to be active would compete with .venv for the extension.
    environment.pop("CONDA_PREFIX", None)
    # Containers often forbid Python to keep what it compiles: each process would compile it again.
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    output = subprocess.PIPE if silent else None
    ended = subprocess.run(words, cwd=place, env=environment, stdout=output, text=True, check=False)
    if ended.returncode:
        sys.exit(max(ended.returncode, 1))
    return ended.stdout or ""


def digest(*paths: Path) -> str:
    """One fingerprint of files, their names and this Python."""
    total = hashlib.sha256(sys.version.encode())
    for path in sorted(paths):
        total.update(f"\n{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return total.hexdigest()


def changed(name: str, now: str) -> bool:
    """Whether `name` was not yet set up in the state `now`."""
    stamp = VENV / f".{name}-stamp"
    return not stamp.is_file() or stamp.read_text() != now


def done(name: str, now: str) -> None:
    """Remember that `name` is set up in the state `now`."""
    (VENV / f".{name}-stamp").write_text(now)


def install(lock: str) -> None:
    """Make .venv hold what the lock file pins, every archive checked against its hash."""
    now = digest(ROOT / lock)
    if not changed(lock, now):
        return
    if not PYTHON.is_file() or changed("python", sys.version):
        run(sys.executable, "-m", "venv", "--clear", VENV)
        done("python", sys.version)
    words: tuple[str | Path, ...] = (BIN / "uv", "pip", "install", "--quiet")
    if lock in ("requirements-uv.lock", "requirements-demo.lock"):  # little, and pip is there
        # Python compiles what is imported when it is: of all that lies there a small part.
        words = (PYTHON, "-m", "pip", "install", "--no-compile")
    else:
        install("requirements-uv.lock")  # which takes a tenth of pip's time
    run(*words, "--require-hashes", "-r", lock)
    done(lock, now)


def needs_cargo() -> None:
    """Say how to get Rust before anything else is done."""
    if shutil.which("cargo") is None:
        sys.exit("dev.py: cargo is not on the PATH; install Rust from https://rustup.rs and try again")


def setup(tools: str = "dev", profile: str = "develop") -> None:
    """Dependencies, then the extension; Python sources are used where they are."""
    needs_cargo()
    install(f"requirements-{tools}.lock")
    develop = (BIN / "maturin", "develop", "--profile", profile, "--locked")
    metadata = digest(ROOT / "pyproject.toml", ROOT / "Cargo.toml", ROOT / "requirements-demo.lock")
    sources = [ROOT / "Cargo.lock", *(ROOT / "crates").rglob("Cargo.toml"), *(ROOT / "crates").rglob("*.rs")]
    rust = digest(*sources) + metadata + profile
    compiled = any((ROOT / "python" / "knobcam").glob("_core*.so")) or os.name == "nt"
    if changed("metadata", metadata):
        run(*develop)
        done("metadata", metadata)
    elif changed("rust", rust) or not compiled:
        run(*develop, "--skip-install")
    if tools != "demo" and changed("library", rust):  # a first look converts nothing
        library(LIBRARY, profile)
        done("library", rust)
    done("rust", rust)


def library(folder: Path, profile: str, target: str = "", tree: Path = ROOT) -> None:
    """The render step for programs in C and for simulators, which `knobcam convert` hands out."""
    bare(folder, target, tree)  # first: in a place of its own, it waits for nobody who compiles meanwhile
    only = ("--target", target) if target else ()
    run("cargo", "build", "--profile", profile, "--locked", "--package", "knobstep", *only, place=tree)
    collect([built_in(tree, target) / profile / name for name in SHARED], folder)


def bare(folder: Path, target: str = "", tree: Path = ROOT) -> None:
    """The static library, which asks nothing of an operating system, so that firmware can have it too."""
    only = ("--target", target) if target else ()
    run("cargo", "rustc", *BARE, "--locked", *only, "--crate-type", "staticlib", place=tree)
    collect([built_in(tree, target) / "bare" / name for name in STATIC], folder)


def built_in(tree: Path, target: str) -> Path:
    """Where cargo puts what it builds."""
    return tree / os.environ.get("CARGO_TARGET_DIR", "target") / target


def collect(made: list[Path], folder: Path) -> None:
    """Copy what there is."""
    folder.mkdir(exist_ok=True)
    for path in made:
        if path.is_file():
            shutil.copy(path, folder / path.name)


def firmware(options: list[str]) -> None:
    """The static library for another processor, which has no operating system."""
    needs_cargo()
    if len(options) != 1 or options[0].startswith("-"):
        sys.exit(
            "dev.py: firmware needs one target, such as thumbv7em-none-eabihf; rustc --print target-list"
        )
    run("rustup", "target", "add", options[0])
    bare(ROOT / "dist", options[0])
    print(
        f"dist/{STATIC[0]}: link a program with it that includes a header of `knobcam convert MODEL --to c`."
    )


def demo(options: list[str]) -> None:
    """Build, then run the demo, with what it needs and no more; what is there of the tests' set stays."""
    setup("demo")
    run(BIN / "knobcam", "demo", *options)


def test(options: list[str]) -> None:
    """Rust first: it is the foundation. Its tests run without the bindings, which need a Python to link."""
    setup()
    run("cargo", "test", *DEVELOP, "--workspace", "--exclude", "knobpy")
    if options:
        run(PYTHON, "-m", "pytest", *options)
        return
    # A file is one worker's, so that what its tests share is made once. Where the benchmarks' tools are
    # installed, they would warn of every worker.
    beside = ("-n", "logical", "--maxprocesses", "8", "--dist", "loadfile", "-p", "no:benchmark")
    # In the order of tests/conftest.py.
    run(PYTHON, "-m", "pytest", "-m", "not alone", *beside, "--no-loadscope-reorder")
    run(PYTHON, "-m", "pytest", "-m", "alone", "tests")


def orders(_: list[str]) -> None:
    """The recorder's desk with locks that try every order."""
    needs_cargo()
    run("cargo", "test", *DEVELOP, "--package", "knobrig", "--features", "orders", "--test", "loom")


def lint(_: list[str]) -> None:
    """Formatting, lints, types and who imports whom; warnings are errors."""
    setup()
    run("cargo", "fmt", "--all", "--check")
    # Effects are named by a macro, behind which cargo fmt does not look.
    run(
        "rustfmt",
        "--check",
        "--edition",
        "2024",
        *sorted((ROOT / "crates/knobcore/src/effects").glob("*.rs")),
    )
    run("cargo", "clippy", *DEVELOP, "--workspace", "--all-targets", "--", "--deny", "warnings")
    run("cargo", "clippy", *BARE, "--locked", "--lib", "--", "--deny", "warnings")
    run(BIN / "ruff", "check")
    run(BIN / "ruff", "format", "--check")
    run(BIN / "lint-imports", "--no-cache")
    run(BIN / "mypy")


def check(options: list[str]) -> None:
    """Everything that a change has to pass."""
    lint([])
    test(options)


def bench(options: list[str]) -> None:
    """The benchmarks, on what a wheel holds; their peers are installed for them alone."""
    quick = "--quick" in options  # nothing is timed, so it need not be built for speed
    setup(profile="develop" if quick else "release")
    install("requirements-bench.lock")
    mode = "--benchmark-disable" if quick else "--benchmark-only"
    run(PYTHON, "-m", "pytest", "benches", mode, *(option for option in options if option != "--quick"))


def wheel(options: list[str]) -> None:
    """One wheel for every Python from 3.11 on; pip builds it from the source archive, away from here."""
    needs_cargo()
    install("requirements-wheel.lock")
    dist = ROOT / "dist"
    shutil.rmtree(dist, ignore_errors=True)
    run(BIN / "maturin", "sdist", "--out", dist)
    with tempfile.TemporaryDirectory() as away:
        shutil.unpack_archive(next(dist.glob("*.tar.gz")), away)
        tree = next(Path(away).iterdir())
        build: list[str | Path] = [PYTHON, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", tree]
        build += ["--no-cache-dir", "--wheel-dir", dist, "--config-settings"]  # pip would keep each one
        here = platform.machine()
        if sys.platform != "linux" or here not in PROCESSORS:
            run(*build, "build-args=--locked")
            add_library(next(dist.glob("*.whl")), tree)
            return
        for processor in PROCESSORS if "--all" in options else (here,):
            target = f"{processor}-unknown-linux-gnu"
            if processor != here:
                run("rustup", "target", "add", target)
            link_by_zig(Path(away), processor)
            run(*build, f"build-args=--locked --compatibility {OLDEST} --target {target}")
            made = next(dist.glob(f"*_{processor}.whl"))
            add_library(made, tree, target)
            proven(made, processor)


def link_by_zig(folder: Path, processor: str) -> None:
    """Have cargo link for any processor and glibc, whoever calls it: what is compiled serves them all."""
    glibc = OLDEST.removeprefix("manylinux_").replace("_", ".")
    script = folder / f"zigcc-{processor}"
    script.write_text(
        f'#!/bin/sh\nexec cargo-zigbuild zig cc -- -target {processor}-linux-gnu.{glibc} "$@"\n'
    )
    script.chmod(0o755)
    os.environ[f"CARGO_TARGET_{processor.upper()}_UNKNOWN_LINUX_GNU_LINKER"] = str(script)


def proven(made: Path, processor: str) -> None:
    """Show a wheel's tag and size, where it keeps what they promise."""
    run(BIN / "abi3audit", "--strict", made)
    found = json.loads(run(BIN / "auditwheel", "show", "--json", made, silent=True))["overall_tag"]
    if found != f"{OLDEST}_{processor}":
        sys.exit(f"dev.py: {made.name}: its symbols ask for {found}")
    print(f"{made.relative_to(ROOT)}: {found}, {made.stat().st_size / 1e6:.1f} MB")


def add_library(made: Path, tree: Path, target: str = "") -> None:
    """Add the libraries of the render step, built in the same tree, to a wheel and its record."""
    with tempfile.TemporaryDirectory() as folder:
        library(Path(folder), "release", target, tree)
        files = {f"knobcam/render/lib/{path.name}": path.read_bytes() for path in Path(folder).iterdir()}
    with zipfile.ZipFile(made) as old:
        files = {name: old.read(name) for name in old.namelist()} | files
    record = next(name for name in files if name.endswith(".dist-info/RECORD"))
    rows = files.pop(record).decode().splitlines()
    told = {row.partition(",")[0] for row in rows}
    for name in sorted(files.keys() - told):
        sha256 = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).decode().rstrip("=")
        rows.append(f"{name},sha256={sha256},{len(files[name])}")
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for name, content in {**files, record: ("\n".join(rows) + "\n").encode()}.items():
            new.writestr(name, content)


def docs(_: list[str]) -> None:
    """The site, from docs/ and from what the installed package says of itself; it opens from disk."""
    setup()
    run(PYTHON, "docs/site/build.py")


def npm() -> None:
    """Make web/node_modules hold what the lock file pins."""
    if shutil.which("npm") is None:
        sys.exit("dev.py: npm is not on the PATH; install Node.js 20 or newer (https://nodejs.org)")
    lock = WEB / "package-lock.json"
    stamp = WEB / "node_modules" / ".knobcam-stamp"
    now = hashlib.sha256(lock.read_bytes()).hexdigest()
    if not stamp.is_file() or stamp.read_text() != now:
        run("npm", "ci", "--prefix", WEB, "--no-audit", "--no-fund")
        stamp.write_text(now)


def page(options: list[str]) -> None:
    """Build the browser's side, or check that the committed files are what is built."""
    npm()
    types = WEB / "src" / "types.js"
    told = run(sys.executable, WEB / "typed.py", silent=True)
    if "--check" not in options:
        types.write_text(told, "utf-8")
    elif types.read_text("utf-8") != told:
        sys.exit("dev.py: web/src/types.js: not what pages*.py say; run `python3 dev.py page` and commit it")
    run("npm", "run", "--prefix", WEB, "--silent", "types")
    run("npm", "test", "--prefix", WEB, "--silent")
    if "--check" not in options:
        run("node", WEB / "build.js", PAGE)
        return
    with tempfile.TemporaryDirectory() as folder:
        run("node", WEB / "build.js", folder)
        names = {path.name for place in (Path(folder), PAGE) for path in place.iterdir()}
        made = {name: Path(folder, name).read_bytes() for name in names if Path(folder, name).is_file()}
        kept = {name: (PAGE / name).read_bytes() for name in names if (PAGE / name).is_file()}
        other = sorted(name for name in names if made.get(name) != kept.get(name))
    if other:
        sys.exit(f"dev.py: {', '.join(other)}: not what web/ builds; run `python3 dev.py page` and commit it")
    print("The page is what web/ builds.")


def browser(_: list[str]) -> None:
    """A Chromium (Debian's, unless there is one) and playwright-core, which drives it."""
    npm()
    if any(shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome")):
        return
    if shutil.which("apt-get") is None:
        sys.exit("dev.py: no Chromium on the PATH; install one and try again")
    prefix = [] if os.geteuid() == 0 else ["sudo"]
    run(*prefix, "apt-get", "update")
    run(*prefix, "apt-get", "install", "--yes", "--no-install-recommends", "chromium")


def lock(options: list[str]) -> None:
    """Pin every dependency with its hash, for all platforms; what is pinned stays while it fits."""
    install("requirements-uv.lock")
    kept = {path: path.read_bytes() for path in sorted(ROOT.glob("requirements-*.lock"))}
    common = ["--universal", "--generate-hashes", "--quiet"]
    common += ["--custom-compile-command", "python3 dev.py lock"]
    common += ["--upgrade"] if "--upgrade" in options else []
    for name, what in LOCKS.items():
        # One .venv serves them all.
        pins = [] if name in ("dev", "uv") else ["--constraints", "requirements-dev.lock"]
        run(BIN / "uv", "pip", "compile", *what, *pins, *common, "-o", f"requirements-{name}.lock")
    if "--check" in options:
        other = [path for path, text in kept.items() if path.read_bytes() != text]
        for path in other:
            path.write_bytes(kept[path])
        if other:
            names = ", ".join(path.name for path in other)
            sys.exit(f"dev.py: {names}: pyproject.toml asks for something else; run `python3 dev.py lock`")
        print("The lock files are what pyproject.toml asks for.")


def main() -> None:
    """Dispatch on the first word."""
    commands = {"demo": demo, "test": test, "lint": lint, "check": check, "bench": bench}
    commands |= {"setup": lambda _: setup(), "wheel": wheel, "lock": lock, "page": page, "browser": browser}
    commands |= {"docs": docs, "orders": orders, "firmware": firmware}
    if sys.version_info < (3, 11):  # noqa: UP036 - an older one can start this script
        sys.exit("dev.py: needs Python 3.11 or newer; this is " + sys.version.split()[0])
    if len(sys.argv) < 2 or sys.argv[1] not in commands:
        sys.exit(__doc__)
    commands[sys.argv[1]](sys.argv[2:])


if __name__ == "__main__":
    main()
