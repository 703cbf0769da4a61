"""list_allocation: the arrays in place of lists are allocated.

    def f(x, n):                            def f(x, n):
        rows = []                               rows = np.empty((len(range(n)), x.shape[0]))
        for k in range(n):                      rows_count = 0
            rows.append(x[:] * k)               for k in range(n):
        return rows[0][1] + rows[-1][0]             rows[k] = x[:] * k
                                                    rows_count += 1
                                                return rows[element(0, len(rows))][1] + rows[element(-1, rows_count)][0]

Requires structured form and types; establishes that no array has the type of a list. The sizes of a row are those of an
array in what is stored first, which must be bound where the list is made, itself or, as a name that is bound anew in a
loop, another array of these sizes; or they follow from what is bound there (`RowShapes`):

    rows.append(x[i:i + 2] * 1.0)               (2,)
    rows.append(np.roll(f[q], 1, axis=0))       f.shape[1:]
    rows.append(x[i * m:(i + 1) * m])           (m,)        the same in the first iteration and in the second
    rows.append(x[:i])                          None

A row of other sizes is an error when it is stored. A list holds arrays themselves, not copies: where one is stored
into, it is a view or refused (`lists_of_views`).
"""
from __future__ import annotations

from collections.abc import Callable, Set

from s2sad import rules
from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report
from s2sad.infer.affine import Affine
from s2sad.infer.list_arrays import RESERVE, grows, has_list_arrays, is_list_allocation, list_arrays, stored_list
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import Shapes, bare_shapes
from s2sad.infer.signatures.laws import Shape, whole_number
from s2sad.naming import Names
from s2sad.normalize.array_anf import named_arrays
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.normalize.context import NormalContext
from s2sad.normalize.library.expand import expanded, is_composed
from s2sad.normalize.lists.list_contents import memory_with_lists
from s2sad.normalize.lists.list_elements import element_types
from s2sad.normalize.lists.lists_of_views import lists_of_views
from s2sad.tree import (
    AST, Assign, Call, Constant, Expr, For, FunctionDef, List, Name, Slice, Store, Subscript, Tuple, add, assign, at,
    attribute, call, call_name, children, const, copy, equal, index, indices, name, rebuild, times_bound,
    tuple_of, walk, with_body,
)

_KEEPING = ("numpy.cumsum", "numpy.cumprod", "numpy.sort")     # of the sizes of their argument, if it has as many axes
_SHAPED = ("numpy.zeros", "numpy.ones", "numpy.empty", "numpy.full")


