"""Gradients by other ways than the adjoint, to compare: one run for each number that the gradient is with respect to.

    tangent     directions through the derivative forwards
    finite      extrapolated central differences of SciPy's (`scipy.differentiate`), which estimate their error
    complex     the imaginary part of f at x + ih, for a step of 1e-20: exact to rounding where f is analytic (Squire
                and Trapp, Using complex variables to estimate derivatives of real functions, SIAM Review 40, 1998)

f is compiled for complex numbers as any other function is, so that what has no meaning for them (a comparison, a store
into an array of floats) is refused at its place. abs, conj and real have one, and are not analytic: the derivative of f
in the imaginary direction is compared with the one in the real direction (Cauchy and Riemann).
"""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.cache import ProgramVersion
from s2sad.extras import needed
from s2sad.interface import batch_calls
from s2sad.interface.selection import RETURN
from s2sad.interface.value_calls import ForwardCall, ReverseCall
from s2sad.run.memory import Memory

Backend = Literal["adjoint", "tangent", "finite", "complex"]
_AT_ONCE = 16       # directions of the tangent
_STEP = 1e-20       # of the complex step
_FIRST = 0.05       # the first step of differences, as a fraction of what is changed
_SURE = 1e-6        # the error that differences may have, as a fraction of the greatest of them
_ANALYTIC = 1e-10


