"""multiplied: a product of matrices in place is a store of the product.

    t @= r                              t[...] = t @ r
    a[:, :3] @= s                       a[:, :3] = a[:, :3] @ s
    p.t @= r                            p.t[...] = p.t @ r
    us[k] @= r                          stays, for the fence to refuse: an item of a list is another matter

NumPy writes the product into the array that is there, whatever names it has.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, Constant, Load, MatMult, Name, Slice, Store, Subscript, UnaryOp, at,
    const, copy, index, indices, walk,
)


def multiplied(node: AugAssign) -> AST:
    """The statement as a store, if that is the same."""
    if not isinstance(node.op, MatMult) or any(isinstance(n, Call) for n in walk(node.target)):
        return node
    target = copy(node.target)
    target.ctx = Load()
    product = at(BinOp(target, MatMult(), node.value), node)
    if isinstance(node.target, (Name, Attribute)) or _is_written(node.target):
        place = index(copy(target), const(...))
        place.ctx = Store()
        return at(Assign([place], product, None), node)
    if isinstance(node.target, Subscript) and any(isinstance(i, Slice) for i in indices(node.target)):
        return at(Assign([node.target], product, None), node)
    return node


def _is_written(node: AST) -> bool:
    """Whether a subscript is a written number, of an array or of a list."""
    place = node.slice if isinstance(node, Subscript) else None
    return isinstance(place.operand if isinstance(place, UnaryOp) else place, Constant)
