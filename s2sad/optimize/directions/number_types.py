"""number_types: which names that passes have made without a type hold numbers, and of what dtype."""
from __future__ import annotations

from s2sad.optimize.directions.layouts import Interleaved
from s2sad.infer.types import FLOAT, Type
from s2sad.liveness import targets
from s2sad.tree import (
    AST, BoolOp, Compare, FunctionDef, Name, Subscript, calls_kernel, indices, names, walk, walk_statements,
)


def number_types(tree: FunctionDef, dependent: set[str], layout: Interleaved) -> dict[str, Type]:
    """The types of those that depend on the direction and have none, or that of an integer: one name may be for
    versions of several types."""
    kinds, values = dict(layout.kinds), dict[str, list[AST]]()
    for statement in walk_statements(tree.body):
        for target in targets(statement):
            known = kinds.get(target.id) if isinstance(target, Name) and target.id in dependent else FLOAT
            if known is None or known.is_integer:
                values.setdefault(target.id, []).append(statement.value)
    made: dict[str, Type] = {}
    for identifier in [*values, *reversed(values)]:
        found = values[identifier]
        if not any(map(calls_kernel, found)) and all(is_number(v, Interleaved({**kinds, **made}, 0)) for v in found):
            inexact = [k for v in found if not isinstance(v, (Compare, BoolOp)) for n in names(v)
                       if (k := made.get(n, kinds.get(n))) is not None and k.is_inexact]
            if inexact or identifier not in kinds:
                made[identifier] = Type("number", "complex128" if any(k.is_complex for k in inexact) else "float64")
    return made


def is_number(value: AST, layout: Interleaved) -> bool:
    """Whether an expression is certainly a number."""
    for part in _outside_subscripts(value):
        kind = layout.kinds.get(part.id) if isinstance(part, Name) and "." not in part.id else FLOAT
        if kind is None or not kind.is_number:
            return False
    return all(isinstance(n.value, Name) and layout.is_element(n.value.id, indices(n))
               for n in walk(value) if isinstance(n, Subscript))


def has_arrays(value: AST, layout: Interleaved) -> bool:
    """Whether an expression has an array that no element is taken of."""
    if isinstance(value, Subscript):
        return not (isinstance(value.value, Name) and layout.is_element(value.value.id, indices(value)))
    return any(isinstance(n, Name) and (kind := layout.kinds.get(n.id)) is not None and kind.is_array
               for n in _outside_subscripts(value))


def _outside_subscripts(node: AST) -> list[AST]:
    """The parts of an expression that no subscript is taken of."""
    if isinstance(node, Subscript):
        return []
    found = [node]
    for value in vars(node).values():
        for part in value if isinstance(value, list) else [value]:
            if isinstance(part, AST):
                found += _outside_subscripts(part)
    return found
