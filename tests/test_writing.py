"""Files appear whole or not at all, where they belong, and never over what is to be kept.

Devices are made or only linked to here: nothing in /dev is ever a target that could be replaced.
"""

from __future__ import annotations

import os
import re
import resource
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam import cli
from knobcam.base import writing
from knobcam.base.reading import open_file
from knobcam.base.writing import RECORDING, make_folder, together, write
from knobcam.errors import InputError

pytestmark = pytest.mark.skipif(os.name != "posix", reason="modes, links and devices are those of POSIX")
SIMULATE = ("simulate", "knob3", "--duration", "0.5", "-o")


_GUARDED = ("os.rename", "os.remove", "os.link", "os.chmod", "os.chown", "shutil.move")


def _hands_off(event: str, args: tuple[object, ...]) -> None:
    """Whatever goes wrong in a test, and whoever runs it: no device of this machine is replaced."""
    if event in _GUARDED and any(str(arg).startswith("/dev/") for arg in args):
        raise RuntimeError(f"{event} of a device: {args}")


sys.addaudithook(_hands_off)


def names(folder: Path) -> list[str]:
    """Everything in a folder, temporaries too."""
    return sorted(path.name for path in folder.iterdir())


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def fails(error: BaseException) -> Callable[[object], None]:
    def fill(_: object) -> None:
        raise error

    return fill


def test_a_link_is_followed_to_its_target_also_to_one_that_is_not_there_yet(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    link = tmp_path / "link.txt"
    link.symlink_to("deep/real.txt")
    for text in ("first", "second"):
        assert write(link, text) == link
        assert link.is_symlink() and (tmp_path / "deep" / "real.txt").read_text() == text
    assert names(tmp_path / "deep") == ["real.txt"]


def test_a_link_that_leads_in_a_circle_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / "a", "text")


@pytest.mark.parametrize("kept", [0o600, 0o640, 0o666])
def test_the_mode_of_a_file_is_kept(kept: int, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text("old")
    path.chmod(kept)
    kc.Model.load("knob3").save(path)
    assert mode(path) == kept and path.read_text() != "old"


def test_a_new_file_has_the_mode_of_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write(tmp_path / "new", "text")
    finally:
        os.umask(before)
    assert mode(tmp_path / "new") == 0o640


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
def test_the_owner_of_a_file_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "theirs"
    path.write_text("old")
    os.chown(path, 12345, 23456)
    path.chmod(0o640)
    write(path, "new")
    assert (path.stat().st_uid, path.stat().st_gid, mode(path)) == (12345, 23456, 0o640)


def test_a_read_only_file_is_refused_to_the_superuser_too(tmp_path: Path) -> None:
    path = tmp_path / "kept.npz"
    path.write_bytes(b"old")
    path.chmod(0o444)
    refused(knobcam(*SIMULATE, path), "kept.npz", "read-only", "0444")
    assert path.read_bytes() == b"old" and names(tmp_path) == ["kept.npz"]


def test_a_fifo_is_written_through_and_stays_one(tmp_path: Path) -> None:
    pipe, whole = tmp_path / "pipe", tmp_path / "whole.npz"
    os.mkfifo(pipe)
    heard: list[bytes] = []
    reader = threading.Thread(target=lambda: heard.append(pipe.read_bytes()))
    reader.start()
    while True:  # the reader opens it when it comes to that
        ended = knobcam(*SIMULATE, pipe)
        if ended.code == 0:
            break
        refused(ended, "nobody reads")
    reader.join(10.0)
    assert knobcam(*SIMULATE, whole).code == 0
    assert heard == [whole.read_bytes()] and stat.S_ISFIFO(pipe.stat().st_mode)


def test_a_fifo_that_nobody_reads_does_not_let_a_command_wait(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    refused(knobcam(*SIMULATE, tmp_path / "pipe"), "pipe", "nobody reads")


def test_a_link_to_a_device_stays_one_and_the_device_too(tmp_path: Path) -> None:
    full, null = tmp_path / "full.npz", tmp_path / "null.npz"
    full.symlink_to("/dev/full")
    null.symlink_to("/dev/null")
    before = Path("/dev/null").stat()
    refused(knobcam(*SIMULATE, full), "full.npz", "No space")
    assert knobcam(*SIMULATE, null).code == 0
    assert full.is_symlink() and null.is_symlink() and stat.S_ISCHR(before.st_mode)
    assert Path("/dev/null").stat().st_rdev == before.st_rdev


def test_a_socket_is_refused(tmp_path: Path) -> None:
    import socket

    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(tmp_path / "s"))
        refused(knobcam(*SIMULATE, tmp_path / "s"), "a socket")


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.npz"
    kc.simulate("knob4", "sweep", duration_s=3.0).save(path)
    return path


def test_a_recording_is_protected_from_every_command(small: Path, tmp_path: Path) -> None:
    disguised, plain = tmp_path / "recording.npz", tmp_path / "run.kcwire"
    link = tmp_path / "link.npz"
    link.symlink_to(disguised.name)
    for path in (disguised, plain):
        path.write_bytes(RECORDING + b"{}\n")
    for path in (disguised, plain, link, tmp_path / "new.kcwire"):
        refused(knobcam(*SIMULATE, path), path.name, "recording")
        refused(knobcam("fit", small, "-o", path), path.name, "recording")
        refused(knobcam("learn", small, "--report", path), path.name, "recording")
        refused(knobcam("import", small, "-o", path), path.name, "recording")
        refused(knobcam("convert", "knob3", "--kt", "1", "-o", path), path.name, "recording")
    assert disguised.read_bytes() == plain.read_bytes() == RECORDING + b"{}\n"


def test_a_demonstration_keeps_the_recording_of_another_rig(tmp_path: Path) -> None:
    log = tmp_path / "capture.kcwire"
    log.write_bytes(RECORDING + b'{"schema": "knobcam.wirelog/1"}\n')
    refused(knobcam("demo", "-o", tmp_path), "capture.kcwire", "recording")
    assert names(tmp_path) == ["capture.kcwire"]


def test_threads_that_write_one_file_leave_one_of_theirs(tmp_path: Path) -> None:
    capture, path = kc.simulate("knob3", duration_s=0.5), tmp_path / "one.npz"
    failures: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(20):
                capture.save(path)
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == [] and names(tmp_path) == ["one.npz"]
    assert kc.load(path).samples == capture.samples


def test_a_temporary_is_never_opened_through_what_somebody_put_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    victim = tmp_path / "victim"
    victim.write_text("kept")
    monkeypatch.setattr(writing.os, "urandom", bytes)
    (tmp_path / f".knobcam-{bytes(8).hex()}.part").symlink_to(victim)
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / "new", "text")
    assert victim.read_text() == "kept"


