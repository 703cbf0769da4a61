"""signs: a minus inside a product goes out of it, and two of them go.

    x_bar -= a * -seed / s          ->   x_bar += a * seed / s
    -seed / s if -seed != 0.0 ...   ->   -seed / s if seed != 0.0 ...
    -(a * -(b * c))                 ->   a * (b * c)

Exact in floating point. A minus at the front of a product stays, as in a kernel's own `-k * slope`.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Add, AugAssign, BinOp, Compare, Constant, Div, Eq, IfExp, Mult, Name, NotEq, Sub, UnaryOp, USub, augment,
)


def signed(node: AST) -> AST:
    """An operation, whose operands are done, with its signs put in order."""
    if isinstance(node, BinOp) and isinstance(node.op, (Mult, Div)):
        return _product(node)
    if isinstance(node, UnaryOp) and isinstance(node.op, USub) and is_minus(node.operand):
        return node.operand.operand
    if isinstance(node, Compare) and len(node.ops) == 1 and isinstance(node.ops[0], (Eq, NotEq)) and is_minus(
            node.left) and _is_zero(node.comparators[0]):
        return Compare(node.left.operand, node.ops, node.comparators)
    return node


def gained(statement: AugAssign) -> AugAssign:
    """A gain of something negative as a loss, and the other way round."""
    value, op = statement.value, statement.op
    if not isinstance(op, (Add, Sub)):
        return statement
    opposite = Sub() if isinstance(op, Add) else Add()
    if isinstance(value, IfExp) and _is_zero(value.orelse) and is_minus(value.body):
        return augment(statement.target, opposite, IfExp(value.test, value.body.operand, value.orelse))
    return augment(statement.target, opposite, value.operand) if is_minus(value) else statement


def is_minus(node: AST) -> bool:
    return isinstance(node, UnaryOp) and isinstance(node.op, USub)


def _is_zero(node: AST) -> bool:
    return isinstance(node, Constant) and type(node.value) is float and node.value == 0.0


def _product(node: BinOp) -> AST:
    left, right = node.left, node.right
    if is_minus(right) and is_minus(left):
        return BinOp(left.operand, node.op, right.operand)
    if is_minus(right) and not isinstance(right.operand, Constant):
        return UnaryOp(USub(), BinOp(left, node.op, right.operand))
    if is_minus(left) and not isinstance(left.operand, (Name, Constant)):
        return UnaryOp(USub(), BinOp(left.operand, node.op, right))
    return node
