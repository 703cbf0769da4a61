"""What calls of NumPy's functions, of the runtime's and of Python's give, as far as memory goes.

A function that is not listed is taken for elementwise if it is NumPy's and gets an array; what else it may be gives a
value that is not known, and no memory.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from s2sad import runtime
from s2sad.run.memory.abstract_arrays import Array, Meter, allocated, broadcast, elementwise
from s2sad.run.memory.interval_arithmetic import (
    INF, UNKNOWN, Between, bounds, is_number, least, loops_of_values, operated, truth, truth_value,
)

Keywords = Mapping[str, Any]
Function = Callable[[Meter, list[Any], Keywords], Any]


def called(meter: Meter, name: str, args: list[Any], keywords: Keywords) -> Any:
    """What a call gives; `name` as the text has it, or "method NAME" for one of an array, its first argument."""
    if name in _FUNCTIONS:
        return _FUNCTIONS[name](meter, args, keywords)
    module, _, own = name.rpartition(".")
    values = [*args, *keywords.values()]
    if all(map(_is_known, values)):
        exact = _of_numbers(module, own)
        return UNKNOWN if exact is None else exact(*args, **keywords)
    if module == "np" and any(isinstance(a, Array) for a in args) and isinstance(getattr(np, own, None), np.ufunc):
        return elementwise(meter, [a for a in args if a is not None], _kind_of_ufunc(own))
    return UNKNOWN


def _is_known(value: Any) -> bool:
    return is_number(value) or isinstance(value, (str, bool, type(None)))


def _of_numbers(module: str, name: str) -> Callable[..., Any] | None:
    """A function of numbers that can be called itself."""
    if module in ("np", "math"):
        found = getattr(np if module == "np" else math, name, None)
        return found if isinstance(found, np.ufunc) or module == "math" and callable(found) else None
    return getattr(runtime, name, None) if not module and name in runtime.__all__ else None


def _kind_of_ufunc(name: str) -> Any:
    """The dtype of what a function gives whatever it takes."""
    found = getattr(np, name)
    return np.bool_ if found.types and all(t.endswith("->?") for t in found.types) else None


# -- arrays that are made -------------------------------------------------------------------------------------------

def shape_of(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, (tuple, list)) else (value,)


def _dtype(given: Any, default: Any = np.float64) -> Any:
    return default if given is None or isinstance(given, Between) else given


def _made(meter: Meter, args: list[Any], keywords: Keywords) -> Array:
    return allocated(meter, shape_of(args[0]), _dtype(args[1] if len(args) > 1 else keywords.get("dtype")))


def _full(meter: Meter, args: list[Any], keywords: Keywords) -> Array:
    kind = args[2] if len(args) > 2 else keywords.get("dtype")
    value = args[1]
    return allocated(meter, shape_of(args[0]), _dtype(kind, np.result_type(type(value)) if is_number(value) else
                                                      np.float64))


def _like(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    model = args[0]
    if not isinstance(model, Array):
        return UNKNOWN
    kind = next((a for a in args[1:] if isinstance(a, (type, np.dtype))), None) or keywords.get("dtype")
    return allocated(meter, shape_of(keywords.get("shape", model.shape)), _dtype(kind, model.dtype))


def _copied(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    given = args[0]
    if isinstance(given, (tuple, list)):
        inner = [g for g in given if isinstance(g, Array)]
        kind = _dtype(keywords.get("dtype"), inner[0].dtype if inner else np.float64)
        return allocated(meter, (len(given), *(inner[0].shape if inner else ())), kind)
    return _like(meter, args, keywords)


def _as_array(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    """An array itself, or a copy with another dtype."""
    model, kind = args[0], args[1] if len(args) > 1 else None
    return model if kind is None or not isinstance(model, Array) or np.dtype(kind) == model.dtype else _like(
        meter, args, keywords)


def _arange(meter: Meter, args: list[Any], keywords: Keywords) -> Array:
    kind = _dtype(keywords.get("dtype"), np.float64 if any(isinstance(a, float) for a in args) else np.int64)
    return allocated(meter, (_trips(args),), kind)


def _linspace(meter: Meter, args: list[Any], keywords: Keywords) -> Array:
    return allocated(meter, (args[2] if len(args) > 2 else keywords.get("num", 50),), np.float64)


def _square(meter: Meter, args: list[Any], keywords: Keywords) -> Array:
    return allocated(meter, (args[0], args[1] if len(args) > 1 and args[1] is not None else args[0]), np.float64)


def _trips(args: list[Any]) -> Any:
    start, stop, step = (0, args[0], 1) if len(args) < 2 else (args[0], args[1], args[2] if len(args) > 2 else 1)
    if not any(isinstance(p, Between) for p in (start, stop, step)):
        return max(0, math.ceil((stop - start) / step))
    size = operated("Sub", stop, start) if bounds(step)[0] > 0 else operated("Sub", start, stop)
    if step not in (1, -1):
        return Between(0, max(0, bounds(size)[1]), loops_of_values(start, stop, step))
    return least([0, size], largest=True)


# -- arrays from arrays ---------------------------------------------------------------------------------------------

def _same_shape(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    return allocated(meter, args[0].shape, args[0].dtype, temporary=True) if isinstance(args[0], Array) else UNKNOWN


def _all_together(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    arrays = [a for a in args if isinstance(a, Array)]
    if len(args) == 3 and isinstance(args[0], Array) and arrays:        # np.where: what is picked has the dtype
        picked = [a for a in args[1:] if isinstance(a, Array)]
        return allocated(meter, broadcast([a.shape for a in arrays]), picked[0].dtype if picked else np.float64, True)
    return elementwise(meter, args) if arrays else UNKNOWN


def _reduced(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    array = args[0]
    axis = args[1] if len(args) > 1 else keywords.get("axis")
    if not isinstance(array, Array) or axis is None:
        return UNKNOWN
    axes = {a % len(array.shape) for a in shape_of(axis)}
    keeps = keywords.get("keepdims") is True
    shape = [1 if k in axes else e for k, e in enumerate(array.shape) if keeps or k not in axes]
    return allocated(meter, tuple(shape), array.dtype, temporary=True) if shape else UNKNOWN


def product(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    """What a product of matrices gives."""
    left, right = args[:2]
    if not isinstance(left, Array) or not isinstance(right, Array):
        return elementwise(meter, args[:2]) if isinstance(left, Array) or isinstance(right, Array) else UNKNOWN
    a, b = left.shape, right.shape
    if len(a) == 1 and len(b) == 1:
        return UNKNOWN
    rows = a[-2:-1] if len(a) > 1 else ()
    columns = b[-1:] if len(b) > 1 else ()
    outer = broadcast([a[:-2], b[:-2]]) if len(a) > 2 or len(b) > 2 else ()
    return allocated(meter, (*outer, *rows, *columns), np.result_type(left.dtype, right.dtype), temporary=True)


def _solution(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    return _same_shape(meter, args[1:], keywords)


def _outer(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    if not all(isinstance(a, Array) for a in args[:2]):
        return UNKNOWN
    return allocated(meter, (args[0].size, args[1].size), np.result_type(args[0].dtype, args[1].dtype), True)


def _transposed(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    if not isinstance(args[0], Array):
        return UNKNOWN
    axes = args[1] if len(args) > 1 else None
    shape = args[0].shape
    return args[0].view(tuple(shape[a] for a in axes) if isinstance(axes, tuple) else shape[::-1])


def _reshaped(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    if not isinstance(args[0], Array):
        return UNKNOWN
    shape = shape_of(args[1] if len(args) == 2 else tuple(args[1:]))
    if -1 in shape:
        rest = math.prod(e for e in shape if isinstance(e, int) and e != -1)
        shape = tuple(operated("FloorDiv", args[0].size, rest or 1) if e == -1 else e for e in shape)
    return args[0].view(shape)


def _flat(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    return args[0].view((args[0].size,)) if isinstance(args[0], Array) else UNKNOWN


def _broadcast_view(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    return args[0].view(shape_of(args[1])) if isinstance(args[0], Array) else UNKNOWN


def _sized(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    stack, shape = args[0], shape_of(args[1])
    return stack if stack.shape == shape else allocated(meter, shape, stack.dtype)


def _in_arena(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    """The array and the place behind it, as where the arena has no room."""
    return allocated(meter, shape_of(args[2]), np.float64), UNKNOWN


def _on_disk(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    """Rows in a file."""
    outer, meter.kind, meter.rows = meter.kind, "disk", None    # the file has them all
    made = allocated(meter, (args[1], *args[0].shape), args[0].dtype)
    meter.kind = outer
    return made


# -- Python's -------------------------------------------------------------------------------------------------------

def _length(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    given = args[0]
    if isinstance(given, Array):
        return given.shape[0]
    return _trips(list(given.bounds)) if isinstance(given, Trips) else len(given)


def _absolute(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    value = args[0]
    if isinstance(value, Array):
        return elementwise(meter, args)
    if isinstance(value, Between):
        low, high = value.low, value.high
        return Between(0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high)), value.loops)
    return abs(value)


def _integer(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    if isinstance(args[0], Between):
        low, high = args[0].low, args[0].high
        return Between(low if low == -INF else math.floor(low), high if high == INF else math.ceil(high), args[0].loops)
    return int(args[0])


def _real(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    return args[0] if isinstance(args[0], Between) else float(args[0])


def _boolean(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    known = truth(args[0])
    return truth_value(loops_of_values(args[0])) if known is None else known


def _inside(meter: Meter, args: list[Any], keywords: Keywords) -> Any:
    """A bound of a slice, moved into an axis of the second argument's length."""
    place, extent = args[:2]
    if isinstance(place, int) and isinstance(extent, int):
        return runtime.position(place, extent)
    return least([place, extent]) if bounds(place)[0] >= 0 else Between(0, bounds(extent)[1], loops_of_values(*args))


