"""loop_memoization: a transcendental value of the forward sweep is stored for the reverse sweep of the same iteration.

    def f(w, n, m):
        h = np.zeros(m)
        t = 0.0
        for s in range(n):
            for j in range(m):
                h[j] = np.tanh(w[j] * s)
            for j in range(m):
                t += h[j] * h[0]
        return t

in its adjoint:

    def f_adjoint(...):
        ...
        for s in range(n - 1, -1, -1):
            for j in range(m):
                h[j] = np.tanh(w[j] * s)
            ...
            for j in range(m):
                seed = h_bar[j]
                h_bar[j] = 0.0
                w_bar[j] += s * ((1.0 / np.cosh(w[j] * s)) ** 2 * seed)

becomes

    def f_adjoint(...):
        ...
        slope_kept = np.empty(max(m, 0))
        for s in range(n - 1, -1, -1):
            for j in range(m):
                h[j] = np.tanh(w[j] * s)
                slope_kept[j] = (1.0 / np.cosh(w[j] * s)) ** 2
            ...
            for j in range(m):
                seed = h_bar[j]
                h_bar[j] = 0.0
                w_bar[j] += s * (slope_kept[j] * seed)

*Requires* finished text for Numba and the types of its names; two nests over one iteration space in one block, between
which nothing writes an operand. *Establishes* the same values. Where an array of the kernel still holds the value, it
is read there; else one buffer serves all iterations of the enclosing loop, and where there is none the value is
computed again: that buffer would be a tape. The derivative of tanh, which is computed beside it, shares its exponential
(`runtime.sech_squared`).
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass

from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.optimize.expensive_values import changed_names, is_double, is_expensive
from s2sad.optimize.loop_bounds import counted_loop, stored_elements
from s2sad.optimize.vector_math import cosh_of_tanh_derivative, tanh_derivative
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_nests import Nest, perfect_nest
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BoolOp, For, FunctionDef, If, IfExp, Name, Subscript, While,
    assign, at, call, call_name, const, copy, dump, index, indices, name, names, rebuild, times_bound, tuple_of,
    walk,
)

CHANGES_ROUNDING = False


def loop_memoization(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such values kept; `writing` are the functions that write arrays."""
    types, writing = context.types, context.writing
    if not any(map(is_expensive, walk(function.body))):
        return function
    new, found = copy(function), _LoopMemoization(function, types, writing)
    new.body = found.whole_body(function.body)
    return new


@dataclass
class _ExpensiveValue:
    """An expensive call in a statement of a nest, or the derivative of tanh, and its argument in terms of the counters;
    `unconditional` if every iteration computes it."""
    statement: AST
    node: AST
    function: str
    argument: AST
    unconditional: bool

    def key(self, counters: list[str]) -> tuple[str, str]:
        """What is equal for equal values of nests whose counters have other names."""
        places = {c: name(f"<{k}>") for k, c in enumerate(counters)}
        return self.function, dump(rebuild(self.argument, lambda n: places.get(n.id) if isinstance(n, Name) else None))

    def offered(self, counters: list[str]) -> list[tuple[str, str]]:
        """The keys of the values that can be computed where this one is."""
        function, argument = self.key(counters)
        return [(function, argument)] + [("slope", argument)] * function.endswith(".tanh")


@dataclass
class _Source:
    """A value that a nest computes, and the position of the nest in its block."""
    position: int
    nest: Nest
    value: _ExpensiveValue


class _Block:
    """A block on the way through it: the nests so far, the values that they offer, latest last, and where each name was
    last changed."""

    def __init__(self) -> None:
        self.nests: dict[int, Nest] = {}
        self.offers: dict[tuple[str, str], list[_Source]] = {}
        self.changed: dict[str, int] = {}

    def offer(self, position: int, nest: Nest) -> None:
        """Adds the values of a nest."""
        self.nests[position] = nest
        for value in _expensive_values(nest):
            for key in value.offered(nest.counters) if value.unconditional else []:
                self.offers.setdefault(key, []).append(_Source(position, nest, value))


