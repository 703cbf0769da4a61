"""array_contraction: an array whose elements are produced and consumed in one iteration becomes a scalar.

An array of the function's own that one nest alone references, always at the element of its iteration, is contracted:

    for i in range(n):                  for i in range(n):
        w_bar[i] += g[i]                    w_bar_here = 0.0
        x_bar[i] += a * w_bar[i]            w_bar_here += g[i]
        w_bar[i] = 0.0                      x_bar[i] += a * w_bar_here

So is one that several nests reference, each at one element of its iteration, which it fills before all else: none hands
anything to another. Where one nest increments an array of zeros and the next one clears it, the increment becomes a
store and the clear goes:

    for i in range(n):                  for i in range(n):
        w_bar[i] += g[i]                    w_bar[i] = g[i]
    for i in range(n):                  for i in range(n):
        x_bar[i] += w_bar[i]                x_bar[i] += w_bar[i]
        w_bar[i] = 0.0

*Requires* nests that loop fusion has made. *Establishes* the same values.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping

from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.optimize.loop_bounds import bound_names, counter_offset
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_nests import Nest, perfect_nest
from s2sad.simplify.initialize_accumulators import clears_element
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, Constant, FunctionDef, If, IfExp, Name, Sub, Subscript, UnaryOp,
    assign, at, augment, call, call_name, const, copy, dump, indices, name, names, negate, rebuild, walk, with_body,
)

_LIKE = {"numpy.empty_like", "numpy.zeros_like"}
_ALLOCATORS = {"numpy.empty", "numpy.zeros"} | _LIKE
# functions that give doubles for doubles
_DOUBLE = {f"numpy.{f}" for f in ("abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tanh", "maximum", "minimum")} | {
    "builtins.min", "builtins.max"}


class Contractible:
    """The arrays of one function that may be contracted. Where its text is `finished`, a number that is an element's
    stays NumPy's: Python's own would raise where it is divided by."""

    def __init__(self, function: FunctionDef, extents: IterationSpaces, types: Mapping[str, Type], free: Names,
                 finished: bool = False):
        self.free, self.types, self.finished = free, types, finished
        self.numbers: dict[str, str] = {}   # the array of which a number is an element
        parameters = {p.id for p in function.args.args}
        self.allocators = {n.targets[0].id: call_name(n.value) or "" for n in function.body if isinstance(n, Assign)
                     and isinstance(n.targets[0], Name) and call_name(n.value) in _ALLOCATORS}
        places = Counter(base_name(n) for n in walk(function.body) if isinstance(n, Subscript)
                         and isinstance(n.value, Name))
        mentions = Mentions(function.body)
        self.places = {a: places[a] for a in self.allocators if a in extents.fixed and a not in parameters
                       and a in types
                       and types[a].dtype == "float64" and mentions.only_by_elements(a, bound=1)}

    def contract(self, nests: list[Nest], extents: IterationSpaces) -> None:
        """Contracts arrays in the bodies of the nests of one block."""
        using: dict[str, list[Nest]] = {}
        for nest in nests:
            for array in {base_name(n) for n in walk(nest.body) if isinstance(n, Subscript)}:
                using.setdefault(array, []).append(nest)
        for array, total in self.places.items():
            users = [(nest, _references(array, nest.body)) for nest in using.get(array, ())]
            if sum(len(places) for _, places in users) != total or any(
                    len({dump(p.slice) for p in places}) > 1 for _, places in users):
                continue
            if len(users) == 1:
                self.contract_to_scalar(array, *users[0])
            elif len(users) == 2 and self.allocators[array].startswith("numpy.zeros"):
                self.drop_clear(array, users[0][0], users[1][0], extents)

    def contract_apart(self, function: FunctionDef, extents: IterationSpaces) -> FunctionDef:
        """The function without the arrays that hand nothing from one nest to another: each nest that mentions one fills
        the element of its iteration before it reads it."""
        places: Counter[str] = Counter()
        filled: Counter[str] = Counter()

        def count(nest: Nest) -> None:
            for array in {base_name(n) for n in walk(nest.body) if isinstance(n, Subscript)} & set(self.places):
                found = _references(array, nest.body)
                filled[array] += len(found) if _fills_first(array, nest) else 0

        def contract(nest: Nest) -> None:
            for array in apart:
                if found := _references(array, nest.body):
                    self.contract_to_scalar(array, nest, found)
        _changed_nests(function.body, extents, count)
        places.update(base_name(n) for n in walk(function.body) if isinstance(n, Subscript))
        apart = [a for a in self.places if filled[a] and filled[a] == places[a]]
        return with_body(function, _changed_nests(function.body, extents, contract)) if apart else function

    def is_produced_for(self, first: list[AST], second: list[AST]) -> bool:
        """Whether one body produces an array that only the other one consumes, at the same element."""
        for array, total in self.places.items():
            given, taken = _references(array, first), _references(array, second)
            if given and taken and len(given) + len(taken) == total and len(
                    {dump(p.slice) for p in (*given, *taken)}) == 1 and _is_fill(
                    next(s for s in first if _references(array, [s])), array):
                return True
        return False

    def contract_to_scalar(self, array: str, nest: Nest, places: list[Subscript]) -> None:
        """Replaces an array of one nest by a scalar."""
        if bound_names(nest.body) & set(names(places[0].slice)):
            return
        using = [s for s in nest.body if _references(array, [s])]
        body, before = list(nest.body), []
        if _is_fill(using[0], array):
            filled = rebuild(using[0], _of_numpy) if self.finished else using[0]
            body = [filled if s is using[0] else s for s in body]
            using[0] = filled
        else:
            if not self.allocators[array].startswith("numpy.zeros") or not clears_element(using[-1]):
                return
            body = [s for s in body if s is not using[-1]]
            before = [0.0]
        here = self.free.fresh(f"{array}_here")
        self.numbers[here] = array

        def change(node: AST) -> AST | None:
            return name(here) if isinstance(node, Subscript) and base_name(node) == array else None
        nest.body = [at(assign(here, const(v)), using[0]) for v in before] + [
            self.with_scalar_target(rebuild(s, change), here) if any(s is u for u in using) else s for s in body]

    def with_scalar_target(self, statement: AST, here: str) -> AST:
        """The statement as a binding of the scalar in place of a store of an element, which makes a float64 of it: an
        integer has other powers, and none below 1."""
        if isinstance(statement, If):
            return with_blocks(statement, lambda block: [self.with_scalar_target(s, here) for s in block])
        if isinstance(statement, AugAssign) and isinstance(statement.target, Name):
            return at(augment(statement.target.id, statement.op, statement.value), statement)
        if isinstance(statement, Assign) and isinstance(target := statement.targets[0], Name):
            value = statement.value
            return at(assign(target.id, value if target.id != here or self.is_double(value) else const(
                float(value.value)) if isinstance(value, Constant) else call("numpy.float64", value)), statement)
        return statement

    def is_double(self, value: AST) -> bool:
        """Whether a value is a float64 number for certain."""
        if isinstance(value, Constant):
            return type(value.value) is float
        if isinstance(value, (Name, Subscript)):
            base = base_name(value)
            return base in self.numbers or base in self.types and self.types[base].dtype == "float64"
        if isinstance(value, IfExp):
            return self.is_double(value.body) and self.is_double(value.orelse)
        if isinstance(value, UnaryOp):
            return self.is_double(value.operand)
        if isinstance(value, BinOp):
            return self.is_double(value.left) or self.is_double(value.right)
        return call_name(value) in _DOUBLE and all(map(self.is_double, value.args))

    def drop_clear(self, array: str, first: Nest, second: Nest, extents: IterationSpaces) -> None:
        """Makes the increment in the first nest a store, where the second nest clears the array."""
        fills = next(s for s in first.body if _references(array, [s]))
        clears = [s for s in second.body if _references(array, [s])][-1]
        if not isinstance(fills, AugAssign) or not clears_element(clears) or _references(array, [fills.value]) or not (
                isinstance(fills.target, Subscript)) or _iteration_region(array, first) is None:
            return
        if _iteration_region(array, first) != _iteration_region(array, second) or not extents.are_equal(
                first.trip_counts, second.trip_counts):
            return
        value = negate(copy(fills.value)) if isinstance(fills.op, Sub) else copy(fills.value)
        first.body = [at(assign(copy(fills.target), value), s) if s is fills else s for s in first.body]
        second.body = [s for s in second.body if s is not clears]


def _changed_nests(block: list[AST], extents: IterationSpaces, change: Callable[[Nest], None]) -> list[AST]:
    """A block with each nest in it, as large as it is, changed."""
    made: list[AST] = []
    for statement in block:
        nest = perfect_nest(statement, extents)
        if nest is not None:
            change(nest)
        made.append(nest.with_body(nest.body) if nest is not None else with_blocks(
            statement, lambda inner: _changed_nests(inner, extents, change)))
    return made


def _fills_first(array: str, nest: Nest) -> bool:
    """Whether a nest mentions one element of an array in each iteration, and always stores into it first."""
    places = _references(array, nest.body)
    first = next(s for s in nest.body if _references(array, [s]))
    return _is_fill(first, array) and len({dump(p.slice) for p in places}) == 1 and not bound_names(
        nest.body) & set(names(places[0].slice))


def _of_numpy(node: AST) -> AST | None:
    """A choice whose numbers are NumPy's; None of any other node."""
    if not isinstance(node, IfExp):
        return None
    sides = (call("numpy.float64", s) if isinstance(s, Constant) and type(s.value) is float else rebuild(s, _of_numpy)
             for s in (node.body, node.orelse))
    return at(IfExp(node.test, *sides), node)


