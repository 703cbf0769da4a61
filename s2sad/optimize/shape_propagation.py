"""shape_propagation: the size of a new array is spelled as it was allocated, and an array that is only asked for its
size is not allocated.

    def f(x: float64[:, :], w: float64[:, :]):
        return np.sum(np.exp(x) @ w)

in its adjoint:

    def f_adjoint(...):                                     def f_adjoint(...):
        ...                                                     ...
        matmul_value = np.empty((x.shape[0], w.shape[1]))
        operand_bar = np.zeros_like(operand)                    operand_bar = np.zeros_like(x)
        matmul_value_bar = np.zeros_like(matmul_value)          matmul_value_bar = np.zeros((x.shape[0], w.shape[1]))
        for i in range(matmul_value_bar.shape[0]):              for i in range(x.shape[0]):
            for j in range(matmul_value_bar.shape[1]):              for j in range(w.shape[1]):
                matmul_value_bar[i, j] += result_bar                    matmul_value_bar[i, j] += result_bar
        ...                                                     ...

*Requires* finished text in which `known_positions` and the fusion of loops have found what is equal. *Establishes* the
same values, in loops whose bounds are equal in the eyes of the compiler, too. Constant propagation, of sizes (Wegman,
Zadeck, TOPLAS 1991).
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from s2sad.blocks import with_blocks
from s2sad.optimize.iteration_spaces import SHAPED, IterationSpaces, sizes_of_shape
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assert, Assign, Attribute, Constant, For, FunctionDef, If, Name, Subscript, While, at, attribute, call,
    call_name, const, copy, index, name, names, rebuild, stored_names, tuple_of, walk, with_body,
)

CHANGES_ROUNDING = False

_LIKE = {"numpy.empty_like", "numpy.zeros_like"}
_NEW = {"numpy.empty", "numpy.zeros", *_LIKE}


def shape_propagation(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such sizes; an allocation of a size that may be negative stays, for it raises then."""
    sizes = _Sizes(function, context)
    body = sizes.block(function.body, {}, in_loop=False)
    mentions = Counter(n.id for n in walk(body) if isinstance(n, Name))
    return with_body(function, [s for s in body if not sizes.is_needless(s, mentions)])