class _LoopMemoization:
    """One function; `allocations` are those of the buffers for its current statement."""

    def __init__(self, function: FunctionDef, types: Mapping[str, Type], writing: Set[str]):
        self.extents, self.types, self.writing = IterationSpaces(function, writing), types, writing
        self.free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(types))
        self.allocations: list[AST] = []

    def whole_body(self, body: list[AST]) -> list[AST]:
        """The function's own block, in which only arrays of the kernel are read again: a buffer would be a tape."""
        made: list[AST] = []
        block = _Block()
        for statement in body:
            self.extents.assume(statement)
            inner = with_blocks(statement, self.block) if isinstance(statement, (For, While)) else statement
            made += [*self.allocations, inner]
            self.allocations = []
            self.add(block, len(made) - 1, inner, may_allocate=False)
        return [block.nests[k].with_body(block.nests[k].body) if k in block.nests else s for k, s in enumerate(made)]

    def block(self, body: list[AST]) -> list[AST]:
        """A block inside of a loop."""
        body = [with_blocks(s, self.block) if isinstance(s, (For, While, If)) else s for s in body]
        block = _Block()
        for position, statement in enumerate(body):
            self.add(block, position, statement, may_allocate=True)
        return [block.nests[k].with_body(block.nests[k].body) if k in block.nests else s for k, s in enumerate(body)]

    def add(self, block: _Block, position: int, statement: AST, may_allocate: bool) -> None:
        """Lets the next statement of a block read what nests before it computed."""
        nest = perfect_nest(statement, self.extents) if isinstance(statement, For) and any(
            map(is_expensive, walk(statement))) else None
        moving = changed_names(statement, self.writing)
        if nest is not None:
            self.take(block, nest, moving, may_allocate)
            block.offer(position, nest)
        block.changed.update(dict.fromkeys(moving, position))

    def take(self, block: _Block, nest: Nest, moving: set[str], may_allocate: bool) -> None:
        """Reads the values in a nest which others computed, where nothing between them writes an operand."""
        places: dict[int, AST] = {}
        kept: set[int] = set()      # nodes of values that are kept: what is within one is computed no more
        for value in _expensive_values(nest):
            operands = set(names(value.argument)) - set(nest.counters)
            if id(value.node) in kept or operands & moving or not is_double(
                    value.argument, self.types, nest.counters):
                continue
            array = next(filter(None, (self.buffer_of(value, source, block, moving, may_allocate)
                                       for source in self.sources(block, value, nest, operands))), "")
            if array:
                places[id(value.node)] = index(name(array), *map(name, nest.counters))
                kept |= {id(n) for n in walk(value.node)}
        if places:
            nest.body = [rebuild(s, lambda n: copy(places[id(n)]) if id(n) in places else None) for s in nest.body]

    def sources(self, block: _Block, value: _ExpensiveValue, nest: Nest, operands: set[str]) -> Iterator[_Source]:
        """Where earlier nests over one iteration space compute a value of a nest, the latest first."""
        written = max((block.changed.get(n, -1) for n in operands), default=-1)
        for source in reversed(block.offers.get(value.key(nest.counters), [])):
            if source.position <= written:
                return
            if len(source.nest.loops) == len(nest.loops) and source.nest.starts == nest.starts and (
                    self.extents.are_equal(source.nest.trip_counts, nest.trip_counts)):
                yield source

    def buffer_of(self, value: _ExpensiveValue, source: _Source, block: _Block, moving: set[str],
                  may_allocate: bool) -> str:
        """The array that holds a value behind the nest that computes it, empty if there is none."""
        existing = self.existing_buffer(value, source.value, source.nest)
        if existing and existing not in moving and block.changed.get(existing, -1) <= source.position:
            return existing
        return self.new_buffer(value, source.value, source.nest) if may_allocate else ""

    def existing_buffer(self, value: _ExpensiveValue, source: _ExpensiveValue, giving: Nest) -> str:
        """The array in which the first nest stores the value anyway, and overwrites it nowhere."""
        if value.function != source.function:
            return ""
        made, place = _value_expression(source), dump(tuple_of(*map(name, giving.counters)))
        position = next(k for k, s in enumerate(giving.body) if s is source.statement)
        once = not isinstance(made, Name) or times_bound(giving.body, Assign, AugAssign)[made.id] == 1
        for statement in giving.body[position:] if once else []:
            target = statement.targets[0] if isinstance(statement, Assign) else None
            if isinstance(target, Subscript) and isinstance(target.value, Name) and dump(
                    tuple_of(*indices(target))) == place and dump(statement.value) == dump(made):
                array = target.value.id
                double = array not in self.types or self.types[array].dtype == "float64"   # or keeps another value
                if double and sum(base_name(t) == array for t in stored_elements(giving.body)) == 1:
                    return array
        return ""

    def new_buffer(self, value: _ExpensiveValue, source: _ExpensiveValue, giving: Nest) -> str:
        """A new buffer for the value, which the first nest fills."""
        stops = [b.stop for b in map(counted_loop, giving.loops) if b is not None]
        if not set(names(stops)) <= self.extents.fixed:
            return ""
        array = self.free.fresh(f"{value.function.rpartition('.')[2]}_kept")
        sizes = [copy(s) if isinstance(s, Subscript) and isinstance(s.value, Attribute) else call(
            "builtins.max", copy(s), const(0)) for s in stops]
        self.allocations.append(assign(array, call("numpy.empty", sizes[0] if len(sizes) == 1 else tuple_of(*sizes))))
        same = value.function == source.function
        made = _value_expression(source) if same else tanh_derivative(copy(source.node.args[0]))
        store = at(Assign([index(name(array), *map(name, giving.counters))], made, None), source.statement)
        position = next(k for k, s in enumerate(giving.body) if s is source.statement)
        giving.body = [*giving.body[:position + 1], store, *giving.body[position + 1:]]
        return array


def _value_expression(source: _ExpensiveValue) -> AST:
    """The name that is bound to a value, or else a copy of its expression."""
    target = source.statement.targets[0] if isinstance(source.statement, Assign) else None
    return name(target.id) if isinstance(target, Name) and source.statement.value is source.node else copy(source.node)


def _expensive_values(nest: Nest) -> Iterator[_ExpensiveValue]:
    """The expensive values in the unbranched statements of a nest, with the names in their arguments substituted."""
    known: dict[str, AST] = {}
    times = times_bound(nest.body, Assign, AugAssign)

    def spelled(node: AST) -> AST:
        return rebuild(node, lambda n: copy(known[n.id]) if isinstance(n, Name) and n.id in known else None)
    for statement in nest.body:
        if isinstance(statement, If):
            continue
        parts = list(walk(getattr(statement, "value", [])))
        chosen = {id(n) for c in parts if isinstance(c, (BoolOp, IfExp)) for n in walk(c)}
        for node in parts:
            slope = cosh_of_tanh_derivative(node)
            if slope is not None:
                yield _ExpensiveValue(statement, node, "slope", spelled(slope.args[0]), id(node) not in chosen)
            elif is_expensive(node) and len(node.args) == 1:
                yield _ExpensiveValue(statement, node, call_name(node) or "", spelled(node.args[0]),
                                      id(node) not in chosen)
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and times[target.id] == 1:
            known[target.id] = spelled(statement.value)


__all__ = ["loop_memoization"]
