"""Calls with shadows that the caller owns: `f.adjoint(...)` and `f.tangent(...)`.

One instance serves all later calls with arguments of the same types. Nothing is written before everything fits.
"""
from __future__ import annotations

from typing import Any

from s2sad.dispatch.arguments import coercion, shadow, check_writable
from s2sad.dispatch.executable import HIDDEN
from s2sad.run.exceptions import CAUGHT
from s2sad.interface.selection import RETURN, Selection, result_seed
from s2sad.interface.shadow_signature import match_arguments
from s2sad.dispatch.cache import ProgramVersion


class ShadowCall:
    """A prepared `f.adjoint(...)` or `f.tangent(...)`: the positions of its arguments are known."""

    def __init__(self, state: ProgramVersion, mode: str, args: tuple[Any, ...], selection: Selection,
                 bare: bool = False):
        self.state = state
        self.variant, self.layout, values = match_arguments(state, mode, args, selection)
        by_name = dict(zip(state.parameters, values))
        self.types = state.types(values)
        written = state.summary(self.types).written
        for name, value in by_name.items():
            if name in written:
                check_writable(name, value)
        self._hidden = [k for k, p in enumerate(self.variant.parameters) if p.name.startswith(HIDDEN)]
        self._hidden_written = any(self.variant.parameters[k].name in written for k in self._hidden)
        self._fitted(args, by_name)
        self._coercions = self._conversions(args)
        arguments = self._arguments(args)
        self.variant.shared_arrays(arguments)
        runs = self.variant.for_call(arguments, bare=bare)
        runs.prepare(arguments)
        self._direct = not self._coercions and not self._hidden
        self._bare = self.variant.engine == "numba" and not any(p.type.is_array for p in self.variant.seeds)

    def __call__(self, args: tuple[Any, ...]) -> Any:
        variant = self.variant
        arguments = args if self._direct else self._arguments(args)
        shared = variant.shared_arrays(arguments)
        runs = variant.for_call(arguments)
        if self._hidden_written:
            assert isinstance(arguments, list)  # hidden arguments are never direct
            outside = self.state.private_outside_arrays(self.types)
            for k in self._hidden:
                arguments[k] = outside[variant.parameters[k].name]
        try:
            if shared:
                return runs.call_with_private_shadows(arguments, shared)
            if self._bare:
                return runs.function(*arguments)
            return runs.run(arguments) or None      # a number may be one of NumPy's, the seed of an array may not fit
        except CAUGHT as error:
            raise runs.meaning(error, arguments) from None

    def function(self, args: tuple[Any, ...]) -> Any:
        """The bare function that runs a call with these arguments."""
        return self.variant.for_call(self._arguments(args), bare=True).function

    def _conversions(self, args: tuple[Any, ...]) -> list[tuple[int, Any]]:
        found = []
        for k, value in enumerate(args):
            role, name = self.layout[k] if k < len(self.layout) else ("seed", RETURN)
            how = coercion(name, value, role != "primal" or name in self.state.floats)
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
            result_seed(seed, p.type)
