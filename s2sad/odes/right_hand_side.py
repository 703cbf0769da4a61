"""A kernel as the right-hand side of an ordinary differential equation, as SciPy's integrators call it.

    f(du, u, p, t)      writes the rate du      fun(t, y, p), jac(t, y, p):
    f(t, u, p)          returns it              y is flat, the kernel's u of any shape
"""
from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import describe
from s2sad.dispatch.cache import derivatives_of
from s2sad.interface.differentiate import Differentiated
from s2sad.interface.pickling import Decorated
from s2sad.interface.pytrees import flat_call
from s2sad.interface.selection import RETURN
from s2sad.interface.value_calls import selection_of
from s2sad.jacobians.jacobian import Jacobian
from s2sad.live_objects.unwrap import apply_functions, python_function
from s2sad.naming import Names
from s2sad.run.module_loader import load
from s2sad.run.tracebacks import public

_TIME = "t"


@public
def ode(f: Callable[..., Any], *, rate: str | None = None, state: str | None = None, time: str | None = None,
        shape: Sequence[int] | None = None, sparse: Any = False, check: bool = True) -> Ode:
    """The callable fun(t, y, *args) that `scipy.integrate.solve_ivp` takes, of a kernel; its `jac` is the matching one.

    Args: f, a function, a differentiated function or a Numba dispatcher: f(du, u, ...) writes the rate of its state
    into its first parameter, f(t, u, ...), whose first parameter is called t, returns it, as an array or as a list or
    tuple of numbers. A parameter t elsewhere is the time, too; all others are those of `args`, in their order. rate,
    state and time name these parameters where they are others; shape, that of u (default: that of y), whose elements y
    has in C order; sparse and check, for `jac`, as for `jacobian`. y is a flat array of floats, integers are converted;
    it is never changed. `fun` returns a new flat array of as many elements, `jac` the Jacobian with respect to y, of
    two axes.
    Raises S2sadError: S401 (f lacks a parameter that is named, or does not write its rate), S403 (y or what f returns
    does not fit), S405 as `jacobian`; and what f raises. Literature: Hairer and Wanner, Solving Ordinary Differential
    Equations II, Springer 1996.

    >>> import numpy as np
    >>> def decay(du, u, k, t):
    ...     for i in range(u.size):
    ...         du[i] = -k * u[i] ** 2 + t
    >>> fun = ode(decay)
    >>> fun(1.0, np.array([1.0, 2.0]), 0.5)
    array([ 0.5, -1. ])
    >>> np.diag(fun.jac(1.0, np.array([1.0, 2.0]), 0.5))
    array([-1., -2.])
    """
    return Ode(f, rate, state, time, shape, sparse, check)


