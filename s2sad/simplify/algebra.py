"""algebra: constant folding and algebraic identities that are exact in floating point.

    def f(x: float64[:], y: float64[:]):
        for i in range(1, x.size - 1):
            y[i] = -x[i - 1] / x[i + 1]

in its adjoint:

    def f_adjoint(...):
        for i in range(x.size - 1 - 1, 0, -1):
            ...
            x_bar[i + 1] -= -x[i - 1] / x[i + 1] * seed / x[i + 1] if seed != 0.0 else 0.0

becomes

    def f_adjoint(...):
        for i in range(x.size - 2, 0, -1):
            ...
            x_bar[i + 1] += x[i - 1] / x[i + 1] * seed / x[i + 1] if seed != 0.0 else 0.0

*Requires* the types of the names. *Establishes* the same values: sums of integers are folded and reassociated, factors
and exponents of one and double negations go, `y + -1.0 * z` is `y - z`, a choice between equals is one of them; sums of
floats keep their order.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.bounded_arithmetic import is_bounded
from s2sad.infer.types import Type
from s2sad.simplify.context import DerivativeContext
from s2sad.simplify.signs import normalize_increment, normalize_signs
from s2sad.simplify.integer_expressions import is_integer, with_counters
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BitAnd, BitOr, BitXor, Call, Constant, Expr, For, FunctionDef, If, IfExp, Mult,
    Pow, Return, Slice, Sub, Tuple, USub, UnaryOp, While, at, augment, call_name, calls_kernel, const, copy, equal,
    replica, with_body,
)

CHANGES_ROUNDING = True

# calls whose results are never bools
_NUMBERS = frozenset([f"builtins.{name}" for name in ("int", "float", "len", "complex")] + [
    f"math.{name}" for name in ("ceil", "cos", "exp", "fabs", "floor", "hypot", "log", "pow", "sin", "sqrt", "tan",
                                "tanh")])
_EXTREMA = ("builtins.max", "builtins.min")
_INDEX_NODES = (BinOp, UnaryOp, Slice, Tuple)


def algebra(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with its expressions simplified."""
    types = context.types
    types = with_counters(types, function)
    return with_body(function, [_statement(s, types) for s in function.body])


def _statement(statement: AST, types: Mapping[str, Type]) -> AST:
    def simple(node: AST) -> AST:
        return simplify_expression(node, types)

    def block(statements: list[AST]) -> list[AST]:
        return [_statement(s, types) for s in statements]
    if isinstance(statement, For):
        made: AST = For(statement.target, simple(statement.iter), block(statement.body), [], None)
    elif isinstance(statement, While):
        made = While(simple(statement.test), block(statement.body), [])
    elif isinstance(statement, If):
        made = If(simple(statement.test), block(statement.body), block(statement.orelse))
    elif isinstance(statement, AugAssign):
        made = normalize_increment(augment(simple(statement.target), statement.op, simple(statement.value)))
    elif isinstance(statement, (Assign, Return, Expr)):
        made = copy(statement)
        if isinstance(statement, Assign):
            made.targets = [simple(statement.targets[0])]
        if statement.value is not None:
            made.value = simple(statement.value)
    else:
        return statement
    return at(made, statement)


def integer_literal(node: AST) -> int | None:
    """The value of an integer literal, with its sign; None for anything else."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = integer_literal(node.operand)
        return None if inner is None else -inner
    if isinstance(node, Constant) and isinstance(node.value, int) and not isinstance(node.value, bool):
        return node.value
    return None


def simplify_index(node: AST, integers: bool = False) -> AST:
    """`simplify_expression` for bounds and subscripts that a loop transformation has made: all names are integers."""
    return simplify_expression(node, None, integers)


def simplify_expression(node: AST, types: Mapping[str, Type] | None, integers: bool = False) -> AST:
    """The expression simplified, innermost operands first. Sums are reassociated only among integers: `integers` says
    that the context wants one, `types` which names are."""
    called = call_name(node)
    integers = called == "builtins.range" or integers and (
        types is not None or called in _EXTREMA or isinstance(node, _INDEX_NODES))
    new = replica(node, lambda value, field: _simplify_field(value, types, integers or field == "slice"))
    if hasattr(node, "lineno"):
        at(new, node)
    new = normalize_signs(new)
    if isinstance(new, IfExp) and equal(new.body, new.orelse) and not calls_kernel(new.test):
        return new.body
    return _simplify_binary(new, types, integers) if isinstance(new, BinOp) else new


def _simplify_field(value: object, types: Mapping[str, Type] | None, integers: bool) -> object:
    if isinstance(value, list):
        return [_simplify_field(v, types, integers) for v in value]
    return simplify_expression(value, types, integers) if isinstance(value, AST) else value


def _simplify_binary(node: BinOp, types: Mapping[str, Type] | None, integers: bool) -> AST:
    left, right = integer_literal(node.left), integer_literal(node.right)
    if isinstance(node.op, (Add, Sub)) and (
            left is not None and right is not None or integers and is_integer(node, types)):
        return _integer_sum(node, left, right)
    if isinstance(node.op, (Add, Sub)):
        return _absorb_sign(node)
    if isinstance(node.op, Mult) and left is not None and right is not None and is_bounded(left * right):
        return const(left * right)
    if isinstance(node.op, Mult) and (left == 1 or right == 1):
        other = node.right if left == 1 else node.left
        return other if integers and is_integer(other, types) or not _may_be_bool(other) else node
    if isinstance(node.op, Pow) and right == 1 and (
            integers and is_integer(node.left, types) or not _may_be_bool(node.left)):
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


def _integer_sum(node: BinOp, left: int | None, right: int | None) -> AST:
    plus = isinstance(node.op, Add)
    if left is not None and right is not None:
        return const(left + right if plus else left - right)
    if right is not None:
        shift = right if plus else -right
        inner = node.left
        known = integer_literal(inner.right) if isinstance(inner, BinOp) and isinstance(inner.op, (Add, Sub)) else None
        if known is not None:
            return add_constant(inner.left, shift + (known if isinstance(inner.op, Add) else -known))
        return add_constant(inner, shift)
    if left == 0 and plus:
        return node.right
    return _absorb_sign(node)


def _absorb_sign(node: BinOp) -> AST:
    """A sum of a negation as a difference, and the other way round."""
    value = node.right
    if isinstance(value, UnaryOp) and isinstance(value.op, USub):
        return BinOp(node.left, Sub() if isinstance(node.op, Add) else Add(), value.operand)
    return node


def add_constant(node: AST, shift: int) -> AST:
    """The expression plus a constant, `n - 1` for `n + -1`."""
    if shift == 0:
        return node
    return BinOp(node, Add() if shift > 0 else Sub(), const(abs(shift)))


