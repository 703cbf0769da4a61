"""Methods and parts of lists of the residual program, whose length only the run knows.

    a, b = todo.pop()       ->      item = todo.pop()
                                    a = item[0]
                                    b = item[1]

    late = h[1:]            ->      late = []
                                    for k in range(1, len(h)):
                                        late.append(h[k])
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.library.lists import METHODS, extend
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.sequences.counted_sequence import part_range
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, Value
from s2sad.tree import AST

COUNTED = "keep a table and counts: table[k, count[k]] = i; count[k] += 1"    # in place of lists in a list


@operation
def residual_list_method(ev: Evaluator, base: Data, name: str, args: Sequence[Value], keywords: Mapping[str, Value],
                         node: AST, f: Frame) -> Value | None:
    """What such a method gives; None of one that is left as it is."""
    if name == "append" and len(args) == 1:
        ev.append_residual(base, args[0], node, f)
        return NONE
    if name == "extend" and len(args) == 1:
        ev.extend_residual(base, args[0], node, f)
        return NONE
    at_end = name == "popleft" or name == "pop" and (not args or isinstance(args[0], Data) and args[0].known in (0, -1))
    if at_end:
        return _popped(ev, base, 0 if name == "popleft" else args[0].known if args else -1, node)  # pyright: ignore
    if name == "clear":
        called = tree.Call(tree.attribute(tree.copy(base.node), "clear"), [], [])
        ev.emit(tree.Expr(tree.at(called, node)), node, True)
        return NONE
    if name == "copy":
        return whole_list(base, node)
    if (method := METHODS.get(name)) is None:
        return None
    if base.rows is not None and base.rows.known.most is not None:
        raise ev.refusal(node, f".{name} of a deque with a length whose items only the run counts",
                         help="append, which takes out the first one where it is full")
    return ev.called_here(method, [base, *args], keywords, node, f)


def _popped(ev: Evaluator, base: Data, place: int, node: AST) -> Value:
    """The first item or the last, which the list no longer has."""
    called = tree.Call(tree.attribute(tree.copy(base.node), "pop"), [tree.const(place)], [])
    item = ev.fresh("item")
    ev.emit(tree.assign(item, tree.at(called, node)), node, True)
    return ev.listed_record(base, Data(tree.at(tree.name(item), node)), node)


@operation
def extend_residual(ev: Evaluator, old: Data, value: Value, s: Any, f: Frame) -> None:
    """What `old += value` and `old.extend(value)` leave of a residual list, which stays the one that it is."""
    if isinstance(value, Data) and not value.is_known and value.count is None:
        made_of = [v.rows.known for v in (old, value) if v.rows is not None]
        if any(k.form for k in made_of) or old.rows is not None and old.rows.known.most is not None:
            ev.called_here(extend, [old, ev.named(value, "added", s)], {}, s, f)
            return
        _share_items(old, value)
        whole, place = ev.named(value, "added", s), ev.fresh("k")
        taken = tree.index(tree.copy(whole.node), tree.name(place))
        added = tree.Call(tree.attribute(tree.copy(old.node), "append"), [taken], [])
        length = tree.call("len", tree.copy(whole.node))
        ev.emit(tree.counted_for(place, [length], [tree.at(tree.Expr(tree.at(added, s)), s)]), s, True)
        return
    for item in ev.items_of(value, s, f):
        ev.append_residual(old, item, s)


def _share_items(old: Data, value: Data) -> None:
    """What is known of the items that are added, numbers and arrays, is known of the list's."""
    if old.rows is not None and value.rows is not None:
        old.rows.join(value.rows)
    elif old.rows is not None:
        old.rows.known.form = old.rows.known.form or ""


@operation
def joined_lists(ev: Evaluator, parts: Sequence[Value], node: AST, f: Frame) -> Data:
    """A new list of the residual program with the items of several."""
    wanted = ev.wanted.get(node, ("items", node))[0]
    made = ev.named(Data(tree.at(tree.List([], tree.Load()), node), is_list=True, rows=ev.listed_records(node)), wanted,
                    node)
    for part in parts:
        ev.extend_residual(made, part, node, f)
    return made


def whole_list(value: Data, node: AST) -> Data:
    """`list(value)` of a residual list."""
    return replace(value, node=tree.at(tree.index(tree.copy(value.node), tree.Slice(None, None, None)), node))


@operation
def copied_part(ev: Evaluator, value: Data, wanted: str, node: AST) -> Data | None:
    """A part of a residual list that grows, as the list of its own that it is in Python; None of any other value."""
    found = part_range(value) if value.rows is not None else None
    return None if found is None else _copied_items(ev, *found, wanted, node)


@operation
def copied_parts(ev: Evaluator, value: Value, node: AST) -> Value:
    """What a loop goes through, with copies in place of parts of residual lists."""
    if isinstance(value, Iteration) and value.kind in ("zip", "enumerate", "reversed"):
        return replace(value, parts=tuple(copied_parts(ev, p, node) for p in value.parts))
    if not isinstance(value, Iteration) or value.kind != "part":
        return value
    listed, places = value.parts
    assert isinstance(listed, Data) and isinstance(places, Iteration)
    span = places.parts[0] if places.kind == "reversed" else places
    assert isinstance(span, Iteration)
    copied = _copied_items(ev, listed, [ev.spelled(p, node) for p in span.parts], "items", node)
    return Iteration("reversed", (copied,)) if places.kind == "reversed" else copied


def _copied_items(ev: Evaluator, listed: Data, bounds: Sequence[AST], wanted: str, node: AST) -> Data:
    """A list of the items at the places of a range."""
    rows = listed.rows
    if rows is not None and rows.known.most is not None:
        rows = rows.without_end()
    made, place = tree.at(tree.name(ev.fresh(wanted)), node), ev.fresh("k")
    taken = tree.Call(tree.attribute(tree.copy(made), "append"), [tree.index(listed.node, tree.name(place))], [])
    ev.emit(tree.assign(made.id, tree.List([], tree.Load())), node)
    ev.emit(tree.counted_for(place, [*bounds], [tree.at(tree.Expr(taken), node)]), node)
    return Data(made, is_list=True, rows=rows)
