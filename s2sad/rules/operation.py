"""The rule behind an operation of a tree, with its operands by parameter."""
from __future__ import annotations

from s2sad.rules.rule import TABLE, Rule
from s2sad.tree import AST, BinOp, Call, UnaryOp, call_name

_BINARY = {"Add": "a + b", "Sub": "a - b", "Mult": "a * b", "Div": "a / b", "Pow": "a ** b", "Mod": "a % b"}
_UNARY = {"USub": "-a", "UAdd": "+a"}


def operation(node: AST) -> tuple[Rule, dict[str, AST]] | None:
    """The rule and the operands of an operator or a call, or None if it has no rule.

    >>> from s2sad.tree import expression
    >>> rule, operands = operation(expression("u / dx"))
    >>> rule.name, sorted(operands)
    ('a / b', ['a', 'b'])
    """
    if isinstance(node, BinOp):
        rule = TABLE.rules.get(_BINARY.get(type(node.op).__name__, ""))
        return rule and (rule, dict(zip(rule.parameters, (node.left, node.right))))
    if isinstance(node, UnaryOp):
        rule = TABLE.rules.get(_UNARY.get(type(node.op).__name__, ""))
        return rule and (rule, {rule.parameters[0]: node.operand})
    name = call_name(node)
    rule = TABLE.rules.get(name or "")
    if rule is None or not isinstance(node, Call) or node.keywords or len(node.args) != len(rule.parameters):
        return None
    return rule, dict(zip(rule.parameters, node.args))
