"""Expansions of functions that select, repeat and insert elements, and of histograms.

Indices are integers, and have no derivative: what they select has.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import (
    WEIGHTS, CallArguments, empty, guard, lines, made, part, size, sizes, zeros,
)

_OUTSIDE = "np.{}: the place is not in the array"


def _of_raveled(args: CallArguments, text: str) -> str:
    """The text for the raveled array, where no axis is named."""
    return lines("flat = numpy.ravel(x)", text) if args.rank("x") > 1 and not args.has("axis") else ""


def _axis(args: CallArguments) -> int:
    return args.axis(args.rank("x")) if args.has("axis") else 0


def _bound_array(args: CallArguments, parameter: str) -> str:
    """The statement that binds an argument, which may be a list that is spelled out; "" for a number."""
    args.as_array(parameter)
    return f"held_{parameter} = {parameter}" if args.rank(parameter) else ""


# -- elements deleted, repeated, inserted -----------------------------------------------------------------------------

def _delete(args: CallArguments) -> str:
    if found := _of_raveled(args, "result = numpy.delete(flat, places)"):
        return found
    axis, rank = _axis(args), args.rank("x")
    n, kind = size("x", axis), args.type("x").dtype
    whole = sizes("x", rank)
    held = _bound_array(args, "places")
    if not held:
        whole[axis] = f"{n} - 1"
        fits = guard(f"-{n} <= places and places < {n}", _OUTSIDE.format("delete"))
        return lines(fits, f"gone = places % {n}", f"result = {empty(whole, kind)}",
                     f"{part('result', axis, ':gone')} = {part('x', axis, ':gone')}",
                     f"{part('result', axis, 'gone:')} = {part('x', axis, 'gone + 1:')}")
    if args.type("places").dtype == "bool":
        return lines(held, "left = numpy.nonzero(held_places == 0, part=0)", f"result = {part('x', axis, 'left')}")
    keep = [f"keep = {made('ones', [n], 'bool')}", "for place in range(held_places.shape[0]):",
            "    keep[held_places[place]] = False"]
    return lines(held, *keep, "left = numpy.nonzero(keep, part=0)", f"result = {part('x', axis, 'left')}")


def _insert(args: CallArguments) -> str:
    if found := _of_raveled(args, "result = numpy.insert(flat, place, values)"):
        return found
    axis, rank = _axis(args), args.rank("x")
    n, whole = size("x", axis), sizes("x", rank)
    several = rank == 1 and args.rank("values") == 1
    more = size("values", 0) if several else "1"
    whole[axis] = f"{n} + {more}"
    fits = guard(f"-{n} <= place and place <= {n}", _OUTSIDE.format("insert"))
    new = f"result = {empty(whole, args.type('x').dtype)}"
    return lines(fits, "at = place", "if at < 0:", f"    at = at + {n}", new,
                 f"{part('result', axis, ':at')} = {part('x', axis, ':at')}",
                 f"{part('result', axis, f'at:at + {more}' if several else 'at')} = values",
                 f"{part('result', axis, f'at + {more}:')} = {part('x', axis, 'at:')}")


def repeat_each(args: CallArguments) -> str:
    """`np.repeat` with a number for each element."""
    if found := _of_raveled(args, "result = numpy.repeat(flat, repeats)"):
        return found
    axis = _axis(args)
    n = size("x", axis)
    fits = guard(f"held_repeats.shape[0] == {n}", "np.repeat with another number of counts than of elements")
    least = guard("held_repeats[place] >= 0", "np.repeat with a count below 0")
    return lines(_bound_array(args, "repeats"), fits, "count = 0", f"for place in range({n}):", f"    {least}",
                 "    count += held_repeats[place]", f"taken = {empty(['count'], 'int64')}", "count = 0",
                 f"for place in range({n}):", "    for again in range(held_repeats[place]):",
                 "        taken[count] = place", "        count += 1", f"result = {part('x', axis, 'taken')}")


def _compress(args: CallArguments) -> str:
    if args.rank("x") > 1 and not args.has("axis"):
        return lines("flat = numpy.ravel(x)", "result = numpy.compress(condition, flat)")
    return lines(_bound_array(args, "condition"), "left = numpy.nonzero(held_condition, part=0)",
                 f"result = {part('x', _axis(args), 'left')}")


def _extract(args: CallArguments) -> str:
    """By the number of an element in row-major order, whatever the shapes are."""
    if args.rank("condition") == args.rank("x"):
        return lines("mask = condition != 0", "result = x[mask]")
    return lines("flat = numpy.ravel(x)", "left = numpy.nonzero(numpy.ravel(condition), part=0)", "result = flat[left]")


def _choose(args: CallArguments) -> str:
    choices = [args.let("choice", node) for node in args.items("choices")]
    outside = f"numpy.count_nonzero((a < 0) | (a >= {len(choices)}))"
    text = choices[-1]
    for k, choice in reversed(list(enumerate(choices[:-1]))):
        text = f"numpy.where(a == {k}, {choice}, {text})"
    return lines(f"outside = {outside}", guard("outside == 0", "np.choose: a number that no choice has"),
                 f"result = {text}")


# -- indices ---------------------------------------------------------------------------------------------------------

def _digitize(args: CallArguments) -> str:
    fits = guard(f"{size('bins', 0)} < 2 or bins[0] <= bins[{size('bins', 0)} - 1]",
                 "np.digitize with bins that decrease: turn them around, bins[::-1]")
    if args.rank("x"):
        return lines(fits, f"result = runtime.sought(bins, x, {not args.flag('right')})")
    return lines(fits, f"result = numpy.searchsorted(bins, x, side='{'left' if args.flag('right') else 'right'}')")


def _isin(args: CallArguments) -> str:
    held = _bound_array(args, "values")
    other = "True" if not args.flag("invert") else "False"
    start = f"result = {made('zeros' if other == 'True' else 'ones', sizes('a', args.rank('a')), 'bool')}"
    counters = [f"place{k}" for k in range(args.rank("a"))]
    nest = [f"{'    ' * k}for {c} in range({size('a', k)}):" for k, c in enumerate(counters)]
    inner, at = "    " * len(counters), ", ".join(counters)
    return lines(held, start, *nest, f"{inner}for other in range(held_values.shape[0]):",
                 f"{inner}    if a[{at}] == held_values[other]:", f"{inner}        result[{at}] = {other}")


def _setdiff1d(args: CallArguments) -> str:
    """The numbers that another array does not have, sorted."""
    return lines("found = numpy.unique(a)", "kept = numpy.isin(found, values, invert=True)",
                 "left = numpy.nonzero(kept, part=0)", "result = found[left]")


def _argwhere(args: CallArguments) -> str:
    rank = args.rank("x")
    return lines("count = numpy.count_nonzero(x)", f"result = {empty(['count', str(rank)], 'int64')}",
                 *(f"result[:, {k}] = runtime.places(x, count, {k})" for k in range(rank)))


def _lexsort(args: CallArguments) -> str:
    """By the last key; what is equal there by the one before."""
    *others, last = [args.let("key", node) for node in args.items("keys")]
    found = [f"order = numpy.argsort({others[0] if others else last}, kind='mergesort')"]
    for k, key in enumerate([*others[1:], last] if others else []):
        found += [f"row{k} = {key}[order]", f"again = numpy.argsort(row{k}, kind='mergesort')", "order = order[again]"]
    return lines(*found, "result = order")


def _unique(args: CallArguments) -> str:
    """Of the sorted numbers the first of those that are equal; `part` is the number of the result."""
    n = size("x", 0)
    given = [p for p in ("return_index", "return_inverse", "return_counts") if args.flag(p)]
    number = args.number("part") or 0
    wanted = given[number - 1] if number else ""
    new = "place == 0 or x[order[place]] != x[order[place - 1]]"
    nans = [] if args.type("x").is_integer else [guard(
        f"{n} == 0 or x[order[{n} - 1]] == x[order[{n} - 1]]", "np.unique of nans")]
    found = ["order = numpy.argsort(x, kind='mergesort')", *nans, "count = 0", f"for place in range({n}):",
             f"    if {new}:", "        count += 1"]
    if wanted == "return_inverse":
        return lines(*found, f"result = {empty([n], 'int64')}", "count = -1", f"for place in range({n}):",
                     f"    if {new}:", "        count += 1", "    result[order[place]] = count")
    first = [f"first = {zeros(['count'], 'int64')}", "count = -1", f"for place in range({n}):", f"    if {new}:",
             "        count += 1"]
    if wanted == "return_counts":
        return lines(*found, *first, "    first[count] += 1", "result = first")
    return lines(*found, *first, "        first[count] = order[place]",
                 "result = x[first]" if not number else "result = first")


# -- bins ------------------------------------------------------------------------------------------------------------

def _histogram(args: CallArguments) -> str:
    """Numbers in bins, or the sums of their weights; the last bin has both of its ends."""
    if args.rank("bins"):
        edges = ["edges = numpy.copy(bins)", guard("edges[0] <= edges[edges.shape[0] - 1]",
                                                   "np.histogram with edges that decrease")]
    elif not args.has("range"):
        edges = _found_edges()
    else:
        low, high = (args.let("end", node) for node in args.items("range"))
        edges = [guard(f"{low} < {high}", "np.histogram with a range whose ends are equal or exchanged"),
                 f"edges = {_as_float32(args, 'x', f'numpy.linspace({low}, {high}, num=bins + 1)')}"]
    if args.number("part") == 1:
        return lines(*edges, "result = edges")
    weighted, dense = args.has("weights"), args.flag("density")
    share = ["total = numpy.sum(sums)", "result = sums / (edges[1:] - edges[:-1]) / total"] if dense else [
        f"result = {_as_float32(args, 'weights', 'sums') if weighted else 'sums'}"]
    fits = guard(f"{size('weights', 0)} == {size('x', 0)}", WEIGHTS) if weighted else ""
    return lines(fits, *edges, "last = edges.shape[0] - 1", "found = runtime.sought(edges, x, True)",
                 f"sums = {zeros(['last'], 'float64' if weighted or dense else 'int64')}",
                 f"for place in range({size('x', 0)}):", "    bin = found[place]",
                 "    if x[place] == edges[last]:", "        bin = last",
                 "    if bin >= 1 and bin <= last:",
                 f"        sums[bin - 1] += {'weights[place]' if weighted else '1'}", *share)


def _found_edges() -> list[str]:
    """From the least to the greatest number, which are moved apart where they are one."""
    return [guard("bins > 0", "np.histogram without bins"), "least = 0.0", "most = 1.0",
            f"if {size('x', 0)} > 0:", "    least = 1.0 * numpy.min(x)",
            "    most = 1.0 * numpy.max(x)",
            guard("-numpy.inf < least and least <= most and most < numpy.inf",
                  "np.histogram of numbers that are not finite"),
            "if least == most:", "    least = least - 0.5", "    most = most + 0.5",
            "edges = numpy.linspace(least, most, num=bins + 1)"]


def _as_float32(args: CallArguments, operand: str, value: str) -> str:
    """A value of float64 in the precision of an operand of float32."""
    return f"numpy.astype({value}, dtype=numpy.float32)" if args.type(operand).dtype == "float32" else value


# -- stores ----------------------------------------------------------------------------------------------------------

def _put(args: CallArguments) -> str:
    """Stores by number in row-major order, one after the other."""
    args.as_array("values")
    several = args.rank("values")
    value = "held[place % held.shape[0]]" if several else "values"
    before = ["held = numpy.copy(values)", guard("held.shape[0] > 0", "np.put without values")] if several else []
    args.as_array("places")
    rank = args.rank("x")
    if not args.rank("places"):
        return lines(*before, f"x[{_unraveled('x', rank, 'places')}] = {'held[0]' if several else 'values'}")
    return lines(*before, "held_places = numpy.copy(places)", "for place in range(held_places.shape[0]):",
                 "    at = held_places[place]", f"    x[{_unraveled('x', rank, 'at')}] = {value}")


def _unraveled(array: str, rank: int, place: str) -> str:
    """The subscripts of an element by its number in row-major order; one below 0 counts from the end."""
    below = [" * ".join(sizes(array, rank)[k + 1:]) for k in range(rank)]
    found = [f"{place} // ({b})" if b else place for b in below]
    return ", ".join(f if k == 0 else f"({f}) % {size(array, k)}" for k, f in enumerate(found))


def _putmask(args: CallArguments) -> str:
    if not args.rank("values"):
        return "x[...] = numpy.where(mask, values, x)"
    fits = [guard(f"{size('values', k)} == {size('x', k)}", "np.putmask with values of another shape")
            for k in range(args.rank("x"))]
    return lines(*fits, "x[...] = numpy.where(mask, values, x)")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.delete": _delete, "numpy.insert": _insert, "numpy.compress": _compress, "numpy.choose": _choose,
    "numpy.extract": _extract,
    "numpy.digitize": _digitize, "numpy.isin": _isin, "numpy.setdiff1d": _setdiff1d,
    "numpy.argwhere": _argwhere, "numpy.lexsort": _lexsort,
    "numpy.unique": _unique, "numpy.histogram": _histogram, "numpy.put": _put, "numpy.putmask": _putmask,
}
