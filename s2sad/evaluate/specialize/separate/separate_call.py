"""separate_call: a function of the user's stays one where it can: it is evaluated by itself, once for all calls alike.

    grid.fill(u, 0.1)           ->      def Grid_fill(first, u, rate): ...
    grid.fill(v, 0.2)                   Grid_fill(grid_first, u, 0.1)
                                        Grid_fill(grid_first, v, 0.2)

It must give arrays and numbers, and change nothing but the content of arrays: what else it does is done where it is
called (`NotSeparate`). A number that a call gives is one of its parameters, unless the function needs to know it.
"""
from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.assignment import holder_of
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import NOWHERE, Leave, Unbound, Unevaluated
from s2sad.evaluate.specialize.frames import arguments_of
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.separate.call_view import CallView, Changes, NotSeparate
from s2sad.evaluate.specialize.separate.needed_numbers import needed_numbers
from s2sad.evaluate.specialize.separate.returned_parts import (
    Part, Returned, given_leaves, merged, rebound_names, returned_parts, returning, returns_in, together,
)
from s2sad.evaluate.specialize.separate.separate_functions import SeparateFunction, acts
from s2sad.evaluate.specialize.sequences.generators import is_generator
from s2sad.evaluate.specialize.sparse.matrix_values import KINDS
from s2sad.evaluate.specialize.unread_lists import without_unread_lists
from s2sad.evaluate.specialize.sequences.constant_tables import with_tables
from s2sad.evaluate.specialize.values import NONE, Data, FunctionValue, Reference, Value, alike, parts
from s2sad.read.outside_values import Captured, UserFunctionValue
from s2sad.tree import AST

DEEPEST = 40


@dataclass(frozen=True)
class Made:
    """What calls alike call: the residual name, which of their leaves they give it, what comes back; whether it
    `acts`: writes arrays, prints, raises."""
    name: str
    leaves: tuple[int, ...]
    whole: Part
    results: tuple[Data, ...]
    acts: bool


@dataclass
class SeparateFunctions:
    """The functions of one evaluation: by what their calls see what they are, None where they are written out;
    `baked` are the numbers that each must know."""
    made: dict[Any, Made | None] = field(default_factory=dict)
    baked: dict[int, set[str]] = field(default_factory=dict)
    inlined: set[int] = field(default_factory=set)
    underway: list[Any] = field(default_factory=list)
    trees: dict[int, list[tuple[Any, str]]] = field(default_factory=dict)
    acting: set[str] = field(default_factory=set)       # those that do more than to compute
    derivatives: dict[Any, str] = field(default_factory=dict)
    lambdas: dict[int, Captured] = field(default_factory=dict)      # as functions that are defined


class _Again(Exception):
    """A function calls itself with what it was called with."""

    def __init__(self, key: Any):
        super().__init__()
        self.key = key


@operation
def separate_call(ev: Evaluator, function: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value],
                  node: AST, f: Frame) -> Value | None:
    """What a call of a function that stays one gives; None where it is written out."""
    wanted, ev.targets = ev.targets, ()
    found = None if ev.inlines else separate_function(ev, function, args, keywords, node, f)
    return None if found is None else _called(ev, *found, node, f, wanted)


def separate_function(ev: Evaluator, function: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value],
                      node: AST, f: Frame) -> tuple[Made, CallView] | None:
    """The function that a call with these arguments calls, and what it sees; None where it cannot be one of its own."""
    definition: Any = function.captured.tree
    known = ev.separate = ev.separate or SeparateFunctions()
    if ev.evaluates_module or ev.depth > DEEPEST or id(definition) in known.inlined or not isinstance(
            definition, tree.FunctionDef) or is_generator(definition) or definition.args.kwarg and keywords:
        return None
    given = arguments_of(ev, function, definition, args, keywords, node, f)
    baked = known.baked.setdefault(id(definition), set())
    while True:
        try:
            view = CallView(ev, function, given, baked)
        except NotSeparate:
            return None
        if view.key not in known.made:
            if view.key in known.underway:
                raise _Again(view.key)
            baked |= _make(ev, known, view, definition, node)
            continue
        made = known.made[view.key]
        return None if made is None else (made, view)


