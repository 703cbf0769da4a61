"""searchsorted: searches that give an array of integers are functions of their own.

    def f(t: "float64[:]", v: "float64[:]", y: "float64[:]"):   def f(t, v, y):
        y[:] = t[np.searchsorted(t, v)]                             y[:] = t[np.searchsorted.each(t, v)]

and, where loops are compiled,

    np.argsort(a, axis=0)       np.argsort.along(a, axis=0)

Requires structured form and types. Establishes that `np.searchsorted` has a number to search for; `expand` writes the
others out.
"""
from __future__ import annotations

from s2sad import rules
from s2sad.infer.inference import Typing
from s2sad.normalize.context import NormalContext
from s2sad.tree import AST, Call, FunctionDef, at, call, call_name, name, rebuild, with_body


def searchsorted(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those functions; where loops are compiled, with sorts row by row, too."""
    typing, loops = context.typing, context.in_loops
    def change(node: AST) -> AST | None:
        made = _array_search(node, typing, loops) if isinstance(node, Call) else None
        return None if made is None else at(rebuild(made, change), node)
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _array_search(node: Call, typing: Typing, loops: bool) -> AST | None:
    called = call_name(node)
    if called == "numpy.searchsorted" and len(node.args) > 1 and typing.of(node.args[1]).is_array:
        return _renamed(node, "numpy.searchsorted.each")
    if called == "numpy.argsort" and node.args and (rank := typing.of(node.args[0]).rank):
        if rank == 1 and any(k.arg == "axis" for k in node.keywords):
            return call(called, node.args[0], **{str(k.arg): k.value for k in node.keywords if k.arg != "axis"})
        return _renamed(node, "numpy.argsort.along") if rank > 1 and loops else None
    return None


def _renamed(node: Call, function: str) -> Call | None:
    rule = rules.find_array(function)
    return rules.bound(rule, at(Call(name(function), node.args, node.keywords), node)) if rule else None
