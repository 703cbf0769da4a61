"""The type of an expanded function that reduces or multiplies; UNKNOWN where its arguments have no expansion."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.infer.signatures.laws import MOST_PAIRED, axes_of, distinct_axes, is_true, of_rank, whole_number
from s2sad.infer.signatures.options import Arguments, is_none, norm_order, one_axis, text_of
from s2sad.infer.promotion import ORDER, common, is_expandable
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.infer.signatures.norms_and_products import of_matrices
from s2sad.tree import Constant, List, Tuple


_WHOLE = ("bool", "int8", "int16", "int32", "int64")     # whose sums and products are of int64


def _float(kind: Type) -> Type:
    return kind if kind.is_inexact or kind.kind == "unknown" else replace(kind, dtype="float64")


def _averaged(args: list[Type], options: Arguments) -> Type:
    return _float(_reduced(args, options))


def _average(args: list[Type], options: Arguments) -> Type:
    """Weights are of the array's own shape, or of that of the axes in their order."""
    made, weights = _averaged(args, options), args[2]
    if is_none(options["weights"]) or made.kind == "unknown":
        return made
    order = None if is_none(options["axis"]) else distinct_axes(options["axis"], args[0].rank)
    along = order is not None and order == sorted(order) and weights.rank == len(order)
    fits = weights.is_array and (weights.rank == args[0].rank or along)
    return replace(made, dtype=common([made, weights])) if fits and weights.dtype in ORDER else UNKNOWN


def _reduced(args: list[Type], options: Arguments) -> Type:
    axes = axes_of(options["axis"], args[0].rank) if is_expandable(args) else None
    kept = options.get("keepdims")
    if kept is not None and not (isinstance(kept, Constant) and isinstance(kept.value, bool)):
        return UNKNOWN
    if not axes or is_true(options.get("keepdims")) and is_none(options["axis"]):
        return UNKNOWN
    return of_rank(args[0], args[0].rank if is_true(options.get("keepdims")) else args[0].rank - len(axes))


def _numbered(args: list[Type], options: Arguments) -> Type:
    return args[0] if is_expandable(args) and args[0].is_float else UNKNOWN


def summed(args: list[Type], options: Arguments) -> Type:
    return _reduced(args, options) if args[0].is_float else UNKNOWN


def _product(args: list[Type], options: Arguments) -> Type:
    if args[0].dtype in _WHOLE and args[0].is_array:
        args = [replace(args[0], dtype="int64"), *args[1:]]
    return _reduced(args, options) if args[0].is_float or args[0].dtype == "int64" else UNKNOWN


def running(args: list[Type], options: Arguments) -> Type:
    if args[0].dtype in _WHOLE and args[0].is_array:
        args = [replace(args[0], dtype="int64"), *args[1:]]
    if not is_expandable(args):
        return UNKNOWN
    if is_none(options["axis"]):
        return array(args[0].dtype, 1)
    return args[0] if one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _norm(args: list[Type], options: Arguments) -> Type:
    made, order = _averaged(args, options), norm_order(options["ord"])
    axes = axes_of(options["axis"], args[0].rank) or ()
    vector = is_none(options["axis"]) and args[0].rank == 1 or whole_number(options["axis"]) is not None
    if vector:
        known = order in (None, "inf", "-inf") or isinstance(order, (int, float)) and order > 0
    else:
        whole = args[0].rank == 2 and is_none(options["axis"])
        pair = whole or (distinct_axes(options["axis"], args[0].rank) or ()) and len(axes) == 2
        known = order in (None, "fro") or pair and not is_true(options["keepdims"]) and order in (
            1, -1, 2, -2, "inf", "-inf", "nuc")
    return made if known and (is_none(options["axis"]) or len(axes) <= 2) else UNKNOWN


def _condition(args: list[Type], options: Arguments) -> Type:
    fits = is_expandable(args) and args[0].is_float and args[0].rank >= 2
    known = norm_order(options["p"]) in (None, 1, -1, 2, -2, "inf", "-inf", "fro", "nuc")
    return of_rank(args[0], args[0].rank - 2) if fits and known else UNKNOWN


def _vectors(args: list[Type], options: Arguments) -> Type:
    return of_matrices(2)(args, options) if args[0].is_float else UNKNOWN


