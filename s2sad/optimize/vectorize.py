"""vectorize: innermost loops of an adjoint in a form that a compiler vectorizes.

    def f(x: float64[:], y: float64[:], a):
        for i in range(1, x.size):
            y[i] = a * (x[i] - x[i - 1])

in its adjoint:

    def f_adjoint(...):                             def f_adjoint(...):
        ...                                             ...
        for i in range(1, x.size):                      if 1 < x.size:
            seed = y_bar[i]                                 x_bar_held = x_bar[0]
            y_bar[i] = 0.0                                  for i in range(1, x.size):
            seed_2 = a * seed                                   x_bar_held_2 = x_bar[i]
            a_bar += (x[i] - x[i - 1]) * seed                   seed = y_bar[i]
            x_bar[i] += seed_2                                  y_bar[i] = 0.0
            x_bar[i - 1] -= seed_2                              seed_2 = a * seed
        return (a_bar,)                                         a_bar = added(a_bar, (x[i] - x[i - 1]) * seed)
                                                                x_bar_held_2 += seed_2
                                                                x_bar_held -= seed_2
                                                                x_bar[i - 1] = x_bar_held
                                                                x_bar_held = x_bar_held_2
                                                            x_bar[x.size - 1] = x_bar_held
                                                        return (a_bar,)

`loop_fusion` fuses adjacent nests, `scalar_reductions` reduces in scalars. Where iterations share elements of a shadow:
`loop_distribution` adds to rows in loops of their own, `scalar_replacement` holds the elements in scalars,
`loop_peeling` splits off iterations where the others then need no test, and `tape_row_loads` restores rows of the tape
beforehand.

*Requires* a finished adjoint for Numba. *Establishes* the same sums in the same order, except that the derivative's own
accumulators in such loops are incremented in any order (`runtime.added`): partial sums round less.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.liveness import base_name
from s2sad.optimize.loop_bounds import (
    CountedLoop, bound_names, counted_loop, counter_offset, is_loop_free, stored_elements,
)
from s2sad.optimize.loop_nests import LoopPass
from s2sad.optimize.loop_peeling import loop_peeling
from s2sad.blocks import with_blocks
from s2sad.optimize.tape_row_loads import tape_row_loads
from s2sad.optimize.scalar_replacement import scalar_replacement
from s2sad.optimize.loop_distribution import loop_distribution
from s2sad.optimize.scalar_reductions import scalar_reductions
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Add, Assign, AugAssign, For, FunctionDef, Name, Sub, Subscript, assign, at, call, copy, dump, indices, name,
    names, negate, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = True

_MOST_STATEMENTS = 60


def vectorize(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The adjoint with its innermost loops transformed."""
    faster = _Vectorize({s: context.types[s] for s in context.gaining}, context.names, context.stacks, context.numbers,
                     context.writing)
    return with_body(function, faster.block(function.body, {}, None))


class _Vectorize(LoopPass):
    def __init__(self, shadows: Mapping[str, Type], free: Names, stacks: Set[str], sums: Set[str],
                 writing: Set[str]):
        self.shadows, self.free, self.stacks, self.sums = shadows, free, stacks, set(sums)
        self.writing = writing
        super().__init__()

    def statement(self, statement: AST, least: Mapping[str, int]) -> list[AST]:
        if counted_loop(statement) is not None and is_loop_free(statement.body, self.writing):
            return self.loop(statement, {c: n for c, n in least.items() if c != statement.target.id})
        return [self.with_inner_blocks(statement, least)]

    def loop(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """An innermost loop, transformed unless it is long."""
        if sum(1 for s in walk_statements(loop.body) if isinstance(s, (Assign, AugAssign))) > _MOST_STATEMENTS:
            return [loop]
        bounds = counted_loop(loop)
        assert bounds is not None
        held = scalar_reductions(loop, bounds, self.shadows, self.free)
        self.sums |= held.sums
        return held.enclose(self.vectorized(held.loop, least), bounds)

    def vectorized(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """The loops for a loop whose sums are scalars."""
        rows, rest = tape_row_loads(loop, self.stacks)
        bounds = counted_loop(rest)
        assert bounds is not None
        for before, middle, after in filter(None, (loop_peeling(rest, bounds), ([], rest, []))):
            made = self.without_sharing(middle, least)
            if made is not None:
                return [*rows, *before, *(self.reassociated(s) for s in made), *after]
        return [self.reassociated(loop) if _has_independent_iterations(loop, bounds) else loop]

    def without_sharing(self, loop: For, least: Mapping[str, int]) -> list[AST] | None:
        """The loops in which no iteration reads what another one stores, None if nothing has to be done or can be."""
        parts = loop_distribution(loop, self.shadows, self.free)
        if parts is None:
            return scalar_replacement(loop, least, self.shadows, self.free)
        first, *rest = parts.loops
        assert isinstance(first, For)
        self.hoisted += parts.allocations
        return [*(scalar_replacement(first, least, self.shadows, self.free) or [first]), *rest]

    def reassociated(self, statement: AST) -> AST:
        """The loops of a statement with accumulators that nothing else in them reads incremented in any order."""
        if isinstance(statement, For):
            return at(For(statement.target, statement.iter, self.with_free_order(statement.body), [], None), statement)
        return with_blocks(statement, lambda block: [self.reassociated(s) for s in block])

    def with_free_order(self, body: list[AST]) -> list[AST]:
        increments = [s for s in body if isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub))
                 and isinstance(s.target, Name) and s.target.id in self.sums]
        mentions = [n.id for n in walk(body) if isinstance(n, Name)]
        alone = {s.target.id for s in increments if mentions.count(s.target.id) == sum(
            g.target.id == s.target.id for g in increments)}
        return [self.in_free_order(s) if any(s is g for g in increments) and s.target.id in alone else s for s in body]

    def in_free_order(self, increment: AugAssign) -> AST:
        value = copy(increment.value) if isinstance(increment.op, Add) else negate(copy(increment.value))
        return at(assign(increment.target.id, call("runtime.added", name(increment.target.id), value)), increment)


def _has_independent_iterations(loop: For, bounds: CountedLoop) -> bool:
    """Whether each array that a loop stores into is referenced by one subscript, along a row."""
    places = {base_name(t): t for t in stored_elements(loop.body)}
    return all(counter_offset(indices(place)[-1], bounds.counter) is not None
               and not bound_names(loop.body) & set(names(place))
               and all(dump(n) == dump(place) for n in walk(loop.body)
                       if isinstance(n, Subscript) and base_name(n) == array)
               for array, place in places.items())


__all__ = ["vectorize"]
