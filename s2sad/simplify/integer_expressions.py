"""integer_expressions: which expressions are integers for certain; sums of these may be reassociated, not those of
bools or floats.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.types import INT, Type
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, FloorDiv, For, FunctionDef, Mod, Mult, Name, Not, Sub, Subscript,
    UnaryOp, call_name, walk_statements,
)

_TYPE_PRESERVING = ("builtins.max", "builtins.min", "builtins.abs", "numpy.maximum", "numpy.minimum")


def is_integer(node: AST, types: Mapping[str, Type] | None) -> bool:
    """Whether an expression is an integer, or an array of integers, by the types of its names; never a bool. Without
    types names are taken for integers, as in bounds and subscripts."""
    if isinstance(node, Constant):
        return type(node.value) is int
    if isinstance(node, Name):
        return types is None or node.id in types and types[node.id].holds_integers
    if isinstance(node, UnaryOp):
        return not isinstance(node.op, Not) and is_integer(node.operand, types)
    if isinstance(node, BinOp):
        return isinstance(node.op, (Add, Sub, Mult, FloorDiv, Mod)) and is_integer(node.left, types) and is_integer(
            node.right, types)
    if isinstance(node, Attribute):
        return node.attr in ("size", "ndim")
    if isinstance(node, Subscript):
        return isinstance(node.value, Attribute) and node.value.attr == "shape" or types is not None and is_integer(
            node.value, types)
    if isinstance(node, Call):
        called = call_name(node)
        return called in ("builtins.int", "builtins.len") or called in _TYPE_PRESERVING and all(
            is_integer(a, types) for a in node.args)
    return False


def with_counters(types: Mapping[str, Type], function: FunctionDef) -> dict[str, Type]:
    """The types of a function's names, with those of its loops' counters."""
    return {**types, **{n.target.id: INT for n in walk_statements(function.body) if isinstance(n, For)}}
