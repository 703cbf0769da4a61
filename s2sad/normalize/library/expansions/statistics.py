"""Expansions of statistics without nans and of several variables, of `reduceat` and of polynomials."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import CallArguments, empty, guard, lines, part, size, sizes, zeros
from s2sad.normalize.library.expansions.reductions import options_of, root_of

_NONE = "numpy.where(numpy.isnan(x), 0.0, 1.0)"


# -- without nans ----------------------------------------------------------------------------------------------------

def _nan_extreme(args: CallArguments, function: str) -> str:
    """nan where there is nothing but nans."""
    options, bound = options_of(args, args.rank("x")), "-numpy.inf" if function == "max" else "numpy.inf"
    found = [f"there = numpy.where(numpy.isnan(x), {bound}, x)", f"counted = numpy.sum({_NONE}{options})",
             f"found = numpy.{function}(there{options})"]
    if _gives_number(args):
        return lines(*found, "if counted == 0.0:", "    result = numpy.nan", "else:", "    result = found")
    return lines(*found, "result = numpy.where(counted == 0.0, numpy.nan, found)")


def _gives_number(args: CallArguments) -> bool:
    rank = args.rank("x")
    return not args.has("axis") or len(args.axes(rank)) == rank and not args.flag("keepdims")


def _nan_var(args: CallArguments, result: str = "result") -> str:
    options = options_of(args, args.rank("x"))
    kept = options if "keepdims" in options or not options else f"{options}, keepdims=True"
    ddof, rank, kind = args.number("ddof") or 0, args.rank("x"), args.type("x").dtype
    count = f"numpy.sum(counted{options})" if not ddof else f"numpy.maximum(numpy.sum(counted{options}) - {ddof}, 0.0)"
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)", f"counted = {empty(sizes('x', rank), kind)}",
                 f"counted[...] = {_NONE}",
                 f"middle = numpy.sum(there{kept}) / numpy.sum(counted{kept})",
                 "apart = numpy.where(numpy.isnan(x), 0.0, x - middle)",
                 f"{result} = numpy.sum(apart * apart{options}) / {count}")


def _nan_std(args: CallArguments) -> str:
    return lines(_nan_var(args, "squared"), root_of(args, "squared"))


def _nancumsum(args: CallArguments) -> str:
    axis = f", axis={args.axis(args.rank('x'))}" if args.has("axis") else ""
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)", f"result = numpy.cumsum(there{axis})")


# -- sums over slices ------------------------------------------------------------------------------------------------

def _reduceat(args: CallArguments) -> str:
    """From each index to the next one, the element itself where that is not greater."""
    axis, rank = args.axis(args.rank("x")), args.rank("x")
    args.as_array("places")
    whole = sizes("x", rank)
    whole[axis] = "held_places.shape[0]"
    return lines("held_places = numpy.copy(places)", f"result = {zeros(whole, args.type('x').dtype)}",
                 "for place in range(held_places.shape[0]):", "    start = held_places[place]",
                 f"    stop = {size('x', axis)}", "    if place + 1 < held_places.shape[0]:",
                 "        stop = max(start + 1, held_places[place + 1])", "    for entry in range(start, stop):",
                 f"        {part('result', axis, 'place')} += {part('x', axis, 'entry')}")


# -- several variables -----------------------------------------------------------------------------------------------

def _cov(args: CallArguments) -> str:
    ddof = args.number("ddof") if args.has("ddof") else int(not args.flag("bias"))
    if args.rank("m") == 1 and not args.has("y"):
        return lines(f"row = {_as_float64(args, 'm')}", f"result = numpy.var(row, ddof={ddof})")
    return lines(*_centered_rows(args, "cov"),
                 f"result = numpy.matmul(apart, numpy.transpose(apart)) / max(rows.shape[1] - {ddof}, 0)")


def _corrcoef(args: CallArguments) -> str:
    return lines(*_centered_rows(args, "corrcoef"),
                 "products = numpy.matmul(apart, numpy.transpose(apart))", "scale = numpy.sqrt(numpy.diag(products))",
                 "result = numpy.clip(products / scale[:, None] / scale[None, :], -1.0, 1.0)")


def _centered_rows(args: CallArguments, function: str) -> list[str]:
    """The variables in rows, without their means; of one NumPy gives a number."""
    if args.has("y"):
        found = [f"rows = numpy.stack([{_as_float64(args, 'm')}, {_as_float64(args, 'y')}])"]
    else:
        rows = args.flag("rowvar")
        given = f"{size('m', 0 if rows else 1)} != 1"
        found = [guard(given, f"np.{function} of one variable is a number: give it as an array with one axis"),
                 f"held = {_as_float64(args, 'm')}", f"rows = {'held' if rows else 'numpy.transpose(held)'}"]
    return [*found, "apart = rows - numpy.mean(rows, axis=1, keepdims=True)"]


def _as_float64(args: CallArguments, operand: str) -> str:
    """An operand as float64, which NumPy computes these in."""
    return operand if args.type(operand).dtype == "float64" else f"numpy.astype({operand}, dtype=numpy.float64)"


# -- polynomials -----------------------------------------------------------------------------------------------------

def _polyfit(args: CallArguments) -> str:
    """Least squares of powers, each column by its length, as NumPy has it."""
    return lines("points = x + 0.0", "powers = numpy.vander(points, N=deg + 1)",
                 "scale = numpy.sqrt(numpy.sum(powers * powers, axis=0))", "columns = powers / scale",
                 "values = y + 0.0", "found = runtime.least_squares(columns, values)", "result = found / scale")


def _polyder(args: CallArguments) -> str:
    return lines(f"count = max({size('p', 0)} - 1, 0)", f"result = {empty(['count'], args.type('p').dtype)}",
                 "for place in range(count):", "    result[place] = p[place] * (count - place)")


def _polyint(args: CallArguments) -> str:
    n = size("p", 0)
    return lines(f"result = {zeros([f'{n} + 1'], 'float64')}", f"for place in range({n}):",
                 f"    result[place] = p[place] / ({n} - place)")


def _polymul(args: CallArguments) -> str:
    fits = [guard(f"{size(p, 0)} == 1 or {p}[0] != 0", "np.polymul leaves leading zeros out: write np.convolve")
            for p in "ab"]
    return lines(*fits, "result = numpy.convolve(a, b)")


def _geomspace(args: CallArguments) -> str:
    kept = "" if args.flag("endpoint") else ", endpoint=False"
    return lines(guard("start > 0 and stop > 0", "np.geomspace between numbers above 0"),
                 f"powers = numpy.linspace(numpy.log(start), numpy.log(stop), num=num{kept})",
                 "result = numpy.exp(powers)")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.nanmax": lambda args: _nan_extreme(args, "max"), "numpy.nanmin": lambda args: _nan_extreme(args, "min"),
    "numpy.nanvar": _nan_var, "numpy.nanstd": _nan_std, "numpy.nancumsum": _nancumsum,
    "numpy.add.reduceat": _reduceat, "numpy.cov": _cov, "numpy.corrcoef": _corrcoef, "numpy.polyfit": _polyfit,
    "numpy.polyder": _polyder, "numpy.polyint": _polyint, "numpy.polymul": _polymul, "numpy.geomspace": _geomspace,
}
