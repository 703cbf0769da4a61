"""Values as expressions of the residual program, and in words.
"""
from __future__ import annotations

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.sparse.matrix_values import form_said, is_sparse
from s2sad.evaluate.specialize.values import (
    ClassValue, Data, FunctionValue, Iteration, LibraryValue, MethodValue, ObjectValue, Reference, ResidualObject,
    ScopeValue, SliceValue, OpaqueValue, TupleValue, Value,
)
from s2sad.tree import AST


# -- residual expressions --------------------------------------------------------------------------------------------
@operation
def spelled(ev: Evaluator, value: Value, origin: AST) -> AST:
    """A value as an expression of the residual program."""
    if isinstance(value, Data) and value.name in ev.texts:
        raise ev.unknown(origin, "a text must be known before the run", value)
    if isinstance(value, Data):
        return tree.copy(value.node) if value.is_atom else value.node
    says = [name for name in ("__iter__", "__len__", "__getitem__") if isinstance(value, TupleValue) and ev.class_item(
        value.made, name, origin, ev.entry)]
    if says:
        raise ev.refusal(origin, f"{kind_of(ev, value)} is used as a whole, whose class defines '{says[0]}'",
                         help="name its fields")
    if isinstance(value, TupleValue):
        return tree.at(tree.tuple_of(*(spelled(ev, v, origin) for v in value.items)), origin)
    if isinstance(value, Reference) and ev.heap[value].kind == "list":
        items = [spelled(ev, v, origin) for v in ev.heap[value].items.values()]
        return tree.at(tree.List(items, tree.Load()), origin)
    if is_sparse(value, ev.heap):
        ev.refuse_whole(value, origin)
    if isinstance(value, LibraryValue) and not value.first and not value.keywords:
        return tree.at(tree.name(ev.library(value.path)), origin)
    if isinstance(value, SliceValue):
        raise ev.unknown(origin, "a slice that is no subscript", help="write the slice where it is used: x[a:b]")
    if isinstance(value, Iteration) and value.kind == "range":
        return tree.at(tree.call(value.kind, *(spelled(ev, v, origin) for v in value.parts)), origin)
    if isinstance(value, FunctionValue):
        return tree.at(tree.name(ev.residual_function(value, origin)), origin)
    if isinstance(value, MethodValue) and value.name == "flat" and isinstance(value.base, Data):
        return spelled(ev, ev.indexed(value, origin), origin)
    if isinstance(value, ObjectValue):
        return tree.at(tree.name(ev.residual_object(value, origin)), origin)
    named, kind = subject(ev, value, origin, inner=False), kind_of(ev, value)
    named = named if named == kind else f"{named}, {kind},"
    raise ev.unknown(origin, f"{named} is used as a whole by what is computed "
                     "at run time", help="give the arrays and numbers that it holds")


@operation
def subject(ev: Evaluator, value: Value, node: AST, inner: bool = True) -> str:
    """What the user's text calls a value, 's' or 's.log', else what it is; of an attribute, an item or a call (`inner`)
    the value that it is of."""
    while inner and isinstance(node, (tree.Attribute, tree.Subscript, tree.Call)):
        node, inner = node.func if isinstance(node, tree.Call) else node.value, isinstance(node, tree.Call)
    root = node
    while isinstance(root, (tree.Attribute, tree.Subscript)):
        root = root.value
    if isinstance(root, tree.Name):
        return f"'{tree.written(node)}'"
    path = ev.heap[value].path if isinstance(value, Reference) else ""
    return f"'{path}'" if path else kind_of(ev, value)


@operation
def kind_of(ev: Evaluator, value: Value) -> str:
    """What a value is, in words."""
    if isinstance(value, Reference):
        held = ev.heap[value]
        if is_sparse(value, ev.heap):
            return form_said(held)
        words = {"list": "a list", "dict": "a dict", "set": "a set", "frame": "a frame", "class": "a class"}
        return words.get(held.kind) or f"an object of class {held.made.name if held.made else '?'}"
    if isinstance(value, ResidualObject):
        made = value.table.made
        return f"an object of class {made.name}" if made is not None else f"a {value.table.kind}"
    if isinstance(value, OpaqueValue):
        return value.what
    if isinstance(value, TupleValue) and value.made is not None:
        return f"a named tuple of class {value.made.name}"
    words = {FunctionValue: "a function", LibraryValue: "a function of a library", ClassValue: "a class",
             MethodValue: "a method", SliceValue: "a slice", TupleValue: "a tuple", ScopeValue: "a module",
             Iteration: "an iterator", ObjectValue: "an object"}
    return words.get(type(value), "a value")


@operation
def subscripted(ev: Evaluator, base: Data, place: Value, origin: AST) -> AST:
    """`base[place]` of the residual program."""
    return tree.at(tree.Subscript(spelled(ev, base, origin), _subscript(ev, place, origin), tree.Load()), origin)


def _subscript(ev: Evaluator, place: Value, origin: AST) -> AST:
    if isinstance(place, SliceValue):
        ends = [None if isinstance(p, Data) and p.is_known and p.known is None else spelled(ev, p, origin)
                for p in place.parts]
        return tree.at(tree.Slice(*ends), origin)
    if isinstance(place, TupleValue):
        return tree.at(tree.tuple_of(*(_subscript(ev, p, origin) for p in place.items)), origin)
    return spelled(ev, place, origin)
