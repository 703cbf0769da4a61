"""tuple_arguments: no tuple of values that may have derivatives is the argument or the result of a kernel.

    def h(t):
        return t[0] * t[1]

    def f(x: "float64[:, :]", n: int):
        us = [(x[0, 0], x[0, 1]), (x[1, 0], x[1, 1])]
        s = 0.0
        for i in range(n):
            s += h(us[i])
        return s

refused: a tuple or a list whose parts are not known is given to 'h'

Requires structured form without calls that return arrays, and types as far as they are known; changes nothing.
Partial evaluation takes tuples apart where their items are known; constants of the module, and a parameter that is
passed on, stay.
"""
from __future__ import annotations

from s2sad.infer.types import Type
from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.effects import parameters
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.tree import AST, Call, FunctionDef, List, Name, Return, Tuple, names, stored_names, walk


def tuple_arguments(function: FunctionDef, context: NormalContext) -> None:
    """Refuses such tuples at their places."""
    free, report = Names(context.names.taken), context.report
    function, typing = context.helpers.typing(function, context.given, context.kernel.source, free)
    given = set(parameters(function)) - set(stored_names(function.body))
    for node in walk(function.body):
        called = user_call(node)
        if isinstance(node, Call) and called is not None:
            for argument in node.args:
                if is_together(typing.of(argument)) and _is_own(argument, given):
                    report.error("S201", f"a tuple or a list whose parts are not known is given to '{called}'", node,
                                 help="spell it out under a name before the call, or give what is in it one by one")
        elif isinstance(node, Return) and node.value is not None:
            for value in node.value.elts if isinstance(node.value, Tuple) else [node.value]:
                if isinstance(value, (List, Name)) and is_together(typing.of(value)):
                    report.error("S201", "a list or a tuple is returned as one value", node,
                                 help="return its items: return us[0], us[1]")


def is_together(kind: Type) -> bool:
    """Whether a type is that of a tuple which has floats, complex numbers or arrays somewhere in it."""
    return kind.kind == "tuple" and any(i.is_inexact or i.is_array or is_together(i) for i in kind.items)


def _is_own(argument: AST, given: set[str]) -> bool:
    """Whether a function makes the tuple of values of its own."""
    return any("." not in n and n not in given for n in names(argument))
