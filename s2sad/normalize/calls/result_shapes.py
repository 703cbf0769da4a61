"""result_shapes: the sizes of what a function makes, as far as they follow from its parameters.

    n = u.size                      n: u.size
    w = np.zeros((n, 2))            w: (u.size, 2)
    r = 2.0 * u + np.sin(v)         r: u.shape
    s = lap(r)                      s: u.shape, where that is what `lap` returns of its own
"""
from __future__ import annotations

from collections.abc import Callable

import numpy

from s2sad.infer.inference import Typing
from s2sad.read.outside_values import library_value
from s2sad.rules import find_array
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Call, Constant, FunctionDef, MatMult, Name, Store, Subscript, Tuple, UnaryOp,
    attribute, call_name, const, copy, index, name, rebuild, times_bound, tuple_of, user_call, walk,
)

MAKERS = {"numpy.empty": None, "numpy.empty_like": None, "numpy.zeros": 0.0, "numpy.zeros_like": 0.0,
          "numpy.ones": 1.0, "numpy.ones_like": 1.0}
_OF_SIZES = ("builtins.len", "builtins.max", "builtins.min", "builtins.int")
_KEEPING = ("along", "same")    # the laws of functions that leave a shape as it is

Shapes = Callable[[Call], list["AST | None"]]   # of the arguments' expressions


class ResultShapes:
    """One function in structured form: `made` has the shapes of arrays of its own, for its parameters; `called` those
    of what a function of the user's returns."""

    def __init__(self, tree: FunctionDef, typing: Typing, called: Shapes):
        self.typing, self.called = typing, called
        self.bound = times_bound(tree.body)
        self.known: dict[str, AST] = {p.id: name(p.id) for p in tree.args.args}
        self.made: dict[str, AST] = {}
        for statement in tree.body:
            self.record(statement)

    def record(self, statement: AST) -> None:
        """Records what a statement binds."""
        target = statement.targets[0] if isinstance(statement, Assign) else None
        shapes = {} if target is None else self.of_value(target, statement.value)
        word = target.id if isinstance(target, Name) and self.typing.of(target).is_number else ""
        found = self.size(statement.value) if word else None
        for node in walk(statement):
            if isinstance(node, Name) and isinstance(node.ctx, Store):
                self.known.pop(node.id, None)
                self.made.pop(node.id, None)
        self.made |= {word: s for word, s in shapes.items() if s is not None and self.bound[word] == 1}
        if found is not None:
            self.known[word] = found

    def of_value(self, target: AST, value: AST) -> dict[str, AST | None]:
        """The shapes of the arrays that a value binds names to, if they are made for it."""
        if isinstance(target, Name):
            return {target.id: self.shape(value) if is_made(value) else None}
        if isinstance(target, Tuple) and user_call(value):
            shapes = map(self.shape_in_parameters, self.called(value))
            return {t.id: s for t, s in zip(target.elts, shapes) if isinstance(t, Name)}
        return {}

    def shape(self, node: AST) -> AST | None:
        """The shape of an array, of the parameters; None where it is not known."""
        if isinstance(node, Name):
            own = self.known.get(node.id)
            return copy(self.made[node.id]) if node.id in self.made else attribute(copy(own), "shape") if isinstance(
                own, Name) else None
        called = call_name(node) or ""
        if called in MAKERS:
            return self.shape(node.args[0]) if called.endswith("_like") else self.size(node.args[0])
        if called.startswith("user."):
            found = self.called(node)
            return self.shape_in_parameters(found[0]) if len(found) == 1 else None
        if (factors := _factors(node)) is not None:
            return self.shape_of_product(*factors)
        parts = _parts(node)
        whole = self.typing.argument(node)      # a part that is repeated has another shape
        found = [s for p in parts if (own := self.typing.argument(p)).rank == whole.rank and own.ones == whole.ones
                 and (s := self.shape(p)) is not None]
        return found[0] if found else None

    def shape_of_product(self, left: AST, right: AST) -> AST | None:
        """The shape of a product of matrices, or of a matrix and a vector."""
        ranks = self.typing.of(left).rank, self.typing.of(right).rank
        places = {(2, 2): ((left, 0), (right, 1)), (2, 1): ((left, 0),), (1, 2): ((right, 1),)}.get(ranks)
        sizes = [self.size(index(attribute(copy(factor), "shape"), const(axis))) for factor, axis in places or ()]
        return tuple_of(*sizes) if sizes and None not in sizes else None

    def shape_in_parameters(self, shape: AST | None) -> AST | None:
        return None if shape is None else self.size(shape)

    def size(self, node: AST) -> AST | None:
        """An integer, or a shape, of the parameters; None for anything else."""
        if isinstance(node, Constant):
            return copy(node)
        if isinstance(node, Name):
            return copy(self.known[node.id]) if node.id in self.known else None
        array = node.value if isinstance(node, Subscript) and isinstance(node.slice, Constant) else node
        if isinstance(array, Attribute):
            return self.of_array(node, array)
        if not isinstance(node, (BinOp, UnaryOp, Tuple)) and call_name(node) not in _OF_SIZES:
            return None
        parts = {id(part): self.size(part) for part in operands(node)}
        if any(part is None for part in parts.values()):
            return None
        return rebuild(node, lambda n: parts.get(id(n)))

    def of_array(self, node: AST, array: Attribute) -> AST | None:
        """The size or the shape of an array, or one of its sizes."""
        if array.attr == "size":
            own = self.known.get(array.value.id) if isinstance(array.value, Name) else None
            return attribute(copy(own), "size") if isinstance(own, Name) else None
        shape = self.shape(array.value) if array.attr == "shape" else None
        if shape is None or not isinstance(node, Subscript):
            return shape
        if isinstance(shape, Attribute):
            return rebuild(node, lambda n: shape if n is array else None)
        place = node.slice.value
        return copy(shape.elts[place]) if isinstance(shape, Tuple) and -len(shape.elts) <= place < len(
            shape.elts) else copy(shape) if place in (0, -1) and not isinstance(shape, Tuple) else None


def is_made(value: AST) -> bool:
    """Whether the array that an expression gives is no other name's."""
    called = call_name(value) or ""
    return isinstance(value, (BinOp, UnaryOp)) or called in MAKERS or called.startswith("user.") or bool(
        isinstance(value, Call) and _parts(value))


def operands(node: AST) -> list[AST]:
    if isinstance(node, BinOp):
        return [node.left, node.right]
    return [node.operand] if isinstance(node, UnaryOp) else list(node.elts if isinstance(node, Tuple) else node.args)


def _factors(node: AST) -> list[AST] | None:
    """The factors of a product of matrices."""
    if isinstance(node, BinOp):
        return operands(node) if isinstance(node.op, MatMult) else None
    return node.args if call_name(node) in ("numpy.matmul", "numpy.dot") and len(node.args) == 2 else None


def _parts(node: AST) -> list[AST]:
    """The operands whose shape the value of an expression may have."""
    if isinstance(node, (BinOp, UnaryOp)):
        return operands(node)
    called = call_name(node) or ""
    rule = find_array(called) if called else None
    if rule is not None:
        return node.args[:1] if rule.law in _KEEPING else []
    function = library_value(called) if called.startswith("numpy.") else None
    elementwise = called in ("numpy.where", "numpy.copy") or isinstance(
        function, numpy.ufunc) and function.signature is None
    return list(node.args) if elementwise else []
