"""tail_duplication: what follows a branch that lets names stand for one array or another goes into both of its sides.

    def f(a, b, x, n):                      def f(a, b, x, n):
        for k in range(n):                      for k in range(n):
            if k % 2 == 0:                          if k % 2 == 0:
                source = a                              source = a
                target = b                              target = b
            else:                                       target[0] = source[1] * x[k]
                source = b                          else:
                target = a                              source = b
            target[0] = source[1] * x[k]                target = a
                                                        target[0] = source[1] * x[k]

Requires structured form and types; establishes for each side of a branch arrays of its own. Behind one there is one
array for a name, into which those of both sides would be copied: where one is written, and the copy would tell, each
side goes on with the arrays that it has. What follows is taken as far as such a name is used in the block, and not at
all where it is long.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.normalize.context import NormalContext
from s2sad.normalize.single_assignment import breaks
from s2sad.normalize.lists.lists_of_views import ListContents, Writes
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Break, Call, Expr, For, FunctionDef, If, Name, Raise, Return, While, at, copy,
    dump, head_copy, names, stored_names, walk, times_bound,
)

_MOST = 120         # statements that are written once more, in one function


def tail_duplication(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function in that form; the same one if nothing is moved. Names that are bound again may stand for other
    arrays from here on."""
    new = function
    if any(isinstance(n, If) for n in walk(function.body)):
        made, changed = _TailDuplication(function, context.typing, context.written), copy(function)
        changed.body = made.block(function.body)
        new = changed if made.left < _MOST else function
    context.swapped = {n for n, times in times_bound(new.body, Assign).items() if times > 1}
    return new


class _TailDuplication:
    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.held, self.left = ListContents(function, typing, writes), _MOST

    def block(self, block: list[AST]) -> list[AST]:
        block = self.joined(block)
        for position, statement in enumerate(block):
            if isinstance(statement, If) and (end := self.end(statement, block, position + 1)) is not None:
                moved = block[position + 1:end]
                self.left -= _length(moved)
                made = at(If(statement.test, *([*arm, *map(copy, moved)] for arm in (
                    statement.body, statement.orelse))), statement)
                return [*map(self.statement, block[:position]), self.statement(made),
                        *self.block(block[end:])]
        return [self.statement(s) for s in block]

    def joined(self, block: list[AST]) -> list[AST]:
        """A block in which two such branches after one another that ask the same are one."""
        made: list[AST] = []
        for s in block:
            last = made[-1] if made else None
            if isinstance(s, If) and isinstance(last, If) and dump(s.test) == dump(last.test) and _names_alone(
                    last) and self.chosen(last) and self.chosen(s):
                made[-1] = at(If(last.test, [*last.body, *s.body], [*last.orelse, *s.orelse]), last)
            else:
                made.append(s)
        return made

    def statement(self, statement: AST) -> AST:
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if isinstance(inner := getattr(statement, field, None), list):
                setattr(new, field, self.block(inner))
        return new

    def end(self, branch: If, block: list[AST], start: int) -> int | None:
        """Where in a block what goes into a branch ends; None if nothing does."""
        chosen = self.chosen(branch)
        if not chosen:
            return None
        own = self.views_bound(chosen, block[start:])
        used = [k for k in range(start, len(block)) if own & set(names(block[k])) and not isinstance(block[k], Return)]
        if not used:
            return None
        end = used[-1] + 1
        if any(isinstance(s, If) and breaks(s) or isinstance(s, Break) for s in block[start:end]):
            end = len(block)
        together, moved = self.held.component(chosen), block[start:end]
        written = {n for s in walk(moved) for n in self.held.written(s)}
        return end if written & together and _length(moved) <= self.left else None

    def chosen(self, branch: If) -> set[str]:
        """The names that may stand for different arrays behind a branch, one of which has a name before it."""
        arms = [self.bound(arm) for arm in (branch.body, branch.orelse)]
        return {n for n in {**arms[0], **arms[1]} if arms[0].get(n) != arms[1].get(n) and (
            arms[0].get(n) or arms[1].get(n))}

    def bound(self, block: list[AST]) -> dict[str, tuple[str, ...]]:
        """The texts of what the names of arrays are bound to in a block, and in the branches in it; empty where it is
        a new array."""
        found: dict[str, tuple[str, ...]] = {}
        for s in block:
            if isinstance(s, If):
                arms = [self.bound(arm) for arm in (s.body, s.orelse)]
                for n in {**arms[0], **arms[1]}:
                    found[n] = (*arms[0].get(n, ("",)), *arms[1].get(n, ("",)))
            elif isinstance(s, Assign) and isinstance(s.targets[0], Name) and self.held.typing.of(
                    s.targets[0]).is_array:
                found[s.targets[0].id] = (dump(s.value),) if self.held.sources(s.value) else ()
        return found

    def views_bound(self, chosen: set[str], block: list[AST]) -> set[str]:
        """The names that stand for different arrays, with those that are bound to parts of them in a block."""
        found = set(chosen)
        bound = [s for s in walk(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
        while more := {s.targets[0].id for s in bound if self.held.sources(s.value) & found} - found:
            found |= more
        return found


def _names_alone(branch: If) -> bool:
    """Whether a branch binds names, and does nothing that its test could tell."""
    bound = [*branch.body, *branch.orelse]
    return all(isinstance(s, Assign) and isinstance(s.targets[0], Name) and not any(
        isinstance(n, Call) for n in walk(s.value)) for s in bound) and not set(stored_names(bound)) & set(
        names(branch.test))


def _length(block: list[AST]) -> int:
    return sum(isinstance(s, (Assign, AugAssign, If, For, While, Expr, Assert, Raise)) for s in walk(block))
