"""Gradients as users of JAX write them: `grad` and `value_and_grad`, by positions, of the first argument by default."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from s2sad.interface.drivers import Gradient, ValueAndGradient
from s2sad.interface.pickling import Decorated
from s2sad.interface.selection import names_of
from s2sad.run.tracebacks import public


@public
def grad(f: Callable[..., Any], argnums: int | Sequence[int] = 0) -> Gradient[Any] | InTuple:
    """As `gradient`, but with respect to the arguments at positions: the first one if nothing is said.

    Args: f as for `gradient`; argnums, a position, or several. The result is one array or float for one position, a
    tuple for several. Errors and literature as for `gradient`.

    >>> import numpy as np
    >>> def weighted(u, k):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += k * u[i] ** 2
    ...     return total
    >>> grad(weighted)(np.array([1.0, 2.0]), 3.0)
    array([ 6., 12.])
    >>> grad(weighted, argnums=(0, 1))(np.array([1.0, 2.0]), 3.0)
    (array([ 6., 12.]), 5.0)
    """
    return InTuple(f, tuple(argnums), False) if isinstance(argnums, Sequence) else Gradient(f, argnums)


@public
def value_and_grad(f: Callable[..., Any], argnums: int | Sequence[int] = 0) -> ValueAndGradient[Any, Any] | InTuple:
    """As `grad`, but the function returns (value, gradient).

    Args, errors and literature as for `grad`; the value is f's float.

    >>> def product(a, b):
    ...     return a * b
    >>> value_and_grad(product)(2.0, 3.0), value_and_grad(product, (1, 0))(2.0, 3.0)
    ((6.0, 3.0), (6.0, (2.0, 3.0)))
    """
    return InTuple(f, tuple(argnums), True) if isinstance(argnums, Sequence) else ValueAndGradient(f, argnums)


class InTuple(Decorated):
    """Gradients with respect to several positions, in a tuple; see `grad`."""

    def __init__(self, f: Any, argnums: tuple[int, ...], with_value: bool):
        self.__wrapped__, self._argnums, self._with_value = f, argnums, with_value
        self._both = ValueAndGradient(f, argnums)
        self._names = names_of(argnums, f) or ()
        self.__name__ = self.__qualname__ = self._both.__name__
        self.__module__, self.__doc__ = self._both.__module__, self._both.__doc__

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self._argnums, self._with_value

    @public
    def __call__(self, *args: Any, **keywords: Any) -> Any:
        value, found = self._both(*args, **keywords)
        gradients = tuple(found[n] for n in self._names) if len(self._names) > 1 else (found,) * len(self._names)
        return (value, gradients) if self._with_value else gradients
