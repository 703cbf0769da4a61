"""Allocations in their two normal forms: `np.empty`/`np.zeros` of a shape, and the same of an array's shape.

    w = np.ones(n)                  w = np.empty(n)
                                    w[...] = 1.0
    w = np.array([a, b])            w = np.empty(2)
                                    w[0] = a
                                    w[1] = b
    w = 2.0 * u + v                 w = np.empty_like(u)
                                    w[...] = 2.0 * u + v
"""
from __future__ import annotations

from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.infer.types import Type
from s2sad.tree import (
    AST, Assign, Attribute, Call, Eq, List, Name, Subscript, Tuple, assign, attribute, call, call_name, compare, const,
    copy, dump, index, indices, name, names, tuple_of, walk,
)

_FILLS = {"numpy.ones": 1.0, "numpy.ones_like": 1.0}
_SHAPED = {"numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full"}
_LIKE = {"numpy.empty_like", "numpy.zeros_like", "numpy.ones_like", "numpy.full_like"}
_COPIES = {"numpy.copy", "numpy.array", "numpy.asarray", "numpy.ascontiguousarray"}


class Allocations:
    """Makes allocations of one function and remembers which arrays have one shape."""

    def __init__(self, typing: Typing, report: Report, bound: list[str]):
        self.typing, self.report, self.bound = typing, report, bound
        self.roots: dict[str, str] = {}

    def forget(self, array: str) -> None:
        """The array has the shape of none, from here on."""
        self.roots[array] = f"array {array} of two branches"

    def allocate(self, target: str, kind: Type, value: AST, place: AST) -> list[AST]:
        """The statements that bind `target` to a new array holding `value` (an expression with resolved views)."""
        function = call_name(value)
        args = value.args if isinstance(value, Call) else []
        if function in _SHAPED:
            return self._shaped(target, kind, function, args)
        if function in _LIKE:
            made: list[AST] = [self.empty_like(target, kind, args[0], "zeros" if "zeros" in function else "empty")]
            fill = const(_FILLS[function]) if function in _FILLS else args[1] if function == "numpy.full_like" else None
            return made + ([] if fill is None else [assign(index(name(target), const(...)), fill)])
        if function in _COPIES and isinstance(args[0], (List, Tuple)):
            return self._listed(target, kind, args[0])
        if function in _COPIES:
            value = args[0]
        model = self._model(value)
        if model is None:
            self.report.error("S201", f"an array made by {function or 'this expression'}", place,
                              help="allocate it with np.empty and write it in a loop")
            return []
        return [self.empty_like(target, kind, model, "empty"), assign(index(name(target), const(...)), value)]

    def _model(self, value: AST) -> AST | None:
        return next((n for n in walk(value) if isinstance(n, (Name, Subscript)) and self.typing.of(n).is_array), None)

    def _shaped(self, target: str, kind: Type, function: str, args: list[AST]) -> list[AST]:
        shape = tuple_of(*args[0].elts) if isinstance(args[0], List) else args[0]
        if isinstance(shape, Tuple) and len(shape.elts) == 1:
            shape = shape.elts[0]
        self.roots[target] = self._shape_root(shape, target)
        start = "numpy.zeros" if function == "numpy.zeros" else "numpy.empty"
        made: list[AST] = [assign(target, call(start, shape, *_dtype(kind)))]
        if function in _FILLS or function == "numpy.full":
            fill = const(_FILLS[function]) if function in _FILLS else args[1]
            made.append(assign(index(name(target), const(...)), fill))
        return made

    def empty_like(self, target: str, kind: Type, model: AST, start: str) -> Assign:
        """`target = np.empty_like(model)`, or by shape where the model is a row or has another dtype."""
        self.roots[target] = self._root(model)
        if isinstance(model, Name) and self.typing.of(model).dtype == kind.dtype:
            return assign(target, call(f"numpy.{start}_like", model))
        return assign(target, call(f"numpy.{start}", self.shape(model), *_dtype(kind)))

    def _listed(self, target: str, kind: Type, value: AST) -> list[AST]:
        entries: list[tuple[list[AST], AST]] = []
        sizes: list[int] = []

        def visit(node: AST, at: list[AST]) -> None:
            if isinstance(node, (List, Tuple)):
                sizes[len(at):len(at) + 1] = [len(node.elts)]
                for k, item in enumerate(node.elts):
                    visit(item, [*at, const(k)])
            else:
                entries.append((at, node))
        visit(value, [])
        shape = const(sizes[0]) if len(sizes) == 1 else tuple_of(*map(const, sizes))
        self.roots[target] = self._shape_root(shape, target)
        return [assign(target, call("numpy.empty", shape, *_dtype(kind))),
                *(assign(index(name(target), *at), item) for at, item in entries)]

    def shape(self, array: AST) -> AST:
        """The shape of an array or of a row of one, as an expression: a size or a tuple."""
        if isinstance(array, Name):
            return attribute(array, "shape")
        parts = self._sizes(array)
        return parts[0] if len(parts) == 1 else tuple_of(*parts)

    def _sizes(self, array: AST) -> list[AST]:
        base, done = (array.value, len(indices(array))) if isinstance(array, Subscript) else (array, 0)
        rank = self.typing.of(base).rank
        return [index(attribute(copy(base), "shape"), const(k)) for k in range(done, rank)]

    def shape_test(self, a: AST, b: AST) -> AST:
        """The test that two array expressions have one shape."""
        if isinstance(a, Name) and isinstance(b, Name):
            return compare(attribute(a, "shape"), Eq(), attribute(b, "shape"))
        left, right = self._sizes(a), self._sizes(b)
        if len(left) == 1:
            return compare(left[0], Eq(), right[0])
        return compare(tuple_of(*left), Eq(), tuple_of(*right))

    def same_shape(self, a: AST, b: AST) -> bool:
        """Whether two array expressions are known to have one shape."""
        return self._root(a) == self._root(b)

    def _root(self, node: AST) -> str:
        if isinstance(node, Name):
            return self.roots.get(node.id, f"array {node.id}")
        assert isinstance(node, Subscript)
        return f"row {len(indices(node))} of {self._root(node.value)}"

    def _shape_root(self, shape: AST, target: str) -> str:
        if isinstance(shape, Attribute) and shape.attr == "shape":
            return self._root(shape.value)
        stable = all(self.bound.count(n) <= 1 for n in names(shape))
        return f"shape {dump(shape)}" if stable else f"array {target}"


def _dtype(kind: Type) -> list[AST]:
    return [] if kind.dtype == "float64" else [name(f"numpy.{kind.dtype}" if kind.dtype != "bool" else "numpy.bool_")]
