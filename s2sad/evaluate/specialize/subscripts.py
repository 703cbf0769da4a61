"""Items, slices, attributes as expressions.
"""
from __future__ import annotations

from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.sequences.known_shapes import of_part, origins
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    NONE, Data, LibraryValue, MethodValue, Reference, ResidualObject, SliceValue, TupleValue, Value, constant,
)
from s2sad.tree import AST


GRIDS = tuple(f"numpy.{n}" for n in ("mgrid", "ogrid", "r_", "c_"))


# -- items -----------------------------------------------------------------------------------------------------------
@expression("Slice")
def slice_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    nodes = [p for p in (node.lower, node.upper, node.step) if p is not None]
    values = iter(ev.values(nodes, f))
    return SliceValue(tuple(NONE if p is None else next(values) for p in (node.lower, node.upper, node.step)))


@expression("Subscript")
def subscript(ev: Evaluator, node: Any, f: Frame) -> Value:
    if isinstance(node.value, tree.Subscript):
        ev.spread.add(node.value)
    base, place = sequence_and_place(ev, node, f)
    for value, written in _places(place, node.slice) if isinstance(base, Data) else ():
        if isinstance(value, Data) and value.is_known and value.known is None and _was_looked_for(ev, written, f):
            raise ev.none_here(value, written)      # x[None] has an axis more: what was looked for was not found
    return item_of(ev, base, place, node, f)


def sequence_and_place(ev: Evaluator, node: Any, f: Frame) -> tuple[Value, Value]:
    """What a subscript is in, and the place; of several places each is one thing."""
    base, place = ev.values([node.value, node.slice], f)
    for value, written in _places(place, node.slice):
        ev.one(value, written)
    return base, place


def _places(place: Value, written: Any) -> list[tuple[Value, AST]]:
    """The places of a subscript as they are written, one for each axis."""
    if not isinstance(place, TupleValue) or not isinstance(written, tree.Tuple):
        return [(place, written)]
    return list(zip(place.items, written.elts)) if len(place.items) == len(written.elts) else []


def _was_looked_for(ev: Evaluator, place: AST, f: Frame) -> bool:
    """Whether a place is a name or an attribute that holds None on some ways only."""
    if isinstance(place, tree.Attribute):
        return any(slot == place.attr for _, slot in ev.found_none)
    return isinstance(place, tree.Name) and (f.reference.number, place.id) in ev.found_none


@operation
def item_of(ev: Evaluator, base: Value, place: Value, node: AST, f: Frame) -> Value:
    """`base[place]`."""
    base = indexed(ev, base, node)
    if isinstance(base, Data):
        if base.is_known and base.known is None:
            raise ev.none_here(base, node)
        if isinstance(base.known, str):
            return constant(base.known[known_place(ev, place, node)])
        found = ev.subscripted(base, place, node)
        if isinstance(base.known, tuple):
            return Data(found, base.known[known_place(ev, place, node)])
        is_part = isinstance(place, SliceValue)
        picks = isinstance(place, Reference) and ev.is_spelled_out(place) and not ev.is_spelled_out(base)
        picked = Data(found, shape=(len(ev.sequence_items(place)),)) if picks else place
        item = Data(found, demands=base.demands, shape=of_part(base, picked), origins=origins(base, place),
                    is_list=base.is_list and is_part, rows=base.rows if is_part else None)
        return item if is_part else ev.listed_record(base, item, node)
    if is_sparse(base, ev.heap):
        ev.refuse_element(base, node)
    if isinstance(base, ResidualObject) and base.table.kind != "record":
        return ev.picked_residual(base, place, node)
    if isinstance(base, ResidualObject):
        return ev.call(ev.attribute_of(base, "__getitem__", node, f), [place], {}, node, f)
    if isinstance(base, Reference) and ev.heap[base].kind == "record":
        if ev.heap[base].made is None:      # it is spelled in a text, and goes by fields and by keys
            return ev.attribute_of(base, ev.known(place, node, "a key"), node, f)
        return ev.call(ev.attribute_of(base, "__getitem__", node, f), [place], {}, node, f)
    if isinstance(base, LibraryValue) and base.path in ("numpy.s_", "numpy.index_exp"):
        return place if base.path == "numpy.s_" or isinstance(place, TupleValue) else TupleValue((place,))
    own = ev.special_method(base, "__getitem__", node, f)
    if own is not None:
        return ev.call(own, [place], {}, node, f)
    return ev.picked(base, place, node, f)


@operation
def indexed(ev: Evaluator, base: Value, node: AST) -> Value:
    """What is indexed: `x.flat` and `np.mgrid` by expressions of their own."""
    if isinstance(base, MethodValue) and base.name == "flat" and isinstance(base.base, Data):
        return Data(tree.at(tree.attribute(ev.spelled(base.base, node), "flat"), node))
    if ev.is_attribute_dictionary(base):
        return ev.attributes_now(base, node)
    if isinstance(base, LibraryValue) and base.path in GRIDS:
        return Data(ev.spelled(base, node))
    return base


@operation
def known_place(ev: Evaluator, place: Value, node: AST) -> Any:
    """A place in a text, or in a tuple that is known."""
    if isinstance(place, SliceValue):
        return slice(*(ev.known(p, node, "an end of a slice") for p in place.parts))
    return ev.known(place, node, "a place in a text or a tuple")


@operation
def item_key(ev: Evaluator, base: Reference, place: Value, node: AST) -> Any:
    """The key of an item of a list or a dict that is there."""
    held = ev.heap[base]
    if held.kind == "dict":
        return ev.key_of(place, node)
    if not isinstance(place, Data) or not place.is_known:
        raise ev.unknown(node, f"which item of '{held.label or 'a list'}' is assigned must be known before the run",
                         place, site=held.site)
    k = place.known + len(held.items) if place.known < 0 else place.known
    if not 0 <= k < len(held.items):
        raise ev.no_item(f"{ev.subject(base, node)} has {len(held.items)} items, and no item {place.known}", node)
    return k


# -- attributes ------------------------------------------------------------------------------------------------------
@expression("Attribute")
def attribute(ev: Evaluator, node: Any, f: Frame) -> Value:
    return ev.attribute_of(ev.value(node.value, f), attribute_name(node.attr, f), node, f)


def attribute_name(name: str, f: Frame) -> str:
    """What an attribute is called: in the text of a class names that begin with two underscores are its own."""
    frame: Frame | None = f
    while frame is not None and frame.owner is None:
        frame = frame.outer
    is_private = name.startswith("__") and not name.endswith("__")
    return f"_{frame.owner.name.lstrip('_')}{name}" if is_private and frame is not None and frame.owner else name
