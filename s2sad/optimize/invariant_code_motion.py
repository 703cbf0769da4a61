"""invariant_code_motion: a transcendental value that an outer loop does not change is computed before that loop.

    def f(w, x, n, m):
        t = 0.0
        for i in range(n):
            for j in range(m):
                t += np.exp(w[j]) * x[i]
        return t

in its adjoint:

    def f_adjoint(...):
        ...
        for i in range(n):
            for j in range(m):
                exp_value = np.exp(w[j])
                ...

becomes

    def f_adjoint(...):
        ...
        exp_table = np.empty(max(m, 0))
        if n > 0:
            for j in range(m):
                exp_table[j] = np.exp(w[j])
        for i in range(n):
            for j in range(m):
                exp_value = exp_table[j]
                ...

*Requires* finished text for Numba and the types of its names; a value that every iteration of the loops around it
computes, in a rectangular space, from what the outer loop neither binds nor writes. *Establishes* the same values. The
table is no larger than an array that it is made from, and is filled only if the loops would have read that. (Scalar
expansion and loop-invariant code motion: Allen, Kennedy, Optimizing Compilers for Modern Architectures, 2001.)
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.naming import Names
from s2sad.optimize.expensive_values import changed_names, is_double, is_expensive
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_bounds import CountedLoop, bound_names, counted_loop, counter_offset
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, And, Assign, Attribute, AugAssign, BoolOp, Break, Constant, Continue, For, FunctionDef, Gt, If, IfExp, Name,
    Return, Subscript, While, assign, at, call, call_name, compare, const, copy, counted_for, dump, index, indices,
    name, names, rebuild, times_bound, tuple_of, walk, walk_statements,
)

CHANGES_ROUNDING = False
_LARGEST = 40       # nodes of an argument: what is longer is not spelled out


def invariant_code_motion(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such values in tables."""
    if not any(map(is_expensive, walk(function.body))):
        return function
    new, motion = copy(function), _InvariantCodeMotion(function, context)
    new.body = []
    for statement in function.body:
        made = motion.moved(statement)
        new.body += [*motion.allocations, *made]
        motion.allocations = []
    return new


@dataclass
class _Invariant:
    """A call whose value an outer loop does not change: what it is made of, the loops that it varies with, those around
    it that it does not vary with, and its statement."""
    node: AST
    argument: AST
    loops: list[CountedLoop]
    others: list[CountedLoop]
    statement: AST

    @property
    def key(self) -> str:
        """The same for values that one table holds."""
        numbers = {loop.counter: name(f"counter {k}") for k, loop in enumerate(self.loops)}
        renamed = rebuild(self.argument, lambda n: numbers.get(n.id) if isinstance(n, Name) else None)
        spaces = [[dump(b) for b in loop.upwards()] for loop in (*self.loops, *self.others)]
        return f"{call_name(self.node)} {dump(renamed)} {len(self.loops)} {spaces}"

    @property
    def test(self) -> AST:
        """Whether the loops run that the value does not vary with."""
        tests = [compare(bounds[-1], Gt(), bounds[0] if len(bounds) == 2 else const(0))
                 for bounds in (x.upwards() for x in self.others)]
        return tests[0] if len(tests) == 1 else BoolOp(And(), tests)


