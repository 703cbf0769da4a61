"""Lists that go into a list of the residual program, which holds copies of them.

    p = [v, x[0]]               h.append([p_0, p_1])    as good, since nothing writes an item of p or of h
    h.append(p)
"""
from __future__ import annotations

from s2sad import tree
from s2sad.evaluate.effects import bindings
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import Data, Reference, Value, parts
from s2sad.tree import AST, names, stored_names, walk

_READING = {"sum", "len", "float", "max", "min", "abs", "zip", "enumerate", "reversed", "list", "tuple"}


@operation
def spelled_item(ev: Evaluator, value: Value, origin: AST, f: Frame | None = None) -> AST:
    """A value as an item of a list of the residual program. A list that something else holds is refused where one may
    be written after that."""
    for one in (value, *parts(value)):
        if isinstance(one, Reference) and ev.heap[one].kind == "list" and (held := ev.heap.holders(one)) and not (
                f is not None and held == 1 and one is value and _is_only_read(ev, one, origin, f)):
            error = ev.refusal(origin, "a list that has a name is put into one of which only the run knows how long it "
                               "becomes, and one of them may be written", help="put a copy there: list(w)")
            raise ev.rows_wanted({ev.heap[one].site}, error)
    return ev.spelled(value, origin)


def _is_only_read(ev: Evaluator, row: Reference, call: AST, f: Frame) -> bool:
    """Whether the function that appends a list of its own reads items of it and of the list that it goes into, and
    does nothing else with them."""
    function = f.captured.tree
    if not isinstance(call, tree.Call) or not isinstance(call.args[0], tree.Name) or not all(
            isinstance(v, Data) for v in ev.heap[row].items.values()):
        return False
    item, outer = call.args[0].id, {*names(call.func)}
    if f.local is None or item not in f.local or item in f.nonlocals or not any(n is call for n in walk(function.body)):
        return False
    found = {item, *outer}
    while more := {n for t, v in bindings(function) if found & {*names(v)} for n in stored_names(t)} - found:
        found |= more
    picked = {id(n.value) for n in walk(function.body) if isinstance(n, tree.Subscript)} | {id(call.args[0])}
    for node in walk(function.body):
        if isinstance(node, tree.Name) and node.id == item and isinstance(node.ctx, tree.Load):
            bad = id(node) not in picked
        elif isinstance(node, tree.Subscript):
            bad = isinstance(node.ctx, tree.Store) and bool(found & {*names(node.value)})
        elif isinstance(node, tree.Call):
            given = {n for a in (*node.args, *(k.value for k in node.keywords)) for n in names(a)}
            bad = node is not call and not _reads(node) and bool((found - {item}) & given)
        else:
            bad = isinstance(node, tree.AugAssign) and bool(found & {*names(node.target)}) or isinstance(
                node, tree.FunctionDef) or type(node).__name__ == "Lambda"
        if bad:
            return False
    return True


def _reads(node: AST) -> bool:
    """Whether a call is one of a function that changes no list."""
    function = node.func  # pyright: ignore[reportAttributeAccessIssue]
    if isinstance(function, tree.Name):
        return function.id in _READING
    return isinstance(function, tree.Attribute) and isinstance(function.value, tree.Name) and function.value.id in (
        "np", "numpy", "math")
