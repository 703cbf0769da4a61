"""totals: what a loop adds to one element of a shadow is summed in a number.

    for j in range(n):                      if 0 < n:
        m_bar[i] += w[j] * seed[j]              total = m_bar[i]
                                                for j in range(n):
                                                    total += w[j] * seed[j]
                                                m_bar[i] = total

The number's gains come in any order afterwards (`runtime.added`), so that the loop runs in vectors.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from s2sad.analyze.liveness import base_name
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.bounds import Counted, changed
from s2sad.tree import (
    AST, Add, Attribute, AugAssign, For, Gt, If, Lt, Name, Sub, Subscript, assign, at, augment, compare, copy, dump,
    name, names, walk,
)

CHANGES_ROUNDING = True


@dataclass
class Totals:
    """The loop, the numbers that it sums, and what binds them before it and stores them behind it."""
    loop: For
    sums: set[str] = field(default_factory=set)
    before: list[AST] = field(default_factory=list)
    after: list[AST] = field(default_factory=list)

    def around(self, loops: list[AST], bounds: Counted) -> list[AST]:
        """The loops for the loop, if it runs at all."""
        if not self.sums:
            return loops
        runs = compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop))
        return [at(If(runs, [*self.before, *loops, *self.after], []), self.loop)]


def totals(loop: For, bounds: Counted, shadows: Mapping[str, Type], free: Names) -> Totals:
    """The loop with numbers for the elements that every iteration adds to."""
    inside = {bounds.counter, *changed(loop.body)}
    made = Totals(loop)
    held: dict[int, str] = {}
    for array in dict.fromkeys(base_name(s.target) for s in loop.body if _is_gain(s)):
        gains = [s for s in loop.body if _is_gain(s) and base_name(s.target) == array]
        place = gains[0].target
        mentions = sum(isinstance(n, Name) and n.id == array for n in walk(loop.body))
        if array not in shadows or shadows[array].dtype != "float64" or mentions != len(gains) or inside & set(
                names(place.slice)) or len({dump(g.target) for g in gains}) > 1 or any(
                isinstance(n, Subscript) and not isinstance(n.value, Attribute) for n in walk(place.slice)):
            continue
        total = free.fresh(f"{array}_total")
        held |= {id(g): total for g in gains}
        made.sums.add(total)
        made.before.append(at(assign(total, copy(place)), loop))
        made.after.append(at(assign(copy(place), name(total)), gains[0]))
    if held:
        body = [at(augment(held[id(s)], s.op, s.value), s) if id(s) in held else s for s in loop.body]
        made.loop = at(For(loop.target, loop.iter, body, [], None), loop)
    return made


def _is_gain(statement: AST) -> bool:
    return isinstance(statement, AugAssign) and isinstance(statement.op, (Add, Sub)) and isinstance(
        statement.target, Subscript)


__all__ = ["Totals", "totals"]