def _make(ev: Evaluator, known: SeparateFunctions, view: CallView, definition: Any, node: AST) -> set[str]:
    """Evaluates a function by itself; gives the numbers that it must know, if any."""
    known.underway.append(view.key)
    try:
        known.made[view.key] = _evaluated(ev, known, view, definition, node)
        return set()
    except Changes:
        known.made[view.key] = None
        known.inlined.add(id(definition))
        ev.held.append(definition)
        return set()
    except _Needed as needed:
        return needed.names
    except _Again as again:
        if again.key != view.key:
            raise
    except Unevaluated as reason:
        asked = {name for name in view.numbers.values() if view.demand(name) in reason.demands}
        if asked:
            return asked
        if reason.endless and reason.demands:       # callers know more
            raise
    except (S2sadError, NotSeparate, Unbound, Leave):
        pass
    finally:
        known.underway.pop()
    if view.numbers:
        return set(view.numbers.values())
    known.made[view.key] = None
    return set()


class _Needed(Exception):
    def __init__(self, names: set[str]):
        super().__init__()
        self.names = names


# -- evaluation ------------------------------------------------------------------------------------------------------
_STATE = ("block", "effects", "rebound", "pending", "names", "leaves", "paths", "texts", "loops", "returned", "depth",
          "emitted", "guarded", "returns", "label", "called", "owning", "wanted", "targets", "touched", "born",
          "tables")


@contextmanager
def _apart(ev: Evaluator, view: CallView) -> Iterator[list[Returned]]:
    """The evaluator with nothing but what a function sees; what it returns."""
    kept, objects = {name: getattr(ev, name) for name in _STATE}, ev.heap.objects
    every: list[Returned] = []

    def returns(s: AST, value: Value, f: Frame) -> None:
        del f
        made, returned = returning(ev, value, len(every), s)
        every.append(returned)
        ev.emit(made, s)
    ev.block, ev.rebound, ev.pending, ev.loops, ev.returned = [], [], [], [], []
    ev.names, ev.texts, ev.returns = view.names, set(), returns
    ev.leaves = {leaf.name for leaf in view.leaves if leaf.is_held}
    ev.paths = {leaf.name: ev.paths[leaf.outer.name] for leaf in view.leaves if leaf.outer.name in ev.paths}
    ev.effects = ev.emitted = 0
    ev.depth += 1
    ev.label, ev.called, ev.touched, ev.born, ev.wanted, ev.tables = "", "", set(), {}, {}, {}
    ev.heap.objects = {**ev.outset, **view.objects}
    # what is given has holders elsewhere
    ev.heap.new(Object("frame", {k: Reference(n) for k, n in enumerate(view.order)}))
    try:
        yield every
    finally:
        ev.heap.objects = objects
        for name, value in kept.items():
            setattr(ev, name, value)
        for number, held in ev.outset.items():
            objects.setdefault(number, held)


def _evaluated(ev: Evaluator, known: SeparateFunctions, view: CallView, definition: Any, node: AST) -> Made:
    live = {*ev.live}
    with _apart(ev, view) as every:
        frame = ev.frame_of(view.function, definition, True)
        for name, value in view.bound.items():
            ev.heap.put(frame.reference, name, value)
        try:
            ev.statements(definition.body, frame)
            ev.returns(node, NONE, frame)
        except Leave as leave:
            if leave.mark != NOWHERE:
                raise
        if any(held.kind in KINDS for held in ev.heap.objects.values()):
            raise Changes("it makes a sparse matrix, whose places the caller has to look after")
        body = with_tables(ev, without_unread_lists(ev.block))
        returned = returns_in(body, every)
        if any(isinstance(n, tree.Attribute) and isinstance(n.ctx, tree.Store) for n in tree.walk(body)):
            raise Changes("it gives an array another shape")
        if not returned or any(isinstance(ev.live[k], Data) for k in ev.live.keys() - live):
            raise NotSeparate("it never returns, or a list is made of what is outside")
        for r in returned:
            _check_unchanged(view, r.objects, ev.touched)
        rebound = rebound_names(body) | {*ev.rebound}
        given_back = returned_parts(view, returned, body, rebound)
        for r, part in zip(returned, given_back):
            nodes = [ev.spelled(v, r.node) for v in part.leaves]
            r.node.value = None if not nodes else nodes[0] if len(nodes) == 1 else tree.tuple_of(*nodes)
            tree.at(r.node, r.node)
        body = body[:-1] if not given_back[0].leaves and isinstance(body[-1], tree.Return) else body
        given = {leaf.name: leaf.outer.known for leaf in view.leaves}
        numbers = needed_numbers(body, {n: given[n] for n in view.numbers})
        if numbers:
            raise _Needed({view.numbers[n] for n in numbers})
        results = tuple(map(merged, zip(*(p.leaves for p in given_back))))
    return _named(ev, known, view, definition, body, given_back[0].whole, results)


