"""Gradients and products with Jacobians as functions of values: no argument is ever changed."""
from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, NoReturn, ParamSpec, TypeVar

import numpy as np

from s2sad.dispatch.arguments import kernel_value, bind, describe, make_zero
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface import batch_calls
from s2sad.interface.comparison_backends import Backend, backend_of
from s2sad.interface.recording_arguments import Checkpoint, recording_of
from s2sad.interface.foreign_names import unexpected_keywords
from s2sad.interface.pytrees import Carrier, flat_drivers as with_structures, flatten
from s2sad.interface.pickling import Decorated
from s2sad.interface.value_calls import ForwardCall, ReverseCall, selection_of
from s2sad.program import Economy, TapeDtype
from s2sad.interface.selection import RETURN, Wrt, names_of
from s2sad.live_objects.unwrap import CalledDerivative, apply_functions
from s2sad.run.memory import Memory
from s2sad.run.tracebacks import public
from s2sad.dispatch.cache import ProgramVersion, derivatives_of

__all__ = ["gradient", "jvp", "make_zero", "value_and_gradient", "vjp"]


P = ParamSpec("P")
R = TypeVar("R", covariant=True)
_INTEGERS = (int, np.integer)


@public
def gradient(f: Callable[P, Any], wrt: Wrt = None, checkpoint: Checkpoint = None, memory: Economy | None = None,
             tape_dtype: TapeDtype | None = None, backend: Backend = "adjoint", **unknown: NoReturn) -> Gradient[P]:
    """A function of f's arguments that returns the gradient of the one float that f returns.

    Args: f, a function, a differentiated function or a Numba dispatcher; wrt, a name or position of a parameter, or
    several (default: all that are floats by f's text: annotation, default, use); checkpoint, the loops that keep
    snapshots in place of a tape, or a limit for the memory, memory and tape_dtype, as for `differentiate`; backend,
    "adjoint", or another way to compare it with, which runs f once for each number: "tangent", "finite" (differences,
    needs SciPy 1.15) or "complex" (the complex step, of a kernel that is analytic). The result
    is one array (of the argument's shape and dtype) or float for one of them, a dict by name for several; an integer
    that stands there for a float is one. Arguments are never changed, read-only arrays are fine, and nothing is changed
    when f raises. The gradient of a structure is one of the same make, what is no float as it was; names may mean
    parts: "p.k".
    Raises S2sadError: S401 (f does not return one float; wrt names nothing that is a float), S404 (a written argument
    shares memory with another), S405 (an argument of another type); and what f raises. Reverse mode: Griewank and
    Walther, Evaluating Derivatives, SIAM 2008.

    >>> import numpy as np
    >>> def norm(u):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += u[i] * u[i]
    ...     return total
    >>> gradient(norm)(np.array([1.0, 2.0]))
    array([2., 4.])
    """
    if unknown:
        raise unexpected_keywords("gradient", unknown)
    return Gradient(f, wrt, checkpoint, memory, tape_dtype, backend)


@public
def value_and_gradient(f: Callable[P, R], wrt: Wrt = None, checkpoint: Checkpoint = None, memory: Economy | None = None,
                       tape_dtype: TapeDtype | None = None, **unknown: NoReturn) -> ValueAndGradient[P, R]:
    """As `gradient`, but the function returns (value, gradient); `scipy.optimize.minimize(..., jac=True)` takes it.

    Args, errors and literature as for `gradient`; the value is f's float.

    >>> import numpy as np
    >>> def norm(u):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += u[i] * u[i]
    ...     return total
    >>> value_and_gradient(norm)(np.array([1.0, 2.0]))
    (5.0, array([2., 4.]))
    """
    if unknown:
        raise unexpected_keywords("value_and_gradient", unknown)
    return ValueAndGradient(f, wrt, checkpoint, memory, tape_dtype)


