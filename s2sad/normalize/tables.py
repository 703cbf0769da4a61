"""tables: rows of written numbers under a name, of which a variable picks some, are an array.

    a = [[0, 0], [0.5, 0]]          a = np.array([[0, 0], [0.5, 0]])
    u += a[s][j] * k[j]             u += a[s][j] * k[j]

Requires resolved names. A name that is bound more than once, written to, or used in any other way than by its numbers,
the numbers of its rows and its length stays what it is: an array of integers would cut what is stored in it, and a row
is a list.
"""
from __future__ import annotations

from s2sad.normalize.scope import Scope
from s2sad.tree import (
    AST, Assign, BinOp, Call, Constant, For, FunctionDef, List, Name, Slice, Store, Subscript, Tuple, UnaryOp, at, call,
    call_name, children, copy, expr, names, walk,
)

_THROUGH = ("builtins.len", "builtins.enumerate", "builtins.zip", "builtins.reversed")


def tables(function: FunctionDef, scope: Scope) -> FunctionDef:
    new = copy(function)
    bound = [n.id for n in walk(new) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    for statement in list(walk(new.body)):
        if isinstance(statement, Assign) and len(statement.targets) == 1 and isinstance(statement.targets[0], Name):
            word = statement.targets[0].id
            if bound.count(word) == 1 and _size(statement.value) and _is_read_as_table(word, new):
                statement.value = at(call("numpy.array", statement.value), statement)
    return new


def _size(node: AST) -> tuple[int, ...]:
    """How many rows of how many written numbers; empty for anything else."""
    if not isinstance(node, (List, Tuple)) or not node.elts:
        return ()
    rows = [r.elts if isinstance(r, (List, Tuple)) else [] for r in node.elts]
    plain = all(rows) and len({len(r) for r in rows}) == 1 and all(_is_written(n) for r in rows for n in r)
    return (len(rows), len(rows[0])) if plain else ()


def _is_written(node: AST) -> bool:
    """Whether an expression is one of written numbers and constants."""
    if isinstance(node, Constant):
        return isinstance(node.value, (int, float)) and not isinstance(node.value, bool)
    if isinstance(node, Name):
        return node.id.startswith("const.") or node.id in ("numpy.pi", "math.pi", "math.e", "numpy.e")
    if isinstance(node, (BinOp, UnaryOp)):
        return all(_is_written(c) for c in children(node) if isinstance(c, expr))
    return (call_name(node) or "").startswith("math.") and isinstance(node, Call) and all(map(_is_written, node.args))


def _is_read_as_table(word: str, function: FunctionDef) -> bool:
    """Whether a variable picks numbers or rows, and nothing else is done but going through all of them."""
    parents = {id(c): p for p in walk(function.body) for c in children(p)}
    reads = [n for n in walk(function.body) if isinstance(n, Name) and n.id == word and not isinstance(n.ctx, Store)]
    picked = False
    for read in reads:
        parent = parents.get(id(read))
        if isinstance(parent, Subscript) and _is_stored(parent, parents):
            return False
        if isinstance(parent, Subscript) and parent.value is read and not isinstance(parent.slice, (Slice, Tuple)):
            outer = parents.get(id(parent))
            whole = isinstance(outer, Subscript) and outer.value is parent and not isinstance(outer.slice, Slice)
            if not whole and not _goes_through(outer, parent, parents, 1):
                return False
            picked = picked or bool(names([parent.slice, *([outer.slice] if isinstance(outer, Subscript) else [])]))
        elif not _goes_through(parent, read, parents, 2):
            return False
    return picked


def _is_stored(node: AST, parents: dict[int, AST]) -> bool:
    """Whether an element of a subscript, or what it picks itself, is stored into."""
    while isinstance(outer := parents.get(id(node)), Subscript) and outer.value is node:
        node = outer
    return isinstance(node, Subscript) and isinstance(node.ctx, Store)


def _goes_through(parent: AST | None, node: AST, parents: dict[int, AST], axes: int) -> bool:
    """Whether a length is asked for, or a loop goes through numbers: those of a row, or of the rows one by one."""
    word = call_name(parent)
    if word == "builtins.len":
        return True
    loop = parents.get(id(parent)) if word in _THROUGH else parent
    if not isinstance(loop, For) or loop.iter is not (node if loop is parent else parent):
        return False
    target = loop.target
    if isinstance(parent, Call) and word != "builtins.reversed":
        place = 1 if word == "builtins.enumerate" else parent.args.index(node)
        target = target.elts[place] if isinstance(target, Tuple) and len(target.elts) > place else None
    return isinstance(target, Name if axes == 1 else Tuple)
