"""Arrays that are given another shape: the name of the array is bound to a view of that shape.

    a.shape = n, n                   ->      a = a.reshape((n, n))

Python changes the array itself, for all that hold it: an array is taken that was made in the same block, and that no
other name of the residual program can be.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.known_shapes import lengths
from s2sad.evaluate.specialize.values import Data, TupleValue, Value
from s2sad.read.shape_assignment import MAKING
from s2sad.tree import AST


@operation
def reshape_in_place(ev: Evaluator, base: Data, shape: Value, origin: AST) -> bool:
    """`base.shape = shape`; False where another name may be this array."""
    if not base.name or not _is_only_name(ev.block, base.name):
        return False
    spelled = ev.spelled(shape, origin)
    ev.emit(tree.assign(base.name, tree.Call(tree.attribute(tree.name(base.name), "reshape"), [spelled], [])), origin,
            True)
    known = lengths(shape)
    if known is not None and any(n is not None and n < 0 for n in known):
        known = None
    for number, held in list(ev.heap.objects.items()):
        ev.heap.objects[number] = _with_shape(held, base.name, known)
    return True


def _is_only_name(block: list[AST], name: str) -> bool:
    """Whether a name is bound to a new array in a block, and nothing is bound to the name."""
    bindings: list[Any] = [s for s in block if isinstance(s, tree.Assign) and _binds(s, name)]
    if not bindings or not all(_is_new(s.value, name) for s in bindings):
        return False
    everywhere = [n for s in block for n in tree.walk(s)]
    bound = sum(isinstance(n, tree.Name) and n.id == name and not isinstance(n.ctx, tree.Load) for n in everywhere)
    augmented = sum(isinstance(n, tree.AugAssign) and isinstance(n.target, tree.Name) and n.target.id == name
                    for n in everywhere)
    holds = any(isinstance(n, (tree.Assign, tree.Expr)) and any(_is_name(v, name) for v in _held(n.value))
                for n in everywhere)
    return bound == len(bindings) + augmented and not holds


def _held(value: Any) -> list[Any]:
    """What may be bound as it is by an assignment of a value."""
    if isinstance(value, (tree.Tuple, tree.List)):
        return [v for n in value.elts for v in _held(n)]
    if isinstance(value, tree.IfExp):
        return [*_held(value.body), *_held(value.orelse)]
    if isinstance(value, tree.BoolOp):
        return list(value.values)
    if isinstance(value, tree.Call):
        return [] if _makes(value) or _is_method(value, "reshape", "copy") else [
            *value.args, *(k.value for k in value.keywords),
            *([value.func.value] if isinstance(value.func, tree.Attribute) else [])]
    return [value]


def _is_name(node: Any, name: str) -> bool:
    return isinstance(node, tree.Name) and node.id == name


def _binds(s: Any, name: str) -> bool:
    return len(s.targets) == 1 and _is_name(s.targets[0], name)


def _is_new(value: Any, name: str) -> bool:
    """Whether an expression makes an array, or gives this one another shape."""
    if isinstance(value, (tree.BinOp, tree.UnaryOp)):
        return True
    again = _is_method(value, "reshape") and _is_name(value.func.value, name)
    return again or _is_method(value, "copy") or _makes(value)


def _makes(value: Any) -> bool:
    """Whether a call of a function of NumPy's makes an array that nothing else holds."""
    room, _, function = (tree.call_name(value) or "").rpartition(".")
    return room == "numpy" and len(value.args) <= MAKING.get(function, -1) and not any(
        k.arg in ("out", "copy", None) for k in value.keywords)


def _is_method(value: Any, *names: str) -> bool:
    return isinstance(value, tree.Call) and isinstance(value.func, tree.Attribute) and value.func.attr in names


def _with_shape(held: Object, name: str, shape: tuple[int | None, ...] | None) -> Object:
    """An object in whose slots the array has another shape."""
    def changed(value: Value) -> Value:
        if isinstance(value, TupleValue):
            return replace(value, items=tuple(map(changed, value.items)))
        return replace(value, shape=shape, origins=frozenset()) if isinstance(
            value, Data) and value.name == name else value
    items = {k: changed(v) for k, v in held.items.items()}
    return held if all(items[k] is v for k, v in held.items.items()) else replace(held, items=items)
