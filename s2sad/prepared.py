"""Calls of derivatives on values: bound, copied where the function may write, with shadows of their own.

One instance serves all later calls with arguments of the same types; what a driver costs beside the compiled call is
spent here.
"""
from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.binding import admitted, bind, coerced, make_zero, misfit, types as types_of
from s2sad.diagnostics import Diagnostic, S2sadError, S2sadWarning
from s2sad.program import Request
from s2sad.run.overlap import Check, Slot
from s2sad.selection import RETURN, Results, array_seed, number_seed, selected_of, selected_wrt, structured
from s2sad.variants import State, Variant

_ONE = {RETURN: 1.0}


def selection_of(f: Any) -> tuple[tuple[str, ...] | None, tuple[str, ...] | None, str]:
    """The wrt, of and engine that a differentiated function carries; a plain one takes the defaults."""
    return getattr(f, "__s2sad_selection__", (None, None, "auto"))


class PreparedCall:
    """Arguments of known types, bound, and copied where the function may write; one instance per compiled call."""

    def __init__(self, state: State, f: Any, args: tuple[Any, ...]):
        self.state, self.names, self.engine = state, state.parameters, selection_of(f)[2]
        bound = bind(state.kernel, args)
        self.tail = [admitted(n, v, n in state.floats) for n, v in zip(self.names[len(args):], bound[len(args):])]
        self.coercions = [(k, how) for k, (n, v) in enumerate(zip(self.names, args))
                          if (how := coerced(n, v, n in state.floats)) is not None]
        values = self.values_of(args)
        self.types = types_of(values)
        self.summary = state.summary(self.types)
        self.results = Results.of(self.summary)
        arrays = [k for k, v in enumerate(values) if isinstance(v, np.ndarray)]
        self.written = [k for k in arrays if self.names[k] in self.summary.written]
        self.arrays = arrays
        slots = [Slot(self.names[k], "primal", self.names[k], k in self.written) for k in arrays]
        self.apart = Check(slots, "numpy") if self.written and len(arrays) > 1 else None
        if self.apart is not None:
            self.apart.exact([values[k] for k in arrays])
        state.first_run(values, self.engine)

    def values_of(self, args: Sequence[Any]) -> list[Any]:
        values = [*args, *self.tail]
        for k, how in self.coercions:
            values[k] = how(values[k])
        return values

    def private(self, args: Sequence[Any]) -> list[Any]:
        """The values, with copies of what the function may write."""
        values = self.values_of(args)
        if self.apart is not None:
            self.apart.exact([values[k] for k in self.arrays])
        for k in self.written:
            values[k] = np.array(values[k], order="C")
        return values

    def variant(self, mode: str, wrt: tuple[str, ...], of: tuple[str, ...], with_primal: bool = False) -> Variant:
        return self.state.variant(Request(mode, self.types, wrt, of, with_primal=with_primal), self.engine)


