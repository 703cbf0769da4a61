"""Expansions of reductions, accumulations and products: sums, loops and slices, in stable forms."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.options import norm_order
from s2sad.infer.promotion import common
from s2sad.normalize.library.expansions.templates import (
    CallArguments, empty, guard, lines, made, part, size, sizes, zeros,
)
from s2sad.normalize.library.expansions.norms_and_products import matrix_axes, matrix_norm


def options_of(args: CallArguments, rank: int) -> str:
    """The axes of a reduction as options of another one."""
    if not args.has("axis"):
        return ""
    axes = args.axes(rank)
    kept = ", keepdims=True" if "keepdims" in args.arguments and args.flag("keepdims") else ""
    return f", axis={axes[0] if len(axes) == 1 else axes}{kept}"


def _element_count(args: CallArguments, rank: int) -> str:
    return " * ".join(size("x", k) for k in args.axes(rank))


# -- variance and norms ----------------------------------------------------------------------------------------------

def _var(args: CallArguments, result: str = "result") -> str:
    """By deviations from the mean: the mean of squares less the square of the mean would cancel."""
    rank = args.rank("x")
    options = options_of(args, rank)
    middle = options if "keepdims" in options or not options else f"{options}, keepdims=True"
    return lines(f"middle = numpy.mean(x{middle})", "apart = x - middle",
                 f"{result} = numpy.sum(apart * apart{options}) / ({_element_count(args, rank)} - ddof)")


def root_of(args: CallArguments, squared: str, root: str = "numpy.sqrt({})") -> str:
    """A root whose derivative at 0 is 0, as that of abs is."""
    rank = args.rank("x")
    whole = args.has("axis") and (len(args.axes(rank)) < rank or args.flag("keepdims"))
    if whole:
        return f"result = numpy.where({squared} == 0.0, 0.0, {root.format(squared)})"
    return lines(f"if {squared} == 0.0:", "    result = 0.0", "else:", f"    result = {root.format(squared)}")


def _std(args: CallArguments) -> str:
    return lines(_var(args, "squared"), root_of(args, "squared"))


def _norm(args: CallArguments) -> str:
    node, options = args.arguments["ord"], options_of(args, args.rank("x"))
    order = norm_order(node)
    if order not in (None, "fro") and (axes := matrix_axes(args)):
        return matrix_norm(order, axes, args.rank("x"))
    if order in ("inf", "-inf"):
        return lines("large = numpy.abs(x)", f"result = numpy.{'max' if order == 'inf' else 'min'}(large{options})")
    if order == 1:
        return f"result = numpy.sum(numpy.abs(x){options})"
    if order in (None, "fro", 2):
        return lines(f"squared = numpy.sum(x * x{options})", root_of(args, "squared"))
    return lines(f"powers = numpy.sum(numpy.abs(x) ** {order}{options})", root_of(
        args, "powers", f"{{}} ** (1.0 / {order})"))


def _average(args: CallArguments) -> str:
    rank = args.rank("x")
    options = options_of(args, rank)
    if not args.has("weights"):
        return f"result = numpy.mean(x{options})"
    weights = "weights"
    if args.rank("weights") < rank:
        axes = args.axes(rank)
        weights = f"weights[{', '.join(':' if k in axes else 'None' for k in range(rank))}]"
        return f"result = numpy.sum(x * {weights}{options}) / numpy.sum(weights)"
    return f"result = numpy.sum(x * weights{options}) / numpy.sum(weights{options})"


# -- products of elements --------------------------------------------------------------------------------------------

def _prod(args: CallArguments) -> str:
    """One factor at a time, without a division: elements may be zero."""
    rank = args.rank("x")
    kept = args.flag("keepdims")
    if not args.has("axis") or rank == 1 and not kept:
        counters = [f"place{k}" for k in range(rank)]
        nest = [f"{'    ' * k}for {c} in range({size('x', k)}):" for k, c in enumerate(counters)]
        whole = not args.type("x").is_inexact
        factor = f"x[{', '.join(counters)}]"
        return lines(f"result = {1 if whole else 1.0}", *nest,
                     f"{'    ' * rank}result *= {f'int({factor})' if whole else factor}")
    axis = args.axis(rank)
    found = sizes("x", rank)
    found[axis:axis + 1] = ["1"] if kept else []
    factor = part("x", axis, "place:place + 1" if kept else "place")
    return lines(f"result = {made('ones', found, _accumulator_dtype(args))}", f"for place in range({size('x', axis)}):",
                 f"    result *= {factor}")


def _accumulator_dtype(args: CallArguments) -> str:
    """The dtype of sums and products: of integers and bools int64."""
    return args.type("x").dtype if args.type("x").is_inexact else "int64"


def _accumulate(args: CallArguments, sign: str, start: str, again: str) -> str:
    """Sums or products of all elements up to each."""
    rank = args.rank("x")
    if rank > 1 and not args.has("axis"):
        return lines("flat = numpy.ravel(x)", f"result = {again}(flat)")
    axis = args.axis(rank) if args.has("axis") else 0
    new = f"result = {empty(sizes('x', rank), _accumulator_dtype(args))}"
    if rank == 1 and args.type("x").is_inexact:
        return lines(new, f"so_far = {start}", f"for place in range({size('x', 0)}):",
                     f"    so_far = so_far {sign} x[place]", "    result[place] = so_far")
    return lines(new, "result[...] = x", f"for place in range(1, {size('x', axis)}):",
                 f"    {part('result', axis, 'place')} = {part('result', axis, 'place - 1')} {sign} "
                 f"{part('x', axis, 'place')}")


def _accumulate_ufunc(args: CallArguments, function: str) -> str:
    rank = args.rank("x")
    axis = args.axis(rank)
    return lines(f"result = {empty(sizes('x', rank), args.type('x').dtype)}",
                 "result[...] = x", f"for place in range(1, {size('x', axis)}):",
                 f"    {part('result', axis, 'place')} = numpy.{function}({part('result', axis, 'place - 1')}, "
                 f"{part('x', axis, 'place')})")


def _nansum(args: CallArguments) -> str:
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)",
                 f"result = numpy.sum(there{options_of(args, args.rank('x'))})")


def _nanmean(args: CallArguments) -> str:
    options = options_of(args, args.rank("x"))
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)", "counted = numpy.where(numpy.isnan(x), 0.0, 1.0)",
                 f"result = numpy.sum(there{options}) / numpy.sum(counted{options})")


# -- products of arrays ----------------------------------------------------------------------------------------------

def _vdot(args: CallArguments) -> str:
    a = "numpy.conj(a)" if args.type("a").is_complex else "a"
    return f"result = numpy.dot({a}, b)" if args.rank("a") == 1 else f"result = numpy.sum({a} * b)"


def _outer(args: CallArguments, text: str) -> str:
    a = f"a[{', '.join([':'] * args.rank('a') + ['None'] * args.rank('b'))}]" if args.rank("b") else "a"
    b = f"b[{', '.join(['None'] * args.rank('a') + [':'] * args.rank('b'))}]" if args.rank("a") else "b"
    return f"result = {text.format(a=a if args.rank('a') else 'a', b=b if args.rank('b') else 'b')}"


def _cross(args: CallArguments) -> str:
    """Of vectors of three along the last axis."""
    ranks = [args.rank(p) for p in "ab"]
    kind = common([args.type("a"), args.type("b")])

    def part(p: str, k: int) -> str:
        return f"{p}[{':, ' * (args.rank(p) - 1)}{k}]"
    three = "np.cross of vectors that do not have 3 elements"
    fits = [guard(f"{size(p, args.rank(p) - 1)} == 3", three) for p in "ab"]
    whole = sizes("ab"[ranks.index(max(ranks))], max(ranks))
    return lines(*fits, f"result = {empty(whole, kind)}", *(
        f"result[{':, ' * (max(ranks) - 1)}{k}] = {part('a', i)} * {part('b', j)} - {part('a', j)} * {part('b', i)}"
        for k, i, j in ((0, 1, 2), (1, 2, 0), (2, 0, 1))))


def _vander(args: CallArguments) -> str:
    columns = "N" if args.has("N") else size("x", 0)
    at = "column" if args.flag("increasing") else f"{columns} - 1 - column"
    single = args.type("x").dtype == "float32"     # NumPy makes it float64
    made = empty([size("x", 0), columns], "float64" if single else args.type("x").dtype)
    return lines("points = numpy.astype(x, dtype=numpy.float64)" if single else "", f"result = {made}",
                 f"for column in range({columns}):", f"    result[:, {at}] = {'points' if single else 'x'} ** column")


def _polyval(args: CallArguments) -> str:
    """By Horner's scheme."""
    if args.rank("x"):
        start = f"result = {zeros(sizes('x', args.rank('x')), common([args.type('p'), args.type('x')]))}"
        step = "    result[...] = result * x + p[place]"
    else:
        start, step = "result = 0.0", "    result = result * x + p[place]"
    return lines(start, f"for place in range({size('p', 0)}):", step)


