"""What follows from the form of subscripts alone."""
from __future__ import annotations

from s2sad.infer.signatures.laws import whole_number
from s2sad.tree import AST, Add, BinOp, Constant, Slice, equal


def keeps_axis(subscript: AST) -> bool:
    """Whether a subscript leaves an axis, or adds one: slices, `...` and `None`."""
    return isinstance(subscript, Slice) or isinstance(subscript, Constant) and subscript.value in (None, Ellipsis)


def is_single(subscript: AST) -> bool:
    """Whether a slice or a new axis has length 1 by its form: `None`, `:1`, `-1:`, `2:3`, `i:i + 1`."""
    if not isinstance(subscript, Slice):
        return isinstance(subscript, Constant) and subscript.value is None
    if subscript.step is not None:
        return False
    low = 0 if subscript.lower is None else whole_number(subscript.lower)
    high = None if subscript.upper is None else whole_number(subscript.upper)
    if low is not None:
        return low == -1 and subscript.upper is None or high == low + 1 and low != -1
    lower, upper = subscript.lower, subscript.upper
    if lower is None or not isinstance(upper, BinOp) or not isinstance(upper.op, Add):
        return False
    return whole_number(upper.right) == 1 and equal(upper.left, lower)
