"""Second derivatives: the adjoint of the tangent, whose text is read as any function is.

    def energy_tangent(u, u_dot):           its one result is the gradient times u_dot,
        ...                                 so that its gradient with respect to u
        return (s_dot,)                     is the Hessian times u_dot
"""
from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import misfit
from s2sad.dispatch.cache import ProgramVersion, derivatives_of, private_copy
from s2sad.dispatch.deferred import compiler
from s2sad.interface.pytrees import Carrier
from s2sad.interface.pytrees.flat_drivers import flat_tangents
from s2sad.interface.selection import RETURN, Wrt, names_of, selected_wrt, uncopied
from s2sad.interface.value_calls import ForwardCall, ReverseCall, selection_of
from s2sad.jacobians.matrix_drivers import FlatCall, MatrixDriver, only_one, real
from s2sad.program import Request
from s2sad.run.compiled import chosen
from s2sad.run.module_loader import load
from s2sad.run.tracebacks import public


@public
def hvp(f: Callable[..., Any], args: Sequence[Any], directions: Mapping[str, Any], wrt: Wrt = None) -> Any:
    """The Hessian of the one float that f returns times a direction: how its gradient changes along it.

    Args: args, all of f's positional arguments; directions, by argument name, a float for a float, an array of the same
    shape and dtype for an array (or of integers, for float64); wrt, the arguments whose gradients these are (default:
    those of the directions). Names may mean parts of structures, "p.k", or whole ones, whose directions and results are
    of the same make. The result is an array or float for one of them, a dict by name for several. Arguments are never
    changed.
    Raises S2sadError: S401 (f does not return one float; a name that is none of a float), S403 (a direction that does
    not fit); and what f raises. Adjoint of the tangent: Griewank and Walther, Evaluating
    Derivatives, SIAM 2008, chapter 5.

    >>> import numpy as np
    >>> def cubes(u):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += u[i] ** 3
    ...     return total
    >>> hvp(cubes, (np.array([1.0, 2.0]),), {"u": np.array([1.0, 1.0])})
    array([ 6., 12.])
    """
    if not isinstance(directions, Mapping) or not directions:
        raise misfit("directions holds none", 'give a dict by argument name: {"x": v}')
    call, asked = FlatCall.of(f, args, {}), names_of(wrt, f) or tuple(directions)
    with call.user_paths():
        made = _of_structures if call.structures is not None else _of_arguments
        found = made(call, {name: _as_floats(along) for name, along in directions.items()}, asked)
    return found[asked[0]] if len(asked) == 1 else {name: found[name] for name in asked}


def _of_arguments(call: FlatCall, directions: Mapping[str, Any], asked: tuple[str, ...]) -> dict[str, Any]:
    values = call.values()
    return _second(call.state, call.carrier, values, tuple(directions), asked)(values, directions)


def _of_structures(call: FlatCall, directions: Mapping[str, Any], asked: tuple[str, ...]) -> dict[str, Any]:
    """The same where arguments are structures: names are parts of them, and what is found has their make."""
    structures, values = call.structures, call.values()
    assert structures is not None
    flat = flat_tangents(structures, directions, values, "directions")
    paths = structures.selected_paths(asked, "wrt")
    wrt = structures.flat_names(paths, "wrt")
    found = _second(call.state, call.carrier, values, tuple(flat), wrt)(values, flat)
    return {path[0]: structures.with_floats(path, call.given, found) for path in paths}


def _as_floats(direction: Any) -> Any:
    """A direction of integers as one of floats: SciPy's optimizers ask for a product with zeros of int8 first."""
    integers = isinstance(direction, np.ndarray) and direction.dtype.kind in "iu"
    return direction.astype(float) if integers else direction


class _SecondOrderCall:
    """A prepared product with the Hessian: directions of some arguments, gradients with respect to some."""

    def __init__(self, state: ProgramVersion, f: Any, values: Sequence[Any], along: tuple[str, ...],
                 wrt: tuple[str, ...]):
        self.first = ForwardCall(state, f, tuple(values), along, (RETURN,))
        name, results = state.kernel.name, self.first.results
        if len(results.types) != 1 or results.types[0].is_array or not results.types[0].is_float:
            described = ", ".join(map(str, results.types)) or "nothing"
            raise S2sadError(Diagnostic(
                "S401", f"second derivatives are of a function that returns one float; '{name}' returns {described}",
                help="write one that returns the float that is meant"))
        kinds = dict(zip(state.parameters, self.first.types))
        for one in selected_wrt(name, state.parameters, self.first.types, (*along, *wrt)):
            real(name, f"'{one}'", kinds[one])
        engine = chosen(selection_of(f).engine)
        made = compiler().derived(state.program, Request(
            "tangent", self.first.types, self.first.wrt, (RETURN,), engine=engine), {})
        tangent = getattr(load(_with_one_result(made.text, made.entry), made.entry), made.entry)
        self._parameters, self._wrt = made.parameters, wrt
        self._state = derivatives_of(tangent).state()
        carrier = Carrier.with_overrides(f, None, None, None, selection_of(f).recording)
        given = self._arguments(values, {n: v for n, v in zip(state.parameters, values) if n in along})
        self._call = ReverseCall(self._state, carrier, given, (RETURN,), wrt)

    def _arguments(self, values: Sequence[Any], directions: Mapping[str, Any]) -> tuple[Any, ...]:
        by_name, shadows = self.first.bind_values(values, directions, _copied)
        hidden = self.first.state.private_outside_arrays(self.first.types)
        return tuple([shadows[p.primal] if p.role == "shadow" else hidden.get(p.name, by_name.get(p.name))
                      for p in self._parameters])

    def __call__(self, values: Sequence[Any], directions: Mapping[str, Any]) -> dict[str, Any]:
        found = self._call.run(self._arguments(values, directions), {RETURN: 1.0})
        return self._call.by_argument(*found)       # a Hessian may well be zero, which is no reason to warn


