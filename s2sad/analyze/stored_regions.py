"""stored_regions: the part of an array outside of which a function stores nothing, as slices that are known before it.

    u[0] = u[0] * c                                         u[:1]
    for i in range(2, m): u[i, 0] = v[i]                    u[2:m, :1]

It may be larger than what is stored, and ends at an end of an axis where nothing better is known, or where it might
begin before the first place. All but a rim counts as all of an array: as much would be kept.
"""
from __future__ import annotations

from collections.abc import Collection, Sequence

from s2sad.analyze.dependence import ArrayReference, Dependence, range_parts
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.infer.affine import Affine, at_most
from s2sad.infer.slice_extents import is_whole
from s2sad.liveness import base_name, targets
from s2sad.tree import (
    AST, Add, Constant, For, Mult, Name, Slice, Sub, Subscript, UnaryOp, attribute, binary, call_name, const, index,
    indices, name, user_call, walk, walk_statements,
)

Interval = tuple[Affine, Affine]        # from the first place up to the second one


def stored_region(structure: ProgramStructure, array: str, fixed: Collection[str]) -> tuple[Slice, ...]:
    """The slices of the axes of an array within which a function stores; none where that may be anywhere, or a function
    that it calls stores there. The numbers `fixed`, and the sizes of arrays that it is given, are what they are
    before."""
    rank = structure.typing.table[array].rank
    statements = list(walk_statements(structure.function.body))
    stored = [(t, s) for s in statements for t in targets(s) if isinstance(t, Subscript) and base_name(t) == array]
    given = any(isinstance(a, (Name, Subscript)) and base_name(a) == array
                for s in statements for n in walk(s) if user_call(n) for a in n.args)
    if given or not stored or any(_is_new_or_unclear(t) for t, _ in stored):
        return ()
    region = _Region(Dependence(structure), array, fixed)
    found = [region.axis([ArrayReference.to(t, s) for t, s in stored], axis) for axis in range(rank)]
    return () if all(_is_all_but_a_rim(s) for s in found) else tuple(found)


def _is_new_or_unclear(target: Subscript) -> bool:
    """Whether the axes of a place are not those of its subscripts."""
    return any(isinstance(s, Constant) and s.value in (None, ...) for s in indices(target)) and len(indices(target)) > 1


def _is_all_but_a_rim(part: Slice) -> bool:
    """Whether a slice leaves out a fixed number of places."""
    begins = part.lower is None or isinstance(part.lower, Constant)
    return begins and (part.upper is None or isinstance(part.upper, UnaryOp))


