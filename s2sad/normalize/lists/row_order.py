"""row_order: whether a list holds rows in the order of an array, from a row on that is not counted from the end.

    rows[count] = a[k + 1]              position 0, 1, 2, ... of the list, row 1, 2, 3, ... of the array
    count += 1

Requires structured form; changes nothing.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Compare, Constant, FloorDiv, For, FunctionDef, Mult, Name, Store,
    Sub, Subscript, call_name, const, dump, walk,
)


def moved(place: AST, loop: AST) -> int | None:
    """How far a subscript is from a loop's counter."""
    if not isinstance(loop, For) or not isinstance(loop.target, Name):
        return None
    if isinstance(place, Name) and place.id == loop.target.id:
        return 0
    if isinstance(place, BinOp) and isinstance(place.op, (Add, Sub)) and isinstance(place.left, Name) and (
            place.left.id == loop.target.id and isinstance(place.right, Constant)
            and type(place.right.value) is int):
        return place.right.value if isinstance(place.op, Add) else -place.right.value
    return None


def in_order(store: Assign, loop: For, function: FunctionDef) -> bool:
    """Whether a store in a loop over a range of two bounds or one goes to the places 0, 1, 2, ... of a list."""
    place = store.targets[0].slice
    if isinstance(place, BinOp) and isinstance(place.right, BinOp) and isinstance(place.right.right, Compare):
        place = place.left                              # what is added where it is negative
    start = loop.iter.args[0] if len(loop.iter.args) == 2 else const(0)
    shift = moved(place, loop)
    if shift is not None:
        return isinstance(start, Constant) and start.value + shift == 0
    if isinstance(place, BinOp):
        return isinstance(place.op, Sub) and moved(place.left, loop) == 0 and dump(place.right) == dump(start)
    return isinstance(place, Name) and _counts(place.id, store, loop, function)


def _counts(identifier: str, store: Assign, loop: For, function: FunctionDef) -> bool:
    """Whether a name is 0 before a loop and one more after a store in it, which is there in every turn."""
    bound = [s for s in walk(function.body) if isinstance(s, (Assign, AugAssign, For)) and any(
        isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store)
        for n in walk(s.target if isinstance(s, (AugAssign, For)) else s.targets[0]))]
    if len(bound) != 2 or not isinstance(bound[0], Assign) or not isinstance(bound[1], AugAssign):
        return False
    added = bound[1]
    own = any(s is added for s in loop.body) and any(s is store for s in loop.body)
    return own and isinstance(added.op, Add) and getattr(added.value, "value", None) == 1 and getattr(
        bound[0].value, "value", None) == 0 and _after(store, added, loop.body)


def _after(first: AST, second: AST, block: list[AST]) -> bool:
    places = [k for k, s in enumerate(block) if s is first or s is second]
    return block[places[0]] is first


def least(node: AST, function: FunctionDef, depth: int = 0) -> int | None:
    """What a whole number is at least, as far as the text shows it."""
    if isinstance(node, Constant):
        return node.value if type(node.value) is int else None
    if call_name(node) == "builtins.len" or isinstance(node, Subscript) and isinstance(
            node.value, Attribute) and node.value.attr == "shape":
        return 0
    if isinstance(node, Name) and depth < 8:
        bound = [s for s in walk(function.body) if isinstance(s, (Assign, AugAssign, For)) and any(
            isinstance(n, Name) and n.id == node.id and isinstance(n.ctx, Store)
            for n in walk(s.target if isinstance(s, (AugAssign, For)) else s.targets[0]))]
        if len(bound) != 1 or node.id in {p.id for p in function.args.args}:
            return None
        return least(bound[0].value, function, depth + 1) if isinstance(bound[0], Assign) and isinstance(
            bound[0].targets[0], Name) else None
    if not isinstance(node, BinOp):
        return None
    left, right = least(node.left, function, depth), least(node.right, function, depth)
    if left is None or right is None:
        return None
    if isinstance(node.op, Add):
        return left + right
    if isinstance(node.op, Sub):
        return left - right if isinstance(node.right, Constant) else None
    positive = left >= 0 and (right >= 0 if isinstance(node.op, Mult) else right > 0)
    return 0 if positive and isinstance(node.op, (Mult, FloorDiv)) else None
