"""reshaped: an array that is given another shape becomes a view of that shape, under its old name.

    a = 2.0 * u                         a = 2.0 * u
    a.shape = (n, n)                    a = a.reshape((n, n))

Requires a captured function. Python gives the array itself another shape, for all that hold it: so only an array is
taken that the function has made, and that has no other name. Others stay, for the fence to refuse.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, For, FunctionDef, List, Load, Name, Store, Tuple, UnaryOp, at, copy,
    rebuild, times_bound, walk,
)

_MAKING = frozenset("zeros ones empty full zeros_like ones_like empty_like full_like arange linspace copy array sin "
                    "cos exp log sqrt tanh abs outer concatenate stack where maximum minimum cumsum".split())
_GROWING = ("append", "extend", "insert")


def reshaped(function: FunctionDef) -> FunctionDef:
    """The function with such arrays as views."""
    wanted = {_shaped(s) for s in walk(function.body)} - {""}
    if not wanted:
        return function
    made = _made(function, wanted) - _held(function)

    def change(node: AST) -> AST | None:
        name = _shaped(node)
        if name not in made:
            return None
        called = Call(Attribute(Name(name, Load(), None, None), "reshape", Load()), [copy(node.value)], [])
        return at(Assign([Name(name, Store(), None, None)], called, None), node)
    new = copy(function)
    new.body = [rebuild(s, change) for s in new.body]
    return new


def _shaped(node: AST) -> str:
    """The name whose shape a statement sets, or ""."""
    target = node.targets[0] if isinstance(node, Assign) and len(node.targets) == 1 else None
    return target.value.id if isinstance(target, Attribute) and target.attr == "shape" and isinstance(
        target.value, Name) else ""


def _made(function: FunctionDef, wanted: set[str]) -> set[str]:
    """Those of the names that are bound to new arrays wherever they are bound."""
    new = [s.targets[0].id for s in walk(function.body) if isinstance(s, Assign) and len(s.targets) == 1
           and isinstance(s.targets[0], Name) and _is_new(s.value)]
    parameters = {n.id for n in walk(function.args) if isinstance(n, Name)}
    changed = times_bound(function.body, AugAssign)
    return {n for n, times in times_bound(function.body).items() if n in wanted - parameters
            and new.count(n) and new.count(n) == times - changed[n]}


def _is_new(value: AST) -> bool:
    """Whether an expression makes an array, as far as its text shows it."""
    if isinstance(value, Call) and isinstance(value.func, Attribute):
        return value.func.attr in _MAKING and not any(k.arg in ("out", "copy") for k in value.keywords)
    return isinstance(value, (BinOp, UnaryOp))


def _held(function: FunctionDef) -> set[str]:
    """The names that something else holds, or may hand back: `v = u`, `(u, v)`, `f(u)`, `us.append(u)`."""
    values: list[AST] = []
    for node in walk(function.body):
        if isinstance(node, Assign):
            values += [node.value, *(a for a in _given(node.value))]
        elif isinstance(node, For):
            values.append(node.iter)
        elif isinstance(node, Call) and isinstance(node.func, Attribute) and node.func.attr in _GROWING:
            values += node.args
        elif isinstance(node, (Tuple, List)):
            values += node.elts
    return {v.id for v in values if isinstance(v, Name)}


def _given(value: AST) -> list[AST]:
    """What a call of a function by its bare name is given, which may come back."""
    return [a for n in walk(value) if isinstance(n, Call) and isinstance(n.func, Name)
            for a in (*n.args, *(k.value for k in n.keywords))]
