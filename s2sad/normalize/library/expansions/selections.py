"""What functions are made of that leave elements out, repeat them or put others between, and that count in bins.

Places are integers, and have no derivative: what is picked by them has.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import (
    WEIGHTS, CallArguments, empty, guard, lines, made, part, size, sizes, zeros,
)

_OUTSIDE = "np.{}: the place is not in the array"


def _flat(asked: CallArguments, text: str) -> str:
    """Of all elements in a row, where no axis is named."""
    return lines("flat = numpy.ravel(x)", text) if asked.rank("x") > 1 and not asked.given("axis") else ""


def _axis(asked: CallArguments) -> int:
    return asked.axis(asked.rank("x")) if asked.given("axis") else 0


def _array(asked: CallArguments, parameter: str) -> str:
    """The name of an argument that may be a list that is spelled out, and what gives it one."""
    asked.as_array(parameter)
    return f"held_{parameter} = {parameter}" if asked.rank(parameter) else ""


# -- elements left out, repeated, put between ------------------------------------------------------------------------

def _deleted(asked: CallArguments) -> str:
    if found := _flat(asked, "result = numpy.delete(flat, places)"):
        return found
    axis, rank = _axis(asked), asked.rank("x")
    n, kind = size("x", axis), asked.type("x").dtype
    whole = sizes("x", rank)
    held = _array(asked, "places")
    if not held:
        whole[axis] = f"{n} - 1"
        fits = guard(f"-{n} <= places and places < {n}", _OUTSIDE.format("delete"))
        return lines(fits, f"gone = places % {n}", f"result = {empty(whole, kind)}",
                     f"{part('result', axis, ':gone')} = {part('x', axis, ':gone')}",
                     f"{part('result', axis, 'gone:')} = {part('x', axis, 'gone + 1:')}")
    if asked.type("places").dtype == "bool":
        return lines(held, "left = numpy.nonzero(held_places == 0, part=0)", f"result = {part('x', axis, 'left')}")
    keep = [f"keep = {made('ones', [n], 'bool')}", "for place in range(held_places.shape[0]):",
            "    keep[held_places[place]] = False"]
    return lines(held, *keep, "left = numpy.nonzero(keep, part=0)", f"result = {part('x', axis, 'left')}")


def _inserted(asked: CallArguments) -> str:
    if found := _flat(asked, "result = numpy.insert(flat, place, values)"):
        return found
    axis, rank = _axis(asked), asked.rank("x")
    n, whole = size("x", axis), sizes("x", rank)
    several = rank == 1 and asked.rank("values") == 1
    more = size("values", 0) if several else "1"
    whole[axis] = f"{n} + {more}"
    fits = guard(f"-{n} <= place and place <= {n}", _OUTSIDE.format("insert"))
    new = f"result = {empty(whole, asked.type('x').dtype)}"
    return lines(fits, "at = place", "if at < 0:", f"    at = at + {n}", new,
                 f"{part('result', axis, ':at')} = {part('x', axis, ':at')}",
                 f"{part('result', axis, f'at:at + {more}' if several else 'at')} = values",
                 f"{part('result', axis, f'at + {more}:')} = {part('x', axis, 'at:')}")


def repeated(asked: CallArguments) -> str:
    """`np.repeat` with a number for each element."""
    if found := _flat(asked, "result = numpy.repeat(flat, repeats)"):
        return found
    axis = _axis(asked)
    n = size("x", axis)
    fits = guard(f"held_repeats.shape[0] == {n}", "np.repeat with another number of counts than of elements")
    least = guard("held_repeats[place] >= 0", "np.repeat with a count below 0")
    return lines(_array(asked, "repeats"), fits, "count = 0", f"for place in range({n}):", f"    {least}",
                 "    count += held_repeats[place]", f"taken = {empty(['count'], 'int64')}", "count = 0",
                 f"for place in range({n}):", "    for again in range(held_repeats[place]):",
                 "        taken[count] = place", "        count += 1", f"result = {part('x', axis, 'taken')}")


def _compressed(asked: CallArguments) -> str:
    if asked.rank("x") > 1 and not asked.given("axis"):
        return lines("flat = numpy.ravel(x)", "result = numpy.compress(condition, flat)")
    return lines(_array(asked, "condition"), "left = numpy.nonzero(held_condition, part=0)",
                 f"result = {part('x', _axis(asked), 'left')}")


def _extracted(asked: CallArguments) -> str:
    """By the number of an element in the order of rows, whatever the shapes are."""
    if asked.rank("condition") == asked.rank("x"):
        return lines("mask = condition != 0", "result = x[mask]")
    return lines("flat = numpy.ravel(x)", "left = numpy.nonzero(numpy.ravel(condition), part=0)", "result = flat[left]")


def _chosen(asked: CallArguments) -> str:
    choices = [asked.let("choice", node) for node in asked.items("choices")]
    outside = f"numpy.count_nonzero((a < 0) | (a >= {len(choices)}))"
    text = choices[-1]
    for k, choice in reversed(list(enumerate(choices[:-1]))):
        text = f"numpy.where(a == {k}, {choice}, {text})"
    return lines(f"outside = {outside}", guard("outside == 0", "np.choose: a number that no choice has"),
                 f"result = {text}")


# -- places ----------------------------------------------------------------------------------------------------------

def _digitized(asked: CallArguments) -> str:
    fits = guard(f"{size('bins', 0)} < 2 or bins[0] <= bins[{size('bins', 0)} - 1]",
                 "np.digitize with bins that decrease: turn them around, bins[::-1]")
    if asked.rank("x"):
        return lines(fits, f"result = runtime.sought(bins, x, {not asked.true('right')})")
    return lines(fits, f"result = numpy.searchsorted(bins, x, side='{'left' if asked.true('right') else 'right'}')")


def _is_in(asked: CallArguments) -> str:
    held = _array(asked, "values")
    other = "True" if not asked.true("invert") else "False"
    start = f"result = {made('zeros' if other == 'True' else 'ones', sizes('a', asked.rank('a')), 'bool')}"
    counters = [f"place{k}" for k in range(asked.rank("a"))]
    nest = [f"{'    ' * k}for {c} in range({size('a', k)}):" for k, c in enumerate(counters)]
    inner, at = "    " * len(counters), ", ".join(counters)
    return lines(held, start, *nest, f"{inner}for other in range(held_values.shape[0]):",
                 f"{inner}    if a[{at}] == held_values[other]:", f"{inner}        result[{at}] = {other}")


def _left_over(asked: CallArguments) -> str:
    """The numbers that another array has not, in order."""
    return lines("found = numpy.unique(a)", "kept = numpy.isin(found, values, invert=True)",
                 "left = numpy.nonzero(kept, part=0)", "result = found[left]")


def _argwhere(asked: CallArguments) -> str:
    rank = asked.rank("x")
    return lines("count = numpy.count_nonzero(x)", f"result = {empty(['count', str(rank)], 'int64')}",
                 *(f"result[:, {k}] = runtime.places(x, count, {k})" for k in range(rank)))


def _lexsorted(asked: CallArguments) -> str:
    """By the last key; what is equal there by the one before."""
    *others, last = [asked.let("key", node) for node in asked.items("keys")]
    found = [f"order = numpy.argsort({others[0] if others else last}, kind='mergesort')"]
    for k, key in enumerate([*others[1:], last] if others else []):
        found += [f"row{k} = {key}[order]", f"again = numpy.argsort(row{k}, kind='mergesort')", "order = order[again]"]
    return lines(*found, "result = order")


def _unique(asked: CallArguments) -> str:
    """Of the numbers in order, the first of those that are equal; `part` counts what is asked for."""
    n = size("x", 0)
    given = [p for p in ("return_index", "return_inverse", "return_counts") if asked.true(p)]
    number = asked.number("part") or 0
    wanted = given[number - 1] if number else ""
    new = "place == 0 or x[order[place]] != x[order[place - 1]]"
    nans = [] if asked.type("x").is_integer else [guard(
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

def _histogram(asked: CallArguments) -> str:
    """Numbers in bins, or the sums of their weights; the last bin has both of its ends."""
    if asked.rank("bins"):
        edges = ["edges = numpy.copy(bins)", guard("edges[0] <= edges[edges.shape[0] - 1]",
                                                   "np.histogram with edges that decrease")]
    else:
        low, high = (asked.let("end", node) for node in asked.items("range"))
        edges = [guard(f"{low} < {high}", "np.histogram with a range whose ends are equal or exchanged"),
                 f"edges = {_as_single(asked, 'x', f'numpy.linspace({low}, {high}, num=bins + 1)')}"]
    if asked.number("part") == 1:
        return lines(*edges, "result = edges")
    weighted = asked.given("weights")
    fits = guard(f"{size('weights', 0)} == {size('x', 0)}", WEIGHTS) if weighted else ""
    return lines(fits, *edges, "last = edges.shape[0] - 1", "found = runtime.sought(edges, x, True)",
                 f"sums = {zeros(['last'], 'float64' if weighted else 'int64')}",
                 f"for place in range({size('x', 0)}):", "    bin = found[place]",
                 "    if x[place] == edges[last]:", "        bin = last",
                 "    if bin >= 1 and bin <= last:",
                 f"        sums[bin - 1] += {'weights[place]' if weighted else '1'}",
                 f"result = {_as_single(asked, 'weights', 'sums') if weighted else 'sums'}")


def _as_single(asked: CallArguments, operand: str, value: str) -> str:
    """A value of float64 in the precision of an operand of float32."""
    return f"numpy.astype({value}, dtype=numpy.float32)" if asked.type(operand).dtype == "float32" else value


# -- stores ----------------------------------------------------------------------------------------------------------

def _put(asked: CallArguments) -> str:
    """Stores at places in the order of rows, one after the other."""
    asked.as_array("values")
    several = asked.rank("values")
    value = "held[place % held.shape[0]]" if several else "values"
    before = ["held = numpy.copy(values)", guard("held.shape[0] > 0", "np.put without values")] if several else []
    asked.as_array("places")
    rank = asked.rank("x")
    if not asked.rank("places"):
        return lines(*before, f"x[{at_flat('x', rank, 'places')}] = {'held[0]' if several else 'values'}")
    return lines(*before, "held_places = numpy.copy(places)", "for place in range(held_places.shape[0]):",
                 "    at = held_places[place]", f"    x[{at_flat('x', rank, 'at')}] = {value}")


def at_flat(array: str, rank: int, place: str) -> str:
    """The subscripts of an element by its number in the order of rows; one below 0 counts from the end."""
    below = [" * ".join(sizes(array, rank)[k + 1:]) for k in range(rank)]
    found = [f"{place} // ({b})" if b else place for b in below]
    return ", ".join(f if k == 0 else f"({f}) % {size(array, k)}" for k, f in enumerate(found))


def _masked(asked: CallArguments) -> str:
    if not asked.rank("values"):
        return "x[...] = numpy.where(mask, values, x)"
    fits = [guard(f"{size('values', k)} == {size('x', k)}", "np.putmask with values of another shape")
            for k in range(asked.rank("x"))]
    return lines(*fits, "x[...] = numpy.where(mask, values, x)")


SELECTIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.delete": _deleted, "numpy.insert": _inserted, "numpy.compress": _compressed, "numpy.choose": _chosen,
    "numpy.extract": _extracted,
    "numpy.digitize": _digitized, "numpy.isin": _is_in, "numpy.setdiff1d": _left_over,
    "numpy.argwhere": _argwhere, "numpy.lexsort": _lexsorted,
    "numpy.unique": _unique, "numpy.histogram": _histogram, "numpy.put": _put, "numpy.putmask": _masked,
}