def list_allocation(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those allocations; refuses lists whose rows have no known sizes."""
    typing, program, writes, report = context.typing, context.program, context.written, context.report
    if not has_list_arrays(function):
        return function
    memory = memory_with_lists(function, program)
    context.lists = frozenset(list_arrays(function))
    element_types(function, typing, writes, report)
    function = lists_of_views(function, typing, memory, writes, report)
    pass_ = _ListAllocation(function, typing, report)
    growing = {n for n, made in list_arrays(function).items() if grows(made)}
    return rebuild(with_reserves(function, growing), pass_.change)


def with_reserves(function: FunctionDef, growing: Set[str]) -> FunctionDef:
    """The function in which arrays that double make room before what is appended.

        us[us_count] = v        reserve(us, us_count)
                                us[us_count] = v
    """
    def block(statements: list[AST]) -> list[AST]:
        return [new for s in statements for new in (*reserve(s), with_blocks(s, block))]

    def reserve(statement: AST) -> list[AST]:
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Subscript) and isinstance(target.value, Name) and isinstance(
                target.slice, Name) and target.value.id in growing:
            return [at(Expr(call(RESERVE, name(target.value.id), copy(target.slice))), statement)]
        return []
    return with_body(function, block(function.body)) if growing else function


class _ListAllocation:
    def __init__(self, function: FunctionDef, typing: Typing, report: Report):
        self.function, self.typing, self.report = function, typing, report
        nodes = list(walk(function.body))
        self.order = {id(n): k for k, n in enumerate(nodes)}
        self.bound = [s for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
        self.made = list_arrays(function)
        self.computed = RowShapes(function, typing)
        self.stores = [s for s in nodes if isinstance(s, Assign) and stored_list(s.targets[0], self.made)]

    def change(self, node: AST) -> AST | None:
        if not is_list_allocation(node):
            return None
        listed, kind = node.targets[0].id, self.typing.of(node.targets[0])
        count = node.value.args[0]
        first = self.first_stored(listed)
        sizes = None if first is None else self.sizes(first, kind.rank - 1, node, 0)
        if sizes is None and first is not None and self.typing.of(first).rank == kind.rank - 1:
            sizes = self.computed.of(first, lambda n: self.is_bound(n, node))
        if sizes is None:
            self.report.error("S201", f"the sizes of the rows of {listed!r} are not known where the list is made", node,
                              help="allocate an array before and fill it in a for loop")
            return copy(node)
        shape = tuple_of(copy(count), *sizes) if sizes else copy(count)
        return at(assign(listed, call("numpy.empty", shape, *dtype_of(kind))), node)

    def sizes(self, value: AST, rank: int, place: AST, depth: int) -> list[AST] | None:
        """The sizes of an expression with so many axes, from an array in it that is bound before a statement."""
        if rank == 0:
            return []
        if depth > 8 or self.typing.of(value).rank != rank:
            return None
        if isinstance(value, Name) and value.id in self.made:
            return self.of_list(value.id, rank, place, depth)
        if call_name(value) == "numpy.array" and isinstance(value.args[0], (List, Tuple)):
            return list(map(const, literal_shape(value.args[0])))
        if call_name(value) == "numpy.stack" and isinstance(value.args[0], (List, Tuple)) and value.args[0].elts and [
                whole_number(k.value) for k in value.keywords] == [0]:
            inner = self.sizes(value.args[0].elts[0], rank - 1, place, depth + 1)
            return None if inner is None else [const(len(value.args[0].elts)), *inner]
        if call_name(value) == "numpy.transpose" and len(value.args) == 1:
            inner = self.sizes(value.args[0], rank, place, depth + 1)
            return None if inner is None else inner[::-1]
        if call_name(value) == "numpy.linalg.solve":
            return self.sizes(value.args[1], rank, place, depth + 1)
        if isinstance(value, (Name, Subscript)):
            return self.of_part(value, rank, place, depth)
        if call_name(value) in _SHAPED:
            shape = value.args[0]
            parts = list(shape.elts) if isinstance(shape, Tuple) else [shape]
            return list(map(copy, parts)) if len(parts) == rank and self.is_bound(shape, place) and all(
                self.typing.of(p).is_number for p in parts) else None
        rule = rules.find_array(call_name(value))
        if rule is not None and rule.law != "same" and rule.name not in _KEEPING:
            return self.of_product(value, rank, place, depth) if rule.law in ("matmul", "dot") else None
        for child in children(value):
            if self.typing.of(child).is_array and (found := self.sizes(child, rank, place, depth)) is not None:
                return found
        return None

    def of_list(self, listed: str, rank: int, place: AST, depth: int) -> list[AST] | None:
        """The sizes of a list that is full, whose count is the same in the first trip of a loop and in the second."""
        count = self.made[listed].value.args[0]
        lengths = [self.computed.substituted(count, lambda n: self.is_bound(n, place), trip, False) for trip in (0, 1)]
        row = self.first_stored(listed) if rank > 1 else None
        rows = [] if rank == 1 else None if row is None else self.sizes(row, rank - 1, place, depth + 1)
        known = equal(*lengths) and self.is_bound(lengths[0], place)
        return [lengths[0], *rows] if known and rows is not None else None

    def first_stored(self, listed: str) -> AST | None:
        return next((s.value for s in self.stores if stored_list(s.targets[0], [listed])), None)

    def of_product(self, value: AST, rank: int, place: AST, depth: int) -> list[AST] | None:
        """The sizes of a product of matrices and vectors: the rows of the first, the columns of the second."""
        made: list[AST] = []
        for operand, axis in zip(value.args, (0, -1)):
            inner = self.typing.of(operand).rank
            found = self.sizes(operand, inner, place, depth + 1) if inner == 2 else []
            if found is None or inner > 2:
                return None
            made += [found[axis]] if found else []
        return made if len(made) == rank else None

    def of_part(self, value: AST, rank: int, place: AST, depth: int) -> list[AST] | None:
        base = value.value if isinstance(value, Subscript) else value
        subscripts = indices(value) if isinstance(value, Subscript) else []
        if not isinstance(base, Name):
            return None
        if isinstance(value, Subscript) and base.id in self.made and isinstance(subscripts[0], Slice):
            return self.sizes(base, rank, place, depth + 1)
        if any(isinstance(s, (Slice, Constant)) and getattr(s, "value", None) in (None, Ellipsis) or self.typing.of(
                s).is_array or self.typing.of(s).kind == "unknown" for s in subscripts):
            return None
        if self.is_bound(base, place) or not subscripts and self.has_array_before(base.id, place):
            return [index(attribute(base, "shape"), const(len(subscripts) + k)) for k in range(rank)]
        made = [s.value for s in self.bound if s.targets[0].id == base.id]
        return self.sizes(made[0], rank, place, depth + 1) if made and not subscripts else None

    def has_array_before(self, identifier: str, place: AST) -> bool:
        """Whether a name is bound to an array before a statement, which a row that it is bound to later has to fit."""
        return any(isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id == identifier
                   and self.order[id(s)] < self.order[id(place)] for s in self.function.body)

    def is_bound(self, node: AST, place: AST) -> bool:
        """Whether all names of an expression are bound before a statement, each once."""
        parameters = {p.id for p in self.function.args.args}
        for n in walk(node):
            if isinstance(n, Name) and "." not in n.id:
                stores = [m for m in walk(self.function.body) if isinstance(m, Name) and m.id == n.id
                          and isinstance(m.ctx, Store)]
                early = n.id in parameters or stores and all(self.order[id(m)] < self.order[id(place)] for m in stores)
                if not early or len(stores) > 1:
                    return False
        return True


_MADE = ("numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full")
_PLAIN = {"builtins.len", "builtins.range", "builtins.min", "builtins.max", "runtime.position", "runtime.position_down"}
_DEEPEST = 8

IsBound = Callable[[AST], bool]     # whether all that an expression reads is bound where the list is made


class RowShapes:
    """The sizes of the arrays of one function, over what `is_bound` says of."""

    def __init__(self, function: FunctionDef, typing: Typing):
        self.function = function
        self.initial = self.typing = typing.copy(Report(typing.report.source))
        nodes = list(walk(function.body))
        self.bound = {s.targets[0].id: s.value for s in reversed(nodes) if isinstance(s, Assign)
                      and isinstance(s.targets[0], Name)}
        self.times = times_bound(function.body)
        self.starts = {s.target.id: s.iter.args[0] if len(s.iter.args) > 1 else const(0)
                       for s in nodes if isinstance(s, For) and isinstance(s.target, Name)}

    def of(self, value: AST, is_bound: IsBound) -> list[AST] | None:
        """The sizes of an array; None if they are not known, or change."""
        found = [self.shape(value, is_bound, trip) for trip in (0, 1)]
        if not found[0] or found[0] != found[1]:
            return None
        return [self.shapes.extent(d) for d in found[0] if d is not None]

    def shape(self, value: AST, is_bound: IsBound, trip: int) -> Shape:
        """The shape in a loop's first trip, or in the second; () if it is not known."""
        self.typing = self.initial.copy()
        self.shapes = _SliceShapes(bare_shapes(self.function, self.typing))
        plain = self.substituted(value, is_bound, trip, False)
        if any(is_composed(n, self.typing) for n in walk(plain)):
            return self.of_expansion(plain, is_bound)
        found = self.shapes.of(self.substituted(value, is_bound, trip))
        known = all(d is not None and all(self.is_plain(self.shapes.atoms[s], is_bound) for s, _ in d.terms)
                    for d in found)
        return found if known and len(found) == self.typing.of(value).rank else ()

    def of_expansion(self, value: AST, is_bound: IsBound) -> Shape:
        """The shape of the result of a function that is expanded."""
        free = Names({n.id for n in walk(self.function) if isinstance(n, Name)})
        row = self.typing.declare(free.fresh("row"), self.typing.of(value))
        alone = copy(self.function)
        alone.body = [assign(row, value)]
        made = expanded(named_arrays(alone, self.typing, free), self.typing, free, self.typing.report)
        if self.typing.report.found or any(is_composed(n, self.typing) for n in walk(made)):
            return ()
        alone.body = [*self.function.body, *made.body]
        inner = RowShapes(alone, self.typing)
        found = inner.shape(name(row), is_bound, 0)
        self.shapes = inner.shapes
        return found

    def is_plain(self, size: AST, is_bound: IsBound) -> bool:
        return is_bound(size) and all(call_name(n) in _PLAIN for n in walk(size) if isinstance(n, Call))

    def substituted(self, value: AST, is_bound: IsBound, trip: int, named: bool = True, depth: int = 0) -> AST:
        """The expression over what is bound; an array that is allocated has a name of its own, of a shape that is
        known, if `named`."""
        def inner(node: AST) -> AST:
            return self.substituted(node, is_bound, trip, named, depth + 1)

        def change(node: AST) -> AST | None:
            if isinstance(node, Name) and "." not in node.id and not is_bound(node) and depth < _DEEPEST:
                if node.id in self.starts and self.times[node.id] == 1:
                    return add(inner(self.starts[node.id]), const(trip)) if trip else inner(self.starts[node.id])
                again = self.typing.of(node).is_number and self.times[node.id] > 1
                return inner(self.bound[node.id]) if node.id in self.bound and not again else None
            if named and call_name(node) in _MADE and isinstance(node, Call):
                return self.named(node, self.shapes.requested(inner(node.args[0])))
            if named and call_name(node) == "numpy.array" and isinstance(node, Call) and isinstance(
                    node.args[0], (List, Tuple)):
                return self.named(node, tuple(Affine((), n) for n in literal_shape(node.args[0])))
            return None
        return rebuild(value, change)

    def named(self, node: AST, shape: Shape | None) -> AST:
        """A name for an array of such a shape."""
        held = f"made {len(self.shapes.arrays)}"
        self.typing.declare(held, kind := self.typing.of(node))
        self.shapes.arrays[held] = shape if shape is not None else (None,) * kind.rank
        return name(held)


class _SliceShapes(Shapes):
    """Shapes where slices are taken to lie inside their arrays."""

    def __init__(self, shapes: Shapes):
        super().__init__(shapes.typing, shapes.values)
        self.guarded, self.several, self.counters = shapes.guarded, shapes.several, shapes.counters

    def is_ordered(self, part: Slice) -> bool:
        return True

    def clamped(self, function: str, node: AST, size: Affine) -> Affine | None:
        form = self.size(node)
        if form is None or function != "runtime.position":
            return None
        ends = bool(form.terms) and all(c < 0 for _, c in form.terms)
        return size.plus(form) if ends else form


def literal_shape(node: AST) -> list[int]:
    """The sizes of the array that nested lists spell."""
    if not isinstance(node, (List, Tuple)):
        return []
    return [len(node.elts), *(literal_shape(node.elts[0]) if node.elts else [])]
