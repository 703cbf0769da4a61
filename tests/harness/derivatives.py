"""The instrument that every derivative is measured with: `check_derivatives`.

It uses the public interface, and the differences that `s2sad.check` takes. The kernel is called as plain Python on
shifted copies of its arguments, and every derivative comes with an estimate of its own error, which knows what rounding
does to this kernel's values here: it is measured once, with all inputs moved at once. Where the estimate is poor (a
kink or a jump within reach), `UnreliableDifferences` is raised, which is no failure: tests on generated programs skip
such a point.
"""
from __future__ import annotations

import copy
import inspect
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

import s2sad
from s2sad.report.differences import Line, rounding
from s2sad.report.differences import differences as along_line
from tests.harness.engines import running
from tests.harness.seeds import generator

Values = dict[str, Any]


class UnreliableDifferences(Exception):
    """The differences do not converge here: there is a kink or a jump within the smallest step."""


@dataclass(frozen=True)
class Measured:
    """How far apart things were, each as a fraction of the sum of magnitudes."""
    dot_product: float
    directional: float
    coordinates: float


# -- values as flat vectors -----------------------------------------------------------------------------------------
def _flat(value: Any) -> np.ndarray:
    """Every float in a value, in order, as float64, complex numbers as two of them; integers, bools and None do not
    count. The sum over products of two such vectors is Re(conj(a) b)."""
    if isinstance(value, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(_flat, value)])
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "c":
            return value.astype("complex128").ravel().view("float64")
        return value.astype("float64").ravel() if value.dtype.kind == "f" else np.zeros(0)
    if isinstance(value, complex):
        return np.array([value.real, value.imag])
    return np.array([float(value)]) if isinstance(value, (float, np.floating)) else np.zeros(0)


def _shaped(like: Any, flat: np.ndarray) -> Any:
    """The inverse of `_flat`, with the structure and dtype of `like`."""
    if isinstance(like, (tuple, list)):
        parts, at = [], 0
        for item in like:
            size = _flat(item).size
            parts.append(_shaped(item, flat[at:at + size]) if size else None)
            at += size
        return tuple(parts)
    if isinstance(like, np.ndarray):
        flat = flat.view("complex128") if like.dtype.kind == "c" else flat
        return flat.reshape(like.shape).astype(like.dtype)
    return complex(flat[0], flat[1]) if isinstance(like, complex) else float(flat[0])


def _vector(values: Mapping[str, Any], names: tuple[str, ...]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *(_flat(values[n]) for n in names)])


def _split(like: Mapping[str, Any], names: tuple[str, ...], flat: np.ndarray) -> Values:
    found, at = {}, 0
    for n in names:
        size = _flat(like[n]).size
        found[n] = _shaped(like[n], flat[at:at + size])
        at += size
    return found


def _wide(value: Any) -> Any:
    """float32 as float64: the differences of a float32 kernel are taken in double precision."""
    return value.astype("float64") if isinstance(value, np.ndarray) and value.dtype.kind == "f" else value


class VectorFunction:
    """A kernel as a mathematical function: from the floats of `wrt` to the floats of `of`."""

    def __init__(self, function: Callable, arguments: tuple, wrt: tuple[str, ...], of: tuple[str, ...]):
        self.function = getattr(function, "py_func", function)
        bound = inspect.signature(self.function).bind(*arguments)
        bound.apply_defaults()
        kinds = {n: p.kind for n, p in bound.signature.parameters.items()}
        self.given: Values = {n: v for n, v in bound.arguments.items() if kinds[n] not in (
            inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)}
        self.wrt, self.of = tuple(wrt), tuple(of)
        self.x = _vector(self.given, self.wrt)
        self.outputs = self.run(self.given)

    def run(self, given: Values) -> Values:
        """The contents of the outputs after a call on copies."""
        given = copy.deepcopy(given)
        with np.errstate(all="ignore"):
            result = self.function(*given.values())
        found = {**given, "return": result}
        return {n: found[n] for n in self.of}

    def __call__(self, x: np.ndarray) -> np.ndarray:
        wide = {n: _wide(copy.deepcopy(v)) for n, v in self.given.items()}
        return _vector(self.run({**wide, **_split(wide, self.wrt, x)}), self.of)

    def along(self, direction: np.ndarray) -> Line:
        """The outputs as a function of the distance gone in a direction."""
        return lambda distance: self(self.x + distance * direction)

    @cached_property
    def noise(self) -> np.ndarray:
        """What rounding adds to the outputs around here."""
        return rounding(self.along(generator(0).standard_normal(self.x.size) * self.scales()))

    def is_single(self) -> bool:
        """Whether an argument is of float32: what is computed is precise to that."""
        return any(isinstance(v, np.ndarray) and v.dtype == np.float32 for v in self.given.values())

    def smallest(self) -> float:
        """The smallest normal number of what is computed."""
        return float(np.finfo(np.float32 if self.is_single() else np.float64).tiny)

    def scales(self) -> np.ndarray:
        """A natural step for every input: its own size, or its argument's where it is small."""
        parts = [np.zeros(0)]
        for n in self.wrt:
            size = np.abs(_flat(self.given[n]))
            top = size.max(initial=0.0) or 1.0
            parts.append(np.maximum(size, 0.1 * top))
        return np.concatenate(parts)


