"""stored_regions: the part of an array outside of which a function stores nothing, as slices that are known before it.

    u[0] = u[0] * c                                         u[:1]
    for i in range(2, m): u[i, 0] = v[i]                    u[2:m, :1]
    u[lo:hi] = u[lo:hi] * c                                 u[lo:hi], where lo may be negative as well
    advance(u, 2), which stores into u[:m] of its own       u[:2]

It may be larger than what is stored, and ends at an end of an axis where nothing better is known, or where it might
begin before the first place. All but a rim counts as all of an array: as much would be kept.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from s2sad.analyze.dependence import ArrayReference, Dependence, range_parts
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.infer.affine import Affine, at_most
from s2sad.infer.slice_extents import is_whole
from s2sad.liveness import base_name, targets
from s2sad.tree import (
    AST, Add, Call, Constant, For, If, Mult, Name, Slice, Sub, Subscript, UnaryOp, While, attribute, binary, call_name,
    const, index, indices, name, user_call, walk, walk_statements,
)

_DEEPEST = 10       # calls in calls


@dataclass(frozen=True)
class Interval:
    """From the first place up to the second one; as a slice has these `as_written` if they may count from the end."""
    low: Affine
    high: Affine
    as_written: bool = False


@dataclass(frozen=True)
class Callee:
    """A function that is called, and the positions of the arguments that it writes."""
    structure: ProgramStructure
    written: Collection[int]


Callees = Callable[[Call], "Callee | None"]


def stored_region(structure: ProgramStructure, array: str, fixed: Collection[str], callees: Callees
                  ) -> tuple[Slice, ...]:
    """The slices of the axes of an array within which a function stores; none where that may be anywhere. The numbers
    `fixed`, and the sizes of arrays that it is given, are what they are before."""
    region = _Region(structure, array, callees)
    if not region.is_clear:
        return ()
    found = [region.axis(axis, fixed) for axis in range(structure.typing.table[array].rank)]
    return () if all(_is_all_but_a_rim(s) for s in found) else tuple(found)


def _is_new_or_unclear(target: Subscript) -> bool:
    """Whether the axes of a place are not those of its subscripts."""
    return any(isinstance(s, Constant) and s.value in (None, ...) for s in indices(target)) and len(indices(target)) > 1


def _is_all_but_a_rim(part: Slice) -> bool:
    """Whether a slice leaves out a fixed number of places."""
    begins = part.lower is None or isinstance(part.lower, Constant)
    return begins and (part.upper is None or isinstance(part.upper, UnaryOp))


class _Region:
    """One array of a function, within so many calls."""

    def __init__(self, structure: ProgramStructure, array: str, callees: Callees, depth: int = 0):
        self.dependence, self.array, self.callees, self.depth = Dependence(structure), array, callees, depth
        self.parameters = [p.id for p in structure.function.args.args]
        statements = list(walk_statements(structure.function.body))
        stored = [(t, s) for s in statements for t in targets(s) if isinstance(t, Subscript) and base_name(t) == array]
        self.stores = [ArrayReference.to(t, s) for t, s in stored]
        self.calls: list[tuple[_Region, Call, AST]] = []
        known = all(self.follows(call, s) for s in statements for call in _calls(s))
        self.is_clear = known and not any(_is_new_or_unclear(t) for t, _ in stored) and bool(self.stores or self.calls)

    def follows(self, call: Call, statement: AST) -> bool:
        """Whether it is known where a call stores into the array: `calls` has it then, if it does."""
        given = [k for k, a in enumerate(call.args) if isinstance(a, (Name, Subscript)) and base_name(a) == self.array]
        if not given:
            return True
        callee = self.callees(call)
        if callee is None or self.depth > _DEEPEST:
            return False
        parameters = [p.id for p in callee.structure.function.args.args]
        for k in given:
            if k not in callee.written:
                continue
            inner = _Region(callee.structure, parameters[k], self.callees, self.depth + 1)
            if not inner.is_clear or not isinstance(call.args[k], Name) or isinstance(statement, (For, If, While)):
                return False
            self.calls.append((inner, call, statement))
        return True

    def axis(self, axis: int, fixed: Collection[str]) -> Slice:
        """The slice of an axis that holds all stores."""
        extent, found = self.dependence.extent(self.array, axis), self.intervals(axis)
        if None in found or extent is None:
            return Slice(None, None, None)
        several = [interval for interval in found if interval is not None]
        if any(interval.as_written for interval in several):
            low, high = several[0].low, several[0].high
            one = len({*several}) == 1 and self.is_known(low, fixed) and self.is_known(high, fixed)
            return Slice(_expression(low), _expression(high), None) if one else Slice(None, None, None)
        low, high = _extreme([i.low for i in several], least=True), _extreme([i.high for i in several], least=False)
        begins = low is not None and low != Affine() and self.is_known(low, fixed) and _is_natural(low)
        return Slice(_expression(low) if begins and low is not None else None,
                     None if high is None or high == extent or not self.is_known(high, fixed) else _end(high, extent),
                     None)

    def intervals(self, axis: int) -> list[Interval | None]:
        """Where each store may be; None for one that may be anywhere."""
        extent = self.dependence.extent(self.array, axis)
        if extent is None:
            return [None]
        return [*(self.interval(s, axis, extent) for s in self.stores),
                *(self.in_caller(i, call, s) for inner, call, s in self.calls for i in inner.intervals(axis))]

    def in_caller(self, interval: Interval | None, call: Call, statement: AST) -> Interval | None:
        """Where a store of a called function may be, of whose parameters its place was known."""
        callee = self.callees(call)
        if interval is None or callee is None:
            return None
        forms: dict[str, Affine | None] = {}
        for parameter, argument in zip((p.id for p in callee.structure.function.args.args), call.args):
            kind = callee.structure.typing.table[parameter]
            if not kind.is_array:
                forms[parameter] = self.dependence.form(argument)
            elif isinstance(argument, Name):
                forms |= {f"{parameter}.shape[{k}]": self.dependence.extent(argument.id, k) for k in range(kind.rank)}
        known = {symbol: form for symbol, form in forms.items() if form is not None}
        if any(s not in known for end in (interval.low, interval.high) for s, _ in end.terms):
            return None
        return self.bounded(interval.low.replaced(known), interval.high.replaced(known), ArrayReference(
            self.array, (), statement), interval.as_written)

    def bounded(self, low: Affine, high: Affine, store: ArrayReference, as_written: bool) -> Interval | None:
        """What holds all intervals in the loops around a store."""
        first, least, last = self.bound(low, store, True), self.bound(high, store, True), self.bound(high, store, False)
        if first is None or least is None or last is None:
            return None
        if not as_written or _is_natural(first) and _is_natural(least):
            return Interval(first, last)
        return Interval(low, high, True) if (first, last) == (low, high) else None

    def interval(self, store: ArrayReference, axis: int, extent: Affine) -> Interval | None:
        """Where one store may be; None if that is anywhere."""
        if axis >= len(store.subscripts) or is_whole(subscript := store.subscripts[axis]):
            return None
        taken = subscript if isinstance(subscript, Slice) else self.gone_through(subscript, store, extent)
        if taken is not None:
            return self.slice(taken, store, extent)
        form = self.dependence.form(subscript)
        if form is None:
            return None
        valid = [at_most(form.shift(1), extent), at_most(extent.times(-1), form)]
        place = self.dependence.from_start(form, extent, store, valid)
        found = None if place is None else self.bounded(place, place, store, False)
        return found and Interval(found.low, found.high.shift(1))

    def gone_through(self, subscript: AST, store: ArrayReference, extent: Affine) -> Slice | None:
        """The slice that a loop goes through whose counter a subscript is, where the loop was made of one."""
        around = [x for x in self.dependence.structure.place(store.statement).loops if isinstance(x, For)]
        loop = next((x for x in around if isinstance(subscript, Name) and x.target.id == subscript.id), None)
        start, stop, step = (None, None, None) if loop is None else range_parts(loop)
        if start is None or stop is None or step != 1:
            return None
        ends = [e.args[0] if call_name(e) == "runtime.position" and self.dependence.form(e.args[1]) == extent else
                e if isinstance(e, Constant) and e.value >= 0 or self.dependence.form(e) == extent else None
                for e in (start, stop)]
        return None if None in ends or ends == [start, stop] else Slice(*ends, None)

    def slice(self, subscript: Slice, store: ArrayReference, extent: Affine) -> Interval | None:
        if subscript.step is not None and not (isinstance(subscript.step, Constant) and subscript.step.value > 0):
            return None
        low, high = (missing if end is None else self.dependence.form(end) for end, missing in (
            (subscript.lower, Affine()), (subscript.upper, extent)))
        if low is None or high is None:
            return None
        first, last = (form if end is None else self.dependence.from_start(form, extent, store, []) for form, end in (
            (low, subscript.lower), (high, subscript.upper)))
        if first is None or last is None:
            return self.bounded(low, high, store, True)
        return self.bounded(first, last, store, False)

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

    def is_known(self, form: Affine, fixed: Collection[str]) -> bool:
        """Whether a form is known before the function."""
        return all(s in fixed or ".shape[" in s and s.partition(".")[0] in self.parameters for s, _ in form.terms)


def _calls(statement: AST) -> Iterator[Call]:
    """The calls of functions of the program in a statement, but in none that is in it."""
    parts = [statement.iter] if isinstance(statement, For) else [statement.test] if isinstance(statement, (
        If, While)) else [statement]
    return (n for part in parts for n in walk(part) if user_call(n))


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
