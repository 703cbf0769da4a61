"""typed_rewrites: rewrites that depend on inferred types.

    def f(z: "complex128[:]", x):
        return x[0] * np.sum(z * z.conj()).real + x.item(1)
becomes

    def f(z, x):
        return x[0] * np.real(np.sum(z * np.conj(z))) + x[1]

Requires structured form and types; changes no type. Establishes the spelling that has a rule, where that depends on the
type of an operand: the conjugate of an array of floats is the array itself, `item` is an element.
"""
from __future__ import annotations

from functools import reduce

from s2sad.infer.inference import Typing
from s2sad.infer.promotion import CASTS
from s2sad.infer.signatures.laws import axes_of, whole_number, constant_slice
from s2sad.infer.signatures.options import is_none
from s2sad.infer.scalar_reductions_types import NORM, SPREAD, reduced_number
from s2sad.infer.types import UNKNOWN, Type
from s2sad.infer.unit_axes import unit_axes
from s2sad.normalize.context import NormalContext
from s2sad.normalize.control.conditional_values import ARRAYS, refuse_added_aliases
from s2sad.normalize.library.separated_subscripts import separated_subscripts
from s2sad.rules import find_array
from s2sad.normalize.views.views_without_axes import refuse_listed, views_element, views_without_axes
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Compare, Constant, FloorDiv, FunctionDef, In, Is, IsNot, List, Mod, Mult,
    Name, NotEq, NotIn, Slice, Sub, Subscript, Tuple, at, attribute, call, call_name, const, copy, index, indices, mult,
    rebuild, tuple_of, with_body,
)

_CASTS = {dtype: name for name, dtype in CASTS.items() if name.startswith("numpy.")}
CONJUGATING = ("conj", "conjugate")     # methods
_OF_A_NUMBER = {"shape": tuple_of(), "ndim": const(0), "size": const(1)}     # of one of NumPy's
_OF_AXES = ("numpy.transpose", "numpy.squeeze")      # which a number does not have
_REDUCING = ("numpy.sum", "numpy.prod", "numpy.mean", "numpy.cumsum", "numpy.cumprod", "numpy.std", "numpy.var")


def sum_start(items: int) -> Constant:
    """The initial 0 of Python's sum: it makes another array of the only item, and an integer of what is True."""
    return Constant(0, "start" if items > 1 else "alone")


