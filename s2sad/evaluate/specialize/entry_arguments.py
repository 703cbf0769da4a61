"""The entry's arguments: what they are when the evaluation begins, and what has become of them when it ends."""
from __future__ import annotations

import re
from collections.abc import Hashable, Sequence
from enum import Enum
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.classes.class_lookup import class_value
from s2sad.evaluate.specialize.evaluation_state import Cell
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sparse.matrix_values import given_matrix
from s2sad.evaluate.specialize.values import (
    NONE, ClassValue, Conflict, Data, Reference, TupleValue, Value, alike, constant,
)
from s2sad.evaluate.specialize.values import UNKNOWN as NOT_KNOWN
from s2sad.infer.types import UNKNOWN
from s2sad.pytree import SPARSE, Form, PyTree, is_held, step
from s2sad.read.linker import header_of
from s2sad.tree import AST


_SPARSE = re.compile(r"an? (bsr|coo|csc|csr|dia|dok|lil)_(matrix|array)")       # what is said of a sparse matrix



def argument_value(ev: Evaluator, form: Form, path: str, wanted: str, origin: AST, names: dict[str, str]) -> Value:
    """What an argument is: names for its leaves."""
    if isinstance(form, PyTree):
        items: dict[Hashable, Value] = {
            ev.member(key) if isinstance(key, Enum) else key: argument_value(
                ev, item, step(form, path, key), f"{wanted}_{key}", origin, names)
            for key, item in zip(form.keys, form.items)}
        if form.kind in SPARSE:
            return given_matrix(ev, form, tuple(items.values()), path, wanted, origin)
        if form.kind in ("tuple", "named"):
            made = _class(ev, form.made, origin) if form.kind == "named" and form.made is not None else None
            return TupleValue(tuple(items.values()), made)
        kind = form.kind if form.kind in ("list", "dict") else "record"
        if kind == "list" and path in ev.sites:
            ev.grown.add(path)
            return _residual_list(ev, tuple(items.values()), wanted, origin)
        made = _class(ev, form.made, origin) if kind == "record" and form.made is not None else None
        reference = ev.heap.new(Object(kind, items, made, label=wanted, path=path,
                                       site=path if kind == "list" else None))
        ev.given[reference.number] = ev.heap[reference]
        parameters = {p: n for n, p in names.items()}
        ev.cells += [Cell(reference.number, key, parameters[inner]) for k, key in zip(form.keys, items)
                     if (inner := step(form, path, k)) in ev.cell_paths]
        return reference
    if form.kind == "none":
        return NONE
    if form.kind == "text":
        name = ev.fresh(wanted)
        names[name] = path
        known = ev.facts.get((path, "value"))
        if known is not None:
            return constant(known)
        ev.texts.add(name)
        return Data(tree.at(tree.name(name), origin), demands=frozenset(((path, "value"),)))
    if not is_held(form):
        fact = (path, "value")
        if fact in ev.facts:        # a function, a class, a member of an enumeration
            return ev.outside_value(wanted, ev.facts[fact], origin, ev.entry)
        help = "give it in another format: A.tocsr()" if _SPARSE.fullmatch(form.dtype) else ""
        return Conflict(f"'{path}' is {form.dtype or form.kind}, of which a kernel can make no use", frozenset((fact,)),
                        help)
    name = ev.fresh(wanted)
    names[name] = path
    if path != name:
        ev.leaves.add(name)
    fact = (path, "value")
    if path in ev.cell_paths:
        own = ev.fresh(re.findall(r"\w+", path)[-1] if "." in path else f"{wanted}_now")
        ev.emit(tree.assign(own, tree.Subscript(tree.name(name), tree.const(0), tree.Load())), header_of(origin))
        name = own
    if form == UNKNOWN:         # an array or a number
        return Data(tree.at(tree.name(name), origin), demands=frozenset((fact,)), origins=frozenset((path,)))
    node = tree.at(tree.name(name), origin)
    if form.is_number and form.dtype in ("int64", "bool"):
        known = ev.facts.get(fact, NOT_KNOWN)
        return Data(node, known, frozenset() if fact in ev.facts else frozenset((fact,)), shape=(), dtype=form.dtype)
    if not form.is_array:
        return Data(node, shape=(), dtype=form.dtype)
    return Data(node, origins=frozenset((path,)), shape=ev.facts.get((path, "shape"), (None,) * form.rank),
                dtype=form.dtype)


