"""unit_axes: the axes of an expression that have length 1 by its form, which `np.squeeze` leaves out."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import axes_of, is_true, items_of, whole_number
from s2sad.infer.signatures.options import is_none, one_axis
from s2sad.infer.types import Type
from s2sad.rules import find_array
from s2sad.tree import AST, Call, call_name


def unit_axes(node: AST, of: Callable[[AST], Type], argument: Callable[[AST], Type]) -> tuple[int, ...]:
    """The axes of an array that are known to have length 1, in order; `of` and `argument` are those of `Typing`."""
    rule = find_array(call_name(node))
    if not isinstance(node, Call) or rule is None:
        return argument(node).ones
    rank, known = of(node).rank, (*rule.operands, *rule.options)
    placed = len(rule.operands) <= len(node.args) <= len(known) and all(k.arg in known for k in node.keywords)
    if not placed or not rank or not of(node.args[0]).is_array:
        return ()
    given = rule.arguments(node)
    if "axis" in given and is_true(given.get("keepdims")):
        return tuple(range(rank)) if is_none(given["axis"]) else axes_of(given["axis"], rank) or ()
    if rule.name == "numpy.reshape":
        return tuple(k for k, size in enumerate(items_of(given["shape"])) if whole_number(size) == 1)
    if rule.name == "numpy.expand_dims":
        axis = one_axis(given["axis"], rank)
        return () if axis is None else (axis,)
    if rule.name == "numpy.atleast_2d" and of(node.args[0]).rank == 1:
        return (0,)
    if rule.name == "numpy.matmul" and rank == 2:
        left, right = (unit_axes(operand, of, argument) for operand in node.args)
        return (*((0,) if 0 in left else ()), *((1,) if 1 in right else ()))
    return ()
