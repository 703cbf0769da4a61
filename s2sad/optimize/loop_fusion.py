"""loop_fusion: nests over one iteration space become one nest.

    def f(x: float64[:], y: float64[:], z: float64[:]):
        y[:] = np.sin(x)
        z[:] = x * y

in its adjoint:

    def f_adjoint(...):                         def f_adjoint(...):
        ...                                         ...
        for i in range(z.shape[0]):                 for i in range(y.shape[0]):
            seed = z_bar[i]                             y[i] = np.sin(x[i])
            z_bar[i] = 0.0                              seed = z_bar[i]
            x_bar[i] += y[i] * seed                     z_bar[i] = 0.0
            y_bar[i] += x[i] * seed                     x_bar[i] += y[i] * seed
        for i in range(y.shape[0]):                     y_bar[i] += x[i] * seed
            seed = y_bar[i]                             seed = y_bar[i]
            y_bar[i] = 0.0                              y_bar[i] = 0.0
            x_bar[i] += np.cos(x[i]) * seed             x_bar[i] += np.cos(x[i]) * seed

*Requires* a finished derivative for Numba (`primal_contraction` fuses nests of a kernel). *Establishes* the same values
with one pass through memory; `array_contraction` then contracts what nothing else reads. Fusion is legal where an array
that one nest writes is referenced by the other at the element of the same iteration only, or in a row of another
number, which loops around may count, and no scalar flows between iterations, except sums whose order is free; and where
the first nest may move behind what is between them. (Kennedy, McKinley, 1993.)
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import add_constant, simplify_index
from s2sad.optimize.loop_bounds import are_apart, bound_names, counted_loop, counter_offset, stored_elements
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_nests import Nest, least_inside, perfect_nest
from s2sad.optimize.array_contraction import Mentions, Contractible
from s2sad.optimize.statement_order import is_accumulator, may_move_behind, upward_exposed
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Break, FunctionDef, Name, Return, Subscript,
    copy, dump, indices, is_comment, name, names, rebuild, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = False

_MOST_STATEMENTS, _MOST_PAIRS, _MOST_CROSSED = 96, 60, 8


def loop_fusion(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with its nests joined."""
    context.names = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(context.types))
    return fused(function, context.numbers, context.types, context.names, context.writing)


def fused(function: FunctionDef, sums: Set[str], types: Mapping[str, Type], free: Names,
          writing: Set[str] = frozenset()) -> FunctionDef:
    """The function with its nests joined; `sums` are numbers whose gains come in any order, `writing`
    the functions that write arrays."""
    extents = IterationSpaces(function, writing)
    between = Contractible(function, extents, types, free, finished=True)
    fusion = LoopFusion(extents, sums, between, given={p.id for p in function.args.args})
    return between.contract_apart(with_body(function, fusion.block(function.body)), extents)


