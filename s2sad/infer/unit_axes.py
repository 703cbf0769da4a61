"""unit_axes: the axes of an expression known to have length 1, which NumPy repeats and `np.squeeze` leaves out.

    np.zeros((n, 1)), u[:, None], u.reshape(-1, 1), 2.0 * column, np.sum(u, axis=1, keepdims=True)

An axis is known where every operand that has it says so, and a name where every binding does.
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import LAWS, ONE, Shape, axes_of, is_true, items_of, whole_number
from s2sad.infer.signatures.options import is_none, one_axis
from s2sad.infer.subscript_forms import is_single, keeps_axis
from s2sad.rules import ArrayRule, find_array
from s2sad.rules import find as find_elementwise
from s2sad.tree import (
    AST, BinOp, Call, Compare, Constant, MatMult, Name, Slice, Subscript, UnaryOp, call_name, indices, user_call,
)

if TYPE_CHECKING:
    from s2sad.infer.inference import Typing

_SHAPED = ("numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full")
_ALIKE = ("numpy.empty_like", "numpy.zeros_like", "numpy.ones_like", "numpy.full_like", "numpy.copy", "numpy.asarray",
          "numpy.ascontiguousarray", "numpy.array", "numpy.astype")
_OTHER = Affine.symbol("another size")


def unit_axes(node: AST, typing: Typing) -> tuple[int, ...]:
    """The axes of an array that are known to have length 1, in order."""
    if isinstance(node, Name):
        return typing.ones.get(node.id, ())
    if isinstance(node, Constant) or not typing.of(node).is_array:
        return ()
    if isinstance(node, Subscript):
        return _of_part(node, typing)
    if isinstance(node, BinOp):
        return () if isinstance(node.op, MatMult) else _common([node.left, node.right], typing)
    if isinstance(node, Compare):
        return _common([node.left, *node.comparators], typing)
    if isinstance(node, UnaryOp):
        return unit_axes(node.operand, typing)
    return _of_call(node, typing) if isinstance(node, Call) else ()


def _of_part(node: Subscript, typing: Typing) -> tuple[int, ...]:
    """Those of a part, by the form of its subscripts, and of the array where all of an axis is taken."""
    subscripts = indices(node)
    if any(not keeps_axis(s) and typing.of(s).is_array or isinstance(s, Constant) and s.value is Ellipsis
           for s in subscripts):
        return ()
    whole, kept, axis = unit_axes(node.value, typing), list[bool](), 0
    for s in subscripts:
        all_of_it = isinstance(s, Slice) and s.lower is None and s.upper is None
        if keeps_axis(s):
            kept.append(axis in whole if all_of_it else is_single(s))
        axis += not (isinstance(s, Constant) and s.value is None)
    kept += [k in whole for k in range(axis, typing.of(node.value).rank)]
    return tuple(k for k, single in enumerate(kept) if single)


def _common(parts: list[AST], typing: Typing) -> tuple[int, ...]:
    """Those of arrays that are broadcast: of every array that has the axis."""
    kinds = list(map(typing.argument, parts))
    rank = max((t.rank for t in kinds), default=0)
    return () if any(t.kind not in ("number", "array") for t in kinds) else tuple(
        k for k in range(rank) if all(t.rank < rank - k or k - rank + t.rank in t.ones for t in kinds))


def _of_call(node: Call, typing: Typing) -> tuple[int, ...]:
    called, rule = call_name(node) or "", find_array(call_name(node))
    if user_call(node):
        results = typing.call_results(node)
        return results[0].ones if results else ()
    if called in _SHAPED and node.args:
        return _written(node.args[0])
    if called in _ALIKE and node.args:
        return unit_axes(node.args[0], typing)
    if rule is not None:
        return _by_rule(node, rule, typing)
    elementwise = called == "numpy.where" and len(node.args) == 3 or find_elementwise(called) is not None
    return _common(node.args, typing) if elementwise and not node.keywords else ()


def _written(shape: AST) -> tuple[int, ...]:
    return tuple(k for k, size in enumerate(items_of(shape)) if whole_number(size) == 1)


def _by_rule(node: Call, rule: ArrayRule, typing: Typing) -> tuple[int, ...]:
    """Those of what a function of whole arrays gives, as the law of its shape has them."""
    rank, known = typing.of(node).rank, (*rule.operands, *rule.options)
    placed = len(rule.operands) <= len(node.args) <= len(known) and all(k.arg in known for k in node.keywords)
    if not placed or not typing.of(node.args[0]).is_array:
        return ()
    given = rule.arguments(node)
    if rule.name == "numpy.reshape":
        return _written(given["shape"])
    if rule.name == "numpy.expand_dims":
        axis = one_axis(given["axis"], rank)
        return () if axis is None else (axis,)
    if rule.name == "numpy.atleast_2d" and typing.of(node.args[0]).rank == 1:
        return (0,)
    if "axis" in given and is_true(given.get("keepdims")):
        return tuple(range(rank)) if is_none(given["axis"]) else axes_of(given["axis"], rank) or ()
    if rule.law not in LAWS:
        return ()
    shapes: list[Shape] = [tuple(ONE if k in t.ones else _OTHER for k in range(t.rank))
                           for t in map(typing.argument, (given[o] for o in rule.operands))]
    made = LAWS[rule.law].shape(shapes, given)
    return () if made is None or len(made) != rank else tuple(k for k, size in enumerate(made) if size == ONE)