class _Driver(Decorated, CalledDerivative):
    """A function of f's arguments that can be pickled where f can; `_what` it gives."""
    _what = ""

    def __init__(self, f: Callable[..., Any], wrt: Wrt = None, checkpoint: Checkpoint = None,
                 memory: Economy | None = None, tape_dtype: TapeDtype | None = None, backend: Backend = "adjoint"):
        self._backend, self._way = backend, backend_of(backend)
        self._derivatives, self.names = derivatives_of(f), names_of(wrt, f)
        self._carrier = carrier_of(f, checkpoint, memory, tape_dtype)
        self.__wrapped__ = f
        name, self.__module__ = getattr(f, "__name__", "f"), getattr(f, "__module__", __name__)
        self.__name__ = self.__qualname__ = f"{self._what.replace(' ', '_')}_of_{name}"
        self.__doc__ = f"The {self._what} of '{name}'."

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self.names, selection_of(self._carrier).recording, None, None, self._backend

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        return self if instance is None else functools.partial(self, instance)

    def __repr__(self) -> str:
        return f"<{self._what} of {getattr(self.__wrapped__, '__name__', 'f')}>"

    @public
    def memory(self, *args: Any, **keywords: Any) -> Memory:
        """The memory that a call with these arguments takes, found before anything runs: see `Memory`."""
        entry, args = self._prepared(args, keywords)
        return entry.memory(args)

    def zeros(self, *args: Any) -> Any:
        """What a call with arguments of these types and shapes gives, of zeros; nothing is run."""
        entry, args = self._prepared(args, {})
        return self._chosen(0.0, entry.zeros(args))

    def _chosen(self, value: Any, found: Any) -> Any:
        """What is given of the value and the gradient."""
        raise NotImplementedError

    def _value_and_gradient(self, args: tuple[Any, ...], keywords: dict[str, Any]) -> tuple[Any, Any]:
        entry, args = self._prepared(args, keywords)
        return entry.value_and_gradient(args)


    def _prepared(self, args: tuple[Any, ...], keywords: dict[str, Any]
                  ) -> tuple[ReverseCall | with_structures.FlatGradient, tuple[Any, ...]]:
        """The prepared gradient for arguments of these types, and the arguments by position."""
        f, carrier, names = self.__wrapped__, self._carrier, self.names
        given, args, keywords = apply_functions(f, args, keywords)
        state = (self._derivatives if given is f else derivatives_of(given)).state()
        if keywords:
            args = tuple(bind(state.kernel, args, keywords))
        args = _with_floats(state, names if names is not None else selection_of(carrier).wrt, args)
        flattened = flatten(state, args)
        if flattened is not None:
            return with_structures.FlatGradient(flattened, carrier, names, self._way), tuple(bind(state.kernel, args))
        key = (self._way, names, describe(args), selection_of(carrier))
        entry = state.entries.get(key)
        if entry is None:
            entry = state.entries[key] = self._way(state, carrier, args, (RETURN,), names, with_value=True)
        return entry, args


class Gradient(_Driver, Generic[P]):
    """The gradient of f's float, as a function of f's arguments; see `gradient`."""
    _what = path = "gradient"

    @public
    def __call__(self, *args: P.args, **keywords: P.kwargs) -> Any:
        return self._value_and_gradient(args, keywords)[1]

    def _chosen(self, value: Any, found: Any) -> Any:
        return found


class ValueAndGradient(_Driver, Generic[P, R]):
    """f's float and its gradient, as a function of f's arguments; see `value_and_gradient`."""
    _what, path = "value and gradient", "value_and_gradient"

    @public
    def __call__(self, *args: P.args, **keywords: P.kwargs) -> tuple[R, Any]:
        return self._value_and_gradient(args, keywords)

    def _chosen(self, value: Any, found: Any) -> Any:
        return value, found


def _with_floats(state: ProgramVersion, names: tuple[str, ...] | None, args: tuple[Any, ...]) -> tuple[Any, ...]:
    """The arguments, with integers in place of floats, 2 for 2.0, as floats: those that a gradient is with respect
    to, so that what it returns depends on the kernel and not on how its arguments are spelled."""
    if names is None and state.depends_on_structure:
        return args
    found = state.entries.get(("floats", names))
    if found is None:
        wanted = state.kernel.independents if names is None else {*names}.intersection(state.kernel.floats)
        found = state.entries["floats", names] = [k for k, p in enumerate(state.parameters) if p in wanted]
    if found and found[-1] >= len(args):
        args = tuple(bind(state.kernel, args))
    odd = [k for k in found if isinstance(args[k], _INTEGERS) and not isinstance(args[k], bool)]
    return tuple([kernel_value(p, a, True) if k in odd else a for k, (p, a) in enumerate(zip(state.parameters, args))]
                 ) if odd else args


