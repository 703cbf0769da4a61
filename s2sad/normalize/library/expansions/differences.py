"""Expansions of differences, integrals and interpolation: slices and loops."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import (
    NOT_AS_MANY, CallArguments, empty, guard, lines, part, size, sizes,
)


def _trapezoid(args: CallArguments) -> str:
    rank = args.rank("y")
    axis = args.axis(rank)
    options = f", axis={axis}" if rank > 1 else ""
    both = f"{part('y', axis, '1:')} + {part('y', axis, ':-1')}"
    if not args.has("x"):
        return f"result = 0.5 * dx * numpy.sum({both}{options})"
    along = axis if args.rank("x") == rank else 0
    widths = f"widths = {part('x', along, '1:')} - {part('x', along, ':-1')}"
    fitted = "widths" if along == axis and args.rank("x") == rank else _broadcast_along("widths", axis, rank)
    return lines(widths, f"result = 0.5 * numpy.sum(({both}) * {fitted}{options})")


def _broadcast_along(vector: str, axis: int, rank: int, taken: str = ":") -> str:
    """A vector, or a slice of it, broadcast along the other axes."""
    return f"{vector}[{', '.join(taken if k == axis else 'None' for k in range(rank))}]"


def _gradient_part(args: CallArguments) -> str:
    """The part along one axis; of a vector an element."""
    number, order = args.number("part") or 0, f", edge_order={args.number('edge_order')}"
    if args.rank("f") == 1 or args.has("axis"):
        options = f", axis={args.axis(args.rank('f'))}" if args.has("axis") else ""
        return lines(f"whole = numpy.gradient(f, spacing=spacing{options}{order})", f"result = whole[{number}]")
    spacing = "second" if number and args.has("second") else "spacing"
    return f"result = numpy.gradient(f, spacing={spacing}, axis={number}{order})"


def _gradient(args: CallArguments) -> str:
    if args.has("part"):
        return _gradient_part(args)
    rank = args.rank("f")
    axis = args.axis(rank) if args.has("axis") else 0
    n = size("f", axis)
    dtype = args.type("f").dtype if args.type("f").is_float else "float64"
    enough = guard(f"{n} >= {1 + (args.number('edge_order') or 1)}", "np.gradient of too few elements along an axis")
    found = [enough, f"result = {empty(sizes('f', rank), dtype)}"]

    def at(array: str, taken: str) -> str:
        return part(array, axis, taken)
    inner, before, here, after = at("result", "1:-1"), at("f", ":-2"), at("f", "1:-1"), at("f", "2:")
    uniform = args.rank("spacing") == 0
    ends = _boundary_differences(at, n, uniform, args.number("edge_order") == 2)
    if uniform:
        return lines(*found, f"{inner} = ({after} - {before}) / (2.0 * spacing)", *ends)
    lay = (lambda v: v) if rank == 1 else (lambda v: _broadcast_along(v, axis, rank))
    return lines(*found, "widths = spacing[1:] - spacing[:-1]", "low = widths[:-1]", "high = widths[1:]",
                 "left = -high / (low * (low + high))", "middle = (high - low) / (low * high)",
                 "right = low / (high * (low + high))",
                 f"{inner} = {lay('left')} * {before} + {lay('middle')} * {here} + {lay('right')} * {after}", *ends)


def _boundary_differences(at: Callable[[str, str], str], n: str, uniform: bool, second: bool) -> list[str]:
    """The first and the last element, of the first or of the second order."""
    first, last = at("result", "0"), at("result", f"{n} - 1")
    f = [at("f", str(k)) for k in range(3)]
    g = [at("f", f"{n} - {k}") for k in (1, 2, 3)]
    if not second:
        return [f"{first} = ({f[1]} - {f[0]}) / {'spacing' if uniform else 'widths[0]'}",
                f"{last} = ({g[0]} - {g[1]}) / {'spacing' if uniform else f'widths[{n} - 2]'}"]
    if uniform:
        return [f"{first} = (2.0 * {f[1]} - 1.5 * {f[0]} - 0.5 * {f[2]}) / spacing",
                f"{last} = (1.5 * {g[0]} - 2.0 * {g[1]} + 0.5 * {g[2]}) / spacing"]
    found: list[str] = []
    for sign, end, (a, b, c), (near, far) in ((1, first, f, ("widths[0]", "widths[1]")),
                                              (-1, last, g, (f"widths[{n} - 2]", f"widths[{n} - 3]"))):
        both = f"({near} + {far})"
        value = (f"{both} / ({near} * {far}) * {b} - ({near} + {both}) / ({near} * {both}) * {a} - "
                 f"{near} / ({far} * {both}) * {c}")
        found.append(f"{end} = {value}" if sign > 0 else f"{end} = -({value})")
    return found


def _interp(args: CallArguments) -> str:
    """At a point of the table the slope is the one on its left; outside of it 0."""
    last = f"{size('xp', 0)} - 1"
    fits = guard(f"{size('fp', 0)} == {size('xp', 0)}", NOT_AS_MANY)
    right = "right" if args.has("right") else f"fp[{last}]"

    def value(point: str, result: str, indent: str) -> list[str]:
        slope = "(fp[place] - fp[place - 1]) / (xp[place] - xp[place - 1])"
        return [indent + line for line in (
            f"place = numpy.searchsorted(xp, {point})", f"if {point} != {point}:", f"    {result} = {point}",
            *([f"elif {point} < xp[0]:", f"    {result} = left"] if args.has("left") else []),
            "elif place == 0:", f"    {result} = fp[0]",
            f"elif place > {last}:", f"    {result} = {right}", "else:",
            f"    {result} = fp[place - 1] + {slope} * ({point} - xp[place - 1])")]
    if args.rank("x") == 0:
        return lines(fits, *value("x", "result", ""))
    return lines(fits, f"result = {empty([size('x', 0)], 'float64')}", f"for position in range({size('x', 0)}):",
                 *value("x[position]", "result[position]", "    "))


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.trapezoid": _trapezoid, "numpy.trapz": _trapezoid, "numpy.gradient": _gradient, "numpy.interp": _interp,
}
