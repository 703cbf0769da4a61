"""The entry's results: its returns, and what structure they give."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.entry_arguments import store_cells
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import Data, Reference, TupleValue, Value
from s2sad.infer.types import UNKNOWN
from s2sad.infer.types import NONE as NONE_TYPE
from s2sad.pytree import PyTree
from s2sad.tree import AST


_DEEPEST = 64       # structures within structures

@operation
def return_from_entry(ev: Evaluator, s: AST, value: Value, f: Frame) -> None:
    """A return of the residual program."""
    value = value if isinstance(value, Data) else ev.atoms(value, "result", s)
    leaves = list(_leaves(ev, value, s))
    if any(v.is_list for v in leaves):
        raise ev.refusal(s, "a list is returned whose length is not known before the run",
                         help="make it an array with np.array")
    nodes = [ev.spelled(v, s) for v in leaves]
    store_cells(ev, s)
    if isinstance(value, Data) and value.is_known and value.known is None:
        node = None
    elif isinstance(value, Data):
        node = nodes[0]
    else:
        node = nodes[0] if len(nodes) == 1 else tree.tuple_of(*nodes)
    ev.emit(tree.Return(node), s)
    ev.returned.append((s, value, ev.heap.fork()))


def _leaves(ev: Evaluator, value: Value, node: AST, depth: int = 0) -> Iterator[Data]:
    """The arrays and numbers of what is returned."""
    if depth > _DEEPEST:
        raise ev.refusal(node, f"a structure that holds itself, or is nested more than {_DEEPEST} deep, is returned")
    if isinstance(value, Data):
        if not (value.is_known and value.known is None):
            yield value
    elif isinstance(value, TupleValue):
        for v in value.items:
            yield from _leaves(ev, v, node, depth + 1)
    elif isinstance(value, Reference) and ev.heap[value].kind in ("list", "dict", "record"):
        for v in ev.heap[value].items.values():
            yield from _leaves(ev, v, node, depth + 1)
    else:
        sparse = "return its entries, and build it of them outside"
        raise ev.refusal(node, f"{ev.kind_of(value)} is returned",
                         help=sparse if is_sparse(value, ev.heap) else "return arrays and numbers")


def result_structure_of(ev: Evaluator) -> PyTree | None:
    """What structure is returned: the same at each return; None for arrays, numbers and tuples of several."""
    forms = [_form(ev, objects, value) for _, value, objects in ev.returned]
    if any(f != forms[0] for f in forms[1:]):
        raise ev.refusal(ev.returned[-1][0], "returns that are structures of different makes",
                         help="return the same structure on every path")
    found = forms[0] if forms else None
    plain = isinstance(found, PyTree) and found.kind == "tuple" and len(found.items) != 1 and all(
        i is UNKNOWN for i in found.items)
    return found if isinstance(found, PyTree) and not plain else None


def _form(ev: Evaluator, objects: Mapping[int, Object], value: Value) -> Any:
    """What is returned, of what its items are."""
    if isinstance(value, Data):
        return NONE_TYPE if value.is_known and value.known is None else UNKNOWN
    if isinstance(value, TupleValue):
        items = tuple(_form(ev, objects, v) for v in value.items)
        made = value.made.live if value.made is not None else None
        fields = ev.layout_of(value.made).names if value.made is not None else tuple(range(len(items)))
        return PyTree("named" if value.made is not None else "tuple", fields, items, made, True)
    assert isinstance(value, Reference)
    held = objects[value.number]
    items = tuple(_form(ev, objects, v) for v in held.items.values())
    return PyTree(held.kind, tuple(held.items), items,  # pyright: ignore[reportArgumentType]
                  held.made.live if held.made is not None else None)

