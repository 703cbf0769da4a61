"""sorted, min, max, queues: by what is known before the run; else by an order that the run finds.

    sorted([a, b])                      ordered = np.sort(np.array((a, b)));  [ordered[0], ordered[1]]
    max(spheres, key=radius)            which = np.argmax(np.array((r_0, r_1)));  one of the objects, by that number
"""
from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.library import lists
from s2sad.evaluate.specialize.control.choices import chosen
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.values import (
    NONE, Choice, Data, Reference, ResidualObject, TupleValue, Value, constant, with_parts,
)
from s2sad.tree import AST

_MOST_ALTERNATIVES = 16     # things of which a variable picks one: what reads it is evaluated for each
_MOST_ORDERED = 4           # of which each place holds one: what reads all is evaluated for each combination


@operation
def sorted_items(ev: Evaluator, items: list[Value], options: Options, node: AST, f: Frame) -> list[Value]:
    """Items in the order of their keys."""
    back = bool(ev.known(options["reverse"], node, "reverse=")) if "reverse" in options else False
    keys = _keys(ev, items, options, node, f)
    known = _ordered(ev, lambda at, key: sorted(at, key=key, reverse=back), keys, node)
    if known is not None:
        return [items[k] for k in known]
    if _has_no_key(options) and not _width(keys):
        ordered = _sorted_array(ev, _row(ev, keys, node, f), back, node, f)
        return [Data(tree.at(tree.index(tree.copy(ordered.node), tree.const(k)), node), shape=()) for k in range(
            len(items))]
    order = ev.named(_order(ev, keys, back, node, f), "order", node)
    places = [Data(tree.at(tree.index(tree.copy(order.node), tree.const(k)), node)) for k in range(len(items))]
    return [_picked(ev, items, place, node, f, _MOST_ORDERED) for place in places]


def _keys(ev: Evaluator, items: Sequence[Value], options: Options, node: AST, f: Frame) -> list[Value]:
    """What items are ordered by; each key is asked for once."""
    plain, key = _has_no_key(options), options.get("key")
    keys = [i if plain else ev.atoms(ev.call(key, [i], {}, node, f), "key", node) for i in items]
    for k in keys:
        if isinstance(k, TupleValue) and ev.special_method(k, "__lt__", node, f) is not None:
            raise ev.refusal(node, f"{ev.kind_of(k)} is ordered, whose class defines '__lt__'", help="give a key=")
    return keys


def _has_no_key(options: Options) -> bool:
    key = options.get("key")
    return key is None or isinstance(key, Data) and key.known is None


def _is_known(key: Value) -> bool:
    return not isinstance(key, Data) or key.is_known


def _ordered(ev: Evaluator, does: Any, keys: Sequence[Value], node: AST) -> Any:
    """What a function gives of the places of keys, None where what is known of them does not tell."""
    if not all(map(_is_known, keys)):
        return None
    known = [_sort_key(ev, k, node) for k in keys]
    if len({str(k) for k in known}) < len(known) and any(type(k) is tuple and k[-1:] == (...,) for k in known):
        return None
    try:
        return does(range(len(known)), known.__getitem__)
    except TypeError:
        return None


def _sort_key(ev: Evaluator, value: Value, node: AST) -> Any:
    """What a list is sorted by; of a tuple the items before the first that is not known, which is `...`."""
    if not isinstance(value, TupleValue):
        return value.known if isinstance(value, Data) and value.is_known else (...,)
    known: list[Any] = []
    for item in value.items:
        if not (isinstance(item, Data) and item.is_known):
            return (*known, ...)
        known.append(item.known)
    return tuple(known)


def _width(keys: Sequence[Value]) -> int:
    """How many numbers are in each key, if all are tuples of as many; else 0."""
    widths = {len(k.items) if isinstance(k, TupleValue) else 0 for k in keys}
    return widths.pop() if len(widths) == 1 else 0


# -- orders that the run finds ---------------------------------------------------------------------------------------
def _row(ev: Evaluator, values: Sequence[Value], node: AST, f: Frame) -> Data:
    """An array of numbers."""
    if not all(isinstance(v, Data) and not isinstance(v.known, (str, tuple, type(None))) for v in values):
        raise ev.unknown(node, "what a list is sorted by must be known before the run, or be a number for each item")
    return ev.library_call("numpy.array", [TupleValue(tuple(values))], {}, node, f)


def _order(ev: Evaluator, keys: Sequence[Value], back: bool, node: AST, f: Frame) -> Any:
    """The places of keys of which only the run knows the order; of equal ones the first is the first."""
    if not _width(keys):
        return ev.called_here(lists.order_of_numbers, [_row(ev, keys, node, f), constant(back)], {}, node, f)
    columns: Any = zip(*(k.items for k in keys))  # pyright: ignore[reportAttributeAccessIssue]
    rows = TupleValue(tuple(ev.named(_row(ev, column, node, f), "column", node) for column in columns))
    return ev.called_here(lists.order_of_columns, [rows, constant(back)], {}, node, f)


