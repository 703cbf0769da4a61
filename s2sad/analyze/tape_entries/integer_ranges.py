"""integer_ranges: the narrowest dtype of integers that are recorded, by what they are proven to be.

    state = 0                               state is from -128 to 127 where it is bound, if it was before:
    for i in range(n):                      int8 is enough
        if y > 1.0:
            state = (state + 3) % 5
        y = y * x[state]

Requires the plan of what is recorded. That every binding of some names leaves them within a dtype's range, as long as
all of them are, is shown by `index_systems`: the claim that one does not has no solution.
"""
from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from s2sad.analyze.dependence import range_parts
from s2sad.analyze.index_bounds import IndexSearch, is_searchable
from s2sad.analyze.program_structure import ProgramStructure, StatementPlace
from s2sad.analyze.recording_plan import RecordingPlan
from s2sad.analyze.trip_counts import trip_counts
from s2sad.infer.affine import Affine, at_most, feasible
from s2sad.infer.inference import Typing
from s2sad.infer.promotion import CASTS
from s2sad.infer.path_conditions import CallSite
from s2sad.tree import AST, Assign, For, FunctionDef, Name, While, call_name, dump, name, stored_names, times_bound

_NARROW = ("int8", "int16", "int32")
_PLACES = ("numpy.argmax", "numpy.argmin")


def integer_ranges(structure: ProgramStructure, plan: RecordingPlan) -> dict[str, str]:
    """The dtypes that are enough, by the keys of what is recorded."""
    function, typing = structure.function, structure.typing
    recorded = {k: v.name for k, v in plan.recorded.items() if typing.table[v.name].dtype == "int64"}
    recorded |= {f"trips {i}": f"trips {i}" for i in plan.reversed if _is_left(structure, structure.places[i])}
    if not recorded or not is_searchable(function, typing):
        return {}
    search = _Ranges(function, typing, plan.reversed)
    search.found()
    dtypes = search.dtypes({*recorded.values()})
    return {k: dtypes[n] for k, n in recorded.items() if n in dtypes}


def _is_left(structure: ProgramStructure, place: StatementPlace) -> bool:
    """Whether a statement is a loop in another one that counts, and may be left before its last iteration."""
    return bool(place.loops) and isinstance(place.statement, For) and trip_counts(structure, place.statement) is None


