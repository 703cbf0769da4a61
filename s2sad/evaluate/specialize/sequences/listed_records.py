"""Objects, dicts and named tuples in a list whose length only the run knows: rows of what they hold.

    events = []                                 events = []
    while t < end:                              while t < end:
        ...                                         ...
        if y < 0:                                   if y < 0:
            events.append(Event(t, v))                  events.append((t, v))
    return sum(e.t * e.v for e in events)       ...     row[0] * row[1]

What is put there and what is taken out is changed by nothing from then on, so that a copy of it is as good (what is
changed is a row of a table, and its number is put there: `object_tables`). What all of them share, a text or an object
that was there before, is no part of a row. Of texts that differ, as lines of a log, a derivative knows how many there
are and no more.
"""
from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.values import (
    FACTORY, Choice, Data, OpaqueValue, Reference, ResidualObject, TupleValue, Value, alike, constant, parts,
)
from s2sad.tree import AST

_ROW = "a row"      # the form of a number or an array: it has a place in the row
_TEXT = "a text"    # of which derivatives know nothing
ONE_OF_SEVERAL = -1        # how many items a deque keeps of which only the run knows which it is


@dataclass(frozen=True)
class _Form:
    """What an object is made of: `keys` with the forms of what they hold; `shared` is what all have."""
    kind: str
    made: Any = None
    keys: tuple[Any, ...] = ()
    inner: tuple[Any, ...] = ()
    shared: Value | None = None


@dataclass(eq=False)
class _Items:
    """What items are made of, once one is there; "" of numbers, arrays and tuples. Tuples of numbers are `width` wide,
    numbers 0. A deque keeps the last `most` of them. Objects were made at `sites`."""
    form: Any = None
    sites: set[Any] = field(default_factory=set)
    width: int | None = None
    is_read: bool = False
    most: int | None = None
    lists: list[ListedRecords] = field(default_factory=list)


class ListedRecords:
    """What is known of the items of the lists of one site, and of those that take their places."""

    def __init__(self, known: _Items | None = None):
        self.known = known or _Items()
        self.known.lists.append(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ListedRecords) and self.known is other.known

    __hash__ = None  # pyright: ignore[reportAssignmentType]

    def without_end(self) -> ListedRecords:
        """What is known of the items of a list that is no deque."""
        return ListedRecords(replace(self.known, is_read=True, most=None, lists=[]))

    def join(self, other: ListedRecords) -> None:
        """Makes what is known of both the same."""
        ours, theirs = self.known, other.known
        if ours is theirs:
            return
        if theirs.form is not None:
            ours.width = theirs.width if ours.form is None or ours.width == theirs.width else None
            ours.form = theirs.form if ours.form is None else _merged(ours.form, theirs.form)
        ours.sites |= theirs.sites
        ours.is_read |= theirs.is_read
        for one in theirs.lists:
            one.known = ours
        ours.lists += theirs.lists


@operation
def listed_records(ev: Evaluator, origin: AST) -> ListedRecords:
    """What the items of the lists that are made at a place are made of."""
    return ev.row_forms.setdefault(id(origin), ListedRecords())


@operation
def limit_items(ev: Evaluator, origin: AST, most: int) -> None:
    """The deques that are made at a place keep so many items."""
    rows = listed_records(ev, origin)
    if rows.known.most not in (None, most):
        raise ev.refusal(origin, "deques of several lengths are made here, whose items only the run counts",
                         help="make each in a statement of its own")
    rows.known.most = most


def hold_alike(*values: Value) -> bool:
    """Whether lists of the residual program that take each other's places keep as many items, which are made of the
    same: from then on they are."""
    listed = [v for v in values if isinstance(v, Data) and v.is_list]
    rows = [v.rows or ListedRecords() for v in listed]
    alike_made = len({r.known.most for r in rows}) < 2 and _have_one_form(rows)
    if alike_made and len(listed) == len(values):
        same_rows(listed)
    return alike_made


def _have_one_form(rows: Sequence[ListedRecords]) -> bool:
    forms = [r.known.form for r in rows if r.known.form is not None]
    return all(_same(forms[0], f) for f in forms)


