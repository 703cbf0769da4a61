"""Derivatives with 113 bits: the text that s2sad writes for NumPy, run on numpy-quaddtype's arrays.

    >>> def kernel(x):
    ...     return x[0] * x[1]
    >>> float(gradient(kernel, (np.array([2.0, 3.0]),), ("x",))["x"][0])
    3.0

Arguments are arrays, numbers and what has no derivative; they are converted as they are, and never changed. What
cannot be computed so raises `NoReference`, which names what is missing. Two tests hold a reference honest
(`mismatch`): the adjoint against the tangent, and the tangent against extrapolated differences of the function's own
text with 113 bits, which knows nothing of s2sad.
"""
from __future__ import annotations

import ast
import inspect
import math
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

import s2sad
from benchmarks.precision.modules import CONSTANTS
from benchmarks.precision.quad import QUAD, NoReference, as_quad
from benchmarks.precision.text import executed, function_of

__all__ = ["Adjoint", "NoReference", "gradient", "mismatch", "relative_error", "tangent", "value"]

STEP, LEVELS = 2.0 ** -14, 6


def gradient(function: Callable[..., Any], arguments: Sequence[Any], wrt: Sequence[str],
             of: Sequence[str] = ("return",), seeds: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The gradients with respect to the entry values, as quads by name.

    Args:
        function: a plain function.
        arguments: its arguments, with doubles; not changed.
        wrt: names of arguments.
        of: outputs: "return", or an argument's name for its final content.
        seeds: for each output the adjoint of it; 1 where there is none, and for a result.

    Raises:
        NoReference: where 113 bits cannot be had for this function.
    """
    return Adjoint(function, arguments, wrt, of)(arguments, seeds)


class Adjoint:
    """The adjoint of a function for arguments of the same types, written once."""

    def __init__(self, function: Callable[..., Any], arguments: Sequence[Any], wrt: Sequence[str],
                 of: Sequence[str] = ("return",)) -> None:
        self.wrt, self.of = tuple(wrt), tuple(of)
        self.call, self.shadows = _call("adjoint", function, arguments, wrt, of)

    def __call__(self, arguments: Sequence[Any], seeds: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """The gradients by name, as `gradient` gives them; arguments may be quads."""
        seeds, call = seeds or {}, self.call
        given, bars = {n: _fresh(v) for n, v in zip(call.names, arguments)}, {}
        for name in self.shadows:
            bars[name] = _filled(given[name], seeds.get(name, 1.0) if name in self.of else 0.0)
        seed, count = seeds.get("return", 1.0), len(call.results) if "return" in self.of else 0
        listed = seed if isinstance(seed, (tuple, list)) else [seed] * count
        floats = call.run(given, bars, [_fresh(np.asarray(s)[()]) for s in listed])
        found = dict(zip((n for n in call.names if n in self.wrt and n not in self.shadows), floats))
        return {name: bars[name] if name in bars else found[name] for name in self.wrt}


def tangent(function: Callable[..., Any], arguments: Sequence[Any], tangents: Mapping[str, Any],
            of: Sequence[str] = ("return",)) -> dict[str, Any]:
    """The tangents of the outputs along those of the arguments, as quads by name."""
    call, shadows = _call("tangent", function, arguments, tuple(tangents), of)
    given = {n: _fresh(v) for n, v in zip(call.names, arguments)}
    dots = {n: _filled(given[n], tangents.get(n, 0.0)) if isinstance(given[n], np.ndarray)
            else as_quad(tangents.get(n, 0.0)) for n in shadows}
    returned = call.run(given, dots, [])
    result = returned[0] if len(returned) == 1 else tuple(returned)
    return {o: result if o == "return" else dots[o] for o in of}


def value(function: Callable[..., Any], arguments: Sequence[Any]) -> tuple[Any, dict[str, Any]]:
    """What the function's own text returns with 113 bits, and its arguments after the call, by name."""
    given = {n: _fresh(v) for n, v in zip(inspect.signature(function).parameters, arguments)}
    return _attempt(function_of(function), *given.values()), given


def mismatch(function: Callable[..., Any], arguments: Sequence[Any], wrt: Sequence[str],
             of: Sequence[str] = ("return",)) -> tuple[float, float]:
    """How far adjoint and tangent part, and tangent and differences, relative to the sum of what is added in magnitude.

    Around 1e-30 the first, around 1e-24 the second where a reference holds.
    """
    names, random = list(inspect.signature(function).parameters), np.random.default_rng(5)
    given = dict(zip(names, arguments))
    along = {n: random.uniform(0.5, 1.0, np.shape(given[n])) * _size(given[n]) for n in wrt}
    changed = tangent(function, arguments, along, of)
    seeds = {o: _like(lambda shape: random.uniform(0.5, 1.5, shape), changed[o]) for o in of}
    found = gradient(function, arguments, wrt, of, seeds)
    forward, size = _dot([(seeds[o], changed[o]) for o in of])
    backward, other = _dot([(along[n], found[n]) for n in wrt])
    total = _differences(function, given, along, seeds)
    scale = max(size, other) or 1.0
    return float(abs(forward - backward)) / scale, float(abs(forward - total)) / scale


def relative_error(found: Any, expected: Any) -> float:
    """The largest error of any element over the largest expected magnitude; infinite where one is not a number."""
    apart = np.abs(as_quad(np.asarray(found)) - np.asarray(expected))
    if not np.all(np.isfinite(apart)):
        return float("inf")
    scale = float(np.max(np.abs(expected), initial=as_quad(0.0))) or 1.0
    return float(np.max(apart, initial=as_quad(0.0))) / scale


class _Call:
    """A generated function with 113 bits: the order of its parameters, and whose shadow each is."""

    def __init__(self, generated: Callable[..., Any], names: list[str]) -> None:
        self.generated, self.order, self.names = generated, list(inspect.signature(generated).parameters), names
        self.shadows, self.results, owner = {}, [], ""
        for parameter in self.order:
            if parameter in self.names:
                owner = parameter
            elif owner and owner not in self.shadows.values() and "result" not in parameter:
                self.shadows[parameter] = owner
            else:
                self.results.append(parameter)

    def run(self, given: Mapping[str, Any], shadows: Mapping[str, Any], seeds: list[Any]) -> Sequence[Any]:
        rest = iter(seeds)
        returned = _attempt(self.generated, *(
            given[p] if p in given else shadows[self.shadows[p]] if p in self.shadows else next(rest)
            for p in self.order))
        return () if returned is None else returned if isinstance(returned, (tuple, list)) else (returned,)


def _call(mode: str, function: Callable[..., Any], arguments: Sequence[Any], wrt: Sequence[str], of: Sequence[str]
          ) -> tuple[_Call, list[str]]:
    names = list(inspect.signature(function).parameters)
    for name, given in zip(names, arguments):
        if not isinstance(given, (np.ndarray, np.generic, float, int, bool, str, type(None))):
            raise NoReference(f"the argument {name}, which is a {type(given).__name__}")
    made = s2sad.differentiate(function, wrt=tuple(wrt), of=tuple(of), engine="numpy")
    text = getattr(made, f"{mode}_source")(*(_copied(a) for a in arguments))
    space = _attempt(executed, text, _constants(function))
    called = next(n for n in reversed(list(space)) if n.startswith(f"{function.__name__}_{mode}"))
    call = _Call(space[called], names)
    return call, list(call.shadows.values())


def _attempt(function: Callable[..., Any], *given: Any) -> Any:
    """What a call with 113 bits gives; what numpy-quaddtype cannot do is a NoReference."""
    try:
        with np.errstate(all="ignore"):
            return function(*given)
    except (TypeError, NotImplementedError, AttributeError) as missing:
        raise NoReference(str(missing)) from missing


def _constants(function: Callable[..., Any]) -> dict[float, Any]:
    """The constants of rules, without those that the function spells itself."""
    text = textwrap.dedent(inspect.getsource(function))
    spelled = {math.pi} if re.search(r"\bpi\b", text) else set()
    found = (n.value for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Constant))
    spelled |= {v for v in found if isinstance(v, float)}
    return {k: v for k, v in CONSTANTS.items() if k not in spelled}