class _Ranges(IndexSearch):
    """Goes through a function; `bindings` has the forms of what names are bound to, each with its place, None where it
    is no form."""

    def __init__(self, function: FunctionDef, typing: Typing, reversed: set[int]):
        super().__init__(function, typing, lambda node: None)
        self.reversed = reversed
        others = {p.id for p in function.args.args} | set(times_bound(function.body, For))
        self.several = frozenset(n for n in set(times_bound(function.body, Assign)) - others
                                 if typing.table[n].dtype == "int64" and typing.table[n].is_number)
        self.bindings: dict[str, list[tuple[Affine | None, CallSite]]] = {}
        self.limits: dict[str, tuple[int, int]] = {}        # by symbol

    def statement(self, statement: AST, here: CallSite) -> CallSite:
        """Notes what the number of a loop's iterations does not exceed. What is known of a name that is bound is known
        of what it was bound to before."""
        if isinstance(statement, (For, While)):
            here = without(here, stored_names(statement))
        if self.looking and isinstance(statement, For) and id(statement) in self.reversed:
            most = self.most_trips(statement, here)
            ran = here if most is None else replace(here, places=(*here.places, most))
            self.bindings[f"trips {id(statement)}"] = [(most, ran)]
        return without(super().statement(statement, here), stored_names(statement))

    def most_trips(self, loop: For, here: CallSite) -> Affine | None:
        """A form that the number of a loop's iterations does not exceed, where it is not negative."""
        start, stop, step = range_parts(loop)
        first, end = self.index(start, here), self.index(stop, here)
        if first is None or end is None or not isinstance(step, int):
            return None
        return at_most(first, end) if step > 0 else at_most(end, first)

    def expression(self, node: AST, here: CallSite) -> None:
        """Nothing is asked of indices."""

    def bind(self, statement: AST, here: CallSite) -> None:
        """Notes what a statement binds."""
        target = statement.targets[0] if isinstance(statement, Assign) else None
        for bound in self.several.intersection(stored_names(statement)) if self.looking else ():
            form = self.form(statement.value, here) if isinstance(target, Name) else None
            self.bindings.setdefault(bound, []).append((form, here))

    def form(self, value: AST, here: CallSite) -> Affine | None:
        """The form of what a name is bound to; a symbol with limits for what has these by its type or size."""
        called, given = call_name(value), getattr(value, "args", ())
        limits = None
        if called in _PLACES and len(given) == 1 and self.typing.of(given[0]).rank == 1:
            size = self.shapes.of(given[0])[0]
            limits = None if size is None or size.terms or size.constant < 1 else (0, size.constant - 1)
        elif CASTS.get(called or "") == "int64" and len(given) == 1:
            kind = self.typing.of(given[0])
            limits = (0, 1) if kind.dtype == "bool" else limits_of(kind.dtype) if kind.dtype in _NARROW else None
        if limits is None:
            return self.index(value, here)
        self.limits[dump(value)] = limits
        return Affine.symbol(dump(value))

    # -- what is proven ----------------------------------------------------------------------------------------------

    def dtypes(self, wanted: set[str]) -> dict[str, str]:
        """The narrowest dtype of each name for which there is one."""
        found: dict[str, str] = {}
        names = {n for n in self.needed(wanted) if all(form is not None for form, _ in self.bindings[n])}
        for dtype in _NARROW:
            within = self.within(names - found.keys(), dtype)
            found |= dict.fromkeys(within, dtype)
            self.limits |= {dump(name(n)): limits_of(dtype) for n in within}
        return found

    def needed(self, wanted: set[str]) -> set[str]:
        """The names, and those that decide what they are bound to."""
        symbols = {dump(name(n)): n for n in self.bindings}
        found: set[str] = set()
        waiting = sorted(wanted & self.bindings.keys())
        while waiting:
            one = waiting.pop()
            if one not in found:
                found.add(one)
                waiting += [symbols[s] for form, here in self.bindings[one] for f in (form, *here.places) if f
                            for s, _ in f.terms if s in symbols]
        return found

    def within(self, names: set[str], dtype: str) -> set[str]:
        """The names that stay within a dtype's range."""
        while True:
            assumed = self.limits | {dump(name(n)): limits_of(dtype) for n in names}
            left = {n for n in names if not any(self.may(claim, here, assumed) for form, here in self.bindings[n]
                                                for claim in outside(form, dtype))}
            if left == names:
                return names
            names = left

    def may(self, claim: Affine, here: CallSite, assumed: dict[str, tuple[int, int]]) -> bool:
        """Whether a claim can hold at a place."""
        for system in self.systems.split(here, (claim,)):
            known = here.with_bounds(system)
            symbols = sorted({s for form in known for s, _ in form.terms if s in assumed})
            known += [side for s in symbols for side in (Affine.symbol(s).shift(-assumed[s][0]),
                                                         Affine.symbol(s).times(-1).shift(assumed[s][1]))]
            if feasible(known):
                return True
        return False


def without(here: CallSite, names: Collection[str]) -> CallSite:
    """The place without what is known there of some names."""
    gone = [dump(name(n)) for n in names]
    left = tuple(f for f in here.places if not any(g in s for s, _ in f.terms for g in gone))
    return here if len(left) == len(here.places) else replace(here, places=left)


def limits_of(dtype: str) -> tuple[int, int]:
    return int(np.iinfo(dtype).min), int(np.iinfo(dtype).max)


def outside(form: Affine | None, dtype: str) -> Iterator[Affine]:
    """The claims that a form is outside of a dtype's range.

    >>> [f.constant for f in outside(Affine.symbol("i"), "int8")]
    [-128, -129]
    """
    if form is not None:
        least, most = limits_of(dtype)
        yield form.shift(-most - 1)
        yield form.times(-1).shift(least - 1)
