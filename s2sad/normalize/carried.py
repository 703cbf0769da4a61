"""carried: a name that loops or branches bind to one array after another stands for one buffer, which is filled.

Used by `views`. Requires structured form and types; establishes that a name stands for one array wherever paths meet.

    v = u                           v_1 = np.empty_like(u)
    for s in range(n):              v_1[...] = u
        out = np.empty_like(v)      for s in range(n):
        ...                             out = np.empty_like(v_1)
        v = out                         ...
                                        assert v_1.shape == out.shape
                                        v_1[...] = out

A name's own array is its buffer where no other name stands for it. NumPy binds names and copies nothing: where a store
would tell (`aliases`), it is refused.
"""
from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from s2sad.infer.affine import Affine
from s2sad.infer.laws import ONE, Shape, whole_number
from s2sad.infer.types import array
from s2sad.infer.shapes import shape_expression
from s2sad.normalize.aliases import Aliases
from s2sad.normalize.allocations import dtype_of
from s2sad.normalize.places import AMBIGUOUS, Places, View
from s2sad.normalize.references import References
from s2sad.normalize.rename import breaks
from s2sad.tree import (
    AST, Assert, Assign, Break, For, If, Name, Subscript, While, assign, at, call, const, copy, index, name, names,
    rename, stored_names, walk,
)

Tail = dict[str, str]                   # the buffers of a loop, by the names that stand for them
CHANGES = "'{}' may change its size from one iteration to the next"


@dataclass
class _Arm:
    """A branch: its statements, and at its end what names stand for and what is known of sizes."""
    block: list[AST]
    seen: dict[str, View]
    equal: dict[str, Affine]


