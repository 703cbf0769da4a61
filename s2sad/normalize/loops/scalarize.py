"""scalarize: whole-array statements become loops over their elements, for the engine that compiles loops.

Requires resolved views and functions of whole arrays that stand alone; establishes that every store and every load is
of one element, but for the functions that have no such form (a matrix product), which stay, or, where the text is to
be run (`final`), fill an array of their own whose elements are then copied.

    def f(u, du, dt):                   def f(u, du, dt):
        u[1:-1] += dt * du[1:-1]            assert max(u.shape[0] - 2, 0) == max(du.shape[0] - 2, 0)
        return 0.5 * np.sum(u ** 2)         for i in range(1, u.shape[0] - 1):
                                                u[i] += dt * du[i]
                                            return 0.5 * np.sum(u ** 2)

A sum runs in blocks of one row, so that its error grows with the length of a row and the number of rows.
"""
from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from s2sad.blocks import with_blocks
from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.promotion import CASTS
from s2sad.infer.shapes import Shapes, started_shapes, shape_expression
from s2sad.infer.slice_extents import scattered
from s2sad.infer.types import INT, Type
from s2sad.naming import Names
from s2sad.normalize.buffers.allocations import array_operands, dtype_of
from s2sad.normalize.loops.element_of import Elements, moves
from s2sad.normalize.array_anf import is_function, multiplies_part
from s2sad.normalize.shape_guards import same_element_count
from s2sad.normalize.loops.reduction_loops import Reductions, is_reduction
from s2sad.normalize.buffers.compose_subscripts import is_new
from s2sad.passes import Context
from s2sad.rules.operation import operation
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Call, FloorDiv, For, FunctionDef, If, Name, Return, Slice, Subscript, While,
    add, assign, at, augment, call, call_name, const, copy, counted_for, index, indices, mult, name, names, rebuild,
    sub, user_call, walk, with_body,
)


@dataclass
class IndexedPart:
    """A part of an array in loops: the counters with the bounds of their loops, the element, its position in the
    part on each axis; `taken` counts what a mask has selected, in the loops from `first` to `masked`."""
    counters: list[str]
    bounds: list[list[AST]]
    cell: AST
    positions: list[AST]
    taken_count: str = ""
    first: int = 0
    masked: int = 0

    def add(self, bounds: list[list[AST]], counters: Callable[[int, int], list[str]]) -> list[AST]:
        """New loops inside the others; their counters."""
        made = counters(len(bounds), len(self.counters))
        self.counters += made
        self.bounds += bounds
        return list(map(name, made))

    def loops_around(self, body: list[AST], test: AST | None = None, counted: bool = False) -> list[AST]:
        """The loops around statements; inside those of a mask its `test`, where elements are counted if `counted`."""
        for k in range(len(self.counters), 0, -1):
            if test is not None and k == self.masked:
                body = [If(test, [*body, augment(self.taken_count, Add(), const(1))] if counted else body, [])]
            body = [counted_for(self.counters[k - 1], self.bounds[k - 1], body)]
            if counted and k - 1 == self.first:
                body = [assign(self.taken_count, const(0)), *body]
        return body


_LOOPED = ("numpy.where", "numpy.heaviside", "scipy.")  # what compiled code has of numbers alone, or is slow in


def scalarize(function: FunctionDef, context: Context) -> FunctionDef:
    """The function without whole-array statements, as it is differentiated."""
    return _scalarized(function, context, False)


def scalarize_final(function: FunctionDef, context: Context) -> FunctionDef:
    """The function without whole-array statements, as it is run.

        def f(a: "float64[:, :]"):
            return np.linalg.det(a)

    Of its adjoint

        def f_adjoint(a, a_bar, result_bar):
            ...
            a_bar[...] += det_value_bar * cofactors_value

    becomes

        def f_adjoint(a, a_bar, result_bar):
            ...
            for i in range(a_bar.shape[0]):
                for j in range(a_bar.shape[1]):
                    a_bar[i, j] += det_value_bar * cofactors_value[i, j]
    """
    return _scalarized(function, context, True, shadows=getattr(context, "shadows", ()))


