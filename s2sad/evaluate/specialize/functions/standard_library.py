"""functools, itertools, operator, copy over what is known.
"""
from __future__ import annotations

import functools
import itertools
from collections.abc import Hashable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.numeric_operators import OPERATORS
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.functions.library_calls import FUNCTIONS, Args, Options, function
from s2sad.evaluate.specialize.sequences.endless import is_endless
from s2sad.evaluate.specialize.sequences.generators import is_lazy
from s2sad.evaluate.specialize.sequences.nested_ranges import COMBINED, rows_of
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    Conflict, Data, FunctionValue, Iteration, LibraryValue, Reference, ResidualObject, ScopeValue, SliceValue,
    TupleValue, Value, constant,
)
from s2sad.read.outside_values import LibraryScope
from s2sad.tree import AST

_SCOPES = ("FunctionDef", "Lambda", "ClassDef", "ListComp", "SetComp", "DictComp", "GeneratorExp")
_CACHES = ("functools.cached", "functools.memoized")
_LONGEST_ROW = 64       # values of one combination


@function("functools.reduce")
def _reduce(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    items = ev.items_of(args[1], node, f)
    total = args[2] if args[2:] else items.pop(0)
    for item in items:
        total = ev.atoms(ev.call(args[0], [total, item], {}, node, f), "total", node)
    return total


@function("functools.partial")
def _partial(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    inner, *first = [ev.atoms(a, "given", node) for a in args]
    held = {k: ev.atoms(v, k, node) for k, v in options.items()}
    if isinstance(inner, (FunctionValue, LibraryValue)):
        return replace(inner, first=(*inner.first, *first), keywords=tuple({**dict(inner.keywords), **held}.items()))
    raise ev.refusal(node, f"a partial of {ev.kind_of(inner)}")


@function("functools.partialmethod")
def _partialmethod(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("functools.partialmethod", tuple(ev.atoms(a, "given", node) for a in args), tuple(
        (k, ev.atoms(v, k, node)) for k, v in options.items()))


@function("functools.cached")
def _cached(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    """What a function behind a cache gives, called as any other: a number of numbers, and it does nothing else."""
    inner, *given = args
    before = ev.snapshot()
    found = ev.call(inner, given, options, node, f) if _is_pure(ev, inner) else None
    if not all(isinstance(v, Data) and (v.is_known or v.shape == ()) for v in (found, *given, *options.values())) or (
            ev.has_changed(before)):
        raise ev.refusal(node, "a function behind a cache, which is more than one of numbers, or reads what may change",
                         help="call the function inside: give it a name, as in inner = f.__wrapped__")
    assert found is not None
    return found


def _is_pure(ev: Evaluator, function: Value) -> bool:
    before = ev.snapshot()
    closed = isinstance(function, FunctionValue) and _is_closed(ev, function, {function.key})
    ev.restore(before)
    return closed


def _is_closed(ev: Evaluator, function: FunctionValue, seen: set[Hashable]) -> bool:
    """Whether a function reads nothing but its arguments, functions and libraries: the same for the same arguments."""
    definition = function.captured.tree
    nodes = list(tree.walk(definition.body))
    if function.defaults or function.first or any(type(n).__name__ in _SCOPES for n in nodes):
        return False
    frame = ev.frame_of(function, definition)
    for n in nodes:
        if not isinstance(n, tree.Name) or n.id in frame.local:
            continue
        value = ev.value(n, frame)
        value = value.first[0] if isinstance(value, LibraryValue) and value.path in _CACHES else value
        if isinstance(value, FunctionValue) and value.key not in seen:
            seen.add(value.key)
            if not _is_closed(ev, value, seen):
                return False
        elif not isinstance(value, (FunctionValue, LibraryValue)) and not (
                isinstance(value, ScopeValue) and isinstance(value.scope, LibraryScope)):
            return False
    return True


@function("functools.wraps")
def _wraps(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("s2sad.identity")


@function("functools.lru_cache", "functools.cache")
def _cache(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    """A function with its cache, or what makes one; a function that is defined in the kernel has a dict of results."""
    functions = [a for a in args if isinstance(a, FunctionValue)]
    most = [*(a for a in args if isinstance(a, Data)), options.get("maxsize", constant(128))][0]
    if not functions:
        return LibraryValue("functools.cache", (), (("maxsize", constant(None) if ev.called == "cache" else most),))
    if functions[0].frame is None:
        return LibraryValue("functools.cached", (functions[0],))
    most = options["maxsize"] if "maxsize" in options else constant(None) if ev.called == "cache" else most
    return LibraryValue("functools.memoized", (functions[0], ev.new_dict({}, node), most))


@function("functools.memoized")
def _memoized(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """What a function gave for these arguments, or gives."""
    inner, results, most, *given = args
    assert isinstance(results, Reference)
    if _is_pure(ev, inner):
        return _cached(ev, [inner, *given], options, node, f)
    named = (TupleValue((constant(k), v)) for k, v in options.items())
    key = ev.key_of(TupleValue((*given, TupleValue((*named,)))), node)
    if key not in ev.heap[results].items:
        found = ev.call(inner, given, options, node, f)
        count = len(ev.heap[results].items)
        if not (isinstance(most, Data) and (most.known is None or type(most.known) is int and count < most.known)):
            raise ev.refusal(node, "a cache that forgets: it is asked for more results than it holds",
                             help="write maxsize=None")
        ev.assign_slot(results, key, found, "cached", node)
    found = ev.heap[results].items[key]
    if isinstance(found, Conflict):
        raise ev.refusal(node, "a cache that holds this result on some ways only",
                         help="call the function for it before the branch, or leave the cache out")
    return found


@function("s2sad.identity", "builtins.staticmethod", "typing.cast",
          "typing.final", "abc.abstractmethod", "numba.jit", "numba.njit")
def _identity(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    functions = [a for a in args if isinstance(a, (FunctionValue, Data, Reference))]
    return functions[-1] if functions else LibraryValue("s2sad.identity")


@function("itertools.chain")
def _chain(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return TupleValue(tuple(i for a in args for i in ev.items_of(a, node, f)))


@function(*COMBINED)
def _combined(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value | None:
    path, given = f"itertools.{ev.called}", dict(options)
    first, rest = (args, []) if path == COMBINED[0] else (args[:1], args[1:])
    times = [*rest, *given.values()]
    count = ev.known(times[0], node, "how many are taken") if times else 1
    if count * len(first) > _LONGEST_ROW:
        raise ev.refusal(node, f"combinations of more than {_LONGEST_ROW} sequences", help="write nested loops")
    made = ev.iterator(path, *first, more=count)
    if all(isinstance(a, Iteration) and a.kind == "range" for a in first):
        return made
    return TupleValue(tuple(ev.items_of(made, node, f)))


@function("itertools.accumulate")
def _accumulate(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    given = {**dict(zip(("iterable", "func", "initial"), args)), **options}
    given = {k: v for k, v in given.items() if not (isinstance(v, Data) and v.known is None)}
    items = [*([given["initial"]] if "initial" in given else []), *ev.items_of(given["iterable"], node, f)]
    found: list[Value] = items[:1]
    for item in items[1:]:
        both = [found[-1], item]
        total = ev.binary(tree.Add(), *both, node, f) if "func" not in given else ev.call(
            given["func"], both, {}, node, f)
        found.append(ev.atoms(total, "total", node))
    return TupleValue(tuple(found))


@function("itertools.permutations")
def _permutations(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value:
    items = list(enumerate(ev.items_of(args[0], node, f)))
    sizes = [ev.known(a, node, "how many are taken") for a in (*args[1:], *options.values())]
    return TupleValue(tuple(rows_of(ev, itertools.permutations(items, *sizes), node)))


@function("itertools.pairwise")
def _pairs(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value:
    return ev.iterator("itertools.pairwise", ev.atoms(args[0], "items", node))


@function("itertools.count")
def _count(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    given = {"start": constant(0), "step": constant(1), **dict(zip(("start", "step"), args)), **options}
    return ev.endless_iterator("itertools.count", node, given["start"], given["step"])


@function("itertools.cycle")
def _cycle(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    if isinstance(args[0], Data) and not isinstance(args[0].known, tuple):
        raise ev.refusal(node, "itertools.cycle of an array or a list of the run, which keeps what it gives first",
                         help="take the items by their places: w[k % len(w)]")
    items = ev.items_of(args[0], node, f)
    if not items:
        raise ev.refusal(node, "itertools.cycle of nothing")
    return ev.endless_iterator("itertools.cycle", node, TupleValue(tuple(items)), args[0])


@function("itertools.repeat")
def _repeat(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value:
    times = [*args[1:], *options.values()]
    if not times:
        return ev.endless_iterator("itertools.repeat", node, args[0])
    count = max(ev.known(times[0], node, "how many are taken"), 0)
    ev.counted(args[:1], node, count)
    return TupleValue((args[0],) * count)


@function("itertools.islice")
def _islice(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value:
    """A part of a sequence from its start, of what ends or does not."""
    bounds = [ev.known(a, node, "how many are taken") for a in args[1:]]
    if any(b is not None and (type(b) is not int or b < 0) for b in bounds):
        raise ev.refusal(node, "itertools.islice with what is no place from the start")
    start, stop, step = (*(bounds if bounds[1:] else [0, *bounds]), None)[:3]
    if isinstance(args[0], Data) and not args[0].is_known:
        return ev.item_of(args[0], SliceValue(tuple(map(constant, (start, stop, step)))), node, f)
    if stop != 0 and is_lazy(args[0]):
        return ev.written_function("itertools.islice", [args[0], *map(constant, (start or 0, stop, step or 1))], {},
                                   node, f)
    if not is_endless(args[0]) or stop is None:
        return TupleValue(tuple(itertools.islice(ev.items_of(args[0], node, f), start, stop, step)))
    both = ev.items_of(Iteration("zip", (Iteration("range", (constant(stop),)), args[0])), node, f)
    return TupleValue(tuple(b.items[1] for b in both[start::step] if isinstance(b, TupleValue)))


def _operators() -> None:
    for kind, (_, word) in OPERATORS.items():
        FUNCTIONS[f"operator.{word}"] = functools.partial(_by_operator, kind)


def _by_operator(kind: type, ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.binary(kind(), args[0], args[1], node, f)


_operators()


@function("copy.copy", "copy.deepcopy")
def _copy(ev: Evaluator, args: Args, _: Options, node: Any, f: Frame) -> Value:
    return copied(ev, args[0], ev.called == "deepcopy", node, {})


def copied(ev: Evaluator, value: Value, deep: bool, node: AST, made: dict[Reference | str, Value]) -> Value:
    """A copy, with its own arrays where it is deep; what is one object, or one array, is one in the copy, too."""
    if isinstance(value, Reference):
        if value in made:
            return made[value]
        if is_sparse(value, ev.heap):
            ev.refuse_whole(value, node)
        held = ev.heap[value]
        own = [n for n in ("__copy__", "__deepcopy__", "__reduce__", "__getstate__", "__setstate__")
               if ev.class_item(held.made, n, node, ev.entry) is not None]
        if held.live is not None or own:
            raise ev.refusal(node, f"a copy of {ev.kind_of(value)} from outside, or with {', '.join(own) or 'a class'}",
                             help="make another object of what it holds")
        new = ev.heap.new(replace(held, items={}, path="", site=node if held.kind == "record" else held.site))
        made[value] = new
        for k, v in held.items.items():
            inner = copied(ev, v, deep, node, made) if deep else v
            ev.assign_slot(new, k, inner, str(k), node)
        return ev.as_residual(new, node)
    if isinstance(value, ResidualObject):
        held = {k: ev.residual_item(value, k, node) for k in value.table.columns}
        return ev.copied_residual(value, {k: copied(ev, v, deep, node, made) if deep else v for k, v in held.items()},
                                  node)
    if isinstance(value, TupleValue):
        return replace(value, items=tuple(copied(ev, v, deep, node, made) for v in value.items)) if deep else value
    if isinstance(value, Data) and not value.is_known and value.shape != ():
        if value.name in made:
            return made[value.name]
        new = ev.named(Data(tree.at(tree.call(ev.library("numpy.copy"), ev.spelled(value, node)), node),
                            shape=value.shape), "copy", node)
        if value.name:
            made[value.name] = new
        return new
    return value
