"""decision_reads: the floats whose last digits decide something: a branch, an index, an integer, a side of a choice.

    if u[i] > 0.0:              u decides
        y = u[i] * abs(v[i])    v decides, for its sign is asked for; u does not
    y = np.exp(w[k])            w does not

Requires normal form and types.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad import rules
from s2sad.analyze.context import CallFacts
from s2sad.analyze.program_structure import heads
from s2sad.analyze.uses import Choices
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import ALLOCATIONS
from s2sad.live_objects.registry import ROOM
from s2sad.liveness import base_name, targets
from s2sad.rules.operation import operation
from s2sad.rules.power import POWERS
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, BoolOp, Call, Compare, For, FunctionDef, If, IfExp, Name, Not, Subscript, UnaryOp,
    While, call_name, children, user_call, walk_statements,
)

_SMOOTH = frozenset({*POWERS, "numpy.sqrt", "math.sqrt", "numpy.hypot", "math.hypot"})  # but for one point, the last
_SOLVING = frozenset({"numpy.linalg.solve", "numpy.linalg.inv"})
_COPIES = frozenset({"numpy.copy", "numpy.full", "numpy.full_like", "builtins.tuple"})

class DecisionReads:
    """What decides in one function; `calls` knows the kernels that it calls, `choices` has the names of what decides
    choices, which are asked in place of the operands."""

    def __init__(self, typing: Typing, calls: CallFacts, choices: Choices):
        self.typing, self.calls, self.choices = typing, calls, choices

    def of(self, statement: AST) -> set[str]:
        """The names of floats that decide something in a statement without its blocks."""
        compound = isinstance(statement, (For, If, While))
        found = {n for head in heads(statement) for n in self.reads(head, compound)}
        if isinstance(statement, Assign) and self.is_rough(statement.value):
            found |= {base_name(t) for t in targets(statement) if self.typing.of(t).is_inexact}    # the result is asked
        return found

    def reads(self, node: AST, deciding: bool) -> Iterator[str]:
        """The names of floats that decide in an expression, all that it reads if it is `deciding` itself."""
        if isinstance(node, Name):
            if deciding and node.id in self.typing.table and self.typing.of(node).is_inexact:
                yield node.id
            return
        if isinstance(node, Attribute) or call_name(node) == "builtins.len":
            return
        for part, inner in self.parts(node, deciding):
            yield from self.reads(part, inner)

    def parts(self, node: AST, deciding: bool) -> Iterator[tuple[AST, bool]]:
        """The parts of an expression, each with whether it decides."""
        if isinstance(node, Subscript):
            yield node.value, deciding
            yield node.slice, True
        elif isinstance(node, IfExp):
            yield node.test, True
            yield node.body, deciding
            yield node.orelse, deciding
        elif isinstance(node, (Compare, BoolOp)) or isinstance(node, UnaryOp) and isinstance(node.op, Not):
            yield from ((part, True) for part in children(node))
        elif isinstance(node, Call):
            yield from self.call(node, deciding)
        else:
            rough = self.is_rough(node)
            yield from ((part, deciding or rough) for part in children(node))

    def call(self, node: Call, deciding: bool) -> Iterator[tuple[AST, bool]]:
        """The arguments of a call."""
        called = call_name(node) or ""
        if called in ALLOCATIONS and called not in _COPIES:
            return
        rule, found, rough = rules.find_array(called), operation(node), self.is_rough(node)
        arguments = [*node.args, *(k.value for k in node.keywords)]
        if user_call(node):
            asked = self.calls.decides(node)
            yield from ((a, deciding or k in asked) for k, a in enumerate(arguments))
        elif found is not None:
            yield from ((operand, deciding or rough or p in found[0].zero) for p, operand in found[1].items())
        elif rule is not None and not rough:
            yield from ((a, deciding or p not in rule.adjoints) for p, a in zip(rule.operands, node.args))
        else:
            yield from ((a, deciding or rough) for a in arguments)

    def floats(self, statement: AST) -> set[str]:
        """The names of all floats that a statement without blocks reads."""
        return {n for head in heads(statement) for n in self.reads(getattr(head, "value", None) or head, True)}

    def written(self, statement: AST) -> set[str]:
        """The names that a statement binds or writes."""
        return {base_name(t) for t in (*targets(statement), *self.calls.writes(statement))}

    def is_rough(self, node: AST) -> bool:
        """Whether the value of an operation or its partials may jump where its operands change, and the choice has no
        name; of a call of a kernel's it is another question."""
        found = operation(node)
        if found is None:
            rule, called = rules.find_array(call_name(node)), call_name(node)
            linear = rule is not None and rule.tangent is None or called in _SOLVING or called in _COPIES
            return isinstance(node, BinOp) or isinstance(node, Call) and not (linear or user_call(node))
        rule, operands = found
        if all((id(node), p) in self.choices for p in operands if rule.chooses(p)) and any(map(rule.chooses, operands)):
            return False
        return bool(rule.kink) and rule.name not in _SMOOTH or rule.name.startswith(ROOM)


def deciding_parameters(function: FunctionDef, asked: DecisionReads) -> frozenset[int]:
    """The positions of a function's parameters on which hangs what it decides."""
    statements = list(walk_statements(function.body))
    found = {n for s in statements for n in asked.of(s)}
    while True:
        more = {n for s in statements if not found.isdisjoint(asked.written(s)) for n in asked.floats(s)}
        if more <= found:
            return frozenset(k for k, p in enumerate(function.args.args) if p.id in found)
        found |= more

