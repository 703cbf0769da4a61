"""Gradients of a number that is computed of the solution of an equation, three ways.

    forward     sensitivities: S' = J S + df/dp beside u' = f, by as many tangents as there are numbers asked for
    adjoint     u' = f to the end, then l' = -l J and g' = -l df/dp back, along the interpolated solution; at each time
                that the loss reads l gains what it gives back
    discrete    the derivative of a method of Runge and Kutta with fixed steps, a kernel as any other

SciPy integrates the first two, within its tolerances; the third has the derivative of what it computes, to rounding.
(Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, Springer 1993, I.14 and II.1; Cao, Li, Petzold
and Serban, Adjoint sensitivity analysis for differential-algebraic equations, SIAM J. Sci. Comput. 24, 2003.)
"""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError, S2sadWarning
from s2sad.dispatch.arguments import misfit
from s2sad.extras import needed
from s2sad.interface.drivers import ValueAndGradient, jvp, vjp
from s2sad.interface.pickling import Decorated
from s2sad.interface.recording_arguments import Checkpoint
from s2sad.interface.selection import RETURN, Wrt, names_of
from s2sad.odes.fixed_steps import METHODS, NOT_CONVERGED, fixed_steps
from s2sad.odes.right_hand_side import Ode
from s2sad.run.tracebacks import public

Way = Literal["forward", "adjoint", "discrete"]
_WAYS = ("forward", "adjoint", "discrete")
_IMPLICIT = ("BDF", "Radau", "LSODA")


@public
def ode_gradient(f: Callable[..., Any], loss: Callable[[np.ndarray], float], wrt: Wrt = None, *, way: Way = "forward",
                 method: str | None = None, rtol: float = 1e-8, atol: float = 1e-10, steps: int | None = None,
                 snapshots: int | None = None) -> OdeGradient:
    """A function of (u, times, *args) that returns the loss of the solution of u' = f, and its gradient.

    Args: f, a right-hand side as for `ode`, or an `Ode`; loss, a function of the states at all times, an array of shape
    (number of times, *shape of u), that returns a float; wrt, names or positions of parameters of f, of its state for u
    at the first of the times (default: the state and all floats of args); way, "forward", "adjoint" or "discrete";
    method (default "RK45"), rtol and atol, for SciPy's `solve_ivp`; of the discrete way method is "RK4" (default), or,
    for stiff equations, "midpoint", "SDIRK2" or "SDIRK4", which solve for each stage by Newton's method; steps, of it,
    between one time and the next, and snapshots, how many states it keeps in place of a tape. u is an array of floats
    of any shape, times are increasing, at least two; args are floats and arrays of floats, or others that wrt does not
    name. Nothing is changed. The gradient is an array or a float for one name, a dict by name for several.
    Raises S2sadError: S401 (wrt names what is no float), S403 (times or u that do not fit), S405 (no such way or
    method, no steps, no SciPy), S502 (the integrator or Newton's method failed, with its message; there is no gradient
    then); and what f and loss raise. Literature: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
    Springer 1993; Hairer and Wanner, the same II, Springer 1996.

    >>> import numpy as np
    >>> def decay(du, u, k):
    ...     for i in range(u.size):
    ...         du[i] = -k * u[i]
    >>> def last(us):
    ...     return us[-1, 0]
    >>> value, by_name = ode_gradient(decay, last)(np.array([2.0]), np.array([0.0, 1.0]), 0.5)
    >>> np.allclose(value, 2.0 * np.exp(-0.5)), np.allclose(by_name["k"], -2.0 * np.exp(-0.5), rtol=1e-6)
    (True, True)
    """
    return OdeGradient(f, loss, wrt, way, method, rtol, atol, steps, snapshots)


