"""array_literals: an array that is spelled with arrays in it is a stack of these.

    def f(rho: "float64[:]", v: "float64[:]", p: "float64[:]"):     def f(rho, v, p):
        F = np.array([rho * v, p])                                      F = np.stack([rho * v, p], axis=0)
        return np.sum(F * F)                                            return np.sum(F * F)

Likewise

    A = np.array([[u, v], [v, w]])      A = np.stack([np.stack([u, v], axis=0), np.stack([v, w], axis=0)], axis=0)
    q[:2] = [u, 2.0 * u]                q[:2] = np.stack([u, 2.0 * u], axis=0)
    n = np.array(u.shape)               n = np.array([u.shape[0], u.shape[1]])

Requires structured form and types. Establishes that array literals have numbers as items.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.inference import Typing
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, Attribute, Call, FunctionDef, List, Name, Tuple, assign, at, call, call_name, const, index,
    keyword, name, rebuild, with_body,
)

_SPELLED = {"numpy.array", "numpy.asarray", "numpy.ascontiguousarray"}


def array_literals(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those stacks."""
    typing = context.typing
    def change(node: AST) -> AST | None:
        if isinstance(node, Assign) and _holds_arrays(node.value, typing) and not isinstance(
                node.targets[0], Name) and typing.of(node.targets[0]).is_array:
            return at(assign(rebuild(node.targets[0], change), _stack(node.value, change)), node)
        if isinstance(node, Call) and call_name(node) in _SPELLED and node.args and _is_shape(node.args[0], typing):
            sizes = [index(rebuild(node.args[0], change), const(k)) for k in range(typing.of(node.args[0].value).rank)]
            return at(Call(node.func, [List(sizes, node.args[0].ctx), *node.args[1:]], node.keywords), node)
        if isinstance(node, Call) and call_name(node) in _SPELLED and node.args and _holds_arrays(node.args[0], typing):
            made = _stack(node.args[0], change)
            kind = typing.of(node).dtype
            return made if kind == typing.of(made).dtype else at(
                Call(name("numpy.astype"), [made], [keyword("dtype", name(f"numpy.{kind}"))]), node)
        return None
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _is_shape(node: AST, typing: Typing) -> bool:
    return isinstance(node, Attribute) and node.attr == "shape" and typing.of(node.value).is_array


def _holds_arrays(node: AST, typing: Typing) -> bool:
    return isinstance(node, (List, Tuple)) and any(typing.of(item).is_array or _holds_arrays(item, typing)
                                                   for item in node.elts)


def _stack(node: AST, change: Callable[[AST], AST | None]) -> AST:
    if not isinstance(node, (List, Tuple)):
        return rebuild(node, change)
    return at(call("numpy.stack", List([_stack(item, change) for item in node.elts], node.ctx), axis=const(0)), node)
