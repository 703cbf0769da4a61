"""hoist_allocations: allocations move out of the loops and branches in which their shape does not change.

Requires resolved views; establishes that an allocation left inside a loop has a shape that changes there, or is one of
several of its name.

    def f(x, n, m):                 def f(x, n, m):
        s = 0.0                         s = 0.0
        for i in range(n):              w = np.empty(m)
            w = np.zeros(m)             for i in range(n):
            for j in range(m):              w[...] = 0.0
                w[j] += x[i] * j            for j in range(m):
                s += w[j] * w[0]                w[j] += x[i] * j
        return s                                s += w[j] * w[0]
                                        return s
"""
from __future__ import annotations

from collections import Counter

from s2sad.liveness import base_name, read_names
from s2sad.form import ALLOCATIONS
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, BinOp, Constant, FloorDiv, For, FunctionDef, If, Mod, Name, Store, Sub, Subscript, Tuple, UnaryOp,
    USub, While, assign, at, call, call_name, const, index, name, names, stored_names, tuple_of, user_call, walk,
    with_body,
)


def hoist_allocations(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with its allocations as far out as their shapes allow."""
    known = {p.id for p in function.args.args}
    allocated = Counter(s.targets[0].id for s in walk(function.body) if is_allocation(s))
    if not allocated:
        return with_body(function, function.body)
    return with_body(function, _block(function.body, known, {n for n, times in allocated.items() if times > 1}))


def _block(block: list[AST], known: set[str], several: set[str]) -> list[AST]:
    """The block with the allocations that its compound statements let go; `known` are names bound before it, `several`
    those that are allocated in several branches, each in its own size."""
    new: list[AST] = []
    bound = set(known)
    for statement in block:
        freed: list[AST] = []
        kept = _compound(statement, bound, freed, several) if isinstance(statement, (For, While, If)) else statement
        new += [*freed, kept]
        bound |= set(stored_names([*freed, kept]))
    return new


def _compound(statement: AST, bound: set[str], freed: list[AST], several: set[str]) -> AST:
    changed = set(stored_names(statement))
    written = _written(statement)
    looping = isinstance(statement, (For, While))

    def strip(block: list[AST], inner: set[str]) -> list[AST]:
        new: list[AST] = []
        for item in _block(block, inner, several):
            gone = {f.targets[0].id for f in freed}
            if not is_allocation(item) or item.targets[0].id in several or not _is_hoistable(
                    item, bound | gone, changed - gone, written):
                new.append(item)
                continue
            target = item.targets[0].id
            zeros = "zeros" in (call_name(item.value) or "")
            freed.append(at(_with_nonnegative_sizes(_uninitialized(item) if looping and zeros else item), item))
            if looping and zeros:
                new.append(at(assign(index(name(target), const(...)), const(0.0)), item))
        return new

    if isinstance(statement, If):
        return at(If(statement.test, strip(statement.body, bound), strip(statement.orelse, bound)), statement)
    if isinstance(statement, For):
        inner = bound | {statement.target.id}
        return at(For(statement.target, statement.iter, strip(statement.body, inner), [], None), statement)
    return at(While(statement.test, strip(statement.body, bound), []), statement)


def is_allocation(statement: AST) -> bool:
    """Whether a statement in normal form binds a name to a new array."""
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Name)
            and call_name(statement.value) in ALLOCATIONS)


def _is_hoistable(item: Assign, bound: set[str], changed: set[str], written: set[str]) -> bool:
    needed = set(names(item.value))
    loads = any(isinstance(n, Subscript) and isinstance(n.value, Name) for n in walk(item.value))
    divides = any(isinstance(n, BinOp) and isinstance(n.op, (FloorDiv, Mod)) and not isinstance(n.right, Constant)
                  for n in walk(item.value))  # by zero, perhaps, where the block would not have run
    return (needed <= bound and not needed & changed and not loads and not divides
            and not read_names(item.value) & written)


def _written(statement: AST) -> set[str]:
    """The arrays whose content a statement may change."""
    stored = {base_name(n) for n in walk(statement) if isinstance(n, Subscript) and isinstance(n.ctx, Store)}
    given = {n for called in walk(statement) if user_call(called) for n in names(called)}
    return stored | given


def _with_nonnegative_sizes(item: Assign) -> Assign:
    """The allocation where its block may not run: a size that a difference makes negative there is zero."""
    shape, allocation = item.value.args[0], call_name(item.value) or ""
    if "like" in allocation:
        return item
    sizes = [call("builtins.max", s, const(0)) if call_name(s) != "builtins.max" and any(
                 isinstance(n, (BinOp, UnaryOp)) and isinstance(n.op, (Sub, USub)) for n in walk(s)) else s
             for s in (shape.elts if isinstance(shape, Tuple) else [shape])]
    new = tuple_of(*sizes) if isinstance(shape, Tuple) else sizes[0]
    return assign(item.targets[0], call(allocation, new, *item.value.args[1:]))


def _uninitialized(item: Assign) -> Assign:
    start = "numpy.empty_like" if "like" in (call_name(item.value) or "") else "numpy.empty"
    return assign(item.targets[0], call(start, *item.value.args))