# -- differences ----------------------------------------------------------------------------------------------------
def differences(subject: VectorFunction, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The derivative along a direction by output, with estimates of the errors."""
    return along_line(subject.along(direction), noise=subject.noise)


# -- the check ------------------------------------------------------------------------------------------------------
def _unchanged(before: tuple, after: tuple, what: str) -> None:
    for k, (a, b) in enumerate(zip(before, after)):
        assert np.array_equal(np.asarray(a), np.asarray(b), equal_nan=np.asarray(a).dtype.kind == "f"), (
            f"{what} changed argument {k}: {a} became {b}")


def _same_shape(gradients: Values, subject: VectorFunction) -> None:
    assert tuple(gradients) == subject.wrt or set(gradients) == set(subject.wrt), f"gradients for {tuple(gradients)}"
    for n in subject.wrt:
        given, found = subject.given[n], gradients[n]
        assert np.shape(found) == np.shape(given), f"gradient of {n}: shape {np.shape(found)}, not {np.shape(given)}"
        if isinstance(given, np.ndarray):
            assert found.dtype == given.dtype, f"gradient of {n}: {found.dtype}, not {given.dtype}"


def _close(found: float, expected: float, magnitude: float, error: float, rtol: float, what: str) -> float:
    """Raises unless they agree; gives the distance as a fraction of the magnitude."""
    if math.isnan(expected) or error > 1e-5 * magnitude + 1e-11:
        raise UnreliableDifferences(f"{what}: error {error:.1e} at magnitude {magnitude:.1e}")
    assert abs(found - expected) <= rtol * magnitude + 10 * error + 1e-14, (
        f"{what}: s2sad has {found!r}, differences have {expected!r} +- {error:.1e} (magnitude {magnitude:.3g})")
    return abs(found - expected) / (magnitude or 1.0)


def _primal_values(differentiated: Any, subject: VectorFunction, rtol: float) -> None:
    """The primal's values are the kernel's, but for what rounding does to them."""
    given = copy.deepcopy(subject.given)
    result = differentiated(*given.values())
    found = _vector({**given, "return": result}, subject.of)
    expected = _vector(subject.outputs, subject.of)
    noise = subject.noise * (np.finfo(np.float32).eps / np.finfo(float).eps if subject.is_single() else 1.0)
    allowed = 1e-12 + 1e-3 * rtol * np.abs(expected) + np.minimum(10 * noise, rtol * np.abs(expected))
    wrong = ~(np.abs(found - expected) <= allowed) & (found != expected)
    assert not wrong.any(), f"primal of {subject.of}: {found[wrong]}, not {expected[wrong]}, {allowed[wrong]} allowed"


def check_derivatives(function: Callable, arguments: tuple, wrt: tuple[str, ...], of: tuple[str, ...],
                      engine: str = "numpy", rtol: float = 1e-7, dot_tol: float = 1e-12, seed: int = 0,
                      coordinates: int = 60, directions: int = 2, vanishing: float = 0.0) -> Measured:
    """Measures the adjoint and the tangent of `function` at `arguments` against each other and differences.

    Every output in `of` (an argument's final content by its name, or "return") gets a random seed. Checked:
    the dot product of tangent and adjoint, the tangent by output and the adjoint along random directions, the
    gradient of up to `coordinates` single inputs, the primal's values, and that no argument is changed.
    The engine may also be `loops` (tests/harness/engines.py). Dot products closer than `vanishing` are equal:
    derivatives of that size are what rounding leaves of numbers around 1.
    Raises AssertionError where they disagree, UnreliableDifferences where nothing can be said. float32
    arguments relax the tolerances to what float32 can hold.
    """
    with running(engine) as run_under:
        return _measured(function, VectorFunction(function, arguments, wrt, of), run_under, rtol, dot_tol, seed,
                         coordinates, directions, vanishing)


def _measured(function: Callable, subject: VectorFunction, engine: str, rtol: float, dot_tol: float, seed: int,
              coordinates: int, directions: int, vanishing: float) -> Measured:
    if subject.is_single():
        rtol, dot_tol = max(rtol, 2e-3), max(dot_tol, 1e-4)
    if not np.all(np.isfinite(_vector(subject.outputs, subject.of))):
        raise UnreliableDifferences("the outputs are not finite")
    rng = generator(seed)
    differentiated = s2sad.differentiate(function, engine=engine)
    _primal_values(differentiated, subject, rtol)
    args = tuple(copy.deepcopy(subject.given).values())
    before = copy.deepcopy(args)
    bars = rng.uniform(0.5, 1.5, _vector(subject.outputs, subject.of).size) * rng.choice([-1.0, 1.0])
    bars *= np.where(rng.random(bars.size) < 0.3, -1.0, 1.0)
    seeds = _split(subject.outputs, subject.of, bars)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", s2sad.S2sadWarning)      # a generated output may depend on nothing
        gradients = s2sad.vjp(differentiated, args, seeds, wrt=subject.wrt)
    _unchanged(before, args, "vjp")
    _same_shape(gradients, subject)
    x_bar, bars = _vector(gradients, subject.wrt), _vector(seeds, subject.of)
    dot = along = 0.0
    for _ in range(directions):
        direction = _rounded(subject, rng.standard_normal(subject.x.size) * subject.scales())
        tangents = s2sad.jvp(differentiated, args, _split(subject.given, subject.wrt, direction), of=subject.of)
        _unchanged(before, args, "jvp")
        y_dot = _vector(tangents, subject.of)
        dot = max(dot, _dot_product(bars, y_dot, x_bar, direction, dot_tol,
                                        max(vanishing, subject.smallest())))
        along = max(along, _along(subject, direction, bars, y_dot, x_bar, rtol))
    single = _single_inputs(subject, bars, x_bar, rtol, coordinates, rng)
    return Measured(dot, along, single)


def check_value(function: Callable, arguments: tuple, wrt: tuple[str, ...], engine: str = "numpy") -> None:
    """Checks the value that comes with the gradient of a function that returns one float."""
    with np.errstate(all="ignore"):
        expected = getattr(function, "py_func", function)(*copy.deepcopy(arguments))
    if not isinstance(expected, (float, np.floating)):
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", s2sad.S2sadWarning)
        with running(engine) as run_under:
            found, _ = s2sad.value_and_gradient(s2sad.differentiate(function, engine=run_under), wrt=wrt)(*arguments)
    tolerance = 1e-4 if any(getattr(a, "dtype", None) == np.float32 for a in arguments) else 1e-9
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=1e-12, err_msg="the value beside the gradient")


def _rounded(subject: VectorFunction, direction: np.ndarray) -> np.ndarray:
    """The direction as the tangents' dtypes can hold it."""
    return _vector(_split(subject.given, subject.wrt, direction), subject.wrt)


def _dot_product(bars: np.ndarray, y_dot: np.ndarray, x_bar: np.ndarray, x_dot: np.ndarray, tolerance: float,
                 smallest: float) -> float:
    """How far they are apart; numbers under the smallest normal one have lost their digits and do not count."""
    magnitude = float(np.abs(bars * y_dot).sum() + np.abs(x_bar * x_dot).sum())
    distance = abs(math.fsum(bars * y_dot) - math.fsum(x_bar * x_dot))
    assert distance <= max(tolerance * magnitude, smallest), (
        f"dot product: tangent {math.fsum(bars * y_dot)!r}, adjoint {math.fsum(x_bar * x_dot)!r}, apart by "
        f"{distance / magnitude:.1e} of {magnitude:.3g}")
    return distance / (magnitude or 1.0)


def _along(subject: VectorFunction, direction: np.ndarray, bars: np.ndarray, y_dot: np.ndarray, x_bar: np.ndarray,
           rtol: float) -> float:
    """The tangent by output, and the adjoint, against differences along one direction."""
    expected, error = differences(subject, direction)
    top = float(np.abs(expected).max(initial=0.0))
    for k in range(expected.size):
        _close(y_dot[k], expected[k], abs(expected[k]) + 1e-2 * top, error[k], rtol, f"tangent of output {k}")
    magnitude = float(np.abs(bars * expected).sum() + np.abs(x_bar * direction).sum())
    return _close(math.fsum(x_bar * direction), math.fsum(bars * expected), magnitude,
                  float(np.abs(bars * error).sum()), rtol, "adjoint along a direction")


def _single_inputs(subject: VectorFunction, bars: np.ndarray, x_bar: np.ndarray, rtol: float, count: int,
                   rng: np.random.Generator) -> float:
    """The gradient of single inputs: all of them where they are few."""
    worst, scales = 0.0, subject.scales()
    chosen = rng.permutation(subject.x.size)[:count]
    top = float(np.abs(x_bar * scales).max(initial=0.0))
    owners = [f"{n}[{k}]" for n in subject.wrt for k in range(_flat(subject.given[n]).size)]
    for j in sorted(chosen):
        direction = np.zeros(subject.x.size)
        direction[j] = scales[j]
        expected, error = differences(subject, direction)
        magnitude = float(np.abs(bars * expected).sum() + abs(x_bar[j] * scales[j]) + 1e-2 * top)
        worst = max(worst, _close(x_bar[j] * scales[j], math.fsum(bars * expected), magnitude,
                                  float(np.abs(bars * error).sum()), rtol, f"gradient of {owners[j]} (scaled)"))
    return worst
