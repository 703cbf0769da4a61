"""types_by_branch: what follows a branch that binds a name to values of different types goes into both of its sides.

    if t < start:                           if t < start:
        f = 0.0                                 f = 0.0
    else:                                       u = u + dt * f
        f = a * np.sin(x)           ->      else:
    u = u + dt * f                              f = a * np.sin(x)
                                                u = u + dt * f

Requires structured form. Tried on names of several types in one live range; what follows is taken as far as such a name
is used in the block.
"""
from __future__ import annotations

from s2sad.naming import Names
from s2sad.normalize.single_assignment import breaks
from s2sad.tree import (
    AST, Break, Continue, FunctionDef, If, Name, Raise, Return, Tuple, assign, at, copy, head_copy, name, names,
    stored_names, tuple_of, walk_statements,
)

MOST = 300          # statements that are duplicated in one function


def types_by_branch(function: FunctionDef, conflicting: set[str], free: Names) -> tuple[FunctionDef, int] | None:
    """The function in that form, and how many statements are duplicated; None if none is."""
    made = _Duplication(conflicting, free)
    body = made.block(function.body)
    return (at(FunctionDef(*[body if f == "body" else getattr(function, f) for f in function._fields]), function),
            made.count) if made.count else None


class _Duplication:
    def __init__(self, conflicting: set[str], free: Names):
        self.conflicting, self.free, self.count = conflicting, free, 0

    def block(self, block: list[AST]) -> list[AST]:
        if block and isinstance(block[-1], Return):
            block = [*block[:-1], *self.returned(block[-1])]
        for position, statement in enumerate(block):
            end = self.end(statement, block, position + 1) if isinstance(statement, If) else None
            if end is not None:
                moved = block[position + 1:end]
                self.count += sum(1 for _ in walk_statements(moved))
                made = at(If(statement.test, *(_followed(arm, moved) for arm in (statement.body, statement.orelse))),
                          statement)
                return [*map(self.statement, block[:position]), made, *block[end:]]
        return [self.statement(s) for s in block]

    def statement(self, statement: AST) -> AST:
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if isinstance(inner := getattr(statement, field, None), list):
                setattr(new, field, self.block(inner))
        return new

    def returned(self, statement: Return) -> list[AST]:
        """A return of names, of what is computed before it where such names are."""
        before: list[AST] = []

        def result(value: AST) -> AST:
            if isinstance(value, Name):
                return value
            before.append(at(assign(self.free.fresh("result"), value), statement))
            return at(name(before[-1].targets[0].id), value)
        value = statement.value
        if value is None or not self.conflicting & {*names(value)}:
            return [statement]
        new = at(tuple_of(*map(result, value.elts)), value) if isinstance(value, Tuple) else result(value)
        return [*before, at(Return(new), statement)]

    def end(self, branch: If, block: list[AST], start: int) -> int | None:
        """Where in a block what goes into a branch ends; None if nothing does."""
        chosen = self.conflicting & {*stored_names(branch)}
        used = [k for k in range(start, len(block)) if chosen & {*names(block[k])}]
        if not used or isinstance(block[used[-1]], Return):
            return None
        end = used[-1] + 1
        if any(isinstance(s, If) and breaks(s) or isinstance(s, (Break, Continue)) for s in block[start:end]):
            end = len(block)
        return end


def _followed(side: list[AST], moved: list[AST]) -> list[AST]:
    """A side of a branch with what follows it, where anything does."""
    return side if side and isinstance(side[-1], (Break, Continue, Raise, Return)) else [*side, *map(copy, moved)]