def _extreme(largest: bool) -> Function:
    return lambda meter, args, keywords: least(list(args[0]) if len(args) == 1 else args, largest)


class Trips:
    """A range."""

    def __init__(self, *parts: Any):
        self.bounds = parts
        self.count = _trips(list(parts))

    def counter(self, name: str, loop: int) -> Any:
        """What the counter of this name may be in a trip that is not known."""
        start, step = self.ends
        last = operated("Add", start, operated("Mult", step, least([operated("Sub", self.count, 1), 0], True)))
        low, high = zip(bounds(start), bounds(last))
        several = [p for p in self.bounds if isinstance(p, Between)]
        reached = not several or len(several) == 1 and several[0].reached and step == 1
        return Between(min(low), max(high), loops_of_values(start, last) | {loop}, (name, loop), 0, reached)

    @property
    def ends(self) -> tuple[Any, Any]:
        """The first value of the counter, and by how much it goes on."""
        return (0, 1) if len(self.bounds) < 2 else (self.bounds[0], (*self.bounds, 1)[2])


_FUNCTIONS: dict[str, Function] = {
    **dict.fromkeys(("np.empty", "np.zeros", "np.ones"), _made), "np.full": _full,
    **dict.fromkeys(("np.empty_like", "np.zeros_like", "np.ones_like", "np.full_like"), _like),
    **dict.fromkeys(("np.copy", "np.array", "np.ascontiguousarray", "method copy"), _copied),
    "np.asarray": _as_array,
    "np.arange": _arange, "np.linspace": _linspace, "np.eye": _square, "np.identity": _square,
    **dict.fromkeys(("np.sort", "np.cumsum", "np.cumprod", "np.roll", "np.linalg.inv", "np.linalg.cholesky",
                     "np.tril", "np.triu", "np.flip", "scattered"), _same_shape),
    **dict.fromkeys(("np.where", "np.maximum", "np.minimum", "np.clip"), _all_together),
    **dict.fromkeys(("np.sum", "np.mean", "np.prod", "np.max", "np.min", "np.any", "np.all", "np.amax", "np.amin",
                     "np.linalg.norm", "added", "product", "blocked_sum", "pairwise_sum"), _reduced),
    **dict.fromkeys(("np.dot", "np.matmul"), product), "np.outer": _outer,
    **dict.fromkeys(("np.linalg.solve", "solve_triangular"), _solution),
    **dict.fromkeys(("np.transpose", "method transpose"), _transposed),
    **dict.fromkeys(("np.reshape", "method reshape"), _reshaped),
    **dict.fromkeys(("np.ravel", "method ravel"), _flat), "np.broadcast_to": _broadcast_view,
    **dict.fromkeys(("allocate", "allocate_zeros"), _in_arena),
    "sized": _sized, "on_disk": _on_disk, "len": _length, "abs": _absolute, "np.abs": _absolute, "int": _integer,
    "float": _real, "np.float64": _real, "bool": _boolean,
    "max": _extreme(True), "min": _extreme(False), "position": _inside,
    "range": lambda _, args, __: Trips(*args)}
