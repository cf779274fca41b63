"""The `knobcam` command as a test calls it."""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

from knobcam import cli


class Ended(NamedTuple):
    """How a command ended: exit code and what was on the two streams."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """Standard output, which must be one strict JSON document."""

        def refuse(constant: str) -> float:
            raise ValueError(f"{constant} is not JSON")

        document = json.loads(self.out, parse_constant=refuse)
        assert isinstance(document, dict)
        return document


def knobcam(*argv: str | Path) -> Ended:
    """Run the command in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main([str(word) for word in argv])
    return Ended(code, out.getvalue(), err.getvalue())


def process(*argv: str | Path, cwd: Path | None = None, **variables: str) -> Ended:
    """Run the command in a process of its own, with warnings as errors."""
    words = [sys.executable, "-W", "error", "-m", "knobcam", *map(str, argv)]
    here = {"PYTHONPATH": str(Path(cli.__file__).parents[2])}  # the package that this process tests
    env = {**os.environ, **here, **variables}
    ended = subprocess.run(words, capture_output=True, text=True, cwd=cwd, env=env, check=False)
    return Ended(ended.returncode, ended.stdout, ended.stderr)


def refused(ended: Ended, *words: str) -> None:
    """Assert exit code 2, one line on standard error that holds the words, nothing on standard output."""
    assert ended.code == 2, ended
    assert ended.out == ""
    assert ended.err.startswith("knobcam: ") and ended.err.count("\n") == 1 and ended.err.endswith("\n"), (
        ended.err
    )
    for word in words:
        assert word in ended.err, f"{word!r} is not in {ended.err!r}"
