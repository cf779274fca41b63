"""Arithmetic over columns: a whitelist of syntax, so that a column map can never run code."""

from __future__ import annotations

import ast
import math
import operator
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...errors import InputError

MAX_LENGTH = 500
"""Longest expression (characters), which also bounds how deep the parser can nest."""


def _unwrap(angle: FloatArray) -> FloatArray:
    """Unwrap jumps of a turn (rad) across the finite samples: one NaN must not spoil all that follow."""
    angle = np.array(angle, dtype=np.float64)
    finite = np.isfinite(angle)
    angle[finite] = np.unwrap(angle[finite])
    return angle


def _hold(values: FloatArray) -> FloatArray:
    """Give blanks the value before them: a command holds until the next one."""
    values = np.asarray(values, dtype=np.float64)
    read = np.maximum.accumulate(np.where(np.isfinite(values), np.arange(values.size), 0))
    return values[read] if values.ndim else values


_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin,
    "cos": np.cos,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "deg2rad": np.deg2rad,
    "unwrap": _unwrap,
    "cumsum": np.cumsum,
    "hold": _hold,
}


def evaluate(expression: str, column: Callable[[str], FloatArray]) -> FloatArray:
    """Return the value of `expression`, with `column` giving the array behind each name.

    Numbers, column names (dotted, or in backquotes when they hold other characters), `pi`, + - * / **,
    parentheses and sin cos sqrt abs deg2rad unwrap cumsum hold. Columns of one expression must have one
    length (scalars fit all); anything else raises InputError naming the expression.
    """
    return _Evaluation(expression, column).run()


class _Evaluation:
    def __init__(self, expression: str, column: Callable[[str], FloatArray]) -> None:
        self.expression = expression
        self.column = column
        self.quoted: list[str] = []
        self.longest: tuple[str, int] | None = None

    def run(self) -> FloatArray:
        if len(self.expression) > MAX_LENGTH:
            raise InputError(f"an expression of the map has more than {MAX_LENGTH} characters; shorten it")
        source = re.sub(r"`([^`]*)`", self._keep_quoted, self.expression).strip()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # the parser comments on style; the whitelist decides
                tree = ast.parse(source, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise self._wrong("is not an expression; write it like 35.1507*vir") from error
        with np.errstate(all="ignore"):
            try:
                return np.asarray(self._value(tree.body), dtype=np.float64)
            except (ArithmeticError, RecursionError, TypeError) as error:
                raise self._wrong(f"cannot be computed ({error})") from error

    def _keep_quoted(self, match: re.Match[str]) -> str:
        self.quoted.append(match[1])
        return f" _quoted_{len(self.quoted) - 1} "

    def _value(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return np.float64(number)
            case ast.Name(id="pi"):
                return np.float64(math.pi)
            case ast.Name() | ast.Attribute():
                return self._column(self._dotted(node))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](self._value(left), self._value(right))
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](self._value(operand))
            case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in _FUNCTIONS:
                return _FUNCTIONS[name](self._value(argument))
            case ast.Call():
                raise self._wrong(f"calls something else than {', '.join(_FUNCTIONS)}, each of one argument")
            case _:
                raise self._wrong("may hold only numbers, column names, + - * / ** and parentheses")

    def _dotted(self, node: ast.expr) -> str:
        match node:
            case ast.Name(id=name):
                quoted = re.fullmatch(r"_quoted_(\d+)", name)
                known = quoted is not None and int(quoted[1]) < len(self.quoted)
                return self.quoted[int(quoted[1])] if quoted and known else name
            case ast.Attribute(value=value, attr=attribute):
                return f"{self._dotted(value)}.{attribute}"
            case _:
                raise self._wrong("may use a dot only inside a column name, as in data.qm")

    def _column(self, name: str) -> FloatArray:
        values = self.column(name)
        if values.ndim == 0:
            return values
        if self.longest is not None and self.longest[1] != len(values):
            other, length = self.longest
            raise self._wrong(
                f"mixes columns of different length: {other} has {length} rows, {name} has {len(values)}"
            )
        self.longest = (name, len(values))
        return values

    def _wrong(self, what: str) -> InputError:
        return InputError(f"map: {self.expression.strip()!r} {what}")
