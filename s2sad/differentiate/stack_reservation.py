"""stack_reservation: a stack that grows gets room for all entries of its innermost loops before these start.

    u_stack = grow(u_stack, u_top + m - 1)          u_top -= m
    for j in range(m):                              for j in range(m - 1, -1, -1):
        u_stack[u_top + j] = u[j]                       u[j] = u_stack[u_top + j]
        ...                                             ...
    u_top += m

Nothing is asked for each entry, no iteration waits for another one's `u_top`, and such loops run in vectors.
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.trip_counts import bound_before, counter, trip_counts
from s2sad.tree import AST, Constant, For, add, const, copy, mult, names, stored_names, sub


@dataclass(frozen=True)
class Reservation:
    """Nested loops, the outermost first, each iteration of which makes one entry, with how many iterations each has."""
    loops: tuple[For, ...]
    sizes: tuple[AST, ...]

    @property
    def entries(self) -> AST:
        """How many entries there are."""
        found = copy(self.sizes[0])
        for size in self.sizes[1:]:
            found = mult(found, copy(size))
        return found

    def last(self, first: AST | None) -> AST:
        """The place of the last entry; the place of the first one is `first`, None if it is 0."""
        if isinstance(self.entries, Constant):
            before: AST = const(self.entries.value - 1)
            return before if first is None else add(first, before)
        return sub(self.entries if first is None else add(first, self.entries), const(1))

    def offset(self) -> AST:
        """The place of an iteration's entry behind the first one."""
        found = counter(self.loops[0])
        for loop, size in zip(self.loops[1:], self.sizes[1:]):
            found = add(mult(found, copy(size)), counter(loop))
        return found


def reservation(structure: ProgramStructure, inside: tuple[AST, ...], loops: tuple[AST, ...]) -> Reservation | None:
    """The innermost of `loops`, as many as go around an entry without a branch and have a number of iterations that is
    known where the first one starts; `inside` are the loops and branches around the entry."""
    for k in range(len(loops)):
        chosen = loops[k:]
        if inside[-len(chosen):] != chosen:
            continue
        sizes = _sizes(structure, chosen)
        if sizes is not None:
            return Reservation(chosen, sizes)
    return None


def _sizes(structure: ProgramStructure, loops: tuple[AST, ...]) -> tuple[AST, ...] | None:
    """The numbers of iterations, which have the same value in front of the loops, within them and behind."""
    first = loops[0]
    if not isinstance(first, For):
        return None
    found = [trip_counts(structure, loop) for loop in loops]
    sizes = tuple(s for s in found if s is not None)
    outside = {*bound_before(structure, first), *names(first.iter)}
    if len(sizes) < len(found) or set(stored_names(first)) & set(names(list(sizes))) or any(
            not set(names(size)) <= outside for size in sizes[1:]):
        return None
    return sizes
