"""forward_substitution: a name that is read once is replaced by the expression that it is bound to, and copies of names
are propagated.

    def f(x: float64[:], y: float64[:]):
        x[0] = x[0] * y[0]

in its adjoint:

    def f_adjoint(...):                 def f_adjoint(...):
        x_here = x[0]                       seed = x_bar[0]
        seed = x_bar[0]                     y_bar[0] += x[0] * seed
        x_here_bar = y[0] * seed            x_bar[0] = y[0] * seed
        y_bar[0] += x_here * seed
        x_bar[0] = x_here_bar

*Requires* a structured function. *Establishes* the same values: between the definition and the use nothing overwrites
an operand, and nothing moves into a loop, where it would be computed more often.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.liveness import base_name, targets
from s2sad.blocks import heads, with_blocks
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, Call, Constant, For, FunctionDef, If, Name, Store, Subscript, UnaryOp, While, call_name,
    names, substitute, user_call, walk, with_body,
)

CHANGES_ROUNDING = False

Writes = Callable[[Call], list[str]]


def forward_substitution(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such names folded; the user's stay."""
    kept = context.parameters(function) | {context.renamed.get(n, n) for n in context.kept_names}
    pass_ = _ForwardSubstitution(function, kept, context.effects.writes)
    return with_body(function, pass_.block(function.body))


class _ForwardSubstitution:
    def __init__(self, function: FunctionDef, kept: set[str], writes: Writes):
        self.kept, self.writes = kept, writes
        self.bound: dict[str, int] = {}
        self.read: dict[str, int] = {}
        for node in walk(function.body):
            if isinstance(node, Name):
                table = self.bound if isinstance(node.ctx, Store) else self.read
                table[node.id] = table.get(node.id, 0) + 1
            if isinstance(node, AugAssign) and isinstance(node.target, Name):
                self.bound[node.target.id] = self.bound.get(node.target.id, 0) + 1

    def block(self, block: list[AST]) -> list[AST]:
        block = [with_blocks(s, self.block) for s in block]
        position = 0
        while position < len(block):
            statement = block[position]
            rest = self.substituted(statement, block[position + 1:]) if self.is_substitutable(statement) else None
            if rest is None:
                position += 1
            else:
                block = block[:position] + rest
        return block

    def is_substitutable(self, statement: AST) -> bool:
        if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
            return False
        target, value = statement.targets[0].id, statement.value
        if target in self.kept or self.bound.get(target) != 1 or (call_name(value) or "").startswith(
                ("user.", "numpy.empty", "numpy.zeros", "numpy.copy", "runtime.", "builtins.list")):
            return False
        plain = isinstance(value, (Name, Constant)) or isinstance(value, UnaryOp) and isinstance(
            value.operand, (Name, Constant))
        reads = self.read.get(target, 0)
        return reads == 1 or plain

    def substituted(self, statement: Assign, rest: list[AST]) -> list[AST] | None:
        """The statements behind the definition with the name replaced, or None if it must stay."""
        target, value = statement.targets[0].id, statement.value
        reads = set(names(value)) | {base_name(n) for n in walk(value) if isinstance(n, Subscript)}
        left, new = self.read.get(target, 0), list(rest)
        for position, item in enumerate(rest):
            inside = sum(isinstance(n, Name) and n.id == target and not isinstance(n.ctx, Store) for n in walk(item))
            if inside:
                plain = isinstance(value, (Name, Constant, UnaryOp))
                if isinstance(item, (For, While, If)) and not (plain or self.uses_in_heads(item, target) == inside and
                                                               not isinstance(item, While)):
                    return None
                if isinstance(item, (For, While, If)) and self.uses_in_heads(item, target) != inside and \
                        reads & self.overwritten(item):
                    return None
                new[position] = substitute(item, {target: value})
                left -= inside
                if left == 0:
                    return new
            if reads & self.overwritten(item):
                return None
        return None

    def uses_in_heads(self, item: AST, target: str) -> int:
        return sum(isinstance(n, Name) and n.id == target for head in heads(item) for n in walk(head))

    def overwritten(self, item: AST) -> set[str]:
        found: set[str] = set()
        for node in walk(item):
            found |= {base_name(t) for t in targets(node)}
            if user_call(node):
                found |= set(self.writes(node))
        return found