def _check_unchanged(view: CallView, objects: Mapping[int, Object], touched: Collection[int]) -> None:
    """Raises Changes where an object that is given holds something else; one from outside holds from then on what was
    read of it."""
    for number, before in view.objects.items():
        after = objects[number]
        if after is before:
            continue
        same = all(k in after.items and alike(v, after.items[k]) for k, v in before.items.items())
        new = [v for k, v in after.items.items() if k not in before.items]
        outside = before.live is not None and number not in touched and all(map(_is_outside, new))
        if not same or new and not outside:
            raise Changes("it changes what it is given")


def _is_outside(value: Value) -> bool:
    """Whether a value has no names of the function's own in it: what is computed once for an object has."""
    if isinstance(value, Data):
        return "." in value.name or value.is_literal
    return all(map(_is_outside, parts(value)))


def _named(ev: Evaluator, known: SeparateFunctions, view: CallView, definition: Any, body: list[AST], whole: Part,
           results: tuple[Data, ...]) -> Made:
    """The residual function, or one of the same text that is there."""
    used = {n.id for n in tree.walk(body) if isinstance(n, tree.Name)}
    bound = {n.id for n in tree.walk(body) if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Store)}
    leaves = tuple(sorted((k for k, leaf in enumerate(view.leaves) if leaf.name in used),
                          key=lambda k: view.leaves[k].position))
    parameters = [view.leaves[k].name for k in leaves]
    if any("." not in n and n not in bound and n not in parameters and not hasattr(__import__("builtins"), n)
           for n in used):
        raise NotSeparate("it reads a name that it does not have")
    does_more = any(acts(s, known.acting) for s in tree.walk_statements(body))
    function = tree.function("", parameters, body or [tree.Pass()])
    there = known.trees.setdefault(id(definition), [])
    for other, name in there:
        if tree.equal(other.args, function.args) and len(other.body) == len(function.body) and all(
                map(tree.equal, other.body, function.body)):
            return Made(name, leaves, whole, results, does_more)
    tree.at(function, definition)
    name = f"separate.{len(ev.outside)}"
    handle = SeparateFunction(ev, view.function, function)
    ev.outside[name] = UserFunctionValue(definition.name, ("separate", id(handle)), "", handle)
    there.append((function, name))
    known.acting |= {name} if does_more else set()
    return Made(name, leaves, whole, results, does_more)


# -- calls -----------------------------------------------------------------------------------------------------------
def _called(ev: Evaluator, made: Made, view: CallView, node: AST, f: Frame, wanted: tuple[str, ...]) -> Value:
    """The call of a function that stays one."""
    for k in given_leaves(made.whole):      # what comes back is what was given, and not the same computed again
        leaf = view.leaves[k]
        view.leaves[k] = replace(leaf, outer=ev.named(leaf.outer, leaf.name, node))
    args = [ev.spelled(view.leaves[k].outer, node) for k in made.leaves]
    call = tree.at(tree.Call(tree.at(tree.name(made.name), node), args, []), node)
    if not made.results:
        if made.acts:
            ev.emit(tree.Expr(call), node, True)
        return together(ev, view, made.whole, ())
    if made.whole.kind == "leaf" and not made.acts:
        return replace(made.results[0], node=call)
    names = _targets(ev, made, wanted, f)
    targets = [tree.name(n) for n in names]
    ev.emit(tree.assign(targets[0] if len(targets) == 1 else tree.tuple_of(*targets), call), node, made.acts)
    leaves = [replace(r, node=tree.at(tree.name(n), node)) for n, r in zip(names, made.results)]
    return together(ev, view, made.whole, leaves)


def _targets(ev: Evaluator, made: Made, wanted: tuple[str, ...], f: Frame) -> list[str]:
    """Names for what is returned: those of the targets that take it, where it is no more than arrays and numbers."""
    whole = made.whole.parts if made.whole.kind == "tuple" else (made.whole,)
    direct = [p.what for p in whole] == list(range(len(wanted))) and all(p.kind == "leaf" for p in whole)
    names: list[str] = []
    for k, result in enumerate(made.results):
        own = _own_name(ev, f, wanted[k]) if direct else ""
        if own and own not in names:
            ev.rebound.append(own)
            ev.effects += 1
            names.append(own)
        else:
            names.append(ev.fresh(wanted[k] if direct else result.name or "result"))
    return names


def _own_name(ev: Evaluator, f: Frame, name: str) -> str:
    """The residual name that a variable alone holds."""
    old = ev.heap[holder_of(ev, f, name)].items.get(name)
    return old.name if isinstance(old, Data) and ev.owns(old.name) else ""


