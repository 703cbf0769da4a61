"""The Jacobian of one output with respect to one argument as a linear map: many directions in one call.

The derivative for many runs f and what it records once for all directions of a call; where there is none, or one
direction is asked for, it is the derivative for one that is called. Arguments are copied once, and what f writes is put
back before each call; shadows lie in memory that is lent from one call to the next.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.dispatch.cache import ProgramVersion
from s2sad.dispatch.executable import Executable, kind_of
from s2sad.infer.types import Type
from s2sad.interface.batch_calls import WIDTHS, width_for
from s2sad.interface.selection import RETURN, places
from s2sad.interface.value_calls import ForwardCall, PreparedCall, ReverseCall
from s2sad.jacobians.direction_arrays import Lanes, Lists, Memory, Single
from s2sad.jacobians.linear_maps import size
from s2sad.run.compiled import chosen

_FEWEST = 8         # directions at once: that a pattern and most of what is made by it share one derivative
_KEPT = 2 ** 26     # bytes of shadows that stay for the next call


class Products:
    """How a prepared call is given directions of one name, and what it has for them under another."""

    def __init__(self, call: PreparedCall, one: Executable, source: str, sink: str, width: int):
        self.call, self.source, self.sink = call, source, sink
        many = call.many(width) if width > 1 else None
        self.executable = one if many is None else many
        self.whole = many is not None
        self.layout: Lanes | Lists | Single = (
            Single() if many is None else Lists(width) if many.engine == "numpy" else Lanes(width))
        kinds = dict(zip(call.names, call.types))
        self._kind = call.results.types[0] if source == RETURN else kinds[source]
        self._dtype = np.dtype(self._kind.dtype if self._kind.is_array else float)
        self._own = not isinstance(call, ForwardCall) or source in call.summary.written

    def run(self, args: Sequence[Any], directions: Iterable[np.ndarray], shape: tuple[int, ...], memory: Memory
            ) -> Iterator[Any]:
        """What the derivative has for each array of directions."""
        call = self.call
        copies, theirs = call.private_copies(args, whole=self.whole), call.values_of(args)
        written = [(mine, value) for mine, value in zip(copies, theirs) if mine is not value]
        values = dict(zip(call.names, copies))
        for k, asked in enumerate(directions):
            for mine, value in written if k else ():
                np.copyto(mine, value)
            shadows = {n: self.layout.zeros(memory, n, values[n]) for n in self.executable.shadows if n != self.source}
            seeds = self._give(values, shadows, asked, shape, memory)
            yield self._read(shadows, call.call(self.executable, values, shadows, seeds))

    def _give(self, values: Mapping[str, Any], shadows: dict[str, Any], asked: np.ndarray, shape: tuple[int, ...],
              memory: Memory) -> list[Any]:
        """Puts directions among the shadows; the seeds of results."""
        given = self.layout.given(memory, self.source, asked, shape, self._dtype, self._own)
        if self.source != RETURN:
            if self.source in self.executable.shadows:
                shadows[self.source] = given
            return []
        if 0 in self.call.results.aliases:      # what is returned is an argument that is written
            shadows[self.call.results.aliases[0]] = given
            return []
        return [given for _ in places([p.primal for p in self.executable.seeds])]

    def _read(self, shadows: Mapping[str, Any], returned: tuple[Any, ...]) -> Any:
        call, names = self.call, self.executable.generated.returns
        if isinstance(call, ForwardCall):
            return shadows[self.sink] if self.sink != RETURN else call.outputs(shadows, returned, names)[RETURN]
        return shadows[self.sink] if self.sink in shadows else dict(zip(names, returned))[self.sink]


class PreparedJacobian:
    """The tangent and the adjoint of one output with respect to one argument, for arguments of known types."""

    def __init__(self, state: ProgramVersion, f: Any, args: Sequence[Any], wrt: str, of: str):
        self.wrt, self.of, self._f, self._args = wrt, of, f, tuple(args)
        self.forward = ForwardCall(state, f, self._args, (wrt,), (of,))
        self.engine = chosen(self.forward.engine)
        kinds = dict(zip(state.parameters, self.forward.types))
        self.output: Type = self.forward.results.types[0] if of == RETURN else kinds[of]
        held = self.forward.results.aliases.get(0) if of == RETURN else of
        self._held = None if held is None else state.parameters.index(held)
        self.place = state.parameters.index(wrt)
        self.dtype = np.result_type(*(k.dtype for k in (self.output, kinds[wrt])))
        self._ways: dict[tuple[bool, int], Products] = {}

    @cached_property
    def reverse(self) -> ReverseCall:
        return ReverseCall(self.forward.state, self._f, self._args, (self.of,), (self.wrt,))

    def products(self, width: int, transposed: bool) -> Products:
        """Those of so many directions at once, or of one where these are taken one by one."""
        key = transposed, width
        if key not in self._ways:
            self._ways[key] = (Products(self.reverse, self.reverse.rv, self.of, self.wrt, width) if transposed else
                               Products(self.forward, self.forward.fv, self.wrt, self.of, width))
        return self._ways[key]

    def shape(self, values: Sequence[Any]) -> tuple[int, ...] | None:
        """The shape of the output; None where only a run tells it."""
        return values[self._held].shape if self._held is not None else None if self.output.is_array else ()

    def value(self, args: Sequence[Any]) -> Any:
        """The output."""
        values = self.forward.private_copies(args)
        returned = self.forward.primal(dict(zip(self.forward.names, values)))
        found = returned[0] if self._held is None else values[self._held]
        return np.array(found) if self.output.is_array else kind_of(self.output)(found)


class JacobianMap:
    """The Jacobian where f is given these values; `batch` is how many directions are taken at once, None: by their
    number."""

    def __init__(self, prepared: PreparedJacobian, args: Sequence[Any], batch: int | None, memories: list[Memory]):
        self._prepared, self._args, self._batch, self._memories = prepared, args, batch, memories
        values = prepared.forward.values_of(args)
        self.taken, self.dtype, self.engine = np.shape(values[prepared.place]), prepared.dtype, prepared.engine
        self._given = prepared.shape(values)

    @property
    def given(self) -> tuple[int, ...]:
        if self._given is None:
            way = self._prepared.products(self.width(None), False)
            zeros = np.zeros((size(self.taken), way.layout.width))
            self._given = way.layout.shape(next(way.run(self._args, [zeros], self.taken, {})))
        return self._given

    def width(self, count: int | None, transposed: bool = False, measured: int | None = None) -> int:
        most = self._batch or measured or (1 if count == 1 else max(_FEWEST, width_for(count or 0)))
        if self.engine == "numpy" and count is not None:    # there any number will do
            most = min(most, max(count, 1))
        return self._prepared.products(most, transposed).layout.width

    def widths(self, count: int, transposed: bool = False) -> Sequence[int]:
        """Of those that take as many calls the smallest, from the one by count down to its half."""
        usual = self.width(count, transposed)
        if self._batch or self.engine == "numpy" or usual == 1:
            return ()
        calls = {-(-count // width): width for width in reversed(WIDTHS) if usual <= 2 * width <= 2 * usual}
        return sorted({usual, *calls.values()}, reverse=True)

    def value(self) -> Any:
        """The output itself."""
        return self._prepared.value(self._args)

    def products(self, directions: Iterable[np.ndarray], width: int, transposed: bool = False) -> Iterator[np.ndarray]:
        memory = self._lent_memory()
        way = self._prepared.products(width, transposed)
        try:
            for found in way.run(self._args, directions, self.given if transposed else self.taken, memory):
                yield way.layout.found(found)
        finally:
            if sum([a.nbytes for a in memory.values()]) <= _KEPT:
                self._memories.append(memory)

    def _lent_memory(self) -> Memory:
        try:
            return self._memories.pop()     # which threads share
        except IndexError:
            return {}
