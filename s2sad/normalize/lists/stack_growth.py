"""stack_growth: a stack that a generated text lets grow is written out, as any array that is allocated anew.

    def f(u: float64[:], n: int64):
        from s2sad.runtime import grow
        us = np.empty(2)
        for k in range(n):
            us = grow(us, k)
            us[k] = u[k]
        return us[0]

becomes

    def f(u, n):
        us = np.empty(2)
        for k in range(n):
            if k >= us.shape[0]:
                us_before = np.copy(us)
                us = np.empty((max(2 * us.shape[0], k + 1),) + us.shape[1:], us.dtype)
                us[:us_before.shape[0]] = us_before
            us[k] = u[k]
        return us[0]

Requires resolved names; establishes that nothing grows but by statements that can be differentiated: derivatives nest.
"""
from __future__ import annotations

from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Add, Assign, FunctionDef, GtE, If, Name, Slice, add, assign, at, attribute, binary, call, call_name, compare,
    const, copy, index, mult, name, rebuild, tuple_of, walk,
)


def stack_growth(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without calls of `grow`."""
    if not any(call_name(n) == "runtime.grow" for n in walk(function.body)):
        return function
    return rebuild(function, lambda node: _written_out(node, scope))


def _written_out(node: AST, scope: KernelScope) -> AST | None:
    if not isinstance(node, Assign) or call_name(node.value) != "runtime.grow":
        return None
    stack, top = node.value.args
    if not isinstance(stack, Name) or getattr(node.targets[0], "id", None) != stack.id:
        return None
    rows = index(attribute(copy(stack), "shape"), const(0))
    more = call("builtins.max", mult(const(2), rows), add(copy(top), const(1)))
    shape = binary(tuple_of(more), Add(), index(attribute(copy(stack), "shape"), Slice(const(1), None, None)))
    before = name(scope.fresh(f"{stack.id}_before"))
    part = index(copy(stack), Slice(None, index(attribute(copy(before), "shape"), const(0)), None))
    return at(If(compare(copy(top), GtE(), copy(rows)), [
        assign(before, call("numpy.copy", copy(stack))),
        assign(copy(stack), call("numpy.empty", shape, attribute(copy(stack), "dtype"))),
        assign(part, copy(before)),
    ], []), node)
