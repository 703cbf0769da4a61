"""chained_assignment: a statement that assigns one value to several targets, one of them an element, is one for each
target.

    def f(x, y):                    def f(x, y):
        a = y[0] = np.sin(x[0])         a = np.sin(x[0])
        y[1] = y[2] = a * x[1]          y[0] = a
                                        held = a * x[1]
                                        y[1] = held
                                        y[2] = held

*Requires* resolved names. *Establishes* that an element is the one target of its statement. Python evaluates the value
once, then each target with what its subscripts are by then. Names alone stay chained: what two names mean is one thing
(`unpack`).
"""
from __future__ import annotations

from s2sad.evaluate.scope import KernelScope, atomic
from s2sad.tree import (
    AST, Assign, FunctionDef, Name, Subscript, assign, at, copy, head_copy, name, names, stored_names, with_body,
)


def chained_assignment(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without such statements."""
    return with_body(function, _block(function.body, scope))


def _block(block: list[AST], scope: KernelScope) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        if isinstance(statement, Assign) and len(statement.targets) > 1 and any(
                isinstance(t, Subscript) for t in statement.targets):
            made += [at(s, statement) for s in _one_by_one(statement, scope)]
            continue
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if isinstance(inner := getattr(statement, field, None), list):
                setattr(new, field, _block(inner, scope))
        made.append(new)
    return made


def _one_by_one(statement: Assign, scope: KernelScope) -> list[AST]:
    first, *rest = statement.targets
    value, made = statement.value, []
    if atomic(value) and not set(names(value)) & set(stored_names(statement.targets)):
        return [assign(t, copy(value)) for t in statement.targets]
    if isinstance(first, Name) and first.id not in stored_names(rest):
        return [assign(first, value), *(assign(t, name(first.id)) for t in rest)]
    held = scope.held(value, "held", made)
    return [*made, *(assign(t, copy(held)) for t in statement.targets)]
