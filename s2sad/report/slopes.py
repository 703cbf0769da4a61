"""Derivatives of a measured call's weighted outputs, by every way that is compared, and their reference.

The complex step is exact to rounding where the kernel does nothing but analytic functions of its inputs; `abs`, `conj`
or a comparison of imaginary parts make it another number, silently. So it is the reference only where it agrees with
the tangent, or else with extrapolated differences at every input; these are the reference where it does not, with the
error that they estimate of themselves. (Squire and Trapp, Using complex variables to estimate derivatives of real
functions, SIAM Review 40, 1998; Ridders, Advances in Engineering Software 4, 1982.)
"""
from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from s2sad.diagnostics import S2sadError
from s2sad.interface.value_calls import ForwardCall
from s2sad.report.differences import differences
from s2sad.report.measured_call import MeasuredCall
from s2sad.report.vector_function import VectorFunction, flat, split, vector_of
from s2sad.interface.selection import RETURN

_STEP = 1e-20                       # of the complex step, as a fraction of the input
_AGREE = 1e-10
_EXACT = "the complex step, which is exact to rounding"
_ESTIMATED = "extrapolated differences, which estimate their own error at"


@dataclass(frozen=True)
class ReferenceSlopes:
    """The derivatives that others are held against, nan where none is known, and their own error as a fraction of the
    largest."""
    values: np.ndarray
    floor: float
    source: str

    def error(self, found: np.ndarray) -> float:
        """The largest distance, as a fraction of the largest derivative; nan where none is known, or not finite.

        >>> ReferenceSlopes(np.array([1.0, 4.0, np.nan]), 0.0, "").error(np.array([1.0, 3.0, 9.0]))
        0.25
        """
        known = np.isfinite(self.values)
        top = float(np.abs(self.values[known]).max(initial=0.0))
        return float(np.abs(found - self.values)[known].max()) / (top or 1.0) if np.any(known) else float("nan")