class OdeGradient(Decorated):
    """The loss of the solution of an equation, and its gradient; see `ode_gradient`."""

    def __init__(self, f: Any, loss: Any, wrt: Wrt = None, way: Way = "forward", method: str | None = None,
                 rtol: float = 1e-8, atol: float = 1e-10, steps: int | None = None, snapshots: int | None = None):
        if way not in _WAYS:
            raise S2sadError(Diagnostic("S405", f"there is no way {way!r}", help='"forward", "adjoint" or "discrete"'))
        if way == "discrete" and (isinstance(steps, bool) or not isinstance(steps, int) or steps < 1):
            raise S2sadError(Diagnostic("S405", f"the discrete way takes fixed steps, and there are {steps!r}",
                                        help="give how many there are between one time and the next: steps=100"))
        if way == "discrete" and method not in (None, *METHODS):
            raise S2sadError(Diagnostic("S405", f"the discrete way has no method {method!r}",
                                        help=f"it has {', '.join(METHODS)}"))
        self.__wrapped__, self._loss, self._way = f, loss, way
        self._options = method, rtol, atol, steps, snapshots
        self._rhs = f if isinstance(f, Ode) else Ode(f)
        self._title = getattr(self._rhs.__wrapped__, "__name__", "f")
        self._wrt = names_of(wrt, self._rhs.__wrapped__)
        self._wrt = self._wrt if self._wrt is None else tuple(dict.fromkeys(self._wrt))
        for name in self._wrt or ():
            if name not in (self._rhs.state, *self._rhs.others):
                raise S2sadError(Diagnostic(
                    "S401", f"wrt names '{name}', neither the state of '{self._title}' nor among its arguments",
                    help=f"these are {', '.join((self._rhs.state, *self._rhs.others))}"))
        self._of_loss = ValueAndGradient(loss, 0)
        self._kernels: dict[int, tuple[Any, str, str]] = {}     # of fixed steps, by the axes of the state
        self.__name__ = self.__qualname__ = f"ode_gradient_of_{self._title}"
        self.__module__ = getattr(f, "__module__", __name__)

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self._loss, self._wrt, self._way, *self._options

    def __repr__(self) -> str:
        return f"<loss and gradient of {self._title}, {self._way}>"

    @public
    def __call__(self, u: Any, times: Any, *args: Any) -> tuple[float, Any]:
        state, at = self._checked(u, times)
        same = self._rhs
        rhs = Ode(same.__wrapped__, same.rate, same.state, same.time, state.shape, *same.jac_options)
        bound = dict(zip(rhs.parameters, rhs.values(at[0], state, args)))
        given = {n: bound[n] for n in rhs.others}
        names = self._names(given)
        given.update({n: np.array(given[n], float) if np.ndim(given[n]) else float(given[n]) for n in names
                      if n != rhs.state})
        value, found = getattr(self, f"_{self._way}")(_Problem(rhs, state, at, given, names))
        return value, found[names[0]] if len(names) == 1 else found

    def _checked(self, u: Any, times: Any) -> tuple[np.ndarray, np.ndarray]:
        state, at = np.array(u), np.array(times)
        if state.dtype.kind not in "iuf" or not state.ndim or not state.size or not np.all(np.isfinite(state)):
            what = "" if state.dtype.kind != "f" or np.all(np.isfinite(state)) else ", which are not finite"
            raise misfit(f"the state is an array of {state.dtype} of shape {state.shape}{what}",
                         "give an array of floats, at least one")
        if at.ndim != 1 or at.dtype.kind not in "iuf" or len(at) < 2 or not np.all(np.diff(at) > 0.0):
            raise misfit("the times are no increasing array of two floats or more", "give the first one, at which u is "
                         "the state, and those that the loss reads: np.linspace(0.0, 1.0, 11)")
        return state.astype(float), at.astype(float)

    def _names(self, given: Mapping[str, Any]) -> tuple[str, ...]:
        """With respect to what the gradient is."""
        floats = [n for n, v in given.items() if isinstance(v, (float, np.floating)) or (
            isinstance(v, np.ndarray) and v.dtype.kind == "f")]
        if self._wrt is None:
            return (self._rhs.state, *floats)
        for name in self._wrt:
            integer = isinstance(given.get(name), (int, np.integer)) and not isinstance(given[name], bool)
            if name != self._rhs.state and name not in floats and not integer:
                raise S2sadError(Diagnostic("S401", f"wrt names '{name}' of '{self._title}', which is neither a float "
                                            "nor an array of floats", help="give one, or leave it out of wrt"))
        return self._wrt

    def _integrated(self, fun: Callable[..., Any], span: tuple[float, float], start: np.ndarray, **more: Any) -> Any:
        """SciPy's solution; raises S2sadError (S502) where it fails."""
        integrate = needed("scipy.integrate", f'way="{self._way}"', 'take way="discrete"')
        method, rtol, atol = self._options[0] or "RK45", *self._options[1:3]
        if method not in _IMPLICIT:
            more.pop("jac", None)
        if not np.all(np.isfinite(fun(span[0], start))):        # with such a rate SciPy's steps would have no end
            raise self._failed(span[0], "the rate is not finite")
        found = integrate.solve_ivp(fun, span, start, method=method, rtol=rtol, atol=atol, **more)
        if not found.success:
            raise self._failed(found.t[-1] if len(found.t) else span[0], found.message)
        return found

    def _failed(self, t: float, why: str) -> S2sadError:
        return S2sadError(Diagnostic("S502", f"the integration of '{self._title}' failed after t = {t:.6g}: {why}",
                                     help="take another method, or other tolerances; there is no gradient"))

    def _forward(self, p: _Problem) -> tuple[float, dict[str, Any]]:
        size, start = p.state.size, p.units(p.rhs.state)
        count = len(start)

        def fun(t: float, y: np.ndarray) -> np.ndarray:
            u, tangents = y[:size], y[size:].reshape(count, *p.state.shape)
            along = {**{n: p.units(n) for n in p.names if n != p.rhs.state}, p.rhs.state: tangents}
            of = p.rhs.rate or RETURN
            dots = jvp(p.rhs.kernel, p.values(t, u), along, of=(of,), batch=True)[of]
            return np.concatenate([p.rate(t, u), dots.reshape(-1)])
        found = self._integrated(fun, (p.times[0], p.times[-1]), np.concatenate([p.state.reshape(-1),
                                                                                start.reshape(-1)]), t_eval=p.times)
        us, tangents = found.y[:size].T.reshape(-1, *p.state.shape), found.y[size:].T.reshape(-1, count, size)
        value, bars = self._of_loss(us)
        return value, p.parted(np.einsum("ti,tki->k", bars.reshape(len(p.times), size), tangents))

    def _adjoint(self, p: _Problem) -> tuple[float, dict[str, Any]]:
        size = p.state.size
        there = self._integrated(p.rate, (p.times[0], p.times[-1]), p.state.reshape(-1), t_eval=p.times,
                                 dense_output=True, jac=p.jac)
        value, bars = self._of_loss(np.ascontiguousarray(there.y.T).reshape(-1, *p.state.shape))
        others = [n for n in p.names if n != p.rhs.state]

        def fun(t: float, y: np.ndarray) -> np.ndarray:
            of = p.rhs.rate or RETURN
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", S2sadWarning)       # a rate may well depend on no parameter
                found = vjp(p.rhs.kernel, p.values(t, there.sol(t)), {of: y[:size].reshape(p.state.shape).copy()},
                            wrt=(p.rhs.state, *others))
            return -np.concatenate([np.ravel(found[n]) for n in (p.rhs.state, *others)])
        made = np.zeros(size + sum(np.size(p.given[n]) for n in others))
        for k in range(len(p.times) - 1, 0, -1):
            made[:size] += bars[k].reshape(-1)
            made = self._integrated(fun, (p.times[k], p.times[k - 1]), made).y[:, -1].copy()
        made[:size] += bars[0].reshape(-1)
        ends = np.cumsum([size, *(np.size(p.given[n]) for n in others)])
        parts = dict(zip((p.rhs.state, *others), np.split(made, ends[:-1])))
        return value, p.parted(np.concatenate([parts[n] for n in p.names]))

    def _discrete(self, p: _Problem) -> tuple[float, dict[str, Any]]:
        steps, snapshots = self._options[3:]
        method = METHODS[self._options[0] or "RK4"]
        if p.state.ndim not in self._kernels:
            self._kernels[p.state.ndim] = fixed_steps(p.rhs, self._loss, p.state.ndim, method)
        kernel, counter, state = self._kernels[p.state.ndim]
        checkpoint: Checkpoint = None if snapshots is None else {counter: snapshots}
        ask = ValueAndGradient(kernel, tuple(state if n == p.rhs.state else n for n in p.names), checkpoint)
        try:
            value, found = ask(p.state, p.times, steps, *method.arrays(), *p.given.values())
        except ArithmeticError as error:
            if str(error) != NOT_CONVERGED:
                raise
            raise S2sadError(Diagnostic(
                "S502", f"{NOT_CONVERGED} for a stage of '{self._title}'",
                help="take more steps, or see whether the rate is finite; there is no gradient")) from None
        found = found if isinstance(found, dict) else {(state if p.names[0] == p.rhs.state else p.names[0]): found}
        return value, {n: found[state if n == p.rhs.state else n] for n in p.names}