def _correlate(args: CallArguments) -> str:
    mode, n, m = args.text("mode"), size("a", 0), size("v", 0)
    if mode != "same":
        return lines("turned = numpy.flip(v)", f"result = numpy.convolve(a, turned, mode='{mode}')")
    kind = common([args.type("a"), args.type("v")])   # NumPy turns what it gives where the first is the shorter one
    return lines("turned = numpy.flip(v)", "whole = numpy.convolve(a, turned, mode='full')",
                 f"least = min({n}, {m})", "first = (least - 1) // 2", f"if {n} < {m}:", "    first = least // 2",
                 f"count = max({n}, {m})", f"result = {empty(['count'], kind)}", "for position in range(count):",
                 "    result[position] = whole[position + first]")


def _convolve(args: CallArguments) -> str:
    n, m = size("a", 0), size("v", 0)
    kind = common([args.type("a"), args.type("v")])
    whole = lines(f"whole = {zeros([f'{n} + {m} - 1'], kind)}", f"for place in range({m}):",
                  f"    whole[place:place + {n}] += v[place] * a")
    if args.text("mode") == "full":
        return whole.replace("whole", "result")
    start, length = ("(least - 1) // 2", f"max({n}, {m})") if args.text("mode") == "same" else (
        "least - 1", f"max({n}, {m}) - least + 1")
    return lines(whole, f"least = min({n}, {m})", f"first = {start}", f"count = {length}",
                 f"result = {empty(['count'], kind)}", "for position in range(count):",
                 "    result[position] = whole[position + first]")


