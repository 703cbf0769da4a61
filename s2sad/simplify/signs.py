"""signs: negations move to the front of products, where two cancel.

    x_bar -= a * -seed / s          ->   x_bar += a * seed / s
    -seed / s if -seed != 0.0 ...   ->   -seed / s if seed != 0.0 ...
    -(a * -(b * c))                 ->   a * (b * c)

Exact in floating point. A negation of a product's first factor stays, as in a kernel's own `-k * slope`.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Add, AugAssign, BinOp, Compare, Constant, Div, Eq, IfExp, Mult, Name, NotEq, Sub, UnaryOp, USub, augment,
)


def normalize_signs(node: AST) -> AST:
    """An operation, whose operands are in order, with its negations moved to the front."""
    if isinstance(node, BinOp) and isinstance(node.op, (Mult, Div)):
        return _factor_out_signs(node)
    if isinstance(node, UnaryOp) and isinstance(node.op, USub) and is_negation(node.operand):
        return node.operand.operand
    if isinstance(node, Compare) and len(node.ops) == 1 and isinstance(node.ops[0], (Eq, NotEq)) and is_negation(
            node.left) and _is_zero(node.comparators[0]):
        return Compare(node.left.operand, node.ops, node.comparators)
    return node


def normalize_increment(statement: AugAssign) -> AugAssign:
    """An increment by a negation as a decrement, and the other way round."""
    value, op = statement.value, statement.op
    if not isinstance(op, (Add, Sub)):
        return statement
    opposite = Sub() if isinstance(op, Add) else Add()
    if isinstance(value, IfExp) and _is_zero(value.orelse) and is_negation(value.body):
        return augment(statement.target, opposite, IfExp(value.test, value.body.operand, value.orelse))
    return augment(statement.target, opposite, value.operand) if is_negation(value) else statement


def is_negation(node: AST) -> bool:
    return isinstance(node, UnaryOp) and isinstance(node.op, USub)


def _is_zero(node: AST) -> bool:
    return isinstance(node, Constant) and type(node.value) is float and node.value == 0.0


def _factor_out_signs(node: BinOp) -> AST:
    left, right = node.left, node.right
    if is_negation(right) and is_negation(left):
        return BinOp(left.operand, node.op, right.operand)
    if is_negation(right) and not isinstance(right.operand, Constant):
        return UnaryOp(USub(), BinOp(left, node.op, right.operand))
    if is_negation(left) and not isinstance(left.operand, (Name, Constant)):
        return UnaryOp(USub(), BinOp(left.operand, node.op, right))
    return node
