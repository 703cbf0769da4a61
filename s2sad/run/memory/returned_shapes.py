"""The shapes of what a generated function returns, found before it runs."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from s2sad.program import Generated
from s2sad.run.memory.abstract_arrays import Array
from s2sad.run.memory.footprint import given_argument, parsed
from s2sad.run.memory.memory_interpreter import MemoryInterpreter

Shape = tuple[int, ...] | None


def returned_shapes(generated: Generated, values: Mapping[str, Any]) -> tuple[Shape, ...]:
    """The shape of each result for values of the kernel's parameters by name, () for a number, None for what data
    decide; nothing is run. Of a value that is not known any object may stand there."""
    functions, constants = parsed(generated.text)
    run = MemoryInterpreter(functions, constants, {}, {})
    returned = run.call(generated.entry, [given_argument(p, values, ()) for p in generated.parameters])
    return tuple(map(_shape, returned if isinstance(returned, tuple) else (returned,)))


def _shape(result: Any) -> Shape:
    if not isinstance(result, Array):
        return ()
    return tuple(map(int, result.shape)) if all(isinstance(extent, int) for extent in result.shape) else None