class _Problem:
    """An equation with its state at the first time and its arguments; `names` is what is asked for."""

    def __init__(self, rhs: Ode, state: np.ndarray, times: np.ndarray, given: Mapping[str, Any], names: Sequence[str]):
        self.rhs, self.state, self.times, self.given, self.names = rhs, state, times, given, names
        self._sizes = [np.size(state if n == rhs.state else given[n]) for n in names]

    def values(self, t: float, u: np.ndarray) -> list[Any]:
        return self.rhs.values(t, u, tuple(self.given.values()))

    def rate(self, t: float, u: np.ndarray) -> np.ndarray:
        return self.rhs(t, u, *self.given.values())

    def jac(self, t: float, u: np.ndarray) -> Any:
        return self.rhs.jac(t, u, *self.given.values())

    def units(self, name: str) -> np.ndarray:
        """How a value changes at first with each of the numbers asked for."""
        shape = np.shape(self.state if name == self.rhs.state else self.given[name])
        made = np.zeros((sum(self._sizes), int(np.prod(shape, dtype=int))))
        if name in self.names:
            first = sum(self._sizes[:list(self.names).index(name)])
            made[first:first + made.shape[1]] = np.eye(made.shape[1])
        return made.reshape(-1, *shape)

    def parted(self, found: np.ndarray) -> dict[str, Any]:
        """The gradients by name, of the numbers asked for in their order."""
        made = {}
        for name, part in zip(self.names, np.split(found, np.cumsum(self._sizes)[:-1])):
            shape = np.shape(self.state if name == self.rhs.state else self.given[name])
            made[name] = part.reshape(shape).copy() if shape else float(part[0])
        return made
