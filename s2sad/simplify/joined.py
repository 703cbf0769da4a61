"""joined: neighbouring nests of loops over one region become one nest.

    for i in range(s.shape[0]):             for i in range(s.shape[0]):
        s[i] = u[i] + u[i + 1]                  s[i] = u[i] + u[i + 1]
    for i in range(1, u.shape[0]):              v[i + 1] = s[i] * u[i + 1]
        v[i] = s[i - 1] * u[i]

Each element goes through memory once for all of them, and `passed` keeps in names what nothing else reads.

Requires a finished derivative for Numba (`handed` joins nests of a kernel). An array that one nest writes and the other
mentions is mentioned at one element for each iteration only, so that nothing moves from one iteration to another;
numbers do not either, but for sums whose order is free. (Loop fusion: Kennedy, McKinley, 1993.)
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from s2sad.analyze.liveness import base_name, targets
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import shifted, simple
from s2sad.simplify.bounds import changed, counted, shifted_by, stores
from s2sad.simplify.extents import Extents
from s2sad.simplify.nests import Nest, nest_of
from s2sad.simplify.passed import Mentions, Passed
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, AugAssign, Break, FunctionDef, If, Name, Return, Sub, Subscript, copy, dump,
    indices, is_comment, name, names, rebuild, walk,
)

CHANGES_ROUNDING = False

_LONGEST, _MOST_PAIRS = 48, 60


def joined(function: FunctionDef, sums: Set[str], types: Mapping[str, Type], free: Names,
           writing: Set[str] = frozenset()) -> FunctionDef:
    """The function with its nests joined; `sums` are numbers whose gains come in any order, `writing`
    the functions that write arrays."""
    new = copy(function)
    extents = Extents(function, writing)
    new.body = Joining(extents, sums, Passed(function, extents, types, free)).block(function.body)
    return new


class Joining:
    """The pass over one function; with `handing` only nests are joined of which one hands the other an array."""

    def __init__(self, extents: Extents, sums: Set[str], between: Passed, handing: bool = False):
        self.extents, self.sums, self.between, self.handing = extents, sums, between, handing
        self.passed: dict[tuple[str, ...], list[Assert]] = {}   # what every iteration has asserted, by the loops around
        self.around: tuple[str, ...] | None = ()                # their bounds; None inside of a branch

    def inside(self, statement: AST) -> AST:
        """A statement with its blocks joined. A loop that runs only if another one has run may rely on what that has
        asserted: sizes do not change."""
        bounds, outer, known = counted(statement), self.around, dict(self.extents.equal)
        fixed = bounds is not None and all(
            self.extents.form(b) is not None for b in (bounds.start, bounds.stop)) and not any(
            isinstance(n, (Break, Return)) for n in walk(statement))
        self.around = (*outer, dump(bounds.upwards())) if bounds and fixed and outer is not None else None
        for assertion in self.passed.get(self.around, []) if self.around else []:
            self.extents.learn(assertion)
        new = with_blocks(statement, self.block)
        if self.around:
            self.passed.setdefault(self.around, []).extend(s for s in statement.body if isinstance(s, Assert))
        self.extents.equal, self.around = known, outer
        return new

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST | Nest] = []
        last: int | None = None     # where the nest before stands; behind it are assertions and comments
        known = dict(self.extents.equal)
        for statement in block:
            self.extents.learn(statement)
            nest = nest_of(statement, self.extents)
            if nest is None:
                made.append(self.inside(statement))
                between = is_comment(statement) or last is not None and _is_passed(statement, made[last])
                last = last if between else None
                continue
            first = made[last] if last is not None else None
            both = self.both(first, nest) if isinstance(first, Nest) else None
            if last is not None and both:
                del made[last]
            made.append(both or nest)
            last = len(made) - 1
        self.between.shorten([n for n in made if isinstance(n, Nest)], self.extents)
        self.extents.equal = known
        return [s.around(s.body) if isinstance(s, Nest) else s for s in made]

    def both(self, first: Nest, second: Nest) -> Nest | None:
        """Two nests as one, with the counters of the first; None if they have to stay apart. What is handed on has no
        extent of its own: then the second nest's bounds are those that count."""
        runs = list(map(self.extents.reduced, first.runs))
        if runs != second.runs or _size(first.body) + _size(second.body) > _LONGEST:
            return None
        if {*changed(first.body), *first.counters} & second.bounds or changed(second.body) & first.bounds:
            return None
        if self.handing and first.starts == second.starts:
            given, body = _with_counters(second, first), second.body
            first = Nest(second.loops, second.starts, second.runs, given or [])
        else:
            given, body = first.body, _with_counters(first, second)
        if given is None or body is None or not self.is_free(first, body) or _pairs(
                [*first.body, *body]) > _MOST_PAIRS:
            return None
        if self.handing and not self.between.is_handed(first.body, body):
            return None
        return Nest(first.loops, first.starts, first.runs, [*first.body, *body])

    def is_free(self, first: Nest, body: list[AST]) -> bool:
        """Whether each iteration of the second nest may run right after that of the first."""
        arrays = _arrays(first.body) | _arrays(body)
        for array in sorted(arrays):
            if not self.is_free_array(array, first, body):
                return False
        if any(array not in self.extents.own for array in arrays):
            return False
        shared = (changed(first.body) & _exposed(body)) | (changed(body) & _exposed(first.body))
        return all(n in self.sums and _is_sum(n, [*first.body, *body]) for n in shared - arrays)

    def is_free_array(self, array: str, first: Nest, body: list[AST]) -> bool:
        """Whether an array that one nest writes is mentioned by the other at the same element only, or not at all."""
        places = [[n for n in walk(b) if isinstance(n, Subscript) and base_name(n) == array]
                  for b in (first.body, body)]
        if not any(base_name(t) == array for t in stores([*first.body, *body])):
            return True
        if not all(places):
            return Mentions([*first.body, *body]).only_places(array)
        texts = {dump(indices(p)) for found in places for p in found}
        subscripts = indices(places[0][0])
        counters = [next((c for c in first.counters if shifted_by(s, c) is not None), None) for s in subscripts]
        bound = changed(first.body) | changed(body)
        return (len(texts) == 1 and set(first.counters) <= set(counters) and not bound & set(names(subscripts))
                and Mentions([*first.body, *body]).only_places(array))


