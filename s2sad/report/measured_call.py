"""A call of a function with its inputs and outputs: what `check` and `bench` measure."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import kernel_value, bind
from s2sad.diagnostics import S2sadError
from s2sad.interface.pytrees import Carrier, flatten, flat_call
from s2sad.infer.types import Type
from s2sad.interface.value_calls import ForwardCall, ReverseCall
from s2sad.program import Recording, Request
from s2sad.run.compiled import chosen
from s2sad.run.tracebacks import with_facts
from s2sad.interface.selection import ReturnedValues, Selection, Wrt, names_of, selected_of, selected_wrt
from s2sad.live_objects.unwrap import by_position, apply_functions
from s2sad.dispatch.cache import DerivativeCache, ProgramVersion, derivatives_of


@dataclass(frozen=True)
class MeasuredCall:
    """A function's `values` by parameter, flat where they were structures, and `original`, which takes them by
    position; the selected inputs and outputs, and the loops that keep snapshots. `single`: among the values are arrays
    of float32; `structured`: the values were structures."""
    original: Callable[..., Any]
    state: ProgramVersion
    values: dict[str, Any]
    types: tuple[Type, ...]
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    engine: str
    recording: Recording
    is_single_precision: bool
    structured: bool

    @classmethod
    def for_call(cls, f: Callable[..., Any], args: tuple[Any, ...], wrt: Wrt, of: str | Iterable[str] | None,
                 engine: str | None) -> MeasuredCall:
        """The call of f at args, in a cache of its own; raises S2sadError."""
        function, args, _ = apply_functions(f, args, {})
        unflattened = DerivativeCache(derivatives_of(function).function).state()
        return with_facts(cls._of_state, f, function, unflattened, args, wrt, of, engine)

    @classmethod
    def _of_state(cls, f: Callable[..., Any], function: Any, unflattened: ProgramVersion, args: tuple[Any, ...],
                  wrt: Wrt, of: str | Iterable[str] | None, engine: str | None) -> MeasuredCall:
        flattened = flatten(unflattened, args)
        carrier = Carrier.with_overrides(f, names_of(wrt, f), names_of(of, f, "of"), engine)
        state, flat, carried = flat_call(unflattened, carrier, args)
        values = [kernel_value(n, v, n in state.floats) for n, v in zip(state.parameters, flat)]
        types, name = state.types(values), state.kernel.name
        single = any(getattr(v, "dtype", None) == np.float32 for v in values)
        original = by_position(state.function if single else getattr(function, "_original", function))
        if flattened is not None:
            original = flattened.flat_function(original, bind(unflattened.kernel, args))
        inputs = selected_wrt(name, state.parameters, types, carried.wrt)
        outputs = selected_of(name, state.parameters, types, state.summary(types), carried.of)
        return cls(original, state, dict(zip(state.parameters, values)), types, inputs, outputs, chosen(carried.engine),
                   carried.recording, single, flattened is not None)

    @property
    def arguments(self) -> tuple[Any, ...]:
        return tuple(self.values.values())

    @property
    def title(self) -> str:
        return f"{self.state.kernel.name}: d({', '.join(self.of)}) / d({', '.join(self.wrt)}), engine {self.engine}"

    def forward(self) -> ForwardCall:
        """The tangent, prepared."""
        return ForwardCall(self.state, self._carrier, self.arguments, self.wrt, self.of)

    def reverse(self) -> ReverseCall:
        """The adjoint, prepared; without a warning for inputs on which no output depends."""
        made = ReverseCall(self.state, self._carrier, self.arguments, self.of, None)
        made.warns = False
        return made

    def has_tangent(self) -> bool:
        """Whether the kernel has a tangent: every function with an adjoint of its own that it needs has one too."""
        owns = [k.own for k in self.state.program.kernels.values() if k.own is not None]
        if all("tangent" in o.functions or o.residual is not None for o in owns):
            return True
        try:
            self.forward()
        except S2sadError as error:
            if any(d.code != "S301" for d in error.diagnostics):
                raise
            return False
        return True

    @property
    def _carrier(self) -> Carrier:
        return Carrier(Selection(self.wrt, self.of, self.engine, self.recording))

    def primal(self, values: Mapping[str, Any]) -> Callable[..., Any]:
        """The function of values like these, by position: as it is under NumPy, compiled for their types under Numba.
        It writes its arguments in place."""
        if self.engine == "numpy":
            return self.original
        types = self.state.types(list(values.values()))
        function, results = self.state.primal(types, self.engine), ReturnedValues.of(self.state.summary(types))
        return lambda *values: results.with_aliases(function(*values), dict(zip(self.values, values)))

    def bare(self, values: Mapping[str, Any]) -> Callable[[], Any]:
        """One bare run of the function on values, in place."""
        if self.engine == "numpy":
            return partial(self.original, *values.values())
        types = self.state.types(list(values.values()))
        variant = self.state.variant(Request("primal", types, (), ()), self.engine)
        return partial(variant.function, *variant.assemble(values, {}, (), self.state.private_outside_arrays(types)))
