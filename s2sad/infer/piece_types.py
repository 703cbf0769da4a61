"""The type of a function of whole arrays that is written out in pieces, by its name; UNKNOWN where its arguments are
none that the pieces are written for."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from s2sad.infer.laws import axes_of, is_true, of_rank, whole_number
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.infer.types_of_places import PLACES, is_none
from s2sad.tree import AST, Constant, List, Name, Tuple, UnaryOp, USub

Arguments = Mapping[str, AST]
_ORDER = ("bool", "int64", "float32", "float64")


def piece_type(function: str, args: list[Type], options: Arguments) -> Type:
    """The type of a call of such a function; `args` are the types of its operands, then of its options."""
    made = _TYPES[function](args, options)
    return UNKNOWN if made.dtype and made.dtype not in _ORDER else made


def common(args: list[Type]) -> str:
    """The dtype that arrays and numbers have together."""
    arrays = [a for a in args if a.is_array] or args
    return max((a.dtype for a in arrays), key=lambda d: _ORDER.index(d) if d in _ORDER else len(_ORDER), default="")


def text_of(node: AST) -> str:
    """The string that an option spells, or ''."""
    return node.value if isinstance(node, Constant) and isinstance(node.value, str) else ""


def one_axis(node: AST, rank: int) -> int | None:
    """The one axis that an option names."""
    found = None if is_none(node) or whole_number(node) is None else axes_of(node, rank)
    return found[0] if found else None


def widths_of(node: AST, rank: int) -> list[tuple[AST, AST]] | None:
    """How much `np.pad` adds before and after each axis."""
    if not isinstance(node, (Tuple, List)):
        return [(node, node)] * rank
    parts = list(node.elts)
    if all(isinstance(p, (Tuple, List)) for p in parts):
        pairs = [tuple(p.elts) for p in parts]
        if any(len(p) != 2 for p in pairs) or len(pairs) not in (1, rank):
            return None
        return [(p[0], p[1]) for p in (pairs if len(pairs) == rank else pairs * rank)]
    return [(parts[0], parts[1])] * rank if len(parts) == 2 else None


# -- by function -----------------------------------------------------------------------------------------------------

def _float(kind: Type) -> Type:
    return kind if kind.is_float or kind.kind == "unknown" else replace(kind, dtype="float64")


def _array(args: list[Type]) -> bool:
    return bool(args) and args[0].is_array and args[0].dtype in _ORDER


def _same(args: list[Type], options: Arguments) -> Type:
    return args[0] if _array(args) else UNKNOWN


def _diff(args: list[Type], options: Arguments) -> Type:
    times = whole_number(options["n"])
    fits = _array(args) and args[0].dtype != "bool" and times is not None and 1 <= times <= 4
    return args[0] if fits and one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _parts(options: Arguments, args: list[Type]) -> list[Type]:
    written = isinstance(options["x"], (Tuple, List))
    items = [replace(i, kind="array", rank=1, items=(), dtype=common(list(i.items))) if i.kind == "tuple" else i
             for i in args[0].items]
    known = all(i.kind in ("array", "number") and i.dtype in _ORDER for i in items)
    return items if written and known else []


def _rows(args: list[Type], options: Arguments) -> Type | None:
    """The type of what joins the rows of one array, in place of a list of them; None if it joins a written list."""
    if not args[0].is_array:
        return None
    first = "axis" not in options or whole_number(options["axis"]) == 0
    return args[0] if first and args[0].dtype in _ORDER else UNKNOWN


def _concatenate(args: list[Type], options: Arguments) -> Type:
    if (rows := _rows(args, options)) is not None:
        return of_rank(rows, rows.rank - 1) if rows.rank > 1 else UNKNOWN
    parts = _parts(options, args)
    ranks = {p.rank for p in parts}
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
    found = _array(args) and one_axis(options["axis"], args[0].rank + 1) is not None
    return array(args[0].dtype, args[0].rank + 1) if found else UNKNOWN


def _squeezed(args: list[Type], options: Arguments) -> Type:
    found = _array(args) and one_axis(options["axis"], args[0].rank) is not None
    return of_rank(args[0], args[0].rank - 1) if found else UNKNOWN


def _swapped(args: list[Type], options: Arguments) -> Type:
    axes = [one_axis(options[a], args[0].rank) for a in ("axis1", "axis2")]
    return args[0] if _array(args) and None not in axes else UNKNOWN


def _tiled(args: list[Type], options: Arguments) -> Type:
    reps = options["reps"]
    written = isinstance(reps, (Tuple, List)) or args[1].is_integer
    rank = len(reps.elts) if isinstance(reps, (Tuple, List)) else 1
    return array(args[0].dtype, max(rank, args[0].rank)) if _array(args) and written else UNKNOWN


def _repeated(args: list[Type], options: Arguments) -> Type:
    if not _array(args) or not args[1].is_integer:
        return UNKNOWN
    if is_none(options["axis"]):
        return array(args[0].dtype, 1)
    return args[0] if one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _padded(args: list[Type], options: Arguments) -> Type:
    mode = text_of(options["mode"])
    fits = mode in ("constant", "edge", "wrap", "reflect", "symmetric") and not isinstance(
        options["constant_values"], (Tuple, List))
    return args[0] if _array(args) and fits and widths_of(options["pad_width"], args[0].rank) else UNKNOWN


def _diag(args: list[Type], options: Arguments) -> Type:
    fits = _array(args) and args[0].rank <= 2
    return array(args[0].dtype, 3 - args[0].rank) if fits else UNKNOWN


def _diagonal(args: list[Type], options: Arguments) -> Type:
    return array(args[0].dtype, 1) if _array(args) and args[0].rank == 2 else UNKNOWN


def _triangle(args: list[Type], options: Arguments) -> Type:
    return args[0] if _array(args) and args[0].rank == 2 else UNKNOWN


def _trace(args: list[Type], options: Arguments) -> Type:
    return of_rank(args[0], 0) if _array(args) and args[0].rank == 2 and args[0].is_float else UNKNOWN


def _eye(args: list[Type], options: Arguments) -> Type:
    return array("float64", 2) if args[0].is_integer else UNKNOWN


def _linspace(args: list[Type], options: Arguments) -> Type:
    written = isinstance(options["endpoint"], Constant)
    return array("float64", 1) if written and all(a.is_number for a in args) else UNKNOWN


def _averaged(args: list[Type], options: Arguments) -> Type:
    return _float(_reduced(args, options))


def _reduced(args: list[Type], options: Arguments) -> Type:
    axes = axes_of(options["axis"], args[0].rank) if _array(args) else None
    kept = options.get("keepdims")
    if kept is not None and not (isinstance(kept, Constant) and isinstance(kept.value, bool)):
        return UNKNOWN
    if axes is None or is_true(options.get("keepdims")) and is_none(options["axis"]):
        return UNKNOWN
    return of_rank(args[0], args[0].rank if is_true(options.get("keepdims")) else args[0].rank - len(axes))


def _summed(args: list[Type], options: Arguments) -> Type:
    return _reduced(args, options) if args[0].is_float else UNKNOWN


def _diagflat(args: list[Type], options: Arguments) -> Type:
    return _diag(args, options) if args[0].rank == 1 else UNKNOWN


def _product(args: list[Type], options: Arguments) -> Type:
    one = is_none(options["axis"]) or _array(args) and one_axis(options["axis"], args[0].rank) is not None
    return _reduced(args, options) if one and args[0].is_float else UNKNOWN


def _running(args: list[Type], options: Arguments) -> Type:
    if not _array(args) or not args[0].is_float:
        return UNKNOWN
    if is_none(options["axis"]):
        return array(args[0].dtype, 1)
    return args[0] if one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def norm_order(node: AST) -> int | float | str | None:
    """The order of a norm that an option spells: a number, "inf", "-inf", "fro", "nuc", None; else ""."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = norm_order(node.operand)
        return "-inf" if inner == "inf" else -inner if isinstance(inner, (int, float)) else ""
    if isinstance(node, Name):
        return "inf" if node.id in ("numpy.inf", "math.inf") else ""
    value = node.value if isinstance(node, Constant) else ""
    return value if value is None or type(value) in (int, float) or value in ("fro", "nuc") else ""