def _class(ev: Evaluator, made: Any, origin: AST) -> ClassValue:
    """The class of an argument, live or of a file."""
    return class_value(made) if isinstance(made, type) else ev.file_class(made, origin, ev.entry)


def _residual_list(ev: Evaluator, items: Sequence[Value], wanted: str, origin: AST) -> Value:
    """A list that is given and grows in the residual program, which has one of its own."""
    made = tree.List([ev.spelled(i, origin) for i in items], tree.Load())
    return ev.named(Data(tree.at(made, origin), is_list=True), wanted, origin)


def store_cells(ev: Evaluator, origin: AST) -> None:
    """What the numbers of arguments' objects are in the end goes to where the caller finds it."""
    for cell in ev.cells:
        place = tree.Subscript(tree.name(cell.parameter), tree.const(0), tree.Load())
        value = ev.heap.objects[cell.holder].items[cell.key]
        ev.emit(tree.assign(place, ev.spelled(value, origin)), origin, True)


def assigned_numbers(ev: Evaluator) -> frozenset[str]:
    """The paths of numbers in arguments' objects that are other numbers in the end, and no cells yet."""
    found: set[str] = set()
    ends = (ev.heap.objects, *(objects for _, _, objects in ev.returned))
    for number, before in ev.given.items():
        for key, old in before.items.items():
            path = ev.paths.get(old.name, "") if isinstance(old, Data) and old.shape == () else ""
            now = [objects[number].items.get(key) for objects in ends]
            if path and not all(alike(old, n) for n in now) and all(
                    isinstance(n, Data) and isinstance(n.known if n.is_known else 0, (bool, int, float, complex))
                    for n in now):
                found.add(path)
    return frozenset(found)


def changes_of(ev: Evaluator) -> tuple[frozenset[str], frozenset[str]]:
    """The arguments' objects that have other content in the end, and the parameters that are no longer in it."""
    changed: set[str] = {*ev.grown}
    replaced: set[str] = set()
    for objects in (ev.heap.objects, *(objects for _, _, objects in ev.returned)):
        for number, before in ev.given.items():
            after = objects[number].items
            keys = {k for k in {*before.items, *after} if not alike(before.items.get(k), after.get(k))}
            keys -= {c.key for c in ev.cells if c.holder == number}
            changed |= {before.path} if keys or list(before.items) != list(after) else set()
            replaced |= {n for k in keys if k in before.items for n in _names(ev, before.items[k])}
    return frozenset(changed), frozenset(replaced)


def mutated(ev: Evaluator) -> frozenset[str]:
    """The arguments' objects that have held something else at any time."""
    return frozenset(before.path for number, before in ev.given.items() if number in ev.heap.mutated)


def changed_outside(ev: Evaluator) -> frozenset[str]:
    """What the objects from outside are called that hold something else in the end: those that a bound object has."""
    found: set[str] = set()
    for objects in (ev.heap.objects, *(objects for _, _, objects in ev.returned)):
        for number, before in ev.outset.items():
            after = objects.get(number, before)
            if not all(alike(v, after.items.get(k)) for k, v in before.items.items()) or {*after.items} != {
                    *before.items}:
                found.add(before.label)
    return frozenset(found)


def _names(ev: Evaluator, value: Value) -> list[str]:
    """The parameters of which a value was made when it was given."""
    if isinstance(value, Data):
        return [value.name] if value.name else []
    inner = value.items if isinstance(value, TupleValue) else tuple(
        ev.given[value.number].items.values()) if isinstance(value, Reference) and value.number in ev.given else ()
    return [n for v in inner for n in _names(ev, v)]
