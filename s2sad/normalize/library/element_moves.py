"""element_moves: functions that move elements about: the spelling that has a rule, and where an element comes from.

    np.roll(u, (1, 2), axis=(0, 1))     np.roll(np.roll(u, 1, axis=0), 2, axis=1)
    np.roll(u, (1, 2))                  np.roll(u, 1 + 2)
    np.flip(a, [0, 1])                  np.flip(a, (0, 1))
    a.T                                 np.transpose(a)
    a.mT                                np.swapaxes(a, -1, -2)
    np.permute_dims(a, (1, 2, 0))       np.moveaxis(a, (1, 2, 0), (0, 1, 2))

In loops (`loops.element_of`) the element of such a call is the element of its operand at another position:

    np.roll(u, 1, axis=0)   at i, j     u[(i - 1) % u.shape[0], j]

Their rules are in `rules/shaping.py`; `optimize/index_set_splitting.py` takes the remainders out of fast loops.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce

from s2sad.infer.signatures.laws import items_of, moveaxis_order, whole_number
from s2sad.infer.signatures.options import is_none
from s2sad.rules import bound, find_array
from s2sad.tree import (
    AST, Attribute, BinOp, Call, FloorDiv, List, Mod, Tuple, add, at, call, call_name, const, copy, keyword, mult, name,
    negate, sub, tuple_of,
)

Size = Callable[[int], AST]     # of the operand along an axis
_WITH_AXES = ("numpy.moveaxis", "numpy.flip", "numpy.roll")


# -- the spelling that has a rule ------------------------------------------------------------------------------------

def canonical_move(node: AST) -> AST | None:
    """The call, or the attribute, in its other spelling; None if it has the one that has a rule."""
    if isinstance(node, Attribute) and node.attr == "T":
        return call("numpy.transpose", node.value)
    if isinstance(node, Attribute) and node.attr == "mT":
        return _transposed_matrices(node.value)
    called = call_name(node)
    if not isinstance(node, Call) or called is None:
        return None
    if called in ("numpy.matrix_transpose", "numpy.linalg.matrix_transpose") and len(node.args) == 1:
        return _transposed_matrices(node.args[0])
    if called == "numpy.permute_dims":
        return Call(name("numpy.transpose"), node.args, node.keywords)
    if called == "numpy.transpose":
        return _permutation(node)
    if called in _WITH_AXES and any(isinstance(a, List) for a in (*node.args[1:], *(k.value for k in node.keywords))):
        return Call(node.func, [node.args[0], *map(_as_tuple, node.args[1:])],
                    [keyword(k.arg, _as_tuple(k.value)) for k in node.keywords])
    return _single_roll(node) if called == "numpy.roll" else None


def _transposed_matrices(stack: AST) -> Call:
    return call("numpy.swapaxes", stack, negate(const(1)), negate(const(2)))


def _as_tuple(node: AST) -> AST:
    return tuple_of(*node.elts) if isinstance(node, List) else node


def _permutation(node: Call) -> AST | None:
    """A transposition with the order of its axes."""
    orders = [*node.args[1:], *(k.value for k in node.keywords if k.arg == "axes")]
    if len(orders) != 1 or len(node.args) + len(node.keywords) != 2 or not isinstance(orders[0], (Tuple, List)):
        return None
    axes = orders[0].elts
    return call("numpy.moveaxis", node.args[0], tuple_of(*axes), tuple_of(*map(const, range(len(axes)))))


def _single_roll(node: Call) -> AST | None:
    """Shifts along several axes, one after the other; several shifts along one axis as their sum."""
    rule = find_array("numpy.roll")
    ordered = rule and bound(rule, node)
    if ordered is None:
        return None
    x, shift = ordered.args
    axes = next((k.value for k in ordered.keywords), None)
    if not isinstance(axes, (Tuple, List)):
        if not isinstance(shift, (Tuple, List)) or not shift.elts:
            return None
        return Call(node.func, [x, reduce(add, shift.elts)], ordered.keywords)
    shifts = shift.elts if isinstance(shift, (Tuple, List)) else [shift] * len(axes.elts)
    if len(shifts) != len(axes.elts):
        return None
    return reduce(lambda made, by: at(call("numpy.roll", made, copy(by[0]), axis=by[1]), node), zip(shifts, axes.elts),
                  x)


# -- where an element comes from -------------------------------------------------------------------------------------

def _roll(options: Mapping[str, AST], positions: list[AST], size: Size) -> list[AST]:
    shift, axis = options["shift"], options["axis"]
    rank = len(positions)
    if is_none(axis) and rank > 1:
        sizes = [size(k) for k in range(rank)]
        number = BinOp(_shifted_back(_raveled(positions, sizes), shift), Mod(), reduce(mult, map(copy, sizes)))
        return _unraveled(number, sizes)
    moved, k = list(positions), (whole_number(axis) or 0) % rank
    moved[k] = BinOp(_shifted_back(moved[k], shift), Mod(), size(k))
    return moved


def _shifted_back(position: AST, shift: AST) -> AST:
    number = whole_number(shift)
    return add(position, const(-number)) if number is not None and number < 0 else sub(position, copy(shift))


def _raveled(positions: list[AST], sizes: list[AST]) -> AST:
    """The number of an element in row-major order."""
    found = positions[0]
    for position, size in zip(positions[1:], sizes[1:]):
        found = add(mult(found, copy(size)), position)
    return found


def _unraveled(number: AST, sizes: list[AST]) -> list[AST]:
    """The position of the element with a number in row-major order."""
    found: list[AST] = []
    for size in reversed(sizes[1:]):
        found.insert(0, BinOp(copy(number), Mod(), copy(size)))
        number = BinOp(number, FloorDiv(), copy(size))
    return [number, *found]


def _flip(options: Mapping[str, AST], positions: list[AST], size: Size) -> list[AST]:
    axis, rank = options["axis"], len(positions)
    axes = range(rank) if is_none(axis) else [(whole_number(a) or 0) % rank for a in items_of(axis)]
    return [sub(sub(size(k), const(1)), p) if k in axes else p for k, p in enumerate(positions)]


def _transpose(options: Mapping[str, AST], positions: list[AST], size: Size) -> list[AST]:
    return positions[::-1]


def _moveaxis(options: Mapping[str, AST], positions: list[AST], size: Size) -> list[AST]:
    order = moveaxis_order(options, len(positions)) or []
    return [positions[order.index(k)] for k in range(len(positions))]


# for the options of a call, a position in its result and the sizes of its operand: the position in the operand
SOURCES: Mapping[str, Callable[[Mapping[str, AST], list[AST], Size], list[AST]]] = {
    "numpy.roll": _roll, "numpy.flip": _flip, "numpy.transpose": _transpose, "numpy.moveaxis": _moveaxis}