def scatter(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with loops for the stores through arrays of integers alone.

        def f(x: "float64[:]", k: "int64[:]", y: "float64[:]"):     def f(x, k, y):
            y[k] = x                                                    assert k.shape[0] == x.shape[0]
                                                                        for i in range(x.shape[0]):
                                                                            y[k[i]] = x[i]

    Where two stores are to the same element, the last one counts.
    """
    return _scalarized(function, context, False, only=True)


def _scalarized(function: FunctionDef, context: Context, final: bool, only: bool = False,
                shadows: Collection[str] = ()) -> FunctionDef:
    """The table of types gains the new counters."""
    shapes = started_shapes(function, context.typing)
    scalarizing = Scalarize(context.typing, context.names, shapes, final, only, shadows)
    return with_body(function, scalarizing.block(function.body))


class Scalarize:
    """The pass over one function; to `shadows` sums are added in any order."""

    def __init__(self, typing: Typing, free: Names, shapes: Shapes, final: bool, only: bool = False,
                 shadows: Collection[str] = ()):
        self.typing, self.free, self.shapes, self.final, self.only = typing, free, shapes, final, only
        self.shadows = shadows
        self.elements = Elements(typing, shapes)
        self.reduced = Reductions(typing, shapes, self.elements, self.counters, self.number)

    def block(self, block: list[AST]) -> list[AST]:
        new: list[AST] = []
        known = dict(self.shapes.equal)
        for statement in block:
            self.shapes.serial += 1
            new += [at(made, statement) if getattr(statement, "lineno", None) else made
                    for made in self.statement(statement)]
            self.shapes.note_statement(statement)
        self.shapes.equal = known
        return new

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, If, While)):
            self.shapes.forget(statement)
            return [with_blocks(statement, self.block)]
        if isinstance(statement, (Assign, AugAssign)):
            return self.store(statement)
        if isinstance(statement, Return) and statement.value is not None and not self.only and (
                not self.final or any(map(self.is_looped, walk(statement.value)))):
            before: list[AST] = []
            value = self.sums(statement.value, before, joined=not self.final)
            return [*before, Return(value)]
        return [statement]

    def is_looped(self, node: AST) -> bool:
        """Whether compiled code needs, or does better with, loops in place of a call."""
        called = call_name(node) or ""
        return called.startswith(_LOOPED) or called in CASTS and isinstance(node, Call) and len(
            node.args) == 1 and self.typing.of(node.args[0]).is_array

    def store(self, statement: Assign | AugAssign) -> list[AST]:
        value = statement.value
        target = statement.targets[0] if isinstance(statement, Assign) else statement.target
        if user_call(value) or self.only and not scattered(target, self.typing):
            return [statement]
        if is_function(value) and not moves(value):
            return self.function(statement, target)
        if isinstance(target, Subscript) and isinstance(value, Subscript) and self.mask_of(value) is not None and \
                self.mask_of(target) is None:
            return self.masked_fill(target, value)
        before = self.reshape_guards(value)
        value = self.sums(value, before)
        if self.typing.of(value).is_array or isinstance(target, Subscript) and self.typing.of(target).is_array:
            value = self.named_properties(value, before)
        if isinstance(target, Subscript) and self.typing.of(target).is_array:
            held = self.named_loads(value, base_name(target), before)
            places = self.named_loads(self.named_properties(target.slice, before), base_name(target), before)
            place = at(Subscript(target.value, places, target.ctx), target)
            return before + self.filled(statement, place, held)
        if isinstance(target, Name) and isinstance(statement, Assign) and (made := self.allocated(target, value)):
            return before + [made, *self.filled(statement, index(name(target.id), const(...)), value)]
        if not before:
            return [statement]
        return before + [assign(target, value) if isinstance(statement, Assign)
                         else augment(target, statement.op, value)]

    def reshape_guards(self, value: AST) -> list[AST]:
        """The guards that what is reshaped has as many elements as the shape; NumPy itself looks, loops do not."""
        found = [self.shapes.numbers_of_elements(self.shapes.of(n.args[0]), self.shapes.of(n)) for n in walk(value)
                 if isinstance(n, Call) and call_name(n) == "numpy.reshape"]
        return [same_element_count(*both) for both in found if both is not None]

    def function(self, statement: Assign | AugAssign, target: AST) -> list[AST]:
        """A function of whole arrays that does more than move elements."""
        value = statement.value
        if is_reduction(value) and isinstance(statement, Assign):
            return self.reduced.statements(target, value)
        if self.reduced.is_whole_product(value) and isinstance(statement, Assign):
            return self.reduced.whole_product(target, value)
        thin = self.reduced.thin_product(target, value, self.filled) if isinstance(statement, Assign) else None
        if thin is not None:
            return thin
        if not self.final or isinstance(target, Name):
            return [statement]
        if isinstance(statement, AugAssign) and isinstance(target, Subscript) and self.gains_from_part(target, value):
            return self.part_product(statement, target, *value.args)
        wanted = f"{(call_name(value) or '').rpartition('.')[2]}_value"
        made = self.typing.declare(self.free.fresh(wanted), self.typing.of(value))
        return [assign(made, copy(value)), *self.filled(statement, target, name(made))]

    def gains_from_part(self, target: Subscript, value: AST) -> bool:
        """Whether a shadow gains the product of a part of a matrix and a vector."""
        return base_name(target) in self.shadows and multiplies_part(value, self.typing) and self.typing.of(
            target).dtype == "float64" and self.mask_of(target) is None and base_name(target) not in names(value)

    def part_product(self, statement: AugAssign, target: Subscript, matrix: AST, vector: AST) -> list[AST]:
        """The loops that add such a product."""
        found, column = self.indexed_part(target), self.counters(1)[0]
        total = self.number("row_total", Type("number", "float64"))
        factors = [self.elements.element(matrix, [*found.positions, name(column)]),
                   self.elements.element(vector, [name(column)])]
        row = counted_for(column, self.reduced.bounds(vector), [augment(total, Add(), mult(*factors))])
        return found.loops_around([assign(total, const(0.0)), row, augment(found.cell, statement.op, name(total))])

    def allocated(self, target: Name, value: AST) -> AST | None:
        """The allocation of a name for the value of an elementwise expression of arrays, None for any other value."""
        kind, shape = self.typing.of(value), self.shapes.of(value)
        if isinstance(value, (Name, Subscript)) or operation(value) is None or not shape or None in shape:
            return None
        self.typing.declare(target.id, kind)
        made = assign(target.id, call("numpy.empty", shape_expression(self.shapes, shape), *dtype_of(kind)))
        self.shapes.allocated(target.id, shape)
        return made

    def filled(self, statement: Assign | AugAssign, target: Subscript, value: AST) -> list[AST]:
        """The loops that store an elementwise expression."""
        found = self.indexed_part(target)
        inner = self.elements.element(value, found.positions)
        body: list[AST] = [assign(found.cell, inner) if isinstance(statement, Assign)
                           else augment(found.cell, statement.op, inner)]
        mask = self.mask_of(target)
        if mask is None:
            return found.loops_around(body)
        counted = any(isinstance(n, Name) and n.id == found.taken_count for n in walk(inner))
        return found.loops_around(body, self.mask_element(mask), counted)

    def masked_fill(self, target: Subscript, value: Subscript) -> list[AST]:
        """An array filled with what a mask selects, one element after the other."""
        source, mask = self.indexed_part(value), self.mask_of(value)
        assert mask is not None
        store = assign(self.elements.element(target.value, source.positions), source.cell)
        return source.loops_around([store], self.mask_element(mask), counted=True)

    def mask_element(self, mask: Name) -> AST:
        """The element of the mask where the loops stand."""
        return index(mask, *map(copy, self.elements.walked[mask.id]))

    def mask_of(self, place: Subscript) -> Name | None:
        """The array of bools that picks elements, if there is one."""
        return next((s for s in indices(place) if isinstance(s, Name) and self.typing.of(s).is_array
                     and self.typing.of(s).dtype == "bool"), None)

    def indexed_part(self, target: Subscript) -> IndexedPart:
        """How a part of an array is indexed in loops."""
        base = target.value
        assert isinstance(base, Name)
        found = IndexedPart([], [], index(base), [])
        self.elements.walked = {}
        cell: list[AST] = []
        picked: list[AST] | None = None
        for entry in self.shapes.full(indices(target), self.typing.of(base).rank):
            kind = None if isinstance(entry, Slice) else self.typing.of(entry)
            if is_new(entry):
                found.positions.append(const(0))
            elif isinstance(entry, Slice):
                self.sliced(found, base.id, cell, entry)
            elif kind is None or not kind.is_array:
                cell.append(copy(entry))
            elif kind.dtype == "bool":
                found.first = len(found.counters)
                counters = found.add([[self.elements.size_of(entry, k)] for k in range(kind.rank)], self.counters)
                self.elements.walked = {entry.id: counters}
                cell += map(copy, counters)
                found.masked = len(found.counters)
                found.taken_count = self.number("taken", INT)
                found.positions.append(name(found.taken_count))
            else:
                if picked is None:
                    sizes = [self.shapes.expression(d) for d in self.shapes.gathered(target) if d is not None]
                    picked = found.add([[size] for size in sizes], self.counters)
                    found.positions += picked
                cell.append(self.elements.element(entry, picked[len(picked) - kind.rank:]))
        found.cell = index(name(base.id), *cell)
        return found

    def sliced(self, found: IndexedPart, base: str, cell: list[AST], entry: Slice) -> None:
        """One axis of which a slice is walked: by the index itself where the step is 1."""
        size = self.shapes.own_symbol(base, len(cell))
        span = self.shapes.for_slice(entry, size).span(entry, size)
        assert span is not None, "the bounds of a slice are names and numbers"
        start, stop, step = span
        low, high = (self.shapes.expression(x, reduced=False) for x in (start, stop))
        zero = not start.terms and not start.constant
        if not isinstance(step, int):       # the counter counts: its steps are written numbers
            count = found.add([[self.shapes.expression(self.shapes.range_length(span))]], self.counters)[0]
            cell.append(mult(count, copy(step)) if zero else add(copy(low), mult(count, copy(step))))
            found.positions.append(count)
            return
        bounds = [high] if zero and step == 1 else [low, high] if step == 1 else [low, high, const(step)]
        counter = found.add([bounds], self.counters)[0]
        cell.append(counter)
        at_zero = sub(copy(low), counter) if step == -1 else counter if zero else sub(counter, copy(low))
        found.positions.append(at_zero if abs(step) == 1 else BinOp(at_zero, FloorDiv(), const(step)))

    def counters(self, rank: int, first: int = 0) -> list[str]:
        return [self.number(c, INT) for c in ("i", "j", "k", "l", "m", "o")[first:first + rank]]

    def number(self, wanted: str, kind: Type) -> str:
        """A new name for a number."""
        made = self.typing.declare(self.free.fresh(wanted), kind)
        self.shapes.values = {**self.shapes.values, made: None}
        return made

    def named_loads(self, value: AST, array: str, before: list[AST]) -> AST:
        """A value or a subscript with names for the elements that it loads of the array that is filled: they are loaded
        before the loop."""
        def change(n: AST) -> AST | None:
            if isinstance(n, Subscript) and base_name(n) == array and self.typing.of(n).is_number:
                made = self.number(f"{array}_held", self.typing.of(n))
                before.append(assign(made, copy(n)))
                return name(made)
            return None
        return rebuild(value, change)

    def sums(self, value: AST, before: list[AST], joined: bool = False) -> AST:
        """The value with its sums named before; where `joined` only those that join arrays of different shapes."""
        def change(n: AST) -> AST | None:
            if call_name(n) == "numpy.sum" and not is_function(n) and not (joined and self.has_one_shape(n.args[0])):
                operand = self.sums(n.args[0], before)
                kind = self.typing.of(n)
                total = self.number("total", kind if kind.is_inexact else INT)
                before.extend(self.reduced.total(total, operand, kind))
                return name(total)
            return None
        return rebuild(value, change)

    def named_properties(self, value: AST, before: list[AST]) -> AST:
        """The value with names for properties of whole arrays, `np.any(m)`, which no element has."""
        def change(n: AST) -> AST | None:
            if not isinstance(n, Call) or not self.typing.of(n).is_number or not any(
                    self.typing.of(a).is_array for a in n.args) or call_name(n) == "builtins.len":
                return None
            made = self.number("asked", self.typing.of(n))
            before.append(assign(made, copy(n)))
            return name(made)
        return rebuild(value, change)

    def has_one_shape(self, node: AST) -> bool:
        """Whether all arrays of an expression have its own shape, and none is picked from."""
        whole = self.shapes.of(node)
        return all(self.shapes.of(part) == whole and not scattered(part, self.typing)
                   for part in array_operands(node, self.typing))