def _copied(place: Any, array: np.ndarray) -> np.ndarray:
    """An argument as it is, for the adjoint copies what it writes; a copy of a direction, which may be an argument."""
    return uncopied(place, array) if place[0] == "value" else private_copy(array)


def _with_one_result(text: str, entry: str) -> str:
    """The text of a tangent, which returns a tuple of one, returning that one."""
    module = ast.parse(text)
    function = next(s for s in module.body if isinstance(s, ast.FunctionDef) and s.name == entry)
    for node in ast.walk(function):
        if isinstance(node, ast.Return) and isinstance(node.value, ast.Tuple):
            node.value, = node.value.elts
    return ast.unparse(module)


def _second(state: ProgramVersion, f: Any, values: Sequence[Any], along: tuple[str, ...], wrt: tuple[str, ...]
            ) -> _SecondOrderCall:
    key = ("second order", along, wrt, state.types(values), selection_of(f))
    found = state.entries.get(key)
    if found is None:
        found = state.entries[key] = _SecondOrderCall(state, f, values, along, wrt)
    return found


class HessianMap:
    """The Hessian of f with respect to one argument, where f is given these values."""

    def __init__(self, call: _SecondOrderCall, values: Sequence[Any], wrt: str, place: int):
        self._call, self._values, self._wrt = call, values, wrt
        self.taken = self.given = np.shape(values[place])
        self.dtype = np.asarray(values[place]).dtype
        self.engine = chosen(call.first.engine)

    def width(self, count: int | None, transposed: bool = False, measured: int | None = None) -> int:
        return 1        # what f computes depends on the direction

    def widths(self, count: int, transposed: bool = False) -> Sequence[int]:
        return ()

    def products(self, directions: Iterable[np.ndarray], width: int, transposed: bool = False) -> Iterator[np.ndarray]:
        for asked in directions:
            along = asked.astype(self.dtype).reshape(self.taken) if self.taken else float(asked[0, 0])
            yield np.array(self._call(self._values, {self._wrt: along})[self._wrt], self.dtype).reshape(-1, 1)


@public
def hessian(f: Callable[..., Any], wrt: Wrt = None, *, sparse: Any = False, format: str = "csr", check: bool = True,
            threads: int = 1) -> Hessian:
    """A function of f's arguments that returns the Hessian of the one float that f returns.

    Args: wrt, a name or position of a parameter (default: the only float); sparse, format, check and threads as for
    `jacobian`. A dense Hessian has the shape of the argument twice, a sparse one two axes, and the same on both sides
    of the diagonal: a star colouring says which product tells an entry. Arguments are never changed.
    Raises S2sadError as `hvp` and `jacobian` do. Literature as for these.

    >>> import numpy as np
    >>> def products(u):
    ...     total = 0.0
    ...     for i in range(1, u.size):
    ...         total += u[i - 1] * u[i] ** 2
    ...     return total
    >>> hessian(products)(np.array([1.0, 2.0, 3.0]))
    array([[0., 4., 0.],
           [4., 2., 6.],
           [0., 6., 4.]])
    """
    return Hessian(f, wrt, sparse, format, check, threads)


class Hessian(MatrixDriver):
    """The Hessian of f's float, as a function of f's arguments; see `hessian`."""
    _what = "Hessian"

    def __init__(self, f: Any, wrt: Wrt = None, sparse: Any = False, format: str = "csr", check: bool = True,
                 threads: int = 1):
        super().__init__(f, "symmetric", sparse, format, check, threads)
        self._wrt = names_of(wrt, f)

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self._wrt, self._sparse, self._format, self._check, self._threads

    def linear_map(self, call: FlatCall) -> HessianMap:
        state, values = call.state, call.values()
        wrt = call.whole(only_one(state, state.types(values), call.wrt(self._wrt)))
        second = _second(state, call.carrier, values, (wrt,), (wrt,))
        return HessianMap(second, values, wrt, state.parameters.index(wrt))