def _sorted_array(ev: Evaluator, array: Value, back: bool, node: AST, f: Frame) -> Data:
    made = ev.named(ev.library_call("numpy.sort", [array], {}, node, f), "ordered", node)
    if not back:
        return made
    turned = tree.index(tree.copy(made.node), tree.Slice(None, None, tree.negate(tree.const(1))))
    return ev.named(replace(made, node=tree.at(turned, node)), "ordered", node)


def _picked(ev: Evaluator, items: Sequence[Value], place: Data, node: AST, f: Frame, most: int = _MOST_ALTERNATIVES
            ) -> Value:
    """The item at a place that the run finds: a number of an array of them, else one of the items."""
    if all(isinstance(i, Data) and (i.shape == () or i.is_known and isinstance(i.known, (int, float))) for i in items):
        row = ev.named(_row(ev, items, node, f), "items", node)
        return Data(tree.at(tree.index(row.node, ev.spelled(place, node)), node), shape=())
    if len(items) <= most and all(isinstance(i, Data) and not i.is_known and not i.is_list for i in items):
        return _one_array(ev, [ev.atoms(i, "item", node) for i in items], ev.named(place, "place", node), node, f)
    if isinstance(items[0], ResidualObject) and all(
            isinstance(i, ResidualObject) and i.table is items[0].table for i in items):
        numbers = [i.number for i in items if isinstance(i, ResidualObject)]
        return with_parts(items[0], [_picked(ev, numbers, place, node, f, most)])
    shapes = {(i.made, len(i.items)) for i in items if isinstance(i, TupleValue)}
    if len(shapes) == 1 and all(isinstance(i, TupleValue) for i in items):
        columns: Any = list(zip(*(i.items for i in items)))  # pyright: ignore[reportAttributeAccessIssue]
        where = ev.named(place, "place", node)
        return TupleValue(tuple(_picked(ev, column, where, node, f, most) for column in columns), shapes.pop()[0])
    refused = ev.refusal(node, "what a list is sorted by must be known before the run",
                         help="sort an array of numbers, or its places: np.argsort(...)")
    if len(items) > most:
        sites = {ev.heap[i].site if isinstance(i, Reference) else None for i in items}
        raise ev.rows_wanted(sites, refused)
    if not ev.choices:
        raise Unevaluated(refused, choice="sorted items")
    held = tuple(ev.atoms(i, "item", node) for i in items)
    return Choice(ev.named(place, "which", node), held, (*range(len(held)),))


def _one_array(ev: Evaluator, items: Sequence[Value], place: Data, node: AST, f: Frame, first: int = 0) -> Value:
    """One of several arrays, under a name that each way binds to one of them."""
    if len(items) == 1:
        return items[0]
    test = tree.compare(tree.copy(place.node), tree.Eq(), tree.const(first))
    return chosen(ev, Data(tree.at(test, node)), (
        lambda: items[0], lambda: _one_array(ev, items[1:], place, node, f, first + 1)), node, f)


