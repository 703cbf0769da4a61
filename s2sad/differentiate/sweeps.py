"""sweeps: the two sweeps of an adjoint: control flow, records and restores, around the adjoints of single statements.

The forward sweep is the primal with its pushes. The reverse sweep of a block is that of its segments, last first; of a
segment: restore the elements that it overwrote, compute again what its adjoints read, then the adjoints, last first.
At the top of the block stands what later segments read as well.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping

from s2sad.blocks import with_blocks
from s2sad.liveness import base_name, targets
from s2sad.analyze.recording_plan import RecordingPlan
from s2sad.analyze.program_structure import ProgramStructure, is_simple
from s2sad.differentiate.reversed_loops import reversed_bounds
from s2sad.differentiate.trip_counters import has_break
from s2sad.differentiate.recording import Recording, whole_place
from s2sad.differentiate.reallocation import pop_sizes, push_sizes, remade
from s2sad.differentiate.tape import Stack, Tape
from s2sad.infer.shapes import Shapes
from s2sad.infer.types import INT
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Expr, For, Gt, If, Name, Return, Subscript, While, assign, at, augment, call,
    call_name, compare, const, copy, counted_for, forget, index, indices, name, sub, user_call, walk_statements,
)

Adjoint = Callable[[AST], list[AST]]


class Sweeps(Recording):
    """Both sweeps of one function, by its plan.

    `adjoint(statement)` is the adjoint of a simple statement, a whole-array statement or a call, `called(statement)`
    the first half of an adjoint in place of a call in the forward sweep;
    `zeros(block)` the shadows to initialize where the reverse of a block begins; `family` the variable of each version.
    """

    def __init__(self, structure: ProgramStructure, plan: RecordingPlan, tape: Tape, free: Names, adjoint: Adjoint,
                 zeros: Callable[[list[AST]], list[AST]], shapes: Shapes, family: Mapping[str, str], called: Adjoint):
        self.shapes = shapes
        self.structure, self.plan, self.tape, self.free = structure, plan, tape, free
        self.typing = structure.typing
        self.adjoint, self.zeros, self.family, self.called = adjoint, zeros, family, called
        self.counting = tape.counting
        self.settled: frozenset[int] = frozenset()      # what an iteration that runs again leaves out
        self.prints = False     # whether the forward sweep does what the kernel prints

    # -- forward -----------------------------------------------------------------------------------------------------

    def forward(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in block:
            made += [at(s, statement) for s in self.forward_statement(statement)]
        return made

    def forward_statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, Return) or self.is_left_out(statement):
            return []
        if isinstance(statement, (For, While)):
            return self.forward_loop(statement) + self.records(statement)
        if isinstance(statement, If):
            made: list[AST] = [If(copy(statement.test), self.forward(statement.body), self.forward(statement.orelse))]
            return made + self.records(statement)
        before = [s for store in self.stores_of(statement)
                  for s in self.tape.push(self.store_stack(store), self.content(store))]
        if id(statement) in self.plan.reallocated - self.plan.remade:
            before += push_sizes(statement, self.tape)
        return [*before, *(self.called(statement) or [copy(statement)]), *self.records(statement)]

    def is_left_out(self, statement: AST) -> bool:
        """Whether the forward sweep does without a statement: a print, or a store that nothing reads."""
        if id(statement) in self.plan.unread or id(statement) in self.settled:
            return True
        return not self.prints and isinstance(statement, Expr) and call_name(statement.value) == "builtins.print"

    def run(self, block: list[AST]) -> list[AST]:
        """The statements of a block that the forward sweep runs."""
        return [with_blocks(s, self.run) for s in block if not self.is_left_out(s)]

    def forward_loop(self, loop: AST) -> list[AST]:
        carried = [s for key, value in self.plan.recorded.items() if value.kind == "carried" and value.home is loop
                   for s in self.tape.push(self.value_stack(key, value), name(value.name))]
        carried += [s for snapshot in self.snapshots_of(loop)
                    for s in self.tape.push(self.snapshot_stack(snapshot), name(snapshot.array))]
        if id(loop) in self.plan.rerun:
            made = copy(with_blocks(loop, self.run))
            made.body = [*carried, *made.body]
            return [*self.tape.allocations.pop(id(loop), []), made]
        body = self.forward(loop.body)
        before: list[AST] = []
        after: list[AST] = []
        if id(loop) in self.plan.reversed and self.counting.is_counted_at_run_time(loop):
            trips = self.counting.count(loop)
            before = [assign(trips, const(0))]
            counted = augment(trips, Add(), const(1))
            body = [counted, *body] if has_break(loop) else [*body, counted]
            if self.counting.in_loop(loop):
                after = self.tape.push(self.trip_stack(loop), name(trips))
        body = [*carried, *body]
        made = For(loop.target, copy(loop.iter), body, [], None) if isinstance(loop, For) else \
            While(copy(loop.test), body, [])
        grown, advanced = self.tape.reserve(loop)
        return [*self.tape.allocations.pop(id(loop), []), *grown, *before, made, *advanced, *after]

    def run_again(self, loop: AST) -> list[AST]:
        """An iteration that runs again, without the stores to cells that hold what they are given."""
        self.settled = self.plan.rerun[id(loop)].settled - {id(s.statement) for s in self.plan.stores.values()}
        made = self.forward(loop.body)
        self.settled = frozenset()
        return made

    def records(self, statement: AST) -> list[AST]:
        """The pushes of the names that a statement has just bound."""
        return [s for key, value in self.plan.recorded.items()
                if value.kind != "carried" and value.home is statement
                for s in self.tape.push(self.value_stack(key, value), name(value.name))]

    # -- reverse -----------------------------------------------------------------------------------------------------

    def reverse(self, block: list[AST], loop: AST | None = None) -> list[AST]:
        """The reverse sweep of a block; `loop` if it is a loop's body, whose carried numbers come back first."""
        made: list[AST] = [at(remade(s), s) for s in block if id(s) in self.plan.remade] + self.zeros(block)
        put_back = self.tape.read if id(loop) in self.plan.rerun else self.tape.pop
        made += self.loop_carried_values(loop, put_back)
        made += [assign(self.plan.values[key].name,
                        self.tape.previous(self.store_stack(shift.store), name(shift.start)))
                 for key, shift in self.plan.shifted.items() if shift.loop is loop]
        keys = set(self.plan.early.get(id(block), []))
        keys |= {k for k, v in self.plan.recorded.items()
                 if v.kind != "carried" and self.structure.place(v.home).block == id(block)}
        if keys:
            made += self.recompute(block, keys)
        cut = self.structure.blocks.get(id(block), [])
        for number in range(len(cut) - 1, -1, -1):
            made += self.reverse_segment(cut[number], (id(block), number))
        return made

    def loop_carried_values(self, loop: AST | None, put_back: Callable[[Stack, AST], list[AST]]) -> list[AST]:
        """The numbers that a loop carries as they are where its iteration begins."""
        return [s for key, value in self.plan.recorded.items() if value.kind == "carried" and value.home is loop
                for s in put_back(self.value_stack(key, value), name(value.name))]

    def reverse_segment(self, run: list[AST], where: tuple[int, int]) -> list[AST]:
        if not is_simple(run[0], self.typing):
            return [at(s, run[0]) for s in self.reverse_compound(run[0])]
        made = self.restores(run)
        late = set(self.plan.late.get(where, []))
        return made + (self.recompute(run, late) if late else []) + self.adjoints(run)

    def restores(self, run: list[AST]) -> list[AST]:
        """Restores the elements that a segment overwrote and that are read, last first."""
        made: list[AST] = []
        for statement in reversed(run):
            if isinstance(statement, If):
                body, orelse = self.restores(statement.body), self.restores(statement.orelse)
                if body or orelse:
                    made.append(at(If(copy(statement.test), body, orelse), statement))
            for store in self.stores_of(statement):
                made += [at(s, statement) for s in self.restore(store)]
        return made

    def recompute(self, block: list[AST], keys: set[str]) -> list[AST]:
        """The bindings of these values, in the order of the text: recomputed, reloaded or popped."""
        made: list[AST] = []
        for statement in block:
            if isinstance(statement, If) and is_simple(statement, self.typing):
                body, orelse = self.recompute(statement.body, keys), self.recompute(statement.orelse, keys)
                if body or orelse:
                    made.append(at(If(copy(statement.test), body, orelse), statement))
            elif not isinstance(statement, (For, While, If)):
                made += [at(s, statement) for s in self.recompute_statement(statement, keys)]
            made += [at(s, statement) for key, value in self.plan.recorded.items()
                     if key in keys and value.home is statement
                     for s in self.tape.pop(self.value_stack(key, value), name(value.name))]
        return made

    def recompute_statement(self, statement: AST, keys: set[str]) -> list[AST]:
        bound = {t.id for t in targets(statement) if isinstance(t, Name)}
        for number in sorted(bound & keys - set(self.plan.recorded)):
            stored = self.plan.reloaded.get(number)
            if stored is not None:
                return [assign(number, copy(targets(stored)[0]))]
            return [copy(statement)]
        return []

    def adjoints(self, run: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in reversed(run):
            if isinstance(statement, If):
                body, orelse = self.adjoints(statement.body), self.adjoints(statement.orelse)
                zeros = self.zeros(statement.body), self.zeros(statement.orelse)
                if body or orelse:
                    made.append(at(If(copy(statement.test), zeros[0] + body, zeros[1] + orelse), statement))
            else:
                made += [at(s, statement) for s in self.adjoint(statement)]
        return made

    def reverse_compound(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, While)):
            return self.reverse_loop(statement) if id(statement) in self.plan.reversed else []
        if isinstance(statement, If):
            if id(statement) not in self.plan.reversed:
                return []
            return [If(copy(statement.test), self.reverse(statement.body), self.reverse(statement.orelse))]
        stores = self.stores_of(statement)
        popped = [s for store in stores for s in self.restore(store)]
        called = user_call(getattr(statement, "value", None))
        again = [s for store in stores if called
                 for s in self.tape.read(self.store_stack(store), whole_place(self.snapshot(store)))]
        if id(statement) in self.plan.reallocated - self.plan.remade:
            popped = [*pop_sizes(statement, self.tape), *popped]
        if id(statement) in self.plan.after:
            return [*self.adjoint(statement), *popped]
        return [*popped, *self.adjoint(statement), *again]

    def stored_arrays(self, loop: AST) -> list[str]:
        """The arrays that a loop stores to."""
        return sorted({base_name(t) for s in walk_statements(loop.body) if isinstance(s, (Assign, AugAssign))
                       and not self.is_left_out(s) for t in targets(s) if isinstance(t, Subscript)})

    def reverse_loop(self, loop: AST) -> list[AST]:
        before: list[AST] = []
        rerun = id(loop) in self.plan.rerun
        body = self.reverse(loop.body, loop)
        before += self.tape.release(loop)
        if rerun:
            saved = [s for snapshot in self.snapshots_of(loop) for s in self.tape.read(
                self.snapshot_stack(snapshot), index(name(snapshot.array), const(...)))]
            stored = [n for n in self.stored_arrays(loop) if n not in self.plan.rerun[id(loop)].persistent]
            body = [*([forget(stored)] if stored else []), *saved, *self.loop_carried_values(loop, self.tape.pop),
                    *self.run_again(loop), *body]
            before += self.tape.allocations.pop(id(loop), [])
        if self.counting.is_counted_at_run_time(loop) and self.counting.in_loop(loop):
            before += self.tape.pop(self.trip_stack(loop), name(self.counting.count(loop)))
        if isinstance(loop, While):
            return [*before, self.reverse_while(loop, body)]
        assert isinstance(loop, For)
        trips = name(self.counting.count(loop)) if self.counting.is_counted_at_run_time(loop) else None
        forwards = id(loop) in self.plan.forwards and not self.tape.runs_backwards(loop)
        bounds = list(map(copy, loop.iter.args)) if forwards else reversed_bounds(loop, trips)
        return [*before, counted_for(loop.target.id, bounds, body), *self.restore_snapshots(loop)]

    def restore_snapshots(self, loop: For) -> list[AST]:
        """Restores the arrays of which there are snapshots to their state before the loop."""
        made: list[AST] = []
        for snapshot in self.snapshots_of(loop):
            cell = self.tape.cell(self.snapshot_stack(snapshot))
            *outer, _ = indices(cell)
            made.append(assign(index(name(snapshot.array), const(...)), index(copy(cell.value), *outer, const(0))))
        ran = compare(call("builtins.len", copy(loop.iter)), Gt(), const(0))
        return [If(ran, made, [])] if made else []

    def reverse_while(self, loop: While, body: list[AST]) -> AST:
        """As often as the loop ran; backwards if the number of the iteration is read."""
        trips, read = name(self.counting.count(loop)), self.counting.iterations.get(id(loop))
        if read is not None:
            return counted_for(read, [sub(trips, const(1)), const(-1), const(-1)], body)
        unread = self.typing.declare(self.free.fresh("trip"), INT)
        return counted_for(unread, [trips], body)

