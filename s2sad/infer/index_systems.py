"""index_systems: what can hold at a place in a function, as systems of inequalities in what the function is given.

A claim about integers, with what the loops and branches around it say of them, is a system of forms that are not
negative. What is no affine form is one in each of several cases: the least of two sizes, a remainder, a name that is
bound several times, the result of a call. All symbols but sizes and integers of parameters are eliminated
(`affine.projected`): what is left holds wherever the claim can, and perhaps elsewhere.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import count

from s2sad.infer.affine import Affine, projected
from s2sad.infer.argument_parts import GREATEST, Part
from s2sad.infer.integer_cases import Case, cases_of
from s2sad.infer.shapes import Shapes
from s2sad.infer.path_conditions import CallSite
from s2sad.tree import AST, BinOp, Call, FloorDiv, Mod, Name, Slice, Subscript, call_name, indices

System = tuple[Affine, ...]
_CASES = 32             # in which a system is split
_DIFFERENT = 3          # forms that are not zero, of each of which there are two cases
_OPERATORS = {Mod: "%", FloorDiv: "//"}


@dataclass(frozen=True)
class IndexBounds:
    """Systems of forms in the symbols of a function's `parameters` (for each, its position and what of it): where one
    system has no negative form, an index may be out of bounds. `result` has the cases of the integer that is returned,
    none if it is not known."""
    systems: frozenset[System]
    parameters: dict[str, tuple[int, Part]]
    result: tuple[tuple[Affine, System], ...] = ()

    @property
    def never_known(self) -> bool:
        """Whether no sizes exclude an index out of bounds."""
        return () in self.systems


Callee = Callable[[Call], "IndexBounds | None"]


@dataclass
class IndexSystems:
    """Those of one function. `bindings` has the values of names that are bound several times, each with what holds
    there, `calls` the names that are bound once, to the result of a call."""
    shapes: Shapes
    parameters: dict[str, tuple[int, Part]]
    callee: Callee
    bindings: dict[str, list[tuple[Affine | None, System]]] = field(default_factory=dict)
    calls: dict[str, tuple[str, Call]] = field(default_factory=dict)
    found: set[System] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._asked: set[tuple[System, System]] = set()
        self._numbers = count()

    def collect(self, here: CallSite, *claim: Affine) -> None:
        """What of a claim can hold at a place."""
        if (claim, here.places) in self._asked:
            return
        self._asked.add((claim, here.places))
        for system in self.split(here, claim):
            left = projected(here.with_bounds(system), self.parameters)
            if left is not None:
                self.found.add(tuple(sorted((f for f in left if not self._always(f)), key=repr)))

    def weakest(self) -> frozenset[System]:
        """The systems that hold wherever any does."""
        kept: list[dict[tuple[tuple[str, int], ...], int]] = []
        for system in sorted(self.found, key=lambda s: (len(s), repr(s))):
            least: dict[tuple[tuple[str, int], ...], int] = {}
            for form in system:
                least[form.terms] = min(form.constant, least.get(form.terms, form.constant))
            if not any(_follows(least, other) for other in kept):
                kept = [other for other in kept if not _follows(other, least)] + [least]
        return frozenset(tuple(Affine(terms, constant) for terms, constant in each.items()) for each in kept)

    def _always(self, form: Affine) -> bool:
        """Whether a form of parameters is never negative."""
        return form.constant >= 0 and all(c > 0 and isinstance(self.parameters[s][1], int) for s, c in form.terms)

    def split(self, here: CallSite, claim: System) -> list[list[Affine]]:
        """The claim, with what holds at a place, for each way to compute what is no affine form."""
        waiting: list[tuple[list[Affine], int, dict[str, Affine]]] = [([*claim, *here.places], len(claim), {})]
        done: list[list[Affine]] = []
        while waiting:
            system, first, chosen = waiting.pop()
            relevant = self._about(system, first)
            symbols = sorted({s for form in relevant for s, _ in form.terms} - chosen.keys())
            found = next(((s, c) for s in symbols if (c := self._cases(s, here))), None)
            if found is None or len(waiting) + len(done) >= _CASES:
                done.append(relevant)
                continue
            symbol, cases = found
            for form, conditions in cases:
                value = Affine.symbol(symbol) if form is None else form.replaced(chosen)
                known = {s: f.replaced({symbol: value}) for s, f in chosen.items()} | {symbol: value}
                forms = [*system[:first], *conditions, *system[first:]]
                waiting.append(([f.replaced(known) for f in forms], first + len(conditions), known))
        return done

    def _about(self, system: list[Affine], first: int) -> list[Affine]:
        """The forms of a system that say more of the symbols of its first ones; all if these have none."""
        found, left = system[:first], system[first:]
        symbols = {s for form in found for s, _ in form.terms}
        while symbols and left:
            more = [f for f in left if not symbols.isdisjoint(
                {s for s, _ in f.terms if s not in self.parameters} or {s for s, _ in f.terms})]
            if not more:
                return found
            found, left = found + more, [f for f in left if f not in more]
            symbols |= {s for form in more for s, _ in form.terms}
        return system

    # -- cases ---------------------------------------------------------------------------------------------------------

    def _cases(self, symbol: str, here: CallSite) -> list[Case]:
        """What a symbol may be, each with what holds then; empty if nothing is known of it."""
        if symbol in self.bindings:
            return self._bound_cases(symbol)
        if symbol in self.calls:
            bound, node = self.calls[symbol]
            return self._called_cases(node, here) if bound in here.bound else []    # else its arguments were others
        atom = self.shapes.atoms.get(symbol)
        if isinstance(atom, BinOp) and type(atom.op) in _OPERATORS:
            function, given = _OPERATORS[type(atom.op)], [atom.left, atom.right]
        elif isinstance(atom, Call):
            counted = call_name(atom) == "builtins.len" and call_name(atom.args[0]) == "builtins.range"
            inner = atom.args[0] if counted else atom       # the length of a range is of what the range is given
            function, given = call_name(inner) or "", inner.args
        else:
            return []
        forms = [form for a in given if (form := here.size(a)) is not None]
        return cases_of(function, forms, Affine.symbol(symbol)) if len(forms) == len(given) > 0 else []

    def _bound_cases(self, symbol: str) -> list[Case]:
        """The values of a name that is bound several times, under what held there, then."""
        found: list[Case] = []
        for form, places in self.bindings[symbol]:
            if form is None:
                return []
            then = {s: Affine.symbol(f"{s} then {next(self._numbers)}") for f in (form, *places) for s, _ in f.terms
                    if s not in self.parameters}
            found.append((form.replaced(then), [f.replaced(then) for f in places]))
        return found

    def _called_cases(self, node: Call, here: CallSite) -> list[Case]:
        """What a call may return."""
        bounds = self.callee(node)
        if bounds is None:
            return []
        given = self.arguments(node, bounds, here)
        return [(form.replaced(given), [f.replaced(given) for f in conditions]) for form, conditions in bounds.result]

    def result(self, form: Affine | None, here: CallSite) -> tuple[tuple[Affine, System], ...]:
        """The cases of what is returned, in what the function is given; none if something else decides it."""
        found: list[tuple[Affine, System]] = []
        if form is None:
            return ()
        for places in apart(here):
            for made, *conditions in self.split(replace(here, places=places), (form,)):
                left = projected(here.with_bounds(conditions), self.parameters)
                if any(s not in self.parameters for s, _ in made.terms):
                    return ()
                if left is not None:
                    found.append((made, tuple(left)))
        return tuple(found)

    # -- calls ---------------------------------------------------------------------------------------------------------

    def arguments(self, node: Call, bounds: IndexBounds, here: CallSite) -> dict[str, Affine]:
        """The forms of what a call gives for the symbols of its callee; a symbol of its own for what is no form."""
        return {symbol: self._given(node.args[place], axis, here) or Affine.symbol(
            f"{symbol} of call {next(self._numbers)}") for symbol, (place, axis) in bounds.parameters.items()}

    def _given(self, argument: AST, axis: Part, here: CallSite) -> Affine | None:
        """The form of an integer that a call passes, or of the size of an array: a whole one, or rows of one. No row
        has elements beyond the extremes of the whole."""
        if axis is None:
            return here.size(argument)
        if isinstance(axis, str):
            whole = argument.value if isinstance(argument, Subscript) else argument
            ends = here.extremes.get(whole.id) if isinstance(whole, Name) else None
            return None if ends is None else Affine.symbol(ends[axis == GREATEST])
        if isinstance(argument, Name):
            return self.shapes.of(argument)[axis]
        if not isinstance(argument, Subscript) or not isinstance(argument.value, Name):
            return None
        asked, whole = indices(argument), self.shapes.of(argument.value)
        if any(not isinstance(s, Slice) and not self.shapes.typing.of(s).is_number for s in asked):
            return None
        kept = [k for k in range(len(whole)) if k >= len(asked) or isinstance(asked[k], Slice)]
        part = asked[kept[axis]] if kept[axis] < len(asked) else None
        return whole[kept[axis]] if part is None or not any((part.lower, part.upper, part.step)) else None


def _follows(one: dict[tuple[tuple[str, int], ...], int], other: dict[tuple[tuple[str, int], ...], int]) -> bool:
    """Whether a system, as the constants of its forms, holds only where the other does."""
    return all(terms in one and one[terms] <= constant for terms, constant in other.items())


def apart(here: CallSite) -> list[System]:
    """What holds at a place, for each way in which forms that are not zero there are above or below."""
    found: list[System] = [here.places]
    for form in here.others[:_DIFFERENT]:
        found = [(*places, side) for places in found for side in (form.shift(-1), form.times(-1).shift(-1))]
    return found
