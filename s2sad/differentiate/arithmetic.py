"""arithmetic: products and sums of trees in the form of a text by hand: no factors 1, no terms 0, signs in front."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from s2sad.tree import (
    AST, Add, BinOp, Constant, Div, IfExp, Mult, Name, NotEq, Sub, Subscript, UnaryOp, USub, call, call_name,
    compare, const, copy, rebuild,
)


@dataclass(frozen=True)
class Term:
    """An expression with a sign."""
    tree: AST
    negative: bool = False

    def times(self, factor: AST) -> Term:
        """The product with a factor: partial * seed, the sign apart.

        >>> from s2sad.tree import dump, expression
        >>> dump(Term(expression("s")).times(expression("-1.0 / b")).tree)
        "BinOp(Name('s'), Div(), Name('b'))"
        """
        factor, negative = unsigned(factor)
        return Term(product(factor, self.tree), self.negative != negative)

    def expression(self) -> AST:
        return UnaryOp(USub(), self.tree) if self.negative else self.tree


def unsigned(node: AST) -> tuple[AST, bool]:
    """The expression without its sign, and whether it was negative."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner, negative = unsigned(node.operand)
        return inner, not negative
    if isinstance(node, BinOp) and isinstance(node.op, (Mult, Div)):
        left, negative = unsigned(node.left)
        return (BinOp(left, node.op, node.right), negative)
    return node, False


def is_one(node: AST) -> bool:
    return isinstance(node, Constant) and not isinstance(node.value, bool) and node.value == 1


def product(factor: AST, seed: AST) -> AST:
    if is_one(factor):
        return seed
    if is_one(seed):
        return factor
    if isinstance(factor, BinOp) and isinstance(factor.op, Div) and is_one(factor.left) and isinstance(
            factor.right, Constant):
        return BinOp(seed, Mult(), factor)
    if isinstance(factor, BinOp) and isinstance(factor.op, Div):
        return BinOp(product(factor.left, seed), Div(), factor.right)
    return BinOp(factor, Mult(), seed)


def total(terms: list[Term]) -> Term:
    """The sum of terms; negative as a whole if its first term is."""
    first, *rest = terms
    made = first.tree
    for term in rest:
        plus = term.negative == first.negative
        made = BinOp(made, Add() if plus else Sub(), term.tree)
    return Term(made, first.negative)


def zero_unless(seed: AST, term: Term, whole: bool) -> Term:
    """The term, and exactly zero where the seed is: also against an infinite partial."""
    test = compare(copy(seed), NotEq(), const(0.0))
    made = call("numpy.where", test, term.tree, const(0.0)) if whole else IfExp(test, term.tree, const(0.0))
    return Term(made, term.negative)


def choice_product(tangent: Term, partial: AST) -> Term | None:
    """The product of a tangent or a seed with a partial that is a choice between something and zero: zero there,
    whatever the other is."""
    if isinstance(partial, IfExp):
        test, sides = partial.test, [partial.body, partial.orelse]
    elif call_name(partial) == "numpy.where" and len(partial.args) == 3:
        test, *sides = partial.args
    else:
        return None
    zero = [isinstance(s, Constant) and type(s.value) is float and s.value == 0.0 for s in sides]
    if zero[0] == zero[1]:
        return None
    made = tangent.times(sides[zero.index(False)])
    left, right = (const(0.0), made.tree) if zero[0] else (made.tree, const(0.0))
    return Term(IfExp(test, left, right) if isinstance(partial, IfExp) else call("numpy.where", test, left, right),
                made.negative)


def scalar_choices(node: AST, chosen: Callable[[AST], bool] = lambda n: True) -> AST:
    """`numpy.where(c, a, b)` on numbers as `a if c else b`, where it is `chosen`."""
    def change(n: AST) -> AST | None:
        if call_name(n) == "numpy.where" and chosen(n):
            return IfExp(*(scalar_choices(n.args[k], chosen) for k in (0, 1, 2)))
        return None
    return rebuild(node, change)


def is_plain(node: AST) -> bool:
    """Whether an expression may be repeated at no cost."""
    if isinstance(node, UnaryOp):
        return is_plain(node.operand)
    return isinstance(node, (Name, Constant)) or isinstance(node, Subscript) and isinstance(node.value, Name)
