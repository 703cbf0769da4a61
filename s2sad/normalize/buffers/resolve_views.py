"""resolve_views: every array reference names its base array and all of its subscripts.

Requires structured form and types; establishes that an array name is bound once on each path, by an allocation, and
that no name is bound to a part of another array. What a view's index was when it was bound is frozen. Names of tuples
go too.

    def f(x, y, i: int):                def f(x, y, i):
        row = x[i, 1:-1]                    y[...] = 0.0
        y[:] = 0.0                          assert max(y.shape[0] - 2, 0) == max(x.shape[1] - 4, 0)
        y[2:] += row[2:] * x[i, 0]          y[2:] += x[i, 3:-1] * x[i, 0]
        w = row.copy()                      w = np.empty(y.shape[0])
        return w[0] * y[1]                  w[...] = x[i, 1:-1]
                                            return w[0] * y[1]
"""
from __future__ import annotations

from collections.abc import Callable, Sequence, Set

from s2sad import rules
from s2sad.liveness import base_name, read_names
from s2sad.infer.signatures.laws import ONE, Shape
from s2sad.infer.shapes import Shapes, single_values
from s2sad.infer.slice_extents import scattered
from s2sad.infer.types import array
from s2sad.infer.list_arrays import RESERVE, stored_list
from s2sad.normalize.buffers.allocations import loaded
from s2sad.normalize.buffers.may_alias import Aliases
from s2sad.normalize.buffers.store_hazards import overlaps
from s2sad.normalize.buffers.late_bindings import LateBinding, allocated_before, late_sizes
from s2sad.normalize.buffers.loop_carried import LoopCarried
from s2sad.normalize.buffers.access_paths import AMBIGUOUS, AccessPath, is_whole_place
from s2sad.normalize.buffers.resized_buffers import Axes, ResizingError
from s2sad.normalize.context import NormalContext
from s2sad.normalize.shape_guards import shapes_equal, same_size_in_list
from s2sad.normalize.loops.reduction_loops import is_reduction
from s2sad.normalize.buffers.may_alias import UpcomingUses
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, Call, Expr, For, FunctionDef, If, Name, Return, Slice, Store,
    Subscript, Tuple, While, assign, at, attribute, augment, call_name, const, copy, index, indices, is_unset, name,
    names, rebuild, tuple_of, user_call, walk, walk_statements, with_body,
)

Writes = Callable[[Call], Sequence[int]]