class Carried(Places):
    """What names stand for after loops and branches."""
    references: References
    aliases: Aliases
    ended: dict[str, Affine]            # what was known of sizes at the end of the last block
    unset: set[str]                     # names of arrays that are bound before they are read, as the flags tell
    late: dict[str, Shape | None]       # buffers of such names in the loops here, and their shapes
    bound_at: dict[str, AST]            # the statement that has last bound a name of an array

    @abstractmethod
    def statement(self, statement: AST) -> list[AST]:
        """A statement in which views are resolved."""

    @abstractmethod
    def apart(self, place: Subscript, value: AST, before: list[AST], origin: AST) -> AST:
        """A value, under a name of its own where a place cannot hold it while it is made."""

    @abstractmethod
    def version(self, target: str) -> str:
        """A new name for an array that a name is bound to."""

    def buffer(self, identifier: str, place: AST, origin: AST, near: set[str]) -> tuple[str, list[AST]]:
        """The array that a name stands for from here on, and the statements that make it; `near` are the names that are
        used later."""
        base, subscripts = self.seen[identifier]
        kept = [n for n in sorted(near) if n != identifier and self.seen.get(n, AMBIGUOUS)[0] == base]
        if not subscripts and base in self.home and not kept:
            return base, []
        made = self.version(identifier)
        kind = self.types[identifier]
        value = index(name(base), *map(copy, subscripts)) if subscripts else name(base)
        statements = self.allocations.allocate(made, array(kind.dtype, kind.rank), value, origin)
        self.home[made] = self.depth
        self.typing.table[made] = kind
        self.aliases.share(made, base)
        return made, statements

    # -- loops -------------------------------------------------------------------------------------------------------

    def loop(self, statement: For | While) -> list[AST]:
        head, after = self.references.head[id(statement)], self.references.after[id(statement)]
        inside = [t.id for s in walk(statement.body) if isinstance(s, Assign) for t in s.targets
                  if isinstance(t, Name) and t.id in self.types and self.types[t.id].is_array]
        bounds = self.resolve(statement.iter) if isinstance(statement, For) else None
        before, start = dict(self.seen), []
        test = set(names(statement.test)) if isinstance(statement, While) else set()
        buffers: Tail = {}
        for n in dict.fromkeys(inside):
            if self.seen.get(n, AMBIGUOUS) != AMBIGUOUS and n in head | after | test:
                buffers[n], made = self.buffer(n, statement, statement, head | after | test)
                start += made
        self.aliases.begin(buffers.values(), {*self.home, *self.parameters}, stored_names(statement))
        self.seen = {n: AMBIGUOUS if n in inside else v for n, v in self.seen.items()}
        self.seen |= {n: (b, ()) for n, b in buffers.items()}
        late = {n: self.version(n) for n in dict.fromkeys(inside) if n in self.unset & after}
        outer, self.late = self.late, dict.fromkeys(late.values())
        self.depth += 1
        new = self.turn(statement, bounds, buffers | late)
        self.depth -= 1
        start += self.started(late, statement)
        self.late = outer
        self.aliases.end()
        lost = set(buffers.values())    # filled again since another name came to stand for them
        self.seen = {n: v if n not in inside or n not in before and v[0] not in lost else AMBIGUOUS
                     for n, v in self.seen.items()}
        self.seen |= {n: (b, ()) for n, b in [*buffers.items(), *late.items()]}
        return [*start, new]

    def started(self, late: Tail, origin: AST) -> list[AST]:
        """The allocations of arrays that a loop may bind, and that are used after it, in the sizes that they have."""
        made: list[AST] = []
        for n, buffer in list(late.items()):
            shape = self.late[buffer]
            if shape is None:
                del late[n]
            elif all(d is not None and self.is_older(d) for d in shape):
                kind = self.typing.table[buffer]
                self.shapes.allocated(buffer, shape)
                self.home[buffer] = self.depth
                made.append(assign(buffer, call("numpy.empty", shape_expression(self.shapes, shape), *dtype_of(kind))))
            else:
                self.report.error("S201", "an array of a size that a loop makes is returned from inside it",
                                  self.bound_at.get(n, origin), help="bind it to a name, break, and return it after")
        return made

    def turn(self, statement: For | While, bounds: AST | None, buffers: Tail) -> AST:
        """The loop itself."""
        if isinstance(statement, While):
            return While(self.resolve(statement.test), self.block(statement.body, buffers), [])
        counters = dict(self.shapes.counters)
        self.shapes.counters |= least_of(statement)
        new = For(statement.target, bounds, self.block(statement.body, buffers), [], None)
        self.shapes.counters = counters
        return new

    def block(self, block: list[AST], tail: Tail | None = None) -> list[AST]:
        new: list[AST] = []
        known = dict(self.shapes.equal)
        for position, statement in enumerate(block):
            outer, self.before = self.before, []
            self.shapes.serial += 1
            last = tail is not None and position == len(block) - 1
            if isinstance(statement, Break):
                made = [*self.filled(tail or {}, statement), statement]
            elif last and isinstance(statement, If) and breaks(statement):
                made, tail = [self.parting(statement, tail or {})], None
            else:
                made = self.statement(statement)
            new += [at(s, statement) for s in [*self.before, *self.required(), *made]]
            self.before = outer
            tail = None if isinstance(statement, Break) else tail
        if tail:
            outer, self.before = self.before, []
            made = self.filled(tail, block[-1])
            new += [at(s, block[-1]) for s in [*self.before, *self.required(), *made]]
            self.before = outer
        self.ended, self.shapes.equal = self.shapes.equal, known
        return new

    def parting(self, statement: If, tail: Tail) -> If:
        """The branch at the end of a loop's body of which one side leaves the loop."""
        test, before = self.resolve(statement.test), dict(self.seen)
        body = self.block(statement.body, tail) if statement.body else []
        self.seen = dict(before)
        orelse = self.block(statement.orelse, tail) if statement.orelse else self.block([], None)
        if tail and not statement.orelse:
            self.seen = before
            orelse = [at(s, statement) for s in self.filled(tail, statement)]
        return If(test, body, orelse)

    def filled(self, buffers: Tail, origin: AST) -> list[AST]:
        """The buffers take what their names stand for, all at once."""
        moves: list[tuple[str, str, View]] = []
        for n, made in buffers.items():
            if made in self.late and n not in self.seen:
                continue
            view = self.seen.get(n, AMBIGUOUS)
            if view == AMBIGUOUS:
                self.viewed(at(name(n), self.bound_at.get(n, origin)))
                continue
            self.aliases.moved(made, view[0])
            if made in self.late and self.late[made] is None:
                shape = self.shapes.of(index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0]))
                self.late[made] = tuple(d and self.shapes.reduced(d) for d in shape)
                self.typing.table[made] = array(self.types[n].dtype, self.types[n].rank)
                self.shapes.allocated(made, shape)
            if view != (made, ()):
                moves.append((n, made, view))
        self.aliases.meet()
        return self.moved(moves, origin)

    def moved(self, moves: list[tuple[str, str, View]], origin: AST) -> list[AST]:
        made: list[AST] = []
        while moves:
            ready = next((m for m in moves if all(other is m or other[2][0] != m[1] for other in moves)), None)
            if ready is None:           # they go round: what the first one is filled over is held
                n, buffer, _ = moves[0]
                held = self.free.fresh(f"{n}_before")
                self.typing.table[held] = array(self.types[n].dtype, self.types[n].rank)
                made += self.allocations.allocate(held, self.typing.table[held], name(buffer), origin)
                self.home[held] = self.depth
                moves = [(m, b, (held, v[1]) if v[0] == buffer else v) for m, b, v in moves]
                continue
            moves.remove(ready)
            made += self.fill(*ready, origin)
        return made

    def fill(self, identifier: str, buffer: str, view: View, origin: AST) -> list[AST]:
        place = index(name(buffer), const(...))
        value = index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0])
        if not all(map(self.may_last, self.shapes.of(name(buffer)), self.shapes.of(value))):
            self.report.error("S201", CHANGES.format(identifier), self.bound_at.get(identifier, origin),
                              help="give arrays of different sizes different names, or copy into one: x[...] = ...")
            return []
        checks = self.checks(place, value)
        said = const(CHANGES.format(identifier))
        checks = [Assert(c.test, said) if isinstance(c, Assert) else c for c in checks]
        return [*checks, assign(place, self.apart(place, value, checks, origin))]

    def may_last(self, filled: Affine | None, size: Affine | None) -> bool:
        """Whether the size that an array has at the end of a turn may be the one that it had before: it is known to be,
        or nothing that it is made of changes in the loop."""
        if filled is None or size is None or size == ONE != filled:
            return False
        apart = self.shapes.reduced(size).plus(self.shapes.reduced(filled), -1)
        if not apart.terms:
            return apart.constant == 0
        return self.is_older(size)

    def is_older(self, size: Affine) -> bool:
        """Whether a size is made of what is from before the loop."""
        return all(self.aliases.is_older(n, self.typing.table[n].is_array)
                   for symbol, _ in self.shapes.reduced(size).terms for n in names(self.shapes.atoms[symbol]))

    # -- branches ----------------------------------------------------------------------------------------------------

    def branch(self, statement: If) -> list[AST]:
        test, before, older = self.resolve(statement.test), dict(self.seen), {*self.home, *self.parameters}
        first = self.arm(statement.body)
        self.seen = dict(before)
        second = self.arm(statement.orelse)
        one = self.allocated_on_both(before, first, second)
        second.block = [rename(s, one) for s in second.block]
        second.seen = {n: (one.get(base, base), subscripts) for n, (base, subscripts) in second.seen.items()}
        self.tuples = {n: rename(t, one) for n, t in self.tuples.items()}
        self.aliases.renamed(one)
        met = self.met(statement, (first, second), before, older)
        self.seen = _merged(first.seen, second.seen, self.depth > 0) | met
        return [If(test, first.block, second.block)]

    def arm(self, block: list[AST]) -> _Arm:
        made = self.block(block)
        return _Arm(made, self.seen, self.ended)

    def met(self, statement: If, arms: tuple[_Arm, _Arm], before: dict[str, View], older: set[str]) -> dict[str, View]:
        """The names that stand for different arrays after the two branches get one array in both."""
        found: dict[str, View] = {}
        near = self.references.after[id(statement)]
        for n in [n for n in arms[0].seen if n in near and n in arms[1].seen and n in self.types]:
            views = [arm.seen[n] for arm in arms]
            if AMBIGUOUS in views or repr(views[0]) == repr(views[1]):
                continue
            shapes = [self.shape_in(arm, view) for arm, view in zip(arms, views)]
            same = all(self.shapes.same(a, b) for a, b in zip(*shapes))
            kept = [k for k in (0, 1) if same and views[k] == before.get(n) and self.is_own(n, views[k], near, arms)]
            made = views[kept[0]][0] if kept else self.version(n)
            for k, (arm, (base, subscripts)) in enumerate(zip(arms, views)):
                if k not in kept:
                    value = index(name(base), *map(copy, subscripts)) if subscripts else name(base)
                    arm.block += [at(s, statement) for s in self.taken(n, made, value, bool(kept), statement)]
                if base in older or any(arm.seen.get(m, AMBIGUOUS)[0] == base for m in near - {n}):
                    self.aliases.share(made, base)
            if not kept:
                self.home[made] = self.depth
                self.typing.table[made] = array(self.types[n].dtype, self.types[n].rank)
                self.shapes.either(made, *shapes)
            found[n] = (made, ())
        return found

    def taken(self, identifier: str, buffer: str, value: AST, filled: bool, origin: AST) -> list[AST]:
        """What makes a buffer hold a value at the end of a branch."""
        if not filled:
            kind = self.types[identifier]
            self.typing.table[buffer] = array(kind.dtype, kind.rank)
            return self.allocations.allocate(buffer, self.typing.table[buffer], value, origin)
        place, before = index(name(buffer), const(...)), []
        value = self.apart(place, value, before, origin)
        return [*before, assign(place, value)]

    def is_own(self, identifier: str, view: View, near: set[str], arms: tuple[_Arm, _Arm]) -> bool:
        """Whether a name stands for a whole array for which no other name that is used later stands."""
        return not view[1] and view[0] in self.home and not any(
            arm.seen.get(m, AMBIGUOUS)[0] == view[0] for arm in arms for m in near - {identifier})

    def shape_in(self, arm: _Arm, view: View) -> Shape:
        """The shape of a view, with what is known of sizes at the end of a branch."""
        known, self.shapes.equal = self.shapes.equal, arm.equal
        shape = self.shapes.of(index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0]))
        self.shapes.equal = known
        return shape

    def allocated_on_both(self, before: dict[str, View], one: _Arm, other: _Arm) -> dict[str, str]:
        """The arrays of a second branch that go under the name of the first branch's: both were bound to one name."""
        found: dict[str, str] = {}
        for bound, (second, subscripts) in other.seen.items():
            first = one.seen.get(bound, AMBIGUOUS)[0]
            if first != second and not subscripts and bound in self.types and all(
                    self.home.get(v) == self.depth and (v, ()) not in before.values() for v in (first, second)) \
                    and one.seen[bound] == (first, ()) and second not in found and first not in found.values():
                found[second] = first
                self.shapes.either(first, self.shape_in(one, (first, ())), self.shape_in(other, (second, ())))
        return found


def least_of(loop: For) -> dict[str, int]:
    """The least value of a loop's counter, if it is written."""
    args = loop.iter.args
    low = 0 if len(args) == 1 else whole_number(args[0])
    step = 1 if len(args) < 3 else whole_number(args[2])
    if step is not None and step < 0:
        stop = whole_number(args[1])
        low = None if stop is None else stop + 1
    return {} if low is None or not step else {loop.target.id: low}


def _merged(a: dict[str, View], b: dict[str, View], looping: bool) -> dict[str, View]:
    """What names stand for where two branches meet; in a loop a name bound on one side may be an iteration old."""
    made: dict[str, View] = {}
    for bound in {**a, **b}:
        if bound in a and bound in b:
            made[bound] = a[bound] if repr(a[bound]) == repr(b[bound]) else AMBIGUOUS
        else:
            made[bound] = AMBIGUOUS if looping else a.get(bound) or b[bound]
    return made
