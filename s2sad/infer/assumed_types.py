"""assumed_types: the types of a function's parameters where no arguments are at hand, from annotations and from use.

Requires fenced trees with resolved names, callees before callers; establishes a type for every parameter of the entry
and the reason for it. In this order: a type from outside (`--types`); the annotation ("float64[:, :]", float, int); the
default value; use: a subscript of rank k or unpacking into names means an array of float64, use as a bound, an index or
a shift int64, an argument of a helper what the helper makes of it, anything else float64.

    def f(x, n, c):                 x: float64[:, :]   n: int64   c: float64
        for i in range(n):
            x[i, 0] *= c
"""
from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from s2sad.diagnostics import Report
from s2sad.infer.integer_arguments import integer_arguments
from s2sad.infer.types import BOOL, FLOAT, INT, Type, array, of_value
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, BitAnd, BitOr, BitXor, Call, Constant, Div, For, FunctionDef, IfExp, List, LShift,
    Name, Pow, RShift, Slice, Subscript, Tuple, UnaryOp, call_name, indices, walk,
)

_DTYPES = ("float64", "float32", "complex128", "int64", "int32", "int16", "int8", "uint64", "uint32", "uint16", "uint8",
           "bool")
_WORDS = {"float": "float64", "int": "int64", "bool_": "bool", "complex": "complex128"}
_SPELLED = re.compile(r"^(?:np\.|numpy\.|nb\.|numba\.)?(\w+)\s*(?:\[\s*(:{1,2}1?(?:\s*,\s*:{1,2}1?)*)\s*\])?$")
_WHOLE = ("builtins.len", "numpy.sum", "numpy.empty_like", "numpy.zeros_like", "numpy.ones_like", "numpy.full_like",
          "numpy.copy")
_ITERATED = ("builtins.enumerate", "builtins.reversed", "builtins.zip")
_PASSED_ON = ("builtins.min", "builtins.max", "builtins.abs")


@dataclass(frozen=True)
class Assumed:
    """A type, and why; `reason` is empty where it was declared. `extents` are sizes known, by axis."""
    type: Type
    reason: str = ""
    extents: tuple[tuple[int, int], ...] = ()


@dataclass
class ParameterUses:
    """The constraints on each name of a function: how many axes it must have, whether it must be an integer."""
    ranks: dict[str, int] = field(default_factory=dict)
    integers: dict[str, AST] = field(default_factory=dict)
    numbers: dict[str, AST] = field(default_factory=dict)
    subscripts: dict[str, AST] = field(default_factory=dict)
    extents: dict[tuple[str, int], int] = field(default_factory=dict)


def parsed_type(text: str) -> Type | None:
    """The type that a text denotes, or None.

    >>> str(parsed_type("float64[:, ::1]")), str(parsed_type("int")), parsed_type("quaternion")
    ('float64[:, :]', 'int64', None)
    """
    found = _SPELLED.match(text.strip().strip("\"'"))
    if found is None or _WORDS.get(found[1], found[1]) not in _DTYPES:
        return None
    dtype = _WORDS.get(found[1], found[1])
    if found[2]:
        return array(dtype, found[2].count(",") + 1)
    return {"float64": FLOAT, "int64": INT, "bool": BOOL}.get(dtype, Type("number", dtype))


def assumed_types(entry: str, trees: Mapping[str, FunctionDef], parameters: tuple[str, ...],
                  annotations: Mapping[str, str], defaults: Mapping[str, Any], declared: Mapping[str, Type],
                  report: Report) -> dict[str, Assumed]:
    """The types of the entry's parameters; contradictions go into the report."""
    uses = uses_of(trees)[entry]
    types: dict[str, Assumed] = {}
    for parameter in parameters:
        extents = tuple((k, n) for (name, k), n in uses.extents.items() if name == parameter)
        known = declared.get(parameter) or parsed_type(annotations.get(parameter, ""))
        used = _used(parameter, uses, report)
        if known is not None:
            if parameter not in declared:
                _check_annotation(parameter, known, uses, report)
            types[parameter] = Assumed(known, "", extents)
        elif parameter in defaults and not uses.ranks.get(parameter):
            types[parameter] = Assumed(of_value(defaults[parameter]), "its default value")
        else:
            types[parameter] = Assumed(used.type, used.reason, extents)
    return types


