"""array_laws: the shapes of what functions give that join arrays, multiply them and rearrange their axes.

A law takes the shapes of the arrays that are given and says what it knows of the result's: None for a length that it
does not know, None in place of the whole where the number of axes is not known either.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from s2sad.evaluate.specialize.values import Data, TupleValue, Value, constant

Shape = tuple["int | None", ...]
Law = Callable[[Sequence[Value], Mapping[str, Value]], Shape | None]


def shape(value: Value) -> Shape | None:
    """The shape of a value, as far as it is known; () of a number."""
    if not isinstance(value, Data):
        return None
    return () if value.is_known and isinstance(value.known, (bool, int, float, complex)) else value.shape


def product(left: Shape | None, right: Shape | None) -> Shape | None:
    """The shape of `left @ right`, of vectors and matrices."""
    if left is None or right is None or not 1 <= len(left) <= 2 or not 1 <= len(right) <= 2:
        return None
    return (*left[:-1], *right[1:])


def _dot(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    return product(*map(shape, args)) if len(args) == 2 and not keywords else None


def _outer(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """Of whatever it is given it takes all elements."""
    rows = [s for s in map(shape, args) if s is not None]
    if len(args) != 2 or keywords:
        return None
    return tuple(s[0] if len(s) == 1 else None for s in rows) if len(rows) == 2 else (None, None)


def _outer_operation(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    one, other = map(shape, args) if len(args) == 2 and not keywords else (None, None)
    return None if one is None or other is None else (*one, *other)


def _parts(args: Sequence[Value]) -> list[Shape] | None:
    """The shapes of the arrays of a tuple or list, where all are known."""
    if len(args) != 1 or not isinstance(args[0], TupleValue) or not args[0].items:
        return None
    found = [shape(v) for v in args[0].items]
    return None if None in found else found  # pyright: ignore[reportReturnType]


def _stack(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    parts = _parts(args)
    return None if parts is None or keywords.keys() - {"axis"} else (None,) * (len(parts[0]) + 1)


def _concatenate(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    parts = _parts(args)
    if parts is None or keywords.keys() - {"axis"} or not _is_axis(keywords.get("axis", constant(0))):
        return None
    return (None,) * len(parts[0])


def _vstack(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    parts = _parts(args)
    return None if parts is None or keywords else (None,) * max(len(parts[0]), 2)


def _hstack(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    parts = _parts(args)
    return None if parts is None or keywords else (None,) * max(len(parts[0]), 1)


def _column_stack(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    parts = _parts(args)
    return None if parts is None or keywords or any(len(p) > 2 for p in parts) else (None, None)


def _diag(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    whole = shape(args[0]) if args else None
    return None if whole is None or keywords.keys() - {"k"} else {1: (None, None), 2: (None,)}.get(len(whole))


def _eye(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    return (None, None)


def _inverse(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    return shape(args[0]) if len(args) == 1 and not keywords else None


def _reordered(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """Of what moves elements, along one axis or all; np.sort along None gives a vector."""
    return shape(args[0]) if all(map(_is_axis, [*args[1:], keywords.get("axis", constant(0))])) else None


def _accumulated(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """Along an axis, of which there must be one alone where none is said."""
    whole = shape(args[0]) if args else None
    said = _is_axis(keywords["axis"]) if "axis" in keywords else whole is not None and len(whole) == 1
    return whole if said and len(args) == 1 else None


def _resized(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """Of what changes the lengths of axes, and not their number."""
    whole = shape(args[0]) if args else None
    return None if whole is None else (None,) * len(whole)


def _repeated(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    if len(args) == 2 and "axis" not in keywords:
        return (None,)
    return _resized(args, keywords) if len(args) == 2 and _is_axis(keywords["axis"]) else None


def _tiled(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    whole, times = (shape(args[0]), args[1]) if len(args) == 2 else (None, constant(0))
    if whole is None or not (isinstance(times, TupleValue) or isinstance(times, Data) and type(times.known) is int):
        return None
    return (None,) * max(len(whole), len(times.items) if isinstance(times, TupleValue) else 1)


def _is_axis(value: Value) -> bool:
    return isinstance(value, Data) and type(value.known) is int


def _transposed(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    whole = shape(args[0]) if len(args) == 1 and not keywords else None
    return None if whole is None else whole[::-1]


def _kron(args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    rows = [shape(a) for a in args]
    return None if keywords or len(rows) != 2 or None in rows else (None,) * max(len(s or ()) for s in rows)


LAWS: dict[str, Law] = {
    "numpy.outer": _outer, "numpy.matmul": _dot, "numpy.dot": _dot, "numpy.stack": _stack, "numpy.vstack": _vstack,
    "numpy.hstack": _hstack, "numpy.column_stack": _column_stack, "numpy.concatenate": _concatenate,
    "numpy.diag": _diag, "numpy.eye": _eye, "numpy.identity": _eye, "numpy.vander": _eye, "numpy.kron": _kron,
    "numpy.linalg.inv": _inverse, "numpy.transpose": _transposed, "numpy.cumsum": _accumulated,
    "numpy.cumprod": _accumulated, "numpy.roll": _reordered, "numpy.flip": _reordered, "numpy.sort": _reordered,
    "numpy.diff": _resized, "numpy.pad": _resized, "numpy.repeat": _repeated, "numpy.tile": _tiled,
    **{f"numpy.{name}.outer": _outer_operation for name in ("add", "subtract", "multiply", "divide")}}
