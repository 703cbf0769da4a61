"""bounds: what counted loops say of their counters, for the loop transformations.

Affine forms over names and shapes that a loop does not change; a form that is not affine is None.
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

from s2sad.infer.affine import Affine, combined
from s2sad.analyze.dependence import range_parts
from s2sad.analyze.liveness import targets
from s2sad.simplify.algebra import shifted, simple
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Constant, For, If, Name, Subscript, UnaryOp, USub, call_name, copy, dump,
    is_comment, names, stored_names, walk,
)


@dataclass(frozen=True)
class Counted:
    """A loop whose step is 1 or -1; its bounds stand for the same numbers everywhere in its body."""
    counter: str
    start: AST
    stop: AST
    step: int

    def upwards(self) -> list[AST]:
        """The bounds of the same counters, the least one first."""
        if self.step > 0:
            return spelled([copy(self.start), copy(self.stop)])
        return spelled([simple(shifted(copy(bound), 1), integers=True) for bound in (self.stop, self.start)])

    def ends(self, first: int = 0, last: int = 0) -> tuple[Affine, Affine] | None:
        """The least and the greatest counter, without so many of the first and of the last iterations."""
        start, stop = affine(self.start), affine(self.stop)
        if start is None or stop is None:
            return None
        if self.step > 0:
            return start.shift(first), stop.shift(-1 - last)
        return stop.shift(1 + last), start.shift(-first)


def counted(loop: AST) -> Counted | None:
    """The bounds of a loop over a range, None if its body changes them or its step is another."""
    if not isinstance(loop, For) or call_name(loop.iter) != "builtins.range":
        return None
    start, stop, step = range_parts(loop)
    fixed = {loop.target.id, *names([start, stop])}
    if step not in (1, -1) or fixed & set(changed(loop.body)):
        return None
    return Counted(loop.target.id, start, stop, step)


def spelled(bounds: list[AST]) -> list[AST]:
    """The arguments of `range`, without a first 0 that goes without saying."""
    first = bounds[0]
    return bounds[1:] if len(bounds) == 2 and isinstance(first, Constant) and first.value == 0 else bounds


def changed(block: list[AST]) -> set[str]:
    """The names that a block binds."""
    return set(stored_names(block))


def affine(node: AST) -> Affine | None:
    """The affine form of an integer expression over names, sizes and shapes."""
    if isinstance(node, Constant):
        return Affine((), node.value) if type(node.value) is int else None
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = affine(node.operand)
        return None if inner is None else inner.times(-1)
    if isinstance(node, Name):
        return Affine.symbol(node.id)
    shape = node.value if isinstance(node, Subscript) and isinstance(node.slice, Constant) else node
    if isinstance(shape, Attribute) and isinstance(shape.value, Name) and shape.attr in ("shape", "size"):
        return Affine.symbol(dump(node))
    if not isinstance(node, BinOp):
        return None
    return combined(node.op, affine(node.left), affine(node.right))


def replaced(form: Affine, counter: str, by: Affine) -> Affine:
    """The form with another form for a counter."""
    factor = dict(form.terms).get(counter, 0)
    return form.plus(Affine.symbol(counter), -factor).plus(by, factor)


def never_negative(form: Affine | None, least: Mapping[str, int]) -> bool:
    """Whether a form is at least 0 if every counter is at least what `least` says."""
    if form is None or any(c < 0 or s not in least for s, c in form.terms):
        return False
    return form.constant + sum(c * least[s] for s, c in form.terms) >= 0


def shifted_by(node: AST, counter: str) -> int | None:
    """The number d of a subscript `counter + d`."""
    form = affine(node)
    return form.constant if form is not None and form.terms == ((counter, 1),) else None


def is_straight(block: list[AST], writing: Set[str] = frozenset()) -> bool:
    """Whether a block has only bindings, stores and branches of these, and calls none of the functions of these names,
    which write arrays."""
    return all(is_comment(s) or isinstance(s, (Assign, AugAssign)) and not any(call_name(n) in writing for n in walk(s))
               or isinstance(s, If) and is_straight(s.body, writing) and is_straight(s.orelse, writing) for s in block)


def stores(block: list[AST]) -> list[Subscript]:
    """The elements that the statements of a block store into, or add to."""
    return [t for s in walk(block) if isinstance(s, (Assign, AugAssign)) for t in targets(s)
            if isinstance(t, Subscript)]
