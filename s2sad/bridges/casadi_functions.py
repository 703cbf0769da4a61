"""Kernels as functions of CasADi's, with sparse Jacobians; CasADi's matrices go by columns, NumPy's arrays by rows."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from s2sad.bridges.bridged_kernel import BridgedKernel
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import bind, kernel_value
from s2sad.dispatch.cache import derivatives_of
from s2sad.extras import needed
from s2sad.interface.selection import RETURN, Wrt, names_of
from s2sad.jacobians.jacobian import jacobian
from s2sad.jacobians.linear_maps import size
from s2sad.jacobians.matrix_drivers import real
from s2sad.run.tracebacks import public


@public
def casadi(f: Callable[..., Any], args: Sequence[Any], wrt: Wrt = None, of: Wrt = None) -> Any:
    """f as a function of CasADi's, a `casadi.Callback`, for arguments of the shapes of these.

    Args: f, a function, a differentiated function or a Numba dispatcher; args, all of f's positional arguments, whose
    values stay for what is not in wrt; wrt, names or positions of the parameters that are CasADi's inputs, in the order
    of f's parameters (default: all floats); of, its outputs, names of written arrays and "return" (default: all of
    them). Vectors are columns, numbers 1 x 1. Its Jacobians are sparse, with the patterns that are found for args. Keep
    the function for as long as CasADi uses it.
    Raises S2sadError: S401 (names that are none, several results, complex numbers), S405 (arrays of more than two axes,
    no CasADi); CasADi's RuntimeError has the text of what f raises, and of S403 where data change a pattern. Andersson
    and others, CasADi, Math. Prog. Comp. 11, 2019.

    >>> import casadi, s2sad
    >>> import numpy as np
    >>> def differences(du, u):
    ...     for i in range(1, u.size):
    ...         du[i] = u[i] ** 2 - u[i - 1]
    >>> k = s2sad.casadi(differences, (np.zeros(3), np.ones(3)), wrt="u", of="du")
    >>> x = casadi.MX.sym("x", 3)
    >>> casadi.Function("J", [x], [casadi.jacobian(k(x), x)])([1.0, 2.0, 3.0]).full()
    array([[ 0.,  0.,  0.],
           [-1.,  4.,  0.],
           [ 0., -1.,  6.]])
    """
    made = _classes()[0](f, args, names_of(wrt, f), names_of(of, f, "of"))
    made.construct(getattr(f, "__name__", "f"), {})
    return made


class _Shape:
    """An input or an output: its shape in NumPy, its name, and how its elements lie in CasADi's order."""

    def __init__(self, name: str, shape: tuple[int, ...], kernel: str):
        if len(shape) > 2:
            raise S2sadError(Diagnostic("S405", f"'{name}' of '{kernel}' has {len(shape)} axes, and a matrix of "
                                        "CasADi's has two", help="write a function that takes it with two, and "
                                        "reshapes it"))
        self.name, self.shape, self.rows = name, shape, (*shape, 1, 1)[:2]
        self.order = np.arange(size(shape)).reshape(self.rows).ravel(order="F")


class _Block:
    """The Jacobian of an output with respect to an input: its pattern in CasADi's order, and where its entries stand
    among s2sad's."""

    def __init__(self, f: Any, values: Sequence[Any], given: _Shape, made: _Shape):
        plan = jacobian(f, given.name, made.name, sparse=True).plan(*values)
        self.of = jacobian(f, given.name, made.name, sparse=plan)
        numbered = plan.matrix(np.arange(1.0, len(plan.indices) + 1.0))[made.order][:, given.order].tocsc()
        numbered.sort_indices()
        self.places = numbered.data.astype(np.int64) - 1
        self.pattern = needed("casadi", "s2sad.casadi").Sparsity(
            *plan.shape, numbered.indptr.tolist(), numbered.indices.tolist())

    def matrix(self, values: Sequence[Any]) -> Any:
        return needed("casadi", "s2sad.casadi").DM(self.pattern, self.of(*values).data[self.places])


