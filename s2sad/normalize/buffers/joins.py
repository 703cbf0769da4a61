"""joins: a name that the two sides of a branch bind to different arrays has one buffer after it.

Used by `resolve_views`. Requires structured form and types.

    if c > 0.0:                     if c > 0.0:
        w = u * c                       w_1 = np.empty_like(u)
    else:                               w_1[...] = u * c
        w = u                       else:
                                        w_1 = np.empty_like(u)
                                        w_1[...] = u

NumPy copies nothing there: a store after which the copy would differ is refused (`may_alias`).
"""
from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import Shape
from s2sad.infer.types import array
from s2sad.normalize.buffers.may_alias import Aliases
from s2sad.normalize.buffers.access_paths import AMBIGUOUS, AccessPaths, AccessPath
from s2sad.normalize.buffers.may_alias import UpcomingUses
from s2sad.tree import AST, If, Subscript, assign, at, const, copy, index, name, names, rename


@dataclass
class _Arm:
    """A branch: its statements, and at its end the access paths of names and what is known of sizes."""
    block: list[AST]
    paths: dict[str, AccessPath]
    equal: dict[str, Affine]


class Joins(AccessPaths):
    """The access paths of names after branches."""
    uses: UpcomingUses
    aliases: Aliases
    buffers: dict[str, str]             # of the loop here, by their names
    equalities_at_end: dict[str, Affine]            # what was known of sizes at the end of the last block
    refilled: list[str]                 # the buffers that have been allocated in other sizes, so far

    @abstractmethod
    def statement(self, statement: AST) -> list[AST]:
        """A statement in which views are resolved."""

    @abstractmethod
    def materialized(self, place: Subscript, value: AST, before: list[AST], origin: AST) -> AST:
        """A value, under a name of its own where a place cannot hold it while it is made."""

    @abstractmethod
    def fill(self, identifier: str, buffer: str, view: AccessPath, origin: AST) -> list[AST]:
        """A buffer takes the content of a name's access path."""

    @abstractmethod
    def version(self, target: str) -> str:
        """A new name for an array that a name is bound to."""

    @abstractmethod
    def block(self, block: list[AST]) -> list[AST]:
        """The statements of a block, one after the other."""

    def is_referenced(self, base: str, near: set[str], paths: dict[str, AccessPath]) -> bool:
        """Whether names that are used later, or tuples, are bound to an array or a part of it."""
        return any(paths.get(n, AMBIGUOUS)[0] == base or base in names(self.tuples.get(n, const(0))) for n in near)

    def branch(self, statement: If) -> list[AST]:
        test, before, older = self.resolve(statement.test), dict(self.paths), {*self.depths, *self.parameters}
        refilled = len(self.refilled)
        first = self.arm(statement.body)
        self.paths = dict(before)
        second = self.arm(statement.orelse)
        one = self.allocated_on_both(before, first, second)
        second.block = [rename(s, one) for s in second.block] if one else second.block
        second.paths = {n: (one.get(base, base), subscripts) for n, (base, subscripts) in second.paths.items()}
        self.tuples = {n: rename(t, one) for n, t in self.tuples.items()}
        self.aliases.note_binding(one)
        met = self.join_buffers(statement, (first, second), before, older)
        self.paths = merged(first.paths, second.paths, self.depth > 0) | met
        self.shapes.forget_sizes(self.refilled[refilled:])
        return [If(test, first.block, second.block)]

    def arm(self, block: list[AST]) -> _Arm:
        made = self.block(block)
        return _Arm(made, self.paths, self.equalities_at_end)

    def join_buffers(self, statement: If, arms: tuple[_Arm, _Arm], before: dict[str, AccessPath],
               older: set[str]) -> dict[str, AccessPath]:
        """The names that are bound to different arrays after the two branches get one buffer in both."""
        found: dict[str, AccessPath] = {}
        near = self.uses.after[id(statement)]
        for n in [n for n in arms[0].paths if n in near and n in arms[1].paths and n in self.types]:
            views = [arm.paths[n] for arm in arms]
            if AMBIGUOUS in views or repr(views[0]) == repr(views[1]):
                continue
            if self.into_buffer(n, arms, near, older, statement):
                found[n] = (self.buffers[n], ())
                continue
            shapes = [self.shape_in(arm, view) for arm, view in zip(arms, views)]
            same = all(self.shapes.are_equal(a, b) for a, b in zip(*shapes))
            kept = [k for k in (0, 1) if same and views[k] == before.get(n) and self.is_own(n, views[k], near, arms)]
            made = views[kept[0]][0] if kept else self.version(n)
            for k, (arm, (base, subscripts)) in enumerate(zip(arms, views)):
                if k not in kept:
                    value = index(name(base), *map(copy, subscripts)) if subscripts else name(base)
                    arm.block += [at(s, statement) for s in self.copied_into(n, made, value, bool(kept), statement)]
                self.aliases.note_copy(base, made, self.aliases.may_be_stored_again(base, older)
                                    or self.is_referenced(base, near - {n}, arm.paths))
            if not kept:
                self.depths[made] = self.depth
                self.typing.declare(made, array(self.types[n].dtype, self.types[n].rank))
                self.shapes.note_two_shapes(made, *shapes)
            found[n] = (made, ())
        return found

    def into_buffer(self, identifier: str, arms: tuple[_Arm, _Arm], near: set[str], older: set[str],
                    origin: AST) -> bool:
        """Fills the buffer that a loop has for a name, at the end of each branch; false if there is none, or its
        content is used under other names."""
        buffer = self.buffers.get(identifier)
        if buffer is None or any(self.is_referenced(buffer, near - {identifier}, arm.paths) for arm in arms):
            return False
        for arm in arms:
            view = arm.paths[identifier]
            if view != (buffer, ()):
                known, self.shapes.equal = self.shapes.equal, arm.equal
                arm.block += [at(s, origin) for s in self.fill(identifier, buffer, view, origin)]
                self.shapes.equal = known
                self.aliases.note_copy(view[0], buffer, self.aliases.may_be_stored_again(view[0], older)
                                    or self.is_referenced(view[0], near - {identifier}, arm.paths))
        return True

    def copied_into(self, identifier: str, buffer: str, value: AST, filled: bool, origin: AST) -> list[AST]:
        """What makes a buffer hold a value at the end of a branch."""
        if not filled:
            kind = self.types[identifier]
            self.typing.declare(buffer, array(kind.dtype, kind.rank))
            return self.allocations.allocate(buffer, self.typing.table[buffer], value, origin)
        place, before = index(name(buffer), const(...)), []
        value = self.materialized(place, value, before, origin)
        return [*before, assign(place, value)]

    def is_own(self, identifier: str, view: AccessPath, near: set[str], arms: tuple[_Arm, _Arm]) -> bool:
        """Whether a name is bound to a whole array which no other name that is used later shares."""
        return not view[1] and view[0] in self.depths and not any(
            self.is_referenced(view[0], near - {identifier}, arm.paths) for arm in arms)

    def shape_in(self, arm: _Arm, view: AccessPath) -> Shape:
        """The shape of a view, with what is known of sizes at the end of a branch."""
        known, self.shapes.equal = self.shapes.equal, arm.equal
        shape = self.shapes.of(index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0]))
        self.shapes.equal = known
        return shape

    def allocated_on_both(self, before: dict[str, AccessPath], one: _Arm, other: _Arm) -> dict[str, str]:
        """The arrays of a second branch that go under the name of the first branch's: both were bound to one name."""
        found: dict[str, str] = {}
        for bound, (second, subscripts) in other.paths.items():
            first = one.paths.get(bound, AMBIGUOUS)[0]
            if first != second and not subscripts and bound in self.types and all(
                    self.depths.get(v) == self.depth and (v, ()) not in before.values() for v in (first, second)) \
                    and one.paths[bound] == (first, ()) and second not in found and first not in found.values():
                found[second] = first
                self.shapes.note_two_shapes(first, self.shape_in(one, (first, ())), self.shape_in(other, (second, ())))
        return found


def merged(a: dict[str, AccessPath], b: dict[str, AccessPath], looping: bool) -> dict[str, AccessPath]:
    """The access paths of names where two branches join; in a loop a name bound on one side may be an iteration old."""
    made: dict[str, AccessPath] = {}
    for bound in {**a, **b}:
        if bound in a and bound in b:
            made[bound] = a[bound] if repr(a[bound]) == repr(b[bound]) else AMBIGUOUS
        else:
            made[bound] = AMBIGUOUS if looping else a.get(bound) or b[bound]
    return made
