"""index_set_splitting: a loop with a periodic subscript runs as several loops whose subscripts are affine.

    def f(u: float64[:], w: float64[:]):
        n = u.size
        for j in range(n):
            w[j] = u[(j - 1) % n]

in its adjoint:

    def f_adjoint(...):                     def f_adjoint(...):
        n = u.size                              n = u.size
        for j in range(n):                      for j in range(min(1, n)):
            seed = w_bar[j]                         seed = w_bar[j]
            w_bar[j] = 0.0                          w_bar[j] = 0.0
            u_bar[(j - 1) % n] += seed              u_bar[(j - 1) % n] += seed
                                                for j in range(1, n):
                                                    seed = w_bar[j]
                                                    w_bar[j] = 0.0
                                                    u_bar[j - 1] += seed

A shift that is not a constant, and shifts to both sides:

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

*Requires* text for Numba. *Establishes* the same iterations in the same order. A loop-invariant remainder is hoisted. A
remainder takes as long as ten sums, and prevents vectorization.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeGuard

from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import integer_literal, add_constant, simplify_index
from s2sad.optimize.loop_bounds import (
    CountedLoop, bound_names, counted_loop, is_loop_free, counter_offset, stored_elements,
)
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.simplify.context import DerivativeContext
from s2sad.simplify.integer_expressions import is_integer, with_counters
from s2sad.tree import (
    AST, BinOp, BoolOp, Call, Compare, For, FunctionDef, Gt, If, IfExp, Lt, Mod, Name, Subscript, add, assign, at,
    call, children, compare, const, copy, counted_for, dump, name, names, rebuild, sub, walk, with_body,
)

CHANGES_ROUNDING = False

_LARGEST_OFFSET = 4


def index_set_splitting(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such loops as several; those that call a function that writes arrays stay."""
    free = Names({n.id for n in walk(function) if isinstance(n, Name)})
    extents, types = IterationSpaces(function, context.writing), with_counters(context.types, function)

    def block(statements: list[AST], positive: list[Affine]) -> list[AST]:
        known = dict(extents.equal)
        made: list[AST] = []
        for statement in statements:
            extents.assume(statement)
            inside = positive + _positive_stop(statement, extents)
            inner = with_blocks(statement, lambda inner, inside=inside: block(inner, inside))
            loop, before = _hoist_remainders(inner, free, types, Signs(extents, inside))
            loops = _split_loop(loop, extents, free, types) or [loop]
            made += [_guarded(loop, [*before, *loops])] if before else loops
        extents.equal = known
        return made
    return with_body(function, block(function.body, []))


@dataclass(frozen=True)
class Signs:
    """What is known of the sign of an integer in a loop: `positive` are the stops of the enclosing loops, whose bodies
    run."""
    extents: IterationSpaces
    positive: list[Affine]

    def is_nonnegative(self, node: AST) -> bool:
        form = self.extents.form(node)
        if form is None:
            return False
        sizes = all(c > 0 and s.endswith("]") and ".shape[" in s for s, c in form.terms) and form.constant >= 0
        return sizes or any(form == self.extents.canonical(p) for p in self.positive)


def _positive_stop(statement: AST, extents: IterationSpaces) -> list[Affine]:
    """The stop of a loop that counts upwards from 0 or more: it is positive where the body runs."""
    bounds = counted_loop(statement)
    start = integer_literal(bounds.start) if bounds and bounds.step > 0 else None
    if bounds is None or start is None or start < 0:
        return []
    form = extents.form(bounds.stop)
    return [] if form is None else [form]


def _hoist_remainders(loop: AST, free: Names, types: Mapping[str, Type], signs: Signs) -> tuple[AST, list[AST]]:
    """An innermost loop without its invariant remainders, and the bindings of these. Only such as each iteration
    computes: an empty loop must not divide by 0."""
    bounds = counted_loop(loop)
    if not isinstance(loop, For) or bounds is None or not is_loop_free(loop.body, signs.extents.writing):
        return loop, []
    bound = {bounds.counter, *bound_names(loop.body), *(base_name(t) for t in stored_elements(loop.body))}
    always = {dump(n) for s in loop.body if not isinstance(s, If) for n in _unconditional(s) if _is_remainder(n)}
    found = {text: n for s in walk(loop.body) if isinstance(s, Subscript) for n in walk(s.slice)
             if _is_remainder(n) and is_integer(n, types) and not bound & set(names(n))
             and not any(isinstance(m, Call) for m in walk(n))
             and ((text := dump(n)) in always or integer_literal(n.right) not in (None, 0))}
    held = {text: free.fresh("around") for text in found}

    def change(node: AST) -> AST | None:
        return name(held[text]) if _is_remainder(node) and (text := dump(node)) in held else None

    def value(around: BinOp) -> AST:
        return call("builtins.max", copy(around), const(0)) if signs.is_nonnegative(around.right) else copy(around)
    before = [at(assign(held[text], value(n)), loop) for text, n in found.items()]
    return at(For(loop.target, loop.iter, rebuild(loop.body, change), [], None), loop) if held else loop, before


