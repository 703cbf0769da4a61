"""The law of zeros, for both modes: a derivative is a sum, over the ways from an input to an output, of products of
partials, a seed and a tangent; where one factor of a product is exactly zero, so is the product, whatever the others.

    x_bar += np.where(seed != 0.0, np.log(x) * seed, 0.0)           of np.where(x > 0.0, x * np.log(x), 0.0)
    y_dot = -(slope * b_dot if slope != 0.0 else 0.0)               of y = 1.0 / b, where b = 1.0 + np.exp(-x)

Going backwards, a seed is the product of all that comes behind, and a choice makes it zero where it takes something
else. It is asked where the next partial can be infinite or nan: by its rule, or because it reads such a value, if a
choice may leave the operation. Going forwards, a choice drops the tangent of what it leaves; a tangent is asked where
the next partial can be infinite by its rule, and the partial where the tangent can be infinite. So a nan stays one
wherever no factor is zero. A root has an infinite slope at 0, where what a sum of squares is made of has none: there
the product is zero in both modes, and the root is asked in place of the seed (`analyze.squares`).
"""
from __future__ import annotations

from s2sad.analyze.unbounded import Unbounded
from s2sad.differentiate.arithmetic import Term, guarded, picked
from s2sad.rules.rule import RESULT, Rule, number
from s2sad.tree import AST, BinOp, Div, names

_SATURATED = frozenset(f"{m}.{n}" for m in ("numpy", "math", "scipy.special") for n in (
    "exp", "exp2", "expm1", "tanh", "arctan", "atan", "expit", "erf", "erfc"))


class Vanishing:
    """Where factors of one function's derivative are asked for zero."""

    def __init__(self, unbounded: Unbounded):
        self.unbounded = unbounded
        self.left = False           # whether a choice may leave the operand at hand

    def enter(self, target: str) -> None:
        """Goes to the statement that binds or fills a name."""
        self.left = target in self.unbounded.left

    def of_seed(self, rule: Rule, parameter: str, operands: dict[str, AST]) -> bool:
        """Whether the seed of an operation is asked, in front of the partial of an operand."""
        if rule.is_singular(parameter, operands):
            return self.left or not self.unbounded.flat_root(rule, operands)
        read = rule.uses(parameter, operands)
        if not read or not self.left or rule.chooses(parameter):
            return False
        return any(self.unbounded.value(o) for p, o in operands.items() if p in read or RESULT in read)

    def of_operand(self, rule: Rule, parameter: str, operands: dict[str, AST], result: AST | None) -> AST | None:
        """What is asked in front of the slope of a root: where it is 0, so is the slope of the squares below it."""
        if not rule.is_singular(parameter, operands) or not self.unbounded.flat_root(rule, operands):
            return None
        operand = operands[parameter]
        if self.unbounded.squares.never_zero(operand):
            return None
        return result if result is not None and RESULT in rule.uses(parameter, operands) else operand

    def of_partial(self, rule: Rule, operand: AST, tangent: Term, partial: AST) -> bool:
        """Whether a partial is asked, in front of the tangent of an operand: where this can be infinite, or where the
        slope is 0 at infinity, which a quotient may be."""
        if not _varies(partial) or picked(tangent, partial) is not None:
            return False
        return self.unbounded.tangent(operand) or rule.name in _SATURATED and self.unbounded.value(operand)

    def product(self, term: Term, asked: list[AST], whole: bool) -> Term:
        """The product, zero where a factor of it is that is asked."""
        for factor in asked:
            term = guarded(factor, term, whole)
        return term


def _varies(partial: AST) -> bool:
    """Whether a partial may be zero: no number is, and no quotient of one."""
    numerator = partial.left if isinstance(partial, BinOp) and isinstance(partial.op, Div) else partial
    return number(numerator) is None and bool(names(numerator))
