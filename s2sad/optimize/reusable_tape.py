"""reusable_tape: the entry's stacks become parameters, so that the caller can reuse them in its next call.

    def f_adjoint(u, u_bar):                def f_adjoint_taped(u, u_bar, u_stack):
        u_stack = np.empty(u.size)              u_stack = sized(u_stack, (u.size,))
        ...                                     ...
                                                return u_stack,
                                            def f_adjoint(u, u_bar):
                                                f_adjoint_taped(u, u_bar, np.empty(0))

*Requires* a finished adjoint. *Establishes* a function that is given its stacks and returns them (larger ones may have
replaced them), and the public one. Fresh memory costs as much as the arithmetic: each page is faulted in anew.
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.differentiate.tape import Stack
from s2sad.infer.types import Type
from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Add, Assign, BinOp, Expr, FunctionDef, Name, Return, Tuple, assign, at, attribute, call, call_name, const,
    copy, function, index, name, tuple_of, walk_statements,
)


@dataclass(frozen=True)
class ReusableTape:
    """The two functions, and the stacks as (name, dtype, rank)."""
    taped: FunctionDef
    public: FunctionDef
    stacks: tuple[tuple[str, str, int], ...]


def reusable_tape(made: FunctionDef, stacks: list[Stack], types: dict[str, Type], title: str) -> ReusableTape | None:
    """The pair for a finished adjoint, None if it keeps nothing in arrays; `title` is the name of the first."""
    allocated = _allocated_stacks(made.body)
    kept = {s.array: s for s in stacks if s.loops and s.array in allocated}
    if not kept:
        return None
    parameters = [p.id for p in made.args.args]
    body = _with_sized_stacks(made.body, kept)
    last = body.pop() if isinstance(body[-1], Return) else None
    values = list(last.value.elts) if last is not None and isinstance(last.value, Tuple) else []
    body.append(Return(tuple_of(*values, *map(name, kept))))
    inner = function(title, [*parameters, *kept], body)
    rank = {s: types[s].rank for s in kept}
    empty = [call("numpy.empty", const(0) if rank[s] == 1 else tuple_of(*[const(0)] * rank[s]), *_dtype(types[s]))
             for s in kept]
    called = call(f"user.{title}", *map(name, parameters), *empty)
    outer: list[AST] = [Expr(called)]
    if values:
        held = "returned" if "returned" not in parameters else "returned_"
        outer = [assign(held, called),
                 Return(tuple_of(*(index(name(held), const(k)) for k in range(len(values)))))]
    described = tuple((s, types[s].dtype, rank[s]) for s in kept)
    return ReusableTape(inner, function(made.name, parameters, outer), described)


def _allocated_stacks(block: list[AST]) -> set[str]:
    return {s.targets[0].id for s in walk_statements(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)
            and call_name(s.value) == "numpy.empty"}


def _with_sized_stacks(block: list[AST], kept: dict[str, Stack]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in kept and call_name(statement.value) == "numpy.empty":
            made.append(at(assign(target.id, call("runtime.sized", name(target.id), _shape(
                copy(statement.value.args[0]), kept[target.id]))), statement))
        else:
            made.append(with_blocks(statement, lambda inner: _with_sized_stacks(inner, kept)))
    return made


def _shape(shape: AST, stack: Stack) -> AST:
    """The shape as a tuple; a growing stack keeps the length that it has reached."""
    if not isinstance(shape, (Tuple, BinOp)):
        shape = tuple_of(shape)
    if not stack.grows:
        return shape
    length = call("builtins.max", const(64), index(attribute(name(stack.array), "shape"), const(0)))
    if isinstance(shape, Tuple):
        return tuple_of(length, *shape.elts[1:])
    return BinOp(tuple_of(length), Add(), shape.right)


def _dtype(kind: Type) -> list[AST]:
    return [] if kind.dtype == "float64" else [name("numpy.bool_" if kind.dtype == "bool" else f"numpy.{kind.dtype}")]