class ReverseCall(PreparedCall):
    """A prepared `vjp` or `gradient`."""

    def __init__(self, state: State, f: Any, args: tuple[Any, ...], outputs: tuple[str, ...],
                 wrt: tuple[str, ...] | None, with_value: bool = False):
        super().__init__(state, f, args)
        name = state.kernel.name
        self.wrt = selected_wrt(name, self.names, self.types, wrt if wrt is not None else selection_of(f)[0])
        if with_value and (len(self.results.types) != 1 or not self.results.types[0].is_float
                           or self.results.types[0].is_array):
            raise _no_float(name, self.results)
        if not outputs:
            raise misfit(f"no seed was given for '{name}'", "give a dict by output name, as {\"return\": 1.0}")
        self.of = selected_of(name, self.names, self.types, self.summary, outputs)
        self.rv = self.variant("adjoint", self.wrt, self.of, with_value)
        if with_value and self.rv.generated.returns[:1] != ("result",):
            raise S2sadError(Diagnostic("S901", f"internal error: the derivative of '{name}' lacks the value"))
        self.seed_places = self.results.places([p.name for p in self.rv.seeds])
        self.first_call = True

    def run(self, args: Sequence[Any], seeds: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
        values = dict(zip(self.names, self.private(args)))
        by_place = self._result_seeds(args, seeds.get(RETURN)) if RETURN in seeds else {}
        shadows = {}
        for name in self.rv.shadows:
            seed = None if name not in self.of else seeds.get(name)
            shadows[name] = (np.zeros(values[name].shape, values[name].dtype) if seed is None
                             else array_seed(name, seed, values[name]))
        for place, name in self.results.aliases.items():
            if place in by_place:
                shadows[name] += array_seed(RETURN, by_place.pop(place), values[name])
        given = [by_place.get(k, 0.0) for k in self.seed_places]
        arguments = self.rv.assemble(values, shadows, given, self.state.arrays_by_name())
        if self.first_call:
            self.rv.prepare(arguments)
            self.first_call = False
        return shadows, self.rv.run(arguments)

    def gradients(self, shadows: dict[str, Any], returned: tuple[Any, ...], args: Sequence[Any]) -> dict[str, Any]:
        scalars = dict(zip(self.rv.generated.returns, returned))
        found, values = {}, None
        for name in self.wrt:
            if name in shadows:
                found[name] = shadows[name]
            elif name in scalars:
                found[name] = scalars[name]
            else:
                values = values or dict(zip(self.names, self.values_of(args)))
                found[name] = make_zero(values[name])
        for name in self.wrt:
            if name in self.rv.generated.facts.get("independent", ()) or name not in shadows and name not in scalars:
                warnings.warn(f"no output asked for of '{self.state.kernel.name}' depends on '{name}': its gradient "
                              "is zero", S2sadWarning, stacklevel=4)
        return found

    def vjp(self, args: Sequence[Any], seeds: Mapping[str, Any]) -> dict[str, Any]:
        shadows, returned = self.run(args, seeds)
        return self.gradients(shadows, returned, args)

    def value_and_gradient(self, args: Sequence[Any]) -> tuple[Any, Any]:
        shadows, returned = self.run(args, _ONE)
        found = self.gradients(shadows, returned, args)
        return returned[0], found[self.wrt[0]] if len(self.wrt) == 1 else found

    def _result_seeds(self, args: Sequence[Any], seed: Any) -> dict[int, Any]:
        """The seeds of the results, by position."""
        given = structured(self.results, seed)
        for place in self.results.own:
            if self.results.types[place].is_array:
                of = self.state.result_at(place, self.values_of(args), self.types, self.engine)
                given[place] = array_seed(RETURN, given[place], of)
            else:
                given[place] = number_seed(given[place])
        return given


class ForwardCall(PreparedCall):
    """A prepared `jvp`."""

    def __init__(self, state: State, f: Any, args: tuple[Any, ...], inputs: tuple[str, ...],
                 of: tuple[str, ...] | None):
        super().__init__(state, f, args)
        name = state.kernel.name
        self.wrt = selected_wrt(name, self.names, self.types, inputs)
        self.of = selected_of(name, self.names, self.types, self.summary, of if of is not None else selection_of(f)[1])
        self.asked = of if of is not None else (*(n for n in self.of if n != RETURN),
                                                *((RETURN,) if self.results.floats else ()))
        self.fv = self.variant("tangent", self.wrt, self.of)
        self.first_call = True

    def jvp(self, args: Sequence[Any], tangents: Mapping[str, Any]) -> dict[str, Any]:
        values = dict(zip(self.names, self.private(args)))
        shadows = {}
        for name in self.fv.shadows:
            value, given = values[name], tangents.get(name)
            if isinstance(value, np.ndarray):
                shadows[name] = np.zeros(value.shape, value.dtype) if given is None else array_seed(name, given, value)
            else:
                shadows[name] = number_seed(given, name)
        for name in self.wrt:
            if name not in shadows:  # without effect on the outputs asked for, but it must fit all the same
                _tangent(name, tangents[name], values[name])
        arguments = self.fv.assemble(values, shadows, (), self.state.arrays_by_name())
        if self.first_call:
            self.fv.prepare(arguments)
            self.first_call = False
        returned = self.fv.run(arguments)
        names = self.fv.generated.returns
        found = dict(zip(self.results.places(names), returned))
        for place, name in self.results.aliases.items():
            found[place] = shadows[name]
        outputs = {name: shadows[name] for name in self.asked if name != RETURN}
        if RETURN in self.asked:
            outputs[RETURN] = self.results.structure(found)
        return outputs


def _tangent(name: str, given: Any, value: Any) -> Any:
    return array_seed(name, given, value) if isinstance(value, np.ndarray) else number_seed(given, name)


def _no_float(name: str, results: Results) -> S2sadError:
    described = ", ".join(map(str, results.types)) or "nothing"
    return S2sadError(Diagnostic("S401", f"a gradient needs a function that returns one float; '{name}' returns "
                                 f"{described}", help="use s2sad.vjp, which takes a seed for each output"))
