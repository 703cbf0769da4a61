"""uses: what the adjoint of a statement reads of the primal.

Requires normal form and activity. What must be there falls out of the rules: the free names of the partials of the
operands that are active. Linear uses need nothing. (Hascoet, Naumann, Pascual, FGCS 21, 2005, "to be recorded".)
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from s2sad import rules
from s2sad.liveness import base_name, targets
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import ALLOCATIONS
from s2sad.rules.operation import operation
from s2sad.rules.rule import RESULT, Rule
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BoolOp, Call, Compare, Constant, IfExp, Name, Subscript, call_name, children,
    indices, name, user_call, walk,
)

Choices = Mapping[tuple[int, str], str]
"""By the `id` of an operation and a parameter: the name of what decides whether its operand is taken."""


@dataclass
class OperandUses:
    """Numbers by name, elements and whole arrays by reference."""
    names: set[str] = field(default_factory=set)
    loads: list[AST] = field(default_factory=list)

    def value(self, node: AST, typing: Typing) -> None:
        """Everything that computing an expression reads."""
        for part in walk(node):
            if isinstance(part, Name) and "." not in part.id:
                kind = typing.of(part)
                if kind.is_array:
                    continue
                self.names.add(part.id)
        self.loads.extend(loads_of(node, typing))

    def place(self, node: AST, typing: Typing) -> None:
        """The subscripts of a reference, not its content."""
        if isinstance(node, Subscript):
            for subscript in indices(node):
                self.value(subscript, typing)


def loads_of(node: AST, typing: Typing) -> Iterator[AST]:
    """The array references that an expression reads: elements, rows and whole arrays, those in subscripts too."""
    stack = [node]
    while stack:
        part = stack.pop()
        if isinstance(part, Subscript) and isinstance(part.value, Name) and typing.of(part.value).is_array:
            yield part
            stack += reversed(indices(part))
        elif isinstance(part, Name):
            if typing.of(part).is_array:
                yield part
        elif not isinstance(part, Attribute) and call_name(part) != "builtins.len":
            stack += reversed(children(part))


def sources(node: AST, typing: Typing) -> Iterator[str]:
    """The names on which an expression depends differentiably."""
    if isinstance(node, (Compare, Constant)) or isinstance(node, BoolOp) and not typing.of(node).is_inexact:
        return
    if isinstance(node, Name):
        if typing.of(node).is_inexact and not node.id.startswith(("const.", "numpy.", "math.")):
            yield node.id
        return
    if isinstance(node, Subscript):
        if typing.of(node).is_inexact and base_name(node):
            yield base_name(node)
        return
    found = operated(node, typing)
    if found:
        rule, operands = found
        for parameter, operand in operands.items():
            if parameter not in rule.zero:
                yield from sources(operand, typing)
    elif isinstance(node, (IfExp, BoolOp)):
        for side in node.values if isinstance(node, BoolOp) else (node.body, node.orelse):
            yield from sources(side, typing)
    elif isinstance(node, Call) and rules.constant_result(call_name(node) or "") is None and call_name(
            node) not in ALLOCATIONS:
        for argument in node.args:
            yield from sources(argument, typing)


class DerivativeFlow:
    """Through which expressions of a function a derivative flows, each looked at once, and with which partials."""

    def __init__(self, typing: Typing, active: frozenset[str] | set[str], choices: Choices | None = None):
        self.typing, self.active, self.choices = typing, active, choices or {}
        self._known: dict[AST, bool] = {}       # by identity

    def partial(self, node: AST, rule: Rule, parameter: str, operands: Mapping[str, AST], result: AST | None) -> AST:
        """The partial of an operation, whose value `result` holds if there is one; choices ask by their names."""
        partial = rule.partial(parameter, operands, node if result is None else result)
        held = self.choices.get((id(node), parameter))
        if held is None:
            return partial
        assert isinstance(partial, Call) and rule.chooses(parameter)
        return Call(partial.func, [name(held), *partial.args[1:]], [])

    def through(self, node: AST) -> bool:
        if isinstance(node, Name):
            return node.id in self.active and self.typing.of(node).is_inexact
        if isinstance(node, Subscript):
            return base_name(node) in self.active and self.typing.of(node).is_inexact
        if node not in self._known:
            self._known[node] = self._through(node)
        return self._known[node]

    def _through(self, node: AST) -> bool:
        found = operated(node, self.typing)
        if found:
            rule, operands = found
            return any(self.through(o) for p, o in operands.items() if p not in rule.zero)
        rule = rules.find_array(call_name(node))
        if rule is None:
            lost = isinstance(node, (Call, IfExp, BoolOp)) and not self.active.isdisjoint(sources(node, self.typing))
            assert not lost, f"no derivative was asked for of {call_name(node) or 'a choice'}"   # never a silent zero
            return False
        return any(self.through(o) for p, o in zip(rule.operands, node.args) if p in rule.adjoints)


def is_active(node: AST, typing: Typing, active: frozenset[str] | set[str]) -> bool:
    """Whether a derivative flows through an expression."""
    return DerivativeFlow(typing, active).through(node)


def operated(node: AST, typing: Typing) -> tuple[Rule, dict[str, AST]] | None:
    """The rule and the operands of an operation, for complex operands the rule that holds for them."""
    found = operation(node)
    if found is None or found[0].plane is None or not any(typing.of(o).is_complex for o in found[1].values()):
        return found
    return found[0].plane, found[1]


def reads_own_result(statement: AST) -> bool:
    """Whether a statement fills an array with a function of whole arrays: its adjoint runs while it holds that."""
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript) and \
        rules.find_array(call_name(statement.value)) is not None


def uses(statement: AST, typing: Typing, active: frozenset[str],
         call_uses: Callable[[AST, OperandUses], None], choices: Choices | None = None) -> OperandUses:
    """What the adjoint of a simple statement, a whole-array statement or a call reads."""
    found = OperandUses()
    if not isinstance(statement, (Assign, AugAssign)) or user_call(statement.value):
        if isinstance(getattr(statement, "value", None), Call):
            call_uses(statement, found)
        return found
    target = targets(statement)[0]
    if base_name(target) not in active or not typing.of(target).is_inexact:
        return found
    found.place(target, typing)
    _pull(statement.value, target if isinstance(target, Name) or reads_own_result(statement) else None,
          DerivativeFlow(typing, active, choices), found)
    return found


def _pull(node: AST, result: AST | None, flow: DerivativeFlow, found: OperandUses) -> None:
    typing = flow.typing
    if isinstance(node, (Name, Constant)) or not flow.through(node):
        return
    if isinstance(node, Subscript):
        found.place(node, typing)
        return
    if rules.find_array(call_name(node)) is not None:
        _pull_function(node, result, flow, found)
        return
    found_rule = operated(node, typing)
    assert found_rule is not None
    rule, operands = found_rule
    for parameter, operand in operands.items():
        if parameter in rule.zero or not flow.through(operand):
            continue
        found.value(flow.partial(node, rule, parameter, operands, result), typing)
        _pull(operand, None, flow, found)


def _pull_function(node: AST, result: AST | None, flow: DerivativeFlow, found: OperandUses) -> None:
    typing = flow.typing
    rule = rules.find_array(call_name(node))
    assert rule is not None and isinstance(node, Call)
    arguments, ranks = rule.arguments(node), tuple(typing.of(a).rank for a in node.args)
    for parameter in rule.adjoints:
        operand = arguments[parameter]
        if flow.through(operand):
            for free in sorted(rule.uses(parameter, ranks)):
                found.value((node if result is None else result) if free == RESULT else arguments[free], typing)
            _pull(operand, None, flow, found)
