"""turned: a loop whose index goes around an axis runs as loops in which it does not.

    for j in range(n):                      turn = max(-s % n, 0)
        w[j] = u[(j - s) % n]               rest = max(n - turn, 0)
                                            for j in range(rest):
                                                w[j] = u[j + turn]
                                            for j in range(turn):
                                                w[j + rest] = u[j]

    for j in range(n):                      for j in range(1):
        w[j] = u[(j - 1) % n] + u[(j + 1) % n]      w[j] = u[(j - 1) % n] + u[(j + 1) % n]
                                            for j in range(1, n - 1):
                                                w[j] = u[j - 1] + u[j + 1]
                                            for j in range(max(n - 1, 1), n):
                                                w[j] = u[(j - 1) % n] + u[(j + 1) % n]

A remainder that is the same for all iterations of a loop is had before it. Requires text for Numba; establishes the
same iterations in the same order. A remainder takes as long as ten sums, and keeps a loop from vectors.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from typing import TypeGuard

from s2sad.analyze.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import integer, shifted, simple
from s2sad.simplify.bounds import Counted, changed, counted, is_straight, shifted_by, stores
from s2sad.simplify.extents import Extents
from s2sad.simplify.whole import is_whole, with_counters
from s2sad.tree import (
    AST, BinOp, BoolOp, Call, Compare, For, FunctionDef, Gt, If, IfExp, Lt, Mod, Name, Subscript, add, assign, at,
    call, children, compare, const, copy, counted_for, dump, name, names, rebuild, sub, walk, with_body,
)

CHANGES_ROUNDING = False

_FURTHEST = 4


def turned(function: FunctionDef, types: Mapping[str, Type], free: Names | None = None,
           writing: Set[str] = frozenset()) -> FunctionDef:
    """The function with such loops as several; those that call one of the `writing` functions stay."""
    free = free or Names({n.id for n in walk(function) if isinstance(n, Name)})
    extents, types = Extents(function, writing), with_counters(types, function)

    def block(statements: list[AST], positive: list[Affine]) -> list[AST]:
        known = dict(extents.equal)
        made: list[AST] = []
        for statement in statements:
            extents.learn(statement)
            inside = positive + _positive(statement, extents)
            inner = with_blocks(statement, lambda inner, inside=inside: block(inner, inside))
            loop, before = _first(inner, free, types, Signs(extents, inside))
            loops = _split(loop, extents, free, types) or [loop]
            made += [_if_run(loop, [*before, *loops])] if before else loops
        extents.equal = known
        return made
    return with_body(function, block(function.body, []))


@dataclass(frozen=True)
class Signs:
    """What is known of the sign of an integer in a loop: `positive` are the ends of the loops around, which run."""
    extents: Extents
    positive: list[Affine]

    def never_negative(self, node: AST) -> bool:
        form = self.extents.form(node)
        if form is None:
            return False
        sizes = all(c > 0 and s.endswith("]") and ".shape[" in s for s, c in form.terms) and form.constant >= 0
        return sizes or any(form == self.extents.reduced(p) for p in self.positive)


def _positive(statement: AST, extents: Extents) -> list[Affine]:
    """The end of a loop that counts upwards from 0 or more: it is positive where the body runs."""
    bounds = counted(statement)
    start = integer(bounds.start) if bounds and bounds.step > 0 else None
    if bounds is None or start is None or start < 0:
        return []
    form = extents.form(bounds.stop)
    return [] if form is None else [form]


def _first(loop: AST, free: Names, types: Mapping[str, Type], signs: Signs) -> tuple[AST, list[AST]]:
    """An innermost loop, and what binds the remainders that are the same for all of its iterations, and that each of
    them computes: by a divisor that is 0 none may be had where the loop has none."""
    bounds = counted(loop)
    if not isinstance(loop, For) or bounds is None or not is_straight(loop.body, signs.extents.writing):
        return loop, []
    bound = {bounds.counter, *changed(loop.body), *(base_name(t) for t in stores(loop.body))}
    always = {dump(n) for s in loop.body if not isinstance(s, If) for n in _always(s) if _goes_around(n)}
    found = {text: n for s in walk(loop.body) if isinstance(s, Subscript) for n in walk(s.slice)
             if _goes_around(n) and is_whole(n, types) and not bound & set(names(n))
             and not any(isinstance(m, Call) for m in walk(n))
             and ((text := dump(n)) in always or integer(n.right) not in (None, 0))}
    held = {text: free.fresh("around") for text in found}

    def change(node: AST) -> AST | None:
        return name(held[text]) if _goes_around(node) and (text := dump(node)) in held else None

    def value(around: BinOp) -> AST:
        return call("builtins.max", copy(around), const(0)) if signs.never_negative(around.right) else copy(around)
    before = [at(assign(held[text], value(n)), loop) for text, n in found.items()]
    return at(For(loop.target, loop.iter, rebuild(loop.body, change), [], None), loop) if held else loop, before


def _goes_around(node: AST) -> TypeGuard[BinOp]:
    """Whether a node is a remainder."""
    return isinstance(node, BinOp) and isinstance(node.op, Mod)


def _always(node: AST) -> Iterator[AST]:
    """The expressions in a statement that are computed whenever it runs."""
    yield node
    below = [node.test] if isinstance(node, IfExp) else children(node)
    if isinstance(node, BoolOp) or isinstance(node, Compare) and len(node.ops) > 1:
        below = below[:1]
    for child in below:
        yield from _always(child)


def _if_run(loop: AST, body: list[AST]) -> AST:
    """The body where the loop runs at all."""
    bounds = counted(loop)
    assert bounds is not None
    return at(If(compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop)), body, []), loop)


def _split(loop: AST, extents: Extents, free: Names, types: Mapping[str, Type]) -> list[AST] | None:
    """The loops for an innermost loop along an axis around which an index goes, None for any other statement."""
    bounds = counted(loop)
    if not isinstance(loop, For) or bounds is None or bounds.step < 0 or integer(bounds.start) != 0 or not is_straight(
            loop.body, extents.writing):
        return None
    around = {dump(n): n for n in walk(loop.body) if _goes_around(n) and bounds.counter in names(n.left)}
    stop = extents.form(bounds.stop)
    if not around or stop is None or not all(
            extents.form(n.right) == stop and is_whole(n, types) for n in around.values()):
        return None
    shifts = [shifted_by(n.left, bounds.counter) for n in around.values()]
    known = [s for s in shifts if s is not None]
    if len(known) == len(shifts) and max(map(abs, known)) <= _FURTHEST:
        return _peeled(loop, bounds, known)
    one = next(iter(around.values()))
    return _two(loop, bounds, one, free) if len(around) == 1 and _is_shifted(one, loop, bounds) else None


def _peeled(loop: For, bounds: Counted, shifts: list[int]) -> list[AST]:
    """The iterations near the ends as they are, and those between without remainders."""
    low, high = max(0, -min(shifts)), max(0, *shifts)
    stop, last = bounds.stop, simple(shifted(copy(bounds.stop), -high), integers=True)

    def straight(node: AST) -> AST | None:
        return simple(copy(node.left), integers=True) if _goes_around(node) and bounds.counter in names(
            node.left) else None
    made: list[AST] = []
    if low:
        made.append(counted_for(bounds.counter, [call("builtins.min", const(low), copy(stop))], copy(loop.body)))
    made.append(counted_for(bounds.counter, [const(low), last] if low else [last], rebuild(loop.body, straight)))
    if high:
        first = call("builtins.max", copy(last), call("builtins.min", const(low), copy(stop)) if low else const(0))
        made.append(counted_for(bounds.counter, [first, copy(stop)], copy(loop.body)))
    return [at(s, loop) for s in made]


def _is_shifted(around: BinOp, loop: For, bounds: Counted) -> bool:
    """Whether an index is the counter and something that the loop does not change."""
    rest = _rest(around, bounds)
    bound = {bounds.counter, *changed(loop.body), *(base_name(t) for t in stores(loop.body))}
    return rest is not None and not bound & set(names(rest)) and not any(isinstance(n, Call) for n in walk(rest))


def _rest(around: BinOp, bounds: Counted) -> AST | None:
    """The index where the counter is 0; None if it is not the first or the last operand of a sum."""
    left = around.left
    if not isinstance(left, BinOp) or shifted_by(left.left, bounds.counter) != 0 or type(left.op).__name__ not in (
            "Add", "Sub"):
        return None
    return copy(left.right) if type(left.op).__name__ == "Add" else sub(const(0), copy(left.right))


def _two(loop: For, bounds: Counted, around: BinOp, free: Names) -> list[AST]:
    """The loop up to where the index begins again, and from there."""
    turn, rest, text = free.fresh("turn"), free.fresh("rest"), dump(around)
    moved = _rest(around, bounds)
    assert moved is not None

    def before(node: AST) -> AST | None:
        return add(name(bounds.counter), name(turn)) if _goes_around(node) and dump(node) == text else None

    def behind(node: AST) -> AST | None:
        if _goes_around(node) and dump(node) == text:
            return name(bounds.counter)
        is_counter = isinstance(node, Name) and node.id == bounds.counter
        return add(name(bounds.counter), name(rest)) if is_counter else None
    made = [assign(turn, call("builtins.max", BinOp(moved, Mod(), copy(bounds.stop)), const(0))),
            assign(rest, call("builtins.max", sub(copy(bounds.stop), name(turn)), const(0))),
            counted_for(bounds.counter, [name(rest)], rebuild(loop.body, before)),
            counted_for(bounds.counter, [name(turn)], rebuild(loop.body, behind))]
    return [_if_run(loop, made)]


__all__ = ["turned"]