def same_rows(values: Iterable[Data]) -> ListedRecords | None:
    """What the items are made of of a list that is one of several: they are from then on."""
    found: list[Any] = [v.rows for v in values]
    there = [r for r in found if r is not None]
    if len({r.known.most for r in there}) > 1 or len(there) < len(found) and any(r.known.most for r in there):
        return ListedRecords(_Items(most=ONE_OF_SEVERAL))
    if len(there) < len(found) or not _have_one_form(there):
        return None
    for other in there[1:]:
        there[0].join(other)
    return there[0] if there else None


@operation
def append_residual(ev: Evaluator, base: Data, value: Value, node: AST, f: Frame | None = None) -> None:
    """Appends to a list of the residual program; a deque that holds as many as it keeps loses its first one."""
    most = None if base.rows is None else base.rows.known.most
    if most == ONE_OF_SEVERAL:
        raise ev.refusal(node, "a deque with a length is one of several", help="give each a name of its own")
    item = ev.as_row(base.rows, value, node)
    added = tree.Call(tree.attribute(ev.spelled(base, node), "append"), [ev.spelled_item(item, node, f)], [])
    ev.emit(tree.Expr(tree.at(added, node)), node, True)
    if most is not None:
        length = tree.call("len", ev.spelled(base, node))
        popped = tree.Call(tree.attribute(ev.spelled(base, node), "pop"), [tree.const(0)], [])
        ev.emit(tree.If(tree.compare(length, tree.Gt(), tree.const(most)), [
            tree.at(tree.assign(ev.fresh("oldest"), popped), node)], []), node, True)


@operation
def as_row(ev: Evaluator, rows: ListedRecords | None, value: Value, node: AST) -> Value:
    """What is put into such a list in place of an object: the tuple of what it holds; any other value is itself."""
    if _is_none(value):
        raise ev.refusal(node, "None is put into a list whose length only the run knows",
                         help="keep a number that says the same: -1.0, or numpy.nan")
    is_text = _is_text_value(value)
    if not _has_records(ev, value) and not is_text:
        form: Any = ""
    elif rows is None:
        raise rows_wanted(ev, made_at(ev, value), ev.refusal(
            node, "an object is put into a list that is one of several", help="give the lists names of their own"))
    else:
        form = _TEXT if is_text else _form(ev, value)
    if rows is not None:
        there = rows.known
        known = form if there.form is None else there.form if there.is_read else _merged(there.form, form)
        there.form, form = known, _merged(form, known)
        if not _same(known, form):
            raise rows_wanted(ev, made_at(ev, value) | there.sites, ev.refusal(
                node, "objects that hold different things are put into one list whose length only the run knows",
                help="give each the same attributes, or keep a list for each kind"))
    if form == "":
        if rows is not None:
            rows.known.width = _width(value)
        return value
    if form == _TEXT:
        return constant(0)
    if isinstance(value, ResidualObject):
        return ev.named(value.number, "number", node)
    if not (leaves := [*_leaves(ev, value, form, set() if rows is None else rows.known.sites)]):
        raise rows_wanted(ev, made_at(ev, value), ev.refusal(node, "one object is put into a list again and again",
                                                            help="make a new one in each round of the loop"))
    return TupleValue(tuple(ev.atoms(v, "item", node) for v in leaves))


@operation
def listed_record(ev: Evaluator, listed: Data, item: Data, node: AST) -> Value:
    """The object that an item of a list stands for; the item itself of a list of numbers, arrays and tuples."""
    known = listed.rows.known if listed.rows is not None else _Items()
    form, known.is_read = known.form if listed.is_list else None, True
    if form is None and listed.rows is not None and ev.residual:
        ev.unfilled.append(listed.rows)     # what is put there says later what it is
        ev.raises("builtins.IndexError", [tree.const("list index out of range")], node)
    if not form:
        return replace(item, count=known.width) if known.width else replace(
            item, may_be_row=listed.is_list and known.width is None)
    if form == _TEXT:
        return OpaqueValue("a text of a list whose length only the run knows")
    if form.kind == "object":
        return ResidualObject(ev.named(replace(item, shape=()), "number", node), form.made)
    row = ev.named(item, "row", node)
    return _built(ev, form, row, iter(range(len([*_places(form)]))), node, known.sites)


@operation
def is_listed(ev: Evaluator, value: Value) -> bool:
    """Whether a value is an object that a list of the residual program holds: it must not be changed."""
    return isinstance(value, Reference) and value.number in ev.in_lists or any(is_listed(ev, p) for p in parts(value))


