"""bounds_check_elimination: an index of a part of an array is asked whether it is inside only where it may not be.

    def f(x, m: int):               def f(x, m):
        y = x[1:-1]                     s = x[1 + element(m, x.shape[0] - 2)]
        s = y[m]                        for i in range(max(x.shape[0] - 2, 0)):
        for i in range(len(y)):             s += x[i + 1]
            s += y[i]                   return s
        return s

Requires resolved views. Establishes that an index of a part is inside the part; what would be outside of the array,
too, is left to its own bounds.
"""
from __future__ import annotations

from s2sad.infer.affine import Affine, at_most, feasible
from s2sad.infer.index_systems import IndexSystems
from s2sad.infer.path_conditions import CallSite, path_conditions
from s2sad.infer.shapes import Shapes, shapes_of
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, BinOp, FunctionDef, Name, Slice, Subscript, at, call_name, dump, index, indices, rebuild, walk, with_body,
)

ELEMENT = "runtime.element"


def bounds_check_elimination(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with the checks that are left."""
    if not any(call_name(n) == ELEMENT for n in walk(function.body)):
        return function
    checks = _Checks(function, shapes_of(function, context.typing))
    return with_body(function, [rebuild(s, checks.subscript) for s in function.body])


class _Checks:
    """The checks of one function, each at its place."""

    def __init__(self, function: FunctionDef, shapes: Shapes):
        self.shapes = shapes
        self.places = path_conditions(function.body, shapes)
        self.systems = IndexSystems(shapes, {}, lambda call: None)

    def subscript(self, node: AST) -> AST | None:
        """A subscript of an array without the checks that it does not need."""
        if not isinstance(node, Subscript) or not isinstance(node.value, Name):
            return None
        extents = self.shapes.of(node.value)
        made = [s if isinstance(s, Slice) else self.unchecked(s, extents[k] if k < len(extents) else None)
                for k, s in enumerate(indices(node))]
        new = Subscript(node.value, index(node.value, *made).slice, node.ctx)
        return at(new, node) if hasattr(node, "lineno") else new

    def unchecked(self, subscript: AST, extent: Affine | None) -> AST:
        needless = {id(n) for n in walk(subscript) if call_name(n) == ELEMENT
                    and self.is_needless(n, subscript, extent)}

        def change(part: AST) -> AST | None:
            return rebuild(part.args[0], change) if id(part) in needless else None
        made = rebuild(subscript, change) if needless else subscript
        form = self.shapes.size(made) if needless and isinstance(subscript, BinOp) else None
        return made if form is None else self.shapes.expression(form)

    def is_needless(self, check: AST, subscript: AST, extent: Affine | None) -> bool:
        """Whether an index is never negative, and not behind the part unless it is behind the array."""
        here = self.places.get(id(check))
        place, size = (None, None) if here is None else map(here.size, check.args)
        if here is None or place is None or size is None:
            return False
        whole = here.size(subscript)
        inside = [] if whole is None or extent is None else [
            form.replaced({dump(check): place}) for form in (at_most(whole.shift(1), extent), whole.plus(extent))]
        return not self.may(here, at_most(place, Affine((), -1))) and not self.may(here, at_most(size, place), *inside)

    def may(self, here: CallSite, *claim: Affine) -> bool:
        """Whether what is claimed can hold at a place."""
        return any(feasible(here.with_bounds(system)) for system in self.systems.split(here, claim))


__all__ = ["bounds_check_elimination"]
