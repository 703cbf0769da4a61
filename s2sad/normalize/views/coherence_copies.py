"""coherence_copies: the statements of a view's life, with copies from the side that was written before the other is
mentioned.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.normalize.views.operand_aliases import OperandAliases
from s2sad.normalize.views.unsupported_views import Writes, written_names
from s2sad.tree import (
    AST, Assign, AugAssign, Break, Call, Expr, For, If, Raise, Return, While, at, call_name, copy, walk,
)

VIEW, OPERAND = "view", "operand"


def leaves(statement: AST) -> bool:
    """Whether a statement may leave the loop in which it stands."""
    if isinstance(statement, If):
        return any(leaves(s) for s in (*statement.body, *statement.orelse))
    return isinstance(statement, Break)


class CoherenceCopies:
    """Puts the copies into the statements of one view's life; `ahead` is the side that was written last and is not
    copied. `costly` if whole arrays would be copied for single elements, or if a call is given both sides."""

    def __init__(self, both: OperandAliases, typing: Typing, writes: Writes, back: Assign, again: Assign):
        self.both, self.typing, self.writes, self.back, self.again = both, typing, writes, back, again
        self.ahead = ""
        self.costly = False
        self.copies = 0

    def life(self, rest: list[AST]) -> list[AST]:
        """The statements behind the binding: at the end the operand holds what the view does."""
        made = self.block(rest)
        if self.ahead == VIEW:
            made += self.copied(rest[-1])
        return made

    def block(self, block: list[AST]) -> list[AST]:
        return [made for s in block for made in self.statement(s)]

    def copied(self, place: AST) -> list[AST]:
        """The copy after which both sides are in step."""
        made = {"": [], VIEW: [self.back], OPERAND: [self.again]}[self.ahead]
        self.copies += len(made)
        self.ahead = ""
        return [at(copy(s), place) for s in made]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (Break, Return, Raise)):
            needed = self.ahead == VIEW or self.both.mentioned(statement)[0]
            return [*(self.copied(statement) if needed else []), statement]
        view, operand = self.both.mentioned(statement)
        written = {n for s in walk(statement) for n in self.written(s)}
        if leaves(statement) or view and operand and written and isinstance(statement, (For, If, While)):
            return self.inside(statement)
        if self.ahead == VIEW and operand or self.ahead == OPERAND and view:
            before = self.copied(statement)
        else:
            before = []
        if written:
            self.ahead = min(written)
            self.costly |= view and operand and len(written) > 1 or self.is_given_both(statement)
        return [*before, statement]

    def written(self, statement: AST) -> set[str]:
        """The sides that a simple statement writes."""
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            return set()
        names = written_names(statement, self.typing, self.writes)
        return {VIEW for n in names if n in self.both.view} | (
            {OPERAND} if names & self.both.operand and self.both.mentioned(statement)[1] else set())

    def is_given_both(self, statement: AST) -> bool:
        """Whether a kernel that writes an array is given both sides."""
        return any(isinstance(n, Call) and (call_name(n) or "").startswith("user.") and self.writes(n)
                   and all(self.both.mentioned(n)) for n in walk(statement))

    def inside(self, statement: AST) -> list[AST]:
        """A loop or branch with both sides in step where its blocks begin and end."""
        before = self.copied(statement)

        def block(given: list[AST]) -> list[AST]:
            known, self.copies = self.copies, 0
            made = self.block(given)
            made += self.copied(given[-1]) if made and not isinstance(made[-1], Break) else []
            self.costly |= self.copies > 0 and isinstance(statement, (For, While)) and self.is_slight(given)
            self.copies = known + (self.copies if isinstance(statement, If) else 0)
            self.ahead = ""
            return made
        return [*before, with_blocks(statement, block)]

    def is_slight(self, body: list[AST]) -> bool:
        """Whether the body of a loop does less than a copy of an array: it works on single elements."""
        return not any(isinstance(s, (For, While)) or isinstance(s, (Assign, AugAssign)) and (
            self.typing.of(s.targets[0] if isinstance(s, Assign) else s.target).is_array
            or self.typing.of(s.value).is_array) or isinstance(s, Expr) for s in walk(body))