def _vdot(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = a.is_array and b.is_array and a.rank == b.rank and a.dtype in ORDER
    return Type("number", common(args)) if fits else UNKNOWN


def _inner(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = a.is_array and b.is_array and a.rank + b.rank <= MOST_PAIRED
    return of_rank(array(common(args), 1), a.rank + b.rank - 2) if fits else UNKNOWN


def _trapezoid(args: list[Type], options: Arguments) -> Type:
    found = is_expandable(args) and one_axis(options["axis"], args[0].rank) is not None
    return _float(of_rank(args[0], args[0].rank - 1)) if found else UNKNOWN


def _gradient(args: list[Type], options: Arguments) -> Type:
    axis = options["axis"]
    if not is_none(options["third"]) or whole_number(options["edge_order"]) not in (1, 2):
        return UNKNOWN
    if not is_none(options["part"]) and is_expandable(args):
        number, several = whole_number(options["part"]) or 0, args[0].rank > 1 and is_none(axis)
        if several and number < args[0].rank and (is_none(options["second"]) or args[0].rank == 2):
            return _float(args[0])
        one = is_none(axis) or one_axis(axis, args[0].rank) is not None
        return UNKNOWN if several or args[0].rank == 0 or not one else _float(of_rank(args[0], args[0].rank - 1))
    if not is_none(options["second"]):
        return UNKNOWN
    fits = is_expandable(args) and (is_none(axis) and args[0].rank == 1 or one_axis(axis, args[0].rank) is not None)
    return _float(args[0]) if fits and not isinstance(options["spacing"], (Tuple, List)) else UNKNOWN


def _convolve(args: list[Type], options: Arguments) -> Type:
    fits = all(a.is_array and a.rank == 1 for a in args[:2]) and text_of(options["mode"]) in ("full", "same", "valid")
    return array(common(args[:2]), 1) if fits else UNKNOWN


def _kron(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = a.is_array and b.is_array and max(a.rank, b.rank) <= 3 and {a.dtype, b.dtype} <= set(ORDER)
    return array(common(args), max(a.rank, b.rank)) if fits else UNKNOWN


def _interp(args: list[Type], options: Arguments) -> Type:
    x, xp, fp = args[:3]
    if not all(is_none(options[o]) or not isinstance(options[o], (Tuple, List)) for o in ("left", "right")):
        return UNKNOWN
    if not (x.is_float and x.rank <= 1 and xp.is_array and fp.is_array and xp.rank == fp.rank == 1):
        return UNKNOWN
    return of_rank(array("float64", 1), x.rank)


def _outer(args: list[Type], options: Arguments) -> Type:
    a, b = args
    fits = all(x.kind in ("array", "number") and x.dtype in ORDER for x in args) and 0 < a.rank + b.rank <= 4
    return array(common(args), a.rank + b.rank) if fits else UNKNOWN


def _quotient(args: list[Type], options: Arguments) -> Type:
    return _float(_outer(args, options))


def _crossed(args: list[Type], options: Arguments) -> Type:
    fits = all(a.is_array and 1 <= a.rank <= 2 for a in args)
    return array(common(args), max(a.rank for a in args)) if fits else UNKNOWN


def _powers(args: list[Type], options: Arguments) -> Type:
    fits = is_expandable(args) and args[0].rank == 1 and isinstance(options["increasing"], Constant)
    return array("float64" if args[0].dtype == "float32" else args[0].dtype, 2) if fits else UNKNOWN


def _polynomial(args: list[Type], options: Arguments) -> Type:
    p, x = args
    known = p.is_array and p.rank == 1 and p.dtype in ORDER and x.is_float
    return (array(common(args), x.rank) if x.rank else Type("number", "float64")) if known else UNKNOWN


def _running_extreme(args: list[Type], options: Arguments) -> Type:
    return args[0] if is_expandable(args) and one_axis(options["axis"], args[0].rank) is not None else UNKNOWN


def _running_logarithm(args: list[Type], options: Arguments) -> Type:
    return _running_extreme(args, options) if args[0].is_float else UNKNOWN


def _sum_of_exponentials(args: list[Type], options: Arguments) -> Type:
    return _averaged(args, options) if is_none(options["b"]) else UNKNOWN


def _shares(args: list[Type], options: Arguments) -> Type:
    return _float(args[0]) if is_expandable(args) and axes_of(options["axis"], args[0].rank) else UNKNOWN


SUMS: dict[str, Callable[[list[Type], Arguments], Type]] = {
    "numpy.var": _averaged, "numpy.std": _averaged, "numpy.prod": _product, "numpy.cumprod": running,
    "numpy.cumsum": running, "numpy.average": _average, "numpy.linalg.norm": _norm,
    "numpy.vdot": _vdot, "numpy.inner": _inner, "numpy.trapezoid": _trapezoid, "numpy.trapz": _trapezoid,
    "numpy.nansum": summed, "numpy.nanmean": _averaged, "numpy.kron": _kron,
    "numpy.nan_to_num": _numbered, "numpy.linalg.cond": _condition,
    **dict.fromkeys(("numpy.linalg.svd.left", "numpy.linalg.svd.right", "numpy.linalg.qr.orthogonal",
                     "numpy.linalg.qr.triangular"), _vectors),
    "scipy.special.logsumexp": _sum_of_exponentials, "scipy.special.softmax": _shares,
    "scipy.special.log_softmax": _shares,
    "numpy.maximum.accumulate": _running_extreme, "numpy.minimum.accumulate": _running_extreme,
    **{f"numpy.{f}.outer": _outer for f in ("add", "subtract", "multiply", "power", "maximum", "minimum")},
    "numpy.logaddexp.accumulate": _running_logarithm,
    **{f"numpy.{f}.outer": _quotient for f in ("divide", "hypot", "logaddexp", "arctan2")},
    "numpy.cross": _crossed, "numpy.vander": _powers, "numpy.polyval": _polynomial,
    "numpy.correlate": _convolve, "numpy.gradient": _gradient, "numpy.convolve": _convolve, "numpy.interp": _interp,
}
