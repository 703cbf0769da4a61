"""squares: which values are never negative, and have no slope where they are 0, as sums of squares have none.

    s = 0.0                     s holds a sum of squares: where it is 0, x is, and 2.0 * x with it
    for i in range(x.size):
        s += x[i] * x[i]
    r = np.sqrt(s)              so the derivative of r is taken as 0 there, not as 0 / 0

A value has this property where all that is ever assigned to it has: squares and even powers, absolute values, `hypot`,
exponentials and constants that are not negative; sums, products and powers of these, roots, quotients by what is one
of these, a choice between two, elements of arrays that hold nothing else. `flat` is a wider word: no slope at 0, of
either sign. A quotient of such a sum is, or its product with what is held fixed. A name or an array that holds
anything else as well, at any time, does not count: there the slope stays infinite, and `differentiate.zero_law` tests
its factors.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from s2sad.liveness import base_name, targets
from s2sad.analyze.uses import is_active
from s2sad.infer.inference import Typing
from s2sad.rules.rule import number
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Div, Expr, FunctionDef, IfExp, Mult, Name, Pow, Subscript,
    UnaryOp, call_name, dump, names, user_call, walk, walk_statements,
)

_NEVER_NEGATIVE = frozenset(f"{m}.{n}" for m in ("numpy", "math", "builtins") for n in (
    "abs", "absolute", "fabs", "square", "hypot", "exp", "exp2", "cosh"))
_KEEPING = frozenset([*(f"{m}.{n}" for m in ("numpy", "math") for n in ("sqrt", "cbrt")), "builtins.float", *(
    f"numpy.{n}" for n in ("sum", "copy", "reshape", "transpose", "broadcast_to", "float64", "float32", "mean", "max",
    "amax"))])
_CHOOSING = ("numpy.maximum", "numpy.minimum", "builtins.max", "builtins.min", "numpy.fmax", "numpy.fmin")
_PRODUCTS = ("numpy.dot", "numpy.matmul", "numpy.inner", "numpy.vdot")
_SMALLEST = 1.2e-38     # of the normal numbers of float32
_ALLOCATING = ("numpy.empty", "numpy.empty_like", "numpy.zeros", "numpy.zeros_like")


@dataclass(frozen=True)
class Squares:
    """Names of numbers and arrays that hold nothing but what is never negative and has no slope at 0."""
    typing: Typing
    active: frozenset[str]
    members: frozenset[str] = frozenset()

    def square(self, node: AST) -> bool:
        """Whether an expression is never negative, and has no slope where it is 0."""
        value = number(node)
        if value is not None:
            return value >= 0
        if isinstance(node, (Name, Subscript)):
            return base_name(node) in self.members
        if isinstance(node, BinOp):
            return not self.typing.of(node).is_complex and self._operation(node)
        if isinstance(node, IfExp):
            return self.square(node.body) and self.square(node.orelse)
        return isinstance(node, Call) and self._call(node)

    def flat(self, node: AST) -> bool:
        """Whether an expression has no slope where it is 0, whatever its sign."""
        if isinstance(node, UnaryOp):
            return self.flat(node.operand)
        if isinstance(node, BinOp) and isinstance(node.op, Div) and self.flat(node.left):
            return True
        if isinstance(node, BinOp) and isinstance(node.op, Mult):
            factors = _factors(node)
            single = factors if self.typing.of(node).is_complex else _unpaired_factors(node)
            flat = [self.flat(f) for f in single]
            return (any(flat) or len(single) < len(factors)) and all(
                known or not is_active(f, self.typing, self.active) for f, known in zip(single, flat))
        return self.square(node)

    def never_zero(self, node: AST) -> bool:
        """Whether an expression is a positive number and what is never negative; numbers that float32 takes for 0 are
        none."""
        if isinstance(node, BinOp) and isinstance(node.op, Add):
            both = self.square(node.left) and self.square(node.right)
            return both and (self.never_zero(node.left) or self.never_zero(node.right))
        value = number(node)
        return value is not None and value >= _SMALLEST

    def _operation(self, node: BinOp) -> bool:
        if isinstance(node.op, Pow):
            exponent = number(node.right)
            if exponent is None:
                return False
            return exponent >= 2 and exponent % 2 == 0 or exponent > 0 and self.square(node.left)
        if isinstance(node.op, Mult):
            return all(map(self.square, _unpaired_factors(node)))
        if isinstance(node.op, Div) and self._is_count(node.right):
            return self.square(node.left)
        return isinstance(node.op, (Add, Div)) and self.square(node.left) and self.square(node.right)

    def _is_count(self, node: AST) -> bool:
        """Whether an expression is a number of elements."""
        if isinstance(node, Subscript):
            node = node.value
        return isinstance(node, Attribute) and node.attr in ("size", "shape") or call_name(node) == "builtins.len"

    def _call(self, node: Call) -> bool:
        called, of = call_name(node) or "", node.args
        if called in _NEVER_NEGATIVE:
            return called not in ("numpy.square", "numpy.exp", "numpy.cosh") or not self.typing.of(node).is_complex
        if called in _PRODUCTS:
            return len(of) == 2 and dump(of[0]) == dump(of[1]) and self.typing.of(of[0]).rank == 1 and (
                not self.typing.of(node).is_complex)
        if called == "numpy.where":
            return len(of) == 3 and self.square(of[1]) and self.square(of[2])
        return bool(of) and (called in _KEEPING and self.square(of[0]) or called in _CHOOSING and all(
            map(self.square, of)))


def _factors(node: AST) -> list[AST]:
    """The factors of a product, however it is put together."""
    if isinstance(node, BinOp) and isinstance(node.op, Mult):
        return [*_factors(node.left), *_factors(node.right)]
    return [node]


def _unpaired_factors(node: AST) -> list[AST]:
    """The factors of a product without those that make squares of two, as x does in 2.0 * x * x."""
    found: dict[str, AST] = {}
    for factor in _factors(node):
        text = dump(factor)
        if found.pop(text, None) is None:
            found[text] = factor
    return list(found.values())


def squares(function: FunctionDef, typing: Typing, active: frozenset[str]) -> Squares:
    """The table of one function, the greatest fixpoint: all names that are bound and filled, less those with a binding
    of another kind."""
    parameters = {p.id for p in function.args.args}
    statements = [s for s in walk_statements(function.body) if isinstance(s, (Assign, AugAssign, Expr))]
    candidates = {b for s in statements for t in targets(s) if (b := base_name(t)) and typing.of(t).is_inexact}
    candidates -= parameters | set(_other_writes(function, statements))
    found = Squares(typing, active, frozenset(candidates))
    while True:
        lost = {base_name(t) for s in statements for t in targets(s) if base_name(t) in found.members
                and not _preserves(found, s, t)}
        if not lost:
            return found
        found = replace(found, members=found.members - lost)


def _preserves(known: Squares, statement: AST, target: AST) -> bool:
    """Whether a statement preserves the property of its target."""
    if isinstance(statement, AugAssign):
        return known.square(BinOp(target, statement.op, statement.value))
    return isinstance(target, (Name, Subscript)) and (
        call_name(statement.value) in _ALLOCATING or known.square(statement.value))


def _other_writes(function: FunctionDef, statements: list[AST]) -> Iterator[str]:
    """The names that something other than an assignment of one value may store."""
    bound = {base_name(t) for s in statements for t in targets(s)}
    for node in walk(function.body):
        for t in targets(node) if not isinstance(node, (Assign, AugAssign, Expr)) else ():
            yield base_name(t)
        if isinstance(node, Assign) and not isinstance(node.targets[0], (Name, Subscript)):
            yield from map(base_name, targets(node))
        if user_call(node):
            yield from (n for a in node.args for n in names(a) if n in bound)


__all__ = ["Squares", "squares"]
