"""known_positions: bounds of slices that loops keep within an array are what they are.

    def f(x: float64[:], y: float64[:]):
        for k in range(1, x.shape[0]):
            y[k] = np.sum(x[:k])

in its adjoint:

    def f_adjoint(...):                                 def f_adjoint(...):
        ...                                                 ...
        for k in range(1, x.shape[0]):                      for k in range(1, x.shape[0]):
            seed = y_bar[k]                                     seed = y_bar[k]
            y_bar[k] = 0.0                                      y_bar[k] = 0.0
            total_bar = seed                                    total_bar = seed
            row_total_bar = total_bar                           row_total_bar = total_bar
            for i in range(position(k, x.shape[0])):            for i in range(k):
                x_bar[i] += row_total_bar                           x_bar[i] += row_total_bar

*Requires* a finished adjoint for Numba. *Establishes* the same values: a position is its bound where that is neither
negative nor beyond the end for all counters of the loops around it, for sizes are not negative.
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_bounds import CountedLoop, counted_loop, substitute_symbol
from s2sad.simplify.algebra import add_constant, simplify_index
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Add, BinOp, Call, For, FunctionDef, If, Mult, While, at, attribute, call_name, const, copy, index, name,
    rebuild, with_body,
)

CHANGES_ROUNDING = False


def known_positions(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such bounds."""
    positions = _Positions(IterationSpaces(function, context.writing, context.shadows))
    made: list[AST] = []
    for statement in function.body:
        made.append(positions.statement(statement, ()))
        positions.extents.assume(statement)     # of sizes, for what stands behind it
    return with_body(function, made)


class _Positions:
    """The pass over one function."""

    def __init__(self, extents: IterationSpaces):
        self.extents = extents

    def block(self, block: list[AST], around: tuple[CountedLoop, ...]) -> list[AST]:
        """A block in some loops, the innermost first."""
        return [self.statement(s, around) for s in block]

    def statement(self, statement: AST, around: tuple[CountedLoop, ...]) -> AST:
        if not isinstance(statement, (For, If, While)):
            return self.known(statement, around)
        if isinstance(statement, For):
            bounds = self.known(statement.iter, around)
            statement = at(For(statement.target, bounds, statement.body, [], None), statement)
        loop = counted_loop(statement)
        inside = around if loop is None else (loop, *around)
        return with_blocks(statement, lambda block: self.block(block, inside))

    def known(self, node: AST, around: Sequence[CountedLoop]) -> AST:
        """A statement or an expression with the positions that are known."""
        def change(part: AST) -> AST | None:
            if call_name(part) not in ("runtime.position", "runtime.position_down"):
                return None
            bound, size = (rebuild(a, change) for a in part.args)
            made = self.position(bound, size, call_name(part) == "runtime.position_down", around)
            return at(made or Call(part.func, [bound, size], []), part)
        return rebuild(node, change)

    def position(self, bound: AST, size: AST, down: bool, around: Sequence[CountedLoop]) -> AST | None:
        """Where a bound lies on an axis, if it is known."""
        at_bound, at_end = self.form(bound, around), self.form(size, around)
        if at_bound is None or at_end is None:
            return None
        rest = at_end.plus(at_bound, -1).shift(-1 if down else 0)
        if self.is_natural(at_bound, around) and self.is_natural(rest, around):
            return copy(bound)
        turned = at_bound.plus(at_end)      # counted from the end
        least = turned.shift(1 if down else 0)
        if self.is_natural(at_bound.times(-1).shift(-1), around) and self.is_natural(least, around):
            return expression(turned)
        return None

    def form(self, node: AST, around: Sequence[CountedLoop]) -> Affine | None:
        """The affine form of an integer over sizes and the counters of the loops."""
        before = set(self.extents.fixed)
        self.extents.fixed |= {loop.counter for loop in around}
        found = self.extents.form(node)
        self.extents.fixed = before
        return found

    def is_natural(self, form: Affine | None, around: Sequence[CountedLoop]) -> bool:
        """Whether an integer is not negative in any iteration."""
        for number, loop in enumerate(around):
            factor = 0 if form is None else dict(form.terms).get(loop.counter, 0)
            if form is None or not factor:
                continue
            outer = around[number + 1:]
            start, stop = self.form(loop.start, outer), self.form(loop.stop, outer)
            least = start if loop.step > 0 else stop and stop.shift(1)
            most = start if loop.step < 0 else stop and stop.shift(-1)
            end = least if factor > 0 else most
            form = None if end is None else substitute_symbol(form, loop.counter, end)
        return form is not None and form.constant >= 0 and all(c > 0 and s.endswith("]") for s, c in form.terms)


def expression(form: Affine) -> AST:
    """A form over names and sizes, `x.shape[0]`, as an expression."""
    made: AST = const(0)
    for symbol, factor in form.terms:
        array, shape, axis = symbol.partition(".shape[")
        term = index(attribute(name(array), "shape"), const(int(axis[:-1]))) if shape else name(symbol)
        made = BinOp(made, Add(), BinOp(const(factor), Mult(), term))
    return simplify_index(add_constant(made, form.constant), integers=True)


__all__ = ["known_positions"]
