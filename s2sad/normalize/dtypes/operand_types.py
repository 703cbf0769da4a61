"""operand_types: an integer where Python takes nothing else, a number or an array where something is computed.

    def f(x: "float64[:]", n: int):
        s = 0.0
        for i in range(n / 2):
            s += x[i]
        return s

refused: a float, where a bound of range is an integer

    x[k]        x[:k]       np.zeros(n)         1 << n              with n or k a float
    k * x       -k      k > 0       x[0] = k        np.sin(k)       with k None or a str
    a *= 0.5    a[1:] -= x                              with a an array of integers
    -a          a - b                                   with a and b arrays of bools

Requires structured form and types; changes nothing. Python and NumPy raise TypeError or IndexError there, whatever the
value is; Numba rounds bounds of loops and slices, and what is stored in place.
"""
from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.infer.list_arrays import LISTED
from s2sad.infer.signatures.laws import items_of
from s2sad.normalize.context import NormalContext
from s2sad.rules import find, find_array
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, BinOp, BitAnd, BitOr, BitXor, Call, Compare, Constant, Expr, FunctionDef, Gt, GtE,
    Invert, LShift, Lt, LtE, Name, Not, RShift, Raise, Slice, Sub, Subscript, USub, UnaryOp, call_name, children,
    indices, times_bound, walk_statements,
)

RANGE, PLACE, BOUND, SIZE = "a bound of range", "an index", "a bound of a slice", "a size"
NUMBER = "it is computed with"
_SIGNS = {LShift: "<<", RShift: ">>", BitAnd: "&", BitOr: "|", BitXor: "^", Invert: "~"}
_MADE = ("numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full", LISTED)
_SIZES = frozenset(("shape", "num", "N", "M", "n", "m", "k", "offset"))     # options of functions of arrays


def operand_types(function: FunctionDef, context: NormalContext) -> None:
    """Refuses operands that are no integer, or no number, where one is needed."""
    OperandTypes(function, context.typing, context.report).check(function.body)


class OperandTypes:
    """The check of one function: `check_node` refuses operands of a node that are no integer, or no number."""

    def __init__(self, function: FunctionDef, typing: Typing, report: Report):
        self.typing, self.report = typing, report
        bound = times_bound(function.body)
        self.given = {p.id for p in function.args.args} - {*bound}
        self.copies = {s.targets[0].id: s.value.id for s in walk_statements(function.body) if isinstance(s, Assign)
                       and isinstance(
            s.targets[0], Name) and isinstance(s.value, Name) and bound[s.targets[0].id] == 1}

    def check(self, block: list[AST]) -> None:
        """Checks every node of a block, but for the texts of errors and assertions."""
        for node in block:
            printed = isinstance(node, Expr) and call_name(node.value) == "builtins.print"
            if not printed and not isinstance(node, (Assert, Raise)):
                before = len(self.report.found)
                self.check(children(node))
                if len(self.report.found) == before:    # else what is refused inside explains it
                    self.check_node(node)

    def check_node(self, node: AST) -> None:
        for operand in _computed(node, self.typing):
            kind = self.typing.of(operand)
            if kind.kind in ("none", "text"):
                self._refuse(operand if getattr(operand, "lineno", None) else node, operand, kind, NUMBER)
                return
        if (found := self._misfit(node) or self._minus_of_bools(node)) is not None:
            self.report.error("S203", found[0], node, help=found[1])
            return
        for what, operand in _operands(node):
            kind = self.typing.of(operand)
            if _is_wrong(kind, what) or what == PLACE and kind.dtype == "bool" and kind.is_number and (
                    self.typing.of(node.value).is_array):
                self._refuse(operand if getattr(operand, "lineno", None) else node, operand, kind, what)

    def _misfit(self, node: AST) -> tuple[str, str] | None:
        """What is said of an array that is changed in place by what its dtype does not hold; NumPy's `same_kind`."""
        if not isinstance(node, AugAssign):
            return None
        held, made = self.typing.of(node.target), self.typing.of(BinOp(node.target, node.op, node.value))
        if not held.is_array or not held.dtype or not made.dtype or made.is_complex or np.can_cast(
                made.dtype, held.dtype, "same_kind"):       # a complex value is refused elsewhere
            return None
        return (f"an array of {held.dtype} is changed in place, and what it gets is {made.dtype}",
                f"make it one of {made.dtype}: dtype={made.dtype.rstrip('0123456789')}, or a.astype(...)")

    def _minus_of_bools(self, node: AST) -> tuple[str, str] | None:
        """What is said of a minus of arrays of bools, which NumPy does not have."""
        operands = [node.operand] if isinstance(node, UnaryOp) and isinstance(node.op, USub) else [
            node.left, node.right] if isinstance(node, BinOp) and isinstance(node.op, Sub) else []
        kinds = [self.typing.of(o) for o in operands]
        if not any(k.is_array for k in kinds) or any(k.dtype != "bool" for k in kinds):
            return None
        return "an array of bools has no minus", "write ~a, a ^ b, or a.astype(int)"

    def _refuse(self, place: AST, operand: AST, kind: Type, what: str) -> None:
        name = self._argument(operand)
        said = _described(kind)
        where = what if what == NUMBER else f"{what} takes integers" if what in _SIGNS.values() else (
            f"{what} is an integer")
        if name:
            wanted = "a number or an array" if what == NUMBER else "an int"
            self.report.error("S405", f"the argument '{name}' is {said}, and {where}", place,
                              help=f"give an int, or write int({name})" if kind.is_number else f"give {wanted}")
        else:
            help = "make it an integer: x[int(k)]; what lies in one list with floats is a float" if what == PLACE else (
                "make it an integer: int(...), or // in place of /")
            self.report.error("S203", f"{said}, where {where}", place, help=help if kind.is_number else "")

    def _argument(self, operand: AST) -> str:
        """The parameter that an operand is, under its own name or that of a copy; "" if it is none."""
        word = operand.id if isinstance(operand, Name) else ""
        seen: set[str] = set()
        while word in self.copies and word not in seen:
            seen.add(word)
            word = self.copies[word]
        return word if word in self.given else ""


