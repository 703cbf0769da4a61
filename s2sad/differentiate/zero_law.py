"""The law of zeros, for both modes: a derivative is a sum, over the ways from an input to an output, of products of
partials, a seed and a tangent; where one factor of a product is exactly zero, so is the product, whatever the others.

    x_bar += np.where(seed != 0.0, np.log(x) * seed, 0.0)           of np.where(x > 0.0, x * np.log(x), 0.0)
    y_dot = -(slope * b_dot if slope != 0.0 else 0.0)               of y = 1.0 / b, where b = 1.0 + np.exp(-x)

Going backwards, a seed is the product of all that comes behind, and a choice makes it zero where it takes something
else. It is tested where the next partial can be infinite or nan: by its rule, or because it reads such a value, if a
choice may leave the operation. Going forwards, a choice drops the tangent of what it leaves; a tangent is tested where
the next partial can be infinite by its rule. The partial is tested where the tangent can be infinite, and going
backwards where the seed can be, in front of a root and what else has an infinite slope where its value is finite. So a
nan stays one wherever no factor is zero. Where the operand of a root is known to be a sum of squares, it has no slope
where the root has an infinite one: there the root is tested, once, in place of all these (`analyze.squares`).

An infinite seed is rare, and testing every partial of a whole array for it is slow: where only roots of the function
itself make seeds infinite, one flag says whether one has, and partials are tested while it is set.

    seed = np.where(r_bar != 0.0, 0.5 * r_bar / r, 0.0)         of r = np.sqrt(x * y)
    steep = steep or not np.all(np.isfinite(seed))
    x_bar += strong_zero(y, y * seed, steep)
"""
from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from s2sad.analyze.unbounded_values import UnboundedValues
from s2sad.differentiate.arithmetic import Term, zero_unless, choice_product, unsigned
from s2sad.rules.rule import RESULT, Rule, number
from s2sad.tree import AST, BinOp, BoolOp, Div, Mult, Not, Or, UnaryOp, assign, call, copy, name, names

_SATURATED = frozenset(f"{m}.{n}" for m in ("numpy", "math", "scipy.special") for n in (
    "exp", "exp2", "expm1", "tanh", "arctan", "atan", "expit", "erf", "erfc"))


class ZeroLaw:
    """Where factors of one function's derivative are tested for zero; the name `flag`, if there is one, is set where
    a root has made a seed infinite."""

    def __init__(self, unbounded: UnboundedValues, flag: str = ""):
        self.unbounded, self.flag = unbounded, flag
        self.flagged = False        # whether the flag is read
        self.discarded = False      # whether a choice may leave the operand at hand
        self.steep = False          # whether the seed at hand can be infinite

    def enter(self, target: str) -> None:
        """Goes to the statement that binds or fills a name."""
        self.discarded = target in self.unbounded.discarded
        self.steep = target in self.unbounded.seeds

    @contextmanager
    def pulled(self, rule: Rule, parameter: str, operands: dict[str, AST]) -> Iterator[None]:
        """Goes to an operand."""
        before = self.discarded, self.steep
        self.discarded |= rule.chooses(parameter)
        self.steep |= self.unbounded.is_steep_in(rule, parameter, operands)
        yield
        self.discarded, self.steep = before

    def tests_seed(self, rule: Rule, parameter: str, operands: dict[str, AST]) -> bool:
        """Whether the seed of an operation is tested, in front of the partial of an operand."""
        if rule.is_singular(parameter, operands):
            return self.discarded or not self.unbounded.flat_root(rule, operands)
        read = rule.uses(parameter, operands)
        if not read or not self.discarded or rule.chooses(parameter):
            return False
        return any(self.unbounded.value(o) for p, o in operands.items() if p in read or RESULT in read)

    def root_test(self, rule: Rule, parameter: str, operands: dict[str, AST], result: AST | None) -> AST | None:
        """What is tested in front of the slope of a root: where it is 0, so is the slope of the squares below it."""
        if not rule.is_singular(parameter, operands) or not self.unbounded.flat_root(rule, operands):
            return None
        operand = operands[parameter]
        if self.unbounded.squares.never_zero(operand):
            return None
        return result if result is not None and RESULT in rule.uses(parameter, operands) else operand

    def slope_test(self, seed: Term, partial: AST) -> AST | None:
        """What is tested in front of the seed at hand: a partial, or what it is a multiple of."""
        zero = _numerator(partial)
        return zero if self.steep and _varies(zero) and choice_product(seed, partial) is None else None

    def tests_partial(self, rule: Rule, operand: AST, tangent: Term, partial: AST) -> bool:
        """Whether a partial is tested, in front of the tangent of an operand: where this can be infinite, or where the
        slope is 0 at infinity, which a quotient may be."""
        if not _varies(partial) or choice_product(tangent, partial) is not None:
            return False
        return self.unbounded.tangent(operand) or rule.name in _SATURATED and self.unbounded.value(operand)

    def strong(self, term: Term, zero: AST, whole: bool) -> Term:
        """The product of a partial and a seed that may be infinite, zero where the partial is."""
        if not (whole and self.flag):
            return zero_unless(zero, term, whole)
        self.flagged = True
        return Term(call("runtime.strong_zero", copy(zero), term.tree, name(self.flag)), term.negative)

    def set_flag(self, seed: AST) -> AST:
        """The statement that sets the flag, where the seed behind a root is infinite or nan."""
        infinite = UnaryOp(Not(), call("numpy.all", call("numpy.isfinite", copy(seed))))
        return assign(self.flag, BoolOp(Or(), [name(self.flag), infinite]))

    def product(self, term: Term, tested: list[AST], whole: bool) -> Term:
        """The product, zero where one of the tested factors is."""
        for factor in tested:
            term = zero_unless(factor, term, whole)
        return term


def _varies(partial: AST) -> bool:
    """Whether a partial may be zero: no number is, and no quotient of one."""
    numerator = partial.left if isinstance(partial, BinOp) and isinstance(partial.op, Div) else partial
    return number(numerator) is None and bool(names(numerator))


def _numerator(partial: AST) -> AST:
    """What is zero where a quotient or a multiple of it is."""
    partial = unsigned(partial)[0]
    if isinstance(partial, BinOp) and isinstance(partial.op, Div):
        return _numerator(partial.left)
    multiple = isinstance(partial, BinOp) and isinstance(partial.op, Mult) and number(partial.left)
    return _numerator(partial.right) if multiple else partial