def _copied(value: Any) -> Any:
    return value.copy() if isinstance(value, np.ndarray) else value


def _fresh(value: Any) -> Any:
    """A copy with 113 bits of what is of floats."""
    if isinstance(value, np.ndarray):
        return value.astype(QUAD) if value.dtype == QUAD or value.dtype.kind in "fc" else value.copy()
    return as_quad(value) if isinstance(value, (float, np.floating)) else value


def _filled(like: Any, value: Any) -> Any:
    made = np.empty(np.shape(like), QUAD)
    made[...] = value
    return made


def _size(value: Any) -> Any:
    """The magnitude of each element, of small ones a thousandth of the largest, of zeros 1."""
    size = np.abs(value)
    return np.maximum(size, 1e-3 * np.max(size, initial=0.0) or 1.0)


def _like(made: Callable[[Any], Any], value: Any) -> Any:
    return tuple(made(np.shape(v)) for v in value) if isinstance(value, tuple) else made(np.shape(value))


def _dot(pairs: Sequence[tuple[Any, Any]]) -> tuple[Any, float]:
    """The sum of products, and that of their magnitudes."""
    total, size = as_quad(0.0), as_quad(0.0)
    for left, right in pairs:
        for a, b in zip(left, right) if isinstance(left, tuple) else ((left, right),):
            product = np.asarray(as_quad(a)) * b
            total, size = total + np.sum(product), size + np.sum(np.abs(product))
    return total, float(size)


def _differences(function: Callable[..., Any], given: Mapping[str, Any], along: Mapping[str, Any],
                 seeds: Mapping[str, Any]) -> Any:
    """The change of the seeded outputs along a direction: central differences with halved steps, the powers of the step
    in their errors eliminated (L. F. Richardson, 1911)."""
    def at(step: float) -> Any:
        moved = [_fresh(v) if n not in along else as_quad(np.asarray(v)) + step * as_quad(np.asarray(along[n]))
                 for n, v in given.items()]
        result, after = value(function, [m[()] if isinstance(m, np.ndarray) and not np.ndim(m) else m for m in moved])
        return _dot([(seeds[o], result if o == "return" else after[o]) for o in seeds])[0]

    steps = [STEP / 2 ** k for k in range(LEVELS)]
    rows = [(at(h) - at(-h)) / as_quad(2 * h) for h in steps]
    for order in range(1, LEVELS):
        rows = [(4 ** order * b - a) / as_quad(4 ** order - 1) for a, b in zip(rows, rows[1:])]
    return rows[0]
