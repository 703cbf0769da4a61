"""loop_carried: each loop-carried array has one buffer; a rebinding of its name becomes a copy into it.

Used by `resolve_views`. Requires structured form and types; establishes that a name is bound to one array wherever
iterations join.

    v = u                           v_1 = np.empty_like(u)
    for s in range(n):              v_1[...] = u
        out = np.empty_like(v)      for s in range(n):
        ...                             out = np.empty_like(v_1)
        v = out                         ...
                                        assert v_1.shape == out.shape
                                        v_1[...] = out

A name's own array is its buffer where no other name is bound to it, and is filled where the name is bound if its old
content is not used any more. NumPy binds names and copies nothing: a store after which a copy would differ is refused
(`may_alias`).
"""
from __future__ import annotations

from collections.abc import Callable, Sequence

from s2sad.infer.signatures.laws import Shape
from s2sad.infer.shapes import least_of, shape_expression
from s2sad.infer.types import array
from s2sad.normalize.buffers.allocations import ALLOCATING, dtype_of
from s2sad.normalize.buffers.joins import merged
from s2sad.evaluate.completion import FALL, endless, completion
from s2sad.normalize.shape_guards import positive_step, slice_in_bounds
from s2sad.normalize.buffers.access_paths import AMBIGUOUS, AccessPath
from s2sad.normalize.buffers.resized_buffers import ResizedBuffers
from s2sad.normalize.single_assignment import breaks
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Break, Call, For, If, Name, Subscript, While, assign, at, call, call_name,
    copy, dump, index, name, names, stored_names, user_call, walk, walk_statements,
)

Tail = dict[str, str]                   # the buffers of a loop, by their names


