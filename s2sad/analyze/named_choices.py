"""named_choices: what decides a choice between numbers has a name, so that the adjoint asks who won, not what competed.

    def f(x, m):
        for i in range(len(x)):
            m = max(m, x[i])
        return m

in A-normal form:

    def f(x, m):                        def f(x, m):
        m_1 = m                             m_1 = m
        for i in range(len(x)):             for i in range(len(x)):
            m_2 = max(m_1, x[i])                taken = x[i] > m_1
            m_1 = m_2                           m_2 = max(m_1, x[i])
        return m_1                              m_1 = m_2
                                            return m_1

The partials of minima, maxima, `clip` and `where` read their operands in a comparison alone. Its outcome takes a byte
where the operands take eight each; where they are at hand, it is computed again. Ties and nan decide as they do in the
rule, whose own condition gets the name.

*Requires* A-normal form; *establishes* `context.choices`, the names by operation and operand. In loops only: what runs
once is recorded at no cost.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.uses import operated
from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.infer.types import BOOL
from s2sad.naming import Names
from s2sad.rules.rule import RESULT, Rule
from s2sad.tree import (
    AST, Assign, AugAssign, Call, Constant, For, FunctionDef, Name, While, assign, at, dump, name, walk, with_body,
)


def named_choices(function: FunctionDef, context: AnalysisContext) -> FunctionDef:
    """The function with names for its choices in loops."""
    naming = _Naming(context.typing, context.names)
    body = [naming.outside(s) for s in function.body]
    context.choices = naming.choices
    return with_body(function, body) if naming.choices else function


class _Naming:
    def __init__(self, typing: Typing, free: Names):
        self.typing, self.free = typing, free
        self.choices: dict[tuple[int, str], str] = {}

    def outside(self, statement: AST) -> AST:
        if isinstance(statement, (For, While)):
            return self.inside(statement)
        return with_blocks(statement, lambda block: [self.outside(s) for s in block])

    def inside(self, statement: AST) -> AST:
        return with_blocks(statement, lambda block: [s for old in block for s in (
            *self.named(old), self.inside(old))])

    def _is_number(self, node: AST) -> bool:
        kind = self.typing.of(node)
        return kind.is_number and kind.is_inexact

    def named(self, statement: AST) -> list[AST]:
        """The bindings of what decides the choices of a statement."""
        if not isinstance(statement, (Assign, AugAssign)):
            return []
        made: dict[str, tuple[str, AST]] = {}
        for node in walk(statement.value):
            found = operated(node, self.typing) if self._is_number(node) else None
            for parameter, test in _tests(*found).items() if found else ():
                if isinstance(test, (Name, Constant)):
                    continue
                key = dump(test)
                if key not in made:
                    held = self.typing.declare(self.free.fresh("taken"), BOOL)
                    made[key] = held, at(assign(held, test), statement)
                self.choices[id(node), parameter] = made[key][0]
        return [binding for _, binding in made.values()]


def _tests(rule: Rule, operands: Mapping[str, AST]) -> dict[str, AST]:
    """What decides whether an operand is taken, where the partial is a choice of two numbers by the operands alone."""
    asked = [p for p in rule.parameters if rule.chooses(p) and RESULT not in rule.uses(p, operands)]
    partials = {p: rule.partial(p, operands, name(RESULT)) for p in asked}
    return {p: partial.args[0] for p, partial in partials.items() if isinstance(partial, Call)}


__all__ = ["named_choices"]