def _is_wrong(kind: Type, what: str) -> bool:
    """Whether a value of this type is no integer; what nothing is known of is refused elsewhere."""
    if kind.is_number or kind.is_array and what in _SIGNS.values():
        return kind.is_inexact
    return kind.kind in ("none", "text") or kind.is_array and what == SIZE or kind.kind in (
        "array", "tuple") and what in (RANGE, BOUND)


def _computed(node: AST, typing: Typing) -> list[AST]:
    """What a node computes with, or stores in an array."""
    if isinstance(node, BinOp):
        return [node.left, node.right]
    if isinstance(node, UnaryOp):
        return [] if isinstance(node.op, Not) else [node.operand]
    if isinstance(node, Compare):
        ordered = isinstance(node.ops[0], (Lt, LtE, Gt, GtE))
        sides = [node.left, *node.comparators]
        return sides if ordered and not all(typing.of(s).kind == "text" for s in sides) else []
    if isinstance(node, AugAssign) or isinstance(node, Assign) and isinstance(node.targets[0], Subscript):
        return [node.value] if isinstance(node.value, Name) else []
    return list(node.args) if isinstance(node, Call) and find(call_name(node) or "") is not None else []


def _operands(node: AST) -> Iterator[tuple[str, AST]]:
    """What a node takes that must be an integer, and as what."""
    name = call_name(node)
    if name == "builtins.range":
        yield from ((RANGE, a) for a in node.args)
    elif isinstance(node, Subscript):
        for part in indices(node):
            if isinstance(part, Slice):
                yield from ((BOUND, b) for b in (part.lower, part.upper, part.step) if not _is_none(b))
            elif not _is_none(part):
                yield PLACE, part
    elif isinstance(node, (BinOp, AugAssign)) and (sign := _SIGNS.get(type(node.op))):
        yield from ((sign, a) for a in ((node.left, node.right) if isinstance(node, BinOp) else (
            node.target, node.value)))
    elif isinstance(node, UnaryOp) and isinstance(node.op, Invert):
        yield "~", node.operand
    elif name in _MADE and node.args:
        yield from ((SIZE, a) for a in items_of(node.args[0]))
    elif isinstance(node, Call) and (rule := find_array(name)) is not None:
        given = dict(zip((*rule.operands, *rule.options), node.args)) | {str(k.arg): k.value for k in node.keywords}
        for option in sorted(_SIZES & given.keys()):
            if not _is_none(given[option]):
                yield from ((SIZE if option in ("shape", "num") else f"{option}=", a) for a in items_of(given[option]))


def _is_none(node: AST | None) -> bool:
    return node is None or isinstance(node, Constant) and (node.value is None or node.value is Ellipsis)


def _described(kind: Type) -> str:
    if kind.is_array:
        return f"an array of {kind.dtype}"
    if kind.dtype == "bool":
        return "a bool"
    said = {"none": "None", "text": "a str", "tuple": "a list or tuple"}
    return said.get(kind.kind) or ("a complex number" if kind.is_complex else "a float")
