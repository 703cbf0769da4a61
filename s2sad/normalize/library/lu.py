"""lu: a matrix that is solved with is factorized by a statement of its own, so that a derivative factorizes it once.

    def f(a: "float64[:, :]", b):       def f(a, b):
        x = np.linalg.solve(a, b[:])        x = np.empty_like(b)
        return np.sum(x)                    factors = np.empty((a.shape[0] + 1, a.shape[0]))
                                            factors[...] = factored(a)
                                            x[...] = solved(factors, b)
                                            return np.sum(x)

Requires resolved views; for the engine that compiles loops. Establishes that a solution reads factors, which are an
array like any other: what a derivative reads of them later is recorded, in place of the matrix.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.naming import Names
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, For, FunctionDef, If, Name, Subscript, While, add, assign, at, attribute, call, call_name, const, copy,
    head_copy, index, name, tuple_of, with_body,
)


def lu(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those factors; the table of `typing` gains them."""
    typing, free = context.typing, context.names
    return with_body(function, _block(function.body, typing, free))


def _block(block: list[AST], typing: Typing, free: Names) -> list[AST]:
    return [at(made, s) for s in block for made in _statement(s, typing, free)]


def _statement(statement: AST, typing: Typing, free: Names) -> list[AST]:
    if isinstance(statement, (For, While, If)):
        new = head_copy(statement)
        new.body = _block(statement.body, typing, free)
        new.orelse = _block(statement.orelse, typing, free)
        return [new]
    if not isinstance(statement, Assign) or call_name(statement.value) != "numpy.linalg.solve":
        return [statement]
    a, b = statement.value.args
    kind = typing.of(a)
    if not isinstance(a, Name) or not isinstance(statement.targets[0], Subscript) or \
            kind.rank != 2 or not kind.is_float or typing.of(b).dtype != kind.dtype:
        return [statement]
    made = typing.declare(free.fresh("factors"), kind)
    size = index(attribute(a, "shape"), const(0))
    return [assign(made, call("numpy.empty", tuple_of(add(size, const(1)), copy(size)), *dtype_of(kind))),
            assign(index(name(made), const(...)), call("runtime.factored", a)),
            assign(statement.targets[0], call("runtime.solved", name(made), b))]
