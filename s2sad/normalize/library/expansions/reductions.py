"""What reductions, running products and products are made of: sums, loops and slices, in stable forms."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.options import norm_order
from s2sad.infer.promotion import common
from s2sad.normalize.library.expansions.templates import (
    CallArguments, empty, guard, lines, made, part, size, sizes, zeros,
)
from s2sad.normalize.library.expansions.norms_and_products import matrix_axes, matrix_norm


def options_of(asked: CallArguments, rank: int) -> str:
    """The axes of a reduction as options of another one."""
    if not asked.given("axis"):
        return ""
    axes = asked.axes(rank)
    kept = ", keepdims=True" if "keepdims" in asked.arguments and asked.true("keepdims") else ""
    return f", axis={axes[0] if len(axes) == 1 else axes}{kept}"


def _count(asked: CallArguments, rank: int) -> str:
    return " * ".join(size("x", k) for k in asked.axes(rank))


# -- variance and norms ----------------------------------------------------------------------------------------------

def _var(asked: CallArguments, result: str = "result") -> str:
    """By deviations from the mean: the mean of squares less the square of the mean would cancel."""
    rank = asked.rank("x")
    options = options_of(asked, rank)
    middle = options if "keepdims" in options or not options else f"{options}, keepdims=True"
    return lines(f"middle = numpy.mean(x{middle})", "apart = x - middle",
                 f"{result} = numpy.sum(apart * apart{options}) / ({_count(asked, rank)} - ddof)")


def root_of(asked: CallArguments, squared: str, root: str = "numpy.sqrt({})") -> str:
    """A root whose derivative at 0 is 0, as that of abs is."""
    rank = asked.rank("x")
    whole = asked.given("axis") and (len(asked.axes(rank)) < rank or asked.true("keepdims"))
    if whole:
        return f"result = numpy.where({squared} == 0.0, 0.0, {root.format(squared)})"
    return lines(f"if {squared} == 0.0:", "    result = 0.0", "else:", f"    result = {root.format(squared)}")


def _std(asked: CallArguments) -> str:
    return lines(_var(asked, "squared"), root_of(asked, "squared"))


def _norm(asked: CallArguments) -> str:
    node, options = asked.arguments["ord"], options_of(asked, asked.rank("x"))
    order = norm_order(node)
    if order not in (None, "fro") and (axes := matrix_axes(asked)):
        return matrix_norm(order, axes, asked.rank("x"))
    if order in ("inf", "-inf"):
        return lines("large = numpy.abs(x)", f"result = numpy.{'max' if order == 'inf' else 'min'}(large{options})")
    if order == 1:
        return f"result = numpy.sum(numpy.abs(x){options})"
    if order in (None, "fro", 2):
        return lines(f"squared = numpy.sum(x * x{options})", root_of(asked, "squared"))
    return lines(f"powers = numpy.sum(numpy.abs(x) ** {order}{options})", root_of(
        asked, "powers", f"{{}} ** (1.0 / {order})"))


def _average(asked: CallArguments) -> str:
    rank = asked.rank("x")
    options = options_of(asked, rank)
    if not asked.given("weights"):
        return f"result = numpy.mean(x{options})"
    weights = "weights"
    if asked.rank("weights") < rank:
        axes = asked.axes(rank)
        weights = f"weights[{', '.join(':' if k in axes else 'None' for k in range(rank))}]"
        return f"result = numpy.sum(x * {weights}{options}) / numpy.sum(weights)"
    return f"result = numpy.sum(x * weights{options}) / numpy.sum(weights{options})"


# -- products of elements --------------------------------------------------------------------------------------------

def _prod(asked: CallArguments) -> str:
    """One factor at a time, without a division: elements may be zero."""
    rank = asked.rank("x")
    kept = asked.true("keepdims")
    if not asked.given("axis") or rank == 1 and not kept:
        counters = [f"place{k}" for k in range(rank)]
        nest = [f"{'    ' * k}for {c} in range({size('x', k)}):" for k, c in enumerate(counters)]
        whole = not asked.type("x").is_inexact
        factor = f"x[{', '.join(counters)}]"
        return lines(f"result = {1 if whole else 1.0}", *nest,
                     f"{'    ' * rank}result *= {f'int({factor})' if whole else factor}")
    axis = asked.axis(rank)
    found = sizes("x", rank)
    found[axis:axis + 1] = ["1"] if kept else []
    factor = part("x", axis, "place:place + 1" if kept else "place")
    return lines(f"result = {made('ones', found, _widened(asked))}", f"for place in range({size('x', axis)}):",
                 f"    result *= {factor}")


def _widened(asked: CallArguments) -> str:
    """The dtype of sums and products: of integers and bools int64."""
    return asked.type("x").dtype if asked.type("x").is_inexact else "int64"


def _running(asked: CallArguments, sign: str, start: str, again: str) -> str:
    """Sums or products of all elements up to each."""
    rank = asked.rank("x")
    if rank > 1 and not asked.given("axis"):
        return lines("flat = numpy.ravel(x)", f"result = {again}(flat)")
    axis = asked.axis(rank) if asked.given("axis") else 0
    new = f"result = {empty(sizes('x', rank), _widened(asked))}"
    if rank == 1 and asked.type("x").is_inexact:
        return lines(new, f"so_far = {start}", f"for place in range({size('x', 0)}):",
                     f"    so_far = so_far {sign} x[place]", "    result[place] = so_far")
    return lines(new, "result[...] = x", f"for place in range(1, {size('x', axis)}):",
                 f"    {part('result', axis, 'place')} = {part('result', axis, 'place - 1')} {sign} "
                 f"{part('x', axis, 'place')}")


def _running_extreme(asked: CallArguments, function: str) -> str:
    rank = asked.rank("x")
    axis = asked.axis(rank)
    return lines(f"result = {empty(sizes('x', rank), asked.type('x').dtype)}",
                 "result[...] = x", f"for place in range(1, {size('x', axis)}):",
                 f"    {part('result', axis, 'place')} = numpy.{function}({part('result', axis, 'place - 1')}, "
                 f"{part('x', axis, 'place')})")


def _nansum(asked: CallArguments) -> str:
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)",
                 f"result = numpy.sum(there{options_of(asked, asked.rank('x'))})")


def _nanmean(asked: CallArguments) -> str:
    options = options_of(asked, asked.rank("x"))
    return lines("there = numpy.where(numpy.isnan(x), 0.0, x)", "counted = numpy.where(numpy.isnan(x), 0.0, 1.0)",
                 f"result = numpy.sum(there{options}) / numpy.sum(counted{options})")


# -- products of arrays ----------------------------------------------------------------------------------------------

def _vdot(asked: CallArguments) -> str:
    a = "numpy.conj(a)" if asked.type("a").is_complex else "a"
    return f"result = numpy.dot({a}, b)" if asked.rank("a") == 1 else f"result = numpy.sum({a} * b)"


def _outer(asked: CallArguments, text: str) -> str:
    a = f"a[{', '.join([':'] * asked.rank('a') + ['None'] * asked.rank('b'))}]" if asked.rank("b") else "a"
    b = f"b[{', '.join(['None'] * asked.rank('a') + [':'] * asked.rank('b'))}]" if asked.rank("a") else "b"
    return f"result = {text.format(a=a if asked.rank('a') else 'a', b=b if asked.rank('b') else 'b')}"


def _cross(asked: CallArguments) -> str:
    """Of vectors of three along the last axis."""
    ranks = [asked.rank(p) for p in "ab"]
    kind = common([asked.type("a"), asked.type("b")])

    def part(p: str, k: int) -> str:
        return f"{p}[{':, ' * (asked.rank(p) - 1)}{k}]"
    three = "np.cross of vectors that do not have 3 elements"
    fits = [guard(f"{size(p, asked.rank(p) - 1)} == 3", three) for p in "ab"]
    whole = sizes("ab"[ranks.index(max(ranks))], max(ranks))
    return lines(*fits, f"result = {empty(whole, kind)}", *(
        f"result[{':, ' * (max(ranks) - 1)}{k}] = {part('a', i)} * {part('b', j)} - {part('a', j)} * {part('b', i)}"
        for k, i, j in ((0, 1, 2), (1, 2, 0), (2, 0, 1))))


def _vander(asked: CallArguments) -> str:
    columns = "N" if asked.given("N") else size("x", 0)
    at = "column" if asked.true("increasing") else f"{columns} - 1 - column"
    single = asked.type("x").dtype == "float32"     # NumPy makes it float64
    made = empty([size("x", 0), columns], "float64" if single else asked.type("x").dtype)
    return lines("points = numpy.astype(x, dtype=numpy.float64)" if single else "", f"result = {made}",
                 f"for column in range({columns}):", f"    result[:, {at}] = {'points' if single else 'x'} ** column")


def _polyval(asked: CallArguments) -> str:
    """By Horner's scheme."""
    if asked.rank("x"):
        start = f"result = {zeros(sizes('x', asked.rank('x')), common([asked.type('p'), asked.type('x')]))}"
        step = "    result[...] = result * x + p[place]"
    else:
        start, step = "result = 0.0", "    result = result * x + p[place]"
    return lines(start, f"for place in range({size('p', 0)}):", step)