def uses_of(trees: Mapping[str, FunctionDef]) -> dict[str, ParameterUses]:
    """The constraints on the names of each function."""
    found: dict[str, ParameterUses] = {}
    for title, tree in trees.items():
        found[title] = _Scan(tree, found, trees).uses()
    return found


def _used(parameter: str, uses: ParameterUses, report: Report) -> Assumed:
    rank, integer = uses.ranks.get(parameter, 0), parameter in uses.integers
    if rank and parameter in uses.numbers:
        report.error("S203", f"the type of '{parameter}' cannot be inferred: it is used as an array and as a bound, an "
                     "index or a shift", uses.numbers[parameter], note="here as an integer",
                     help=f"say which: --types \"{parameter}: {array('float64', rank)}\"")
    if rank:
        kind = array("int64" if integer else "float64", rank)
        elements = ", its elements are bounds, indices or shifts" if integer else ""
        return Assumed(kind, f"used as an array with {rank} ax{'e' if rank > 1 else 'i'}s{elements}")
    return Assumed(INT, "used as a bound, an index or a shift") if integer else Assumed(FLOAT, "nothing says otherwise")


def _check_annotation(parameter: str, kind: Type, uses: ParameterUses, report: Report) -> None:
    """Reports an annotation that the function's own use contradicts."""
    rank = uses.ranks.get(parameter, 0)
    if rank > kind.rank:
        better = array(kind.dtype or "float64", rank)
        report.error("S203", f"'{parameter}' is annotated as {kind} and used as an array with {rank} "
                     f"ax{'e' if rank > 1 else 'i'}s", uses.subscripts.get(parameter), note="here",
                     help=f"correct the annotation, or say it here: --types \"{parameter}: {better}\"")
    elif kind.is_float and parameter in uses.integers:
        better = array("int64", kind.rank) if kind.is_array else INT
        report.error("S203", f"'{parameter}' is annotated as {kind} and used as a bound, an index or a shift",
                     uses.integers[parameter], note="here",
                     help=f"correct the annotation, or say it here: --types \"{parameter}: {better}\"")


