"""The type of an expanded function that finds indices, sorts or selects, or that stores through indices; UNKNOWN where
its arguments have no expansion."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import is_true, of_rank, whole_number
from s2sad.infer.signatures.options import Arguments, is_none, one_axis
from s2sad.infer.promotion import ORDER
from s2sad.infer.types import INT, UNKNOWN, Type, array
from s2sad.tree import Constant, List, Tuple



def _part(options: Arguments, count: int) -> int | None:
    """The number of the requested part, if there is such a part."""
    found = whole_number(options["part"])
    return found if found is not None and 0 <= found < count else None


def _places(kind: Type) -> list[Type]:
    return list(kind.items) if kind.kind == "tuple" else [kind]


def _stored(args: list[Type], options: Arguments) -> Type:
    """Of `np.add.at`: with one array of places or several of one axis, or a mask."""
    x, places, values = args
    if x.is_array and places.is_array and places.dtype == "bool":
        return x if places.rank == x.rank and values.kind in ("array", "number") and values.rank <= 1 else UNKNOWN
    indices = _places(places)
    fits = x.is_array and 0 < len(indices) <= x.rank and all(p.holds_integers and p.rank <= 1 for p in indices)
    left = x.rank - len(indices) + max((p.rank for p in indices), default=0)
    return x if fits and values.kind in ("array", "number") and values.rank <= left else UNKNOWN


def _diagonal_filled(args: list[Type], options: Arguments) -> Type:
    x, values = args
    return x if x.is_array and x.rank == 2 and values.kind in ("array", "number") and values.rank < 2 else UNKNOWN


def _nonzero(args: list[Type], options: Arguments) -> Type:
    x = args[0]
    return array("int64", 1) if x.is_array and x.rank <= 3 and _part(options, x.rank) is not None else UNKNOWN


def _sorted(args: list[Type], options: Arguments) -> Type:
    x = args[0]
    if not x.is_array or x.rank > 3:
        return UNKNOWN
    if is_none(options["axis"]):
        return array(x.dtype, 1)
    return x if one_axis(options["axis"], x.rank) is not None else UNKNOWN


def _taken(args: list[Type], options: Arguments) -> Type:
    x, places = args[:2]
    spelled = options["places"]
    rank = 1 if isinstance(spelled, (List, Tuple)) else places.rank
    whole = places.holds_integers or places.kind == "tuple" and all(
        i.holds_integers and not i.rank for i in places.items)
    if not x.is_array or not whole or rank > 1:
        return UNKNOWN
    if is_none(options["axis"]):
        return of_rank(x, rank)
    return of_rank(x, x.rank - 1 + rank) if one_axis(options["axis"], x.rank) is not None else UNKNOWN


def _taken_along(args: list[Type], options: Arguments) -> Type:
    x, places = args[:2]
    fits = x.is_array and places.is_array and places.holds_integers and places.rank == x.rank <= 3
    return x if fits and one_axis(options["axis"], x.rank) is not None else UNKNOWN


def _selected(args: list[Type], options: Arguments) -> Type:
    conditions, choices = (options[o] for o in ("conditions", "choices"))
    if not all(isinstance(o, (List, Tuple)) for o in (conditions, choices)):
        return UNKNOWN
    kinds = [*args[1].items, args[2]]
    if len(conditions.elts) != len(choices.elts) or not kinds or any(k.dtype not in ORDER for k in kinds):
        return UNKNOWN
    dtype = max((k.dtype for k in kinds), key=ORDER.index)
    rank = max(k.rank for k in (*kinds, *args[0].items))
    return array(dtype, rank) if rank else UNKNOWN


def _grid(args: list[Type], options: Arguments) -> Type:
    vectors = [a for a in args[:3] if a.kind != "none"]
    part = _part(options, len(vectors))
    mode = getattr(options["indexing"], "value", None)
    fits = all(v.is_array and v.rank == 1 for v in vectors) and mode in ("xy", "ij")
    return array(vectors[part].dtype, len(vectors)) if fits and part is not None else UNKNOWN


def _indices(args: list[Type], options: Arguments) -> Type:
    count = len(args[0].items)
    if args[0].kind != "tuple" or not 0 < count <= 3 or not all(i.holds_integers for i in args[0].items):
        return UNKNOWN
    if is_none(options["part"]):
        return array("int64", count + 1)
    return array("int64", count) if _part(options, count) is not None else UNKNOWN


def _unraveled(args: list[Type], options: Arguments) -> Type:
    place, shape = args[:2]
    known = shape.kind == "tuple" and place.holds_integers and place.rank == 0
    return INT if known and _part(options, len(shape.items)) is not None else UNKNOWN


def _triangle_places(args: list[Type], options: Arguments) -> Type:
    numbers = [a for a in args if a.kind != "none"]
    whole = all(a.holds_integers and not a.rank for a in numbers)
    return array("int64", 1) if whole and _part(options, 2) is not None else UNKNOWN


def _counted(args: list[Type], options: Arguments) -> Type:
    x, weights, least = args
    fits = x.is_array and x.holds_integers and x.rank == 1 and least.holds_integers and (
        weights.kind == "none" or weights.is_array and weights.rank == 1)
    return array("int64" if weights.kind == "none" else "float64", 1) if fits else UNKNOWN


def _middle(args: list[Type], options: Arguments) -> Type:
    x = args[0]
    kept = options["keepdims"]
    if not x.is_array or not x.is_float or not (isinstance(kept, Constant) and isinstance(kept.value, bool)):
        return UNKNOWN
    if is_true(kept):
        return UNKNOWN if is_none(options["axis"]) or one_axis(options["axis"], x.rank) is None else x.plain
    if is_none(options["axis"]):
        return of_rank(x, 0)
    return of_rank(x, x.rank - 1) if one_axis(options["axis"], x.rank) is not None else UNKNOWN


def _quantile(args: list[Type], options: Arguments) -> Type:
    q, one = args[1], _middle(args, options)
    if q.is_number:
        return one
    several = q.kind == "tuple" and bool(q.items) and all(i.is_number for i in q.items) or q.is_array and q.rank == 1
    return array(one.dtype, one.rank + 1) if several and one.dtype == "float64" else UNKNOWN


def _insertion_indices(args: list[Type], options: Arguments) -> Type:
    a, v = args[:2]
    side = getattr(options["side"], "value", None)
    return array("int64", v.rank) if a.is_array and a.rank == 1 and v.is_array and v.rank <= 2 and side in (
        "left", "right") else UNKNOWN


def _extreme_place(args: list[Type], options: Arguments) -> Type:
    x = args[0]
    return of_rank(array("int64", 1), x.rank - 1) if x.is_array and x.rank <= 3 and one_axis(
        options["axis"], x.rank) is not None else UNKNOWN


def _order(args: list[Type], options: Arguments) -> Type:
    made = _sorted(args, options)
    return UNKNOWN if is_none(options["axis"]) or not made.is_array else array("int64", made.rank)


PLACES: dict[str, Callable[[list[Type], Arguments], Type]] = {
    **{f"numpy.{f}.at": _stored for f in ("add", "subtract", "multiply", "divide", "maximum", "minimum")},
    "numpy.searchsorted.each": _insertion_indices,
    "numpy.argmax.along": _extreme_place, "numpy.argmin.along": _extreme_place,
    "numpy.argsort.along": _order, "numpy.fill_diagonal": _diagonal_filled, "numpy.nonzero": _nonzero,
    "numpy.sort": _sorted,
    "numpy.take": _taken,
    "numpy.take_along_axis": _taken_along, "numpy.select": _selected, "numpy.meshgrid": _grid,
    "numpy.indices": _indices, "numpy.unravel_index": _unraveled, "numpy.triu_indices": _triangle_places,
    "numpy.tril_indices": _triangle_places, "numpy.diag_indices": _triangle_places, "numpy.bincount": _counted,
    "numpy.median": _middle, "numpy.percentile": _quantile, "numpy.quantile": _quantile,
}