def typed_rewrites(function: FunctionDef, context: NormalContext) -> FunctionDef:
    typing = context.typing
    refuse_added_aliases(function, context)
    views = views_without_axes(function, typing)
    refuse_listed(function, context, views)

    def change(node: AST) -> AST | None:
        if isinstance(node, BinOp) and isinstance(node.op, Add) and isinstance(
                node.left, Constant) and node.left.kind in ("start", "alone"):
            right, kind = rebuild(node.right, change), typing.of(node.right)
            counts = kind.dtype == "bool" or node.left.kind == "alone" and kind.is_array
            return at(BinOp(Constant(0, None), Add(), right), node) if counts else right
        if isinstance(node, Call) and isinstance(node.func, Attribute) and node.func.attr in CONJUGATING:
            kind, inner = typing.of(node.func.value), rebuild(node.func.value, change)
            return inner if kind.is_array and not kind.is_complex else at(call("numpy.conj", inner), node)
        if isinstance(node, BinOp) and (made := _operand_as_array(node, typing)) is not None:
            return rebuild(made, change)
        if isinstance(node, Compare) and (made := _comparison_as_array(node, typing)) is not None:
            return rebuild(made, change)
        if isinstance(node, Call) and isinstance(node.func, Attribute) and node.func.attr == "item":
            return _item(node, typing.of(node.func.value), [rebuild(n, change) for n in [node.func.value, *node.args]])
        if isinstance(node, Subscript) and isinstance(node.slice, Slice) and isinstance(node.value, Attribute):
            return _shape_slice(node, typing)
        if isinstance(node, Subscript) and (made := separated_subscripts(node, typing)) is not None:
            return rebuild(made, change)
        if call_name(node) == "numpy.asarray" and typing.of(node) == typing.of(node.args[0]) and (
                views_element(node.args[0], typing) or isinstance(node.args[0], Name) and node.args[0].id in views):
            return rebuild(node.args[0], change)    # which it is, and `view_aliases` is to see
        if call_name(node) in ARRAYS and (kind := typing.of(node)).is_number:
            return at(call(_CASTS[kind.dtype], rebuild(node.args[0], change)), node)
        if call_name(node) == "numpy.astype" and (kind := typing.of(node)).is_number and (
                kind.is_complex or not typing.of(node.args[0]).is_complex):
            inner = rebuild(node.args[0], change)
            if typing.of(node.args[0]) == kind or kind.is_complex:
                return inner if typing.of(node.args[0]) == kind else at(BinOp(inner, Add(), const(0j)), node)
            return at(call(_CASTS[kind.dtype], inner), node)
        if (dtype := CASTS.get(call_name(node) or "")) and isinstance(node, Call) and len(node.args) == 1 and (
                kind := typing.of(node.args[0])).is_array and kind.dtype == dtype:
            return at(call("numpy.asarray", rebuild(node.args[0], change)), node)
        if call_name(node) == "builtins.abs" and len(node.args) == 1 and typing.of(node.args[0]).is_array:
            return at(call("numpy.abs", rebuild(node.args[0], change)), node)
        if call_name(node) in _OF_AXES and len(node.args) == 1 and typing.of(node.args[0]).is_number:
            return rebuild(node.args[0], change)
        if call_name(node) == "numpy.squeeze" and len(node.args) == 1 and all(map(is_none, (
                k.value for k in node.keywords))) and (
                gone := unit_axes(node.args[0], typing)):
            context.guarded |= len(gone) < typing.of(node.args[0]).rank     # others may have length 1
            return at(call("numpy.squeeze", rebuild(node.args[0], change), axis=tuple_of(*map(const, gone)),
                           whole=const(True)), node)
        if call_name(node) == "numpy.reshape" and typing.of(node.args[0]).is_number:
            return _number_reshape(node, rebuild(node.args[0], change), typing)
        if call_name(node) == "numpy.reshape" and typing.of(node).is_number:
            every = tuple_of(*map(const, range(typing.of(node.args[0]).rank)))
            return at(call("numpy.squeeze", rebuild(node.args[0], change), axis=every), node)
        if call_name(node) == "numpy.reshape" and (made := _vector_reshape(node, typing)) is not None:
            return made
        if call_name(node) == "numpy.flip" and (made := _reversed_axes(node, typing)) is not None:
            return rebuild(made, change)
        if call_name(node) == "numpy.count_nonzero" and len(node.args) == 1 and not node.keywords and (
                kind := typing.of(node.args[0])).is_number and not kind.is_complex:
            return at(_number_count(rebuild(node.args[0], change), kind), node)
        if isinstance(node, Attribute) and node.attr in _OF_A_NUMBER and typing.of(node.value).is_number:
            return at(copy(_OF_A_NUMBER[node.attr]), node)
        if call_name(node) in ("numpy.size", "numpy.ndim") and (made := _array_property(node, typing)) is not None:
            return rebuild(made, change)
        if isinstance(node, Call) and (rule := find_array(call_name(node))) is not None and (
                len(node.args) == len(rule.operands) == 1) and (
                reduced_number(rule.name, typing.of(node.args[0]), rule.arguments(node)) != UNKNOWN):
            return _number_reduction(node, rule.name, rebuild(node.args[0], change),
                              exact=typing.of(node) == typing.of(node.args[0]))
        if call_name(node) == "numpy.prod" and (made := _axis_by_axis(node, typing)) is not None:
            return rebuild(made, change)
        if call_name(node) in _REDUCING and node.args and call_name(inner := node.args[0]) == "numpy.astype":
            kind = typing.of(inner.args[0])
            if kind.is_array and kind.dtype == typing.of(inner).dtype == "float64":
                return rebuild(at(Call(node.func, [inner.args[0], *node.args[1:]], node.keywords), node), change)
        return None
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _array_property(node: Call, typing: Typing) -> AST | None:
    """The size of an array, or along an axis, or the number of its axes, which is 0 for a number."""
    given = [*node.args, *(k.value for k in node.keywords if k.arg in ("a", "axis"))]
    kind = typing.of(given[0]) if given else UNKNOWN
    if len(given) != len(node.args) + len(node.keywords) or not (kind.is_array or kind.is_number):
        return None
    if call_name(node) == "numpy.ndim" and len(given) == 1:
        return at(const(kind.rank), node)
    if call_name(node) == "numpy.ndim" or kind.is_number or not isinstance(given[0], (Name, Subscript)):
        return at(const(1), node) if kind.is_number and len(given) == 1 else None
    axis = whole_number(given[1]) if len(given) == 2 else 0
    if len(given) > 2 or axis is None or not -kind.rank <= axis < kind.rank:
        return None
    return at(attribute(given[0], "size") if len(given) == 1 else index(
        attribute(given[0], "shape"), const(axis % kind.rank)), node)


def _number_count(value: AST, kind: Type) -> AST:
    """How many of one number are not 0, which Numba counts in arrays only."""
    return call("builtins.int", value if kind.dtype == "bool" else Compare(value, [NotEq()], [const(0)]))


def _axis_by_axis(node: Call, typing: Typing) -> AST | None:
    """A product along several axes as products along each, the last first."""
    given = {str(k.arg): k.value for k in node.keywords}
    axes = axes_of(given["axis"], typing.of(node.args[0]).rank) if isinstance(given.get("axis"), Tuple) else None
    if axes is None or len(node.args) != 1:
        return None
    made = node.args[0]
    for axis in reversed(axes):
        made = at(call("numpy.prod", made, **{**given, "axis": const(axis)}), node)
    return made


def _number_reduction(node: Call, reduction: str, value: AST, exact: bool) -> AST:
    """A reduction of a number as the number; a spread is 0, or NaN where the number is not finite."""
    if reduction in SPREAD:
        return at(BinOp(value, Sub(), copy(value)), node)
    if reduction == NORM:
        return at(call("builtins.abs", value), node)
    return value if exact else at(call("builtins.float", value), node)