@function("builtins.sorted")
def _sorted(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    given = args[0]
    if isinstance(given, Data) and not given.is_known and not given.is_list and _has_no_key(options):
        if given.shape is not None and len(given.shape) != 1:
            raise ev.refusal(node, "what is sorted is no array of numbers")
        back = bool(ev.known(options["reverse"], node, "reverse=")) if "reverse" in options else False
        return ev.library_call("builtins.list", [_sorted_array(ev, given, back, node, f)], {}, node, f)
    if isinstance(given, Data) and given.is_list:
        back = bool(ev.known(options["reverse"], node, "reverse=")) if "reverse" in options else False
        order = _order_of_list(ev, given, options, back, "order", node, f)
        return ev.called_here(lists.in_order, [given, order], {}, node, f)
    return ev.list_of(sorted_items(ev, ev.items_of(given, node, f), options, node, f), node)


def _order_of_list(ev: Evaluator, items: Data, options: Options, back: bool, wanted: str, node: AST, f: Frame) -> Any:
    """The places of the items of a list of the residual program in their order, or the `first` of these."""
    keys = items if _has_no_key(options) else ev.called_here(
        lists.keys_of, [items, options["key"]], {}, node, f)
    known = None if keys.rows is None else keys.rows.known
    width = None if known is None or known.form else 0 if known.form is None else known.width
    if width is None:
        raise ev.unknown(node, "what a list is sorted by must be known before the run, or be a number for each item")
    kind, more = ("numbers", []) if not width else ("rows", [constant(width)])
    return ev.called_here(getattr(lists, f"{wanted}_of_{kind}"), [keys, constant(back), *more], {}, node, f)


@function("builtins.min", "builtins.max")
def _extreme(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    name = ev.called
    one = args[0] if len(args) == 1 else None
    if isinstance(one, Data) and one.is_list and "default" not in options and (
            not _has_no_key(options) or one.rows is not None and one.rows.known.width):
        place = _order_of_list(ev, one, options, name == "max", "first", node, f)
        return ev.item_of(one, ev.named(place, "place", node), node, f)
    if "key" in options:
        items = ev.items_of(args[0], node, f) if len(args) == 1 else args
        if not items and "default" in options:
            return options["default"]
        return _extreme_of(ev, name, items, _keys(ev, items, options, node, f), node, f)
    if "default" in options and len(args) == 1 and isinstance(args[0], Data):
        return _extreme_or(ev, args[0], options["default"], node, f)
    is_whole = one is not None and isinstance(one, Data) and one.count is None      # an array, or a list of the run
    items = args if len(args) > 1 else () if is_whole else ev.items_of(args[0], node, f)
    if any(isinstance(i, TupleValue) for i in items) and not any(
            ev.special_method(i, "__lt__", node, f) or ev.special_method(i, "__gt__", node, f) for i in items):
        return _extreme_of(ev, name, items, items, node, f)
    if len(args) == 1 and not is_whole:
        default = options.pop("default", None)
        if not items and default is not None:
            return default
        return items[0] if len(items) == 1 else ev.library_call(f"builtins.{name}", items, options, node, f)
    return None


def _extreme_of(ev: Evaluator, name: str, items: Sequence[Value], keys: Sequence[Value], node: AST, f: Frame) -> Value:
    """The item with the least key, or the largest one; of several the first."""
    does = min if name == "min" else max
    known = _ordered(ev, lambda at, key: does(at, key=key), keys, node)
    if known is not None:
        return items[known]
    if _width(keys):
        place = ev.item_of(_order(ev, keys, name == "max", node, f), constant(0), node, f)
    else:
        place = ev.library_call(f"numpy.arg{name}", [_row(ev, keys, node, f)], {}, node, f)
    return _picked(ev, items, ev.named(place, "place", node), node, f)


def _extreme_or(ev: Evaluator, value: Data, default: Value, node: AST, f: Frame) -> Value:
    """The extreme of an array or a list of the residual program, or what is given where it has no items."""
    path, count = f"builtins.{ev.called}", ev.length(value, node, f)

    def extreme() -> Value:
        return ev.library_call(path, [value], {}, node, f)
    if not isinstance(count, Data) or count.is_known:
        return extreme() if not isinstance(count, Data) or count.known else default
    some = Data(tree.at(tree.compare(ev.spelled(count, node), tree.Gt(), tree.const(0)), node))
    return chosen(ev, some, (extreme, lambda: default), node, f)


# -- queues and places in what is sorted -----------------------------------------------------------------------------
class _Item:
    """An item of a queue, by a key that is known."""

    def __init__(self, value: Value, key: Any, refused: Exception):
        self.value, self.key, self.refused = value, key, refused

    def __lt__(self, other: _Item) -> bool:
        own, others = (k if isinstance(k, tuple) else (k,) for k in (self.key, other.key))
        if next((a is ... or b is ... for a, b in zip(own, others) if a is ... or b is ... or a != b), False):
            raise self.refused
        try:
            return own < others
        except TypeError:
            raise self.refused from None


@function("heapq.heappush", "heapq.heappop", "heapq.heapify", "heapq.heappushpop", "heapq.heapreplace")
def _queue(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    name, queue = ev.called, args[0]
    if isinstance(queue, Data) and queue.is_list and name in lists.QUEUES:
        return ev.called_here(lists.QUEUES[name], args, {}, node, f)
    held = ev.heap[queue] if isinstance(queue, Reference) else None
    refused = ev.unknown(node, "a queue is ordered by what is not known before the run", site=held and held.site,
                         help="loop over the items, and take the first: min(queue, key=...)")
    if not isinstance(queue, Reference) or ev.heap[queue].kind != "list":
        raise refused
    items, *given = [[_Item(v, _sort_key(ev, v, node), refused) for v in several]
                     for several in (ev.sequence_items(queue), *([a] for a in args[1:]))]
    found = getattr(heapq, name)(items, *(g[0] for g in given))
    ev.replace_items(queue, [i.value for i in items], node)
    return NONE if found is None else found.value


@function("bisect.insort", "bisect.insort_right", "bisect.insort_left")
def _insort(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    if len(args) != 2 or options.keys() - {"key"}:
        raise ev.refusal(node, "bisect.insort into a part of a list", help="append, and sort")
    left = ev.called == "insort_left"
    return ev.called_here(lists.insort_left if left else lists.insort_right, args, options, node, f)


@function("bisect.bisect", "bisect.bisect_right", "bisect.bisect_left")
def _bisect(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    if options or len(args) != 2:
        raise ev.refusal(node, "bisect with more than a list and a number is not supported in a kernel")
    side = "left" if ev.called == "bisect_left" else "right"
    row = args[0] if isinstance(args[0], Data) else _row(ev, ev.items_of(args[0], node, f), node, f)
    return ev.library_call("numpy.searchsorted", [row, args[1]], {"side": Data(tree.const(side), side)}, node, f)
