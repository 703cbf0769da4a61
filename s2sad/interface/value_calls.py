"""Calls of derivatives on values: bound, copied where the function may write, with shadows of their own.

One instance serves all later calls with arguments of the same types; what a driver costs beside the compiled call is
spent here.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import kernel_value, bind, coercion, make_zero, misfit
from s2sad.diagnostics import Diagnostic, S2sadError, warn
from s2sad.dispatch.executable import Executable
from s2sad.dispatch.memory_reuse import CallCopies, InThreads
from s2sad.infer.types import NONE, TEXT
from s2sad.program import Recording, Request
from s2sad.run.compiled import chosen
from s2sad.run.memory import Memory
from s2sad.interface.selection import (
    RETURN, Copied, ReturnedValues, Selection, array_seed, number_seed, places, result_seed, selected_of, selected_wrt,
    seeds_by_position, uncopied,
)
from s2sad.dispatch.cache import ProgramVersion, check_contiguous, private_copy

_ONE = {RETURN: 1.0}


def selection_of(f: Any) -> Selection:
    """What a differentiated function carries; a plain one takes the defaults."""
    return getattr(f, "__s2sad_selection__", Selection())


class PreparedCall:
    """Arguments of known types, bound, and copied where the function may write; one instance per compiled call."""
    _mode = ""
    wrt: tuple[str, ...]
    of: tuple[str, ...]

    def __init__(self, state: ProgramVersion, f: Any, args: tuple[Any, ...]):
        self.state, self.names, self.engine = state, state.parameters, selection_of(f).engine
        self.recording = selection_of(f).recording
        bound = bind(state.kernel, args)
        self.tail = [kernel_value(n, v, n in state.floats) for n, v in zip(self.names[len(args):], bound[len(args):])]
        self.coercions = [(k, how) for k, (n, v) in enumerate(zip(self.names, args))
                          if (how := coercion(n, v, n in state.floats)) is not None]
        values = self.values_of(args)
        self.types = state.types(values)
        self.summary = state.summary(self.types)
        self.results = ReturnedValues.of(self.summary)
        self.written = [k for k, n in enumerate(self.names)
                        if n in self.summary.written and isinstance(values[k], np.ndarray)]
        self._changed = self.written
        self._apart = state.overlap_check(self.types)
        if self._apart is not None:
            self._apart(values)
        self._ready: set[int] = set()
        self.kept = InThreads(state.function)
        self._many: dict[int, Executable | None] = {}

    def values_of(self, args: Sequence[Any]) -> list[Any]:
        values = [*args, *self.tail]
        for k, how in self.coercions:
            values[k] = how(values[k])
        return values

    def private_copies(self, args: Sequence[Any], whole: bool = False, copied: Copied | None = None) -> list[Any]:
        """The values, with copies of what the function may write, `copied` so; of all of that for another derivative
        (`whole`)."""
        values = self.values_of(args)
        if self._apart is not None:
            self._apart(values)
        if self.summary.contiguous:
            check_contiguous(self.summary, dict(zip(self.names, values)))
        for k in self._changed if whole else self.written:
            values[k] = private_copy(values[k]) if copied is None else copied(("value", k), values[k])
        return values

    def leave_uncopied(self, variant: Executable) -> None:
        """Does not copy what the function writes and its derivative does not."""
        self.written = [k for k in self.written if self.names[k] not in variant.generated.facts.get("unwritten", ())]

    def call(self, variant: Executable, values: Mapping[str, Any], shadows: Mapping[str, Any],
               seeds: Sequence[Any] = ()) -> tuple[Any, ...]:
        """Calls the derivative; the first time it is compiled."""
        arguments = variant.assemble(values, shadows, seeds, self.state.private_outside_arrays(self.types))
        variant = variant.for_call(arguments, self._copied(variant, arguments, shadows) if variant.limited else 0)
        if id(variant) not in self._ready:
            variant.prepare(arguments)
            self._ready.add(id(variant))
        return variant.run(arguments)

    def primal(self, values: Mapping[str, Any]) -> tuple[Any, ...]:
        """Calls the function itself, which writes these values: what it returns, one by one."""
        variant = self._primal
        arguments = variant.assemble(values, {}, (), self.state.private_outside_arrays(self.types))
        variant.for_call(arguments)
        if id(variant) not in self._ready:
            variant.prepare(arguments)
            self._ready.add(id(variant))
        returned = variant.call(*arguments)
        return returned if len(self.results.types) > 1 else (returned,)

    @cached_property
    def _primal(self) -> Executable:
        return self.state.variant(Request("primal", self.types, (), ()), self.engine)

    def _copied(self, variant: Executable, arguments: Sequence[Any], shadows: Mapping[str, Any]) -> int:
        """The bytes of what a call makes beside the derivative."""
        copies = [a for p, a in zip(variant.parameters, arguments) if p.role == "primal"
                  and p.name in self.summary.written]
        return sum(a.nbytes for a in (*copies, *shadows.values()) if isinstance(a, np.ndarray))

    def variant(self, mode: str, wrt: tuple[str, ...], of: tuple[str, ...], with_primal: bool = False, width: int = 0
                ) -> Executable:
        recording = self.recording if mode == "adjoint" else Recording()
        return self.state.variant(Request(mode, self.types, wrt, of, with_primal=with_primal, recording=recording,
                                          width=width), self.engine)

    def many(self, width: int) -> Executable | None:
        """The derivative for so many directions at once; None where it has to be one at a time."""
        if chosen(self.engine) == "numpy":
            width = 1       # a list of any length
        if width not in self._many:
            self._many[width] = self._for_many(width)
        return self._many[width]

    def _for_many(self, width: int) -> Executable | None:
        if self.recording.limit:
            return None
        try:
            return self.variant(self._mode, self.wrt, self.of, width=width)
        except S2sadError as refused:
            if refused.diagnostics[0].code != "S411":
                raise
            return None


class ReverseCall(PreparedCall):
    """A prepared `vjp` or `gradient`."""
    _mode = "adjoint"

    def __init__(self, state: ProgramVersion, f: Any, args: tuple[Any, ...], outputs: tuple[str, ...],
                 wrt: tuple[str, ...] | None, with_value: bool = False):
        super().__init__(state, f, args)
        name = state.kernel.name
        selected = wrt if wrt is not None else selection_of(f)[0]
        kinds = dict(zip(self.names, self.types))
        if selected is None and with_value:
            wrt = tuple(n for n in state.kernel.independents if kinds[n].is_inexact) or None
        self.wrt = selected_wrt(name, self.names, self.types, wrt if selected is None else selected)
        self.is_single = len(self.wrt) == 1 and (
            selected is not None or sum(kinds[n] not in (NONE, TEXT) for n in state.kernel.independents) <= 1)
        if with_value and (len(self.results.types) != 1 or not self.results.types[0].is_float
                           or self.results.types[0].is_array):
            raise _no_float(name, self.results)
        if not outputs:
            raise misfit(f"no seed was given for '{name}'", "give a dict by output name, as {\"return\": 1.0}")
        self.of = selected_of(name, self.names, self.types, self.summary, outputs)
        self.warns = selected is not None
        self.rv = self.variant("adjoint", self.wrt, self.of, with_value)
        if not self.rv.limited:         # else a call chooses among several
            self.leave_uncopied(self.rv)
        self.seed_places = places([p.primal for p in self.rv.seeds])

    def warn_of_zeros(self, derivative: Executable) -> None:
        """Warns of gradients that were named and are zero."""
        for name in derivative.generated.facts.get("independent", ()):
            if self.warns and name in self.wrt:
                warn(f"no output asked for of '{self.state.kernel.name}' depends on '{name}': its gradient is zero")

    def run(self, args: Sequence[Any], seeds: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
        copies = CallCopies(self.kept)
        values, shadows, result_seeds = self.bind_values(args, seeds, copies.of)
        returned = self.call(self.rv, values, shadows, result_seeds)
        copies.end()
        return shadows, returned

    def bind_values(self, args: Sequence[Any], seeds: Mapping[str, Any], copied: Copied | None = None
                    ) -> tuple[dict[str, Any], dict[str, Any], list[Any]]:
        """The values and the shadows by name, and the seeds of results; `copied` has the copies of what the caller does
        not see."""
        values = dict(zip(self.names, self.private_copies(args, copied=copied)))
        by_place = self._result_seeds(seeds.get(RETURN)) if RETURN in seeds else {}
        shadows = {}
        for name in self.rv.shadows:
            seed = None if name not in self.of else seeds.get(name)
            shadows[name] = (np.zeros(values[name].shape, values[name].dtype) if seed is None
                             else array_seed(name, seed, values[name], None if name in self.wrt else copied))
        for place, name in self.results.aliases.items():
            if place in by_place:
                shadows[name] += array_seed(RETURN, by_place.pop(place), values[name])
        return values, shadows, [by_place.get(k, 0.0) for k in self.seed_places]

    def memory(self, args: Sequence[Any]) -> Memory:
        """What a call takes, with the copies and the shadows that it makes."""
        values = self.values_of(args)
        by_name = {**dict(zip(self.names, values)), **self.state.arrays_by_name()}
        copied = [*(self.names[k] for k in self.written), *self.rv.shadows,
                  *(n for n in self.summary.written if n not in self.names)]
        return self.rv.memory(by_name, sum(by_name[n].nbytes for n in copied))

    def gradients(self, shadows: dict[str, Any], returned: tuple[Any, ...]) -> dict[str, Any]:
        self.warn_of_zeros(self.rv)
        return self.by_argument(shadows, returned)

    def by_argument(self, shadows: dict[str, Any], returned: tuple[Any, ...]) -> dict[str, Any]:
        """The gradients, those of arrays in their shadows, those of numbers among what is returned."""
        scalars = dict(zip(self.rv.generated.returns, returned))
        return {name: shadows[name] if name in shadows else scalars[name] for name in self.wrt}

    def vjp(self, args: Sequence[Any], seeds: Mapping[str, Any]) -> dict[str, Any]:
        shadows, returned = self.run(args, seeds)
        return self.gradients(shadows, returned)

    def value_and_gradient(self, args: Sequence[Any]) -> tuple[Any, Any]:
        shadows, returned = self.run(args, _ONE)
        found = self.gradients(shadows, returned)
        return returned[0], found[self.wrt[0]] if self.is_single else found

    def zeros(self, args: Sequence[Any]) -> Any:
        """Gradients of zeros, of the make of a call's."""
        values = dict(zip(self.names, self.values_of(args)))
        found = {n: make_zero(values[n]) for n in self.wrt}
        return found[self.wrt[0]] if self.is_single else found

    def _result_seeds(self, seed: Any) -> dict[int, Any]:
        """The seeds of the results, by position."""
        seeds = seeds_by_position(self.results, seed, self.results.floats)
        for place in self.results.own:
            seeds[place] = result_seed(seeds[place], self.results.types[place])
        return seeds


