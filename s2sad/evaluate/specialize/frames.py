"""Frames of calls: their names, and how arguments come to parameters.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import FunctionValue, TupleValue, Value
from s2sad.tree import AST


@operation
def frame_of(ev: Evaluator, function: FunctionValue, definition: Any, is_entry: bool = False) -> Frame:
    """The frame of a call."""
    a = definition.args
    parameters = [p.id for p in (*a.posonlyargs, *a.args, *a.kwonlyargs)]
    outer = ev.frames.get(function.frame) if function.frame is not None else None
    body = [definition.body] if type(definition).__name__ == "Lambda" else definition.body
    local, nonlocals = local_names(body)
    extra = [p.id for p in (a.vararg, a.kwarg) if p is not None]
    reference = ev.heap.new(Object("frame", {}))
    return Frame(reference, function.captured, outer, function.owner, is_entry, len(ev.pending), len(ev.loops),
                 definition.__dict__.get("name", ""), frozenset({*local, *parameters, *extra}), nonlocals,
                 parameters[0] if parameters else "")


@operation
def inner_frame(ev: Evaluator, f: Frame, generator: Any) -> Frame:
    """The frame of a comprehension, inside its function's."""
    reference = ev.heap.new(Object("frame", {}))
    names = frozenset(n.id for n in tree.walk(generator.target) if isinstance(n, tree.Name))
    return replace(f, reference=reference, outer=f, local=names, nonlocals=frozenset(), is_entry=False)


def local_names(body: Sequence[Any]) -> tuple[frozenset[str], frozenset[str]]:
    """The names that a function binds itself, and those that it binds around itself."""
    bound: set[str] = set()
    outer: set[str] = set()
    work = list(body)
    while work:
        node = work.pop()
        kind = type(node).__name__
        if kind in ("FunctionDef", "ClassDef"):
            bound.add(node.name)
            work += node.decorator_list
            continue
        if kind in ("Lambda", "ListComp", "SetComp", "DictComp", "GeneratorExp"):
            if kind != "Lambda":
                bound |= {n.target.id for n in tree.walk(node) if type(n).__name__ == "NamedExpr"}
            continue
        if kind in ("Nonlocal", "Global"):
            outer |= {*node.names}
        elif kind in ("Import", "ImportFrom"):
            bound |= {(n.asname or n.name).partition(".")[0] for n in node.names}
        elif isinstance(node, tree.Name) and isinstance(node.ctx, tree.Store):
            bound.add(node.id)
        elif kind in ("MatchAs", "MatchStar") and node.name:
            bound.add(node.name)
        work += tree.children(node)
    return frozenset(bound - outer), frozenset(outer)


@operation
def bind_arguments(ev: Evaluator, function: FunctionValue, definition: Any, args: Sequence[Value],
                    keywords: Mapping[str, Value], node: AST, frame: Frame) -> None:
    """Arguments to parameters of a frame."""
    for name, value in arguments_of(ev, function, definition, args, keywords, node, frame).items():
        ev.heap.put(frame.reference, name, ev.atoms(value, name, node))


def arguments_of(ev: Evaluator, function: FunctionValue, definition: Any, args: Sequence[Value],
                 keywords: Mapping[str, Value], node: AST, f: Frame) -> dict[str, Value]:
    """What each parameter is given, as Python does it."""
    a = definition.args
    positional = [p.id for p in (*a.posonlyargs, *a.args)]
    only = [p.id for p in a.kwonlyargs]
    title = function.captured.name
    given: dict[str, Value] = dict(zip(positional, args))
    if len(args) > len(positional) and a.vararg is None:
        raise ev.refusal(node, f"'{title}' takes {len(positional)} arguments, and is given {len(args)}")
    more: dict[str, Value] = {}
    by_name = {*positional[len(a.posonlyargs):], *only}
    for k, v in keywords.items():
        if k in given or k not in by_name and a.kwarg is None:
            raise ev.refusal(node, f"'{title}' {'is given' if k in given else 'has no parameter'} '{k}'"
                             + (" twice" if k in given else ""))
        (given if k in by_name else more)[k] = v
    defaults = dict(function.defaults)
    found = {name: given[name] if name in given else _default(ev, function, definition, name, defaults, node, f)
             for name in [*positional, *only]}
    if a.vararg is not None:
        found[a.vararg.id] = TupleValue(tuple(args[len(positional):]))
    if a.kwarg is not None:
        found[a.kwarg.id] = ev.new_dict(dict(more), node)
    return found


def _default(ev: Evaluator, function: FunctionValue, definition: Any, name: str, defaults: Mapping[str, Value],
             node: AST, frame: Frame) -> Value:
    if name in defaults:
        return defaults[name]
    found = ev.default_of(function, name, node, frame)
    if found is None:
        raise ev.refusal(node, f"'{function.captured.name}' is not given '{name}'")
    return found
