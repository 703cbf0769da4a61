"""Expansions of functions that rearrange elements: views, allocations and stores into slices."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.signatures.options import astype_dtype, widths_of
from s2sad.normalize.library.expansions.templates import (
    SECTIONS, WINDOW, CallArguments, dtype_option, empty, guard, lines, part, size, sizes, zeros,
)
from s2sad.normalize.library.expansions.selections import repeat_each
from s2sad.tree import List, Tuple, call


def _diff(args: CallArguments) -> str:
    axis, times = args.axis(args.rank("x")), args.number("n") or 1
    steps = ["x", *(f"apart{k}" for k in range(1, times)), "result"]
    return lines(*(f"{new} = {part(old, axis, '1:')} - {part(old, axis, ':-1')}" for old, new in zip(steps, steps[1:])))


# -- axes ------------------------------------------------------------------------------------------------------------

def _expand_dims(args: CallArguments) -> str:
    return f"result = {part('x', args.axis(args.rank('x') + 1), 'None')}"


def _squeeze(args: CallArguments) -> str:
    rank, gone = args.rank("x"), args.axes(args.rank("x"))
    more = [guard(f"{size('x', k)} != 1", "np.squeeze without an axis leaves out every axis of length 1: name it")
            for k in range(rank) if k not in gone and args.flag("whole")]
    fits = [guard(f"{size('x', k)} == 1", "np.squeeze along an axis of another length than 1") for k in gone]
    return lines(*more, *fits, f"result = x[{', '.join('0' if k in gone else ':' for k in range(rank))}]")


def _atleast(args: CallArguments, rank: int) -> str:
    if not args.rank("x"):
        dtype = args.type("x").dtype
        return lines(f"result = {empty(['1'] * rank, dtype)}", f"result[{', '.join(['0'] * rank)}] = x")
    return f"result = x[{'None, ' * (rank - args.rank('x'))}...]" if args.rank("x") < rank else "result = x[...]"


def _atleast_3d(args: CallArguments) -> str:
    """The axis of a row is the second of three, those of a matrix are the first two."""
    rank = args.rank("x")
    return f"result = x[{'None, :, None' if rank == 1 else ':, :, None'}]" if 0 < rank < 3 else _atleast(args, 3)


def _rot90(args: CallArguments) -> str:
    turns = (args.number("k") or 0) % 4
    a, b = ((whole_number(axis) or 0) % args.rank("x") for axis in args.items("axes"))      # in this order
    turned = f"numpy.moveaxis(x, ({a}, {b}), ({b}, {a}))" if args.rank("x") > 2 else "numpy.transpose(x)"
    return ["result = numpy.copy(x)", f"result = numpy.flip({turned}, axis={a})",
            f"result = numpy.flip(x, axis=({a}, {b}))", f"result = numpy.flip({turned}, axis={b})"][turns]


def _astype(args: CallArguments) -> str:
    return lines(f"result = {empty(sizes('x', args.rank('x')), astype_dtype(args.arguments))}", "result[...] = x")


def _split(args: CallArguments, axis: int | None = None, even: bool = True) -> str:
    """One of the sections: of equal sizes, the first ones one larger if they do not divide the whole, or between
    indices that are spelled out."""
    rank = args.rank("x")
    axis = args.axis(rank) if axis is None else axis
    number, n = args.number("part") or 0, size("x", axis)
    node = args.arguments["sections"]
    if isinstance(node, (Tuple, List)):
        bounds = ["", *(args.let("bound", e) for e in node.elts), ""]
        return f"result = numpy.copy({part('x', axis, f'{bounds[number]}:{bounds[number + 1]}')})"
    if even:
        return lines(guard(f"{n} % sections == 0", SECTIONS), f"step = {n} // sections",
                     f"result = numpy.copy({part('x', axis, f'{number} * step:{number + 1} * step')})")
    return lines(f"step = {n} // sections", f"more = {n} % sections",
                 f"start = {number} * step + min({number}, more)",
                 f"stop = {number + 1} * step + min({number + 1}, more)",
                 f"result = numpy.copy({part('x', axis, 'start:stop')})")


def _swapaxes(args: CallArguments) -> str:
    rank = args.rank("x")
    a, b = args.axis(rank, "axis1"), args.axis(rank, "axis2")
    return f"result = numpy.moveaxis(x, ({a}, {b}), ({b}, {a}))" if a != b else "result = x[...]"


def _broadcast_to(args: CallArguments) -> str:
    return lines(f"result = numpy.empty(shape{dtype_option(args.type('x').dtype)})", "result[...] = x")


def _windows(args: CallArguments) -> str:
    """Windows along some axes: at each place of a window the part that has these elements."""
    rank = args.rank("x")
    widths = [args.let("width", node) for node in args.items("window_shape")]
    axes = args.axes(rank) if args.has("axis") else tuple(range(rank))
    whole, parts = sizes("x", rank), [":"] * rank
    for axis, width in zip(axes, widths):
        whole[axis] += f" - {width} + 1"
        parts[axis] = f"place{width}:place{width} + {whole[axis]}"
    places = [f"place{width}" for width in widths]
    loops = [f"{'    ' * k}for {place} in range({width}):" for k, (place, width) in enumerate(zip(places, widths))]
    return lines(*(guard(f"0 < {width} <= {size('x', axis)}", WINDOW) for axis, width in zip(axes, widths)),
                 f"result = {empty([*whole, *widths], args.type('x').dtype)}", *loops,
                 f"{'    ' * len(loops)}result[{', '.join([':'] * rank + places)}] = x[{', '.join(parts)}]")


# -- repetition ------------------------------------------------------------------------------------------------------

def _tile(args: CallArguments) -> str:
    times = [args.let("times", node) for node in args.items("reps")]
    rank = args.rank("x")
    whole = max(rank, len(times))
    times = ["1"] * (whole - len(times)) + times
    own = ["1"] * (whole - rank) + sizes("x", rank)
    taken = ["None"] * (2 * (whole - rank)) + ["None, :"] * rank
    return lines(f"rows = {empty([s for pair in zip(times, own) for s in pair], args.type('x').dtype)}",
                 f"rows[...] = x[{', '.join(taken)}]",
                 f"result = numpy.reshape(rows, ({', '.join(f'{t} * {s}' for t, s in zip(times, own))},))")


def _repeat(args: CallArguments) -> str:
    if args.rank("repeats") or isinstance(args.arguments["repeats"], (List, Tuple)):
        return repeat_each(args)
    rank = args.rank("x")
    if not rank:
        return lines(f"result = {empty(['repeats'], args.type('x').dtype)}", "result[...] = x")
    if rank > 1 and not args.has("axis"):
        return lines("flat = numpy.ravel(x)", "result = numpy.repeat(flat, repeats)")
    axis = args.axis(rank)
    rows, whole = sizes("x", rank), sizes("x", rank)
    rows.insert(axis + 1, "repeats")
    whole[axis] += " * repeats"
    return lines(f"rows = {empty(rows, args.type('x').dtype)}",
                 f"rows[...] = x[{', '.join([':'] * (axis + 1))}, None{', :' * (rank - axis - 1)}]",
                 f"result = numpy.reshape(rows, ({', '.join(whole)},))")




def _pad(args: CallArguments) -> str:
    rank, mode = args.rank("x"), args.text("mode")
    widths = [(args.let("low", a), args.let("high", b)) for a, b in
              widths_of(args.arguments["pad_width"], rank) or []]
    whole = [f"{a} + {size('x', k)} + {b}" for k, (a, b) in enumerate(widths)]
    inner = ", ".join(f"{a}:{a} + {size('x', k)}" for k, (a, b) in enumerate(widths))
    start = zeros(whole, args.type("x").dtype)
    found = [f"result = {start}", f"result[{inner}] = x"]
    if mode == "constant":
        return lines(found[0], "result[...] = constant_values", found[1])
    for k, (a, b) in enumerate(widths):
        found += _borders(mode, k, a, b, size("x", k))
    return lines(*found)


def _borders(mode: str, axis: int, a: str, b: str, n: str) -> list[str]:
    """Guards and stores that fill both ends of one axis from what lies between."""
    low, high = part("result", axis, f":{a}"), part("result", axis, f"{a} + {n}:")

    def taken(start: str, stop: str) -> str:
        return part("result", axis, f"{start}:{stop}")
    if mode == "edge":
        first, last = (part("result", axis, f"{k}, None") for k in (a, f"{a} + {n} - 1"))
        return [f"{low} = {first}", f"{high} = {last}"]
    if mode == "linear_ramp":
        first, last = part("result", axis, a), part("result", axis, f"{a} + {n} - 1")
        return [f"for place in range({a}):", f"    {part('result', axis, 'place')} = {first} * (place / {a})",
                f"for place in range({b}):",
                f"    {part('result', axis, f'{a} + {n} + {b} - 1 - place')} = {last} * (place / {b})"]
    if mode in ("mean", "maximum", "minimum"):
        function = {"mean": "mean", "maximum": "max", "minimum": "min"}[mode]
        return [f"found{axis} = numpy.{function}({taken(a, f'{a} + {n}')}, axis={axis}, keepdims=True)",
                f"{low} = found{axis}", f"{high} = found{axis}"]
    period, mirrored = {"wrap": (n, "{0}"), "symmetric": (f"(2 * {n})", f"min({{0}}, 2 * {n} - 1 - {{0}})"),
                        "reflect": (f"max(2 * {n} - 2, 1)", f"min({{0}}, max(2 * {n} - 2, 1) - {{0}})")}[mode]

    def filled(count: str, cell: str, place: str) -> list[str]:
        """The loop over one end, whose cells repeat with a period what lies between, however wide it is."""
        return [f"for place in range({count}):", f"    turn = ({place}) % {period}",
                f"    {part('result', axis, cell)} = {part('result', axis, f'{a} + ' + mirrored.format('turn'))}"]
    return [guard(f"{n} > 0 or {a} + {b} == 0", "np.pad of an axis without elements"),
            *filled(a, "place", f"place - {a}"), *filled(b, f"{a} + {n} + place", f"{n} + place")]


# -- diagonals and triangles -----------------------------------------------------------------------------------------

def _diag(args: CallArguments, offset: str = "k") -> str:
    dtype = args.type("x").dtype
    if args.number(offset) == 0:   # the diagonal itself
        rows, columns = size("x", 0), size("x", args.rank("x") - 1)
        if args.rank("x") == 1:
            return lines(f"result = {zeros([rows, rows], dtype)}", f"for place in range({rows}):",
                         "    result[place, place] = x[place]")
        return lines(f"count = min({rows}, {columns})", f"result = {empty(['count'], dtype)}",
                     "for place in range(count):", "    result[place] = x[place, place]")
    shift = [f"right = max(0, {offset})", f"down = max(0, -{offset})"]
    if args.rank("x") == 1:
        side = f"{size('x', 0)} + right + down"
        return lines(*shift, f"result = {zeros([side, side], dtype)}", f"for place in range({size('x', 0)}):",
                     "    result[place + down, place + right] = x[place]")
    return lines(*shift, f"count = max(0, min({size('x', 0)} - down, {size('x', 1)} - right))",
                 f"result = {empty(['count'], dtype)}", "for place in range(count):",
                 "    result[place] = x[place + down, place + right]")


def _diagonal(args: CallArguments) -> str:
    """Of a matrix, whose axes may be exchanged."""
    if args.axis(2, "axis1"):
        args.arguments |= {"x": call("numpy.transpose", args.arguments["x"])}
    return _diag(args, "offset")


def _trace(args: CallArguments) -> str:
    if args.number("offset") == 0:
        return lines("result = 0.0", f"for place in range(min({size('x', 0)}, {size('x', 1)})):",
                     "    result += x[place, place]")
    return lines("right = max(0, offset)", "down = max(0, -offset)", "result = 0.0",
                 f"for place in range(min({size('x', 0)} - down, {size('x', 1)} - right)):",
                 "    result += x[place + down, place + right]")


def _triangle(args: CallArguments, kept: str, first: str) -> str:
    return lines(f"result = {zeros(sizes('x', 2), args.type('x').dtype)}", f"for row in range({size('x', 0)}):",
                 f"    bound = max(0, min(row + k{first}, {size('x', 1)}))",
                 f"    result[row, {kept}] = x[row, {kept}]")


def _tri(args: CallArguments) -> str:
    columns = "M" if args.has("M") else "N"
    dtype = astype_dtype(args.arguments)
    return lines(f"result = {zeros(['N', columns], dtype)}", "for row in range(N):",
                 f"    bound = max(0, min(row + k + 1, {columns}))", f"    result[row, :bound] = {_one(dtype)}")


def _eye(args: CallArguments) -> str:
    columns = "M" if args.has("M") else "N"
    dtype = astype_dtype(args.arguments)
    return lines(f"result = {zeros(['N', columns], dtype)}", f"for place in range(max(0, -k), min(N, {columns} - k)):",
                 f"    result[place, place + k] = {_one(dtype)}")


def _one(dtype: str) -> str:
    return {"bool": "True", "int64": "1", "int32": "1"}.get(dtype, "1.0")


def _identity(args: CallArguments) -> str:
    return f"result = numpy.eye(n{dtype_option(astype_dtype(args.arguments), default='')})"


def _linspace(args: CallArguments) -> str:
    gaps = "max(num - 1, 1)" if args.flag("endpoint") else "num"
    found = [f"gap = (stop - start) / {gaps}", f"result = {empty(['num'], 'float64')}", "for place in range(num):",
             "    result[place] = start + place * gap"]
    return lines(*found, *(["if num > 1:", "    result[num - 1] = stop"] if args.flag("endpoint") else []))


def _arange(args: CallArguments) -> str:
    numbers = [args.type(p) for p in ("start", "stop", "step")]
    low, high = ("start", "stop") if args.has("stop") else ("0", "start")
    if any(n.is_float for n in numbers):
        count, dtype = f"max(0, math.ceil(({high} - {low}) / step))", "float64"
    elif args.number("step") == 1:
        count, dtype = f"max(0, {high} - {low})" if low != "0" else high, "int64"
    else:
        count, dtype = f"len(range({low}, {high}, step))", "int64"
    dtype = dtype if not args.has("dtype") else astype_dtype(args.arguments)
    value = "place" if low == "0" and args.number("step") == 1 else f"{low} + place * step"
    return lines(f"count = {count}", f"result = {empty(['count'], dtype)}", "for place in range(count):",
                 f"    result[place] = {value}")


def _window(value: str) -> str:
    """A window over the places from -1 to 1; of one element it is 1."""
    return lines(f"result = {empty(['M'], 'float64')}", "for k in range(M):",
                 "    place = (2 * k - M + 1) / max(M - 1, 1)", f"    result[k] = {value}")


def _along_diagonal(args: CallArguments) -> str:
    dtype = args.type("values").dtype if args.type("values").is_float else "float64"
    return lines(f"result = {empty(['size'], dtype)}", "result[...] = values")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.diff": _diff, "numpy.broadcast_to": _broadcast_to,
    "numpy.expand_dims": _expand_dims, "numpy.squeeze": _squeeze, "numpy.swapaxes": _swapaxes, "numpy.tile": _tile,
    "numpy.repeat": _repeat, "numpy.pad": _pad, "numpy.diag": _diag, "numpy.diagonal": _diagonal,
    "numpy.lib.stride_tricks.sliding_window_view": _windows,
    "numpy.trace": _trace, "numpy.tril": lambda args: _triangle(args, ":bound", " + 1"),
    "numpy.triu": lambda args: _triangle(args, "bound:", ""), "numpy.eye": _eye, "numpy.identity": _identity,
    "numpy.linspace": _linspace, "numpy.arange": _arange, "numpy.tri": _tri,
    "numpy.hanning": lambda args: _window("0.5 + 0.5 * numpy.cos(numpy.pi * place)"),
    "numpy.hamming": lambda args: _window("0.54 + 0.46 * numpy.cos(numpy.pi * place)"),
    "numpy.blackman": lambda args: _window(
        "0.42 + 0.5 * numpy.cos(numpy.pi * place) + 0.08 * numpy.cos(2.0 * numpy.pi * place)"),
    "numpy.bartlett": lambda args: _window("1.0 - numpy.abs(place)"),
    "numpy.atleast_1d": lambda args: _atleast(args, 1), "numpy.atleast_2d": lambda args: _atleast(args, 2),
    "numpy.atleast_3d": _atleast_3d,
    "numpy.rot90": _rot90, "numpy.astype": _astype, "numpy.diagflat": _diag, "numpy.split": _split,
    "numpy.array_split": lambda args: _split(args, even=False), "numpy.vsplit": lambda args: _split(args, 0),
    "numpy.hsplit": lambda args: _split(args, min(args.rank("x") - 1, 1)),
    "scipy.sparse.entries": lambda args: "result = data * c", "scipy.sparse.along": _along_diagonal,
}
