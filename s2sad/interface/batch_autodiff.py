"""Enzyme's annotated call for several directions: `BatchDuplicated` arguments have a shadow for each.

What is annotated is checked as for one direction. The derivative for many runs on copies, as `jvp` and `vjp` with
batch=True do; only then are the caller's primals and shadows written.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import bind, describe, misfit, shadow
from s2sad.dispatch.cache import ProgramVersion
from s2sad.dispatch.executable import kind_of
from s2sad.interface import batch_calls
from s2sad.interface.activities import Annotation, BatchDuplicated, Duplicated, Mode
from s2sad.interface.autodiff import AnnotatedCall
from s2sad.interface.pytrees import Carrier, flatten
from s2sad.interface.selection import RETURN, Selection
from s2sad.interface.value_calls import ForwardCall, ReverseCall
from s2sad.run.overlap import Check, Slot


def width_of(names: Sequence[str], annotated: Sequence[Any]) -> int:
    """How many directions there are; raises S2sadError (S402) unless each argument with shadows has as many."""
    widths = {}
    for name, mark in zip(names, annotated):
        if isinstance(mark, Duplicated):
            raise _refused(f"the argument '{name}' has one shadow, others have several",
                           f"say BatchDuplicated({name}, (d1, d2, ...)), with as many as these")
        if not isinstance(mark, BatchDuplicated):
            continue
        if not isinstance(mark.shadows, (tuple, list)):
            raise _refused(f"the shadows of '{name}' are of type {type(mark.shadows).__name__}",
                           "give a tuple with one for each direction: (d1, d2)")
        if not mark.shadows:
            raise _refused(f"the argument '{name}' has no shadow", "give a tuple with one for each direction: (d1, d2)")
        widths[name] = len(mark.shadows)
    first = next(iter(widths))
    for name, width in widths.items():
        if width != widths[first]:
            raise _refused(f"'{first}' has {widths[first]} shadows, '{name}' has {width}", "give all of them as many")
    return widths[first]


class BatchAnnotatedCall:
    """A prepared `autodiff` for several directions."""

    def __init__(self, state: ProgramVersion, mode: Mode, annotated: Sequence[Any], selection: Selection,
                 width: int):
        self.mode, self.width = mode, width
        primals = [a.value if isinstance(a, Annotation) else a for a in annotated]
        if flatten(state, bind(state.kernel, primals)) is not None:
            raise _refused(f"'{state.kernel.name}' takes or returns a structure, and an argument is BatchDuplicated",
                           "call once for each direction with Duplicated(x, shadow)")
        self.one = AnnotatedCall(state, mode, [
            Duplicated(a.value, a.shadows[0]) if isinstance(a, BatchDuplicated) else a for a in annotated], selection)
        names, duplicated = state.parameters, self.one.duplicated
        self.written = tuple(n for n in duplicated if names.index(n) in self.one.written)
        values, self.call = tuple(self.one.values_of(primals)), None
        carrier = Carrier(selection)
        of = (*self.written, *((RETURN,) if self.one.results.own else ()))
        if self.one.variant is not None and mode.reverse:
            self.call = ReverseCall(state, carrier, values, of, (*duplicated, *self.one.active))
            self.call.warns = False
        elif self.one.variant is not None:
            self.call = ForwardCall(state, carrier, values, duplicated, of)
        summary = self.one.summary
        self._arrays = [k for k, t in enumerate(self.one.types) if t.is_array]
        self._shadowed = [n for n in duplicated if self.one.types[names.index(n)].is_array]
        primal = [Slot(names[k], "primal", names[k], names[k] in summary.written) for k in self._arrays]
        labels = [self._label(n, k) for n in self._shadowed for k in range(width)]
        self._apart = Check([*primal, *(Slot(label, "shadow", label, True) for label in labels)], "numpy")

    def _label(self, name: str, k: int) -> str:
        return f"{name}_{'bar' if self.mode.reverse else 'dot'}[{k}]"

    def __call__(self, primals: Sequence[Any], shadows: Mapping[str, Sequence[Any]], seed: Any) -> Any:
        values = self.one.values_of(primals)
        by_name = dict(zip(self.one.state.parameters, values))
        owned = {n: [shadow(self._label(n, k), s, n, by_name[n]) for k, s in enumerate(given)]
                 for n, given in shadows.items()}
        self._apart.exact([*(values[k] for k in self._arrays), *(s for n in self._shadowed for s in owned[n])])
        stacked = {n: np.stack(given) if n in self._shadowed else np.array([
            complex(s) if isinstance(s, complex) else float(s) for s in given]) for n, given in owned.items()}
        if self.mode.reverse:
            found = self._backwards(values, by_name, stacked, self._seeds(seed, by_name))
        else:
            self.one.seeds_of(seed, by_name)
            found = batch_calls.jvp(self.call, values, stacked) if isinstance(self.call, ForwardCall) else {}
        if self.call is None:
            self.one.state.check_bounds(values, self.one.engine)
        primal = self.one.run_primal(values) if self.one.keeps or self.call is None else None
        for name in self._shadowed:
            if name in found and (self.mode.reverse or name in self.written):
                for mine, made in zip(owned[name], found[name]):
                    mine[...] = made if name in self.written else mine + made
        derivative = self._adjoints(found) if self.mode.reverse else self._tangents(found, primal, owned)
        return (derivative, primal) if self.mode.with_primal else derivative

    def _seeds(self, seed: Any, by_name: Mapping[str, Any]) -> dict[int, np.ndarray]:
        """The seeds of results by position, along one more axis."""
        if seed is not None and (not isinstance(seed, (tuple, list)) or len(seed) != self.width):
            raise misfit(f"the seed is {'of ' + str(len(seed)) if isinstance(seed, (tuple, list)) else 'no tuple'}, "
                         f"there are {self.width} directions", "give a tuple of one seed for each")
        each = [self.one.seeds_of(s, dict(by_name)) for s in (seed or (None,) * self.width)]
        return {place: np.array([s[place] for s in each]) for place in each[0]}

    def _backwards(self, values: Sequence[Any], by_name: Mapping[str, Any], stacked: dict[str, np.ndarray],
                   seeds: dict[int, np.ndarray]) -> dict[str, Any]:
        if not isinstance(self.call, ReverseCall):
            return {}
        results = self.one.results
        weights: dict[str, Any] = {n: stacked[n] for n in self.written}
        for place, name in results.aliases.items():
            if place in seeds:
                weights[name] = weights[name] + seeds.pop(place)
        if results.own:
            items = [seeds.get(k, np.zeros((self.width, *np.shape(by_name[results.aliases[k]])), t.dtype)
                               if k in results.aliases else None) for k, t in enumerate(results.types)]
            weights[RETURN] = tuple(items) if len(items) > 1 else items[0]
        return batch_calls.vjp(self.call, values, weights)

    def _adjoints(self, found: Mapping[str, Any]) -> tuple[Any, ...]:
        """Of each Active argument one for each direction."""
        return tuple(tuple(found[n].tolist()) if n in found else (0.0,) * self.width for n in self.one.active)

    def _tangents(self, found: Mapping[str, Any], primal: Any, owned: Mapping[str, Sequence[Any]]) -> tuple[Any, ...]:
        """The tangent of what is returned for each direction."""
        results = self.one.results
        parts: Any = found.get(RETURN, ())
        items = parts if isinstance(parts, tuple) else (parts,)

        def of(k: int) -> Any:
            made = {p: kind_of(results.types[p])(items[p][k]) for p in results.own} if items else (
                self.one.zeros_of(primal))
            return results.structure({**made, **{
                p: owned[n][k] if n in owned else None for p, n in results.aliases.items()}})
        return tuple(map(of, range(self.width)))


def batch_call(state: ProgramVersion, mode: Mode, annotated: Sequence[Any], selection: Selection, seed: Any) -> Any:
    """What `autodiff` gives for several directions."""
    width = width_of(state.parameters, annotated)
    values = [a.value if isinstance(a, Annotation) else a for a in annotated]
    marks = tuple([type(a) if isinstance(a, Annotation) else None for a in annotated])
    key = ("batch", mode, selection, width, marks, describe(values))
    entry = state.entries.get(key)
    if entry is None:
        entry = state.entries[key] = BatchAnnotatedCall(state, mode, annotated, selection, width)
    return entry(values, {n: a.shadows for n, a in zip(state.parameters, annotated) if isinstance(a, BatchDuplicated)},
                 seed)


def _refused(message: str, remedy: str) -> S2sadError:
    return S2sadError(Diagnostic("S402", message, help=remedy))
