"""The type of a function that leaves elements out, repeats them or puts others between, or that counts in bins; UNKNOWN
where its arguments have no expansion."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import is_true, whole_number
from s2sad.infer.signatures.options import Arguments, is_none, one_axis
from s2sad.infer.promotion import ORDER, common, is_expandable
from s2sad.infer.types import INT, UNKNOWN, Type, array
from s2sad.tree import Constant, List, Tuple


def _whole(kind: Type) -> bool:
    """Whether an argument is an integer, or an array or a list display of them."""
    if kind.kind == "tuple":
        return bool(kind.items) and all(_whole(i) and not i.rank for i in kind.items)
    return kind.holds_integers


def _rank(kind: Type) -> int:
    return 1 if kind.kind == "tuple" else kind.rank


def _flags(options: Arguments, *names: str) -> bool:
    return all(isinstance(options[n], Constant) and isinstance(options[n].value, bool) for n in names)


def _along(x: Type, options: Arguments) -> Type:
    """The array itself, or its elements in a row."""
    if not is_expandable([x]):
        return UNKNOWN
    if is_none(options["axis"]):
        return array(x.dtype, 1)
    return x if one_axis(options["axis"], x.rank) is not None else UNKNOWN


def _plain(x: Type) -> Type:
    return array(x.dtype, x.rank) if x.is_array else x


def _deleted(args: list[Type], options: Arguments) -> Type:
    places = args[1]
    masked = places.is_array and places.dtype == "bool"
    return _plain(_along(args[0], options)) if (_whole(places) or masked) and _rank(places) <= 1 else UNKNOWN


def _inserted(args: list[Type], options: Arguments) -> Type:
    x, place, values = args[:3]
    made = _along(x, options)
    fits = _whole(place) and not _rank(place) and values.kind in ("array", "number") and x.is_float
    return _plain(made) if fits and values.dtype in ORDER and not values.is_complex and made.is_array and (
        values.rank <= max(made.rank - 1, 1)) else UNKNOWN


def repeated(args: list[Type], options: Arguments) -> Type:
    return _plain(_along(args[0], options)) if _whole(args[1]) and _rank(args[1]) == 1 else UNKNOWN


def _compressed(args: list[Type], options: Arguments) -> Type:
    condition, x = args[:2]
    listed = condition.kind == "tuple" and condition.items and all(i.dtype == "bool" for i in condition.items)
    return _plain(_along(x, options)) if listed or condition.is_array and condition.rank == 1 else UNKNOWN


def _extracted(args: list[Type], options: Arguments) -> Type:
    fits = is_expandable([args[1]]) and args[0].is_array and args[1].rank
    return array(args[1].dtype, 1) if fits else UNKNOWN


def _chosen(args: list[Type], options: Arguments) -> Type:
    a, choices = args
    display = isinstance(options["choices"], (List, Tuple)) and choices.items
    known = display and all(c.kind in ("array", "number") and c.dtype in ORDER for c in choices.items)
    if not known or not a.is_array or not _whole(a) or max(c.rank for c in choices.items) > a.rank:
        return UNKNOWN
    return array(common(list(choices.items)), a.rank)


def _digitized(args: list[Type], options: Arguments) -> Type:
    x, bins = args[:2]
    fits = bins.is_array and bins.rank == 1 and x.kind in ("array", "number") and x.rank <= 2
    return (array("int64", x.rank) if x.rank else INT) if fits and _flags(options, "right") else UNKNOWN


def _is_in(args: list[Type], options: Arguments) -> Type:
    a, values = args[:2]
    fits = a.is_array and _whole(a) and _whole(values) and _rank(values) == 1 and _flags(options, "invert")
    return array("bool", a.rank) if fits else UNKNOWN


def _left_over(args: list[Type], options: Arguments) -> Type:
    a, values = args
    fits = a.is_array and values.is_array and all(k.rank == 1 and _whole(k) for k in args)
    return array(a.dtype, 1) if fits and a.dtype == "int64" else UNKNOWN


def _argwhere(args: list[Type], options: Arguments) -> Type:
    return array("int64", 2) if args[0].is_array and args[0].rank <= 3 else UNKNOWN


def _lexsorted(args: list[Type], options: Arguments) -> Type:
    display = isinstance(options["keys"], (List, Tuple)) and args[0].items
    return array("int64", 1) if display and all(k.is_array and k.rank == 1 for k in args[0].items) else UNKNOWN


def _unique(args: list[Type], options: Arguments) -> Type:
    x, flags = args[0], ("return_index", "return_inverse", "return_counts")
    if not x.is_array or x.rank != 1 or x.dtype not in ORDER or x.is_complex or not _flags(options, *flags):
        return UNKNOWN
    number, most = whole_number(options["part"]), sum(options[f].value for f in flags)
    if number is None and most or (number or 0) > most:         # a tuple that nothing has taken apart
        return UNKNOWN
    return array("int64" if number else x.dtype, 1)


def _histogram(args: list[Type], options: Arguments) -> Type:
    x, bins, ends, weights = args[0], args[1], options["range"], args[4]
    display = isinstance(ends, (List, Tuple)) and len(ends.elts) == 2
    edges = bins.is_array and bins.rank == 1 and bins.is_float and is_none(ends)
    bounded = display or is_none(ends) and x.dtype in ("float64", "int64")
    known = edges or _whole(bins) and not _rank(bins) and bounded
    dense = is_true(options["density"])
    weighted = weights.is_array and weights.rank == 1 and weights.is_float
    part = whole_number(options["part"])
    if not (dense or is_none(options["density"]) or _flags(options, "density")):
        return UNKNOWN
    plain = display and all(isinstance(getattr(e, "operand", e), Constant) for e in ends.elts)
    if x.dtype == "float32" and not edges and not plain:
        return UNKNOWN      # the edges' dtype is that of the ends, too
    if not known or not x.is_array or x.rank != 1 or not (weighted or weights.kind == "none") or part not in (0, 1):
        return UNKNOWN
    if not part:
        return array("float64" if dense else weights.dtype if weighted else "int64", 1)
    return array(bins.dtype if edges else "float32" if x.dtype == "float32" else "float64", 1)


def _put(args: list[Type], options: Arguments) -> Type:
    x, places, values = args
    fits = values.kind in ("array", "number") and values.rank <= 1 or values.kind == "tuple" and all(
        i.is_number for i in values.items)
    return x if x.is_array and x.rank <= 3 and _whole(places) and _rank(places) <= 1 and fits else UNKNOWN


def _masked(args: list[Type], options: Arguments) -> Type:
    x, mask, values = args
    fits = mask.is_array and mask.dtype == "bool" and mask.rank == x.rank
    return x if x.is_array and fits and values.kind in ("array", "number") and values.rank in (0, x.rank) else UNKNOWN


SELECTIONS: dict[str, Callable[[list[Type], Arguments], Type]] = {
    "numpy.delete": _deleted, "numpy.insert": _inserted, "numpy.compress": _compressed, "numpy.choose": _chosen,
    "numpy.extract": _extracted,
    "numpy.digitize": _digitized, "numpy.isin": _is_in, "numpy.setdiff1d": _left_over,
    "numpy.argwhere": _argwhere, "numpy.lexsort": _lexsorted,
    "numpy.unique": _unique, "numpy.histogram": _histogram, "numpy.put": _put, "numpy.putmask": _masked,
}
