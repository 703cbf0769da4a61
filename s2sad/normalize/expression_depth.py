"""expression_depth: no value is made by more operations one in the other than _MOST, if their derivatives read
operands.

    def f(a, b):
        return a * b * a * b * a * b * a * b * a * b * a * b * a * b * a * b * a * b * a
becomes

    def f(a, b):
        part = a * b * a * b * a * b * a * b * a * b * a * b * a * b * a * b * a
        return part * b * a

The derivative of each operation writes its operands again, so that a product of n factors has derivatives of n * n
factors; sums have not, and stay as long as they are. Requires structured form and types;
establishes a bound on the length of derivatives. What a branch of an expression computes stays there.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.rules.operation import operation
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Call, Compare, Constant, For, FunctionDef, If, IfExp, Name, Return, Subscript,
    While, assign, at, call_name, children, copy, name, rebuild, with_body,
)

_MOST = 16


def expression_depth(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with names for parts of such values."""
    typing, free = context.typing, context.names
    return with_body(function, _Parts(typing, free).block(function.body))


class _Parts:
    def __init__(self, typing: Typing, free: Names):
        self.typing, self.free = typing, free
        self.cut: set[AST] = set()          # what gets a name

    def block(self, block: list[AST]) -> list[AST]:
        return [made for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, While, If)):
            return [with_blocks(statement, self.block)]
        if not isinstance(statement, (Assign, AugAssign, Return)) or statement.value is None:
            return [statement]
        self.cut = set()
        self.depth(statement.value)
        if not self.cut:
            return [statement]
        before: list[AST] = []

        def change(node: AST) -> AST | None:
            if node not in self.cut:
                return None
            self.cut.remove(node)
            held = self.typing.declare(self.free.numbered("part"), self.typing.of(node))
            value = rebuild(node, change)
            before.append(at(assign(held, value), statement))
            return at(name(held), node)
        made = copy(statement)
        made.value = rebuild(statement.value, change)
        return [*before, made]

    def depth(self, node: AST) -> int:
        """How many operations whose derivatives read operands lie one in the other; what is deeper is cut."""
        if isinstance(node, (Name, Constant, Subscript, Compare, BoolOp, IfExp)) or call_name(node) == "numpy.where":
            return 0
        found = operation(node) if self.typing.of(node).is_inexact else None
        if found is None:
            return max(map(self.depth, children(node)), default=0) if isinstance(node, Call) else 0
        rule, operands = found
        deep = {p: self.depth(o) for p, o in operands.items()}
        if not any(rule.uses(p, operands) for p in operands if p not in rule.zero):
            return max(deep.values(), default=0)
        for parameter, count in deep.items():
            if count >= _MOST:
                self.cut.add(operands[parameter])
                deep[parameter] = 0
        return 1 + max(deep.values(), default=0)


__all__ = ["expression_depth"]