def resolve_views(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with views resolved; refuses what cannot be. It begins anew where it finds that an array changes its
    size, or must be there before a loop."""
    resized: dict[str, Axes] = {}
    taken, said = set(context.names.taken), len(context.report.found)
    while True:
        typing = context.typing.copy()
        try:
            return _resolved(function, context, resized)
        except ResizingError as error:
            resized = {**resized, error.identifier: error.axes}
        except LateBinding as late:
            function = allocated_before(function, late.sizes, typing.table)
            del context.report.found[said:]
        context.typing = typing
        context.names.release(*context.names.taken - taken)


def _resolved(function: FunctionDef, context: NormalContext, resized: dict[str, Axes]) -> FunctionDef:
    typing, free, report = context.typing, context.names, context.report
    bound = [p.id for p in function.args.args]
    bound += [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    shapes = Shapes(typing, single_values(function))
    pass_ = _ResolveViews(typing.table, typing, free, report, bound, shapes)
    pass_.paths = {p.id: (p.id, ()) for p in function.args.args if typing.table[p.id].is_array}
    pass_.parameters = set(pass_.paths)
    pass_.loops, pass_.writes, pass_.lists = context.in_loops, context.written, context.lists
    pass_.bound_at, pass_.unset, pass_.late_allocated, pass_.buffers, pass_.stored_in_loop = {}, set(), {}, {}, set()
    pass_.at_breaks, pass_.resized, pass_.refilled = [], resized, []
    pass_.growing = {n.args[0].id for n in walk(function.body) if call_name(n) == RESERVE}
    pass_.reserved, pass_.bound_shapes = set(), {}
    pass_.uses, pass_.aliases = UpcomingUses(function), Aliases(pass_.parameters)
    new = with_body(function, function.body)
    lengths = [shapes_equal(index(attribute(name(p.id), "shape"), const(k)), const(1))
               for p in function.args.args for k in typing.ones.get(p.id, ())]
    new.body = [*(at(test, function) for test in lengths), *pass_.block(function.body)]
    if late := late_sizes(function, sorted(pass_.ambiguous), pass_.bound_shapes, shapes):
        raise LateBinding(late)
    context.shared = pass_.aliases.check(report)
    context.guarded |= _asserts(new) > _asserts(function)
    return new


def _asserts(function: FunctionDef) -> int:
    return sum(isinstance(n, Assert) for n in walk_statements(function.body))


class _ResolveViews(LoopCarried):
    """Rewrites the statements of one function."""
    writes: Writes
    lists: Set[str]
    growing: Set[str]                   # the names of lists whose arrays double
    bound_shapes: dict[str, list[Shape]]                # of what loops bind names to

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, Assign):
            return self.assignment(statement)
        if isinstance(statement, AugAssign):
            return self.augmented(statement)
        if isinstance(statement, If):
            return self.branch(statement)
        if isinstance(statement, (For, While)):
            return self.loop(statement)
        if isinstance(statement, Expr):
            return self.effect(statement)
        if isinstance(statement, Return) and statement.value is not None:
            before, value = self.returned(statement.value)
            return [*before, Return(value)]
        return [self.resolve(statement)]

    def assignment(self, statement: Assign) -> list[AST]:
        target, value = statement.targets[0], statement.value
        if isinstance(target, Subscript):
            return self.store(target, value, statement)
        if isinstance(target, Tuple) or self.types.get(target.id, None) is None:
            return [assign(target, self.resolved_call(value, statement))]
        kind = self.types[target.id]
        if is_unset(value):
            self.unset |= {target.id} if kind.is_array else set()
            return [] if kind.is_array else [assign(target, const(value.value))]
        if kind.kind == "tuple" and call_name(value) is None:
            self.tuples[target.id] = self.resolve(value)
            self.refuse_changing_tuple(self.tuples[target.id], statement)
            return []
        if not kind.is_array:
            return [assign(target, self.number(target.id, self.resolved_call(value, statement)))]
        self.bound_at[target.id] = statement
        made = self.bind_array(target.id, value, statement)
        self.note_shape(target.id)
        return made

    def note_shape(self, identifier: str) -> None:
        """Notes the shape of what a name is bound to in a loop."""
        base, subscripts = self.paths.get(identifier, AMBIGUOUS)
        if self.depth and base:
            needed = list(self.shapes.required)
            array_ = index(name(base), *map(copy, subscripts)) if subscripts else name(base)
            shape = tuple(d and self.shapes.reduced(d) for d in self.shapes.of(array_))
            self.bound_shapes.setdefault(identifier, []).append(shape)
            self.shapes.required = needed

    def refuse_changing_tuple(self, value: AST, statement: Assign) -> None:
        """Refuses a tuple that is read later, when what it is made of may be something else."""
        parts = [n for n in walk(value) if isinstance(n, Subscript) and not isinstance(n.value, Attribute)]
        numbers = {n.id for n in walk(value) if isinstance(n, Name) and not self.typing.of(n).is_array}
        changed = any(self.bound.count(n) > 1 for n in {*numbers, statement.targets[0].id})
        if changed or any(not self.typing.of(p).is_array for p in parts):
            self.report.error("S201", f"'{statement.targets[0].id}' holds numbers that change before it is read",
                              statement, help="give each of them a name, or make it an array: np.array([...])")

    def number(self, identifier: str, value: AST) -> AST:
        """What a number is bound to; sizes are known over the resolved value, as names of arrays change."""
        if self.shapes.values.get(identifier) is not None:
            resized = self.shapes.several & {*names(value)}
            size = self.shapes.size(value) if resized else None
            self.shapes.values = {**self.shapes.values, identifier: None if resized else value}
            if size is not None:        # as long as the array has this size
                self.shapes.unify(self.shapes.symbol(name(identifier)), size)
        return value

    def resolved_call(self, value: AST, statement: AST) -> AST:
        """The value resolved; notes the arrays that a call stores into."""
        if user_call(value):
            for position in self.writes(value):
                self.note_store((self.access_path(value.args[position]) or AMBIGUOUS)[0], statement)
        return self.resolve(value)

    def note_store(self, base: str, statement: AST) -> None:
        near = self.uses.after.get(id(statement), set())
        self.aliases.note_store(base, statement, {self.paths[n][0] for n in near if n in self.paths})

    def bind_array(self, target: str, value: AST, statement: AST) -> list[AST]:
        if isinstance(value, (Name, Subscript)) and not self.is_gather(value) and self.access_path(value):
            base, prefix = self.access_path(value) or AMBIGUOUS
            self.paths[target] = (base, tuple(self.frozen(s, f"{target}_at") for s in prefix))
            return []
        if isinstance(value, Attribute) or isinstance(value, Name):
            self.report.error("S201", f"'{target}' would be a view that is not supported", statement,
                              help="copy it with np.empty and a loop")
            return []
        value = self.resolve(value)
        if self.fills_buffer(target, value, statement):
            place = index(name(self.buffers[target]), const(...))
            checks = self.allocations.store_guards(place, value)
            value = self.materialized(place, value, checks, statement)
            return [*checks, assign(place, value)]
        new = self.version(target)
        made = self.allocations.allocate(new, self.types[target], value, statement)
        self.paths[target] = (new, ())
        self.depths[new] = self.depth
        self.typing.declare(new, self.types[target])
        if target in self.growing:
            self.begin_resizing(new, frozenset((0,)))
            self.reserved.add(new)
        return made

    def is_gather(self, value: AST) -> bool:
        """Whether an expression is a copy of elements that an array picks."""
        return isinstance(value, Subscript) and (self.is_gather(value.value) or any(
            self.typing.of(s).is_array for s in indices(value) if not isinstance(s, Slice)))

    def version(self, target: str) -> str:
        if target in self.versions or target in self.parameters:
            return self.free.fresh(f"{target}_{sum(v.startswith(target) for v in self.versions) + 1}")
        self.versions.add(target)
        return target

    def augmented(self, statement: AugAssign) -> list[AST]:
        target = statement.target
        if (view := self.gathered_part(target)) is not None:
            return self.store_through_copy(target, view, statement,
                                     lambda place: augment(place, statement.op, statement.value))
        if isinstance(target, Name) and not self.typing.of(target).is_array:
            return [augment(target, statement.op, self.resolve(statement.value))]
        place = self.store_target(target)
        self.note_store(base_name(place), statement)
        value = self.resolve(statement.value)
        checks = self.allocations.store_guards(place, value) if self.is_region(place) else []
        value = self.materialized(place, value, checks, statement)
        if type(statement.op).__name__ in ("Add", "Sub"):
            return [*checks, augment(place, statement.op, value)]
        return [*checks, assign(place, BinOp(loaded(place), statement.op, value))]

    def gathered_part(self, target: AST) -> AccessPath | None:
        """What a target's array is a part of, where arrays pick elements of that part."""
        if not isinstance(target, Subscript) or not self.is_gather(target):
            return None
        view = self.access_path(target.value)
        return view if view is not None and self.gathers_from_part(target, view) else None

    def store_through_copy(self, target: Subscript, part: AccessPath, origin: AST, stored: Callable[[AST], AST]
                           ) -> list[AST]:
        """A store to elements that are picked from a part of an array: to a copy of the part, which is put back."""
        held = self.copied_part(target.value)
        made = self.statement(stored(index(name(held), *indices(target))))
        return [*made, *self.store(index(index(name(part[0]), *part[1]), const(...)), name(held), origin)]

    def store(self, target: Subscript, value: AST, statement: AST) -> list[AST]:
        if (view := self.gathered_part(target)) is not None:
            return self.store_through_copy(target, view, statement, lambda place: assign(place, value))
        place, new = self.store_target(target), self.resolve(value)
        self.note_store(base_name(place), statement)
        listed = self.is_region(place) and stored_list(target, self.lists)
        if listed:
            self.refuse_repeated_row(place, new, statement)
        checks = self.allocations.store_guards(place, new) if self.is_region(place) else []
        checks = list(map(same_size_in_list, checks)) if listed else checks
        new = self.materialized(place, new, checks, target)
        return [*checks, assign(place, new)]

    def refuse_repeated_row(self, place: Subscript, value: AST, statement: AST) -> None:
        """Refuses what would be repeated in a row of the array in place of a list: the list holds it as it is."""
        row, made = self.shapes.of(loaded(place)), self.shapes.of(value)
        if len(row) != len(made) or any(m == ONE and not self.shapes.are_equal(r, m) for r, m in zip(row, made)):
            self.report.error("S201", "an array of another size than the others is put into a list", statement,
                              help="give arrays of different sizes different names")

    def materialized(self, place: Subscript, value: AST, before: list[AST], origin: AST) -> AST:
        """The value, under a name of its own where the place cannot hold it while it is made: a loop would read what
        it has filled, or a function's derivative or loop needs its result as it is."""
        if not self.must_materialize(place, value):
            return value
        kind = self.typing.of(value)
        held = self.typing.declare(self.free.fresh(f"{base_name(place)}_next"), kind)
        if not kind.is_array:
            self.shapes.values = {**self.shapes.values, held: None}
            before.append(assign(held, value))
            return name(held)
        value = self.materialized_masks(value, before, origin)
        before += self.allocations.allocate(held, array(kind.dtype, kind.rank), value, origin)
        return name(held)

    def materialized_masks(self, value: AST, before: list[AST], origin: AST) -> AST:
        """The value with names for what masks pick: only the statement that fills what a mask picks walks the mask."""
        def change(n: AST) -> AST | None:
            if not isinstance(n, Subscript) or not any(
                    self.typing.of(s).is_array and self.typing.of(s).dtype == "bool"
                    for s in indices(n) if not isinstance(s, Slice)):
                return None
            kind = self.typing.of(n)
            held = self.typing.declare(self.free.fresh("picked"), array(kind.dtype, kind.rank))
            before.extend(self.allocations.allocate(held, self.typing.table[held], n, origin))
            return name(held)
        return rebuild(value, change)

    def must_materialize(self, place: Subscript, value: AST) -> bool:
        """Whether a value must be there before the place is filled with it."""
        if not self.is_region(place):
            return rules.find_array(call_name(value)) is not None and base_name(place) in read_names(value)
        looped = self.loops or scattered(place, self.typing)
        if self.typing.of(value).is_array and looped and overlaps(place, value, self.typing):
            return True
        if rules.find_array(call_name(value)) is None:
            return False
        filled, made = self.shapes.of(loaded(place)), self.shapes.of(value)
        spread = len(filled) != len(made) or any(m == ONE != f for f, m in zip(filled, made))
        part = looped and is_reduction(value) and not is_whole_place(place)
        return spread or part or base_name(place) in read_names(value)

    def effect(self, statement: Expr) -> list[AST]:
        value = statement.value
        if call_name(value) == RESERVE:
            return self.reserve(value.args[0], self.resolve(value.args[1]), statement)
        if isinstance(value, Call) and isinstance(value.func, Attribute):
            if value.func.attr == "fill":
                return self.store(index(value.func.value, const(...)), value.args[0], statement)
            self.report.error("S201", f"the method '{value.func.attr}'", statement, help="write it as a loop")
            return []
        return [Expr(self.resolved_call(value, statement))]

    def returned(self, value: AST) -> tuple[list[AST], AST]:
        """What is returned: numbers, and arrays by name; a part of an array, or what is only made here, gets one."""
        parts = value.elts if isinstance(value, Tuple) else [value]
        before: list[AST] = []
        new: list[AST] = []
        for part in parts:
            made = self.resolve(part)
            if self.typing.of(made).is_array and not isinstance(made, Name):
                kind = self.typing.of(made)
                held = self.typing.declare(self.free.numbered("returned"), array(kind.dtype, kind.rank))
                before += self.allocations.allocate(held, self.typing.table[held], made, part)
                made = name(held)
            new.append(made)
        return before, tuple_of(*new) if isinstance(value, Tuple) else new[0]