class Ode(Decorated):
    """A kernel as the right-hand side of an equation; see `ode`."""

    def __init__(self, f: Any, rate: str | None = None, state: str | None = None, time: str | None = None,
                 shape: Sequence[int] | None = None, sparse: Any = False, check: bool = True):
        self.__wrapped__, self._given = f, (rate, state, time, shape, sparse, check)
        self._title = getattr(f, "__name__", "f")
        self.parameters = _parameters(f)
        self.rate, self.state, self.time = _roles(self._title, self.parameters, rate, state, time)
        self.others = tuple(n for n in self.parameters if n not in (self.rate, self.state, self.time))
        self.shape = None if shape is None else _checked(shape)
        self.jac_options = sparse, check
        self._known: set[tuple[Any, ...]] = set()
        self.__name__ = self.__qualname__ = f"ode_of_{self._title}"
        self.__module__ = getattr(f, "__module__", __name__)
        self.__doc__ = f"The right-hand side '{self._title}'."

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, *self._given

    def __repr__(self) -> str:
        return f"<ode of {self._title}>"

    @cached_property
    def kernel(self) -> Differentiated[..., Any]:
        """The kernel that writes the rate, or returns it as an array."""
        f, carried = self.__wrapped__, selection_of(self.__wrapped__)
        return Differentiated(f if self.rate is not None else self.read, None, None, carried.engine, carried.recording)

    @cached_property
    def read(self) -> Any:
        """The kernel's function, of arrays and numbers, as other texts call it."""
        f = python_function(self.__wrapped__)
        return f if self.rate is not None else _in_an_array(f, self.parameters)

    @public
    def __call__(self, t: float, y: Any, *args: Any) -> np.ndarray:
        values = self.values(t, y, args)
        if (key := describe(values)) not in self._known:
            self._written(values)
            self._known.add(key)
        returned = self.kernel.primal(*values)
        found = np.asarray(returned if self.rate is None else values[self.parameters.index(self.rate)])
        shape = np.shape(y) if self.shape is None else self.shape
        if found.shape != shape:
            raise S2sadError(Diagnostic(
                "S403", f"'{self._title}' returns an array of shape {found.shape}, its state is of shape {shape}",
                help="return the rate of each element of the state"))
        return found.reshape(-1)

    @public
    def jac(self, t: float, y: Any, *args: Any) -> Any:
        """The Jacobian of the rate with respect to y, of two axes, an array or a sparse matrix."""
        found = self.jacobian(self.state)(*self.values(t, y, args))
        return found.reshape(2 * (np.size(y),)) if isinstance(found, np.ndarray) else found

    def jacobian(self, wrt: str) -> Jacobian:
        """The Jacobian of the rate with respect to a parameter of f, as a function of f's arguments."""
        if wrt not in self._jacobians:
            sparse, check = self.jac_options if wrt == self.state else (False, True)
            self._jacobians[wrt] = Jacobian(self.kernel, wrt, self.rate or RETURN, sparse=sparse, check=check)
        return self._jacobians[wrt]

    @cached_property
    def _jacobians(self) -> dict[str, Jacobian]:
        return {}

    def values(self, t: float, y: Any, args: Sequence[Any]) -> list[Any]:
        """The arguments of the kernel, with a state and a rate of their own."""
        given = np.asarray(y)
        shape = given.shape if self.shape is None else self.shape
        if given.size != np.prod(shape, dtype=int) or given.dtype.kind not in "biufc":
            raise S2sadError(Diagnostic(
                "S403", f"y is an array of {given.dtype} of shape {given.shape}, the state of '{self._title}' is of "
                f"shape {shape}", help=f"give a flat array of floats of {np.prod(shape, dtype=int)} elements"))
        u = np.array(given, None if given.dtype.kind == "c" else float, order="C").reshape(shape)
        held = {self.state: u if shape else u.item(), self.time: float(t), self.rate: np.zeros_like(u)}
        given_names = inspect.signature(python_function(self.__wrapped__) or self.__wrapped__).parameters
        left = [n for n in self.others if given_names[n].default is inspect.Parameter.empty]
        if not len(left) <= len(args) <= len(self.others):
            raise TypeError(f"'{self._title}' takes {len(self.others)} arguments beside its state "
                            f"({', '.join(self.others) or 'none'}), but {len(args)} were given: args=(...)")
        held.update({n: given_names[n].default for n in self.others[len(args):]})
        held.update(zip(self.others, args))
        return [held[n] for n in self.parameters]

    def _written(self, values: Sequence[Any]) -> None:
        """Raises where the kernel does not write what should be its rate."""
        if self.rate is None:
            return
        f, args, _ = apply_functions(self.kernel, values, {})
        state, flat, _ = flat_call(derivatives_of(f).state(), f, args)
        if self.rate not in state.summary(state.types(flat)).written:
            raise S2sadError(Diagnostic(
                "S401", f"'{self._title}' does not write '{self.rate}', which should be the rate of '{self.state}'",
                help="write f(du, u, ...), which writes du, or f(t, u, ...), which returns it; or name the parameters: "
                "rate=, state=, time="))


def _parameters(f: Any) -> tuple[str, ...]:
    function = python_function(f)
    if function is None:
        raise S2sadError(Diagnostic("S401", f"{f!r} is no function of Python's", help="give the kernel itself"))
    return tuple(inspect.signature(function).parameters)


def _roles(title: str, parameters: Sequence[str], rate: str | None, state: str | None, time: str | None
           ) -> tuple[str | None, str, str | None]:
    """The parameters that are the rate (None: it is returned), the state and the time."""
    for name in (rate, state, time):
        if name is not None and name not in parameters:
            raise S2sadError(Diagnostic("S401", f"'{name}' is no parameter of '{title}'",
                                        help=f"its parameters are {', '.join(parameters)}"))
    time = time if time is not None else _TIME if _TIME in parameters else None
    left = [n for n in parameters if n not in (time, state, rate)]
    if rate is None and parameters and parameters[0] != time and parameters[0] != state:
        rate = left.pop(0)
    if state is None and left:
        state = left[0]
    named = [n for n in (rate, state, time) if n is not None]
    if state is None or len(named) != len({*named}):
        raise S2sadError(Diagnostic("S401", f"'{title}' has no parameter for its state", help="write f(du, u, ...) or "
                                    "f(t, u, ...), or name the parameters: rate=, state=, time="))
    return rate, state, time


def _checked(shape: Any) -> tuple[int, ...]:
    sizes = tuple(shape) if isinstance(shape, (tuple, list)) else (shape,)
    if not all(isinstance(n, (int, np.integer)) and not isinstance(n, bool) and n >= 0 for n in sizes):
        raise S2sadError(Diagnostic("S405", f"{shape!r} is no shape", help="give sizes: shape=u.shape"))
    return tuple(map(int, sizes))


def _in_an_array(f: Any, parameters: Sequence[str]) -> partial[Any]:
    """The kernel whose result is an array, also where f returns a list or a tuple of numbers."""
    names = Names(parameters)
    library, entry, inner, taken = (*map(names.fresh, ("np", "rate", "rate_of")), ", ".join(parameters))
    text = (f"import numpy as {library}\n\n\ndef {entry}({inner}, {taken}):\n"
            f"    return {library}.array({inner}({taken}))\n")
    return partial(getattr(load(text, entry), entry), f)
