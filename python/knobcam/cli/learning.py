"""`knobcam diagnose`, `knobcam add` and `knobcam learn`: which effect is missing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from . import arguments
from .fitting import answer, kept, put, said
from .output import Unfinished, about, check_file, check_folder, check_kind, status

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from ..fit import Fit
    from ..learn import LearningResult
    from ..model import Model
    from .output import Answer


def register(commands: arguments.Commands) -> None:
    """Add the commands of this file."""
    parser = arguments.add_command(
        commands, "diagnose", run_diagnose, "Rank the effects that could be missing from a model."
    )
    arguments.add_captures_and_model(parser, "what the model is fitted to", "the base model")
    arguments.add_plots(parser)
    _shared(parser)

    parser = arguments.add_command(
        commands, "add", run_add, "Fit a model again with one effect more, and say what that changed."
    )
    parser.add_argument("effect", metavar="EFFECT", help="id from `knobcam effects`; none with --law")
    parser.add_argument(
        "--law",
        metavar="FORMULA",
        help="in place of EFFECT: one of your own, a torque such as 'a tanh(omega/w)'; the model carries it",
    )
    parser.add_argument("--name", metavar="NAME", help="with --law: of the effect; default law, law_2, ...")
    parser.add_argument(
        "--acts",
        choices=("load", "friction", "sensor"),
        help="with --law: a torque (load, the default), a factor on dry friction, or what the sensor adds",
    )
    parser.add_argument(
        "--units",
        nargs="+",
        action="extend",
        type=arguments.assignment,
        metavar="PARAMETER=UNIT",
        help="with --law: units that do not follow from it, as 'k=N m/rad'",
    )
    parser.add_argument(
        "--guess",
        nargs="+",
        action="extend",
        type=arguments.assignment,
        metavar="PARAMETER=VALUE",
        help="with --law: where its parameters start, as 'f=50'; default a few sizes by the motion",
    )
    parser.instead = ("law", "effect")
    arguments.add_captures_and_model(parser, "what the model is fitted to")
    arguments.add_output(parser, "model")
    arguments.add_plots(parser)
    arguments.add_preparation(parser)
    arguments.add_reading(parser)

    parser = arguments.add_command(
        commands, "learn", run_learn, "Add what is missing until the rest is chance, or unexplained."
    )
    arguments.add_captures(parser, "several are of one knob", "*")
    parser.add_argument("--model", metavar="MODEL", help="to start from; default the base")
    parser.add_argument("--report", type=Path, metavar="FILE.html", help="report to write, in one file")
    parser.add_argument(
        "--budget-s",
        type=arguments.number,
        metavar="SECONDS",
        help="time for the search, which is then cut short",
    )
    parser.add_argument(
        "--propose", action="store_true", help="laws for what no effect explains, from a grammar of mechanics"
    )
    parser.add_argument(
        "--accept", type=arguments.whole, metavar="N", help="with --propose: take the Nth law into the model"
    )
    arguments.add_output(parser, "model")
    arguments.add_plots(parser)
    _shared(parser)
    group = parser.add_argument_group("in place of captures")
    group.add_argument("--port", help="record from the rig behind this port, learn, and record again")
    group.add_argument(
        "--experiments", type=arguments.whole, metavar="N", help="with --port: further motions; default 1"
    )
    group.add_argument(
        "--records", type=Path, metavar="FOLDER", help="with --port: of the recordings; default experiments"
    )
    group.add_argument("--limits", metavar="FILE", help="with --port: of the motions, as of `next`")
    arguments.add_fault(group)


def _shared(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--without", nargs="+", action="extend", default=[], metavar="EFFECT", help="not to be weighed"
    )
    arguments.add_preparation(parser)
    arguments.add_reading(parser)


def _check_without(args: Namespace) -> None:
    from ..fit.diagnose import check_effects

    # The ids are those of either axis.
    check_effects("--without", args.without, "rotary")


def run_diagnose(args: Namespace) -> Answer:
    """Fit a model, weigh every absent effect, rank them."""
    check_folder(args.plots)
    options = arguments.preparation(args)
    model = _model(args.model)
    _check_without(args)
    fitted = _fitted(args, model, options)

    from ..fit.diagnose import diagnose

    status("weighing every effect of the catalogue")
    diagnosis = diagnose(fitted, without=args.without)
    files: dict[str, object] = {}
    if args.plots is not None:
        pictures = {"diagnosis": diagnosis.plot, "comparison": diagnosis.comparison.plot}
        files["pictures"] = put(args, pictures)
    text = "\n".join([repr(diagnosis), *said(files)])
    return answer(args, text, diagnosis.document() | {"files": files}, fitted)


def run_add(args: Namespace) -> Answer:
    """Fit a model, add an effect, fit again."""
    for option in ("name", "acts", "units", "guess"):
        if getattr(args, option) is not None and args.law is None:
            raise InputError(f"--{option}: is of --law, which is not given; add it, or leave --{option} out")
    check_file(args.output, [*args.captures, args.model])
    check_folder(args.plots, args.output)
    options = arguments.preparation(args)

    from ..fit import refit
    from ..model import Model
    from ..model.own_law import guesses

    guess = guesses(args.guess or (), "--guess")

    model = Model.load(args.model)
    effect = args.effect if args.law is None else _law(args, model)
    refit.check(effect, model)
    fitted = refit.add(_fitted(args, model, options), effect, start=guess)
    files = kept(args, fitted)
    text = "\n".join([repr(fitted), *said(files)])
    return answer(args, text, refit.document(fitted) | {"files": files}, fitted)


def _law(args: Namespace, model: Model) -> str:
    """Register the law of the command line, and return its name."""
    from ..model.own_law import free_name, own_law

    name = args.name if args.name is not None else free_name(model)
    if name in {*model.catalogue(), *model.effects}:
        raise InputError(f"--name {name}: is an effect already; choose another name")
    units = dict(one.split("=", 1) for one in args.units or ())
    own_law(name, args.law, acts=args.acts or "load", units=units)
    return str(name)


def run_learn(args: Namespace) -> Answer:
    """Learn what is missing from a model of one or several captures of a knob."""
    _check_source(args)
    inputs = [*args.captures, *([args.model] if args.model else [])]
    check_file(args.output, inputs)
    check_file(args.report, inputs)
    check_kind(args.report, "a report", ".html", ".htm")
    if (
        args.report is not None
        and args.output is not None
        and args.report.absolute() == args.output.absolute()
    ):
        raise InputError(f"{args.report}: cannot be the report and the model; choose two names")
    check_folder(args.plots, args.output)
    check_folder(args.plots, args.report)
    options = arguments.preparation(args)
    model = _model(args.model)
    _check_without(args)

    if args.port is not None:
        return _experimented(args, model, options)

    from ..learn import Interrupted, learn
    from ..learn.showing_more import along

    captures = arguments.read_all(args)
    options |= {"budget_s": args.budget_s}
    with about(*args.captures):
        try:
            learned = learn(
                captures, model, without=args.without, prepare=args.prepare, progress=status, **options
            )
        except Interrupted as interrupted:
            so_far = interrupted.so_far
            raise Unfinished(
                answer(args, repr(so_far), so_far.document() | {"files": {}}, so_far.fit)
            ) from None
    said_more, document = [], {}
    pictures = {}
    if args.propose:
        status("looking for laws of what is left")
        proposals = learned.propose()
        said_more = [repr(proposals)]
        document = {
            "proposals": [one.document() for one in proposals.laws],
            "needs": [one._asdict() for one in proposals.needs],
        }
        if proposals.laws:
            pictures = {"proposals": proposals.plot}
        if args.accept is not None:
            learned = learned.accept(proposals, args.accept)
    elif learned.verdict == "unexplained" and learned.cut is None:
        said_more = ["Formulas that would explain it, beside all names: the same with --propose."]
        if along(learned) is not None:
            said_more += ["A motion for that, within limits: `knobcam next` with the same captures."]
    files = write(args, learned)
    if args.plots is not None and pictures:
        files["proposals"] = put(args, pictures)
    text = "\n".join([repr(learned), *said_more, *said(files)])
    return answer(args, text, learned.document() | document | {"files": files}, learned.fit)


def _check_source(args: Namespace) -> None:
    """Refuse a call without captures and without a rig, or with both."""
    if args.accept is not None and not args.propose:
        raise InputError("--accept: is of --propose, which is not given; add it, or leave --accept out")
    if args.propose and args.port is not None:
        raise InputError("--propose: is for captures; record first, then learn from the files")
    given = [name for name in ("experiments", "records", "limits") if getattr(args, name) is not None]
    if args.port is None and (given or args.clear_fault):
        name = given[0] if given else "clear-fault"
        raise InputError(f"--{name}: is for what is recorded; name the rig with --port")
    if bool(args.captures) == (args.port is not None):
        raise InputError("CAPTURE: name captures, or --port to record them; one of both")


def _experimented(args: Namespace, model: Model | None, options: dict[str, Any]) -> Answer:
    """Record, learn, and record what would tell more."""
    from ..rig.experiments import experiments

    done = experiments(
        args.port,
        1 if args.experiments is None else args.experiments,
        args.records or Path("experiments"),
        limits=args.limits,
        clear_fault=arguments.clear_fault(args),
        progress=status,
        model=model,
        without=args.without,
        prepare=args.prepare,
        budget_s=args.budget_s,
        **options,
    )
    args.captures = [str(log) for log in done.logs]
    files = write(args, done.learned)
    text = "\n".join([repr(done), *said(files)])
    return answer(args, text, done.document() | {"files": files}, done.learned.fit)


def write(args: Namespace, learned: LearningResult) -> dict[str, object]:
    """Write what was asked for of what was learned, all or nothing, and return the paths."""
    from ..base.writing import together

    files: dict[str, object] = {}
    with together():
        if args.output is not None:
            files["model"] = str(learned.model.save(args.output))
        if args.plots is not None:
            from ..show import plot

            status("drawing")
            drawn = plot.save_learning(learned, args.plots, kind=args.format)
            files["pictures"] = [str(path) for path in drawn]
        if args.report is not None:
            status("writing the report")
            files["report"] = str(learned.report(args.report))
    return files


def _model(path: str | None) -> Model | None:
    from ..model import Model

    return Model.load(path) if path else None


def _fitted(args: Namespace, model: Model | None, options: dict[str, Any]) -> Fit:
    from ..fit import fit

    captures = arguments.read_all(args)
    status("fitting")
    with about(*args.captures):
        return fit(captures, model, prepare=args.prepare, **options)