class _InvariantCodeMotion:
    """One function; `allocations` are those of the tables for its current statement."""

    def __init__(self, function: FunctionDef, context: DerivativeContext):
        self.types, self.writing = context.types, context.writing
        self.extents = IterationSpaces(function, self.writing)
        self.free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(self.types))
        self.sharing = _sharing(function, self.types)
        self.allocations: list[AST] = []
        self.rebound: set[str] = set()      # by the outer loop

    def moved(self, statement: AST) -> list[AST]:
        """A statement behind what is computed before it; outer loops first."""
        if not isinstance(statement, (For, While, If)) or not any(map(is_expensive, walk(statement))):
            return [statement]
        filled: list[AST] = []
        if isinstance(statement, For):
            statement, filled = self.loop(statement)
        return [*filled, with_blocks(statement, lambda block: [x for s in block for x in self.moved(s)])]

    def loop(self, loop: For) -> tuple[For, list[AST]]:
        """A loop that reads tables, and what fills them."""
        tables: dict[str, str] = {}
        places: dict[int, AST] = {}
        filled: dict[str, If] = {}
        kept: set[int] = set()      # nodes of values in tables: what is within one is computed no more
        for value in self.invariants(loop):
            if id(value.node) in kept:
                continue
            if value.key not in tables:
                tables[value.key] = self.table(value)
                made = filled.setdefault(dump(value.test), If(value.test, [], []))
                made.body.append(_filled(tables[value.key], value))
            places[id(value.node)] = index(name(tables[value.key]), *(name(x.counter) for x in value.loops))
            kept |= {id(n) for n in walk(value.node)}
        new = rebuild(loop, lambda n: copy(places[id(n)]) if id(n) in places else None) if places else loop
        assert isinstance(new, For)
        return new, [*filled.values()]

    def table(self, value: _Invariant) -> str:
        """The name of a new table."""
        made = self.free.fresh(f"{str(call_name(value.node)).rpartition('.')[2]}_table")
        stops = [x.upwards()[-1] for x in value.loops]
        sizes = [copy(s) if _is_size(s) else call("builtins.max", copy(s), const(0)) for s in stops]
        self.allocations.append(assign(made, call("numpy.empty", sizes[0] if len(sizes) == 1 else tuple_of(*sizes))))
        return made

    def invariants(self, loop: For) -> Iterator[_Invariant]:
        """The values in a loop that it does not change, and that each of its iterations computes."""
        outer = counted_loop(loop)
        if outer is None or any(isinstance(n, (Break, Continue, Return)) for n in walk_statements(loop.body)):
            return
        changed = changed_names(loop, self.writing)
        for group in self.sharing:
            changed |= group if group & changed else set()
        self.rebound = bound_names([loop])
        yield from self.within(loop.body, [outer], {}, changed | {outer.counter})

    def within(self, block: list[AST], around: list[CountedLoop], known: Mapping[str, AST], changed: set[str]
               ) -> Iterator[_Invariant]:
        """Those in a block; `known` are the names bound around it to what the outer loop does not change."""
        times, bound = times_bound(block, Assign, AugAssign), dict(known)
        counters = {x.counter for x in around[1:]}
        for statement in block:
            if isinstance(statement, For):
                inner = counted_loop(statement)
                if inner is not None and self.is_rectangular(inner, changed | counters):
                    yield from self.within(statement.body, [*around, inner], bound, changed | {inner.counter})
                continue
            if isinstance(statement, (If, While)):
                continue
            free = changed - counters
            chosen = {id(n) for c in walk(statement) if isinstance(c, (BoolOp, IfExp)) for n in walk(c)}
            for node in walk(statement):
                if is_expensive(node) and len(node.args) == 1 and id(node) not in chosen:
                    argument = _spelled(node.args[0], bound)
                    found = _Invariant(node, argument, *_split(around, argument), statement)
                    if not free & set(names(argument)) and self.is_worth_a_table(found):
                        yield found
            target = statement.targets[0] if isinstance(statement, Assign) else None
            if isinstance(target, Name) and times[target.id] == 1:
                value = _spelled(statement.value, bound)
                if not free & set(names(value)) and sum(1 for _ in walk(value)) <= _LARGEST:
                    bound[target.id] = value

    def is_rectangular(self, loop: CountedLoop, changed: set[str]) -> bool:
        """Whether a loop has the same bounds each time that it runs: what is stored into an array leaves its sizes."""
        parts = [n for n in walk([loop.start, loop.stop]) if isinstance(n, Attribute) and n.attr in ("shape", "size")]
        sizes = {id(n.value) for n in parts}
        return not any(n.id in self.rebound or id(n) not in sizes and n.id in changed
                       for n in walk([loop.start, loop.stop]) if isinstance(n, Name))

    def is_worth_a_table(self, value: _Invariant) -> bool:
        """Whether a value has a table's place: numbers of an array's elements, each read by its own counters."""
        counters = [x.counter for x in value.loops]
        if not counters or not is_double(value.argument, self.types, counters):
            return False
        for loop in value.loops:
            first = loop.upwards()[0] if len(loop.upwards()) == 2 else const(0)
            if not (isinstance(first, Constant) and first.value >= 0) or not set(
                    names(loop.upwards()[-1])) <= self.extents.fixed:
                return False
        return any(isinstance(n, Subscript) and isinstance(n.value, Name) and all(
            any(counter_offset(s, c) is not None for s in indices(n)) for c in counters) for n in walk(value.argument))


def _filled(table: str, value: _Invariant) -> AST:
    """What fills a table."""
    made = copy(value.node)
    made.args = [copy(value.argument)]
    place = index(name(table), *(name(x.counter) for x in value.loops))
    block: AST = at(Assign([place], made, None), value.statement)
    for loop in reversed(value.loops):
        block = counted_for(loop.counter, loop.upwards(), [block])
    return block


def _is_size(node: AST) -> bool:
    """Whether a number is a size of an array, which is never negative."""
    sized = node.value if isinstance(node, Subscript) else node
    return isinstance(sized, Attribute) and sized.attr in ("shape", "size")


def _split(around: list[CountedLoop], argument: AST) -> tuple[list[CountedLoop], list[CountedLoop]]:
    """The loops whose counters an argument has, and the others."""
    read = set(names(argument))
    return [x for x in around if x.counter in read], [x for x in around if x.counter not in read]


def _spelled(node: AST, bound: Mapping[str, AST]) -> AST:
    """An expression with what names are bound to in their place."""
    return rebuild(node, lambda n: copy(bound[n.id]) if isinstance(n, Name) and n.id in bound else None)


def _sharing(function: FunctionDef, types: Mapping[str, Type]) -> list[set[str]]:
    """The names that may stand for the same memory: those that are bound to parts of an array, with that array."""
    groups: list[set[str]] = []
    for n in walk_statements(function.body):
        target = n.targets[0] if isinstance(n, Assign) else None
        if isinstance(target, Name) and target.id in types and types[target.id].is_array and isinstance(
                n.value, (Name, Subscript)):
            own = {target.id, base_name(n.value)}
            groups = [g for g in groups if not g & own] + [own.union(*(g for g in groups if g & own))]
    return groups


__all__ = ["invariant_code_motion"]