def _operand_as_array(node: BinOp, typing: Typing) -> AST | None:
    """The operation of an array with an array of the numbers that are spelled out."""
    sides = [node.left, node.right]
    for side, other in (sides, sides[::-1]):
        if isinstance(node.op, (Add, Mult)) and isinstance(side, (List, Tuple)) and typing.of(other).is_array and (
                typing.of(node).is_array):
            made = at(call("numpy.array", side), side)
            return at(BinOp(*((made, node.op, other) if side is node.left else (other, node.op, made))), node)
    return None


def _comparison_as_array(node: Compare, typing: Typing) -> AST | None:
    """The comparison of an array with an array of the numbers that are spelled out."""
    if len(node.ops) > 1 or isinstance(node.ops[0], (In, Is, IsNot, NotIn)):
        return None
    sides = [node.left, node.comparators[0]]
    if not any(isinstance(s, (List, Tuple)) for s in sides):
        return None
    if any(typing.of(s).is_number for s in sides):
        typing.report.error("S201", "a number is compared with a list or tuple that is spelled out", node,
                            help="make it an array: np.array([...])")
    if not any(typing.of(s).is_array for s in sides):
        return None
    left, right = (at(call("numpy.array", s), s) if isinstance(s, (List, Tuple)) else s for s in sides)
    return at(Compare(left, node.ops, [right]), node)


def _shape_slice(node: Subscript, typing: Typing) -> AST | None:
    """A slice of a shape, of constant bounds, as a tuple of sizes."""
    shape, part = node.value, constant_slice(node.slice)
    kind = typing.of(shape.value) if shape.attr == "shape" else None
    if part is None or kind is None or not kind.is_array:
        return None
    return at(tuple_of(*(index(copy(shape), const(k)) for k in range(kind.rank)[part])), node)


def _number_reshape(node: Call, number: AST, typing: Typing) -> AST:
    """A number as an array with axes; without them it is the number."""
    if typing.of(node).is_number:
        return number
    return at(Call(node.func, [call("numpy.atleast_1d", number), *node.args[1:]], node.keywords), node)


def _vector_reshape(node: Call, typing: Typing) -> AST | None:
    """A reshape of a vector to a column, a row or a vector as a view by subscripts."""
    if len(node.args) != 2 or node.keywords or not isinstance(node.args[0], (Name, Subscript)):
        return None
    operand, shape = node.args
    kind = typing.of(operand)
    sizes = [whole_number(s) for s in (shape.elts if isinstance(shape, Tuple) else [shape])]
    whole = Slice(None, None, None)
    spread = {(-1,): [whole], (-1, 1): [whole, const(None)], (1, -1): [const(None), whole]}.get(tuple(sizes))
    return at(index(operand, *spread), node) if spread and kind.is_array and kind.rank == 1 else None


def _reversed_axes(node: Call, typing: Typing) -> AST | None:
    """A flip of a named array or of a part of it as the view by subscripts that it is."""
    given = {"axis": const(None), **{str(k.arg): k.value for k in node.keywords}}
    operand = node.args[0] if len(node.args) == 1 else None
    if not isinstance(operand, (Name, Subscript)) or len(given) > 1 or not (kind := typing.of(operand)).is_array:
        return None
    if isinstance(operand, Subscript) and not (isinstance(operand.value, Name) and all(
            constant_slice(Slice(None, None, s.step)) if isinstance(s, Slice) else typing.of(s).is_number
            for s in indices(operand))):
        return None     # what picks elements gives a copy, and a part by a step that is not known has no parts
    axes = range(kind.rank) if is_none(given["axis"]) else axes_of(given["axis"], kind.rank)
    if axes is None:
        return None
    backwards, whole = Slice(None, None, const(-1)), Slice(None, None, None)
    return at(index(operand, *(copy(backwards if k in axes else whole) for k in range(kind.rank))), node)


def _item(node: Call, kind: Type, parts: list[AST]) -> AST | None:
    """The one element of an array, or that with a number in row-major order."""
    if node.keywords or len(parts) > 2 or not (kind.is_array or kind.is_number):
        return None
    value, *places = parts
    if places and kind.rank > 1:
        places = _unraveled(value, places[0], kind.rank)
    return at(index(value, *(places or [const(0)] * kind.rank)), node) if kind.is_array else value


def _unraveled(array: AST, place: AST, rank: int) -> list[AST]:
    """The subscripts of an element by its number in row-major order; one below 0 counts from the end."""
    sizes = [index(attribute(copy(array), "shape"), const(k)) for k in range(rank)]
    found: list[AST] = []
    for k in range(rank):
        below = reduce(mult, map(copy, sizes[k + 1:])) if k + 1 < rank else None
        part = copy(place) if below is None else BinOp(copy(place), FloorDiv(), below)
        found.append(BinOp(part, Mod(), sizes[k]) if k else part)
    return found
