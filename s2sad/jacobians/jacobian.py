"""Jacobians: of one output with respect to one argument, dense or sparse."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import describe
from s2sad.dispatch.cache import ProgramVersion
from s2sad.interface.selection import RETURN, ReturnedValues, Wrt, names_of, selected_of
from s2sad.interface.value_calls import selection_of
from s2sad.jacobians.compression_plan import Mode, Plan
from s2sad.jacobians.direction_arrays import Memory
from s2sad.jacobians.jacobian_map import JacobianMap, PreparedJacobian
from s2sad.jacobians.linear_maps import LinearMap
from s2sad.jacobians.matrix_drivers import FlatCall, MatrixDriver, only_one, real
from s2sad.run.tracebacks import public


@public
def jacobian(f: Callable[..., Any], wrt: Wrt = None, of: Wrt = None, *, mode: Mode = "auto", sparse: Any = False,
             format: str = "csr", check: bool = True, batch: int | Literal["auto"] = "auto", threads: int = 1
             ) -> Jacobian:
    """A function of f's arguments that returns the Jacobian of one output with respect to one argument.

    Args: f, a function, a differentiated function or a Numba dispatcher; wrt, a name or position of a parameter
    (default: the only float); of, the name of a written array or "return" (default: the only output); mode, by
    columns ("forward"), by rows ("reverse"), of a sparse one by "both", what is dense the one way and the rest the
    other, or what is cheapest ("auto": an adjoint counts as two tangents); sparse, True, a pattern (a SciPy matrix or
    an array that is not zero where the Jacobian may be) or a `Plan`; format, "csr", "csc" or "coo"; check, whether each
    sparse matrix is compared with the derivative for one more direction; batch, how many directions one call of the
    derivative takes, or "auto": 8, 12 or 16 by how many there are, and what is fastest of that and fewer once calls
    have taken as long as compiling; threads, how many share the directions, to the same result. A dense Jacobian has
    the shape of the output and then that of the argument; a sparse one has two axes, the elements of both in C order.
    Arguments are never changed; of structures wrt and of name a part, "state.u". Its `plan(*args)` is the pattern with
    its colours and the fastest widths.
    Raises S2sadError: S401 (wrt or of names nothing that has one, or several), S403 (a pattern that is too small), S405
    (a plan for other shapes, no SciPy, a mode, a batch or threads that are none); and what f raises. Literature:
    Gebremedhin, Manne and Pothen, What color is your Jacobian?, SIAM Review 47, 2005.

    >>> import numpy as np
    >>> def differences(du, u):
    ...     for i in range(1, u.size):
    ...         du[i] = u[i] ** 2 - u[i - 1]
    >>> J = jacobian(differences, wrt="u", of="du", sparse=True)
    >>> J(np.zeros(3), np.array([1.0, 2.0, 3.0])).toarray()
    array([[ 0.,  0.,  0.],
           [-1.,  4.,  0.],
           [ 0., -1.,  6.]])
    >>> J.plan(np.zeros(3), np.ones(3))
    <plan of a 3 x 3 matrix: 4 entries, 2 forward products>
    >>> jacobian(differences, wrt="u", of="du", batch=2)(np.zeros(3), np.array([1.0, 2.0, 3.0]))
    array([[ 0.,  0.,  0.],
           [-1.,  4.,  0.],
           [ 0., -1.,  6.]])
    """
    return Jacobian(f, wrt, of, mode, sparse, format, check, batch, threads)


@public
def value_and_jacobian(f: Callable[..., Any], wrt: Wrt = None, of: Wrt = None, *, mode: Mode = "auto",
                       sparse: Any = False, format: str = "csr", check: bool = True,
                       batch: int | Literal["auto"] = "auto", threads: int = 1) -> ValueAndJacobian:
    """As `jacobian`, but the function returns (value, Jacobian), as a step of Newton's method takes both.

    Args, errors and literature as for `jacobian`; the value is that of the one output: a new array, of a written one
    its content at the end, or a float.

    >>> import numpy as np
    >>> def differences(du, u):
    ...     for i in range(1, u.size):
    ...         du[i] = u[i] ** 2 - u[i - 1]
    >>> value, J = value_and_jacobian(differences, wrt="u", of="du")(np.zeros(3), np.array([1.0, 2.0, 3.0]))
    >>> value
    array([0., 3., 7.])
    >>> J
    array([[ 0.,  0.,  0.],
           [-1.,  4.,  0.],
           [ 0., -1.,  6.]])
    """
    return ValueAndJacobian(f, wrt, of, mode, sparse, format, check, batch, threads)


class Jacobian(MatrixDriver):
    """The Jacobian of f, as a function of f's arguments; see `jacobian`."""
    _what = "Jacobian"

    def __init__(self, f: Any, wrt: Wrt = None, of: Wrt = None, mode: Mode = "auto", sparse: Any = False,
                 format: str = "csr", check: bool = True, batch: int | Literal["auto"] = "auto", threads: int = 1):
        if mode not in ("auto", "forward", "reverse", "both"):
            raise S2sadError(Diagnostic("S405", f"there is no mode {mode!r}",
                                        help='"auto", "forward", "reverse" or "both"'))
        if mode == "both" and sparse is False:
            raise S2sadError(Diagnostic("S405", "a dense Jacobian is made by columns or by rows, not by both",
                                        help='mode="auto" takes what is cheaper; sparse=True takes both'))
        super().__init__(f, mode, sparse, format, check, threads)
        if isinstance(sparse, Plan) and sparse.mode == "symmetric":
            raise S2sadError(Diagnostic("S405", "the plan is for a symmetric matrix",
                                        help="make one for this Jacobian: J.plan(*args)"))
        if batch != "auto" and (isinstance(batch, bool) or not isinstance(batch, int) or batch < 1):
            raise S2sadError(Diagnostic("S405", f"there is no batch of {batch!r} directions",
                                        help='"auto", or how many at once: 1, 2, ...'))
        self._wrt, self._of, self._batch = names_of(wrt, f), names_of(of, f, "of"), batch
        self._memories: list[Memory] = []

    def decorator_arguments(self) -> tuple[Any, ...]:
        return (self.__wrapped__, self._wrt, self._of, self._mode, self._sparse, self._format, self._check,
                self._batch, self._threads)

    def linear_map(self, call: FlatCall) -> JacobianMap:
        key = ("jacobian", self._wrt, self._of, describe(call.args), selection_of(call.carrier))
        found = call.state.entries.get(key)
        if found is None:
            found = call.state.entries[key] = self._prepared(call)
        return JacobianMap(found, call.args, self._batch if isinstance(self._batch, int) else None, self._memories)

    def _prepared(self, call: FlatCall) -> PreparedJacobian:
        state, types = call.state, call.state.types(call.values())
        wrt = call.whole(only_one(state, types, call.wrt(self._wrt)))
        of = call.whole(_only_output(state, types, call.outputs(self._of)))
        made = PreparedJacobian(state, call.carrier, call.args, wrt, of)
        real(state.kernel.name, f"'{wrt}'", dict(zip(state.parameters, types))[wrt])
        return made