class Slopes:
    """The derivatives of the outputs, weighted by `seeds`, for some of a measured call's `size` inputs."""

    def __init__(self, measured: MeasuredCall, seeds: dict[str, Any], gradients: dict[str, Any], most: int):
        self.measured, self.weights = measured, vector_of(seeds, measured.of)
        self.function_of_x = VectorFunction(self._primal(), measured.values, measured.wrt, measured.of)
        self.gradient, self.scales = vector_of(gradients, measured.wrt), self.function_of_x.scales()
        self.centre, self.size = vector_of(self.function_of_x.outputs, measured.of), self.gradient.size
        moving = np.flatnonzero(self.gradient)
        places = moving if moving.size else np.arange(self.size)
        self.places = np.sort(np.random.default_rng(0).choice(places, min(most, places.size), replace=False))

    def _primal(self) -> Callable[..., Any]:
        """The primal; of kernels with arrays of float32 for float64, in which differences are taken."""
        values = self.measured.values
        return self.measured.primal({n: np.zeros(v.shape) if getattr(v, "dtype", None) == np.float32 else v
                                     for n, v in values.items()})

    # -- the ways ------------------------------------------------------------------------------------------------------

    def adjoint(self) -> np.ndarray:
        return self.gradient[self.places]

    def tangent(self, call: ForwardCall) -> np.ndarray:
        found = []
        for place in self.places:
            tangents = split(self.measured.values, self.measured.wrt, self._direction(place, 1.0))
            dots = call.jvp(self.measured.arguments, tangents)
            found.append(self._weighted(vector_of(dots, self.measured.of)))
        return np.array(found)

    def central(self, step: float) -> np.ndarray:
        return self._differences(lambda line: (line(step) - line(-step)) / (2.0 * step))

    def forward(self, step: float) -> np.ndarray:
        return self._differences(lambda line: (line(step) - line(0.0)) / step)

    def _differences(self, taken: Callable[[Any], np.ndarray]) -> np.ndarray:
        with np.errstate(all="ignore"):
            return np.array([float(taken(self._line(k))[0]) / self.scales[k] for k in self.places])

    def complex_step(self) -> np.ndarray:
        """Raises whatever the kernel raises that takes no complex numbers, or S2sadError where none can be compiled."""
        if any(np.iscomplexobj(v) for v in self.measured.values.values()):
            raise ValueError("the kernel takes complex numbers itself")
        function = self.measured.primal(self.complex_values(0))
        return np.array([self._weighted(self._imaginary(function, self.complex_values(k))) / (_STEP * self.scales[k])
                         for k in self.places])

    def complex_values(self, place: int) -> dict[str, Any]:
        """The values with complex numbers for inputs and outputs, one of the inputs with a step."""
        measured, found = self.measured, {}
        x = self.function_of_x.x.astype("complex128")
        x[place] += 1j * _STEP * self.scales[place]
        written, at = measured.state.summary(measured.types).written, 0
        for name, value in self.function_of_x.arguments.items():
            found[name] = value.astype("complex128") if name in written and getattr(
                value, "dtype", None) == np.float64 else np.array(value) if isinstance(value, np.ndarray) else value
        for name in measured.wrt:
            shape = np.shape(self.function_of_x.arguments[name])
            part = x[at:at + flat(self.function_of_x.arguments[name]).size]
            found[name] = part.reshape(shape) if shape else complex(part[0])
            at += part.size
        return found

    def _imaginary(self, function: Callable[..., Any], values: dict[str, Any]) -> np.ndarray:
        """The imaginary parts of the outputs, which the function writes into complex values."""
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("error")      # an imaginary part that is discarded
            values[RETURN] = function(*[values[n] for n in self.measured.values])
        outputs = {n: values[n] for n in self.measured.of}
        return np.concatenate([np.zeros(0), *(_parts(self.function_of_x.outputs[n], outputs[n]) for n in outputs)])

    # -- what they are held against ------------------------------------------------------------------------------------

    def reference(self, others: Sequence[np.ndarray], stepped: np.ndarray | None) -> tuple[ReferenceSlopes, bool]:
        """The reference, and whether the complex step is right; `others` are derivatives by the tangent or adjoint."""
        if stepped is not None:
            exact = ReferenceSlopes(stepped, 0.0, _EXACT)
            if np.all(np.isfinite(stepped)) and any(exact.error(o) <= _AGREE for o in others):
                return exact, True
        expected, estimate = self._extrapolated()
        known = np.isfinite(estimate)
        top = float(np.abs(expected[known]).max(initial=0.0)) or 1.0
        if stepped is not None and np.all(known) and np.all(np.abs(stepped - expected) <= 10 * estimate + 1e-8 * top):
            return ReferenceSlopes(stepped, 0.0, _EXACT), True
        floor = float(estimate[known].max(initial=0.0)) / top
        kinks = int((~known).sum())
        unsure = f" (and say nothing of {kinks} of them: a kink or a jump is near)" if kinks else ""
        return ReferenceSlopes(np.where(known, expected, np.nan), floor, f"{_ESTIMATED} {floor:.0e}{unsure}"), False

    def _extrapolated(self) -> tuple[np.ndarray, np.ndarray]:
        found = [differences(self._line(place)) for place in self.places]
        scales = self.scales[self.places]
        return (np.array([float(slope[0]) for slope, _ in found]) / scales,
                np.array([float(error[0]) for _, error in found]) / scales)

    # -- helpers -------------------------------------------------------------------------------------------------------

    def _direction(self, place: int, length: float) -> np.ndarray:
        found = np.zeros(self.size)
        found[place] = length
        return found

    def _line(self, place: int) -> Callable[[float], np.ndarray]:
        """The weighted outputs along one input, less what they are at its value: what does not depend on it is 0."""
        line = self.function_of_x.along(self._direction(place, self.scales[place]))
        return lambda h: np.array([self._weighted(line(h) - self.centre)])

    def _weighted(self, values: np.ndarray) -> float:
        return float(self.weights @ values)


def _parts(like: Any, value: Any) -> np.ndarray:
    """The imaginary parts of the floats in an output, in the order of `flat`; of what is real they are zero."""
    if isinstance(like, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(_parts, like, value)])
    return np.asarray(np.imag(value), "float64").ravel() if flat(like).size else np.zeros(0)


def reason(error: Exception) -> str:
    """Why there is no complex step, in one line."""
    said = error.diagnostics[0].message if isinstance(error, S2sadError) else f"{type(error).__name__}: {error}"
    return said.strip().splitlines()[0]
