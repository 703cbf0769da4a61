"""A kernel with its derivatives as functions of values: what is written comes back, and nothing that is given changes.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from s2sad.dispatch.cache import ProgramVersion, check_contiguous, private_copy
from s2sad.dispatch.executable import Executable
from s2sad.infer.types import Type
from s2sad.interface.selection import RETURN, number_seed, result_seed, selected_of, selected_wrt
from s2sad.interface.value_calls import ForwardCall, PreparedCall, ReverseCall, selection_of
from s2sad.program import Request


@dataclass(frozen=True)
class Output:
    """An array or a number that comes back: a written argument by its name, or the result at a `place`."""
    name: str
    type: Type
    place: int = -1


class BridgedKernel:
    """A kernel for arguments of these types. `outputs` are those of `of`, in order; `wrt` may have a derivative."""

    def __init__(self, state: ProgramVersion, f: Any, values: Sequence[Any], wrt: tuple[str, ...] | None,
                 of: tuple[str, ...] | None):
        self.state, self.f = state, f
        self.prepared = PreparedCall(state, f, tuple(values))
        self.name, self.names, self.types = state.kernel.name, state.parameters, self.prepared.types
        summary, carried = self.prepared.summary, selection_of(f)
        wrt = wrt if wrt is not None else carried.wrt
        inexact = tuple(n for n, t in zip(self.names, self.types) if t.is_inexact)
        self.wrt = inexact if wrt is None else selected_wrt(self.name, self.names, self.types, wrt)
        self.of = selected_of(self.name, self.names, self.types, summary, of if of is not None else carried.of)
        kinds, results = dict(zip(self.names, self.types)), self.prepared.results
        self.outputs = tuple([
            o for name in self.of for o in ([Output(RETURN, results.types[k], k) for k in results.own]
                                            if name == RETURN else [Output(name, kinds[name])])])
        self._adjoints: dict[Any, tuple[ReverseCall, dict[str, int], list[tuple[int, Type]]]] = {}
        self._tangents: dict[tuple[str, ...], ForwardCall] = {}

    def request(self, mode: str, wrt: tuple[str, ...] = (), of: tuple[str, ...] = ()) -> Executable:
        """The derivative, or the primal."""
        if mode != "primal":
            return self.prepared.variant(mode, wrt, of)
        return self.state.variant(Request("primal", self.types, (), ()), self.prepared.engine)

    def structure(self, items: Sequence[Any]) -> Any:
        """What a user gets of the outputs, or of their tangents: one by itself, several by name, results as the kernel
        returns them, with None for what is no float or goes by the name of an argument."""
        found: dict[str, Any] = {}
        by_place = {o.place: item for o, item in zip(self.outputs, items) if o.name == RETURN}
        count = len(self.prepared.results.types)
        for output, item in zip(self.outputs, items):
            found[output.name] = item
        if by_place and count > 1:
            found[RETURN] = tuple(by_place.get(k) for k in range(count))
        return found[self.of[0]] if len(self.of) == 1 else found

    def primal(self, values: Sequence[Any]) -> list[Any]:
        """The outputs."""
        copies = self._own(self.prepared, values)
        parts = self.prepared.primal(copies)
        return [parts[o.place] if o.name == RETURN else copies[o.name] for o in self.outputs]

    def vjp(self, values: Sequence[Any], seeds: Sequence[Any], wrt: tuple[str, ...], of: tuple[str, ...]) -> list[Any]:
        """The adjoints of `wrt` for seeds of those outputs that are in `of`, in order."""
        call, places, results = self._adjoint(values, wrt, of)
        copies = self._own(call, values)
        shadows = {n: np.array(seeds[places[n]]) if n in places else np.zeros(copies[n].shape, copies[n].dtype)
                   for n in call.rv.shadows}
        returned = call.call(call.rv, copies, shadows, [result_seed(seeds[k], kind) for k, kind in results])
        found = call.by_argument(shadows, returned)
        return [found[n] for n in wrt]

    def _adjoint(self, values: Sequence[Any], wrt: tuple[str, ...], of: tuple[str, ...]
                 ) -> tuple[ReverseCall, dict[str, int], list[tuple[int, Type]]]:
        """The call; the places of seeds, of arguments by their names, of results in the order of the call with their
        types."""
        key = wrt, of
        if key not in self._adjoints:
            call = ReverseCall(self.state, self.f, tuple(values), of, wrt)
            outputs = [o for o in self.outputs if o.name in of]
            own = {o.place: (k, o.type) for k, o in enumerate(outputs) if o.name == RETURN}
            self._adjoints[key] = (call, {o.name: k for k, o in enumerate(outputs) if o.name != RETURN},
                                   [own[place] for place in call.seed_places])
        return self._adjoints[key]

    def jvp(self, values: Sequence[Any], tangents: Mapping[str, Any]) -> list[Any]:
        """The tangents of the outputs."""
        given = tuple(tangents)
        call = self._tangents.get(given)
        if call is None:
            call = self._tangents[given] = ForwardCall(self.state, self.f, tuple(values), given, self.of)
        copies = self._own(call, values)
        shadows = {n: self._tangent(copies[n], tangents.get(n)) for n in call.fv.shadows}
        returned = dict(zip(call.fv.generated.returns, call.call(call.fv, copies, shadows)))
        return [returned.get(f"{RETURN} {o.place}", 0.0) if o.name == RETURN else shadows[o.name] for o in self.outputs]

    def _own(self, call: PreparedCall, values: Sequence[Any]) -> dict[str, Any]:
        """The values by name, with copies of what the kernel writes: one array may be given twice."""
        found = call.values_of(values)
        for k in call.written:
            found[k] = private_copy(found[k])
        by_name = dict(zip(self.names, found))
        check_contiguous(call.summary, by_name)
        return by_name

    @staticmethod
    def _tangent(value: Any, tangent: Any) -> Any:
        if isinstance(value, np.ndarray):
            return np.zeros_like(value) if tangent is None else private_copy(tangent)
        return number_seed(tangent, is_complex=isinstance(value, complex))
