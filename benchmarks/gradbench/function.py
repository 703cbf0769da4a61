"""What an eval asks for: the function of one name, and the derivatives that such functions are made of."""
from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import s2sad


ENGINE = "auto"     # set before the evals are loaded


@dataclass(frozen=True)
class Function:
    """One function of an eval: `arguments` makes them of the input and `output` what is sent of the result and the
    input, both untimed; `call` is timed."""
    arguments: Callable[[Any], tuple[Any, ...]]
    call: Callable[..., Any]
    output: Callable[[Any, Any], Any]


def number(result: Any, given: Any) -> float:
    """A result that is sent as a number."""
    return float(result)


def listed(result: Any, given: Any) -> list[Any]:
    """An array that is sent as lists of its shape."""
    return result.tolist()


def array(values: Any, *shape: int) -> np.ndarray:
    """Floats of the shape, in rows.

    >>> array([[1, 2], [3, 4]], 4)
    array([1., 2., 3., 4.])
    """
    return np.array(values, dtype=np.float64).reshape(shape)


def differentiated(kernel: Callable[..., Any], **selection: Any) -> Any:
    """The kernel with its derivatives, for the engine that was chosen."""
    return s2sad.differentiate(kernel, engine=ENGINE, **selection)


def primal(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """The kernel as it is compiled beside its derivatives."""
    return differentiated(kernel).primal


def reverse(kernel: Callable[..., Any], *wrt: str) -> Callable[..., tuple[np.ndarray, ...]]:
    """The gradients of the float that a kernel returns with respect to array parameters, as a function of its
    arguments: one adjoint, whose shadows start as zeros."""
    adjoint = differentiated(kernel, wrt=wrt, of="return").adjoint
    places = [list(inspect.signature(kernel).parameters).index(name) for name in wrt]

    def gradients(*arguments: Any) -> tuple[np.ndarray, ...]:
        shadows = {k: np.zeros_like(arguments[k]) for k in places}
        adjoint(*with_shadows(arguments, shadows), 1.0)
        return tuple(shadows[k] for k in places)
    return gradients


def with_shadows(arguments: Sequence[Any], shadows: dict[int, Any]) -> list[Any]:
    """The arguments, each followed by its shadow if its place has one.

    >>> with_shadows((1, 2, 3), {1: 20})
    [1, 2, 20, 3]
    """
    return [part for k, a in enumerate(arguments) for part in ((a, shadows[k]) if k in shadows else (a,))]
