"""Which expressions are integers for certain, while structures are taken apart: they may be assigned to integer fields.

    s.k = (s.k + 1) % 3      for i in range(n): s.k += i      s.k = len(x)
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.tree import (
    AST, Add, AnnAssign, Assign, Attribute, AugAssign, BinOp, Call, Constant, FloorDiv, For, FunctionDef, Mod, Mult,
    Name, Sub, Subscript, Tuple, UAdd, USub, UnaryOp, call_name, stored_names, walk, walk_statements,
)

KEEPING = (Add, Sub, Mult, FloorDiv, Mod)       # what they make of two integers is one
_COUNTING = ("builtins.int", "builtins.len")
_CHOOSING = ("builtins.abs", "builtins.min", "builtins.max")


def is_whole(node: AST | None, types: Mapping[str, str]) -> bool:
    """Whether an expression is an integer, given the dtypes of names and of what arrays of one element hold."""
    if isinstance(node, Constant):
        return type(node.value) is int
    if isinstance(node, Name):
        return types.get(node.id, "").startswith(("int", "uint"))
    if isinstance(node, UnaryOp):
        return isinstance(node.op, (USub, UAdd)) and is_whole(node.operand, types)
    if isinstance(node, BinOp):
        return isinstance(node.op, KEEPING) and is_whole(node.left, types) and is_whole(node.right, types)
    if isinstance(node, Subscript):
        shape = isinstance(node.value, Attribute) and node.value.attr == "shape"
        return shape or isinstance(node.value, Name) and is_whole(node.value, types)
    if isinstance(node, Attribute):
        return node.attr in ("size", "ndim")
    given = node.args if isinstance(node, Call) and not node.keywords else []
    called = call_name(node) or ""
    return called in _COUNTING and len(given) == 1 or called in _CHOOSING and bool(given) and all(
        is_whole(a, types) for a in given)


def whole_names(function: FunctionDef, types: Mapping[str, str]) -> dict[str, str]:
    """The names of a kernel that are bound to integers alone, beside those whose dtypes are known."""
    bound: dict[str, list[AST | None]] = {}
    for node in walk_statements(function.body):
        if isinstance(node, For):
            counted = call_name(node.iter) == "builtins.range"
            first = node.target.elts[0] if isinstance(node.target, Tuple) and node.target.elts and call_name(
                node.iter) == "builtins.enumerate" else None
            for n in stored_names(node.target):
                whole = counted or isinstance(first, Name) and first.id == n
                bound.setdefault(n, []).append(Constant(0, None) if whole else None)
        elif isinstance(node, (Assign, AugAssign, AnnAssign)):
            targets = node.targets if isinstance(node, Assign) else [node.target]
            fields = node.value is None or any(isinstance(v, Attribute) for v in walk(node.value))
            keeps = not fields and (not isinstance(node, AugAssign) or isinstance(node.op, KEEPING))
            for n in stored_names(targets):
                simple = keeps and any(isinstance(t, Name) and t.id == n for t in targets)
                bound.setdefault(n, []).append(node.value if simple else None)
    parameters = {p.id for p in (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)}
    found = {n for n in bound if n not in parameters}
    while True:
        known = {**types, **dict.fromkeys(found, "int64")}
        left = {n for n in found if all(is_whole(v, known) for v in bound[n])}
        if left == found:
            return known
        found = left
