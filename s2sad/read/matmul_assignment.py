"""matmul_assignment: a product of matrices in place is a store of the product.

    t @= r                              t[...] = t @ r
    a[:, :3] @= s                       a[:, :3] = a[:, :3] @ s
    p.t @= r                            p.t[...] = p.t @ r
    for k in range(n):                  for k in range(n):
        us[k] @= r                          us[k][...] = us[k] @ r
    us[i] @= r                          stays, for the fence to refuse: i may be an array, which picks a copy

NumPy writes the product into the array that is there, whatever names it has, and whether it lies in an array or a list.
"""
from __future__ import annotations

from collections import Counter

from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Constant, FloorDiv, For, FunctionDef, Load, MatMult, Mod, Mult,
    Name, Slice, Store, Sub, Subscript, Tuple, USub, UnaryOp, at, const, copy, index, indices, rebuild, walk,
    walk_statements, written,
)


def matmul_assignment(function: FunctionDef) -> FunctionDef:
    """The function without such products."""
    if not any(isinstance(n, AugAssign) and isinstance(n.op, MatMult) for n in walk_statements(function.body)):
        return function
    whole = _whole(function)
    return rebuild(function, lambda n: _stored(n, whole) if isinstance(n, AugAssign) else None)


def _stored(node: AugAssign, whole: set[str]) -> AST | None:
    """The statement as a store, if that is the same."""
    if not isinstance(node.op, MatMult) or any(isinstance(n, Call) for n in walk(node.target)):
        return None
    target = copy(node.target)
    target.ctx = Load()
    product = at(BinOp(target, MatMult(), node.value), node)
    if isinstance(node.target, (Name, Attribute)) or isinstance(node.target, Subscript) and all(
            _is_whole(i, whole) for i in indices(node.target)):
        place = index(copy(target), const(...))
        place.ctx = Store()
        return at(Assign([place], product, None), node)
    if isinstance(node.target, Subscript) and any(isinstance(i, Slice) for i in indices(node.target)):
        return at(Assign([node.target], product, None), node)
    return None


def _whole(function: FunctionDef) -> set[str]:
    """The names that stand for integers alone: they count loops, or are bound to written numbers and count on."""
    others = {n.id for n in walk(function) if isinstance(n, Name) and not isinstance(n.ctx, (Load, Store))}
    stores = Counter(n.id for n in walk(function) if isinstance(n, Name) and isinstance(n.ctx, Store))
    found: Counter[str] = Counter()
    for s in walk(function):
        target = s.targets[0] if isinstance(s, Assign) and len(s.targets) == 1 else getattr(s, "target", None)
        if isinstance(s, For):
            called = written(s.iter.func) if isinstance(s.iter, Call) else ""
            counts = called == "range" or called == "enumerate" and isinstance(target, Tuple)
            target = target.elts[0] if isinstance(target, Tuple) else target
        else:
            counts = isinstance(s, Assign) and _is_number(s.value) or isinstance(s, AugAssign) and isinstance(
                s.op, (Add, Sub)) and _is_number(s.value)
        found[target.id if counts and isinstance(target, Name) else ""] += 1
    shadowed = {"range", "enumerate"} & (others | set(stores))
    return set() if shadowed else {n for n, count in found.items() if count == stores[n] and n not in others}


def _is_whole(node: AST, whole: set[str]) -> bool:
    if isinstance(node, BinOp):
        return isinstance(node.op, (Add, Sub, Mult, Mod, FloorDiv)) and _is_whole(node.left, whole) and _is_whole(
            node.right, whole)
    if isinstance(node, UnaryOp):
        return isinstance(node.op, USub) and _is_whole(node.operand, whole)
    return _is_number(node) or isinstance(node, Name) and node.id in whole


def _is_number(node: AST) -> bool:
    return isinstance(node, Constant) and type(node.value) is int