def _correlate(asked: CallArguments) -> str:
    mode, n, m = asked.text("mode"), size("a", 0), size("v", 0)
    if mode != "same":
        return lines("turned = numpy.flip(v)", f"result = numpy.convolve(a, turned, mode='{mode}')")
    kind = common([asked.type("a"), asked.type("v")])   # NumPy turns what it gives where the first is the shorter one
    return lines("turned = numpy.flip(v)", "whole = numpy.convolve(a, turned, mode='full')",
                 f"least = min({n}, {m})", "first = (least - 1) // 2", f"if {n} < {m}:", "    first = least // 2",
                 f"count = max({n}, {m})", f"result = {empty(['count'], kind)}", "for position in range(count):",
                 "    result[position] = whole[position + first]")


def _convolve(asked: CallArguments) -> str:
    n, m = size("a", 0), size("v", 0)
    kind = common([asked.type("a"), asked.type("v")])
    whole = lines(f"whole = {zeros([f'{n} + {m} - 1'], kind)}", f"for place in range({m}):",
                  f"    whole[place:place + {n}] += v[place] * a")
    if asked.text("mode") == "full":
        return whole.replace("whole", "result")
    start, length = ("(least - 1) // 2", f"max({n}, {m})") if asked.text("mode") == "same" else (
        "least - 1", f"max({n}, {m}) - least + 1")
    return lines(whole, f"least = min({n}, {m})", f"first = {start}", f"count = {length}",
                 f"result = {empty(['count'], kind)}", "for position in range(count):",
                 "    result[position] = whole[position + first]")