def test_what_belongs_together_appears_together_or_not_at_all(tmp_path: Path) -> None:
    old, new, folder = tmp_path / "old", tmp_path / "new", tmp_path / "pictures"
    old.write_text("before")
    for error in (InputError("no"), KeyboardInterrupt(), OSError(28, "No space left on device")):
        with pytest.raises(type(error) if not isinstance(error, OSError) else InputError), together():
            write(old, "after")
            write(make_folder(folder) / "one.png", b"picture")
            write(new, fails(error))
        assert old.read_text() == "before" and names(tmp_path) == ["old"]
    with together():
        write(old, "after")
        write(new, "text")
        assert old.read_text() == "before" and not new.exists()
    assert (old.read_text(), new.read_text(), names(tmp_path)) == ("after", "text", ["new", "old"])


def test_what_has_its_place_already_goes_back_where_another_cannot_have_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_text("before")
    replace = Path.replace

    def failing(part: Path, target: Path) -> Path:
        if target == second:
            raise OSError(5, "Input/output error")
        return replace(part, target)

    monkeypatch.setattr(Path, "replace", failing)
    with pytest.raises(InputError, match="second: cannot be written"), together():
        write(first, "after")
        write(second, "text")
    assert first.read_text() == "before" and names(tmp_path) == ["first"]


def test_one_file_for_two_things_is_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("one")
    with pytest.raises(InputError, match="written twice"), together():
        write(tmp_path / "one", "a")
        write(tmp_path / "link", "b")
    assert names(tmp_path) == ["link"]


def test_a_report_on_a_full_disk_leaves_no_model_either(small: Path, tmp_path: Path) -> None:
    report, model = tmp_path / "full.html", tmp_path / "m.toml"
    report.symlink_to("/dev/full")
    refused(knobcam("learn", small, "-o", model, "--report", report), "full.html", "No space")
    assert names(tmp_path) == ["full.html", "small.npz"]