@public
def vjp(f: Callable[..., Any], args: Sequence[Any], seeds: Mapping[str, Any], wrt: Wrt = None,
        checkpoint: Checkpoint = None, memory: Economy | None = None, tape_dtype: TapeDtype | None = None, *,
        batch: bool = False) -> dict[str, Any]:
    """The gradients, by argument name, of the outputs weighted by `seeds`, at the arguments' entry values.

    Args: args, all of f's positional arguments; seeds by output name: a written argument's name (an array of its
    shape and dtype: weights of its final content) or "return" (a float, an array, or a tuple for a tuple result, with
    None for what is no float); wrt, as for `gradient` (default: every float argument). Gradients have the shape and
    dtype of their arguments, those of structures their make, as seeds have; `args` and `seeds` are never changed. With
    batch seeds have one more axis, the first, of k directions (a float's is an array of k), and so have gradients.
    Raises S2sadError: S401 (an unknown output or wrt), S403 (a seed that does not fit), S404, S405 as for `gradient`;
    and what f raises. A zero gradient because no output depends on the argument comes with an S2sadWarning.
    Literature as for `gradient`.

    >>> import numpy as np
    >>> def scale(u, c):
    ...     for i in range(u.size):
    ...         u[i] = c * u[i]
    >>> vjp(scale, (np.ones(2), 3.0), {"u": np.ones(2)})
    {'u': array([3., 3.]), 'c': 2.0}
    >>> vjp(scale, (np.ones(2), 3.0), {"u": np.eye(2)}, batch=True)["c"]
    array([1., 1.])
    """
    given, args, _ = apply_functions(f, _argument_tuple(args), {})
    state, names = derivatives_of(given).state(), names_of(wrt, given)
    carrier = carrier_of(f, checkpoint, memory, tape_dtype)
    flattened = flatten(state, args)
    if flattened is not None:
        _keys_of(seeds, "seeds")
        return with_structures.vjp(flattened, carrier, bind(state.kernel, args), seeds, names, batch)
    key = ("vjp", names, _keys_of(seeds, "seeds"), describe(args), selection_of(carrier))
    entry = state.entries.get(key)
    if entry is None:
        entry = state.entries[key] = ReverseCall(state, carrier, args, tuple(seeds), names)
    return batch_calls.vjp(entry, args, seeds) if batch else entry.vjp(args, seeds)


def carrier_of(f: Any, checkpoint: Checkpoint, memory: Economy | None, tape_dtype: TapeDtype | None) -> Any:
    """What has the selection of a function, with another recording if one is asked for."""
    if checkpoint is None and memory is None and tape_dtype is None:
        return f
    found = recording_of(checkpoint, memory, tape_dtype, selection_of(f).recording)
    return Carrier.with_overrides(f, None, None, None, found)


@public
def jvp(f: Callable[..., Any], args: Sequence[Any], tangents: Mapping[str, Any], of: Wrt = None, *,
        batch: bool = False) -> dict[str, Any]:
    """The tangents of f's outputs, by output name, for `tangents` of its arguments by name.

    Args: args, all of f's positional arguments; tangents, a float for a float, an array of the same shape and dtype
    for an array; of, output names (default: every written float array, and "return"). The tangent of a tuple result
    is a tuple, with None for what is no float. `args` and `tangents` are never changed. With batch tangents have one
    more axis, the first, of k directions (a float's is an array of k), and so have those of outputs.
    Raises S2sadError as `vjp` does. Forward mode: Griewank and Walther, Evaluating Derivatives, SIAM 2008.

    >>> import numpy as np
    >>> def scale(u, c):
    ...     for i in range(u.size):
    ...         u[i] = c * u[i]
    >>> jvp(scale, (np.ones(2), 3.0), {"c": 1.0})
    {'u': array([1., 1.])}
    >>> jvp(scale, (np.ones(2), 3.0), {"c": np.array([1.0, 2.0])}, batch=True)["u"]
    array([[1., 1.],
           [2., 2.]])
    """
    given, args, _ = apply_functions(f, _argument_tuple(args), {})
    state, names = derivatives_of(given).state(), names_of(of, given, "of")
    flattened = flatten(state, args)
    if flattened is not None:
        _keys_of(tangents, "tangents")
        return with_structures.jvp(flattened, f, bind(state.kernel, args), tangents, names, batch)
    key = ("jvp", names, _keys_of(tangents, "tangents"), describe(args), selection_of(f))
    entry = state.entries.get(key)
    if entry is None:
        entry = state.entries[key] = ForwardCall(state, f, args, tuple(tangents), names)
    return batch_calls.jvp(entry, args, tangents) if batch else entry.jvp(args, tangents)


def _argument_tuple(args: Any) -> tuple[Any, ...]:
    """The arguments of a call as a tuple; an array alone, whose elements these would be, is refused."""
    if isinstance(args, (tuple, list)):
        return tuple(args)
    raise S2sadError(Diagnostic("S405", f"args is of type {type(args).__name__}",
                                help="give a tuple of the function's arguments, as (u,)"))


def _keys_of(values: Any, what: str) -> tuple[str, ...]:
    """The names in `seeds` or `tangents`; what is no mapping is refused."""
    if type(values) is dict or isinstance(values, Mapping):     # asking an abstract class takes long
        return tuple(values)
    raise S2sadError(Diagnostic("S403", f"{what} is of type {type(values).__name__}",
                                help=f'give a dict by {"output" if what == "seeds" else "argument"} name'))