def _is_remainder(node: AST) -> TypeGuard[BinOp]:
    """Whether a node is a remainder."""
    return isinstance(node, BinOp) and isinstance(node.op, Mod)


def _unconditional(node: AST) -> Iterator[AST]:
    """The expressions in a statement that are evaluated whenever it runs."""
    yield node
    below = [node.test] if isinstance(node, IfExp) else children(node)
    if isinstance(node, BoolOp) or isinstance(node, Compare) and len(node.ops) > 1:
        below = below[:1]
    for child in below:
        yield from _unconditional(child)


def _guarded(loop: AST, body: list[AST]) -> AST:
    """The body under the test that the loop runs at all."""
    bounds = counted_loop(loop)
    assert bounds is not None
    return at(If(compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop)), body, []), loop)


def _split_loop(loop: AST, extents: IterationSpaces, free: Names, types: Mapping[str, Type]) -> list[AST] | None:
    """The loops for an innermost loop along an axis with a periodic subscript, None for any other statement."""
    bounds = counted_loop(loop)
    if not isinstance(loop, For) or bounds is None or bounds.step < 0 or integer_literal(
            bounds.start) != 0 or not is_loop_free(loop.body, extents.writing):
        return None
    around = {dump(n): n for n in walk(loop.body) if _is_remainder(n) and bounds.counter in names(n.left)}
    stop = extents.form(bounds.stop)
    if not around or stop is None or not all(
            extents.form(n.right) == stop and is_integer(n, types) for n in around.values()):
        return None
    shifts = [counter_offset(n.left, bounds.counter) for n in around.values()]
    known = [s for s in shifts if s is not None]
    if len(known) == len(shifts) and max(map(abs, known)) <= _LARGEST_OFFSET:
        return _peel_ends(loop, bounds, known)
    one = next(iter(around.values()))
    if len(around) > 1 or not _has_invariant_offset(one, loop, bounds):
        return None
    return _split_at_wraparound(loop, bounds, one, free)


def _peel_ends(loop: For, bounds: CountedLoop, shifts: list[int]) -> list[AST]:
    """The iterations near the ends as they are, and those between without remainders."""
    low, high = max(0, -min(shifts)), max(0, *shifts)
    stop, last = bounds.stop, simplify_index(add_constant(copy(bounds.stop), -high), integers=True)

    def straight(node: AST) -> AST | None:
        return simplify_index(copy(node.left), integers=True) if _is_remainder(node) and bounds.counter in names(
            node.left) else None
    made: list[AST] = []
    if low:
        made.append(counted_for(bounds.counter, [call("builtins.min", const(low), copy(stop))], copy(loop.body)))
    made.append(counted_for(bounds.counter, [const(low), last] if low else [last], rebuild(loop.body, straight)))
    if high:
        first = call("builtins.max", copy(last), call("builtins.min", const(low), copy(stop)) if low else const(0))
        made.append(counted_for(bounds.counter, [first, copy(stop)], copy(loop.body)))
    return [at(s, loop) for s in made]


def _has_invariant_offset(around: BinOp, loop: For, bounds: CountedLoop) -> bool:
    """Whether a periodic subscript is the counter plus or minus an invariant."""
    rest = _offset(around, bounds)
    bound = {bounds.counter, *bound_names(loop.body), *(base_name(t) for t in stored_elements(loop.body))}
    return rest is not None and not bound & set(names(rest)) and not any(isinstance(n, Call) for n in walk(rest))


def _offset(around: BinOp, bounds: CountedLoop) -> AST | None:
    """The subscript where the counter is 0; None if the counter is not the first operand of a sum."""
    left = around.left
    if not isinstance(left, BinOp) or counter_offset(left.left, bounds.counter) != 0 or type(left.op).__name__ not in (
            "Add", "Sub"):
        return None
    return copy(left.right) if type(left.op).__name__ == "Add" else sub(const(0), copy(left.right))


def _split_at_wraparound(loop: For, bounds: CountedLoop, around: BinOp, free: Names) -> list[AST]:
    """The loop up to where the subscript starts over, and from there."""
    turn, rest, text = free.fresh("turn"), free.fresh("rest"), dump(around)
    moved = _offset(around, bounds)
    assert moved is not None

    def before(node: AST) -> AST | None:
        return add(name(bounds.counter), name(turn)) if _is_remainder(node) and dump(node) == text else None

    def behind(node: AST) -> AST | None:
        if _is_remainder(node) and dump(node) == text:
            return name(bounds.counter)
        is_counter = isinstance(node, Name) and node.id == bounds.counter
        return add(name(bounds.counter), name(rest)) if is_counter else None
    made = [assign(turn, call("builtins.max", BinOp(moved, Mod(), copy(bounds.stop)), const(0))),
            assign(rest, call("builtins.max", sub(copy(bounds.stop), name(turn)), const(0))),
            counted_for(bounds.counter, [name(rest)], rebuild(loop.body, before)),
            counted_for(bounds.counter, [name(turn)], rebuild(loop.body, behind))]
    return [_guarded(loop, made)]


__all__ = ["index_set_splitting"]
