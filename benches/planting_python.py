"""Faults beside what they replace, in Python: `mutated if _living(17) else original`, written into a copy.

A variable of the environment says which one lives; with "all", every process notes which ones it came past,
and in which test, so that only those need to run.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from typing import NamedTuple

VARIABLE = "PLANTED"
MODULE = f'''"""Which planted fault lives in this process."""

import atexit
import json
import os

_living = os.environ.get("{VARIABLE}", "")
_passed = {{}}


def living(number):
    """Whether this one lives."""
    if _living == "all":
        _passed.setdefault(os.environ.get("{VARIABLE}_IN", ""), set()).add(number)
        return False
    return _living == str(number)


def _note():
    with open(os.path.join(os.environ["{VARIABLE}_NOTES"], f"{{os.getpid()}}.json"), "w") as file:
        json.dump({{where: sorted(numbers) for where, numbers in _passed.items()}}, file)


if _living == "all":
    atexit.register(_note)
'''
_SWAPS: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Add: (ast.Sub, ast.Mult),
    ast.Sub: (ast.Add, ast.Div),
    ast.Mult: (ast.Add, ast.Div),
    ast.Div: (ast.Mult,),
    ast.FloorDiv: (ast.Mult,),
    ast.Mod: (ast.Mult,),
    ast.Pow: (ast.Mult,),
    ast.BitAnd: (ast.BitOr,),
    ast.BitOr: (ast.BitAnd,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
}
_WORDS = {
    **{ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is"},
    **{ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in", ast.Add: "+", ast.Sub: "-", ast.Mult: "*"},
    **{ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: "**", ast.BitAnd: "&", ast.BitOr: "|"},
    **{ast.And: "and", ast.Or: "or"},
}


class Fault(NamedTuple):
    """A place in a file and what to do there."""

    file: str
    line: int
    column: int
    function: str
    what: str

    @property
    def name(self) -> str:
        """For people, as cargo-mutants says it."""
        return f"{self.file}:{self.line}:{self.column}: {self.what} in {self.function}"


def faults(file: str, source: str) -> list[Fault]:
    """Every fault that can be planted in a file."""
    planter = _Planter(file, {})
    planter.visit(ast.parse(source))
    return planter.seen


def planted(file: str, source: str, numbers: dict[str, int]) -> str:
    """The source with the faults of these names beside what they replace."""
    planter = _Planter(file, numbers)
    tree = planter.visit(ast.parse(source))
    first = next(
        at
        for at, node in enumerate(tree.body)
        if not _is_text(node) and not (isinstance(node, ast.ImportFrom) and node.module == "__future__")
    )
    tree.body.insert(first, ast.parse("from knobcam._planted import living as _living").body[0])
    return ast.unparse(ast.fix_missing_locations(tree))


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


class _Planter(ast.NodeTransformer):
    """Collects faults and plants those that it is told."""

    def __init__(self, file: str, numbers: dict[str, int]) -> None:
        self.file, self.numbers = file, numbers
        self.seen: list[Fault] = []
        self.functions: list[str] = []

    def _number(self, node: ast.AST, what: str) -> int | None:
        function = ".".join(self.functions) or "the module"
        fault = Fault(self.file, node.lineno, node.col_offset + 1, function, what)  # type: ignore[attr-defined]
        self.seen.append(fault)
        return self.numbers.get(fault.name)

    def _beside(self, node: ast.expr, mutants: list[tuple[ast.expr, str, ast.expr]]) -> ast.expr:
        """The expression, itself already visited, or one of its mutants, each said to be at a place."""
        for place, what, mutant in mutants:
            number = self._number(place, what)
            if number is not None:
                node = ast.copy_location(ast.IfExp(_call(number), mutant, node), node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        self.functions.append(node.name)
        body = node.body[1:] if _is_text(node.body[0]) else node.body
        head = node.body[: len(node.body) - len(body)]
        guards = []
        is_generator = any(isinstance(one, ast.Yield | ast.YieldFrom) for one in _own(node))
        if body and not isinstance(body[0], ast.Pass):
            values = ["None"]
            if isinstance(node.returns, ast.Name) and node.returns.id == "bool":
                values = ["True", "False"]
            for value in values:
                what = "replace the body with nothing" if is_generator else f"replace the body with {value}"
                number = self._number(node, what)
                if number is not None:
                    guards.append(ast.If(_call(number), [ast.Return(ast.parse(value, mode="eval").body)], []))
        node.args.defaults = [self.visit(one) for one in node.args.defaults]
        node.args.kw_defaults = [self.visit(one) if one else None for one in node.args.kw_defaults]
        visited = [self.visit(statement) for statement in body]
        node.body = [*head, *guards, *visited]
        self.functions.pop()
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.ClassDef:
        self.functions.append(node.name)
        node.body = [self.visit(statement) for statement in node.body]
        self.functions.pop()
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        if node.value is not None:
            node.value = self.visit(node.value)
        return node

    def visit_If(self, node: ast.If) -> ast.If:
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return node
        return self.generic_visit(node)  # type: ignore[return-value]

    def visit_match_case(self, node: ast.match_case) -> ast.match_case:
        if node.guard is not None:
            node.guard = self.visit(node.guard)
        node.body = [self.visit(statement) for statement in node.body]
        return node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        return node

    def visit_Raise(self, node: ast.Raise) -> ast.Raise:
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.Subscript:
        node.value = self.visit(node.value)
        if isinstance(node.ctx, ast.Load):
            node.slice = self.visit(node.slice)
        return node

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        mutants = []
        for at, operator in enumerate(node.ops):
            for other in _SWAPS.get(type(operator), ()):
                mutant = copy.deepcopy(node)
                mutant.ops[at] = other()  # type: ignore[call-overload]
                mutants.append((node.comparators[at], _said(operator, other), mutant))
        return self._beside(self.generic_visit(node), mutants)  # type: ignore[arg-type]

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        return self._swapped(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        return self._swapped(node)

    def _swapped(self, node: ast.BinOp | ast.BoolOp) -> ast.expr:
        mutants = []
        for other in _SWAPS.get(type(node.op), ()):
            mutant = copy.deepcopy(node)
            mutant.op = other()  # type: ignore[assignment]
            place = node.right if isinstance(node, ast.BinOp) else node.values[1]
            mutants.append((place, _said(node.op, other), mutant))
        return self._beside(self.generic_visit(node), mutants)  # type: ignore[arg-type]

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.stmt:
        statement: ast.stmt = node
        originals = copy.deepcopy(node)
        node.value = self.visit(node.value)
        for other in _SWAPS.get(type(node.op), ()):
            number = self._number(node, _said(node.op, other).replace("with ", "= with ") + "=")
            if number is not None:
                mutant = copy.deepcopy(originals)
                mutant.op = other()  # type: ignore[assignment]
                statement = ast.copy_location(ast.If(_call(number), [mutant], [statement]), node)
        return statement

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        mutants = []
        if isinstance(node.op, ast.Not | ast.USub | ast.Invert):
            word = {ast.Not: "not", ast.USub: "-", ast.Invert: "~"}[type(node.op)]
            mutants.append((node, f"delete {word}", copy.deepcopy(node.operand)))
        visited = node if isinstance(node.operand, ast.Constant) else self.generic_visit(node)
        return self._beside(visited, mutants)  # type: ignore[arg-type]

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        mutants = [
            (node.test, "replace the condition with True", copy.deepcopy(node.body)),
            (node.test, "replace the condition with False", copy.deepcopy(node.orelse)),
        ]
        return self._beside(self.generic_visit(node), mutants)  # type: ignore[arg-type]

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        value = node.value
        if isinstance(value, bool):
            other: object = not value
        elif isinstance(value, int | float):
            other = value + 1 if isinstance(value, int) else 2.0 * value if value else 1.0
        else:
            return node
        return self._beside(node, [(node, f"replace {value} with {other}", ast.Constant(other))])


def _own(function: ast.FunctionDef) -> Iterator[ast.AST]:
    """The nodes of a function that are in no other one."""
    waiting: list[ast.AST] = list(function.body)
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, ast.FunctionDef | ast.Lambda | ast.GeneratorExp):
            waiting += ast.iter_child_nodes(node)


def _call(number: int) -> ast.Call:
    return ast.Call(ast.Name("_living", ast.Load()), [ast.Constant(number)], [])


def _said(operator: ast.AST, other: type[ast.AST]) -> str:
    return f"replace {_WORDS[type(operator)]} with {_WORDS[other]}"
