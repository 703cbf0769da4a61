"""literal_concatenation: tuples and lists that are put together where they are written are written out.

    def f(x, n: int64):                         def f(x, n):
        u = np.zeros((n,) * 2)                      u = np.zeros((n, n))
        v = np.zeros((n,) + (2, 3))                 v = np.zeros((n, 2, 3))
        w = np.array([1.0] + [0.5] * n)             w = np.concatenate(([1.0], np.full(n, 0.5)))
        z = np.zeros((*x.shape, 2))                 z = np.zeros(x.shape + (2,))
        z[:, 0] = x + w[0] + u[0] + v[:, 0, 0]      z[:, 0] = x + w[0] + u[0] + v[:, 0, 0]
        return np.sum(z)                            return np.sum(z)

    def f(x, c):
        z = (c, *x)
        return z[0]

refused: a star before what is not known to be a tuple

*Requires* resolved names. *Establishes* that items which are written stand in one tuple or list, where they are added,
or repeated as often as a number says that is written; and that no tuple has a star: it stands before what the text
shows to be a tuple, for of an array it would take in the elements.
"""
from __future__ import annotations

from functools import reduce

from s2sad.evaluate.effects import bindings
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, FunctionDef, List, Load, Mult, Name, Slice, Starred, Subscript, Tuple,
    UnaryOp, at, call, call_name, copy, expr, indices, rebuild, tuple_of, walk, with_body,
)

_ARRAYS = ("numpy.array", "numpy.asarray")
_MOST = 4096    # items that are written out