OUTER = {"add": "{a} + {b}", "subtract": "{a} - {b}", "multiply": "{a} * {b}", "divide": "{a} / {b}",
         "power": "{a} ** {b}", "maximum": "numpy.maximum({a}, {b})", "minimum": "numpy.minimum({a}, {b})",
         **{f: f"numpy.{f}({{a}}, {{b}})" for f in ("hypot", "logaddexp", "arctan2")}}
SUMS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.var": _var, "numpy.std": _std, "numpy.linalg.norm": _norm, "numpy.average": _average, "numpy.prod": _prod,
    "numpy.cumprod": lambda asked: _running(asked, "*", "1.0", "numpy.cumprod"),
    "numpy.cumsum": lambda asked: _running(asked, "+", "0.0", "numpy.cumsum"),
    "numpy.vdot": _vdot, "numpy.convolve": _convolve,
    "numpy.nansum": _nansum, "numpy.nanmean": _nanmean, "numpy.cross": _cross,
    "numpy.vander": _vander, "numpy.polyval": _polyval, "numpy.correlate": _correlate,
    "numpy.maximum.accumulate": lambda asked: _running_extreme(asked, "maximum"),
    "numpy.minimum.accumulate": lambda asked: _running_extreme(asked, "minimum"),
    "numpy.logaddexp.accumulate": lambda asked: _running_extreme(asked, "logaddexp"),
    **{f"numpy.{f}.outer": lambda asked, text=text: _outer(asked, text) for f, text in OUTER.items()},
}
