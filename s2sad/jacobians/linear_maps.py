"""Linear maps at one point: what a derivative does to one direction, of which a matrix is made column by column.

    J v     the tangent, with the arguments copied once and what f writes put back before each product
    w J     the adjoint
    H v     the adjoint of the tangent (`second_order`)
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from s2sad.interface.selection import RETURN
from s2sad.interface.value_calls import ForwardCall, ReverseCall


class LinearMap(Protocol):
    """A matrix that is known by its products; `taken` and `given` are the shapes that its columns and rows stand for,
    `dtype` that of its entries."""
    taken: tuple[int, ...]
    given: tuple[int, ...]
    dtype: np.dtype

    def product(self, direction: np.ndarray) -> np.ndarray:
        """The matrix times a vector, an array of its own."""
        ...

    def transposed_product(self, weights: np.ndarray) -> np.ndarray:
        """A vector times the matrix, an array of its own."""
        ...


def size(shape: Sequence[int]) -> int:
    """The number of elements."""
    return int(np.prod(shape, dtype=np.int64))


class JacobianMap:
    """The derivative of one output with respect to one argument, where f is given these values."""

    def __init__(self, forward: ForwardCall, reverse: Any, args: Sequence[Any], wrt: str, of: str):
        self._call, self._reverse, self._args, self.wrt, self.of = forward, reverse, args, wrt, of
        self._values = dict(zip(forward.names, forward.private_copies(args)))
        given = forward.values_of(args)
        self._written = [(self._values[forward.names[k]], np.array(given[k])) for k in forward.written]
        self._shadows = {name: np.zeros_like(self._values[name]) if isinstance(self._values[name], np.ndarray) else 0.0
                         for name in forward.fv.shadows}
        self._arrays = [s for s in self._shadows.values() if isinstance(s, np.ndarray)]
        self._arguments: list[Any] | None = None
        self.taken = np.shape(self._values[wrt])

    @cached_property
    def _output(self) -> Any:
        """The output for the direction zero: its shape and dtype are those of all."""
        output = self._values.get(self.of) if self.of != RETURN else self._run(np.zeros(size(self.taken)))
        return np.asarray(output)

    @cached_property
    def given(self) -> tuple[int, ...]:
        return self._output.shape

    @cached_property
    def dtype(self) -> np.dtype:
        return np.result_type(self._output, np.asarray(self._values[self.wrt]).dtype)

    def product(self, direction: np.ndarray) -> np.ndarray:
        return np.array(self._run(direction), dtype=self.dtype).reshape(-1)

    def _run(self, direction: np.ndarray) -> Any:
        for mine, theirs in self._written:
            np.copyto(mine, theirs)
        for shadow in self._arrays:
            shadow.fill(0.0)
        shadow = self._shadows[self.wrt]
        if isinstance(shadow, np.ndarray):
            shadow.reshape(-1)[...] = direction
            if self._arguments is not None:     # the same arrays as before: they were checked then
                return self._outputs(self._call.fv.run(self._arguments))
            if not self._call.state.private_outside_arrays(self._call.types):
                self._arguments = self._call.fv.assemble(self._values, self._shadows, (), {})
        else:
            self._shadows[self.wrt] = float(direction[0])
        return self._outputs(self._call.call(self._call.fv, self._values, self._shadows))

    def _outputs(self, returned: Sequence[Any]) -> Any:
        return self._shadows[self.of] if self.of != RETURN else self._call.outputs(self._shadows, returned)[self.of]

    @cached_property
    def _adjoint(self) -> ReverseCall:
        return self._reverse()

    def transposed_product(self, weights: np.ndarray) -> np.ndarray:
        seed = weights.astype(self._output.dtype).reshape(self.given)
        found = self._adjoint.vjp(self._args, {self.of: seed if self.given or self.of != RETURN else float(weights[0])})
        return np.array(found[self.wrt], dtype=self.dtype).reshape(-1)


def dense(of: LinearMap, mode: str) -> np.ndarray:
    """The whole matrix, rows by columns: by columns for "forward", by rows for "reverse"."""
    rows, columns = size(of.given), size(of.taken)
    forward = mode == "forward"
    made = np.empty((columns, rows) if forward else (rows, columns), of.dtype)
    multiply = of.product if forward else of.transposed_product
    direction = np.zeros(len(made))
    for k, line in enumerate(made):
        direction[k] = 1.0
        line[...] = multiply(direction)
        direction[k] = 0.0
    return np.ascontiguousarray(made.T) if forward else made
