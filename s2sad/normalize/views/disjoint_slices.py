"""disjoint_slices: whether two parts of one array share no element, whatever its size.

    y[:n * n]  y[n * n:]            they share none
    y[:n]      y[2 * n:]            none if n is not negative: `disjoint` says so
    y[0::2]    y[1::2]              none
    y[:n]      y[k:]                perhaps
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.signatures.laws import whole_number
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, FunctionDef, Mult, Name, Slice, Sub, Subscript, USub, UnaryOp, copy,
    dump, indices, names, walk,
)

Polynomial = dict[tuple[str, ...], int]


class DisjointSlices:
    """The parts of arrays in one function; `values` are its names bound once, with what binds them."""

    def __init__(self, function: FunctionDef, values: Mapping[str, AST | None]):
        self.parameters = {p.id for p in function.args.args}
        self.values = values
        self.atoms: dict[str, AST] = {}

    def lasts(self, node: AST, depth: int = 0) -> bool:
        """Whether an expression is the same wherever it stands: of arrays it reads sizes of parameters."""
        if depth > 20 or isinstance(node, Subscript) and not (isinstance(node.value, Attribute) and self.lasts(
                node.value, depth + 1)) or isinstance(node, Call):
            return False
        for n in names(node):
            if n not in self.values or n not in self.parameters and (
                    (value := self.values[n]) is None or not self.lasts(value, depth + 1)):
                return False
        return True

    def apart(self, one: AST, other: AST) -> list[AST] | None:
        """The expressions that must not be negative for two parts of one array to share nothing; None if they may."""
        if not isinstance(one, Subscript) or not isinstance(other, Subscript):
            return None
        for a, b in zip(_first(one), _first(other)):
            for low, high in ((a, b), (b, a)):
                if (found := self.before(low, high)) is not None:
                    return found
        return None

    def before(self, low: AST, high: AST) -> list[AST] | None:
        """The same for one axis, where the first part is to lie before the second, or between its elements."""
        if not isinstance(low, Slice) or not isinstance(high, Slice):
            a, b = whole_number(low), whole_number(high)
            return [] if a is not None and b is not None and 0 <= a < b else None
        step, other = (1 if s.step is None else whole_number(s.step) for s in (low, high))
        if step is not None and step == other and step > 1:
            first, second = (0 if s.lower is None else whole_number(s.lower) for s in (low, high))
            if first is not None and second is not None and min(first, second) >= 0 and (second - first) % step:
                return []
        if step is None or other is None or min(step, other) < 1 or low.upper is None or high.lower is None:
            return None
        end, start = self.polynomial(low.upper), self.polynomial(high.lower)
        if end is None or start is None:
            return None
        if end == start:
            return []
        rest = _plus(start, end, -1)
        if any(c < 0 for c in (*rest.values(), *end.values())):
            return None
        found = sorted({s for terms in (*rest, *end) for s in terms})
        return [copy(self.atoms[s]) for s in found]

    def polynomial(self, node: AST, depth: int = 0) -> Polynomial | None:
        """An integer expression as a sum of products of what stays the same; None if it may change."""
        number = whole_number(node)
        if number is not None:
            return {(): number} if number else {}
        if depth > 20 or not self.lasts(node):
            return None
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.polynomial(node.operand, depth + 1)
            return None if inner is None else _plus({}, inner, -1)
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
            left, right = self.polynomial(node.left, depth + 1), self.polynomial(node.right, depth + 1)
            if left is None or right is None:
                return None
            if isinstance(node.op, Mult):
                made: Polynomial = {}
                for terms, c in left.items():
                    made = _plus(made, {tuple(sorted((*terms, *t))): d for t, d in right.items()}, c)
                return made
            return _plus(left, right, 1 if isinstance(node.op, Add) else -1)
        value = self.values.get(node.id) if isinstance(node, Name) else None
        if value is not None:
            return self.polynomial(value, depth + 1)
        key = dump(node)
        self.atoms[key] = node
        return {(key,): 1}


def _plus(one: Polynomial, other: Polynomial, factor: int) -> Polynomial:
    made = dict(one)
    for terms, c in other.items():
        made[terms] = made.get(terms, 0) + factor * c
    return {terms: c for terms, c in made.items() if c}


def _first(part: Subscript) -> list[AST]:
    """The subscripts of the first axes."""
    found = indices(part)
    ends = [k for k, s in enumerate(found) if isinstance(s, Constant) and s.value in (None, Ellipsis)]
    return found[:ends[0]] if ends else found


def occurrences(node: AST | list[AST]) -> list[AST]:
    """The names in a statement or expression, each with the subscript that takes a part of it, if one does."""
    inside = {id(n.value) for n in walk(node) if isinstance(n, Subscript) and isinstance(n.value, Name)}
    return [n for n in walk(node) if isinstance(n, Name) and id(n) not in inside or isinstance(
        n, Subscript) and isinstance(n.value, Name)]
