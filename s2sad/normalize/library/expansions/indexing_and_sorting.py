"""Expansions of functions that search, sort and select, and of stores through indices."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import axes_of
from s2sad.normalize.library.expansions.templates import (
    NOT_AS_MANY, WEIGHTS, CallArguments, empty, guard, lines, part, size, sizes, zeros,
)
from s2sad.tree import List, Tuple, call

_SIGNS = {"add": "+=", "subtract": "-=", "multiply": "*=", "divide": "/="}


def _nest(counters: list[str], bounds: list[str], body: list[str]) -> list[str]:
    """Loops around a body, which is not indented."""
    heads = [f"{'    ' * k}for {c} in range({b}):" for k, (c, b) in enumerate(zip(counters, bounds))]
    return [*heads, *("    " * len(counters) + line for line in body)]


def _counters(rank: int, first: int = 0) -> list[str]:
    return [f"place{k}" for k in range(first, first + rank)]


# -- stores ----------------------------------------------------------------------------------------------------------

def _ufunc_at(args: CallArguments, function: str) -> str:
    """One store for each index, also where one occurs twice; the values are what they were before."""
    if args.type("places").dtype == "bool" and args.rank("places"):
        return _ufunc_at_mask(args, function)
    given = [args.let("places", node) for node in args.items("places")] if isinstance(
        args.arguments["places"], Tuple) else ["places"]
    arrays = [g for g in given if args.rank(g)]
    left = args.rank("x") - len(given) + (1 if arrays else 0)
    values = "held" if args.rank("values") else "values"
    taken = f"{values}[place]" if arrays and args.rank("values") == left else values
    cell = f"x[{', '.join(f'{g}[place]' if g in arrays else g for g in given)}]"
    store = f"{cell} {_SIGNS[function]} {taken}" if function in _SIGNS else (
        f"{cell} = numpy.{function}({cell}, {taken})")
    before = ["held = numpy.copy(values)"] if values == "held" else []
    if not arrays:
        return lines(*before, store)
    fits = [guard(f"{size(g, 0)} == {size(arrays[0], 0)}", NOT_AS_MANY) for g in arrays[1:]]
    fits += [guard(f"{size('held', 0)} == {size(arrays[0], 0)}", NOT_AS_MANY)] if taken != values else []
    return lines(*before, *fits, f"for place in range({size(arrays[0], 0)}):", f"    {store}")


def _ufunc_at_mask(args: CallArguments, function: str) -> str:
    """A store into what a mask selects, which has no element twice."""
    before, values = (["held = numpy.copy(values)"], "held") if args.rank("values") else ([], "values")
    store = f"x[places] {_SIGNS[function]} {values}" if function in _SIGNS else (
        f"x[places] = numpy.{function}(x[places], {values})")
    return lines(*before, store)


def _fill_diagonal(args: CallArguments) -> str:
    count = f"min({size('x', 0)}, {size('x', 1)})"
    if not args.rank("values"):
        return lines(f"for place in range({count}):", "    x[place, place] = values")
    fits = guard(f"{size('held', 0)} >= {count}", "np.fill_diagonal with fewer values than the diagonal has")
    return lines("held = numpy.copy(values)", fits, f"for place in range({count}):",
                 "    x[place, place] = held[place]")


# -- indices ---------------------------------------------------------------------------------------------------------

def _nonzero(args: CallArguments) -> str:
    return lines("count = numpy.count_nonzero(x)", f"result = runtime.places(x, count, {args.number('part') or 0})")


def _triangle_indices(args: CallArguments, bounds: tuple[str, str]) -> str:
    low, high = (b.format(m="m" if args.has("m") else "n") for b in bounds)
    value = "row" if args.number("part") == 0 else "column"
    walk = ["for row in range(n):", f"    for column in range({low}, {high}):"]
    return lines("count = 0", *walk, "        count += 1", f"result = {empty(['count'], 'int64')}", "taken = 0",
                 *walk, f"        result[taken] = {value}", "        taken += 1")


def _shape_items(args: CallArguments) -> list[str]:
    """The sizes that a shape has."""
    node = args.arguments["shape"]
    if isinstance(node, (Tuple, List)):
        return [args.let("size", s) for s in node.elts]
    return [f"shape[{k}]" for k in range(len(args.type("shape").items))]


def _unravel_index(args: CallArguments) -> str:
    found = _shape_items(args)
    number = args.number("part") or 0
    below = " * ".join(f"({s})" for s in found[number + 1:])
    left = f"place // ({below})" if below else "place"
    return f"result = {left} % {found[number]}" if number else f"result = {left}"


def _indices(args: CallArguments) -> str:
    found = _shape_items(args)
    count = len(found)
    counters = _counters(count)
    taken = ", ".join(counters)
    if args.has("part"):
        return lines(f"result = {empty(found, 'int64')}",
                     *_nest(counters, found, [f"result[{taken}] = {counters[args.number('part') or 0]}"]))
    return lines(f"result = {empty([str(count), *found], 'int64')}", *_nest(counters, found, [
        f"result[{k}, {taken}] = {c}" for k, c in enumerate(counters)]))


def _meshgrid(args: CallArguments) -> str:
    vectors = [v for v in "xyz" if args.has(v)] if args.has("z") else ["x", "y"]
    order = list(range(len(vectors)))
    if args.text("indexing") == "xy":
        order[:2] = [1, 0]
    number = args.number("part") or 0
    taken = ", ".join(":" if k == number else "None" for k in order)
    return lines(f"result = {empty([size(vectors[k], 0) for k in order], args.type(vectors[number]).dtype)}",
                 f"result[{', '.join([':'] * len(order))}] = {vectors[number]}[{taken}]")


# -- sorting ---------------------------------------------------------------------------------------------------------

def _subscripts_along(rank: int, axis: int, taken: str) -> str:
    """Subscripts with counters but along one axis."""
    return ", ".join(taken if k == axis else f"place{k}" for k in range(rank))


def _other_axes(array: str, rank: int, axis: int) -> tuple[list[str], list[str]]:
    kept = [k for k in range(rank) if k != axis]
    return [f"place{k}" for k in kept], [size(array, k) for k in kept]


def _sort(args: CallArguments) -> str:
    """The elements in sorted order: the adjoint of each is that of its place in the result."""
    rank = args.rank("x")
    if not args.has("axis") and rank > 1:
        return lines("flat = numpy.ravel(x)", "result = numpy.sort(flat)")
    axis = args.axis(rank) if args.has("axis") else 0
    if rank == 1:
        return lines("order = numpy.argsort(x)", "result = x[order]")
    counters, bounds = _other_axes("x", rank, axis)
    row = _subscripts_along(rank, axis, ":")
    return lines(f"result = {empty(sizes('x', rank), args.type('x').dtype)}", *_nest(counters, bounds, [
        f"row = numpy.copy(x[{row}])", "order = numpy.argsort(row)", f"result[{row}] = row[order]"]))


def _argsort(args: CallArguments) -> str:
    rank = args.rank("x")
    kind = ", kind='mergesort'" if args.has("kind") else ""
    axis = args.axis(rank)
    counters, bounds = _other_axes("x", rank, axis)
    row = _subscripts_along(rank, axis, ":")
    return lines(f"result = {empty(sizes('x', rank), 'int64')}", *_nest(counters, bounds, [
        f"row = numpy.copy(x[{row}])", f"order = numpy.argsort(row{kind})", f"result[{row}] = order"]))


def _nan_to_num(args: CallArguments) -> str:
    largest = "3.4028234663852886e+38" if args.type("x").dtype == "float32" else "1.7976931348623157e+308"
    high, low = ("posinf" if args.has("posinf") else largest, "neginf" if args.has("neginf") else f"-{largest}")
    return lines(f"high = numpy.where(x > {largest}, {high}, x)", f"low = numpy.where(x < -{largest}, {low}, high)",
                 "result = numpy.where(numpy.isnan(x), nan, low)")


def _take(args: CallArguments) -> str:
    node = args.arguments["places"]
    rank = args.rank("x")
    before = []
    if isinstance(node, (List, Tuple)):
        args.arguments["spelled"] = call("numpy.array", node)
        before = ["taken = spelled"]
    elif args.rank("places"):
        before = ["taken = numpy.copy(places)"]
    whole = "taken" if before else "places"
    if not args.has("axis") and rank > 1:
        return lines(*before, "flat = numpy.ravel(x)", f"result = flat[{whole}]")
    axis = args.axis(rank) if args.has("axis") else 0
    return lines(*before, f"result = {part('x', axis, whole)}")


def _take_along_axis(args: CallArguments) -> str:
    rank = args.rank("x")
    axis = (axes_of(args.arguments["axis"], rank) or (0,))[0]
    counters = _counters(rank)
    found = _subscripts_along(rank, axis, f"places[{', '.join(counters)}]")
    message = "np.take_along_axis with places for another number of rows: repeat them"
    fits = [guard(f"{size('places', k)} == {size('x', k)}", message) for k in range(rank) if k != axis]
    return lines(*fits, f"result = {empty(sizes('places', rank), args.type('x').dtype)}", *_nest(
        counters, sizes("places", rank), [f"result[{', '.join(counters)}] = x[{found}]"]))


def _median(args: CallArguments) -> str:
    rank = args.rank("x")
    if rank > 1 and not args.has("axis"):
        return lines("flat = numpy.ravel(x)", "result = numpy.median(flat)")
    axis = args.axis(rank) if args.has("axis") else 0
    n = size("x", axis)
    low, high = _sorted_part(args, axis, f"({n} - 1) // 2"), _sorted_part(args, axis, f"{n} // 2")
    return lines(f"sorted_x = numpy.sort(x, axis={axis})", *_nan_or(args, axis, f"0.5 * ({low} + {high})"))


def _sorted_part(args: CallArguments, axis: int, place: str) -> str:
    """The elements at a place, along an axis that may be kept."""
    return part("sorted_x", axis, f"{place}, None" if args.flag("keepdims") else place)


def _nan_or(args: CallArguments, axis: int, text: str, target: str = "result") -> list[str]:
    """A value between sorted elements, nan where one is: nans come last."""
    last = _sorted_part(args, axis, f"{size('x', axis)} - 1")
    if args.rank("x") == 1 and not args.flag("keepdims"):
        return [f"if {last} != {last}:", f"    {target} = {last}", "else:", f"    {target} = {text}"]
    return [f"middle = {text}", f"{target} = numpy.where({last} != {last}, {last}, middle)"]


def _quantile(args: CallArguments, scale: str) -> str:
    """Linear between the two neighbours in sorted order."""
    rank = args.rank("x")
    name = "quantile" if scale == "1.0" else "percentile"
    if rank > 1 and not args.has("axis"):
        return lines("flat = numpy.ravel(x)", f"result = numpy.{name}(flat, q)")
    axis = args.axis(rank) if args.has("axis") else 0
    low, high = _sorted_part(args, axis, "below"), _sorted_part(args, axis, "above")
    args.as_array("q")
    several = bool(args.rank("q"))
    found = [f"level = {'q[place]' if several else 'q'} / {scale} * last",
             guard("0.0 <= level <= last", f"np.{name}: q is not in its range, or there are no elements"),
             "below = int(level)", "above = min(below + 1, last)", "between = level - below",
             *_nan_or(args, axis, f"{low} + between * ({high} - {low})", "result[place]" if several else "result")]
    start = [f"sorted_x = numpy.sort(x, axis={axis})", f"last = {size('x', axis)} - 1"]
    if not several:
        return lines(*start, *found)
    own = ["1" if k == axis else size("x", k) for k in range(rank) if k != axis or args.flag("keepdims")]
    whole = [size("q", 0), *own]
    return lines(*start, f"result = {empty(whole, args.type('x').dtype)}", f"for place in range({whole[0]}):",
                 *(f"    {line}" for line in found))


def _searchsorted(args: CallArguments) -> str:
    return f"result = runtime.sought(a, v, {args.text('side') == 'right'})"


def _arg_extremum(args: CallArguments, function: str) -> str:
    rank = args.rank("x")
    if rank == 1:
        return f"result = numpy.{function}(x)"
    axis = args.axis(rank)
    counters, bounds = _other_axes("x", rank, axis)
    return lines(f"result = {empty(bounds, 'int64')}", *_nest(counters, bounds, [
        f"row = numpy.copy(x[{_subscripts_along(rank, axis, ':')}])",
        f"result[{', '.join(counters)}] = numpy.{function}(row)"]))


# -- selection -------------------------------------------------------------------------------------------------------

def _select(args: CallArguments) -> str:
    """The first condition that holds."""
    pairs = list(zip(args.items("conditions"), args.items("choices")))
    found = args.let("choice", args.arguments["default"])
    text = found
    for condition, choice in reversed(pairs):
        text = f"numpy.where({args.let('condition', condition)}, {args.let('choice', choice)}, {text})"
    return f"result = {text}"


def _bincount(args: CallArguments) -> str:
    weighted = args.has("weights")
    fits = [guard(f"{size('weights', 0)} == {size('x', 0)}", WEIGHTS)] if weighted else []
    return lines(*fits, "count = minlength", f"for place in range({size('x', 0)}):",
                 "    count = max(count, x[place] + 1)",
                 f"result = {zeros(['count'], 'float64' if weighted else 'int64')}",
                 f"for place in range({size('x', 0)}):",
                 f"    result[x[place]] += {'weights[place]' if weighted else '1'}")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    **{f"numpy.{f}.at": lambda args, f=f: _ufunc_at(args, f) for f in (*_SIGNS, "maximum", "minimum")},
    "numpy.searchsorted.each": _searchsorted, "numpy.argmax.along": lambda args: _arg_extremum(args, "argmax"),
    "numpy.argmin.along": lambda args: _arg_extremum(args, "argmin"),
    "numpy.argsort.along": _argsort, "numpy.fill_diagonal": _fill_diagonal, "numpy.nonzero": _nonzero,
    "numpy.sort": _sort, "numpy.nan_to_num": _nan_to_num,
    "numpy.take": _take,
    "numpy.take_along_axis": _take_along_axis, "numpy.select": _select, "numpy.meshgrid": _meshgrid,
    "numpy.indices": _indices, "numpy.unravel_index": _unravel_index, "numpy.bincount": _bincount,
    "numpy.triu_indices": lambda args: _triangle_indices(args, ("max(0, row + k)", "{m}")),
    "numpy.tril_indices": lambda args: _triangle_indices(args, ("0", "max(0, min({m}, row + k + 1))")),
    "numpy.diag_indices": lambda args: "result = numpy.arange(n)",
    "numpy.median": _median, "numpy.percentile": lambda args: _quantile(args, "100.0"),
    "numpy.quantile": lambda args: _quantile(args, "1.0"),
}
