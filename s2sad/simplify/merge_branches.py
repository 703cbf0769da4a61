"""merge_branches: adjacent branches on one test become one, and a branch with two equal sides gives way to its side.

    def f(x, n):
        for k in range(n):
            if x[0] > 2.0:
                break
            x[0] = np.sin(x[0])

in its adjoint:

    def f_adjoint(...):                                 def f_adjoint(...):
        ...                                                 ...
        for k in range(0 + trips - 1, -1, -1):              for k in range(0 + trips - 1, -1, -1):
            taken = taken_stack[k]                              taken = taken_stack[k]
            if not taken:                                       if not taken:
                x[0] = x_stack[k]                                   x[0] = x_stack[k]
            if not taken:                                           x_here = x[0]
                x_here = x[0]                                       seed = x_bar[0]
            if not taken:                                           x_here_bar = np.cos(x_here) * seed
                seed = x_bar[0]                                     x_bar[0] = x_here_bar
                x_here_bar = np.cos(x_here) * seed
                x_bar[0] = x_here_bar

    def f(x, p):
        if x[0] > 0.0:
            x[1] = p
        else:
            x[1] = p
        return x[1]

in its tangent:

    def f_tangent(...):                 def f_tangent(...):
        taken = x[0] > 0.0                  taken = x[0] > 0.0
        if taken:                           x_dot[1] = p_dot
            x_dot[1] = p_dot                x[1] = p
            x[1] = p                        result_dot = x_dot[1]
        else:                               return (result_dot,)
            x_dot[1] = p_dot
            x[1] = p
        result_dot = x_dot[1]
        return (result_dot,)

*Requires* a structured function. *Establishes* the same values: the first branch does not change what the test reads.
"""
from __future__ import annotations

from s2sad.liveness import base_name, targets
from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import AST, FunctionDef, If, Subscript, at, calls_kernel, equal, names, walk, with_body

CHANGES_ROUNDING = False


def merge_branches(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with its adjacent branches merged."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        before = made[-1] if made else None
        if isinstance(statement, If) and isinstance(before, If) and _tests_again(before, statement):
            made[-1] = at(If(before.test, [*before.body, *statement.body], [*before.orelse, *statement.orelse]), before)
        else:
            made.append(statement)
    found: list[AST] = []
    for statement in (with_blocks(s, _block) for s in made):
        alike = isinstance(statement, If) and equal_blocks(statement.body, statement.orelse)
        found += statement.body if alike and not calls_kernel(statement.test) else [statement]
    return found


def equal_blocks(first: list[AST], second: list[AST]) -> bool:
    return len(first) == len(second) and all(map(equal, first, second))


def _tests_again(first: If, second: If) -> bool:
    inside = list(walk([*first.body, *first.orelse]))
    if not equal(first.test, second.test) or calls_kernel(first.test) or any(map(_leaves_block, inside)):
        return False
    elements = any(isinstance(n, Subscript) for n in walk(first.test))
    written = {base_name(t) for s in inside for t in targets(s)}
    return not written & set(names(first.test)) and not (elements and any(map(calls_kernel, inside)))


def _leaves_block(node: AST) -> bool:
    return type(node).__name__ in ("Break", "Continue", "Return", "Raise", "Assert")
