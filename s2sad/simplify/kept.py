"""kept: what an exponential gave an iteration is kept in it until the derivative asks for it.

    for s in range(n):                                  slope_kept = np.empty(m)
        for j in range(m):                              for s in range(n):
            h[j] = np.tanh(w[j] * s)                        for j in range(m):
        ...                                                     h[j] = np.tanh(w[j] * s)
        for j in range(m):                                      slope_kept[j] = (1.0 / np.cosh(w[j] * s)) ** 2
            x = w[j] * s                                    ...
            g = (1.0 / np.cosh(x)) ** 2 * h_bar[j]          for j in range(m):
                                                                x = w[j] * s
                                                                g = slope_kept[j] * h_bar[j]

Two nests over one region in one block; nothing from the first to the second writes what the argument is made of. Where
an array of the kernel still holds the value, it is read there. One array serves all iterations: only inside of a loop.

Requires finished text for Numba and the types of its names; establishes the same values. The derivative of tanh, which
is computed beside it, shares its exponential (`runtime.sech_squared`).
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass

from s2sad.analyze.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.bounds import changed, counted, stores
from s2sad.simplify.exponentials import cosh_of_slope, slope_of_tanh
from s2sad.simplify.extents import Extents
from s2sad.simplify.nests import Nest, nest_of
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BoolOp, Constant, Expr, For, FunctionDef, If, IfExp, Name, Subscript, While,
    assign, at, call, call_name, const, copy, dump, index, indices, name, names, rebuild, times_bound, tuple_of,
    walk,
)

CHANGES_ROUNDING = False

_COSTLY = {f"{room}.{f}" for room in ("numpy", "math") for f in (
    "exp", "expm1", "exp2", "log", "log1p", "log2", "log10", "sinh", "cosh", "tanh", "sin", "cos", "tan")}


def kept(function: FunctionDef, types: Mapping[str, Type], writing: Set[str] = frozenset()) -> FunctionDef:
    """The function with such values kept; `writing` are the functions that write arrays."""
    if not any(call_name(n) in _COSTLY for n in walk(function.body)):
        return function
    new, found = copy(function), _Kept(function, types, writing)
    new.body = []
    for statement in function.body:
        found.extents.learn(statement)
        made = with_blocks(statement, found.block) if isinstance(statement, (For, While)) else statement
        new.body += [*found.allocations, made]
        found.allocations = []
    return new


@dataclass
class _Value:
    """Of a statement in a nest: a costly call, or the derivative of tanh, and what it is asked of, without names;
    `sure` if every iteration computes it."""
    statement: AST
    node: AST
    function: str
    argument: AST
    sure: bool

    def is_of(self, other: _Value) -> bool:
        """Whether the value can be computed where the other one is."""
        same = other.function == self.function or self.function == "slope" and other.function.endswith(".tanh")
        return same and dump(self.argument) == dump(other.argument)


class _Kept:
    """One function; `allocations` are those of the arrays that its current statement keeps values in."""

    def __init__(self, function: FunctionDef, types: Mapping[str, Type], writing: Set[str]):
        self.extents, self.types, self.writing = Extents(function, writing), types, writing
        self.free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(types))
        self.allocations: list[AST] = []

    def block(self, block: list[AST]) -> list[AST]:
        """A block inside of a loop."""
        block = [with_blocks(s, self.block) if isinstance(s, (For, While, If)) else s for s in block]
        nests = {k: nest for k, s in enumerate(block) if isinstance(s, For) and (
            nest := nest_of(s, self.extents)) is not None and any(map(_is_costly, walk(s)))}
        moving = [_changed(s, self.writing) for s in block]
        for last, taking in nests.items():
            for first in [k for k in nests if k < last][::-1]:
                self.pair(nests[first], taking, moving[first:last + 1])
        return [nests[k].around(nests[k].body) if k in nests else s for k, s in enumerate(block)]

    def pair(self, giving: Nest, taking: Nest, moving: list[set[str]]) -> None:
        """Keeps what two nests compute, where nothing between them changes what it is made of."""
        if len(giving.loops) != len(taking.loops) or giving.starts != taking.starts or list(
                map(self.extents.reduced, giving.runs)) != list(map(self.extents.reduced, taking.runs)):
            return
        counters, still = dict(zip(taking.counters, map(name, giving.counters))), set().union(*moving)
        places: dict[int, AST] = {}
        for value in _values(taking):
            if (set(names(value.argument)) - set(taking.counters)) & still or not self.is_double(
                    value.argument, taking.counters):
                continue
            value.argument = rebuild(value.argument, lambda n: copy(counters[n.id]) if isinstance(
                n, Name) and n.id in counters else None)
            array = self.array(value, giving, set().union(*moving[1:]))
            if array:
                places[id(value.node)] = index(name(array), *map(name, taking.counters))
        if places:
            taking.body = [rebuild(s, lambda n: copy(places[id(n)]) if id(n) in places else None) for s in taking.body]

    def array(self, value: _Value, giving: Nest, moving: set[str]) -> str:
        """The array that holds a value behind the nest that computes it, empty if that nest does not."""
        source = next((v for v in _values(giving) if v.sure and value.is_of(v)), None)
        return "" if source is None else self.held(value, source, giving, moving) or self.stored(value, source, giving)

    def is_double(self, argument: AST, counters: list[str]) -> bool:
        """Whether a value is a float64 number for certain: one of a complex argument is none."""
        known = {n for n, kind in self.types.items() if kind.dtype in ("float64", "int64")} | set(counters)
        library = ("numpy.", "math.", "builtins.")
        words = {n.id for n in walk(argument) if isinstance(n, Name) and not n.id.startswith(library)}
        return words <= known and not any(
            isinstance(n, Constant) and isinstance(n.value, complex) for n in walk(argument))

    def held(self, value: _Value, source: _Value, giving: Nest, moving: set[str]) -> str:
        """The array in which the first nest stores the value anyway, and which nothing changes behind it."""
        if value.function != source.function:
            return ""
        made, place = _made(source), dump(tuple_of(*map(name, giving.counters)))
        position = next(k for k, s in enumerate(giving.body) if s is source.statement)
        once = not isinstance(made, Name) or times_bound(giving.body, Assign, AugAssign)[made.id] == 1
        for statement in giving.body[position:] if once else []:
            target = statement.targets[0] if isinstance(statement, Assign) else None
            if isinstance(target, Subscript) and isinstance(target.value, Name) and dump(
                    tuple_of(*indices(target))) == place and dump(statement.value) == dump(made):
                array = target.value.id
                double = array not in self.types or self.types[array].dtype == "float64"   # or keeps another value
                if double and array not in moving and sum(base_name(t) == array for t in stores(giving.body)) == 1:
                    return array
        return ""

    def stored(self, value: _Value, source: _Value, giving: Nest) -> str:
        """An array of its own for the value, which the first nest fills."""
        stops = [b.stop for b in map(counted, giving.loops) if b is not None]
        if not set(names(stops)) <= self.extents.fixed:
            return ""
        array = self.free.fresh(f"{value.function.rpartition('.')[2]}_kept")
        sizes = [copy(s) if isinstance(s, Subscript) and isinstance(s.value, Attribute) else call(
            "builtins.max", copy(s), const(0)) for s in stops]
        self.allocations.append(assign(array, call("numpy.empty", sizes[0] if len(sizes) == 1 else tuple_of(*sizes))))
        made = _made(source) if value.function == source.function else slope_of_tanh(copy(source.node.args[0]))
        store = at(Assign([index(name(array), *map(name, giving.counters))], made, None), source.statement)
        position = next(k for k, s in enumerate(giving.body) if s is source.statement)
        giving.body = [*giving.body[:position + 1], store, *giving.body[position + 1:]]
        return array


def _made(source: _Value) -> AST:
    """The name that is bound to a value, or the expression of it once more."""
    target = source.statement.targets[0] if isinstance(source.statement, Assign) else None
    return name(target.id) if isinstance(target, Name) and source.statement.value is source.node else copy(source.node)


def _is_costly(node: AST) -> bool:
    return call_name(node) in _COSTLY


def _changed(statement: AST, writing: Set[str]) -> set[str]:
    """What a statement may bind or write."""
    calls = [n for n in walk(statement) if isinstance(n, Expr) or call_name(n) in writing]
    return changed([statement]) | {base_name(t) for t in stores([statement])} | set(names(calls))


def _values(nest: Nest) -> Iterator[_Value]:
    """The values of the straight statements of a nest, with what the names in their arguments are bound to."""
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
            slope = cosh_of_slope(node)
            if slope is not None:
                yield _Value(statement, node, "slope", spelled(slope.args[0]), id(node) not in chosen)
            elif _is_costly(node) and len(node.args) == 1:
                yield _Value(statement, node, call_name(node) or "", spelled(node.args[0]), id(node) not in chosen)
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and times[target.id] == 1:
            known[target.id] = spelled(statement.value)


__all__ = ["kept"]