@operation
def refuse_objects(ev: Evaluator, values: Iterable[Value], node: AST) -> None:
    """Refuses lists of the residual program whose items stand for objects where these are used as they are."""
    for value in values:
        if isinstance(value, Data) and holds_objects(ev, value):
            raise ev.refusal(node, "a list of objects, whose length only the run knows, is used as a whole",
                             help="give the numbers that they hold: [p.x for p in ps]")
        refuse_objects(ev, parts(value), node)
        if isinstance(value, Reference) and ev.heap[value].kind == "list":
            refuse_objects(ev, ev.heap[value].items.values(), node)


@operation
def holds_objects(ev: Evaluator, listed: Data) -> bool:
    """Whether items of a list stand for objects; what is not known of one that is not filled is asked again."""
    known = listed.rows.known if listed.is_list and listed.rows is not None else None
    if known is not None and known.form is None and ev.residual:
        ev.unfilled.append(listed.rows)
    return known is not None and _holds_objects(known.form)


@operation
def may_hold(ev: Evaluator, listed: Data, table: Any) -> bool:
    """Whether items of a list stand for objects of a table."""
    form = listed.rows.known.form if holds_objects(ev, listed) else None
    return isinstance(form, _Form) and form.kind == "object" and form.made is table


def _holds_objects(form: Any) -> bool:
    """Whether items are objects, or have some in them."""
    return isinstance(form, _Form) and (form.kind in ("object", "record", "dict") or any(map(
        _holds_objects, form.inner)))


@operation
def listed_sites(ev: Evaluator, value: Value) -> set[Any] | None:
    """Where the objects of lists of the residual program were made that are in a value; None where there are none."""
    found = [ev.in_lists.get(value.number)] if isinstance(value, Reference) else [listed_sites(ev, p) for p in parts(
        value)]
    there = [sites for sites in found if sites is not None]
    return there[0] if len(there) == 1 else set[Any]().union(*there) if there else None


@operation
def as_listed(ev: Evaluator, value: Value, objects: Mapping[int, Object], sites: set[Any] | None) -> Value:
    """The value, whose objects must not be changed if they were made at `sites` as those of lists."""
    if sites is not None and isinstance(value, Reference) and value.number not in ev.in_lists:
        ev.in_lists[value.number] = sites
        for inner in objects[value.number].items.values():
            as_listed(ev, inner, objects, sites)
    for inner in parts(value):
        as_listed(ev, inner, objects, sites)
    return value


@operation
def rows_wanted(ev: Evaluator, made: set[Any], error: S2sadError) -> Unevaluated:
    """What is said where objects would have to be rows of tables, of which is known where they are made."""
    sites = frozenset() if None in made else frozenset(map(id, made))
    ev.held += [*made]
    return Unevaluated(error, objects=sites)


@operation
def changed_in_list(ev: Evaluator, number: int, node: AST) -> Unevaluated:
    """What is said of an object that a list of the run holds as a copy, and that is changed."""
    return rows_wanted(ev, ev.in_lists[number], ev.refusal(
        node, "an object is changed that a list holds whose length only the run knows",
        help="change it before it is appended, or append a new one"))


@operation
def made_at(ev: Evaluator, value: Value) -> set[Any]:
    """Where the objects in a value were made."""
    if isinstance(value, Reference):
        return ev.in_lists.get(value.number) or {ev.heap[value].site}
    return set[Any]().union(*(made_at(ev, p) for p in parts(value)))


def _width(value: Value) -> int | None:
    """How many numbers a tuple has, 0 of a number; None of what has no order, as an array."""
    items = value.items if isinstance(value, TupleValue) else (value,)
    if any(not isinstance(i, Data) or i.shape or i.is_list for i in items):
        return None
    return len(items) if isinstance(value, TupleValue) else getattr(value, "count", None) or 0


def _is_none(value: Value) -> bool:
    return isinstance(value, Data) and value.is_known and value.known is None


def _is_text_value(value: Value) -> bool:
    """Whether a value is a text, or one of several."""
    if isinstance(value, Choice):
        return all(map(_is_text_value, value.values))
    return isinstance(value, OpaqueValue) or isinstance(value, Data) and isinstance(value.known, str)


def _has_records(ev: Evaluator, value: Value) -> bool:
    """Whether a value is made of more than numbers and arrays."""
    if isinstance(value, TupleValue):
        return value.made is not None or any(
            _is_none(i) or _is_text_value(i) or _has_records(ev, i) for i in value.items)
    return isinstance(value, ResidualObject) or isinstance(value, Reference) and (
        ev.heap[value].kind in ("record", "dict"))


