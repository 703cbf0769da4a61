"""primal: the kernels that derivatives call, as the generated file has them."""
from __future__ import annotations

from collections.abc import Iterable

from s2sad.emit.bind_before_loops import bind_before_loops
from s2sad.rules import find_array
from s2sad.tree import (
    AST, AugAssign, Call, Expr, For, FunctionDef, GeneratorExp, ListComp, Raise, Subscript, call_name, copy, function,
    user_call, walk, walk_statements,
)
from s2sad.units import Unit, Units


def kernels_called(functions: Iterable[FunctionDef], units: Units) -> list[str]:
    """The titles of the units that functions call."""
    found = (user_call(n) for f in functions for n in walk(f.body))
    return list(dict.fromkeys(t for t in found if t in units.titled))


def primal_functions(units: Units, titles: list[str]) -> list[FunctionDef]:
    """The functions of these units and of all that they call, callees first."""
    made: dict[str, FunctionDef] = {}

    def visit(title: str) -> None:
        if title not in made:
            body = primal(units.titled[title])
            for called in kernels_called([body], units):
                visit(called)
            made[title] = body

    for title in titles:
        visit(title)
    return list(made.values())


def primal(unit: Unit) -> FunctionDef:
    """One kernel: as the user wrote it if it deals with numbers alone, else with views resolved, and each number bound
    where it is read."""
    original = unit.kernel.tree
    parameters = [p.id for p in unit.lowered.args.args]
    body = _undocumented(original.body) if _is_plain(unit) else unit.lowered.body
    return bind_before_loops(function(unit.title, parameters, copy(body)), unit.lowered_types)


def _undocumented(body: list[AST]) -> list[AST]:
    first = body[0] if body else None
    text = isinstance(first, Expr) and isinstance(getattr(first.value, "value", None), str)
    return body[1:] if text else body


def _is_plain(unit: Unit) -> bool:
    simple = all(t.is_number for t in unit.types) and not any(t.is_array for t in unit.typing.table.values())
    tree = unit.kernel.tree
    called = [call_name(n) or "" for n in walk(tree.body) if isinstance(n, Call)]
    calls = any(c.startswith("user.") or find_array(c) is not None for c in called)     # Numba reduces no numbers
    loops = (Subscript, For, AugAssign, GeneratorExp, ListComp)
    return simple and not calls and not any(isinstance(n, loops) for n in walk(tree.body)) and _raises(
        unit.lowered) == _raises(tree)


def _raises(tree: FunctionDef) -> int:
    """How often a function raises: once more where a name may be read before it is bound."""
    return sum(isinstance(n, Raise) for n in walk_statements(tree.body))
