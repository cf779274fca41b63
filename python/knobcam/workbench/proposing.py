"""The answers about laws for what no effect explains: looked for, held against the samples, taken."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from starlette.concurrency import run_in_threadpool

from ..base.said import Said
from ..errors import InputError
from ..fit import refit
from ..learn.proposing import accepted
from ..model.own import forget_effect
from ..model.own_law import free_name, guesses
from ..model.sliding import written
from ..show.values import with_doubt
from ..show.words import unit_word
from . import arrays, formulas
from .adding import story
from .answers import answered, bytes_answer, finished
from .bodies import read_json, text, whole
from .jobs import Cancelled

if TYPE_CHECKING:
    from collections.abc import Mapping

    from starlette.requests import Request
    from starlette.responses import Response

    from ..base import pages, pages_said
    from ..base.arrays import FloatArray
    from ..base.pages_left import Curve
    from ..fit import Estimate, Fit
    from ..learn.proposals import Proposal, Proposals
    from .bench import Bench
    from .jobs import Job
    from .session import Session
    from .tell import Tell
    from .tree import Node

_MOST = 99
_LATEST_MS = 2**53  # of a clock in JavaScript


class Proposing:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self._typed_ms = 0  # when the newest formula was typed, which may not be the last that came
        self.gets = {"law": self.law}
        self.posts = {
            "propose": self.propose,
            "accept": self.accept,
            "formula": self.formula,
            "typed": self.attempt,
        }

    async def propose(self, _: Request) -> Response:
        """Look for laws of what is left where the branch is."""
        session = self.bench.session
        await finished(self.bench.work.start("looking for a law", lambda job: looked_for(session, job.tell)))
        return answered(session)

    async def law(self, request: Request) -> Response:
        """What a law would explain of a capture's residual."""
        asked, session = request.query_params, self.bench.session
        view = session.view_of(asked.get("node", ""))
        at = session.place(view, asked.get("capture", ""))
        if asked.get("number") == "typed":
            if session.tried is None or session.tried[0] != view.node.id:
                raise InputError("no formula was tried here; type one first")
            model = session.tried[1].model
            return bytes_answer(await run_in_threadpool(arrays.explained, "formula", model, view, at))
        found = proposals_of(session, view.node)
        number = int(asked["number"]) if asked.get("number", "").isdecimal() else 0
        if not 1 <= number <= len(found.laws):
            raise InputError(f"number: give one from 1 to {len(found.laws)}")
        model = found.laws[number - 1].fit.model
        return bytes_answer(await run_in_threadpool(arrays.explained, f"law {number}", model, view, at))

    async def accept(self, request: Request) -> Response:
        """Take a law into the model, as an effect of this name."""
        body = await read_json(request)
        number, name = whole(body, "number", 1, 1, _MOST), text(body, "name", "").strip()
        session = self.bench.session

        def work(job: Job) -> None:
            taken(session, number, name, job.tell)

        await finished(self.bench.work.start(f"taking law {number}", work))
        await run_in_threadpool(self.bench.flush)
        return answered(session)

    async def attempt(self, request: Request) -> Response:
        """Fit a formula on the side while it is typed; one that was typed before is given up.

        What is no formula yet is no wrong request: what it lacks is the answer.
        """
        body = await read_json(request)
        law, guess, session = text(body, "law").strip(), text(body, "guess", ""), self.bench.session
        at_ms = whole(body, "typed_ms", self._typed_ms, 0, _LATEST_MS)
        if at_ms < self._typed_ms:
            return answered(session, unfinished=str(Cancelled()))
        self._typed_ms = at_ms
        self.bench.trying.cancel()
        try:
            start = guesses(guess.replace(",", " ").split(), "start")
            job = self.bench.trying.start("trying", lambda job: tried(session, law, start, job.tell))
            return answered(session, tried=await finished(job))
        except InputError as error:
            return answered(session, unfinished=str(error))

    async def formula(self, request: Request) -> Response:
        """Take a formula of the user's own into the model, as an effect of this name."""
        body = await read_json(request)
        law, name = text(body, "law").strip(), text(body, "name", "").strip()
        start = guesses(text(body, "guess", "").replace(",", " ").split(), "start")
        session = self.bench.session

        def work(job: Job) -> None:
            typed(session, law, name, start, job.tell)

        await finished(self.bench.work.start("fitting a formula", work))
        await run_in_threadpool(self.bench.flush)
        return answered(session)


def looked_for(session: Session, tell: Tell) -> None:
    """Look for laws of what is left where the branch is, unless that was done."""
    node = session.node
    if node.id in session.proposals:
        return
    found_here = story(session, tell)
    doing = "looking for a law"
    tell(doing)
    found = found_here.propose(lambda share: tell(doing, share))
    tell("putting the laws in place", last=True)
    with session.lock:
        session.proposals[node.id] = found
        session.touched()


def taken(session: Session, number: int, name: str, tell: Tell) -> None:
    """Take a law into the model as an effect of this name, by default the first that is free.

    What the law was found to make needless goes. Raises InputError for a number that none has, for a name
    that is taken, and where no laws were looked for.
    """
    node = session.node
    found = proposals_of(session, node)
    tell("fitting the law")
    name, richer = accepted(found, number, name or None)
    try:
        for effect in [one for one in node.fit.model.effects if one not in richer.model.effects]:
            session.drop(effect, tell)
        tell(f"putting {name} in place", last=True)
        session.accept(name, richer, found.p_value)
    except BaseException:
        forget_effect(name)
        raise