@cache
def _classes() -> tuple[Any, Any]:
    """The two classes of callbacks: a kernel and its Jacobians."""
    library = needed("casadi", "s2sad.casadi")

    class Kernel(library.Callback):
        def __init__(self, f: Any, args: Sequence[Any], wrt: Any, of: Any):
            super().__init__()
            state = derivatives_of(f).state()
            self.values = [kernel_value(n, v, n in state.floats or n in (wrt or ())) for n, v in zip(
                state.parameters, bind(state.kernel, args))]
            kernel = self.kernel = BridgedKernel(state, f, self.values, wrt, of)
            self.places = [state.parameters.index(n) for n in kernel.wrt]
            self.given = [_Shape(n, np.shape(self.values[k]), kernel.name) for n, k in zip(kernel.wrt, self.places)]
            if kernel.of.count(RETURN) and len(kernel.prepared.results.types) > 1:
                raise S2sadError(Diagnostic("S401", f"'{kernel.name}' returns several values", help="write a function "
                                            "that returns the one that is meant, or name what it writes: of=..."))
            for name, kind in [*((n, kernel.types[k]) for n, k in zip(kernel.wrt, self.places)),
                               *((o.name, o.type) for o in kernel.outputs)]:
                real(kernel.name, f"'{name}'", kind)
            self.made = [_Shape(o.name, np.shape(v), kernel.name)
                         for o, v in zip(kernel.outputs, kernel.primal(self.values))]
            self.blocks = [[_Block(f, self.values, g, m) for g in self.given] for m in self.made]
            self.jacobians: list[Any] = []      # CasADi does not keep them

        def arguments(self, inputs: Sequence[Any]) -> list[Any]:
            values = list(self.values)
            for place, one, value in zip(self.places, self.given, inputs):
                dense = np.array(value.full())
                values[place] = dense.reshape(one.shape).astype(self.values[place].dtype) if one.shape else float(
                    dense[0, 0])
            return values

        def get_n_in(self) -> int:
            return len(self.given)

        def get_n_out(self) -> int:
            return len(self.made)

        def get_name_in(self, k: int) -> str:
            return self.given[k].name

        def get_name_out(self, k: int) -> str:
            return f"{self.made[k].name}_out"

        def get_sparsity_in(self, k: int) -> Any:
            return library.Sparsity.dense(*self.given[k].rows)

        def get_sparsity_out(self, k: int) -> Any:
            return library.Sparsity.dense(*self.made[k].rows)

        def eval(self, inputs: Sequence[Any]) -> list[Any]:
            found = self.kernel.primal(self.arguments(inputs))
            return [library.DM(np.asarray(v, float).reshape(one.rows)) for v, one in zip(found, self.made)]

        def has_jacobian(self, *_: Any) -> bool:
            return True

        def has_jac_sparsity(self, made: int, given: int) -> bool:
            return True

        def get_jac_sparsity(self, made: int, given: int, symmetric: bool) -> Any:
            return self.blocks[made][given].pattern

        def get_jacobian(self, name: str, names_in: Sequence[str], names_out: Sequence[str], options: Any) -> Any:
            made = Jacobian(self, names_in, names_out)
            made.construct(name, options)
            self.jacobians.append(made)
            return made

    class Jacobian(library.Callback):
        def __init__(self, of: Kernel, names_in: Sequence[str], names_out: Sequence[str]):
            super().__init__()
            self.of, self.names_in, self.names_out = of, list(names_in), list(names_out)
            self.blocks = [block for row in of.blocks for block in row]

        def get_n_in(self) -> int:
            return len(self.names_in)

        def get_n_out(self) -> int:
            return len(self.names_out)

        def get_name_in(self, k: int) -> str:
            return self.names_in[k]

        def get_name_out(self, k: int) -> str:
            return self.names_out[k]

        def get_sparsity_in(self, k: int) -> Any:
            return library.Sparsity.dense(*[*self.of.given, *self.of.made][k].rows)

        def get_sparsity_out(self, k: int) -> Any:
            return self.blocks[k].pattern

        def eval(self, inputs: Sequence[Any]) -> list[Any]:
            values = self.of.arguments(inputs)
            return [block.matrix(values) for block in self.blocks]
    return Kernel, Jacobian