def literal_concatenation(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with such tuples; a star before anything else goes into the report."""
    bound: dict[str, list[AST]] = {}
    for target, value in bindings(function):
        for n in walk(target):
            if isinstance(n, Name):
                bound.setdefault(n.id, []).append(value if n is target else n)

    def change(node: AST) -> AST | None:
        if call_name(node) in _ARRAYS and len(node.args) == 1 and (made := _filled(node)) is not None:
            return rebuild(at(made, node), change)
        if call_name(node) in _ARRAYS and len(node.args) == 1 and isinstance(node.args[0], BinOp) and (
                given := items_of(node.args[0], List, True)):
            return rebuild(at(Call(node.func, [List(given, Load())], node.keywords), node), change)
        for kind in (Tuple, List):
            if isinstance(node, BinOp) and (items := items_of(node, kind)) is not None and not any(
                    isinstance(i, Starred) for i in items):
                return at(kind([rebuild(item, change) for item in items], Load()), node)
        if not isinstance(node, Tuple) or not isinstance(node.ctx, Load):
            return None
        stars = [i.value for i in node.elts if isinstance(i, Starred)]
        for value in stars:
            if not _is_tuple(value, bound, set()):
                scope.refuse(value, "a star before what is not known to be a tuple", help="write its elements out, or "
                             "join arrays: np.concatenate(([a], x))")
        return rebuild(at(_summed(node.elts), node), change) if stars else None
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def items_of(node: AST, kind: type, copied: bool = False) -> list[AST] | None:
    """The items of lists or tuples that are added and repeated: `[a] * 2 + [b]`; what is `copied` at once need be no
    one object. None for what is no such sum, and for what would be long."""
    if isinstance(node, kind):
        return node.elts
    if isinstance(node, BinOp) and isinstance(node.op, Add):
        right = items_of(node.right, kind, copied)      # of a sum of numbers the short side
        left = None if right is None else items_of(node.left, kind, copied)
        return None if left is None or right is None else [*left, *right]
    if isinstance(node, BinOp) and isinstance(node.op, Mult) and isinstance(node.right, Constant) and _count(
            node) <= _MOST:
        left = items_of(node.left, kind, copied)
        one = left is not None and (all(map(_is_one, left)) or copied and not any(
            isinstance(n, Call) for n in walk(left)))
        return None if left is None or type(node.right.value) is not int or not one else [
            copy(item) for _ in range(node.right.value) for item in left]
    return None


def _count(node: AST) -> int:
    """How many items a display has where what it repeats is written out."""
    if isinstance(node, (Tuple, List)):
        return sum(map(_count, node.elts))
    if isinstance(node, BinOp) and isinstance(node.op, Add):
        return _count(node.left) + _count(node.right)
    if isinstance(node, BinOp) and isinstance(node.op, Mult) and isinstance(node.right, Constant):
        return _count(node.left) * (node.right.value if type(node.right.value) is int else 1)
    return 1


def _filled(node: Call) -> AST | None:
    """An array of a list of which a number is repeated, as often as a variable says."""
    parts = _added(node.args[0])
    sizes = [_sizes(part) for part in parts]
    if not any(s is not None and any(not isinstance(c, Constant) for c in s[1]) for s in sizes):
        return None
    made = [part if s is None else call("numpy.full", tuple_of(*s[1]) if len(s[1]) > 1 else s[1][0], s[0])
            for part, s in zip(parts, sizes)]
    if len(made) == 1:
        return Call(made[0].func, made[0].args, node.keywords)
    return None if node.keywords or not all(isinstance(p, List) or s for p, s in zip(parts, sizes)) else call(
        "numpy.concatenate", tuple_of(*made))


def _added(node: AST) -> list[AST]:
    return [*_added(node.left), *_added(node.right)] if isinstance(node, BinOp) and isinstance(node.op, Add) else [node]


def _sizes(node: AST) -> tuple[AST, list[AST]] | None:
    """The number that a list of one repeats, and how often along each axis: `[[0.0] * n] * m`."""
    if not isinstance(node, BinOp) or not isinstance(node.op, Mult) or not isinstance(
            node.left, List) or len(node.left.elts) != 1:
        return None
    item = node.left.elts[0]
    inner = _sizes(item)
    if inner is not None:
        return inner[0], [node.right, *inner[1]]
    number = item.operand if isinstance(item, UnaryOp) else item
    return (item, [node.right]) if isinstance(number, Constant) and isinstance(number.value, (int, float)) else None


def _is_one(item: AST) -> bool:
    """Whether an expression stands for one object or number however often it is written."""
    if all(isinstance(n, (Constant, BinOp, UnaryOp)) or not isinstance(n, expr) for n in walk(item)):
        return True     # a number that is written, 1 / 9 too
    return isinstance(item, (Name, Subscript, Attribute)) and all(
        not isinstance(n, Call) and (not isinstance(n, Subscript) or all(map(_is_written, indices(n))))
        for n in walk(item))


def _is_written(place: AST) -> bool:
    """Whether a subscript is a number or a slice: a name may be an array, which picks a copy each time."""
    return isinstance(place, (Constant, Slice)) or isinstance(place, UnaryOp) and isinstance(place.operand, Constant)


def _is_tuple(value: AST, bound: dict[str, list[AST]], seen: set[str]) -> bool:
    """Whether a value is a tuple for certain, as far as the text shows it."""
    if isinstance(value, (Tuple, List)):
        return True
    if isinstance(value, Attribute):
        return value.attr == "shape"
    if isinstance(value, Subscript):
        return isinstance(value.slice, Slice) and _is_tuple(value.value, bound, seen)
    if isinstance(value, BinOp) and isinstance(value.op, (Add, Mult)):
        sides = (value.left, value.right) if isinstance(value.op, Add) else (value.left,)
        return all(_is_tuple(side, bound, seen) for side in sides)
    if not isinstance(value, Name) or value.id in seen:
        return False
    return value.id in bound and all(_is_tuple(v, bound, {*seen, value.id}) for v in bound[value.id])


def _summed(items: list[AST]) -> AST:
    """A tuple's items as a sum of the tuples it takes in and of those between."""
    parts: list[AST] = []
    plain: list[AST] = []
    for item in items:
        if isinstance(item, Starred):
            parts += [*([tuple_of(*plain)] if plain else []), item.value]
            plain = []
        else:
            plain.append(item)
    return reduce(lambda a, b: BinOp(a, Add(), b), [*parts, *([tuple_of(*plain)] if plain else [])])