def small_files(argv: list[str], limit: int, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the command where no file may be longer than a limit, as on a disk that fills."""
    words = [sys.executable, "-m", "knobcam", *argv]
    env = {**os.environ, "PYTHONPATH": str(Path(cli.__file__).parents[2])}

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.run(
        words, capture_output=True, text=True, cwd=cwd, env=env, preexec_fn=limited, check=False
    )


@pytest.mark.parametrize("name", ["a.npz", "a.csv", "a.csv.gz", "a.parquet", "a.mat", "a.h5"])
def test_a_capture_on_a_disk_that_fills_keeps_the_old_file(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(b"old")
    ended = small_files([*SIMULATE, name], 20_000, tmp_path)
    assert (ended.returncode, ended.stdout) == (2, "") and ended.stderr.count("\n") == 1, ended.stderr
    assert name in ended.stderr and "File too large" in ended.stderr
    assert (tmp_path / name).read_bytes() == b"old" and names(tmp_path) == [name]


def test_a_picture_on_a_disk_that_fills_keeps_the_old_one(tmp_path: Path) -> None:
    (tmp_path / "e.png").write_bytes(b"old")
    ended = small_files(["effects", "detent", "-o", "e.png", "--plots", "all"], 20_000, tmp_path)
    assert ended.returncode == 2 and ended.stderr.count("\n") == 1, ended.stderr
    assert (tmp_path / "e.png").read_bytes() == b"old" and names(tmp_path) == ["e.png"]


def test_a_picture_has_the_format_of_its_name(tmp_path: Path) -> None:
    figure = kc.effects()["coulomb"].plot()
    for name, head in (("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")):
        figure.savefig(tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(head)
    figure.savefig(tmp_path / "plain")
    assert (tmp_path / "plain.png").is_file()


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_whoever_ends_a_command_its_temporaries_go(number: signal.Signals, code: int, tmp_path: Path) -> None:
    script = (
        "import sys, time; from knobcam import cli; from knobcam.cli import capturing, recording\n"
        "from knobcam.base.writing import write\n"
        "def run(args):\n"
        "    def fill(file):\n"
        "        file.write(b'half'); file.flush(); print('writing', file=sys.stderr, flush=True)\n"
        "        time.sleep(60)\n"
        "    write('out', fill)\n"
        "recording.run_simulate = run\n"
        "sys.argv = ['knobcam', 'simulate', 'knob3', '-o', 'out']\n"
        "raise SystemExit(cli.main())"
    )
    env = {**os.environ, "PYTHONPATH": str(Path(cli.__file__).parents[2])}
    usual = "default_int_handler" if number == signal.SIGINT else "SIG_DFL"  # a background job ignores it
    default = f"import signal; signal.signal({int(number)}, signal.{usual})\n"
    words = [sys.executable, "-c", default + script]
    child = subprocess.Popen(words, cwd=tmp_path, env=env, stderr=subprocess.PIPE, text=True)
    assert child.stderr is not None and child.stderr.readline() == "writing\n"
    assert names(tmp_path) != []
    child.send_signal(number)
    _, said = child.communicate(timeout=30)
    how = "interrupted" if number == signal.SIGINT else f"ended by {number.name}"
    assert (child.returncode, said, names(tmp_path)) == (code, f"knobcam: {how}\n", [])


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_the_user_ignores_stays_ignored(number: signal.Signals) -> None:
    code = (
        f"import signal; signal.signal({int(number)}, signal.SIG_IGN)\n"
        "from knobcam.base.ended import by_exception\n"
        f"with by_exception(): print(signal.getsignal({int(number)}) is signal.SIG_IGN)"
    )
    env = {**os.environ, "PYTHONPATH": str(Path(cli.__file__).parents[2])}
    assert subprocess.check_output([sys.executable, "-c", code], env=env, text=True) == "True\n"


@pytest.mark.parametrize(("closed", "code"), [(1, 2), (2, 0)])
def test_a_closed_stream_is_no_traceback(closed: int, code: int) -> None:
    words = f'"{sys.executable}" -m knobcam effects {closed}>&-'
    env = {**os.environ, "PYTHONPATH": str(Path(cli.__file__).parents[2])}
    ended = subprocess.run(words, shell=True, capture_output=True, text=True, env=env, check=False)
    assert ended.returncode == code
    if code:
        assert ended.stderr == "knobcam: standard output: is closed; open it, or send it to a file\n"
    else:
        assert "coulomb" in ended.stdout and "Traceback" not in ended.stdout


def test_a_name_that_is_too_long_is_refused_in_one_line(small: Path, tmp_path: Path) -> None:
    for name in ("a" * 300, "a" * 4100, "a/" * 2100 + "b"):
        refused(knobcam(*SIMULATE, tmp_path / name), "too long" if "/" not in name else "cannot be written")
        refused(knobcam("fit", tmp_path / name), "cannot be read")
        refused(knobcam("fit", small, "--model", tmp_path / name), "cannot be read")
        refused(knobcam("fit", small, "--plots", tmp_path / name))
        refused(knobcam("effects", "coulomb", "-o", tmp_path / f"{name}.png"))
    longest = tmp_path / ("n" * 251 + ".npz")
    assert knobcam(*SIMULATE, longest).code == 0


WRITERS = ("a.npz", "a.csv", "a.parquet", "a.mat", "a.h5")


def test_a_writer_that_is_killed_leaves_the_old_file_or_the_new(tmp_path: Path) -> None:
    """A short part of `benches/study_faults.py`, with a new seed each time."""
    from study_faults import killed

    seed = int(time.time_ns() % 2**32)
    print(f"seed {seed}")
    for name in WRITERS[:2]:
        assert killed(name, 2, seed, tmp_path) == {"old or new": 2}, f"seed {seed}"


def test_only_one_module_writes() -> None:
    """Everything else goes through it, but a recorder, a session's journal and what a browser hands over."""
    own = {"base/writing.py", "rig/wirelog.py", "workbench/bodies.py", "workbench/journal.py"}
    words = re.compile(r"\.write_(text|bytes)\(|\.open\(\"[wxa]|NamedTemporaryFile\(|os\.fdopen\(.*\"[wxa]")
    package = Path(cli.__file__).parents[1]
    files = {path.relative_to(package).as_posix(): path.read_text() for path in package.rglob("*.py")}
    assert {name for name, text in files.items() if words.search(text)} == own


def test_a_file_is_closed_where_it_is_another_by_now(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="is a pipe"):
        open_file(tmp_path / "pipe")
