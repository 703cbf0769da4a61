"""Lists that compiled code gives, as it takes them back: Numba knows no type of an empty one."""
from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np


def with_typed_lists(dispatcher: Any, arguments: Sequence[Any], values: tuple[Any, ...]) -> tuple[Any, ...]:
    """The values of the tuple that a compiled function has given last for these arguments; an empty list has an item of
    the type of its items, which nobody takes: what is pushed on a list is popped in turn."""
    if [] not in [v for v in values if type(v) is list] or not hasattr(dispatcher, "overloads"):
        return values
    types = importlib.import_module("numba").types
    signature = dispatcher.overloads[tuple(map(dispatcher.typeof_pyval, arguments))].signature
    kinds = signature.return_type.types[-1].types
    return tuple([[_of_type(kind.dtype, types)] if type(v) is list and not v else v for v, kind in zip(values, kinds)])


def _of_type(kind: Any, types: Any) -> Any:
    """A value of a type of Numba's."""
    if isinstance(kind, types.BaseTuple):
        return tuple([_of_type(k, types) for k in kind])
    if isinstance(kind, types.Array):
        return np.empty((1,) * kind.ndim, str(kind.dtype))
    if isinstance(kind, (types.List, types.ListType)):
        return [_of_type(kind.dtype, types)]
    return np.dtype(str(kind)).type(0)