class ForwardCall(PreparedCall):
    """A prepared `jvp`."""
    _mode = "tangent"

    def __init__(self, state: ProgramVersion, f: Any, args: tuple[Any, ...], inputs: tuple[str, ...],
                 of: tuple[str, ...] | None):
        super().__init__(state, f, args)
        name = state.kernel.name
        self.wrt = selected_wrt(name, self.names, self.types, inputs)
        self.of = selected_of(name, self.names, self.types, self.summary, of if of is not None else selection_of(f)[1])
        self.requested = of if of is not None else (*(n for n in self.of if n != RETURN),
                                                *((RETURN,) if self.results.floats else ()))
        self.fv = self.variant("tangent", self.wrt, self.of)
        self._given = {*self.requested, *self.results.aliases.values()}
        self._keeps = not any(t.is_array for t in self.results.types)   # else a result may be a part of a tangent

    def bind_values(self, args: Sequence[Any], tangents: Mapping[str, Any], copied: Copied | None = None
                    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """The values and the tangents by name; `copied` has the copies of what the caller does not see."""
        values = dict(zip(self.names, self.private_copies(args, copied=copied)))
        shadows = {}
        for name in self.fv.shadows:
            value, tangent = values[name], tangents.get(name)
            if isinstance(value, np.ndarray):
                shadows[name] = (np.zeros(value.shape, value.dtype) if tangent is None
                                 else array_seed(name, tangent, value, self._copied_tangent(name, copied)))
            else:
                shadows[name] = number_seed(tangent, name, isinstance(value, complex))
        return values, shadows

    def _copied_tangent(self, name: str, copied: Copied | None) -> Copied | None:
        """How the tangent of an argument is copied: not at all where neither it nor its argument is written."""
        if copied is not None and name not in self.summary.written:
            return uncopied
        return None if name in self._given else copied

    def jvp(self, args: Sequence[Any], tangents: Mapping[str, Any]) -> dict[str, Any]:
        copies = CallCopies(self.kept)
        values, shadows = self.bind_values(args, tangents, copies.of if self._keeps else None)
        returned = self.call(self.fv, values, shadows)
        copies.end()
        return self.outputs(shadows, returned)

    def outputs(self, shadows: Mapping[str, Any], returned: Sequence[Any], names: Sequence[str] | None = None
                ) -> dict[str, Any]:
        """The tangents of the outputs by name, after a call that returns these names."""
        found: dict[int, Any] = dict(zip(places(self.fv.generated.returns if names is None else names), returned))
        for place, name in self.results.aliases.items():
            found[place] = shadows[name]
        outputs = {name: shadows[name] for name in self.requested if name != RETURN}
        if RETURN in self.requested:
            outputs[RETURN] = self.results.structure(found)
        return outputs


def _no_float(name: str, results: ReturnedValues) -> S2sadError:
    described = ", ".join(map(str, results.types)) or "nothing"
    return S2sadError(Diagnostic("S401", f"a gradient needs a function that returns one float; '{name}' returns "
                                 f"{described}", help="use s2sad.vjp, which takes a seed for each output"))
