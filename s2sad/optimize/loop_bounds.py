"""loop_bounds: counted loops and affine forms of their bounds and subscripts, for the loop transformations.

Forms are over names and shapes that a loop does not change; an expression that is not affine has the form None.
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

from s2sad.infer.affine import Affine, combined
from s2sad.analyze.dependence import range_parts
from s2sad.liveness import targets
from s2sad.simplify.algebra import add_constant, simplify_index
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Constant, For, If, Mult, Name, Sub, Subscript, USub, UnaryOp,
    call, call_name, const, copy, dump, indices, is_comment, names, walk, walk_statements,
)


@dataclass(frozen=True)
class CountedLoop:
    """A loop over a range with step 1 or -1 and invariant bounds."""
    counter: str
    start: AST
    stop: AST
    step: int

    def upwards(self) -> list[AST]:
        """The arguments of the range of the same counters with step 1."""
        if self.step > 0:
            return range_arguments([copy(self.start), copy(self.stop)])
        return range_arguments([
            simplify_index(add_constant(copy(bound), 1), integers=True) for bound in (self.stop, self.start)])

    def extent(self) -> AST:
        """The length of a row that has an element for every counter."""
        size = copy(self.stop) if self.step > 0 else simplify_index(add_constant(copy(self.start), 1), integers=True)
        return size if isinstance(size, (Subscript, Constant)) else call("builtins.max", size, const(0))

    def ends(self, first: int = 0, last: int = 0) -> tuple[Affine, Affine] | None:
        """The least and the greatest counter, without the given numbers of first and last iterations."""
        start, stop = affine(self.start), affine(self.stop)
        if start is None or stop is None:
            return None
        if self.step > 0:
            return start.shift(first), stop.shift(-1 - last)
        return stop.shift(1 + last), start.shift(-first)


def counted_loop(loop: AST) -> CountedLoop | None:
    """The bounds of a loop over a range, None if its body changes them or its step is neither 1 nor -1."""
    if not isinstance(loop, For) or call_name(loop.iter) != "builtins.range":
        return None
    start, stop, step = range_parts(loop)
    fixed = {loop.target.id, *names([start, stop])}
    if step not in (1, -1) or fixed & set(bound_names(loop.body)):
        return None
    return CountedLoop(loop.target.id, start, stop, step)


def range_arguments(bounds: list[AST]) -> list[AST]:
    """The arguments of `range` for two bounds: a start of 0 is left out."""
    first = bounds[0]
    return bounds[1:] if len(bounds) == 2 and isinstance(first, Constant) and first.value == 0 else bounds


def bound_names(block: list[AST]) -> set[str]:
    """The names that a block binds."""
    return {t.id for s in walk_statements(block) for t in targets(s) if isinstance(t, Name)}


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


def substitute_symbol(form: Affine, counter: str, by: Affine) -> Affine:
    """The form with a form in place of a symbol."""
    factor = dict(form.terms).get(counter, 0)
    return form.plus(Affine.symbol(counter), -factor).plus(by, factor)


def is_nonnegative(form: Affine | None, least: Mapping[str, int]) -> bool:
    """Whether a form is at least 0 if every counter is at least its bound in `least`."""
    found = None if form is None else least_value(form, least)
    return found is not None and found >= 0


def least_value(form: Affine, least: Mapping[str, int]) -> int | None:
    """The least value of a form if every counter is at least its bound in `least`, None if that is not known."""
    if any(c < 0 or s not in least for s, c in form.terms):
        return None
    return form.constant + sum(c * least[s] for s, c in form.terms)


def counter_offset(node: AST, counter: str) -> int | None:
    """The constant d of a subscript `counter + d`; None for any other one."""
    form = affine(node)
    return form.constant if form is not None and form.terms == ((counter, 1),) else None


def is_along(node: AST, counter: str, moving: Set[str]) -> bool:
    """Whether a subscript goes up by one with a counter; `moving` are the names that change with it."""
    form = affine(node)
    return form is not None and dict(form.terms).get(counter) == 1 and not (set(names(node)) - {counter}) & moving


def least_counter(loop: For) -> int | None:
    """The least number that a loop may count, None if it is not known.

    `range((m - 1) * 2, -2, -2)` counts even numbers, and none of them is below 0.
    """
    start, stop, step = range_parts(loop)
    if not isinstance(step, int):
        return None
    if step > 0:
        first = affine(start)
        return first.constant if first is not None and not first.terms else None
    last = affine(stop)
    if last is None or last.terms:
        return None
    rest = _remainder(start, -step)
    return last.constant + 1 + (0 if rest is None else (rest - last.constant - 1) % -step)


def _remainder(node: AST, divisor: int) -> int | None:
    """What an integer expression leaves when it is divided, None if that is not known."""
    if divisor == 1:
        return 0
    if isinstance(node, Constant) and type(node.value) is int:
        return node.value % divisor
    if not isinstance(node, BinOp) or not isinstance(node.op, (Add, Sub, Mult)):
        return None
    left, right = _remainder(node.left, divisor), _remainder(node.right, divisor)
    if isinstance(node.op, Mult) and 0 in (left, right):
        return 0
    if left is None or right is None:
        return None
    made = left * right if isinstance(node.op, Mult) else left + right if isinstance(node.op, Add) else left - right
    return made % divisor


def are_apart(a: Subscript, b: Subscript, least: Mapping[str, int]) -> bool:
    """Whether two references to an array have different numbers along an axis, none of them counted from the end;
    `least` has the least numbers of counters."""
    for x, y in zip(indices(a), indices(b)):
        first, second = affine(x), affine(y)
        if is_nonnegative(first, least) and is_nonnegative(second, least) and first is not None and (
                second is not None) and first.terms == second.terms and first.constant != second.constant:
            return True
    return False


def is_loop_free(block: list[AST], writing: Set[str] = frozenset()) -> bool:
    """Whether a block has only bindings, stores and branches of these, and calls none of the functions `writing`, which
    write arrays."""
    return all(is_comment(s) or isinstance(s, (Assign, AugAssign)) and not any(call_name(n) in writing for n in walk(s))
               or isinstance(s, If) and is_loop_free(s.body, writing) and is_loop_free(s.orelse, writing)
               for s in block)


def stored_elements(block: list[AST]) -> list[Subscript]:
    """The elements that the statements of a block store into, or increment."""
    return [t for s in walk_statements(block) if isinstance(s, (Assign, AugAssign)) for t in targets(s)
            if isinstance(t, Subscript)]