OUTER = {"add": "{a} + {b}", "subtract": "{a} - {b}", "multiply": "{a} * {b}", "divide": "{a} / {b}",
         "power": "{a} ** {b}", "maximum": "numpy.maximum({a}, {b})", "minimum": "numpy.minimum({a}, {b})",
         **{f: f"numpy.{f}({{a}}, {{b}})" for f in ("hypot", "logaddexp", "arctan2")}}
EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.var": _var, "numpy.std": _std, "numpy.linalg.norm": _norm, "numpy.average": _average, "numpy.prod": _prod,
    "numpy.cumprod": lambda args: _accumulate(args, "*", "1.0", "numpy.cumprod"),
    "numpy.cumsum": lambda args: _accumulate(args, "+", "0.0", "numpy.cumsum"),
    "numpy.vdot": _vdot, "numpy.convolve": _convolve,
    "numpy.nansum": _nansum, "numpy.nanmean": _nanmean, "numpy.cross": _cross,
    "numpy.vander": _vander, "numpy.polyval": _polyval, "numpy.correlate": _correlate,
    "numpy.maximum.accumulate": lambda args: _accumulate_ufunc(args, "maximum"),
    "numpy.minimum.accumulate": lambda args: _accumulate_ufunc(args, "minimum"),
    "numpy.logaddexp.accumulate": lambda args: _accumulate_ufunc(args, "logaddexp"),
    **{f"numpy.{f}.outer": lambda args, text=text: _outer(args, text) for f, text in OUTER.items()},
}
