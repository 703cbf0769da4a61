"""The order in which Python evaluates what a structure is made of: that of the text, whatever that of the fields.

    p = Point(y=up(x), x=x[0])   ->   held = up(x)
                                      held_2 = x[0]
                                      p = Point(y=held, x=held_2)

Only where a function that is called may store, and where the structure is all that a statement computes; elsewhere such
a call is refused.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable

from s2sad.evaluate.argument_binding import user_call
from s2sad.tree import AST, Assign, Attribute, Call, Name, Store, at, call_name, keyword, name, walk


def may_write(node: Call) -> bool:
    """Whether a call of what is no user's function may store in an array."""
    return any(k.arg == "out" for k in node.keywords) or not (call_name(node) or "").startswith((
        "builtins.", "math.", "numpy.", "record."))


def stores(node: AST, may_store: Callable[[Call], bool]) -> bool:
    """Whether an expression may store in an array or in a structure."""
    return any(isinstance(n, Call) and (may_store(n) if user_call(n) else may_write(n)) for n in walk(node))


def is_turned(node: AST, fields: Iterable[str | int]) -> bool:
    """Whether what is given by name stands in another order than the fields."""
    order = list(fields)
    given = [order.index(k.arg) for k in getattr(node, "keywords", []) if k.arg in order]
    return given != sorted(given)


def in_order(node: Call, fresh: Callable[[str], str], assign: Callable[[Assign], list[AST]]) -> tuple[list[AST], Call]:
    """The call with names for what it is given, which statements before it bind in the order of the text."""
    before: list[AST] = []

    def held(value: AST) -> AST:
        new = fresh("held")
        target = at(Name(new, Store(), None, None), value)
        before.extend(at(s, value) for s in assign(at(Assign([target], value, None), value)))
        return at(name(new), value)
    function = node.func
    if isinstance(function, Attribute):
        function = at(Attribute(held(function.value), function.attr, function.ctx), function)
    arguments = [held(a) for a in node.args]
    keywords = [at(keyword(k.arg, held(k.value)), k.value) for k in node.keywords]
    return before, at(Call(function, arguments, keywords), node)
