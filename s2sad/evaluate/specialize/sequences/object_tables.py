"""Objects of which only the run knows which is which, and which are changed: rows of tables, one for each class.

    while t < end:                              particle_x, particle_v = [], []
        ps.append(Particle(x, v))               while t < end:
        for p in ps:                                particle_x.append(x); particle_v.append(v)
            p.x += p.v * dt                         ps.append(len(particle_x) - 1)
        ps = [p for p in ps if p.x < end]           for p in ps:
                                                        particle_x[p] += particle_v[p] * dt
                                                    ps = [p for p in ps if particle_x[p] < end]

A table has a list for each attribute; an object is the number of its row, whoever holds it, so that what is changed by
one name is changed for all. What is no number and no array must be the same for all objects of a table.
"""
from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.choices import is_structural
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.listed_records import ListedRecords
from s2sad.evaluate.specialize.values import (
    FACTORY, NONE, ClassValue, Data, Reference, ResidualObject, TupleValue, Value, alike,
)
from s2sad.tree import AST

_KINDS = ("record", "dict", "list")


@dataclass(eq=False)
class ObjectTable:
    """The objects of one make: by attribute, key or place the list of what they hold, or what all of them hold; where
    that is an object, it was made at one of the `sites`."""
    kind: str
    made: ClassValue | None
    columns: dict[Hashable, Value] = field(default_factory=dict)
    sites: dict[Hashable, Any] = field(default_factory=dict)

    @property
    def first(self) -> Data:
        """A column of numbers or arrays, which has as many items as there are objects."""
        return next(c for c in self.columns.values() if isinstance(c, Data) and c.is_list)


@operation
def as_residual(ev: Evaluator, value: Value, node: AST) -> Value:
    """An object that was made at a place as a row of its table, where that is asked; any other value as it is."""
    if not isinstance(value, Reference) or id(node) not in ev.object_sites or ev.heap[value].kind not in _KINDS:
        return value
    held = ev.heap[value]
    kept = ev.heap.holders(value) or value.number in ev.in_lists
    if kept or held.path or held.live is not None or held.most is not None or FACTORY in held.items:
        raise ev.refusal(node, f"{ev.kind_of(value)} is kept elsewhere before it is made, and put into a list whose "
                         "length only the run knows", help="put it there behind its __init__")
    table = _table(ev, held, node)
    for key, item in held.items.items():
        column = table.columns[key]
        if isinstance(column, Data) and column.is_list and not is_structural(item):
            ev.append_residual(column, item, node)
        elif not alike(column, item):
            raise _differs(ev, table, key, item, node)
    last = tree.BinOp(tree.call("len", tree.copy(table.first.node)), tree.Sub(), tree.const(1))
    del ev.heap.objects[value.number]
    return ResidualObject(ev.named(Data(tree.at(last, node), shape=()), held.label or _title(held), node), table)


def _table(ev: Evaluator, held: Object, node: AST) -> ObjectTable:
    """The table of such objects, with a column for what each holds."""
    make = held.kind, held.made, tuple(held.items)
    table = ev.object_tables.get(make)
    if table is None:
        table = ev.object_tables[make] = ObjectTable(held.kind, held.made)
        for key, item in held.items.items():
            table.columns[key] = item if _stays(ev, item, node) else _column(f"{_title(held)}_{key}")
            table.sites[key] = ev.heap[item].site if isinstance(item, Reference) else None
        if not any(isinstance(c, Data) and c.is_list for c in table.columns.values()):
            raise ev.refusal(node, f"{_said(held)}, which holds no numbers and no arrays, is put into a list whose "
                             "length only the run knows", help="give it a number: self.number = k")
    return table


def _column(title: str) -> Data:
    """A list that is made where the kernel begins, under a name that is settled when all is evaluated."""
    return Data(tree.name(f"?{title}"), is_list=True, rows=ListedRecords())


def _title(held: Object) -> str:
    return held.made.name.lower() if held.made is not None else held.kind


def _said(held: Object | ObjectTable) -> str:
    return f"an object of class {held.made.name}" if held.made is not None else f"a {held.kind}"


def _stays(ev: Evaluator, item: Value, node: AST) -> bool:
    """Whether what an object holds is asked to be the same for all objects of the table."""
    if isinstance(item, (TupleValue, ResidualObject)):
        return False
    if isinstance(item, Data):
        return is_structural(item)
    if isinstance(item, Reference):
        loop = next((one for one in ev.loops if not isinstance(one, tuple)), None)
        if loop is not None and item.number not in loop.start:
            raise _asked(ev, {ev.heap[item].site}, f"{ev.kind_of(item)} that each round of a loop makes", node)
    return True


