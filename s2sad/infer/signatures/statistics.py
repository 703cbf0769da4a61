"""The type of statistics that pass over nans, of several variables, of parts one after the other, and of polynomials;
UNKNOWN where the arguments have no expansion."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.signatures.options import Arguments, is_none, one_axis
from s2sad.infer.promotion import ORDER, common, is_expandable
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.infer.signatures.reductions import running, summed
from s2sad.tree import Constant


def _spread(args: list[Type], options: Arguments) -> Type:
    return summed(args, options) if whole_number(options["ddof"]) in (0, 1) else UNKNOWN


def _running(args: list[Type], options: Arguments) -> Type:
    return running(args, options) if args[0].is_float else UNKNOWN


def _parts_added(args: list[Type], options: Arguments) -> Type:
    x, places = args[:2]
    listed = places.kind == "tuple" and places.items and all(i.dtype.startswith("int") and not i.rank
                                                             for i in places.items)
    fits = listed or places.is_array and places.rank == 1 and places.dtype.startswith(("int", "uint"))
    known = is_expandable([x]) and x.is_float and fits and one_axis(options["axis"], x.rank) is not None
    return array(x.dtype, x.rank) if known else UNKNOWN


def _variables(args: list[Type], options: Arguments) -> int:
    """How many axes the covariance of these has; -1 if they are none that it is known of."""
    m, y = args[0], args[1]
    if not is_expandable([m]) or not isinstance(options["rowvar"], Constant) or m.is_complex:
        return -1
    if y.kind != "none":
        fits = y.is_array and m.rank == y.rank == 1 and options["rowvar"].value is True and y.dtype in ORDER
        return 2 if fits else -1
    return {1: 0, 2: 2}.get(m.rank, -1)


def _cov(args: list[Type], options: Arguments) -> Type:
    known = isinstance(options["bias"], Constant) and (is_none(options["ddof"]) or whole_number(
        options["ddof"]) is not None)
    rank = _variables(args, options) if known else -1
    return UNKNOWN if rank < 0 else Type("number", "float64") if rank == 0 else array("float64", 2)


def _corrcoef(args: list[Type], options: Arguments) -> Type:
    return array("float64", 2) if _variables(args, options) == 2 else UNKNOWN


def _polyfit(args: list[Type], options: Arguments) -> Type:
    x, y, degree = args
    fits = all(a.is_array and a.rank == 1 and a.dtype in ("float64", "int64") for a in (x, y))
    return array("float64", 1) if fits and degree.is_integer and degree.is_number else UNKNOWN


def _derived(args: list[Type], options: Arguments) -> Type:
    p = args[0]
    return array(p.dtype, 1) if p.is_array and p.rank == 1 and p.dtype == "float64" else UNKNOWN


def _product(args: list[Type], options: Arguments) -> Type:
    fits = all(a.is_array and a.rank == 1 and a.dtype in ORDER for a in args)
    return array(common(args), 1) if fits else UNKNOWN


def _geomspace(args: list[Type], options: Arguments) -> Type:
    numbers = all(a.is_number and not a.is_complex for a in args)
    return array("float64", 1) if isinstance(options["endpoint"], Constant) and numbers else UNKNOWN


STATISTICS: dict[str, Callable[[list[Type], Arguments], Type]] = {
    "numpy.nanmax": summed, "numpy.nanmin": summed, "numpy.nanvar": _spread, "numpy.nanstd": _spread,
    "numpy.nancumsum": _running, "numpy.add.reduceat": _parts_added, "numpy.cov": _cov, "numpy.corrcoef": _corrcoef,
    "numpy.polyfit": _polyfit, "numpy.polyder": _derived, "numpy.polyint": _derived, "numpy.polymul": _product,
    "numpy.geomspace": _geomspace,
}
