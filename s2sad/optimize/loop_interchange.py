"""loop_interchange: two loops change places where the inner one then runs along rows.

    def f(c: float64[:, :], a: float64[:, :]):
        for k in range(a.shape[1]):
            for j in range(c.shape[0]):
                c[0, j] += a[j, k] * a[0, k]

in its adjoint:

    def f_adjoint(...):                             def f_adjoint(...):
        ...                                             ...
        for k in range(a.shape[1]):                     for j in range(c.shape[0]):
            for j in range(c.shape[0]):                     for k in range(a.shape[1]):
                seed = c_bar[0, j]                              seed = c_bar[0, j]
                a_bar[j, k] += a[0, k] * seed                   a_bar[j, k] += a[0, k] * seed
                a_bar[0, k] += a[j, k] * seed                   a_bar[0, k] += a[j, k] * seed

*Requires* a finished adjoint for Numba. *Establishes* the same values, sums of numbers in another order. Legal where no
element that is stored is one of two iterations of the outer loop (its counter stands in one subscript of all references
to the array), no bound changes on the way, and no number flows between iterations, except sums whose order is free.
(Allen, Kennedy, PLDI 1984.) Taken where fewer references then have the inner counter in a subscript before the last.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.optimize.array_contraction import Mentions
from s2sad.optimize.loop_bounds import (
    CountedLoop, affine, bound_names, counted_loop, counter_offset, is_loop_free, stored_elements,
)
from s2sad.optimize.loop_fusion import is_accumulator, upward_exposed
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, Attribute, For, FunctionDef, Name, Subscript, at, indices, is_comment, names, walk,
    with_body,
)

CHANGES_ROUNDING = True

_SHORT = 8      # iterations that are not worth a loop of their own


def loop_interchange(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The adjoint with such loops interchanged, innermost first."""
    def change(statement: AST) -> AST:
        made = with_blocks(statement, lambda block: list(map(change, block)))
        return _interchanged(made, context.types, context.numbers, context.writing) or made
    return with_body(function, list(map(change, function.body)))


def _interchanged(loop: AST, types: Mapping[str, Type], sums: Set[str], writing: Set[str]) -> AST | None:
    """The two loops in the other order; None if that is not legal or not worth it."""
    outer = counted_loop(loop)
    inside = [s for s in loop.body if not is_comment(s)] if isinstance(loop, For) else []
    inner = counted_loop(inside[0]) if len(inside) == 1 else None
    if outer is None or inner is None or not is_loop_free(body := inside[0].body, writing):
        return None
    if _strides(body, outer.counter) >= _strides(body, inner.counter) or _is_short(outer):
        return None
    if not (_may_change_places(outer, inner, body) and _numbers_stay(body, sums) and all(
            _is_apart(a, outer, body, types) for a in {base_name(t) for t in stored_elements(body)})):
        return None
    within = at(For(loop.target, loop.iter, body, [], None), inside[0])
    return at(For(inside[0].target, inside[0].iter, [within], [], None), loop)


def _strides(body: list[AST], counter: str) -> int:
    """How many references have a counter in another subscript than the last."""
    return sum(counter in names(indices(n)[:-1]) for n in walk(body) if isinstance(n, Subscript))


def _is_short(loop: CountedLoop) -> bool:
    ends = loop.ends()
    return ends is not None and not (trips := ends[1].plus(ends[0], -1)).terms and trips.constant + 1 < _SHORT


def _may_change_places(outer: CountedLoop, inner: CountedLoop, body: list[AST]) -> bool:
    """Whether the bounds of either loop are the same in every iteration of the other, and there where it has none."""
    bounds = [outer.start, outer.stop, inner.start, inner.stop]
    if any(isinstance(n, Subscript) and not isinstance(n.value, Attribute) for n in walk(bounds)):
        return False        # an element that need not be there
    sizes = {id(n.value) for n in walk(bounds) if isinstance(n, Attribute)}
    read = {n.id for n in walk(bounds) if isinstance(n, Name) and id(n) not in sizes}
    changed = {outer.counter, inner.counter, *bound_names(body), *(base_name(t) for t in stored_elements(body))}
    return outer.counter != inner.counter and not read & changed


def _numbers_stay(body: list[AST], sums: Set[str]) -> bool:
    """Whether each number that is bound is so in every iteration before it is read, or is a sum in free order."""
    flowing = upward_exposed(body) & bound_names(body)
    always = bound_names([s for s in body if isinstance(s, (Assign, AugAssign))])
    return bound_names(body) <= always and all(n in sums and is_accumulator(n, body) for n in flowing)


def _is_apart(array: str, outer: CountedLoop, body: list[AST], types: Mapping[str, Type]) -> bool:
    """Whether no two iterations of the outer loop mention the same element of an array: it is mentioned by elements
    alone, and one subscript of all of them is the counter plus one number, and not negative."""
    found = [indices(n) for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]
    ends = outer.ends()
    rank = types[array].rank if array in types else 0
    if not Mentions(body).only_by_elements(array) or ends is None or ends[0].terms or any(
            len(subscripts) != rank or any(affine(s) is None for s in subscripts) for subscripts in found):
        return False
    shifts = [{counter_offset(subscripts[axis], outer.counter) for subscripts in found} for axis in range(rank)]
    return any(len(s) == 1 and (shift := next(iter(s))) is not None and ends[0].constant + shift >= 0 for s in shifts)


__all__ = ["loop_interchange"]
