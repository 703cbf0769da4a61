"""Calls with shadows that the caller owns: `f.adjoint(...)` and `f.tangent(...)`.

One instance serves all later calls with arguments of the same types. Nothing is written before everything fits.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np

from s2sad.binding import FLOATS, admitted, coerced, shadow, types as types_of, written_argument
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import Request
from s2sad.selection import RETURN, Results, array_seed, number_seed, selected_of, selected_wrt
from s2sad.variants import HIDDEN, State, Variant

_LAYOUTS = 32


class ShadowedCall:
    """A prepared `f.adjoint(...)` or `f.tangent(...)`: the positions of its arguments are known."""

    def __init__(self, state: State, mode: str, args: tuple[Any, ...], selection: tuple[Any, Any, str]):
        self.state, self.mode, self.selection = state, mode, selection
        self.variant, self.layout, values = self._found(args)
        by_name = dict(zip(state.parameters, values))
        types = types_of(values)
        for name, value in by_name.items():
            if name in state.summary(types).written:
                written_argument(name, value)
        self._types, results = types, Results.of(state.summary(types))
        self._seed_places = results.places([p.name for p in self.variant.seeds])
        self._array_seeds = any(p.type.is_array for p in self.variant.seeds)
        self._hidden = [k for k, p in enumerate(self.variant.parameters) if p.name.startswith(HIDDEN)]
        self._coercions = self._conversions(args)
        arguments = self._arguments(args)
        self._fitted(args, by_name)
        self.variant.checked(arguments) if self.variant.engine == "numpy" else self._exact(arguments)
        state.first_run(values, self.variant.engine)
        self.variant.prepare(arguments)
        self._direct = not self._coercions and not self._hidden and not self._array_seeds

    def __call__(self, args: tuple[Any, ...]) -> Any:
        variant = self.variant
        arguments = args if self._direct else self._arguments(args)
        if self._array_seeds:
            self._fit_seeds(args)
        shared = variant.checked(arguments)
        return variant.apart(arguments, shared) if shared else variant.function(*arguments)

    def _found(self, args: tuple[Any, ...]) -> tuple[Variant, list[tuple[str, str]], list[Any]]:
        """The variant whose signature the arguments follow: an argument without influence has no shadow, and which
        these are shows only once the types are known, so the readings of the list are tried, the fullest first."""
        first: Exception | None = None
        seen = None
        for layout in islice(_layouts(self.state, args, self.mode, self.selection), _LAYOUTS):
            try:
                values = [admitted(name, args[k], name in self.state.floats)
                          for k, (role, name) in enumerate(layout) if role == "primal"]
                variant = self._variant(values)
            except S2sadError as error:
                first = first or error
                continue
            seen = seen or variant
            if _layout_of(variant) == [*layout, *[("seed", "")] * (len(args) - len(layout))]:
                return variant, layout, values
        if first is not None and seen is None:
            raise first
        raise self._misread(args, seen)

    def _variant(self, values: list[Any]) -> Variant:
        state, (wrt, of, engine) = self.state, self.selection
        types, name = types_of(values), self.state.kernel.name
        chosen_wrt = selected_wrt(name, state.parameters, types, wrt)
        chosen_of = selected_of(name, state.parameters, types, state.summary(types), of)
        return state.variant(Request(self.mode, types, chosen_wrt, chosen_of), engine)

    def _misread(self, args: tuple[Any, ...], variant: Variant | None) -> S2sadError:
        name = self.state.kernel.name
        signature = (", ".join(p.name for p in variant.parameters if not p.name.startswith(HIDDEN)) if variant else
                     f"{', '.join(self.state.parameters)}, with a shadow after each float array")
        return S2sadError(Diagnostic("S405", f"'{name}.{self.mode}' was given {len(args)} arguments that do not fit "
                                     "its signature", help=f"call {name}.{self.mode}({signature})"))

    def _conversions(self, args: tuple[Any, ...]) -> list[tuple[int, Any]]:
        found = []
        for k, value in enumerate(args):
            role, name = self.layout[k] if k < len(self.layout) else ("seed", RETURN)
            how = coerced(name, value, role != "primal" or name in self.state.floats)
            if how is not None:
                found.append((k, how))
        return found

    def _arguments(self, args: tuple[Any, ...]) -> list[Any]:
        arguments = list(args)
        for k, how in self._coercions:
            arguments[k] = how(arguments[k])
        hidden = self.state.arrays_by_name() if self._hidden else {}
        for k in self._hidden:
            arguments.insert(k, hidden[self.variant.parameters[k].name])
        return arguments

    def _fitted(self, args: tuple[Any, ...], values: dict[str, Any]) -> None:
        names = [p.name for p in self.variant.parameters if not p.name.startswith(HIDDEN)]
        for k, (role, primal) in enumerate(self.layout):
            if role == "shadow":
                shadow(names[k], args[k], primal, values[primal])
        for seed, p in zip(args[len(self.layout):], self.variant.seeds):
            if not p.type.is_array:
                number_seed(seed, p.name)

    def _fit_seeds(self, args: tuple[Any, ...]) -> None:
        arguments = self._arguments(args)
        values = [v for v, p in zip(arguments, self.variant.parameters)
                  if p.role == "primal" and not p.name.startswith(HIDDEN)]
        for seed, place, p in zip(args[len(self.layout):], self._seed_places, self.variant.seeds):
            if p.type.is_array:
                array_seed(p.name, seed, self.state.result_at(place, values, self._types, self.variant.engine))

    def _exact(self, arguments: Sequence[Any]) -> None:
        """The check before Numba has compiled its own."""
        self.variant.check.exact([arguments[k] for k in self.variant.array_places])


def _layout_of(variant: Variant) -> list[tuple[str, str]]:
    return [("seed", "") if p.role == "seed" else (p.role, p.primal or p.name)
            for p in variant.parameters if not p.name.startswith(HIDDEN)]


def _layouts(state: State, args: tuple[Any, ...], mode: str, selection: tuple[Any, Any, str],
             start: int = 0, done: int = 0) -> Iterator[list[tuple[str, str]]]:
    """The ways to read a list of arguments as parameters each followed, or not, by a shadow."""
    names = state.parameters
    if done == len(names):
        yield []
        return
    if len(args) - start < len(names) - done:
        return
    name = names[done]
    if start + 1 < len(args) and _may_have_shadow(name, args[start], mode, selection, name in state.floats):
        for rest in _layouts(state, args, mode, selection, start + 2, done + 1):
            yield [("primal", name), ("shadow", name), *rest]
    for rest in _layouts(state, args, mode, selection, start + 1, done + 1):
        yield [("primal", name), *rest]


def _may_have_shadow(name: str, value: Any, mode: str, selection: tuple[Any, Any, str], is_float: bool) -> bool:
    wrt, of, _ = selection
    if isinstance(value, np.ndarray):
        return value.dtype.name in FLOATS and (wrt is None or of is None or name in wrt or name in of)
    number = isinstance(value, (float, np.floating)) or is_float
    return mode == "tangent" and number and (wrt is None or name in wrt)
