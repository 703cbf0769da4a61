"""covered_parts: the parts of an array that stores of an iteration fill, and whether they are all of it together.

    b[1:-1] = a[2:] - a[:-2]            from 1 up to n - 1
    b[0] = a[0]                         from 0 up to 1
    b[-1] = a[-1]                       from n - 1 up to n

Together they are `b`, whatever its length n is: no cell in it is outside all of them.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence

from s2sad.analyze.dependence import ArrayReference, Dependence, range_parts
from s2sad.analyze.program_structure import StatementPlace
from s2sad.infer.affine import Affine, at_most, feasible
from s2sad.infer.slice_extents import is_whole
from s2sad.liveness import is_whole_array
from s2sad.tree import (
    AST, Break, Constant, For, Name, Slice, Subscript, attribute, const, dump, index, indices, name, walk_statements,
)

Interval = tuple[Affine, Affine]                # from the first place up to the second one
Part = tuple[Interval | None, ...]              # for each axis; None for all of it, as are the axes that it lacks

_MOST = 12                                      # parts that are looked at together


def covered_part(target: AST, where: StatementPlace, loop: For, dependence: Dependence) -> Part | None:
    """The part of an array that a store in a loop fills in each iteration; None if it is not known."""
    nest = where.loops[where.loops.index(loop) + 1:]
    if where.branches != dependence.structure.place(loop).branches or any(
            isinstance(s, Break) for x in nest[:1] for s in walk_statements(x.body)):
        return None
    if not isinstance(target, Subscript) or is_whole_array(target):
        return None if nest else ()
    if any(isinstance(s, Constant) and s.value in (None, ...) for s in indices(target)):
        return None
    return _Covered(dependence, nest, ArrayReference.to(target, where.statement)).part()


def cover(array: str, parts: Iterable[Part], dependence: Dependence) -> bool:
    """Whether parts of an array are all of it together, whatever its sizes are."""
    found = list(dict.fromkeys(parts))
    extents = {k: dependence.extent(array, k) for part in found for k, interval in enumerate(part) if interval}
    known = [part for part in found if all(x is None or extents[k] is not None for k, x in enumerate(part))]
    inside = [f for k, extent in extents.items() if extent is not None
              for f in (_cell(k), at_most(_cell(k).shift(1), extent))]
    return len(known) <= _MOST and not _has_hole(inside, known)


def _has_hole(inside: list[Affine], parts: Sequence[Part]) -> bool:
    """Whether a cell inside may be in none of the parts."""
    if not feasible(inside):
        return False
    if not parts:
        return True
    beside = (f for k, interval in enumerate(parts[0]) if interval is not None
              for f in (at_most(_cell(k).shift(1), interval[0]), at_most(interval[1], _cell(k))))
    return any(_has_hole([*inside, f], parts[1:]) for f in beside)


def _cell(axis: int) -> Affine:
    return Affine.symbol(f"cell {axis}")


class _Covered:
    """One store in a nest of loops."""

    def __init__(self, dependence: Dependence, nest: Sequence[AST], reference: ArrayReference):
        self.dependence, self.reference, self.nest = dependence, reference, nest
        self.counters = {x.target.id: x for x in nest if isinstance(x, For)}
        self.used: list[str] = []                       # the counters of axes

    def part(self) -> Part | None:
        """The part that all iterations of the nest fill."""
        found: list[Interval | None] = []
        for axis, subscript in enumerate(self.reference.subscripts):
            if isinstance(subscript, Slice) and is_whole(subscript) or self.goes_through(subscript, axis):
                found.append(None)
                continue
            interval = self.slice(subscript, axis) if isinstance(subscript, Slice) else self.element(subscript, axis)
            if interval is None or not all(map(self.is_fixed, interval)):
                return None
            found.append(interval)
        return tuple(found) if sorted(self.used) == sorted(self.counters) and len(self.used) == len(self.nest) else None

    def goes_through(self, subscript: AST, axis: int) -> bool:
        """Whether a subscript is a counter that goes through the axis, by the text."""
        loop = self.counters.get(subscript.id) if isinstance(subscript, Name) else None
        if loop is None or len(loop.iter.args) > 1 or dump(loop.iter.args[0]) != dump(index(attribute(
                name(self.reference.array), "shape"), const(axis))):
            return False
        self.used.append(loop.target.id)
        return True

    def element(self, subscript: AST, axis: int) -> Interval | None:
        """The places that one subscript names in the nest."""
        form, extent = self.dependence.form(subscript), self.dependence.extent(self.reference.array, axis)
        if form is None or extent is None:
            return None
        counted = [s for s, _ in form.terms if s in self.counters]
        if not counted:
            valid = [at_most(form.shift(1), extent), at_most(extent.times(-1), form)]
            first = self.dependence.from_start(form, extent, self.reference, valid)
            return None if first is None else (first, first.shift(1))
        [counter, *others] = counted
        start, stop, step = range_parts(self.counters[counter])
        low, high = self.dependence.form(start), self.dependence.form(stop)
        rest = form.plus(Affine.symbol(counter), -1)
        if others or counter in dict(rest.terms) or step not in (1, -1) or low is None or high is None:
            return None
        self.used.append(counter)
        low, high = (low, high) if step == 1 else (high.shift(1), low.shift(1))
        first, last = low.plus(rest), high.plus(rest)
        return (first, last) if self.dependence.from_start(first, extent, self.reference, []) == first else None

    def slice(self, subscript: Slice, axis: int) -> Interval | None:
        """The places of a slice. A bound that is clamped to the axis bounds no less; one above that may be negative
        stands for no more places than it names."""
        extent = self.dependence.extent(self.reference.array, axis)
        if extent is None or subscript.step is not None and not (
                isinstance(subscript.step, Constant) and subscript.step.value == 1):
            return None
        low = Affine() if subscript.lower is None else self.dependence.form(subscript.lower)
        high = extent if subscript.upper is None else self.dependence.form(subscript.upper)
        first = None if low is None else self.dependence.from_start(low, extent, self.reference, [])
        if first is None or high is None:
            return None
        if subscript.upper is None:
            return first, high
        return first, self.dependence.from_start(high, extent, self.reference, []) or high

    def is_fixed(self, form: Affine) -> bool:
        """Whether a form is the same in all iterations of the nest."""
        structure = self.dependence.structure
        bound = [b for s, _ in form.terms for b in structure.bindings.get(s, ())]
        return not any(s in self.counters for s, _ in form.terms) and not any(
            x is loop for b in bound for x in structure.place(b).loops for loop in self.nest)
