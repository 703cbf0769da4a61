"""The type of an expanded function that rearranges elements; UNKNOWN where its arguments have no expansion."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.infer.signatures.laws import axes_of, of_rank, whole_number
from s2sad.infer.signatures.options import Arguments, astype_dtype, is_none, one_axis, text_of, widths_of
from s2sad.infer.promotion import ORDER, RANKS, common, is_expandable, promote
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.infer.signatures.selections import repeated
from s2sad.tree import Constant, List, Tuple


def _diff(args: list[Type], options: Arguments) -> Type:
    times = whole_number(options["n"])
    fits = is_expandable(args) and args[0].dtype != "bool" and times is not None and 1 <= times <= 16
    return args[0] if fits and one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _parts(options: Arguments, args: list[Type]) -> list[Type]:
    display = isinstance(options["x"], (Tuple, List))
    items = [replace(i, kind="array", rank=1, items=(), dtype=common(list(i.items))) if i.kind == "tuple" else i
             for i in args[0].items]
    known = all(i.kind in ("array", "number") and i.dtype in ORDER for i in items)
    return items if display and known else []


def _rows(args: list[Type], options: Arguments) -> Type | None:
    """The type of what joins the rows of one array, in place of a list of them; None if it joins a list display."""
    if not args[0].is_array:
        return None
    first = "axis" not in options or whole_number(options["axis"]) == 0
    return args[0] if first and args[0].dtype in ORDER else UNKNOWN


def _concatenate(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return of_rank(rows, rows.rank - 1) if rows.rank > 1 else UNKNOWN
    parts = _parts(options, args)
    ranks = {p.rank for p in parts}
    if is_none(options["axis"]) and parts and all(p.is_array for p in parts):
        return array(common(parts), 1)
    if len(ranks) != 1 or 0 in ranks or one_axis(options["axis"], max(ranks)) is None:
        return UNKNOWN
    return array(common(parts), ranks.pop())


def _stack(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return rows
    parts = _parts(options, args)
    ranks = {p.rank for p in parts}
    if len(ranks) != 1 or 0 in ranks or one_axis(options["axis"], max(ranks) + 1) is None:
        return UNKNOWN
    return array(common(parts), ranks.pop() + 1)


def _hstack(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return of_rank(rows, 1) if rows.rank in (1, 2) else UNKNOWN
    parts = _parts(options, args)
    ranks = {max(p.rank, 1) for p in parts}
    return array(common(parts), ranks.pop()) if len(ranks) == 1 else UNKNOWN


def _vstack(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return of_rank(rows, 2) if rows.rank in (2, 3) else UNKNOWN
    parts = _parts(options, args)
    return array(common(parts), 2) if parts and all(p.rank in (1, 2) for p in parts) else UNKNOWN


def _columns(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return rows if rows.rank == 2 else UNKNOWN
    return _vstack(args, options)


def _append(args: list[Type], options: Arguments) -> Type:
    fits = args[0].rank == 1 and args[1].rank <= 1 and args[1].kind in ("array", "number")
    return array(common(args), 1) if fits else UNKNOWN


def _expanded(args: list[Type], options: Arguments) -> Type:
    found = is_expandable(args) and one_axis(options["axis"], args[0].rank + 1) is not None
    return array(args[0].dtype, args[0].rank + 1) if found else UNKNOWN


def _squeezed(args: list[Type], options: Arguments) -> Type:
    if not is_expandable(args):
        return UNKNOWN
    gone = args[0].ones if is_none(options["axis"]) else axes_of(options["axis"], args[0].rank) or ()
    return of_rank(args[0], args[0].rank - len(gone)) if gone else UNKNOWN


def _swapped(args: list[Type], options: Arguments) -> Type:
    axes = [one_axis(options[a], args[0].rank) for a in ("axis1", "axis2")]
    return args[0] if is_expandable(args) and None not in axes else UNKNOWN


def _tiled(args: list[Type], options: Arguments) -> Type:
    reps = options["reps"]
    display = isinstance(reps, (Tuple, List)) or args[1].is_integer
    rank = len(reps.elts) if isinstance(reps, (Tuple, List)) else 1
    return array(args[0].dtype, max(rank, args[0].rank)) if is_expandable(args) and display else UNKNOWN


def _repeated(args: list[Type], options: Arguments) -> Type:
    if args[1].rank or args[1].kind == "tuple":
        return repeated(args, options)
    if not (is_expandable(args) or args[0].is_number and args[0].dtype in ORDER) or not args[1].is_integer:
        return UNKNOWN
    if is_none(options["axis"]):
        return array(args[0].dtype, 1)
    return args[0] if one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _padded(args: list[Type], options: Arguments) -> Type:
    mode = text_of(options["mode"])
    filled = ("constant", "edge", "wrap", "reflect", "symmetric", "linear_ramp", "mean", "maximum", "minimum")
    fits = mode in filled and not isinstance(options["constant_values"], (Tuple, List))
    return args[0] if is_expandable(args) and fits and widths_of(options["pad_width"], args[0].rank) else UNKNOWN


def _diag(args: list[Type], options: Arguments) -> Type:
    fits = is_expandable(args) and args[0].rank <= 2
    return array(args[0].dtype, 3 - args[0].rank) if fits else UNKNOWN


def _diagonal(args: list[Type], options: Arguments) -> Type:
    axes = [one_axis(options[a], 2) for a in ("axis1", "axis2")]
    fits = is_expandable(args) and args[0].rank == 2 and sorted(a for a in axes if a is not None) == [0, 1]
    return array(args[0].dtype, 1) if fits else UNKNOWN


def _triangle(args: list[Type], options: Arguments) -> Type:
    return args[0] if is_expandable(args) and args[0].rank == 2 else UNKNOWN


def _trace(args: list[Type], options: Arguments) -> Type:
    return of_rank(args[0], 0) if is_expandable(args) and args[0].rank == 2 and args[0].is_inexact else UNKNOWN


def _eye(args: list[Type], options: Arguments) -> Type:
    dtype = astype_dtype(options) if "dtype" in options else "float64"
    return array(dtype, 2) if args[0].is_integer and dtype else UNKNOWN


def _linspace(args: list[Type], options: Arguments) -> Type:
    display = isinstance(options["endpoint"], Constant)
    return array("float64", 1) if display and all(a.is_number for a in args) else UNKNOWN


def _window(args: list[Type], options: Arguments) -> Type:
    return array("float64", 1) if args[0].is_integer else UNKNOWN


def _diagflat(args: list[Type], options: Arguments) -> Type:
    return _diag(args, options) if args[0].rank == 1 else UNKNOWN


def _arange(args: list[Type], options: Arguments) -> Type:
    numbers = [a for a in args[:3] if a.kind != "none"]
    own = "float64" if any(a.is_float for a in numbers) else "int64"
    dtype = own if is_none(options["dtype"]) else astype_dtype(options)
    fits = dtype in (own, "float64") or own == "int64" and dtype in ("int32", "float32")
    return array(dtype, 1) if fits and all(a.is_number for a in numbers) else UNKNOWN


def _cast(args: list[Type], options: Arguments) -> Type:
    dtype = astype_dtype(options)
    if args[0].is_number and args[0].dtype in RANKS and dtype in ("float64", "float32", "complex128", "int64"):
        return Type("number", dtype)
    return array(dtype, args[0].rank) if args[0].is_array and args[0].dtype in RANKS and dtype else UNKNOWN


def _at_least(rank: int) -> Callable[[list[Type], Arguments], Type]:
    def type_of(args: list[Type], options: Arguments) -> Type:
        known = args[0].kind in ("array", "number") and args[0].dtype in ORDER
        return array(args[0].dtype, max(rank, args[0].rank)) if known else UNKNOWN
    return type_of


def _deep(args: list[Type], options: Arguments) -> Type:
    if args[0].is_array:
        return UNKNOWN
    parts = _parts(options, args)
    return array(common(parts), 3) if parts and all(p.rank in (1, 2) for p in parts) else UNKNOWN


def _turned(args: list[Type], options: Arguments) -> Type:
    axes = axes_of(options["axes"], args[0].rank) if is_expandable(args) and args[0].rank > 1 else None
    fits = axes is not None and len(axes) == 2 and whole_number(options["k"]) is not None
    return args[0].plain if fits else UNKNOWN


def _section(args: list[Type], options: Arguments) -> Type:
    sections, number = options["sections"], whole_number(options["part"])
    display = isinstance(sections, (Tuple, List))
    count = len(sections.elts) + 1 if display else whole_number(sections)
    fits = is_expandable(args) and number is not None and (count is None or number < count)
    if "axis" in options and (not is_expandable(args) or one_axis(options["axis"], args[0].rank) is None):
        return UNKNOWN
    return args[0] if fits and (display or args[1].is_integer) else UNKNOWN


def _stacked_sections(args: list[Type], options: Arguments) -> Type:
    return _section(args, options) if args[0].rank >= 2 else UNKNOWN


def _scaled(args: list[Type], options: Arguments) -> Type:
    data, c = args
    return promote(data, c) if data.is_array and data.rank == 1 and c.is_number else UNKNOWN


def _along(args: list[Type], options: Arguments) -> Type:
    values = args[0]
    return array(values.dtype if values.is_float else "float64", 1) if values.rank < 2 and values.dtype in ORDER else (
        UNKNOWN)


def _windows(args: list[Type], options: Arguments) -> Type:
    x, shape = args[0], options["window_shape"]
    count = len(shape.elts) if isinstance(shape, (Tuple, List)) else 1
    axes = range(x.rank) if is_none(options["axis"]) else axes_of(options["axis"], x.rank) or ()
    whole = args[1].is_integer or args[1].kind == "tuple" and all(i.is_integer for i in args[1].items)
    return of_rank(x, x.rank + count) if x.is_array and whole and len(axes) == count else UNKNOWN


SHAPES: dict[str, Callable[[list[Type], Arguments], Type]] = {
    "numpy.diff": _diff, "numpy.concatenate": _concatenate, "numpy.stack": _stack, "numpy.hstack": _hstack,
    "numpy.r_": _hstack,
    "numpy.vstack": _vstack, "numpy.column_stack": _columns, "numpy.append": _append, "numpy.expand_dims": _expanded,
    "numpy.squeeze": _squeezed, "numpy.swapaxes": _swapped, "numpy.tile": _tiled, "numpy.repeat": _repeated,
    "numpy.pad": _padded, "numpy.diag": _diag, "numpy.diagonal": _diagonal, "numpy.tril": _triangle,
    "numpy.triu": _triangle, "numpy.trace": _trace, "numpy.eye": _eye, "numpy.identity": _eye,
    "numpy.linspace": _linspace, "numpy.arange": _arange,
    "numpy.astype": _cast, "numpy.atleast_1d": _at_least(1), "numpy.atleast_2d": _at_least(2),
    "numpy.atleast_3d": _at_least(3), "numpy.dstack": _deep,
    "numpy.rot90": _turned, "numpy.diagflat": _diagflat, "numpy.split": _section, "numpy.array_split": _section,
    "numpy.lib.stride_tricks.sliding_window_view": _windows,
    "numpy.hsplit": _section, "numpy.vsplit": _stacked_sections, "numpy.tri": _eye,
    **dict.fromkeys(("numpy.hanning", "numpy.hamming", "numpy.blackman", "numpy.bartlett"), _window),
    "scipy.sparse.entries": _scaled, "scipy.sparse.along": _along,
}