class ValueAndJacobian(Jacobian):
    """The output of f and its Jacobian, as a function of f's arguments; see `value_and_jacobian`."""
    _what = "value_and_Jacobian"

    def _found(self, of: LinearMap) -> Any:
        assert isinstance(of, JacobianMap)
        return of.value(), self._matrix(of)


def _only_output(state: ProgramVersion, types: Any, names: tuple[str, ...] | None) -> str:
    """The one output that is meant: it is named, or is the only one."""
    summary = state.summary(types)
    title, results = state.kernel.name, ReturnedValues.of(summary)
    found = names if names is not None else selected_of(title, state.parameters, types, summary, None)
    if len(found) != 1:
        said = f"of names {len(found)} outputs" if names is not None else (
            f"'{title}' has several outputs: {', '.join(found)}")
        raise S2sadError(Diagnostic("S401", said, help=f'a Jacobian is of one: of="{found[0] if found else "return"}"'))
    selected_of(title, state.parameters, types, summary, found)
    if found[0] == RETURN and len(results.types) > 1:
        raise S2sadError(Diagnostic("S401", f"'{title}' returns {len(results.types)} values",
                                    help="a Jacobian is of one: write a function that returns it"))
    kind = [*results.types][0] if found[0] == RETURN else dict(zip(state.parameters, types))[found[0]]
    real(title, f"'{found[0]}'", kind)
    return found[0]
