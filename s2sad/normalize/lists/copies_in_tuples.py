"""copies_in_tuples: what a list of tuples or lists holds are copies here, in Python the arrays themselves; refused
where that would tell.

    ts.append((u, v))                   for p, q in ts:
    u[0] = 0.0          refused             p[0] += q[1]            refused: Python writes u

Requires structured form and types, and the marks of `lists`, by which such a row differs from an array that is made of
arrays. Changes nothing.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.call_types import LISTED, MARKS
from s2sad.normalize.context import NormalContext
from s2sad.normalize.lists.copy_semantics import is_shared, is_told
from s2sad.evaluate.effects import Memory
from s2sad.normalize.lists.lists_of_views import HELP, ListContents
from s2sad.tree import (
    AST, Assign, FunctionDef, IfExp, List, Name, Slice, Subscript, Tuple, call, call_name, const, indices, rebuild,
    stored_names, walk,
)


def copies_in_tuples(function: FunctionDef, context: NormalContext) -> None:
    """Puts into the report what such a list would tell."""
    typing, program, writes, report = context.typing, context.program, context.written, context.report
    if not any(call_name(n) == LISTED for n in walk(function.body)):
        return
    held = ListContents(function, typing, writes)
    apart = {id(s): [i for i in _items(s.value) if is_shared(i, typing)
                     and base_name(i) not in held.made]      # a list of its own has stores of its own
             for stores in held.stores.values() for s in stores if _is_row(s.value)}
    if not any(apart.values()):
        return
    memory = Memory(rebuild(function, lambda n: call("numpy.empty", const(0)) if call_name(n) == LISTED else None),
                    program)
    every = [s for stores in held.stores.values() for s in stores]
    for listed, stores in held.stores.items():
        for store in stores:
            items = apart.get(id(store), [])
            if any(is_told(function, store, item, every, memory) for item in items):
                report.error("S201", "a list holds an array that is written, not a copy of it", store, help=HELP)
            elif items and (place := _telling(listed, store, items, held, typing)) is not None:
                report.error("S201", f"the list {listed!r} holds views of an array, or one array several times, and "
                             "what it holds is written", place, help=HELP)


def _is_row(value: AST) -> bool:
    if isinstance(value, IfExp):
        return _is_row(value.body) or _is_row(value.orelse)
    return isinstance(value, (Tuple, List)) or call_name(value) in MARKS


def _items(value: AST) -> Iterator[AST]:
    """What lies in a row, or in the rows of it."""
    if isinstance(value, IfExp):
        yield from (i for v in (value.body, value.orelse) for i in _items(v))
    elif isinstance(value, (Tuple, List)):
        yield from (i for v in value.elts for i in _items(v))
    elif call_name(value) in MARKS:
        yield from _items(value.args[0])
    else:
        yield value


def _telling(listed: str, store: Assign, items: list[AST], held: ListContents, typing: Typing) -> AST | None:
    """The first statement that writes an array of a row by the list, where another name or row would tell."""
    kept = [i for i in items if not _is_alone(store, i, items, held)]
    rank = min((typing.of(i).rank for i in kept), default=0)
    own = held.views_of({listed})
    while more := {n for n, stores in held.stores.items() if any(
            held.sources(s.value) & own for s in stores)} - own:
        own |= held.views_of(more)
    filling = {id(s) for stores in held.stores.values() for s in stores if not isinstance(s.targets[0], Name)}
    parts = {n for n in own if 0 < held.typing.table[n].rank <= rank}
    for statement in walk(held.function.body):
        if not kept or id(statement) in filling or not _written(statement, held) & own:
            continue
        if not _puts(statement, rank, typing) or parts & held.references.after[id(statement)]:
            return statement
    return None


def _written(statement: AST, held: ListContents) -> set[str]:
    """The arrays that a statement stores into; of a name that was bound just before, what it stands for."""
    found: set[str] = set()
    for n in held.written(statement):
        bound = _bound(statement, n, held)
        found |= {n} if bound is None or n in held.made else held.sources(bound.value)
    return found


def _bound(statement: AST, identifier: str, held: ListContents) -> Assign | None:
    """The statement that binds a name as a statement of the same block finds it; None if it is in no such place."""
    block = next(b for b in held.blocks if any(s is statement for s in b))
    for s in reversed(block[:next(k for k, s in enumerate(block) if s is statement)]):
        if isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id == identifier:
            return s
        if identifier in stored_names(s):
            return None
    return None


def _is_alone(store: Assign, item: AST, items: list[AST], held: ListContents) -> bool:
    """Whether a row holds an array that is made for it and is used by no other name."""
    if not isinstance(item, Name) or sum(isinstance(i, Name) and i.id == item.id for i in items) > 1:
        return False
    return held.is_new(store, item.id) and not held.views_of({item.id}) & held.references.after[id(store)]


def _puts(statement: AST, rank: int, typing: Typing) -> bool:
    """Whether a statement puts another array into a row, and writes none."""
    target = statement.targets[0] if isinstance(statement, Assign) else None
    return isinstance(target, Subscript) and typing.of(target).rank >= rank and not any(
        isinstance(i, Slice) or typing.of(i).is_array or getattr(i, "value", None) is Ellipsis for i in indices(target))