def typed(session: Session, law: str, name: str, start: Mapping[str, float], tell: Tell) -> None:
    """Take a formula into the model as an effect of this name, by default the first that is free.

    `start` is where its parameters start. Raises InputError for what is no formula, by the character, for a
    name that is taken, and for a formula that cannot be fitted.
    """
    node = session.node
    model = node.fit.model
    name = name or free_name(model)
    # A formula that was undone may come again, and otherwise: each model carries its own.
    undone = {one for other in session.branch.steps for one in other.fit.model.laws}
    if name in model.effects or name in {*model.catalogue()} - undone:
        raise InputError(f"name {name}: is an effect already; choose another name")
    formulas.register(name, law, model.coordinate)
    try:
        doing = f"fitting {name}"
        tell(doing)
        richer = refit.add(node.fit, name, lambda share: tell(doing, share), start)
        tell(f"putting {name} in place", last=True)
        session.accept(name, richer, math.nan)
    except BaseException:
        forget_effect(name)
        raise


def tried(session: Session, law: str, start: Mapping[str, float], tell: Tell) -> pages.Law:
    """Fit a formula that is still typed, beside the model, and return what it would leave.

    Raises InputError for what is no formula yet, and for one that cannot be fitted.
    """
    node, name = session.node, session.new("typed")
    formulas.register(name, law, node.fit.model.coordinate)
    try:
        doing = "trying a formula"
        richer = refit.add(node.fit, name, lambda share: tell(doing, share), start)
    finally:
        forget_effect(name)
    tell(doing, last=True)
    session.tried = (node.id, richer)
    own = {
        param.removeprefix(f"{name}."): e
        for param, e in richer.params.items()
        if param.startswith(f"{name}.")
    }
    return {
        "label": law,
        "law": law,
        "fall": 1.0 - richer.rmse / node.fit.rmse,
        "rmse": richer.rmse,
        "rmse_heldout": richer.rmse_heldout,
        "variables": [],
        "words": _in_words(own),
        "doubt": doubt_of(own),
        "start": " ".join(f"{param}={e.value:.5g}" for param, e in own.items()),
    }


def proposals_of(session: Session, node: Node) -> Proposals:
    """Return the laws of a node. Raises InputError where none were looked for."""
    if node.id not in session.proposals:
        raise InputError("no laws were looked for here; ask for them first")
    return session.proposals[node.id]


def document(found: Proposals | None) -> list[pages.Law] | None:
    """Return what a page is told of laws, the one first for which most speaks; None: not looked for."""
    if found is None:
        return None
    return [_law(one, one in found.front, found.beside) for one in found.laws]


def headline(found: Proposals | None) -> list[pages_said.Part]:
    """Return the same in one sentence, with the first of them as law 1; nothing where none were sought."""
    if found is None:
        return []
    parts = found.headline.parts
    for first in found.laws[:1]:
        parts = tuple(one.replace(first.label, "law 1") if isinstance(one, str) else one for one in parts)
    return Said(*parts).document()


def curve(found: Proposals | None) -> Curve | None:
    """Return what is left as a curve with the laws on it; None where it is none, or was not looked for."""
    drawn = None if found is None else found.curve
    if found is None or drawn is None:
        return None

    def told(values: FloatArray) -> list[float | None]:
        return [float(one) if known else None for one, known in zip(values, drawn.known, strict=True)]

    laws = [drawn.laws.get(one.law) for one in found.laws]
    return {
        "over": drawn.over,
        "times": drawn.times,
        "x": drawn.x.tolist(),
        "value": told(drawn.value),
        "band": told(drawn.band),
        "laws": [None if one is None else told(one) for one in laws],
    }


def _in_words(params: Mapping[str, Estimate]) -> list[str]:
    """Values with half their 95 % interval, as the parameters of the model have them."""
    words = (
        f"{name} = {with_doubt(e)} {unit_word(e.unit)}".strip() if e.determined else f"{name} not determined"
        for name, e in params.items()
    )
    return [f"{one} (fixed)" if e.held else one for one, e in zip(words, params.values(), strict=True)]


def doubt_of(params: Mapping[str, Estimate]) -> str:
    """Which values nobody knows, and which may be nothing as well, so that the law has a part too many."""
    told = {name: one for name, one in params.items() if not one.held}
    unknown = [name for name, one in told.items() if not one.determined]
    nothing = [name for name, one in told.items() if one.determined and one.ci95[0] <= 0.0 <= one.ci95[1]]
    words = [f"not determined: {', '.join(unknown)}"] if unknown else []
    words += [f"may be nothing as well: {', '.join(nothing)}"] if nothing else []
    return "; ".join(words)


def _law(one: Proposal, front: bool, beside: Fit) -> pages.Law:
    coordinate = beside.model.coordinate
    # The numbers of splines say nothing to anybody: what they make is drawn.
    words = _in_words(one.params) if one.unseen is None else []
    words += ["no shorter law is as good"] if front else []
    return {
        "label": written(one.label, coordinate),
        "law": written(one.law, coordinate),
        "fall": 1.0 - one.rmse / beside.rmse,
        "rmse": one.rmse,
        "rmse_heldout": one.rmse_heldout,
        "variables": list(one.variables),
        "words": words,
        "doubt": doubt_of(one.params) if one.unseen is None else "",
        "start": one.guess,
    }