class LoopFusion:
    """The pass over one function; `only_producers` fuses only a producer of an array with its one consumer. The arrays
    `given` to the function share no memory with any other."""

    def __init__(self, extents: IterationSpaces, sums: Set[str], between: Contractible, only_producers: bool = False,
                 given: Set[str] = frozenset()):
        self.extents, self.sums, self.between, self.only_producers = extents, sums, between, only_producers
        self.given = given
        self.asserted: dict[tuple[str, ...],
                            list[Assert]] = {}   # what every iteration has asserted, by the loops around
        self.enclosing: tuple[str, ...] | None = ()                # their bounds; None inside of a branch
        self.least: dict[str, int] = {}                            # lower bounds of the counters around

    def nested(self, statement: AST) -> AST:
        """A statement with its blocks fused. A loop that runs only if another one has run may rely on that one's
        assertions, since sizes do not change."""
        bounds, outer, known = counted_loop(statement), self.enclosing, dict(self.extents.equal)
        least, self.least = self.least, least_inside(statement, self.least)
        fixed = bounds is not None and all(
            self.extents.form(b) is not None for b in (bounds.start, bounds.stop)) and not any(
            isinstance(n, (Break, Return)) for n in walk_statements(statement))
        self.enclosing = (*outer, dump(bounds.upwards())) if bounds and fixed and outer is not None else None
        for assertion in self.asserted.get(self.enclosing, []) if self.enclosing else []:
            self.extents.assume(assertion)
        new = with_blocks(statement, self.block)
        if self.enclosing:
            self.asserted.setdefault(self.enclosing, []).extend(s for s in statement.body if isinstance(s, Assert))
        self.extents.equal, self.enclosing, self.least = known, outer, least
        return new

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST | Nest] = []
        known = dict(self.extents.equal)
        for statement in block:
            self.extents.assume(statement)
            nest = perfect_nest(statement, self.extents)
            place, both = self.partner(made, nest) if nest is not None else (0, None)
            if both is not None:
                del made[place]
            made.append(both or nest or self.nested(statement))
        self.between.contract([n for n in made if isinstance(n, Nest)], self.extents)
        self.extents.equal = known
        return [s.with_body(s.body) if isinstance(s, Nest) else s for s in made]

    def partner(self, made: list[AST | Nest], nest: Nest) -> tuple[int, Nest | None]:
        """Where the nest stands that becomes one with another one, behind what is between them, and that one."""
        for place in reversed(range(max(0, len(made) - _MOST_CROSSED - 1), len(made))):
            first = made[place]
            if isinstance(first, Nest) and all(may_move_behind(
                    first, s, self.extents.own, self.between.types) for s in made[place + 1:]):
                both = self.fused(first, nest)
                if both is not None:
                    return place, both
            if self.only_producers and not isinstance(first, Assert) and not is_comment(first):
                break
        return 0, None

    def fused(self, first: Nest, second: Nest) -> Nest | None:
        """Two nests as one, with the counters of the first; None if fusion is not legal or not worth it. An array that
        is only produced for the second nest has no size of its own: then the second nest's bounds are kept."""
        runs = list(map(self.extents.canonical, first.trip_counts))
        size = _statement_count(first.body) + _statement_count(second.body)
        if runs != second.trip_counts or size > _MOST_STATEMENTS:
            return None
        if {*bound_names(first.body), *first.counters} & second.bounds or bound_names(second.body) & first.bounds:
            return None
        if self.only_producers and first.starts == second.starts:
            given, body = _with_counters_of(second, first), second.body
            first = Nest(second.loops, second.starts, second.trip_counts, given or [])
        else:
            given, body = first.body, _with_counters_of(first, second)
        if given is None or body is None or not self.is_legal(first, body) or _alias_pairs(
                [*first.body, *body], self.given, first.counters[-1]) > _MOST_PAIRS:
            return None
        if self.only_producers and not self.between.is_produced_for(first.body, body):
            return None
        return Nest(first.loops, first.starts, first.trip_counts, [*first.body, *body])

    def is_legal(self, first: Nest, body: list[AST]) -> bool:
        """Whether each iteration of the second nest may run right after that of the first."""
        arrays = _subscripted_arrays(first.body) | _subscripted_arrays(body)
        for array in sorted(arrays):
            if not self.is_legal_for(array, first, body):
                return False
        if any(array not in self.extents.own for array in arrays):
            return False
        shared = (bound_names(first.body) & upward_exposed(body)) | (bound_names(body) & upward_exposed(first.body))
        return all(n in self.sums and is_accumulator(n, [*first.body, *body]) for n in shared - arrays)

    def is_legal_for(self, array: str, first: Nest, body: list[AST]) -> bool:
        """Whether an array that one nest writes is referenced by the other at the same element only, or in other rows,
        or not at all."""
        places = [[n for n in walk(b) if isinstance(n, Subscript) and base_name(n) == array]
                  for b in (first.body, body)]
        if not any(base_name(t) == array for t in stored_elements([*first.body, *body])):
            return True
        if not all(places):
            return Mentions([*first.body, *body]).only_by_elements(array)
        stores = {id(t) for t in stored_elements([*first.body, *body])}
        bound = bound_names(first.body) | bound_names(body)
        around = {c: k for c, k in self.least.items() if c not in first.counters}   # the same in all iterations
        both = [(a, b) for a in places[0] for b in places[1] if id(a) in stores or id(b) in stores]
        return Mentions([*first.body, *body]).only_by_elements(array) and all(
            are_apart(a, b, around) or dump(a.slice) == dump(b.slice) and not bound & set(names(a.slice)) and set(
                first.counters) <= {c for s in indices(a) for c in first.counters if counter_offset(s, c) is not None}
            for a, b in both)


def _with_counters_of(nest: Nest, other: Nest) -> list[AST] | None:
    """The body of another nest in terms of a nest's counters; None if these names mean something else there."""
    if any(a != b and a in names(other.body) for a, b in zip(nest.counters, other.counters)):
        return None
    there = {b: simplify_index(add_constant(name(a), t.constant - s.constant), integers=True)
             for a, b, s, t in zip(nest.counters, other.counters, nest.starts, other.starts)}

    def change(node: AST) -> AST | None:
        return copy(there[node.id]) if isinstance(node, Name) and node.id in there else None
    return [simplify_index(rebuild(s, change), integers=False) for s in other.body]


def _statement_count(body: list[AST]) -> int:
    return sum(isinstance(s, (Assign, AugAssign)) for s in walk_statements(body))


def _subscripted_arrays(body: list[AST]) -> set[str]:
    return {base_name(n) for n in walk(body) if isinstance(n, Subscript) and isinstance(n.value, Name)}


def _alias_pairs(body: list[AST], given: Set[str], counter: str) -> int:
    """How many pairs of arrays the compiler's run-time alias test compares before the vectorized loop: of those that
    the function makes itself. A loop that stores along columns has no vectors, and no test."""
    stored = stored_elements(body)
    if any(counter in names(indices(t)[:-1]) for t in stored):
        return 0
    written = {base_name(t) for t in stored} - given
    others = _subscripted_arrays(body) - written - given
    return len(written) * (len(written) - 1) // 2 + len(written) * len(others)


__all__ = ["LoopFusion", "fused", "loop_fusion"]