def _differs(ev: Evaluator, table: ObjectTable, key: Hashable, item: Value, node: AST) -> Exception:
    """What is said of an object that does not hold what all of its table do."""
    what = f"'{key}' of {_said(table)}, of which only the run knows which is which,"
    if isinstance(table.columns[key], Reference) and isinstance(item, Reference):
        return _asked(ev, {table.sites[key], ev.heap[item].site}, f"{what} is another object for each", node)
    return ev.refusal(node, f"{what} is something else for each, and no number and no array",
                      help="keep a number that says the same, and compare that")


def _asked(ev: Evaluator, sites: set[Any], said: str, node: AST) -> Exception:
    """Asks for objects that are rows of tables, too."""
    return ev.rows_wanted(sites, ev.refusal(node, f"{said} is put into a list whose length only the run knows",
                                            help="make it where the object is made"))


# -- what an object holds ----------------------------------------------------------------------------------------------
@operation
def residual_item(ev: Evaluator, base: ResidualObject, key: Hashable, node: AST) -> Value:
    """What an object holds under an attribute, a key or at a place that its table has."""
    column = base.table.columns[key]
    if not isinstance(column, Data) or not column.is_list:
        return column
    return ev.item_of(column, base.number, node, None)


@operation
def residual_place(ev: Evaluator, base: Value, key: Any, node: AST) -> tuple[Data, Data] | None:
    """The list in which an object holds what an attribute is, and its place there; None of anything else."""
    if not isinstance(base, ResidualObject):
        return None
    column = base.table.columns.get(key if isinstance(key, str) else _key(ev, base, key, node))
    return (column, base.number) if isinstance(column, Data) and column.is_list else None


def _key(ev: Evaluator, base: ResidualObject, place: Value, node: AST) -> Hashable:
    """The key of an item of a dict or a list."""
    if base.table.kind == "dict":
        return ev.key_of(place, node)
    k = ev.known(place, node, "a place in a list of which only the run knows which it is")
    return k + len(base.table.columns) if isinstance(k, int) and k < 0 else k


@operation
def picked_residual(ev: Evaluator, base: ResidualObject, place: Value, node: AST) -> Value:
    """An item of a dict or a list that is a row of a table."""
    key = _key(ev, base, place, node)
    if key not in base.table.columns:
        raise ev.refusal(node, f"{ev.kind_of(base)} of which only the run knows which it is has no item {key!r}",
                         code="S203")
    return residual_item(ev, base, key, node)


@operation
def residual_method(ev: Evaluator, base: ResidualObject, name: str, args: Sequence[Value], node: AST, f: Frame
                    ) -> Value:
    """What a method of a dict or a list gives that is a row of a table: those that read one item, or copy."""
    held = {k: residual_item(ev, base, k, node) for k in base.table.columns} if name == "copy" else {}
    if held:
        return copied_residual(ev, base, held, node)
    if name == "get" and base.table.kind == "dict" and args:
        there = ev.key_of(args[0], node) in base.table.columns
        return picked_residual(ev, base, args[0], node) if there else args[1] if args[1:] else NONE
    raise ev.refusal(node, f".{name} of {ev.kind_of(base)} of which only the run knows which it is",
                     help="name its items")


@operation
def store_residual(ev: Evaluator, base: ResidualObject, key: Any, value: Value, node: AST, f: Frame) -> None:
    """`base.key = value`, or `base[key] = value`."""
    if (place := residual_place(ev, base, key, node)) is not None and not is_structural(value):
        ev.assign_to(*place, value, node, f)
        return
    key = key if isinstance(key, str) else _key(ev, base, key, node)
    column = base.table.columns.get(key)
    if column is None:
        raise ev.refusal(node, f"'{key}' is new in {ev.kind_of(base)}, of which only the run knows which it is",
                         help="set it where the object is made")
    if not alike(column, value):
        raise _differs(ev, base.table, key, value, node)


@operation
def copied_residual(ev: Evaluator, base: ResidualObject, items: Mapping[Hashable, Value], node: AST) -> Value:
    """Another object of the same make, which holds these."""
    made = ev.heap.new(Object(base.table.kind, {k: ev.atoms(v, str(k), node) for k, v in items.items()},
                              base.table.made, site=node))
    around, ev.object_sites = ev.object_sites, ev.object_sites | {id(node)}
    try:
        return as_residual(ev, made, node)
    finally:
        ev.object_sites = around


def with_columns(ev: Evaluator, body: list[AST], origin: AST) -> list[AST]:
    """The statements behind those that make the columns of tables, which get their names."""
    columns = [c for table in ev.object_tables.values() for c in table.columns.values()
               if isinstance(c, Data) and c.is_list]
    used = {n.id for s in body for n in tree.walk(s) if isinstance(n, tree.Name)}
    names = {c.name: ev.fresh(c.name[1:]) for c in columns if c.name in used}
    made = [tree.at(tree.assign(new, tree.List([], tree.Load())), origin) for new in names.values()]
    return [*made, *tree.rename(body, names)] if names else body
