"""reduction_loops: sums, means and extremes as loops.

    s[...] = np.sum(a, axis=1)      for i in range(a.shape[0]):
                                        row_total = 0.0
                                        for j in range(a.shape[1]):
                                            row_total += a[i, j]
                                        s[i] = row_total
    m = np.max(x)                   place = 0
                                    for i in range(1, x.shape[0]):
                                        if x[i] > x[place] or x[i] != x[i]:
                                            place = i
                                    m = x[place]

An extreme is the element found: what is recorded of it is its place, and a nan is found as NumPy finds it.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad import rules
from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE, axes_of, is_true
from s2sad.infer.shapes import Shapes
from s2sad.infer.types import INT, Type
from s2sad.normalize.loops.element_of import Elements
from s2sad.normalize.shape_guards import has_elements
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BoolOp, Call, Div, Gt, If, Lt, Mult, Name, NotEq, Or, Slice, Subscript, add,
    assign, augment, call, call_name, compare, const, copy, counted_for, index, name, names, walk,
)

_SUMS = {"numpy.sum", "numpy.mean"}
_EXTREMES = {"numpy.max": Gt, "numpy.amax": Gt, "numpy.min": Lt, "numpy.amin": Lt}
_PRODUCTS = ("numpy.matmul", "numpy.dot")
_BLOCK = 128


def is_reduction(node: AST) -> bool:
    """Whether an expression is a reduction that has a form of loops."""
    return call_name(node) in {*_SUMS, *_EXTREMES}


class Reductions:
    """Reductions of one function; `counters(n)` makes loop counters, `number(wanted, type)` another new number."""

    def __init__(self, typing: Typing, shapes: Shapes, elements: Elements, counters: Callable[[int], list[str]],
                 number: Callable[[str, Type], str]):
        self.typing, self.shapes, self.elements = typing, shapes, elements
        self.counters, self.number = counters, number

    def bounds(self, operand: AST) -> list[AST]:
        """The sizes of an expression's axes."""
        if isinstance(operand, Name):
            return [self.elements.size_of(operand, k) for k in range(self.typing.of(operand).rank)]
        found = self.shapes.of(operand)
        if None in found:               # a bound of a slice is bound more than once: what it is here
            found = self.shapes.at_statement(operand).of(operand)
        return [self.shapes.expression(d) for d in found if d is not None]

    # -- sums of everything ------------------------------------------------------------------------------------------

    def total(self, target: str, operand: AST, kind: Type) -> list[AST]:
        """The sum of all elements of an expression."""
        number = kind if kind.is_inexact else INT
        start = assign(target, _zero(number))
        sizes = self.bounds(operand)
        if len(sizes) == 1 and isinstance(operand, Name):
            return [start, self._blocked(target, operand, number, sizes[0])]
        counters = self.counters(len(sizes))
        element = self.elements.element(operand, list(map(name, counters)))
        part = self.number("row_total", number)
        row = [assign(part, _zero(number)),
               counted_for(counters[-1], [sizes[-1]], [augment(part, Add(), element)]),
               augment(target, Add(), name(part))]
        return [start, *(row if len(sizes) == 1 else [_nest(counters[:-1], sizes[:-1], row)])]

    def _blocked(self, target: str, operand: Name, number: Type, size: AST) -> AST:
        """A vector summed in blocks."""
        start, counter = self.number("start", INT), self.counters(1)[0]
        part = self.number("row_total", number)
        stop = call("builtins.min", add(name(start), const(_BLOCK)), copy(size))
        inner = counted_for(counter, [name(start), stop], [
            augment(part, Add(), self.elements.element(operand, [name(counter)]))])
        return counted_for(start, [const(0), size, const(_BLOCK)], [
            assign(part, _zero(number)), inner, augment(target, Add(), name(part))])

    # -- products ----------------------------------------------------------------------------------------------------

    def is_whole_product(self, node: AST) -> bool:
        """Whether an expression is a product of vectors or matrices of integers or bools."""
        return call_name(node) in _PRODUCTS and isinstance(node, Call) and not any(
            self.typing.of(a).is_inexact for a in node.args)

    def whole_product(self, target: AST, node: AST) -> list[AST]:
        """The loops that bind or fill the target with such a product; of bools it says whether there is one."""
        assert isinstance(node, Call)
        a, b = node.args
        left, right = self.bounds(a), self.bounds(b)
        counters = self.counters(len(left) + len(right) - 1)
        rows, columns, inner = counters[:len(left) - 1], counters[len(left) - 1:-1], counters[-1]
        factors = [self.elements.element(a, list(map(name, [*rows, inner]))),
                   self.elements.element(b, list(map(name, [inner, *columns])))]
        part = self.number("row_total", INT)
        total: AST = name(part)
        if all(self.typing.of(o).dtype == "bool" for o in (a, b)):
            factors, total = [call("builtins.int", f) for f in factors], compare(total, Gt(), const(0))
        cell = index(target.value, *map(name, [*rows, *columns])) if isinstance(target, Subscript) and (
            self.typing.of(target).is_array) else target
        body = [assign(part, const(0)),
                counted_for(inner, [left[-1]], [augment(part, Add(), BinOp(factors[0], Mult(), factors[1]))]),
                assign(cell, total)]
        sizes = [*left[:-1], *right[1:]]
        return [_nest([*rows, *columns], sizes, body)] if sizes else body

    def thin_product(self, target: AST, node: AST,
                     filled: Callable[[Assign | AugAssign, Subscript, AST], list[AST]]) -> list[AST] | None:
        """The loops that store a column times a row, or a row times a matrix, which fuse with those around them; None
        for any other product of matrices. `filled` makes those of an elementwise statement."""
        if call_name(node) not in _PRODUCTS or not isinstance(node, Call) or not isinstance(
                target, Subscript) or base_name(target) in names(node):
            return None
        a, b = node.args
        if self.typing.of(a).rank != 2 or self.typing.of(b).rank != 2:
            return None
        (rows, inner), (also, columns) = self.shapes.of(a), self.shapes.of(b)
        if inner is None or not self.shapes.are_equal(inner, also):
            return None
        if inner == ONE:
            product = BinOp(a, Mult(), b)
            return filled(assign(target, product), target, product)
        if rows != ONE or columns == ONE or not isinstance(a, Name) or not isinstance(b, Name):
            return None
        row = name(self.counters(1)[0])
        part = BinOp(index(a, const(0), row), Mult(), index(b, row))
        return [*filled(assign(target, const(0.0)), target, const(0.0)), counted_for(
            row.id, [self.elements.size_of(a, 1)], filled(augment(target, Add(), part), target, part))]

    # -- along axes --------------------------------------------------------------------------------------------------

    def statements(self, target: AST, node: AST) -> list[AST]:
        """The loops that bind or fill the target with a reduction."""
        assert isinstance(node, Call)
        rule = rules.find_array(call_name(node))
        assert rule is not None
        arguments = rule.arguments(node)
        operand = arguments["x"]
        rank = self.typing.of(operand).rank
        axes = axes_of(arguments["axis"], rank) or ()
        sizes, counters = self.bounds(operand), self.counters(rank)
        kept = [k for k in range(rank) if k not in axes]
        if not self.typing.of(target).is_array:
            cell: AST = target
        else:
            assert isinstance(target, Subscript)
            places = [name(counters[k]) if k in kept else const(0) for k in range(rank)] \
                if is_true(arguments["keepdims"]) else [name(counters[k]) for k in kept]
            cell = index(target.value, *places)
        if call_name(node) in _EXTREMES:
            return self.extreme(cell, operand, axes, kept, sizes, counters, _EXTREMES[call_name(node) or ""])
        return self.sum(cell, operand, axes, kept, sizes, counters, call_name(node) == "numpy.mean")

    def sum(self, cell: AST, operand: AST, axes: tuple[int, ...], kept: list[int], sizes: list[AST],
            counters: list[str], mean: bool) -> list[AST]:
        element = self.elements.element(operand, list(map(name, counters)))
        number = Type("number", self.typing.of(operand).dtype)
        number = number if number.is_inexact else INT
        divided = self._count([sizes[k] for k in axes]) if mean else None
        if kept and max(kept) > min(axes):
            # the rows stay the innermost loop: the sums grow side by side
            def over(walked: list[int], statement: AST) -> AST:
                return _nest([counters[k] for k in walked], [sizes[k] for k in walked], [statement])

            clear = over(kept, assign(copy(cell), _zero(number)))
            loops = over([*axes, *kept], augment(copy(cell), Add(), element))
            if divided is None:
                return [clear, loops]
            return [clear, loops, over(kept, assign(copy(cell), BinOp(copy(cell), Div(), divided)))]
        part = self.number("row_total", number)
        total: AST = name(part) if divided is None else BinOp(name(part), Div(), divided)
        inner = _nest([counters[k] for k in axes], [sizes[k] for k in axes], [augment(part, Add(), element)])
        body = [assign(part, _zero(number)), inner, assign(cell, total)]
        return [_nest([counters[k] for k in kept], [sizes[k] for k in kept], body)] if kept else body

    def _count(self, sizes: list[AST]) -> AST:
        made = copy(sizes[0])
        for size in sizes[1:]:
            made = BinOp(made, Mult(), copy(size))
        return made

    def extreme(self, cell: AST, operand: AST, axes: tuple[int, ...], kept: list[int], sizes: list[AST],
                counters: list[str], order: type) -> list[AST]:
        found = {k: self.number("place", INT) for k in axes}
        here = self.elements.element(operand, list(map(name, counters)))
        best = self.elements.element(operand, [name(found.get(k, c)) for k, c in enumerate(counters)])
        better = BoolOp(Or(), [compare(here, order(), best), compare(copy(here), NotEq(), copy(here))])
        taken = If(better, [assign(found[k], name(counters[k])) for k in axes], [])
        search = _nest([counters[k] for k in axes], [sizes[k] for k in axes], [taken])
        body = [*(assign(found[k], const(0)) for k in axes), search, assign(cell, copy(best))]
        guards = [has_elements([sizes[k] for k in axes])] if self._may_be_empty(operand, axes) else []
        return [*guards, *([_nest([counters[k] for k in kept], [sizes[k] for k in kept], body)] if kept else body)]

    def _may_be_empty(self, operand: AST, axes: tuple[int, ...]) -> bool:
        """Whether the first element of an operand may be none although its array has it: what is outside of an array
        is known from its sizes (`analyze/index_bounds.py`), where these are affine."""
        found = self.shapes.of(operand)
        sizes = [self.shapes.expression(d) for k in axes if (d := found[k]) is not None]
        return any(isinstance(n, Slice) for n in walk(operand)) or any(
            isinstance(n, Call) for size in sizes for n in walk(size))


def _zero(number: Type) -> AST:
    return const(0.0 if number.is_inexact else 0)


def _nest(counters: list[str], sizes: list[AST], body: list[AST]) -> AST:
    for counter, size in reversed(list(zip(counters, sizes))):
        body = [counted_for(counter, [copy(size)], body)]
    return body[0]