class ComparedCall(ReverseCall):
    """A prepared `gradient` of which the value and the gradients come another way."""

    def __init__(self, state: ProgramVersion, f: Any, args: tuple[Any, ...], outputs: tuple[str, ...],
                 wrt: tuple[str, ...] | None, with_value: bool = False):
        super().__init__(state, f, args, outputs, wrt, with_value)
        self.title = state.kernel.name
        self._f, self._example = f, tuple(args)
        kinds = dict(zip(self.names, self.types))
        self._complex = next((n for n in self.names if kinds[n].is_complex), None)

    def run(self, args: Sequence[Any], seeds: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
        values = dict(zip(self.names, self.private_copies(args, whole=True)))
        if self._complex is not None:
            raise S2sadError(Diagnostic("S401", f"'{self._complex}' of '{self.title}' is complex, and only the adjoint "
                                        "has a gradient for it", help='backend="adjoint"'))
        value = self._primal(self._copied(values))
        sizes = [np.size(values[n]) for n in self.wrt]
        found = np.split(self.slopes(values), np.cumsum(sizes)[:-1]) if sizes else []
        shaped = {n: self._like(values[n], part) for n, part in zip(self.wrt, found)}
        return shaped, (value,)

    def slopes(self, values: Mapping[str, Any]) -> np.ndarray:
        """The derivatives with respect to all numbers of `wrt`, one after the other."""
        raise NotImplementedError

    def memory(self, args: Sequence[Any]) -> Memory:
        raise S2sadError(Diagnostic("S405", f"what a call takes is said of the adjoint of '{self.title}'",
                                    help='backend="adjoint"'))

    @cached_property
    def _primal(self) -> Callable[[Mapping[str, Any]], Any]:
        """f's float, of values by name, which f may write."""
        return _function_of(self.state, self.types, self.engine)

    def _like(self, value: Any, part: np.ndarray) -> Any:
        return part.reshape(value.shape).astype(value.dtype) if isinstance(value, np.ndarray) else float(part[0])

    def _copied(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Copies of all arrays, which f may write."""
        return {n: np.array(v, order="C") if isinstance(v, np.ndarray) else v for n, v in values.items()}

    def places(self, values: Mapping[str, Any]) -> list[tuple[str, int]]:
        """The name and the place of each number."""
        return [(n, k) for n in self.wrt for k in range(np.size(values[n]))]


def _function_of(state: ProgramVersion, types: Any, engine: str) -> Callable[[Mapping[str, Any]], Any]:
    function = state.primal(tuple(types), engine)

    def called(values: Mapping[str, Any]) -> Any:
        ordered = [values[n] for n in state.parameters]
        state.check_bounds(ordered, engine)
        return function(*ordered)
    return called


class ByTangents(ComparedCall):
    """Unit directions through the tangent, some at once."""

    @cached_property
    def _forward(self) -> ForwardCall:
        return ForwardCall(self.state, self._f, self._example, self.wrt, (RETURN,))

    def slopes(self, values: Mapping[str, Any]) -> np.ndarray:
        places, found = self.places(values), [np.zeros(0)]
        args = tuple(values[n] for n in self.names)
        for first in range(0, len(places), _AT_ONCE):
            some = places[first:first + _AT_ONCE]
            units = {n: np.zeros((len(some), *np.shape(values[n])), getattr(values[n], "dtype", float))
                     for n in self.wrt}
            for k, (name, place) in enumerate(some):
                units[name].reshape(len(some), -1)[k, place] = 1.0
            found.append(batch_calls.jvp(self._forward, args, units)[RETURN])
        return np.concatenate(found)


class ByDifferences(ComparedCall):
    """SciPy's extrapolated differences."""

    def slopes(self, values: Mapping[str, Any]) -> np.ndarray:
        differentiate = needed("scipy.differentiate", 'backend="finite"', 'take backend="tangent"')
        places = self.places(values)
        x = np.concatenate([np.zeros(0), *(np.ravel(values[n]).astype(float) for n in self.wrt)])
        if not len(x):
            return x

        def along(changed: np.ndarray, index: np.ndarray) -> np.ndarray:
            pairs = np.broadcast(changed, index)
            return np.array([self._at(values, places[k], float(c)) for c, k in pairs]).reshape(pairs.shape)
        scale = float(np.abs(x[np.isfinite(x)]).max(initial=0.0)) or 1.0
        with np.errstate(all="ignore"):
            made = differentiate.derivative(along, x, args=(np.arange(len(x)),), initial_step=_FIRST * np.where(
                x == 0.0, scale, np.abs(x)))
        sure = made.success | (made.error <= _SURE * np.abs(made.df[np.isfinite(made.df)]).max(initial=0.0))
        if not np.all(sure):
            name, place = places[int(np.argmin(sure))]
            raise S2sadError(Diagnostic(
                "S405", f"differences of '{self.title}' say nothing sure of '{name}' at element {place}: "
                f"{made.df[~sure][0]:.3g} with an error of {made.error[~sure][0]:.1g}",
                help='a kink or a jump is near, or values cancel: take backend="tangent"'))
        return made.df

    def _at(self, values: Mapping[str, Any], place: tuple[str, int], changed: float) -> float:
        given = self._copied({n: v.astype(float) if getattr(v, "dtype", None) == np.float32 else v
                              for n, v in values.items()})
        _put(given, place, changed)
        return float(self._in_double(given))

    @cached_property
    def _in_double(self) -> Callable[[Mapping[str, Any]], Any]:
        """f in double precision, where differences of floats of single precision would be rounded."""
        types = [replace(t, dtype="float64") if t.dtype == "float32" else t for t in self.types]
        return self._primal if types == [*self.types] else _function_of(self.state, types, self.engine)


def _put(values: dict[str, Any], place: tuple[str, int], changed: Any) -> None:
    name, k = place
    if isinstance(values[name], np.ndarray):
        values[name].reshape(-1)[k] = changed
    else:
        values[name] = changed


class ByComplexStep(ComparedCall):
    """The imaginary part of f beside the real line."""

    def slopes(self, values: Mapping[str, Any]) -> np.ndarray:
        widened = {n: _widened(v) if n in self.wrt or n in self.summary.written else v for n, v in values.items()}
        function, found = self._checked(widened), []
        for name, k in self.places(values):
            given = self._copied(widened)
            x = np.ravel(widened[name])[k]
            scale = abs(x) or 1.0
            _put(given, (name, k), x + 1j * _STEP * scale)
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("error")      # an imaginary part that is discarded
                found.append(np.imag(function(given)) / (_STEP * scale))
        return np.array(found, float)

    def _checked(self, widened: Mapping[str, Any]) -> Callable[[Mapping[str, Any]], Any]:
        """f for complex numbers, which is analytic here; raises S2sadError where it is not."""
        args = tuple(widened[n] for n in self.names)
        types = self.state.types(args)
        results = self.state.summary(types).results
        if not results[0].is_complex:
            raise self._not_analytic("a float of complex numbers")
        call = self._analytic.get(types)
        if call is None:
            call = self._analytic[types] = ReverseCall(self.state, self._f, args, (RETURN,), self.wrt)
            call.warns = False
        ones, turned = (call.vjp(args, {RETURN: seed}) for seed in (1.0 + 0.0j, 1j))
        for name in self.wrt:
            real, imaginary = np.asarray(ones[name]), np.asarray(turned[name])
            scale = np.abs(real).max(initial=0.0) + np.abs(imaginary).max(initial=0.0)
            if not np.all(np.abs(imaginary - 1j * real) <= _ANALYTIC * scale):
                raise self._not_analytic(f"other slopes beside the real line than along it in '{name}'")
        return _function_of(self.state, types, self.engine)

    @cached_property
    def _analytic(self) -> dict[Any, ReverseCall]:
        return {}

    def _not_analytic(self, what: str) -> S2sadError:
        return S2sadError(Diagnostic(
            "S405", f"'{self.title}' is not analytic, it has {what}: the complex step would give another number",
            help='abs, conj, real or imag are the cause: take backend="tangent", or write np.sqrt(x * x) for abs(x)'))


def _widened(value: Any) -> Any:
    """Complex numbers for floats."""
    if isinstance(value, np.ndarray):
        return value.astype("complex128") if value.dtype.kind == "f" else value
    return np.complex128(value) if isinstance(value, float) else value


BACKENDS: dict[str, type[ReverseCall]] = {
    "adjoint": ReverseCall, "tangent": ByTangents, "finite": ByDifferences, "complex": ByComplexStep}


def backend_of(name: Any) -> type[ReverseCall]:
    """The calls of a way; raises S2sadError (S405) where there is none of that name.

    >>> backend_of("tangent").__name__
    'ByTangents'
    """
    if name not in BACKENDS:
        *others, last = map('"{}"'.format, BACKENDS)
        raise S2sadError(Diagnostic("S405", f"there is no backend {name!r}", help=f"{', '.join(others)} or {last}"))
    return BACKENDS[name]
