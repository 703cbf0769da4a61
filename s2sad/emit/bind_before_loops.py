"""bind_before_loops: what an iteration reads of the one before has a value before the loop.

Numba takes names in the order of the text, and does not know one that is read above its first binding; and where one
of several things is carried (None or a number), all of them are copied, those that are not there, too:

    for i in range(3):                  m = 0
        if i > 1:                       for i in range(3):
            x[i] *= x[m]                    if i > 1:
        m = i                                   x[i] *= x[m]
                                            m = i
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.blocks import heads
from s2sad.infer.types import Type
from s2sad.tree import (
    AST, AugAssign, FunctionDef, Name, assign, at, const, names, stored_names, walk_statements, with_body,
)


def bind_before_loops(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function in which no number is read above its first binding."""
    bound = {p.id for p in function.args.args}
    body: list[AST] = []
    for statement in function.body:
        for early in _read_above_binding(statement, bound):
            if early in types and types[early].is_number:
                body.append(at(assign(early, const(types[early].zero)), statement))
        body.append(statement)
    return with_body(function, body) if len(body) > len(function.body) else function


def _read_above_binding(statement: AST, bound: set[str]) -> list[str]:
    """The names that a statement binds, and reads before it does; `bound` takes all that it binds."""
    here, found = set(stored_names(statement)), {}
    for part in walk_statements(statement):
        read = names(heads(part))
        if isinstance(part, AugAssign) and isinstance(part.target, Name):
            read.append(part.target.id)
        found |= {n: None for n in read if n in here and n not in bound}
        bound |= set(stored_names(heads(part))) | ({part.target.id} if hasattr(part, "iter") else set())
    return list(found)