def _is_passed(statement: AST, nest: AST | Nest) -> bool:
    """Whether a nest may run behind a statement: an assertion that reads nothing that the nest binds or stores."""
    if not isinstance(statement, Assert) or not isinstance(nest, Nest):
        return False
    sizes = {id(n.value) for n in walk(statement) if isinstance(n, Attribute)}
    read = {n.id for n in walk(statement) if isinstance(n, Name) and id(n) not in sizes}
    return not read & {*changed(nest.body), *nest.counters, *(base_name(t) for t in stores(nest.body))}


def _with_counters(nest: Nest, other: Nest) -> list[AST] | None:
    """The body of another nest with the counters of a nest; None if it has names of its own like these."""
    if any(a != b and a in names(other.body) for a, b in zip(nest.counters, other.counters)):
        return None
    there = {b: simple(shifted(name(a), t.constant - s.constant), integers=True)
             for a, b, s, t in zip(nest.counters, other.counters, nest.starts, other.starts)}

    def change(node: AST) -> AST | None:
        return copy(there[node.id]) if isinstance(node, Name) and node.id in there else None
    return [simple(rebuild(s, change), integers=False) for s in other.body]


def _size(body: list[AST]) -> int:
    return sum(isinstance(s, (Assign, AugAssign)) for s in walk(body))


def _arrays(body: list[AST]) -> set[str]:
    return {base_name(n) for n in walk(body) if isinstance(n, Subscript) and isinstance(n.value, Name)}


def _exposed(body: list[AST]) -> set[str]:
    """The names that a body may read before it binds them."""
    found: set[str] = set()
    sure: set[str] = set()

    def visit(block: list[AST], always: bool) -> None:
        for statement in block:
            if isinstance(statement, If):
                found.update(set(names(statement.test)) - sure)
                visit(statement.body, False)
                visit(statement.orelse, False)
            elif isinstance(statement, (Assign, AugAssign)):
                read = set(names(statement.value))
                for target in targets(statement):
                    read |= set(names(target)) if isinstance(target, Subscript) or isinstance(
                        statement, AugAssign) else set()
                found.update(read - sure)
                if always:
                    sure.update(t.id for t in targets(statement) if isinstance(t, Name))
    visit(body, True)
    return found


def _is_sum(identifier: str, body: list[AST]) -> bool:
    """Whether a body only adds to a number."""
    gains = sum(isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) and isinstance(s.target, Name)
                and s.target.id == identifier for s in walk(body))
    return gains == sum(isinstance(n, Name) and n.id == identifier for n in walk(body))


def _pairs(body: list[AST]) -> int:
    """How many pairs of arrays a compiler compares before it runs the loop in vectors."""
    written = {base_name(t) for t in stores(body)}
    others = _arrays(body) - written
    return len(written) * (len(written) - 1) // 2 + len(written) * len(others)


__all__ = ["Joining", "joined"]
