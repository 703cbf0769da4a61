"""iteration_spaces: sizes of arrays and bounds of loops as affine forms over a function's parameters.

    w = np.empty((max(u.shape[0] - 2, 0), n))       range(w.shape[0]) runs as often as range(1, u.shape[0] - 1)
    assert u.shape == v.shape                       u.shape[1] is v.shape[1]

Only arrays and numbers that are bound once, outside of loops and branches, have a form other than their own symbol.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from types import MappingProxyType

from s2sad.infer.affine import Affine, combined
from s2sad.optimize.loop_bounds import substitute_symbol
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, BinOp, Compare, Constant, Eq, FunctionDef, Name, Subscript, Tuple, USub,
    UnaryOp, call_name, times_bound, walk_statements,
)

Size = tuple[str, int]
SHAPED = {"numpy.empty", "numpy.zeros"}
_LIKE = {"numpy.empty_like", "numpy.zeros_like"}
_NEW = {*SHAPED, *_LIKE, "numpy.copy", "numpy.matmul", "runtime.sized"}


class IterationSpaces:
    """The sizes that a function's own statements define; `assume` adds what an assertion on the way states. `writing`
    are the functions that write arrays; `shadows` has of each shadow the primal, which is of its size."""

    def __init__(self, function: FunctionDef, writing: Set[str] = frozenset(),
                 shadows: Mapping[str, str] = MappingProxyType({})):
        self.writing = writing
        bound = times_bound(function.body)
        parameters = {p.id for p in function.args.args}
        self.fixed = {p for p in parameters if not bound[p]}
        self.numbers: dict[str, AST] = {}
        self.shapes: dict[str, list[AST]] = {}
        self.like = {s: p for s, p in shadows.items() if {s, p} <= self.fixed}
        self.equal: dict[str, Affine] = {}
        made: dict[str, bool] = {}      # whether a name is bound to new arrays alone
        for n in walk_statements(function.body):
            if isinstance(n, Assign) and isinstance(target := n.targets[0], Name):
                new = call_name(n.value) in _NEW or isinstance(n.value, BinOp)
                made[target.id] = new and made.get(target.id, True)
        self.own = (parameters & self.fixed) | {n for n, new in made.items() if new}
        for statement in function.body:
            if isinstance(statement, Assign) and isinstance(target := statement.targets[0], Name) and bound[
                    target.id] - (target.id in parameters) == 1 and target.id not in parameters:
                self.fixed.add(target.id)
                self._define(target.id, statement.value)

    def _define(self, identifier: str, value: AST) -> None:
        called = call_name(value)
        if called in SHAPED:
            self.shapes[identifier] = sizes_of_shape(value.args[0])
        elif called == "runtime.sized":
            self.shapes[identifier] = sizes_of_shape(value.args[1])
        elif called in _LIKE and isinstance(value.args[0], Name):
            self.like[identifier] = value.args[0].id
        else:
            self.numbers[identifier] = value

    def assume(self, statement: AST) -> None:
        """Adds the equalities of sizes that an assertion states."""
        if not isinstance(statement, Assert) or not isinstance(test := statement.test, Compare) or len(
                test.ops) != 1 or not isinstance(test.ops[0], Eq):
            return
        left, right = test.left, test.comparators[0]
        if _is_shape(left) and _is_shape(right):
            for axis in range(8):
                self._equate(self.size(left.value.id, axis), self.size(right.value.id, axis))
        else:
            self._equate(self.form(left), self.form(right))

    def _equate(self, left: Affine | None, right: Affine | None) -> None:
        """Makes two forms equal: one symbol of their difference is substituted."""
        if left is None or right is None:
            return
        rest = left.plus(right, -1)
        for symbol, coefficient in reversed(rest.terms):
            if coefficient in (1, -1):
                known = rest.plus(Affine.symbol(symbol), -coefficient).times(-coefficient)
                self.equal = {s: substitute_symbol(f, symbol, known) for s, f in self.equal.items()}
                self.equal[symbol] = known
                return

    def form(self, node: AST, clipped: bool = False) -> Affine | None:
        """The affine form of an integer; `clipped` for the stop of a range, where negative numbers count as 0."""
        if isinstance(node, Constant):
            return Affine((), node.value) if type(node.value) is int else None
        if isinstance(node, Name):
            known = self.form(self.numbers[node.id], clipped) if node.id in self.numbers else None
            if known is not None:
                return known
            return self._symbol(node.id) if node.id in self.fixed else None
        if isinstance(node, Subscript) and _is_shape(node.value) and isinstance(node.slice, Constant):
            return self.size(node.value.value.id, node.slice.value, clipped)
        if clipped and call_name(node) == "builtins.max" and len(node.args) == 2 and isinstance(
                node.args[1], Constant) and node.args[1].value == 0:
            return self.form(node.args[0], True)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.form(node.operand)
            return None if inner is None else inner.times(-1)
        if not isinstance(node, BinOp):
            return None
        right = self.form(node.right)
        lowered = clipped and right is not None and not right.terms and (
            right.constant <= 0 if isinstance(node.op, Add) else right.constant >= 0)
        return combined(node.op, self.form(node.left, lowered), right)

    def size(self, array: str, axis: int, clipped: bool = False) -> Affine | None:
        """The form of an array's size along an axis."""
        if array not in self.fixed:
            return None
        if array in self.like:
            return self.size(self.like[array], axis, clipped)
        if array not in self.shapes:
            return self._symbol(f"{array}.shape[{axis}]")
        parts = self.shapes[array]
        if axis < len(parts) and not any(map(_is_shape, parts[:axis + 1])):
            return self.form(parts[axis], clipped)
        given = next((k for k, part in enumerate(parts) if _is_shape(part)), None)
        if given is not None and axis >= given and given == len(parts) - 1:
            return self.size(parts[given].value.id, axis - given, clipped)
        return None

    def canonical(self, form: Affine) -> Affine:
        """A form that was made before the last assumptions, in terms of them."""
        for symbol, _ in form.terms:
            form = substitute_symbol(form, symbol, self.equal[symbol]) if symbol in self.equal else form
        return form

    def are_equal(self, left: Iterable[Affine], right: Iterable[Affine]) -> bool:
        """Whether two rows of forms are equal under the assumptions so far."""
        return list(map(self.canonical, left)) == list(map(self.canonical, right))

    def _symbol(self, symbol: str) -> Affine:
        return self.equal.get(symbol, Affine.symbol(symbol))


def sizes_of_shape(shape: AST) -> list[AST]:
    """The sizes in a shape, one by one; `v.shape` in it denotes all sizes of `v`."""
    if isinstance(shape, BinOp) and _is_concatenation(shape):
        return [*sizes_of_shape(shape.left), *sizes_of_shape(shape.right)]
    return list(shape.elts) if isinstance(shape, Tuple) else [shape]


def _is_concatenation(node: AST) -> bool:
    """Whether an expression is a tuple of sizes, or a sum of such tuples; a sum of two numbers is one size."""
    if isinstance(node, BinOp):
        return isinstance(node.op, Add) and _is_concatenation(node.left) and _is_concatenation(node.right)
    return isinstance(node, Tuple) or _is_shape(node)


def _is_shape(node: AST) -> bool:
    return isinstance(node, Attribute) and node.attr == "shape" and isinstance(node.value, Name)


__all__ = ["SHAPED", "IterationSpaces", "sizes_of_shape"]
