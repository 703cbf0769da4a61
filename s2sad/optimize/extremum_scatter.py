"""extremum_scatter: the adjoint of an extremum of a whole array increments the element that attains it, for NumPy.

    def f(x: float64[:]):
        return np.max(x)

in its adjoint:

    def f_adjoint(...):
        ...
        x_bar[...] += np.where(extreme_mask(x, max_value, None, False) != 0,
                               spread(max_value_bar, x.shape, None, False), 0.0)

becomes

    def f_adjoint(...):
        ...
        x_bar[extreme_place(x, max_value)] += max_value_bar

*Requires* finished text for NumPy. *Establishes* the same values, without arrays of zeros.
"""
from __future__ import annotations


from s2sad.liveness import base_name
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, AugAssign, Compare, Constant, FunctionDef, Name, Subscript, at, augment, call, call_name, const, copy,
    dump, index, name, rebuild, with_body,
)

CHANGES_ROUNDING = False


def extremum_scatter(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such increments."""
    types = context.types
    def change(node: AST) -> AST | None:
        if not isinstance(node, AugAssign) or not isinstance(node.target, Subscript) or dump(
                node.target.slice) != dump(const(...)) or call_name(node.value) != "numpy.where":
            return None
        test, increment, rest = node.value.args
        mask = test.left if isinstance(test, Compare) else test
        if call_name(mask) != "runtime.extreme_mask" or call_name(increment) != "runtime.spread" or not _is_zero(rest):
            return None
        x, y = mask.args[:2]
        array = base_name(node.target)
        alike = isinstance(x, Name) and all(n in types for n in (x.id, array)) and types[x.id].rank == types[array].rank
        if not alike or not _reduces_all_axes(mask) or not _reduces_all_axes(increment):
            return None
        place = index(name(array), call("runtime.extreme_place", copy(x), copy(y)))
        return at(augment(place, node.op, copy(increment.args[0])), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _reduces_all_axes(called: AST) -> bool:
    """Whether a call is of all axes: its axis is None, and it keeps no axis."""
    return len(called.args) == 4 and [dump(a) for a in called.args[2:]] == [dump(const(None)), dump(const(False))]


def _is_zero(node: AST) -> bool:
    return isinstance(node, Constant) and node.value == 0


__all__ = ["extremum_scatter"]