class _Scan:
    """The constraints on one function's names, by iteration to a fixpoint."""

    def __init__(self, tree: FunctionDef, others: Mapping[str, ParameterUses], trees: Mapping[str, FunctionDef]):
        self.tree, self.others, self.trees, self.found = tree, others, trees, ParameterUses()

    def uses(self) -> ParameterUses:
        for _ in range(20):
            before = (dict(self.found.ranks), set(self.found.integers))
            for node in walk(self.tree.body):
                method = getattr(self, "see_" + type(node).__name__, None)
                if method is not None:
                    method(node)
            if before == (self.found.ranks, set(self.found.integers)):
                break
        return self.found

    def demand(self, node: AST, rank: int = 0, integer: bool = False) -> None:
        """Adds a constraint: at least so many axes, or an integer."""
        if isinstance(node, Name):
            if rank > self.found.ranks.get(node.id, 0):
                self.found.ranks[node.id] = rank
            if integer:
                self.found.integers.setdefault(node.id, node)
                if not rank:
                    self.found.numbers.setdefault(node.id, node)
        elif isinstance(node, Subscript) and not isinstance(node.value, Attribute):
            parts = [s for s in indices(node) if not (isinstance(s, Constant) and s.value in (..., None))]
            slices = sum(isinstance(s, Slice) for s in parts)
            self.demand(node.value, len(parts) - slices + max(slices, rank), integer)
        elif isinstance(node, BinOp) and integer and not isinstance(node.op, (Div, Pow)):
            self.demand(node.left, 0, True)
            self.demand(node.right, 0, True)
        elif isinstance(node, UnaryOp) and integer:
            self.demand(node.operand, 0, True)
        elif isinstance(node, IfExp):
            self.demand(node.body, rank, integer)
            self.demand(node.orelse, rank, integer)
        elif isinstance(node, (Tuple, List)):
            for item in node.elts:
                self.demand(item, max(rank - 1, 0), integer)
        elif integer and call_name(node) in _PASSED_ON:
            for argument in node.args:
                self.demand(argument, 0, True)

    # -- nodes -------------------------------------------------------------------------------------------------------

    def see_Subscript(self, node: Subscript) -> None:
        base = node.value
        while isinstance(base, Subscript):
            base = base.value
        if isinstance(base, Name):
            self.found.subscripts.setdefault(base.id, node)
        if isinstance(base, Attribute):
            place = node.slice.value if isinstance(node.slice, Constant) and isinstance(node.slice.value, int) else 0
            if base.attr == "shape":
                self.demand(base.value, max(place, 0) + 1)
            return
        self.demand(node)
        for part in indices(node):
            for bound in (part.lower, part.upper, part.step) if isinstance(part, Slice) else (part,):
                if bound is not None:
                    self.demand(bound, 0, True)

    def see_Attribute(self, node: Attribute) -> None:
        if node.attr in ("shape", "size", "ndim", "copy", "fill", "sum", "dtype"):
            self.demand(node.value, 1)

    def see_BinOp(self, node: BinOp) -> None:
        if isinstance(node.op, (LShift, RShift, BitAnd, BitOr, BitXor)) or isinstance(node.left, List):
            self.demand(node.left, 0, True)
            self.demand(node.right, 0, True)

    def see_For(self, node: For) -> None:
        items, targets = [node.iter], [node.target]
        if call_name(node.iter) in _ITERATED:
            items = node.iter.args[:1] if call_name(node.iter) != "builtins.zip" else node.iter.args
            whole = isinstance(node.target, Tuple)
            skipped = 1 if call_name(node.iter) == "builtins.enumerate" else 0
            targets = list(node.target.elts)[skipped:] if whole else [node.target]
        for item, target in zip(items, targets):
            rank = self.found.ranks.get(target.id, 0) if isinstance(target, Name) else 1
            self.demand(item, 1 + rank, isinstance(target, Name) and target.id in self.found.integers)

    def see_Assign(self, node: Assign) -> None:
        for target in node.targets:
            if isinstance(target, Name):
                self.demand(node.value, self.found.ranks.get(target.id, 0), target.id in self.found.integers)
            elif isinstance(target, Tuple):
                self.unpacked(target, node.value)

    def unpacked(self, target: Tuple, value: AST) -> None:
        if isinstance(value, Tuple):
            for item, part in zip(target.elts, value.elts):
                if isinstance(item, Name):
                    self.demand(part, self.found.ranks.get(item.id, 0), item.id in self.found.integers)
            return
        if isinstance(value, Attribute) and value.attr == "shape":
            self.demand(value.value, len(target.elts))
            return
        ranks = [self.found.ranks.get(i.id, 0) for i in target.elts if isinstance(i, Name)]
        self.demand(value, 1 + max(ranks, default=0))
        if isinstance(value, Name):
            self.found.extents[value.id, 0] = len(target.elts)
            self.found.subscripts.setdefault(value.id, value)

    def see_Call(self, node: Call) -> None:
        called = call_name(node) or ""
        for argument in node.args if called == "builtins.range" else integer_arguments(node):
            self.demand(argument, 0, True)
        if called in _WHOLE:
            for argument in node.args[:1]:
                self.demand(argument, 1)
        elif called.startswith("user.") and called[5:] in self.others:
            self.passed(node, called[5:])

    def passed(self, node: Call, helper: str) -> None:
        uses = self.others[helper]
        parameters = [p.id for p in self.trees[helper].args.args]
        pairs = [*zip(parameters, node.args), *((k.arg, k.value) for k in node.keywords)]
        for parameter, argument in pairs:
            self.demand(argument, uses.ranks.get(parameter, 0), parameter in uses.integers)
            if isinstance(argument, Name):
                for (name, axis), size in uses.extents.items():
                    if name == parameter:
                        self.found.extents.setdefault((argument.id, axis), size)
                if parameter in uses.subscripts:
                    self.found.subscripts.setdefault(argument.id, argument)
