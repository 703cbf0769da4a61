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
is read there; else one buffer serves all iterations of the enclosing loop. The derivative of tanh, which is computed
beside it, shares its exponential (`runtime.sech_squared`).
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
    new.body = []
    for statement in function.body:
        found.extents.assume(statement)
        made = with_blocks(statement, found.block) if isinstance(statement, (For, While)) else statement
        new.body += [*found.allocations, made]
        found.allocations = []
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

    def is_available_from(self, other: _ExpensiveValue) -> bool:
        """Whether the value can be computed where the other one is."""
        same = other.function == self.function or self.function == "slope" and other.function.endswith(".tanh")
        return same and dump(self.argument) == dump(other.argument)


class _LoopMemoization:
    """One function; `allocations` are those of the buffers for its current statement."""

    def __init__(self, function: FunctionDef, types: Mapping[str, Type], writing: Set[str]):
        self.extents, self.types, self.writing = IterationSpaces(function, writing), types, writing
        self.free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(types))
        self.allocations: list[AST] = []

    def block(self, block: list[AST]) -> list[AST]:
        """A block inside of a loop."""
        block = [with_blocks(s, self.block) if isinstance(s, (For, While, If)) else s for s in block]
        nests = {k: nest for k, s in enumerate(block) if isinstance(s, For) and (
            nest := perfect_nest(s, self.extents)) is not None and any(map(is_expensive, walk(s)))}
        moving = [changed_names(s, self.writing) for s in block]
        for last, taking in nests.items():
            for first in [k for k in nests if k < last][::-1]:
                self.reuse(nests[first], taking, moving[first:last + 1])
        return [nests[k].with_body(nests[k].body) if k in nests else s for k, s in enumerate(block)]

    def reuse(self, giving: Nest, taking: Nest, moving: list[set[str]]) -> None:
        """Stores the values that two nests compute, where nothing between them writes an operand."""
        if len(giving.loops) != len(taking.loops) or giving.starts != taking.starts or not (
                self.extents.are_equal(giving.trip_counts, taking.trip_counts)):
            return
        counters, still = dict(zip(taking.counters, map(name, giving.counters))), set().union(*moving)
        places: dict[int, AST] = {}
        kept: set[int] = set()      # nodes of values that are kept: what is within one is computed no more
        for value in _expensive_values(taking):
            if id(value.node) in kept or (set(names(value.argument)) - set(taking.counters)) & still or not (
                    is_double(value.argument, self.types, taking.counters)):
                continue
            value.argument = rebuild(value.argument, lambda n: copy(counters[n.id]) if isinstance(
                n, Name) and n.id in counters else None)
            array = self.buffer_of(value, giving, set().union(*moving[1:]))
            if array:
                places[id(value.node)] = index(name(array), *map(name, taking.counters))
                kept |= {id(n) for n in walk(value.node)}
        if places:
            taking.body = [rebuild(s, lambda n: copy(places[id(n)]) if id(n) in places else None) for s in taking.body]

    def buffer_of(self, value: _ExpensiveValue, giving: Nest, moving: set[str]) -> str:
        """The array that holds a value behind the nest that computes it, empty if that nest does not."""
        source = next((v for v in _expensive_values(giving) if v.unconditional and value.is_available_from(v)), None)
        if source is None:
            return ""
        return self.existing_buffer(value, source, giving, moving) or self.new_buffer(value, source, giving)

    def existing_buffer(self, value: _ExpensiveValue, source: _ExpensiveValue, giving: Nest, moving: set[str]) -> str:
        """The array in which the first nest stores the value anyway, and which nothing overwrites behind it."""
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
                if double and array not in moving and sum(base_name(t) == array
                                                          for t in stored_elements(giving.body)) == 1:
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