class _Region:
    """One array of a function."""

    def __init__(self, dependence: Dependence, array: str, fixed: Collection[str]):
        self.dependence, self.array, self.fixed = dependence, array, fixed
        self.parameters = {p.id for p in dependence.structure.function.args.args}

    def axis(self, stores: Sequence[ArrayReference], axis: int) -> Slice:
        """The slice of an axis that holds all stores."""
        extent = self.dependence.extent(self.array, axis)
        found = [None if extent is None else self.interval(s, axis, extent) for s in stores]
        lows = [interval and interval[0] for interval in found]
        highs = [interval and interval[1] for interval in found]
        low, high = _extreme(lows, least=True), _extreme(highs, least=False)
        begins = low is not None and low != Affine() and self.is_known(low) and _is_natural(low)
        return Slice(_expression(low) if begins and low is not None else None,
                     None if high is None or extent is None or high == extent or not self.is_known(high) else
                     _end(high, extent), None)

    def interval(self, store: ArrayReference, axis: int, extent: Affine) -> Interval | None:
        """Where one store may be; None if that is anywhere."""
        if axis >= len(store.subscripts) or is_whole(subscript := store.subscripts[axis]):
            return None
        if isinstance(subscript, Slice):
            return self.slice(subscript, store, extent)
        form = self.dependence.form(subscript)
        if form is None:
            return None
        valid = [at_most(form.shift(1), extent), at_most(extent.times(-1), form)]
        place = self.dependence.from_start(form, extent, store, valid)
        first, last = (None if place is None else self.bound(place, store, least) for least in (True, False))
        return None if first is None or last is None else (first, last.shift(1))

    def slice(self, subscript: Slice, store: ArrayReference, extent: Affine) -> Interval | None:
        if subscript.step is not None and not (isinstance(subscript.step, Constant) and subscript.step.value > 0):
            return None
        found: list[Affine | None] = []
        for end, missing, least in ((subscript.lower, Affine(), True), (subscript.upper, extent, False)):
            form = missing if end is None else self.dependence.form(end)
            place = form if form is None or end is None else self.dependence.from_start(form, extent, store, [])
            found.append(None if place is None else self.bound(place, store, least))
        low, high = found
        return None if low is None or high is None else (low, high)

    def bound(self, form: Affine, store: ArrayReference, least: bool) -> Affine | None:
        """The least or the largest value of a form in the loops around a store; None if it is not known."""
        for loop in reversed(self.dependence.structure.place(store.statement).loops):
            factor = dict(form.terms).get(loop.target.id, 0) if isinstance(loop, For) else 0
            if not isinstance(loop, For) or factor == 0:
                continue
            start, stop, step = range_parts(loop)
            first, end = self.dependence.form(start), self.dependence.form(self.unclamped(stop, start, step))
            if not isinstance(step, int) or first is None or end is None:
                return None
            low, high = (first, end.shift(-1)) if step > 0 else (end.shift(1), first)
            form = form.replaced({loop.target.id: low if least == (factor > 0) else high})
        return form

    def unclamped(self, stop: AST, start: AST, step: int | AST) -> AST:
        """A bound that iterations do not go beyond, as they do not beyond the stop of a loop."""
        if call_name(stop) == "builtins.min" and isinstance(step, int) and step > 0:
            known = [a for a in stop.args if isinstance(a, Constant)]
            return known[0] if known else stop
        if call_name(stop) == "builtins.max" and isinstance(start, Constant):
            above = [a for a in stop.args if not (isinstance(a, Constant) and a.value <= start.value)]
            return above[0] if len(above) == 1 else stop
        return stop

    def is_known(self, form: Affine) -> bool:
        """Whether a form is known before the function."""
        return all(s in self.fixed or ".shape[" in s and s.partition(".")[0] in self.parameters for s, _ in form.terms)


def _is_natural(form: Affine) -> bool:
    """Whether a form is not negative for any sizes: a place that is would be counted from the end."""
    return form.constant >= 0 and all(c > 0 and ".shape[" in s for s, c in form.terms)


def _extreme(forms: Sequence[Affine | None], least: bool) -> Affine | None:
    """The least or the largest of forms; None where that depends on their symbols."""
    if any(f is None or f.terms != (forms[0] or f).terms for f in forms):
        return None
    known = [f for f in forms if f is not None]
    return (min if least else max)(known, key=lambda f: f.constant)


def _end(high: Affine, extent: Affine) -> AST:
    """Where a slice ends, counted from the end where that is a number."""
    behind = high.plus(extent, -1)
    return const(behind.constant) if extent.terms and not behind.terms and behind.constant < 0 else _expression(high)


def _expression(form: Affine) -> AST:
    made: AST | None = None
    for symbol, factor in form.terms:
        term = _symbol(symbol) if abs(factor) == 1 else binary(const(abs(factor)), Mult(), _symbol(symbol))
        if made is None:
            made = term if factor > 0 else binary(const(0), Sub(), term)
        else:
            made = binary(made, Add() if factor > 0 else Sub(), term)
    if made is None:
        return const(form.constant)
    return made if not form.constant else binary(made, Add() if form.constant > 0 else Sub(), const(abs(form.constant)))


def _symbol(symbol: str) -> AST:
    array, _, axis = symbol.partition(".shape[")
    return index(attribute(name(array), "shape"), const(int(axis[:-1]))) if axis else name(symbol)
