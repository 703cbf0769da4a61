"""extremes: what an extreme of a whole array gains is added at its place, for NumPy.

    x_bar[...] += np.where(extreme_mask(x, m, None, False) != 0,        x_bar[extreme_place(x, m)] += g
                           spread(g, x.shape, None, False), 0.0)

Requires finished text for NumPy; establishes the same values.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.analyze.liveness import base_name
from s2sad.infer.types import Type
from s2sad.tree import (
    AST, AugAssign, Compare, Constant, FunctionDef, Name, Subscript, at, augment, call, call_name, const, copy,
    dump, index, name, rebuild, with_body,
)

CHANGES_ROUNDING = False


def extremes(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function with such gains."""
    def change(node: AST) -> AST | None:
        if not isinstance(node, AugAssign) or not isinstance(node.target, Subscript) or dump(
                node.target.slice) != dump(const(...)) or call_name(node.value) != "numpy.where":
            return None
        test, gain, rest = node.value.args
        mask = test.left if isinstance(test, Compare) else test
        if call_name(mask) != "runtime.extreme_mask" or call_name(gain) != "runtime.spread" or not _is_zero(rest):
            return None
        x, y = mask.args[:2]
        array = base_name(node.target)
        alike = isinstance(x, Name) and all(n in types for n in (x.id, array)) and types[x.id].rank == types[array].rank
        if not alike or not _of_all(mask) or not _of_all(gain):
            return None
        place = index(name(array), call("runtime.extreme_place", copy(x), copy(y)))
        return at(augment(place, node.op, copy(gain.args[0])), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _of_all(called: AST) -> bool:
    """Whether a function was of all axes: its axis is None, and it kept none."""
    return len(called.args) == 4 and [dump(a) for a in called.args[2:]] == [dump(const(None)), dump(const(False))]


def _is_zero(node: AST) -> bool:
    return isinstance(node, Constant) and node.value == 0


__all__ = ["extremes"]
