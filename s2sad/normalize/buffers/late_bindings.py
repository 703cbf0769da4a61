"""late_bindings: an array that only some iterations bind, and that is read behind these, has a place before the loop.

    best = 0.0                          best = 0.0
    for k in range(n):                  chosen = np.empty((x.shape[0],))
        u = a[k] * x                    for k in range(n):
        if u[0] > best:                     u = a[k] * x
            best, chosen = u[0], u          if u[0] > best:
    return chosen                               best, chosen = u[0], u

Used by `resolve_views`, which begins anew with it where a name may stand for the array of an earlier iteration, and all
that it is bound to has one shape, made of sizes and numbers that the function is given. That it is bound when it is
read `definite_assignment` has asked.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping

from s2sad.infer.shapes import Shapes, shape_expression
from s2sad.infer.signatures.laws import Shape
from s2sad.infer.types import Type
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.tree import AST, For, FunctionDef, If, While, assign, at, call, names, stored_names, with_body


class LateBinding(Exception):
    """Names whose arrays are to be allocated before the loop that binds them, with the sizes."""

    def __init__(self, sizes: Mapping[str, AST]):
        super().__init__(*sizes)
        self.sizes = sizes


def allocated_before(function: FunctionDef, sizes: Mapping[str, AST], types: Mapping[str, Type]) -> FunctionDef:
    """The function with these allocations, each before the statement that binds the name first."""
    new, left = list[AST](), dict(sizes)
    for statement in function.body:
        for n in [n for n in left if n in stored_names(statement)]:
            new.append(at(assign(n, call("numpy.empty", left.pop(n), *dtype_of(types[n]))), statement))
        new.append(statement)
    return with_body(function, new)


def late_sizes(function: FunctionDef, found: Iterable[str], bound: Mapping[str, list[Shape]], shapes: Shapes
               ) -> dict[str, AST]:
    """The sizes of those of some names that can be allocated before the loop that binds them first."""
    parameters = {p.id for p in function.args.args} - {*stored_names(function.body)}
    made: dict[str, AST] = {}
    for n in found:
        first = next((s for s in function.body if n in stored_names(s)), None)
        several = {tuple(d and shapes.reduced(d) for d in shape) for shape in bound.get(n, ())}
        if n in parameters or not isinstance(first, (For, While, If)) or len(several) != 1:
            continue
        shape = next(iter(several))
        if all(d is not None and all(parameters.issuperset(names(shapes.atoms[s])) for s, _ in d.terms) for d in shape):
            made[n] = shape_expression(shapes, shape)
    return made