class LoopCarried(ResizedBuffers):
    """The access paths of names in and after loops."""
    unset: set[str]                     # names of arrays whose flags say that they are bound before they are read
    late_allocated: dict[str, Shape | None]       # buffers of such names in the loops here, and their shapes
    writes: Callable[[Call], Sequence[int]]
    stored_in_loop: set[str]            # names whose arrays the loop here stores into
    at_breaks: list[dict[str, AccessPath]]  # the access paths of names at the breaks of the loop here

    def buffer(self, identifier: str, place: AST, origin: AST, near: set[str]) -> tuple[str, list[AST]]:
        """The buffer of a name from here on, and the statements that make it; `near` are the names used later."""
        base, subscripts = self.paths[identifier]
        if not subscripts and base in self.depths and not self.is_referenced(base, near - {identifier}, self.paths):
            return base, []
        made = self.version(identifier)
        kind = self.types[identifier]
        value = index(name(base), *map(copy, subscripts)) if subscripts else name(base)
        statements = self.allocations.allocate(made, array(kind.dtype, kind.rank), value, origin)
        self.depths[made] = self.depth
        self.typing.declare(made, kind)
        self.aliases.note_copy(base, made, True)
        return made, statements

    def fills_buffer(self, identifier: str, value: AST, statement: AST) -> bool:
        """Whether what a name is bound to may go straight into its buffer: no name that is used later is bound to what
        was there, the size is known to be the same, and no store could take the new array for
        one that the buffer may have been before."""
        buffer = self.buffers.get(identifier)
        if buffer is None or self.paths.get(identifier) != (buffer, ()) or call_name(value) in ALLOCATING:
            return False
        if identifier in self.stored_in_loop and self.aliases.is_shared(buffer):
            return False
        near = self.uses.after[id(statement)] - {identifier}
        shapes = self.shapes.of(name(buffer)), self.shapes.of(value)
        return all(map(self.shapes.are_equal, *shapes)) and not self.is_referenced(buffer, near, self.paths)

    # -- loops -------------------------------------------------------------------------------------------------------

    def loop(self, statement: For | While) -> list[AST]:
        head, after = self.uses.head[id(statement)], self.uses.after[id(statement)]
        inside = [t.id for s in walk_statements(statement.body) if isinstance(s, Assign) for t in s.targets
                  if isinstance(t, Name) and t.id in self.types and self.types[t.id].is_array]
        bounds = self.resolve(statement.iter) if isinstance(statement, For) else None
        before, start = dict(self.paths), []
        test = set(names(statement.test)) if isinstance(statement, While) else set()
        buffers: Tail = {}
        for n in dict.fromkeys(inside):
            if self.paths.get(n, AMBIGUOUS) != AMBIGUOUS and n in head | after | test:
                buffers[n], made = self.buffer(n, statement, statement, head | after | test)
                start += made
        for n in buffers.keys() & self.resized.keys():
            self.begin_resizing(buffers[n], self.resized[n])
        self.shapes.forget_sizes(self.reserved)
        self.aliases.begin_loop(buffers.values(), {*self.depths, *self.parameters}, stored_names(statement))
        self.paths = {n: AMBIGUOUS if n in inside else v for n, v in self.paths.items()}
        self.paths |= {n: (b, ()) for n, b in buffers.items()}
        outer_buffers, self.buffers = self.buffers, buffers
        outer_altered, self.stored_in_loop = self.stored_in_loop, self.stored_into(statement)
        late = {n: self.version(n) for n in dict.fromkeys(inside) if n in self.unset & after}
        outer, self.late_allocated = self.late_allocated, dict.fromkeys(late.values())
        outer_left, self.at_breaks = self.at_breaks, []
        self.depth += 1
        new = self.loop_statement(statement, bounds, buffers | late)
        self.depth -= 1
        start += self.late_allocations(late, statement)
        self.late_allocated, self.buffers, self.stored_in_loop = outer, outer_buffers, outer_altered
        self.paths = _agreed([*self.at_breaks, *([] if endless(statement) else [self.paths])])
        self.at_breaks = outer_left
        self.aliases.end_loop()
        lost = set(buffers.values())    # filled again since another name was bound to them
        counter = statement.target.id if isinstance(statement, For) else ""     # has no value after its loop
        self.paths = {n: v if (n not in inside or n not in before and v[0] not in lost) and counter not in names(
            list(v[1])) else AMBIGUOUS for n, v in self.paths.items()}
        self.paths |= {n: (b, ()) for n, b in [*buffers.items(), *late.items()]}
        return [*start, new]

    def stored_into(self, loop: AST) -> set[str]:
        """The names whose arrays a loop stores into, as far as its text shows: in stores, in calls, through views."""
        found: set[str] = set()
        for node in walk(loop):
            if isinstance(node, AugAssign):
                found |= {node.target.id} if isinstance(node.target, Name) else set(names(node.target))
            elif isinstance(node, Assign) and isinstance(node.targets[0], Subscript):
                found |= set(names(node.targets[0].value))
            elif user_call(node):
                found |= {n for k in self.writes(node) for n in names(node.args[k])}
        while True:
            grown = {n for node in walk_statements(loop) if isinstance(node, Assign)
                     and found & set(names(node.targets[0]))
                     and not isinstance(node.value, (BinOp, Call)) for n in names(node.value)} - found
            if not grown:
                return found
            found |= grown

    def late_allocations(self, late: Tail, origin: AST) -> list[AST]:
        """The allocations of arrays that a loop may bind, and that are used after it, in the sizes that they have."""
        made: list[AST] = []
        for n, buffer in list(late.items()):
            shape = self.late_allocated[buffer]
            if shape is None:
                del late[n]
            elif all(d is not None and self.is_loop_invariant(d) for d in shape):
                sizes = shape_expression(self.shapes, shape)
                self.shapes.allocated(buffer, shape)
                self.depths[buffer] = self.depth
                made.append(assign(buffer, call("numpy.empty", sizes, *dtype_of(self.typing.table[buffer]))))
            else:
                self.report.error("S201", "an array of a size that a loop makes is returned from inside it",
                                  self.bound_at.get(n, origin), help="bind it to a name, break, and return it after")
        return made

    def loop_statement(self, statement: For | While, bounds: AST | None, buffers: Tail) -> AST:
        """The loop itself."""
        if isinstance(statement, While):
            self.testing = True
            test = self.resolve(statement.test)
            self.testing = False
            return While(test, self.block(statement.body, buffers), [])
        counters = dict(self.shapes.counters)
        if statement.target.id not in stored_names(statement.body):
            self.shapes.counters |= least_of(statement)
        new = For(statement.target, bounds, self.block(statement.body, buffers), [], None)
        self.shapes.counters = counters
        return new

    def block(self, block: list[AST], tail: Tail | None = None) -> list[AST]:
        new: list[AST] = []
        known = dict(self.shapes.equal)
        for position, statement in enumerate(block):
            outer, self.preceding = self.preceding, []
            self.shapes.serial += 1
            last = tail is not None and position == len(block) - 1
            if isinstance(statement, Break):
                self.at_breaks.append(dict(self.paths))
                made = [*self.fill_buffers(tail or {}, statement), statement]
            elif last and isinstance(statement, If) and breaks(statement):
                made, tail = [self.exit_branch(statement, tail or {})], None
            else:
                made = self.statement(statement)
            new += [at(s, statement) for s in [*self.preceding, *self.required(statement), *made]]
            self.preceding = outer
            tail = None if isinstance(statement, Break) else tail
        if tail:
            outer, self.preceding = self.preceding, []
            made = self.fill_buffers(tail, block[-1])
            new += [at(s, block[-1]) for s in [*self.preceding, *self.required(block[-1]), *made]]
            self.preceding = outer
        self.equalities_at_end, self.shapes.equal = self.shapes.equal, known
        return new

    def required(self, origin: AST) -> list[AST]:
        """Guards that slices which start from the end start inside."""
        needed, self.shapes.required = self.shapes.required, []
        text = self.report.source.line(origin.lineno).strip() if needed else ""
        steps, self.shapes.positive_steps = self.shapes.positive_steps, []
        guards = [*(positive_step(self.shapes.expression(form)) for form in steps),
                  *(slice_in_bounds(self.shapes.expression(form), text) for form in needed)]
        return list({dump(g): g for g in guards}.values())

    def exit_branch(self, statement: If, tail: Tail) -> If:
        """The branch at the end of a loop's body of which a side leaves the loop."""
        test, before = self.resolve(statement.test), dict(self.paths)
        body = self.block(statement.body, tail) if statement.body else []
        first, self.paths = self.paths, dict(before)
        orelse = self.block(statement.orelse, tail) if statement.orelse else self.block([], None)
        if tail and not statement.orelse:
            self.paths = before
            orelse = [at(s, statement) for s in self.fill_buffers(tail, statement)]
        stays = [FALL in completion(arm) for arm in (statement.body, statement.orelse)]
        self.paths = merged(first, self.paths, True) if all(stays) else first if stays[0] else self.paths
        return If(test, body, orelse)

    def fill_buffers(self, buffers: Tail, origin: AST) -> list[AST]:
        """The buffers take the content of their names, all at once."""
        moves: list[tuple[str, str, AccessPath]] = []
        for n, made in buffers.items():
            if made in self.late_allocated and n not in self.paths:
                continue
            view = self.paths.get(n, AMBIGUOUS)
            if view == AMBIGUOUS:
                self.access_path(at(name(n), self.bound_at.get(n, origin)))
                continue
            self.aliases.note_fill(made, view[0])
            if made in self.late_allocated and self.late_allocated[made] is None:
                shape = self.shapes.of(index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0]))
                self.late_allocated[made] = tuple(d and self.shapes.reduced(d) for d in shape)
                self.typing.declare(made, array(self.types[n].dtype, self.types[n].rank))
                self.shapes.allocated(made, shape)
            if view != (made, ()):
                moves.append((n, made, view))
        self.aliases.end_iteration()
        return self.parallel_copies(moves, origin)

    def parallel_copies(self, moves: list[tuple[str, str, AccessPath]], origin: AST) -> list[AST]:
        made: list[AST] = []
        while moves:
            ready = next((m for m in moves if all(other is m or other[2][0] != m[1] for other in moves)), None)
            if ready is None:           # they go round: what the first one is filled over is held
                n, buffer, _ = moves[0]
                kind = array(self.types[n].dtype, self.types[n].rank)
                held = self.typing.declare(self.free.fresh(f"{n}_before"), kind)
                made += self.allocations.allocate(held, self.typing.table[held], name(buffer), origin)
                self.depths[held] = self.depth
                moves = [(m, b, (held, v[1]) if v[0] == buffer else v) for m, b, v in moves]
                continue
            moves.remove(ready)
            made += self.fill(*ready, origin)
        return made


def _agreed(ends: list[dict[str, AccessPath]]) -> dict[str, AccessPath]:
    """The access paths of names behind a loop: those that they have at all of its exits at which they are bound."""
    return {n: view if all(repr(paths.get(n, view)) == repr(view) for paths in ends) else AMBIGUOUS
            for end in ends for n, view in end.items()}
