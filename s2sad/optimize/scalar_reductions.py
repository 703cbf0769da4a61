"""scalar_reductions: a loop's increments of one element of a shadow are reduced in a scalar.

    for j in range(n):                      if 0 < n:
        m_bar[i] += w[j] * seed[j]              total = m_bar[i]
                                                for j in range(n):
                                                    total += w[j] * seed[j]
                                                m_bar[i] = total

Where the loop increments other elements of the array as well, which may be the same one, the scalar begins with zero:

    for j in range(n):                      if 0 < n:
        m_bar[k, j] += seed[j]                  total = 0.0
        m_bar[i, k] += seed[j]                  for j in range(n):
                                                    m_bar[k, j] += seed[j]
                                                    total += seed[j]
                                                m_bar[i, k] += total

*Requires* an innermost counted loop. *Establishes* the same sums; `vectorize` then lets the scalar's increments come in
any order (`runtime.added`), so that the loop vectorizes.
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from s2sad.liveness import base_name
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.optimize.loop_bounds import CountedLoop, bound_names
from s2sad.tree import (
    AST, Add, Attribute, AugAssign, For, Gt, If, Lt, Name, Sub, Subscript, assign, at, augment, compare, const, copy,
    dump, name, names, walk,
)

CHANGES_ROUNDING = True


@dataclass
class ScalarReductions:
    """The loop, its scalar accumulators, and the statements that load them before it and store them behind it."""
    loop: For
    sums: set[str] = field(default_factory=set)
    before: list[AST] = field(default_factory=list)
    after: list[AST] = field(default_factory=list)

    def enclose(self, loops: list[AST], bounds: CountedLoop) -> list[AST]:
        """The loops that replace the loop between load and store, under the test that it runs at all."""
        if not self.sums:
            return loops
        runs = compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop))
        return [at(If(runs, [*self.before, *loops, *self.after], []), self.loop)]


def scalar_reductions(loop: For, bounds: CountedLoop, shadows: Mapping[str, Type], free: Names) -> ScalarReductions:
    """The loop with scalars for the elements that every iteration increments."""
    inside = {bounds.counter, *bound_names(loop.body)}
    made = ScalarReductions(loop)
    held: dict[int, str] = {}
    for array in dict.fromkeys(base_name(s.target) for s in loop.body if _is_increment(s)):
        increments = [s for s in loop.body if _is_increment(s) and base_name(s.target) == array]
        mentions = sum(isinstance(n, Name) and n.id == array for n in walk(loop.body))
        if array not in shadows or shadows[array].dtype != "float64" or mentions != len(increments):
            continue
        places = {dump(s.target): s for s in reversed(increments)}
        for text, first in reversed(places.items()):
            if _varies(first.target, inside):
                continue
            place, total = first.target, free.fresh(f"{array}_total")
            held |= {id(s): total for s in increments if dump(s.target) == text}
            made.sums.add(total)
            alone = len(places) == 1
            made.before.append(at(assign(total, copy(place) if alone else const(0.0)), loop))
            made.after.append(at(assign(copy(place), name(total)) if alone else augment(
                copy(place), Add(), name(total)), first))
    if held:
        body = [at(augment(held[id(s)], s.op, s.value), s) if id(s) in held else s for s in loop.body]
        made.loop = at(For(loop.target, loop.iter, body, [], None), loop)
    return made


def _varies(place: Subscript, inside: Set[str]) -> bool:
    """Whether a reference may be another element in another iteration."""
    return bool(inside & set(names(place.slice))) or any(
        isinstance(n, Subscript) and not isinstance(n.value, Attribute) for n in walk(place.slice))


def _is_increment(statement: AST) -> bool:
    return isinstance(statement, AugAssign) and isinstance(statement.op, (Add, Sub)) and isinstance(
        statement.target, Subscript)


__all__ = ["ScalarReductions", "scalar_reductions"]
