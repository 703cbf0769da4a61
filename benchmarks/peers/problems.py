"""What is compared: a kernel at a size, with seeds for its outputs, and its gradients with 113 bits."""
from __future__ import annotations

import importlib
import importlib.util
import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.calls import fresh, seed_like
from benchmarks.gradbench import inputs
from benchmarks.gradbench.kernels import gmm, lstm
from benchmarks.kernels.cases import ARRAYS, CASES, Case, Size


class Unsupported(Exception):
    """A kernel that a tool cannot express or differentiate; the text says why."""


@dataclass
class Run:
    """A gradient: the call that is timed, and what makes arrays of its result, in the order of the inputs.

    `held` are the bytes that the call needs beside its arguments and that were allocated before it.
    """
    call: Callable[[], Any]
    gradients: Callable[[Any], Sequence[Any]]
    held: int = 0


# sizes from some hundred cells to beyond the cache; errors are measured at the first, where 113 bits take seconds
SIZES = {
    "brusselator": (32, 128, 1024), "integrate": (16, 64, 256), "jacobi": (32, 128, 1024), "seidel": (32, 128, 512),
    "advect": (256, 4096, 100_000), "mixture": (128, 2048, 50_000), "nbody": (16, 64, 256), "glacier": (24, 96, 384),
    "lattice": (16, 64, 256), "attention": (64, 256, 1024), "gmm": (128, 1024, 20_000), "lstm": (32, 256, 4096),
}
EXACT = 0


def _gmm(size: Size) -> tuple[Any, ...]:
    made = inputs.gmm(5, 6, int(size))
    return (*(np.array(made[name]) for name in ("alpha", "mu", "q", "l", "x")), 1.0, 0, 1.0)


def _lstm(size: Size) -> tuple[Any, ...]:
    made = inputs.lstm(2, int(size))
    return tuple(np.array(made[name]) for name in ("main_params", "extra_params", "state", "sequence"))


_ADBENCH = (Case("gmm", gmm.objective, _gmm, ("alpha", "mu", "q", "l"), ("return",)),
            Case("lstm", lstm.objective, _lstm, ("main_params", "extra_params"), ("return",)))
_ALL: dict[str, Case] = {**CASES, **{case.name: case for case in (*ARRAYS, *_ADBENCH)}}


@dataclass(frozen=True)
class Problem:
    """A kernel at a size: its arguments, never changed, and the seeds of its outputs."""
    case: Case
    size: int
    arguments: tuple[Any, ...]

    @classmethod
    def of(cls, kernel: str, size: int) -> Problem:
        """The problem of a kernel's name."""
        case = _ALL[kernel]
        return cls(case, size, case.arguments(size))

    @property
    def names(self) -> list[str]:
        """The kernel's parameters."""
        return list(inspect.signature(self.case.function).parameters)

    @property
    def given(self) -> dict[str, Any]:
        """The arguments by name, arrays copied."""
        return dict(zip(self.names, fresh(self.arguments)))

    @property
    def seeds(self) -> list[Any]:
        """For each output the adjoint of it: an array for an array, 1 for a returned number."""
        given = dict(zip(self.names, self.arguments))
        return [1.0 if name == "return" else seed_like(given[name]) for name in self.case.of]

    @property
    def inputs(self) -> int:
        """How many numbers are differentiated with respect to."""
        given = dict(zip(self.names, self.arguments))
        return sum(np.size(given[name]) for name in self.case.wrt)

    def taken(self, function: Callable[..., Any]) -> dict[str, Any]:
        """Those arguments that a tool's version of the kernel takes, by name."""
        given = self.given
        return {name: given[name] for name in inspect.signature(function).parameters}

    def reference(self) -> list[Any] | None:
        """The gradients with 113 bits, in the order of the inputs; None where they cannot be had."""
        if importlib.util.find_spec("numpy_quaddtype") is None:
            return None
        module = importlib.import_module("benchmarks.precision.reference")
        try:
            found = module.gradient(self.case.function, self.arguments, self.case.wrt, self.case.of,
                                    dict(zip(self.case.of, self.seeds)))
        except module.NoReference:
            return None
        return [found[name] for name in self.case.wrt]


def error(found: Sequence[Any], expected: Sequence[Any]) -> float:
    """The largest error of an element over the largest element of the same input's gradient.

    >>> error([np.array([1.0, 2.0])], [np.array([1.0, 4.0])])
    0.5
    """
    worst = 0.0
    for one, other in zip(found, expected, strict=True):
        apart = np.abs(np.asarray(one).astype(np.asarray(other).dtype) - other)
        if apart.shape != np.shape(other) or not np.all(np.isfinite(apart)):
            return float("inf")
        worst = max(worst, float(np.max(apart)) / (float(np.max(np.abs(other))) or 1.0))
    return worst
