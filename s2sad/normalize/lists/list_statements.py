"""list_statements: what of a function's text makes lists, appends to them and takes items out of them, and where they
may be arrays of their items.
"""
from __future__ import annotations

from s2sad.infer.list_arrays import LISTED, MARKS
from s2sad.liveness import base_name, targets
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, Compare, Constant, Eq, Expr, For, FunctionDef, Gt, GtE, List, Lt,
    LtE, Mult, Name, NotEq, Subscript, Tuple, at, call, call_name, const, indices, walk,
)

_READING = tuple(f"builtins.{f}" for f in ("sum", "len", "enumerate", "zip", "reversed"))


def unfilled(node: AST) -> AST | None:
    """A list that is yet to be filled: `[None] * n`."""
    one = node.left if isinstance(node, BinOp) and isinstance(node.op, Mult) else node
    if not isinstance(one, List) or not one.elts or not all(
            isinstance(i, Constant) and i.value is None for i in one.elts):
        return None
    return at(call(LISTED, node.right if isinstance(node, BinOp) else const(len(one.elts))), node)


def appended_list(node: AST) -> str | None:
    """The name that `name.append(x)` appends to."""
    call_ = node.value if isinstance(node, Expr) else None
    if isinstance(call_, Call) and isinstance(call_.func, Attribute) and call_.func.attr == "append" and isinstance(
            call_.func.value, Name) and len(call_.args) == 1 and not call_.keywords:
        return call_.func.value.id
    return None


def popped_list(node: AST) -> str | None:
    """The name of the list of which `item = name.pop(k)` takes out the first item or the last, `name.clear()` all."""
    call_ = node.value if isinstance(node, (Assign, Expr)) else None
    taken = isinstance(call_, Call) and isinstance(call_.func, Attribute) and isinstance(
        call_.func.value, Name) and (call_.func.attr, len(call_.args)) in (("pop", 1), ("clear", 0))
    return call_.func.value.id if taken and isinstance(call_, Call) else None


def grown_lists(function: FunctionDef) -> list[str]:
    """The names of the lists that a function appends to, or takes items out of."""
    return list(dict.fromkeys(n for s in walk(function.body) if (n := appended_list(s) or popped_list(s)) is not None))


def is_first(statement: AST) -> bool:
    """Whether what is popped is the first item."""
    return isinstance(statement, Assign) and getattr(statement.value.args[0], "value", None) == 0


def as_arrays(tree: FunctionDef) -> set[int]:
    """The occurrences of names at which a list may be an array of its items."""
    found: set[int] = set()
    for node in walk(tree.body):
        called = call_name(node) or ""
        if called.startswith("numpy.") or called in _READING or called in MARKS:
            arguments = [*node.args, *(k.value for k in node.keywords)]
            found |= {id(n) for a in arguments for n in (a.elts if isinstance(a, (Tuple, List)) else [a])}
        elif isinstance(node, For):
            found.add(id(node.iter))
        elif isinstance(node, Subscript):
            found |= {id(n) for n in indices(node)}
        elif appended_list(node):
            found.add(id(node.value.args[0]))
    return found


def operands(tree: FunctionDef) -> set[int]:
    """The occurrences of names as operands: of a list it is a list's operator, or an array's if the other one is."""
    found: set[int] = set()
    for node in walk(tree.body):
        if isinstance(node, BinOp):
            found |= {id(node.left), id(node.right)}
        elif isinstance(node, Compare) and all(isinstance(op, (Eq, NotEq, Lt, LtE, Gt, GtE)) for op in node.ops):
            found |= {id(n) for n in (node.left, *node.comparators)}
        elif isinstance(node, AugAssign):
            found.add(id(node.value))
    return found


def changed_inside(tree: FunctionDef) -> set[int]:
    """The parts of lists that loops go through which append to these or store into them."""
    found: set[int] = set()
    for loop in walk(tree.body):
        parts = [n for n in walk(loop.iter) if isinstance(n, Subscript)] if isinstance(loop, For) else []
        changed = {n for s in walk(loop.body) for n in (appended_list(s), *map(base_name, targets(s)))} if parts else ()
        found |= {id(n) for n in parts if base_name(n) in changed}
    return found