def _form(ev: Evaluator, value: Value) -> Any:
    """What a value is made of."""
    if isinstance(value, Data) and not (value.is_known and (value.known is None or isinstance(value.known, str))):
        return _ROW
    if isinstance(value, OpaqueValue) or isinstance(value, Choice) and _is_text_value(value):
        return _TEXT
    if isinstance(value, ResidualObject):
        return _Form("object", value.table)
    if isinstance(value, TupleValue):
        return _Form("tuple", value.made, inner=tuple(_form(ev, i) for i in value.items))
    held = ev.heap[value] if isinstance(value, Reference) else None
    loop = next((one for one in reversed(ev.loops) if not isinstance(one, tuple)), None)
    made_before = loop is not None and isinstance(value, Reference) and value.number in loop.start
    if held is None or made_before or held.kind not in ("record", "dict", "list") or held.live is not None or (
            held.path or held.most is not None or FACTORY in held.items):
        return _Form("shared", shared=value)
    return _Form(held.kind, held.made, tuple(held.items), tuple(_form(ev, i) for i in held.items.values()))


def _merged(one: Any, other: Any) -> Any:
    """The first of two forms, in which texts are any that differ between them."""
    if _is_text(one) and _is_text(other):
        return one if _same(one, other) else _TEXT
    if not isinstance(one, _Form) or not isinstance(other, _Form) or len(one.inner) != len(other.inner):
        return one
    return replace(one, inner=tuple(map(_merged, one.inner, other.inner)))


def _is_text(form: Any) -> bool:
    return form == _TEXT or isinstance(form, _Form) and isinstance(form.shared, Data) and isinstance(
        form.shared.known, str)


def _same(one: Any, other: Any) -> bool:
    if not isinstance(one, _Form) or not isinstance(other, _Form):
        return one == other
    if one.shared is not None or other.shared is not None:
        return one.shared is not None and other.shared is not None and alike(one.shared, other.shared)
    return (one.kind, one.made, one.keys) == (other.kind, other.made, other.keys) and len(one.inner) == len(
        other.inner) and all(map(_same, one.inner, other.inner))


def _leaves(ev: Evaluator, value: Any, form: Any, sites: set[Any]) -> Iterator[Value]:
    """The numbers and arrays that a value holds; nothing may change it from now on. Its objects are of `sites`."""
    if form == _ROW:
        yield value
    elif form == _TEXT:
        return
    elif form.kind == "object":
        yield value.number
    elif form.kind == "tuple":
        for item, inner in zip(value.items, form.inner):
            yield from _leaves(ev, item, inner, sites)
    elif form.kind == "shared":
        if isinstance(value, Reference):
            ev.in_lists[value.number] = {ev.heap[value].site}
    else:
        sites |= made_at(ev, value)
        ev.in_lists[value.number] = sites
        for item, inner in zip(ev.heap[value].items.values(), form.inner):
            yield from _leaves(ev, item, inner, sites)


def _places(form: Any) -> Iterator[None]:
    if form == _ROW or isinstance(form, _Form) and form.kind == "object":
        yield None
    elif form != _TEXT:
        for inner in form.inner:
            yield from _places(inner)


def _built(ev: Evaluator, form: Any, row: Data, places: Iterator[int], node: AST, sites: set[Any],
           wanted: str = "item") -> Value:
    """An object of what a row holds."""
    if form == _ROW:
        return ev.named(Data(tree.at(tree.index(tree.copy(row.node), tree.const(next(places))), node)), wanted, node)
    if form == _TEXT:
        return OpaqueValue("a text of a list whose length only the run knows")
    if form.kind == "shared":
        return form.shared
    if form.kind == "object":
        number = _built(ev, _ROW, row, places, node, sites, wanted)
        return ResidualObject(replace(number, shape=()), form.made)  # pyright: ignore[reportArgumentType]
    keys = form.keys or range(len(form.inner))
    items: dict[Hashable, Value] = {k: _built(ev, inner, row, places, node, sites, f"{row.name}_{k}")
                                    for k, inner in zip(keys, form.inner)}
    if form.kind == "tuple":
        return TupleValue(tuple(items.values()), form.made)
    made = ev.heap.new(Object(form.kind, items, form.made, label=row.name))
    ev.in_lists[made.number] = sites
    return made
