"""algebra: arithmetic with constants is done, and what it leaves is written as one would by hand.

    x ** (2 - 1)   ->   x           range(n - 1, 0 - 1, -1)   ->   range(n - 1, -1, -1)
    y + -1.0 * z   ->   y - z       i + 1 - 1                 ->   i
    a if c else a  ->   a

Only what is exact in floating point: integers are computed, factors one and double signs go.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.bounded_arithmetic import is_bounded
from s2sad.infer.types import Type
from s2sad.simplify.signs import gained, signed
from s2sad.simplify.whole import is_whole, with_counters
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BitAnd, BitOr, BitXor, Call, Constant, Expr, For, FunctionDef, If, IfExp,
    Mult, Pow, Return, Slice, Sub, Tuple, USub, UnaryOp, While, at, augment, call_name, const, copy, equal, walk,
    with_body,
)

CHANGES_ROUNDING = True

# calls whose results are never bools
_NUMBERS = frozenset([f"builtins.{name}" for name in ("int", "float", "len", "complex")] + [
    f"math.{name}" for name in ("ceil", "cos", "exp", "fabs", "floor", "hypot", "log", "pow", "sin", "sqrt", "tan",
                                "tanh")])
_ALIKE = ("builtins.max", "builtins.min")
_SUMS = (BinOp, UnaryOp, Slice, Tuple)


def algebra(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function with simple arithmetic."""
    types = with_counters(types, function)
    return with_body(function, [_statement(s, types) for s in function.body])


def _statement(statement: AST, types: Mapping[str, Type]) -> AST:
    def simple(node: AST) -> AST:
        return simplified(node, types)

    def block(statements: list[AST]) -> list[AST]:
        return [_statement(s, types) for s in statements]
    if isinstance(statement, For):
        made: AST = For(statement.target, simple(statement.iter), block(statement.body), [], None)
    elif isinstance(statement, While):
        made = While(simple(statement.test), block(statement.body), [])
    elif isinstance(statement, If):
        made = If(simple(statement.test), block(statement.body), block(statement.orelse))
    elif isinstance(statement, AugAssign):
        made = gained(augment(simple(statement.target), statement.op, simple(statement.value)))
    elif isinstance(statement, (Assign, Return, Expr)):
        made = copy(statement)
        if isinstance(statement, Assign):
            made.targets = [simple(statement.targets[0])]
        if statement.value is not None:
            made.value = simple(statement.value)
    else:
        return statement
    return at(made, statement)


def integer(node: AST) -> int | None:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = integer(node.operand)
        return None if inner is None else -inner
    if isinstance(node, Constant) and isinstance(node.value, int) and not isinstance(node.value, bool):
        return node.value
    return None


def simple(node: AST, integers: bool = False) -> AST:
    """`simplified` for what a transformation of loops has made of bounds and subscripts, whose names are integers."""
    return simplified(node, None, integers)


def simplified(node: AST, types: Mapping[str, Type] | None, integers: bool = False) -> AST:
    """The expression with its arithmetic done, innermost first; sums are reordered only among integers: where
    `integers` are meant, what is_whole by its types."""
    called = call_name(node)
    integers = called == "builtins.range" or integers and (
        types is not None or called in _ALIKE or isinstance(node, _SUMS))
    new = type(node)(*[_field(getattr(node, f), types, integers or f == "slice") for f in node._fields])
    if hasattr(node, "lineno"):
        at(new, node)
    new = signed(new)
    if isinstance(new, IfExp) and equal(new.body, new.orelse) and not _calls(new.test):
        return new.body
    return _binary(new, types, integers) if isinstance(new, BinOp) else new


def _calls(node: AST) -> bool:
    """Whether an expression calls a kernel, which may write its arguments or raise."""
    return any((call_name(n) or "").startswith("user.") for n in walk(node))


def _field(value: object, types: Mapping[str, Type] | None, integers: bool) -> object:
    if isinstance(value, list):
        return [_field(v, types, integers) for v in value]
    return simplified(value, types, integers) if isinstance(value, AST) else value


def _binary(node: BinOp, types: Mapping[str, Type] | None, integers: bool) -> AST:
    left, right = integer(node.left), integer(node.right)
    if isinstance(node.op, (Add, Sub)) and (
            left is not None and right is not None or integers and is_whole(node, types)):
        return _sum(node, left, right)
    if isinstance(node.op, (Add, Sub)):
        return _signed(node)
    if isinstance(node.op, Mult) and left is not None and right is not None and is_bounded(left * right):
        return const(left * right)
    if isinstance(node.op, Mult) and (left == 1 or right == 1):
        other = node.right if left == 1 else node.left
        return other if integers and is_whole(other, types) or not _may_be_bool(other) else node
    if isinstance(node.op, Pow) and right == 1 and (
            integers and is_whole(node.left, types) or not _may_be_bool(node.left)):
        return node.left
    return node


def _may_be_bool(node: AST) -> bool:
    """Whether an expression may be a bool, which times 1 is a number: a sum of two bools is a bool."""
    if isinstance(node, BinOp):
        return isinstance(node.op, (BitAnd, BitOr, BitXor, Add, Mult)) and _may_be_bool(node.left) and _may_be_bool(
            node.right)
    if isinstance(node, Constant):
        return isinstance(node.value, bool)
    return not isinstance(node, Call) or call_name(node) not in _NUMBERS


def _sum(node: BinOp, left: int | None, right: int | None) -> AST:
    plus = isinstance(node.op, Add)
    if left is not None and right is not None:
        return const(left + right if plus else left - right)
    if right is not None:
        shift = right if plus else -right
        inner = node.left
        known = integer(inner.right) if isinstance(inner, BinOp) and isinstance(inner.op, (Add, Sub)) else None
        if known is not None:
            return shifted(inner.left, shift + (known if isinstance(inner.op, Add) else -known))
        return shifted(inner, shift)
    if left == 0 and plus:
        return node.right
    return _signed(node)


def _signed(node: BinOp) -> AST:
    value = node.right
    if isinstance(value, UnaryOp) and isinstance(value.op, USub):
        return BinOp(node.left, Sub() if isinstance(node.op, Add) else Add(), value.operand)
    return node


def shifted(node: AST, shift: int) -> AST:
    if shift == 0:
        return node
    return BinOp(node, Add() if shift > 0 else Sub(), const(abs(shift)))


