"""direction_expressions: an expression of one direction in a loop over directions, and what is the same before it.

    2.0 * x[i] * x_dot[i]       factor = 2.0 * x[i]
                                ... factor * x_dot[i, b] ...
"""
from __future__ import annotations

from s2sad.optimize.directions.dependent_names import mentioned
from s2sad.optimize.directions.layouts import Apart, Interleaved
from s2sad.naming import Names
from s2sad.tree import (
    AST, Assign, BinOp, BoolOp, Call, Compare, Constant, IfExp, Name, Subscript, UnaryOp, assign, const, copy, equal,
    name, rebuild, replica,
)

_COMPUTED = (BinOp, BoolOp, Call, Compare, IfExp, Subscript, UnaryOp)


class Expressions:
    """The expressions of one function: the names that depend on the direction, how these lie, the name of the direction
    and what is to be bound before the loop that is being made."""

    def __init__(self, dependent: set[str], layout: Apart | Interleaved, free: Names, b: str):
        self.dependent, self.layout, self.free, self.b = dependent, layout, free, b
        self.before: list[Assign] = []

    def sizes(self, node: AST) -> AST:
        """What is the same for all directions, where it asks for the size of what is not: that of the first."""
        if not mentioned(node, self.dependent):
            return copy(node)
        return self.each(node, const(0))

    def each(self, node: AST, b: AST) -> AST:
        """An expression or a statement for one direction."""
        def change(part: AST) -> AST | None:
            if isinstance(part, Subscript) and isinstance(part.value, Name) and part.value.id in self.dependent:
                made = self.layout.part(part.value.id, rebuild(part.slice, change), copy(b))
                made.ctx = part.ctx
                return made
            if isinstance(part, Name) and part.id in self.dependent:
                made = self.layout.named(part.id, copy(b))
                made.ctx = part.ctx
                return made
            return None
        return rebuild(node, change)

    def factor(self, node: AST) -> Name:
        """The name of what is the same for all directions, bound before the loop over them."""
        for known in self.before:
            if equal(known.value, node):
                return name(known.targets[0].id)
        made = self.free.fresh("factor")
        self.before.append(assign(made, copy(node)))
        return name(made)

    def lowered(self, node: AST, eager: bool) -> AST:
        """An expression or a statement in a loop over directions; what is the same for all of them has a name that is
        bound before, where it is certain to be computed."""
        if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in self.dependent or (
                isinstance(node, Name)):
            return self.each(node, name(self.b))
        if not mentioned(node, self.dependent):
            return self.factor(node) if eager and isinstance(node, _COMPUTED) and not _is_sign(node) else copy(node)
        if isinstance(node, IfExp):
            return IfExp(self.lowered(node.test, eager), self.lowered(node.body, False),
                         self.lowered(node.orelse, False))
        if isinstance(node, BoolOp):
            return BoolOp(node.op, [self.lowered(v, eager and not k) for k, v in enumerate(node.values)])

        def below(value, field):
            if field == "func":
                return copy(value)
            return [self.lowered(v, eager) for v in value] if isinstance(value, list) else self.lowered(value, eager)
        return replica(node, below)

    def in_loop(self, node: AST) -> tuple[list[Assign], AST]:
        """What is bound before a loop over directions, and what runs in it for one."""
        outer, self.before = self.before, []
        made = self.lowered(node, True)
        before, self.before = self.before, outer
        return before, made


def _is_sign(node: AST) -> bool:
    return isinstance(node, UnaryOp) and isinstance(node.operand, Constant)