def _references(array: str, body: list[AST]) -> list[Subscript]:
    return [n for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]


def _is_fill(statement: AST, array: str) -> bool:
    """Whether a statement stores into the array and does not read it."""
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript) and base_name(
        statement.targets[0]) == array and not _references(array, [statement.value])


def _iteration_region(array: str, nest: Nest) -> list[tuple[int, int]] | None:
    """For every axis the loop that runs along it and its first index; None if a subscript is not a counter plus a
    constant."""
    found: list[tuple[int, int]] = []
    for subscript in indices(_references(array, nest.body)[0]):
        walked = [(k, shift + nest.starts[k].constant) for k, counter in enumerate(nest.counters)
                  if (shift := counter_offset(subscript, counter)) is not None]
        found += walked
        if not walked:
            return None
    return found if sorted(k for k, _ in found) == list(range(len(nest.counters))) else None


class Mentions:
    """How often each name is mentioned in a body, and how often as an array of which an element or the shape is read.
    """

    def __init__(self, body: list[AST]):
        self.names: Counter[str] = Counter()
        self.places: Counter[str] = Counter()
        for node in walk(body):
            if isinstance(node, Name):
                self.names[node.id] += 1
            elif isinstance(node, (Subscript, Attribute)) or isinstance(node, Call) and call_name(node) in _LIKE:
                holder = node.args[0] if isinstance(node, Call) else node.value
                self.places[holder.id if isinstance(holder, Name) else ""] += 1

    def only_by_elements(self, array: str, bound: int = 0) -> bool:
        """Whether an array is mentioned by its elements and its shape only, apart from `bound` bindings of its name."""
        return self.places[array] + bound == self.names[array]


__all__ = ["Mentions", "Contractible"]
