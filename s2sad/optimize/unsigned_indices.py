"""unsigned_indices: subscripts of innermost loops that cannot be negative say so.

    def f(x: float64[:], y: float64[:], k: int64):
        for i in range(k, x.shape[0]):
            y[i] += x[i] * x[i - k]

in its adjoint:

    def f_adjoint(...):                         def f_adjoint(...):
        ...                                         ...
        for i in range(k, x.shape[0]):              for i in range(k, x.shape[0]):
            seed = y_bar[i]                             seed = y_bar[i]
            x_bar[i] += x[i - k] * seed                 x_bar[i] += x[np.uintp(i - k)] * seed
            x_bar[i - k] += x[i] * seed                 x_bar[np.uintp(i - k)] += x[i] * seed

Compiled, a subscript that is not a counter is asked whether it counts from the end, element by element, and what could
be a row in memory is gathered. An unsigned subscript is not asked.

*Requires* a finished adjoint for Numba. *Establishes* the same values. The last subscript is unsigned where its affine
form is not negative at the ends of the loops around it, for sizes, names of these, positions, lengths and tops of
stacks that are not.
"""
from __future__ import annotations

from collections.abc import Sequence, Set

from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine, combined
from s2sad.liveness import base_name, targets
from s2sad.optimize.loop_bounds import CountedLoop, affine, counted_loop, is_loop_free, substitute_symbol
from s2sad.rules.rule import number
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Constant, For, FunctionDef, Mult, Name, Sub, Subscript, Tuple, at,
    call, call_name, dump, indices, names, rebuild, times_bound, walk_statements, with_body,
)

CHANGES_ROUNDING = False

_NATURAL = ("runtime.position", "builtins.len")


def unsigned_indices(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such subscripts in its innermost loops."""
    tops = {t for t in context.tops if _counts(t, function)} | _sizes(function)

    def change(statement: AST, around: tuple[CountedLoop, ...]) -> AST:
        loop = counted_loop(statement)
        inside = around if loop is None else (loop, *around)
        if isinstance(statement, For) and loop is not None and is_loop_free(statement.body, context.writing):
            naturals = _Naturals(inside, tops)
            return with_blocks(statement, lambda block: [rebuild(s, naturals.unsigned) for s in block])
        return with_blocks(statement, lambda block: [change(s, inside) for s in block])
    return with_body(function, [change(s, ()) for s in function.body])


def _counts(top: str, function: FunctionDef) -> bool:
    """Whether a function only sets a number to 0 and counts it up and down, as pushing and popping do."""
    found = [s for s in walk_statements(function.body) if any(base_name(t) == top for t in targets(s))]
    return all(isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) or isinstance(s, Assign) and isinstance(
        s.value, Constant) and s.value.value == 0 for s in found)


def _sizes(function: FunctionDef) -> set[str]:
    """The names of a function that are bound once, before its loops, to what is not negative: sizes and their like."""
    times, found = times_bound(function), set[str]()
    for statement in function.body:
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and times[target.id] == 1 and _Naturals((), found).natural(statement.value):
            found.add(target.id)
    return found


class _Naturals:
    """The integers that are not negative in the innermost of some loops, the innermost first."""

    def __init__(self, loops: Sequence[CountedLoop], tops: Set[str]):
        self.loops, self.tops = loops, tops
        self.products: dict[str, BinOp] = {}

    def unsigned(self, node: AST) -> AST | None:
        """A reference along a row with an unsigned subscript; None of any other node."""
        if not isinstance(node, Subscript) or isinstance(node.value, Attribute):
            return None
        *outer, last = indices(node)
        if not self.is_asked(last) or not self.natural(last):
            return None
        last = at(call("numpy.uintp", last), last)
        return at(Subscript(node.value, Tuple([*outer, last], node.slice.ctx) if outer else last, node.ctx), node)

    def is_asked(self, subscript: AST) -> bool:
        """Whether a subscript changes with the innermost loop, and is not a counter from a number on plus a number."""
        loop, form = self.loops[0], affine(subscript)
        alone = form is not None and len(form.terms) == 1 and form.terms[0][1] == 1
        first = loop.start if loop.step > 0 else loop.stop
        return loop.counter in names(subscript) and not (alone and number(first) is not None)

    def natural(self, node: AST) -> bool:
        """Whether an integer is not negative in any iteration."""
        form = self.form(node)
        for loop in self.loops:
            factor = 0 if form is None else dict(form.terms).get(loop.counter, 0)
            if form is not None and factor:
                least, most = self.ends(loop)
                end = least if factor > 0 else most
                form = None if end is None else substitute_symbol(form, loop.counter, end)
        return form is not None and form.constant >= 0 and all(c > 0 and self.is_natural(s) for s, c in form.terms)

    def ends(self, loop: CountedLoop) -> tuple[Affine | None, Affine | None]:
        """The least and the greatest counter of an iteration."""
        start, stop = self.form(loop.start), self.form(loop.stop)
        if loop.step > 0:
            return start, None if stop is None else stop.shift(-1)
        return None if stop is None else stop.shift(1), start

    def form(self, node: AST) -> Affine | None:
        """The affine form of an integer, in which positions, lengths and products are symbols."""
        plain = affine(node)
        if plain is not None:
            return plain
        if call_name(node) in _NATURAL:
            return Affine.symbol(dump(node))
        if not isinstance(node, BinOp):
            return None
        found = combined(node.op, self.form(node.left), self.form(node.right))
        if found is None and isinstance(node.op, Mult):
            self.products[dump(node)] = node
            return Affine.symbol(dump(node))
        return found

    def is_natural(self, symbol: str) -> bool:
        product = self.products.get(symbol)
        if product is not None:
            return self.natural(product.left) and self.natural(product.right)
        return symbol in self.tops or symbol.startswith(("Call(", "Attribute(", "Subscript(Attribute("))


__all__ = ["unsigned_indices"]