class _Sizes:
    """How the sizes of arrays are spelled that are allocated once, where the function always passes, and, behind the
    allocation, of those that iterations allocate (`own`)."""

    def __init__(self, function: FunctionDef, context: DerivativeContext):
        self.spaces = IterationSpaces(function, context.writing)
        self.types, self.kept = context.types, context.stacks
        self.parameters = {p.id for p in function.args.args}
        self.own: Mapping[str, list[AST]] = {}

    def block(self, statements: list[AST], own: Mapping[str, list[AST]], in_loop: bool) -> list[AST]:
        """A block before which the sizes of these arrays are known."""
        made: list[AST] = []
        for statement in statements:
            bound = set(stored_names(statement))
            own = {a: parts for a, parts in own.items() if not bound & {a, *(n for p in parts for n in names(p))}}
            inside = in_loop or isinstance(statement, (For, While))
            self.own = own
            head = self.head(statement)
            made.append(with_blocks(head, lambda block, own=own, inside=inside: self.block(block, own, inside)))
            if in_loop and isinstance(head, Assign) and call_name(head.value) in SHAPED and isinstance(
                    target := head.targets[0], Name) and target.id not in names(head.value):
                own = {**own, target.id: sizes_of_shape(head.value.args[0])}
        return made

    def head(self, statement: AST) -> AST:
        """The statement with what its own expressions say of sizes; of a compound one the blocks are as they were."""
        if isinstance(statement, For):
            bounds = rebuild(statement.iter, self.replacement)
            return at(For(statement.target, bounds, statement.body, [], None), statement)
        if isinstance(statement, (If, While)):
            test = rebuild(statement.test, self.replacement)
            made = If(test, statement.body, statement.orelse) if isinstance(statement, If) else While(
                test, statement.body, [])
            return at(made, statement)
        return rebuild(statement, self.replacement)

    def replacement(self, node: AST) -> AST | None:
        """What is put in the place of `x.shape[k]`, or of a whole shape; None for all else. A guard says it in its own
        words."""
        if isinstance(node, Assert):
            return node
        if isinstance(node, Subscript) and isinstance(node.slice, Constant) and (array := _shape_of(node.value)):
            extent = self.extent(array, node.slice.value)
            return None if extent is None or _is_size(extent, array) else extent
        if call_name(node) in _LIKE and isinstance(model := node.args[0], Name) and len(node.args) == 1:
            return self.allocation(node, model.id)
        array = _shape_of(node)
        return None if array is None else self.whole(array)

    def allocation(self, like: AST, array: str) -> AST | None:
        """An allocation of the size of an array, without it."""
        model, kinds = self.model(array), [self.types.get(n) for n in (array, self.model(array))]
        if not all(k is not None and k.is_array and k.dtype == "float64" for k in kinds):
            return None
        if self.parts(model) is None:
            return None if model == array else call(call_name(like) or "", name(model))
        shape = self.whole(array)
        return None if shape is None else call((call_name(like) or "").removesuffix("_like"), shape)

    def whole(self, array: str) -> AST | None:
        """The shape as one value."""
        model = self.model(array)
        if model != array and self.parts(model) is None:
            return attribute(name(model), "shape")
        parts = [self.extent(array, k) for k in range(len(self.parts(model) or ()))]
        found = [p for p in parts if p is not None]
        return tuple_of(*found) if found and len(found) == len(parts) else None

    def model(self, array: str) -> str:
        """The first of the arrays of one size that were made after one another's."""
        while array in self.spaces.like and array in self.spaces.fixed:
            array = self.spaces.like[array]
        return array

    def extent(self, array: str, axis: int) -> AST | None:
        """The size of an axis: a constant, a fixed number, or that of an array that was not made here."""
        array = self.model(array)
        parts = self.parts(array)
        if parts is None and array not in self.spaces.fixed:
            return None
        if parts is None:
            return index(attribute(name(array), "shape"), const(axis))
        part = parts[axis] if axis < len(parts) and not any(_shape_of(p) for p in parts) else None
        if isinstance(part, Subscript) and (other := _shape_of(part.value)) and isinstance(part.slice, Constant):
            return self.extent(other, part.slice.value)
        is_number = isinstance(part, Name) and (part.id in self.spaces.fixed or array in self.own and self.is_number(
            part.id))
        return copy(part) if part is not None and (is_number or isinstance(part, Constant)) else None

    def parts(self, array: str) -> list[AST] | None:
        """The sizes of an array, as it was allocated."""
        return self.own.get(array) or (self.spaces.shapes.get(array) if array in self.spaces.fixed else None)

    def is_number(self, identifier: str) -> bool:
        return identifier not in self.types or self.types[identifier].is_number

    def is_needless(self, statement: AST, mentions: Counter[str]) -> bool:
        """Whether a statement allocates what nothing else mentions, of a size that cannot be negative."""
        return isinstance(statement, Assign) and isinstance(target := statement.targets[0], Name) and call_name(
            statement.value) in _NEW and mentions[target.id] == 1 and target.id not in self.kept and all(
            map(self.is_positive, getattr(statement.value.args[0], "elts", statement.value.args[:1])))

    def is_positive(self, size: AST) -> bool:
        """Whether a size, or the array that an allocation has the size of, is none that raises."""
        if isinstance(size, Constant):
            return type(size.value) is int and size.value >= 0
        if isinstance(size, Name):
            return size.id in self.types and self.types[size.id].is_array
        return _shape_of(size.value if isinstance(size, Subscript) else size) is not None


def _shape_of(node: AST) -> str | None:
    """The array of `x.shape`; None of anything else."""
    found = isinstance(node, Attribute) and node.attr == "shape" and isinstance(node.value, Name)
    return node.value.id if found else None


def _is_size(node: AST, array: str) -> bool:
    return isinstance(node, Subscript) and _shape_of(node.value) == array
