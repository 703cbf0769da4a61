"""shape_assignment: an array that is given another shape becomes a view of that shape, under its old name.

    a = 2.0 * u                         a = 2.0 * u
    a.shape = (n, n)                    a = a.reshape((n, n))

Before names are resolved. Python gives the array itself another shape, for all that hold it: so only an array is taken
that the function has made, and which nothing that reads it hands on. Others stay, for the fence to refuse.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad.read.outside_values import AST, Captured, ModuleValue
from s2sad.tree import (
    Assign, Attribute, AugAssign, BinOp, Call, Compare, Expr, FunctionDef, Load, Name, Return, Store, Subscript,
    UnaryOp, at, children, copy, rebuild, stored_names, times_bound, walk, walk_statements, with_body,
)

# functions of NumPy that make an array, with how many arguments come before the place of `out`
MAKING = {**dict.fromkeys("zeros ones empty full zeros_like ones_like empty_like full_like arange linspace copy array"
                           .split(), 9), **dict.fromkeys("sin cos exp log sqrt tanh abs".split(), 1),
           **dict.fromkeys("maximum minimum outer concatenate stack".split(), 2), "where": 3, "cumsum": 3}
_REDUCING = {"sum": 3, "prod": 3, "mean": 3, "dot": 2, "max": 2, "min": 2, "any": 2, "all": 2}
_ASKED = ("shape", "size", "ndim", "dtype", "T",
          "sum", "prod", "mean", "max", "min", "copy", "dot", "reshape", "ravel", "fill")   # none is the array itself


def shape_assignment(captured: Captured) -> Captured:
    """The function with such arrays as views."""
    function = captured.tree
    wanted = {_shaped(s) for s in walk(function.body)} - {""} if isinstance(function, FunctionDef) else set()
    if not wanted:
        return captured
    made = _made(captured, wanted) - _held(captured)

    def change(node: AST) -> AST | None:
        name = _shaped(node)
        if name not in made:
            return None
        called = Call(Attribute(Name(name, Load(), None, None), "reshape", Load()), [copy(node.value)], [])
        return at(Assign([Name(name, Store(), None, None)], called, None), node)
    new = with_body(function, [rebuild(s, change) for s in function.body])
    return replace(captured, tree=new)


def _shaped(node: AST) -> str:
    """The name whose shape a statement sets, or ""."""
    target = node.targets[0] if isinstance(node, Assign) and len(node.targets) == 1 else None
    return target.value.id if isinstance(target, Attribute) and target.attr == "shape" and isinstance(
        target.value, Name) else ""


def _made(captured: Captured, wanted: set[str]) -> set[str]:
    """Those of the names that are bound to new arrays wherever they are bound."""
    function = captured.tree
    new = [s.targets[0].id for s in walk_statements(function.body) if isinstance(s, Assign) and len(s.targets) == 1
           and isinstance(s.targets[0], Name) and _is_new(s.value, captured)]
    parameters = {n.id for n in walk(function.args) if isinstance(n, Name)}
    changed = times_bound(function.body, AugAssign)
    return {n for n, times in times_bound(function.body).items() if n in wanted - parameters
            and new.count(n) and new.count(n) == times - changed[n]}


def _is_new(value: AST, captured: Captured) -> bool:
    """Whether an expression makes an array, as far as its text shows it."""
    if isinstance(value, Call) and isinstance(value.func, Attribute) and value.func.attr == "copy":
        return not value.keywords
    return isinstance(value, (BinOp, UnaryOp)) or _calls(value, captured, MAKING)


def _calls(node: AST, captured: Captured, functions: dict[str, int]) -> bool:
    """Whether a call of a function of NumPy, by its module's name, gives something new."""
    if not isinstance(node, Call) or not isinstance(node.func, Attribute) or not isinstance(
            node.func.value, Name) or node.func.value.id in stored_names(captured.tree.body):
        return False
    meaning = captured.scope.lookup(node.func.value.id)
    return isinstance(meaning, ModuleValue) and meaning.name == "numpy" and len(node.args) <= functions.get(
        node.func.attr, -1) and not any(k.arg in ("out", "copy", None) for k in node.keywords)


def _held(captured: Captured) -> set[str]:
    """The names that something else may hold: all but those that are only asked, computed with, or returned."""
    harmless: set[int] = set()
    for node in _own(captured.tree.body):
        if isinstance(node, Attribute) and node.attr in _ASKED or isinstance(node, (Subscript, Return)):
            harmless.add(id(node.value))
        elif isinstance(node, (BinOp, UnaryOp, Compare)):
            harmless |= {id(n) for n in children(node)}
        elif _calls(node, captured, {**MAKING, **_REDUCING}):
            harmless |= {id(a) for a in node.args}
        elif isinstance(node, Expr) and isinstance(node.value, Call) and isinstance(node.value.func, Name):
            harmless |= {id(a) for a in node.value.args}
    return {n.id for n in walk(captured.tree.body) if isinstance(n, Name) and isinstance(n.ctx, Load)
            and id(n) not in harmless}


def _own(node: AST | list[AST]) -> list[AST]:
    """The nodes below, without those of functions within."""
    below = node if isinstance(node, list) else [] if type(node).__name__ in ("FunctionDef", "Lambda") else [
        *children(node)]
    return [n for b in below for n in (b, *_own(b))]
