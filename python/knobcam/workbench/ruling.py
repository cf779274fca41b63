"""Findings of a capture that a person overrules: it is read again, and the model fitted to that."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.reading import digest
from ..capture import load
from ..capture.quality.ruled import with_later
from ..errors import InputError
from ..fit.described import by_model

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ..base import pages
    from ..capture.finding import Finding
    from ..fit import Fit
    from .session import Session
    from .tell import Tell
    from .tree import Opened

_SIGN = "it says what the model cannot be: turn the sign of the torque in the map"
_SAVED = "it was overruled before the capture was saved"


def overrule(
    session: Session, capture: str, finding: str, on: bool, find: Callable[[Opened], Path], tell: Tell
) -> str:
    """Overrule a finding of a capture by its key, or let it stand again, and return the id of what was read.

    That takes the place of the capture in the model's fit; going back finds the one that was. What is decided
    is an option of `knobcam.load`, with which the session, its script and its journal go on. `find` says
    where the file of a capture lies. Raises InputError for a finding that is not there, and for a file that
    is gone or another by now.
    """
    if capture not in session.captures:
        raise InputError(f"capture {capture!r} is not in this session")
    old = session.captures[capture]
    keys = [one.key for one in old.capture.findings if one.overruled and one.key != finding]
    options = {**old.options, "overrule": [*keys, finding] if on else keys}
    tell(f"reading {old.name}")
    path = find(old)
    if old.sha256 and digest(path) != old.sha256:
        raise InputError(f"{old.name}: has changed since it was read; put back what it was, or open it anew")
    read = load(path, **options)
    read = replace(read, meta={**read.meta, "source": old.capture.meta.get("source", old.name)})
    new = replace(old, id=session.new("c"), capture=read, options=options, of=old.of or old.id, closed=False)
    with session.lock:
        session.captures[new.id] = new
    fitted = session.node.captures
    if capture in fitted:
        try:
            session.use([new.id if one == capture else one for one in fitted], tell)
        except BaseException:
            del session.captures[new.id]
            raise
    else:
        session.touched()
    return new.id


def found(opened: Opened, fit: Fit | None, at: int) -> tuple[Finding, ...]:
    """Return what was found in a capture, and on the way from it to a fit in whose `prepared` it is `at`.

    What a fit says of all its captures is said of the first.
    """
    if fit is None:
        return opened.capture.findings
    return with_later(fit.prepared[at].findings, by_model(fit) if at == 0 else ())


def document(opened: Opened, fit: Fit | None = None, at: int = 0) -> list[pages.Finding]:
    """Return what was found in a capture, and by a fit to it, as a page is told it."""
    told = opened.options.get("overrule", ())
    return [
        {
            "key": one.key,
            "said": one.told.document(),
            "advice": one.advice.document() if one.advice and not one.overruled else None,
            "severity": one.severity,
            "overruled": one.overruled,
            "stands": _SAVED if one.overruled and one.key not in told else _stands(one),
            "seen": bool(opened.capture.where(one)),
        }
        for one in found(opened, fit, at)
    ]


def _stands(finding: Finding) -> str:
    return _SIGN if finding.kind == "sign" else finding.stands


def samples(session: Session, capture: str, finding: str) -> list[tuple[int, int]]:
    """Return the samples that a finding names, first and last of each run, from 0."""
    if capture not in session.captures:
        raise InputError(f"capture {capture!r} is not in this session")
    opened, node = session.captures[capture], session.node
    fitted = capture in node.captures
    told = found(opened, node.fit, node.captures.index(capture)) if fitted else opened.capture.findings
    named = [one for one in told if one.key == finding]
    if not named:
        raise InputError(f"finding {finding!r} is not among those of {opened.name}")
    return sorted({span for one in named for span in opened.capture.where(one)})