def _norm(args: list[Type], options: Arguments) -> Type:
    made, order = _averaged(args, options), norm_order(options["ord"])
    axes = axes_of(options["axis"], args[0].rank) or ()
    vector = is_none(options["axis"]) and args[0].rank == 1 or whole_number(options["axis"]) is not None
    if vector:
        known = order in (None, "inf", "-inf") or isinstance(order, (int, float)) and order > 0
    else:
        whole = args[0].rank == 2 and is_none(options["axis"]) and not is_true(options["keepdims"])
        known = order in (None, "fro") or whole and order in (1, -1, 2, -2, "inf", "-inf", "nuc")
    return made if known and (is_none(options["axis"]) or len(axes) <= 2) else UNKNOWN


def _vdot(args: list[Type], options: Arguments) -> Type:
    a, b = args
    return Type("number", common(args)) if a.is_array and b.is_array and a.rank == b.rank and a.is_float else UNKNOWN


def _inner(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = a.is_array and b.is_array and max(a.rank, b.rank) <= 2
    return of_rank(array(common(args), 1), a.rank + b.rank - 2) if fits else UNKNOWN


def _trapezoid(args: list[Type], options: Arguments) -> Type:
    found = _array(args) and one_axis(options["axis"], args[0].rank) is not None
    return _float(of_rank(args[0], args[0].rank - 1)) if found else UNKNOWN


def _gradient(args: list[Type], options: Arguments) -> Type:
    axis = options["axis"]
    if not is_none(options["part"]) and _array(args):
        number, several = whole_number(options["part"]) or 0, args[0].rank > 1 and is_none(axis)
        if several and number < args[0].rank and (is_none(options["second"]) or args[0].rank == 2):
            return _float(args[0])
        return UNKNOWN if several or args[0].rank == 0 else _float(of_rank(args[0], args[0].rank - 1))
    if not is_none(options["second"]):
        return UNKNOWN
    fits = _array(args) and (is_none(axis) and args[0].rank == 1 or one_axis(axis, args[0].rank) is not None)
    return _float(args[0]) if fits and not isinstance(options["spacing"], (Tuple, List)) else UNKNOWN


def _convolve(args: list[Type], options: Arguments) -> Type:
    fits = all(a.is_array and a.rank == 1 for a in args[:2]) and text_of(options["mode"]) in ("full", "same", "valid")
    return array(common(args[:2]), 1) if fits else UNKNOWN


def _interp(args: list[Type], options: Arguments) -> Type:
    x, xp, fp = args
    if not (x.is_float and x.rank <= 1 and xp.is_array and fp.is_array and xp.rank == fp.rank == 1):
        return UNKNOWN
    return of_rank(array("float64", 1), x.rank)


def _arange(args: list[Type], options: Arguments) -> Type:
    given = [a for a in args if a.kind != "none"]
    return array("float64" if any(a.is_float for a in given) else "int64", 1) if all(
        a.is_number for a in given) else UNKNOWN


def astype_dtype(options: Arguments) -> str:
    """The dtype that `np.astype` is given, "" if it is none that arrays here have."""
    node = options["dtype"]
    named = node.id if isinstance(node, Name) else text_of(node)
    found = {"builtins.float": "float64", "builtins.int": "int64", "builtins.bool": "bool", "numpy.bool_": "bool",
             "numpy.bool": "bool"}.get(named, named.removeprefix("numpy."))
    return found if found in _ORDER else ""


def _cast(args: list[Type], options: Arguments) -> Type:
    dtype = astype_dtype(options)
    return array(dtype, args[0].rank) if _array(args) and dtype else UNKNOWN


def _at_least(rank: int) -> Callable[[list[Type], Arguments], Type]:
    def made(args: list[Type], options: Arguments) -> Type:
        known = args[0].kind in ("array", "number") and args[0].dtype in _ORDER
        return array(args[0].dtype, max(rank, args[0].rank)) if known else UNKNOWN
    return made


def _deep(args: list[Type], options: Arguments) -> Type:
    if args[0].is_array:
        return UNKNOWN
    parts = _parts(options, args)
    return array(common(parts), 3) if parts and all(p.rank in (1, 2) for p in parts) else UNKNOWN


def _turned(args: list[Type], options: Arguments) -> Type:
    return args[0] if _array(args) and args[0].rank == 2 and whole_number(options["k"]) is not None else UNKNOWN


def _section(args: list[Type], options: Arguments) -> Type:
    sections, number = options["sections"], whole_number(options["part"])
    written = isinstance(sections, (Tuple, List))
    count = len(sections.elts) + 1 if written else whole_number(sections)
    fits = _array(args) and number is not None and (count is None or number < count)
    if "axis" in options and (not _array(args) or one_axis(options["axis"], args[0].rank) is None):
        return UNKNOWN
    return args[0] if fits and (written or args[1].is_integer) else UNKNOWN


def _stacked_sections(args: list[Type], options: Arguments) -> Type:
    return _section(args, options) if args[0].rank >= 2 else UNKNOWN


def _outer(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = all(x.kind in ("array", "number") and x.dtype in _ORDER for x in args) and 0 < a.rank + b.rank <= 4
    return array(common(args), a.rank + b.rank) if fits else UNKNOWN


def _quotient(args: list[Type], options: Arguments) -> Type:
    return _float(_outer(args, options))


def _crossed(args: list[Type], options: Arguments) -> Type:
    fits = all(a.is_array and 1 <= a.rank <= 2 for a in args)
    return array(common(args), max(a.rank for a in args)) if fits else UNKNOWN


def _powers(args: list[Type], options: Arguments) -> Type:
    return array(args[0].dtype, 2) if _array(args) and args[0].rank == 1 and isinstance(
        options["increasing"], Constant) else UNKNOWN


def _polynomial(args: list[Type], options: Arguments) -> Type:
    p, x = args
    known = p.is_array and p.rank == 1 and p.dtype in _ORDER and x.is_float
    return (array(common(args), x.rank) if x.rank else Type("number", "float64")) if known else UNKNOWN


def _running_extreme(args: list[Type], options: Arguments) -> Type:
    return args[0] if _array(args) and one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


_TYPES: dict[str, Callable[[list[Type], Arguments], Type]] = {
    "numpy.diff": _diff, "numpy.concatenate": _concatenate, "numpy.stack": _stack, "numpy.hstack": _hstack,
    "numpy.vstack": _vstack, "numpy.column_stack": _columns, "numpy.append": _append, "numpy.expand_dims": _expanded,
    "numpy.squeeze": _squeezed, "numpy.swapaxes": _swapped, "numpy.tile": _tiled, "numpy.repeat": _repeated,
    "numpy.pad": _padded, "numpy.diag": _diag, "numpy.diagonal": _diagonal, "numpy.tril": _triangle,
    "numpy.triu": _triangle, "numpy.trace": _trace, "numpy.eye": _eye, "numpy.identity": _eye,
    "numpy.linspace": _linspace, "numpy.arange": _arange, "numpy.var": _averaged, "numpy.std": _averaged,
    "numpy.prod": _product, "numpy.cumprod": _running, "numpy.cumsum": _running,
    "numpy.average": _averaged, "numpy.linalg.norm": _norm,
    "numpy.vdot": _vdot, "numpy.inner": _inner, "numpy.trapezoid": _trapezoid, "numpy.trapz": _trapezoid,
    "numpy.astype": _cast, "numpy.atleast_1d": _at_least(1), "numpy.atleast_2d": _at_least(2), "numpy.dstack": _deep,
    "numpy.rot90": _turned, "numpy.diagflat": _diagflat, "numpy.split": _section, "numpy.array_split": _section,
    "numpy.hsplit": _section, "numpy.vsplit": _stacked_sections, "numpy.tri": _eye, "numpy.ptp": _reduced,
    "numpy.nansum": _summed, "numpy.maximum.accumulate": _running_extreme, "numpy.minimum.accumulate": _running_extreme,
    **{f"numpy.{f}.outer": _outer for f in ("add", "subtract", "multiply", "power", "maximum", "minimum")},
    "numpy.divide.outer": _quotient, "numpy.cross": _crossed, "numpy.vander": _powers, "numpy.polyval": _polynomial,
    "numpy.correlate": _convolve, **PLACES,
    "numpy.gradient": _gradient, "numpy.convolve": _convolve, "numpy.interp": _interp,
}
