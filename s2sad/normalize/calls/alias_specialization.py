"""alias_specialization: a kernel that is given one array for two parameters, and writes it, is specialized for that:
it has one parameter.

    change(x, x, a)                 change_2(x, a)

A call with overlapping parts of one array, one of them stored into, is refused: which elements they share depends on
values that are known only when it runs.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from s2sad.liveness import base_name
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.path_conditions import CallSite
from s2sad.program import Kernel
from s2sad.tree import (
    AST, Add, BinOp, Call, Name, Slice, Store, Subscript, assign, at, const, copy, dump, function, indices, name,
    rename, walk,
)


def alias_pairs(node: Call, written: tuple[int, ...], typing: Typing, places: Callable[[], dict[int, CallSite]],
           report: Report) -> tuple[tuple[int, int], ...]:
    """The pairs (position, earlier position) of a call's arguments that are one array, into which the callee stores."""
    arrays = [k for k, a in enumerate(node.args) if typing.of(a).is_array]
    pairs: list[tuple[int, int]] = []
    for place, k in enumerate(arrays):
        for first in arrays[:place]:
            if base_name(node.args[k]) != base_name(node.args[first]) or not {k, first} & set(written):
                continue
            if dump(node.args[k]) == dump(node.args[first]):
                if all(p != k for p, _ in pairs):
                    pairs.append((k, first))
            elif not _are_disjoint(node.args[k], node.args[first], places()[id(node)]):
                report.error("S404", f"two arguments that may share elements of '{base_name(node.args[k])}', one of "
                             "which is written", node, help="copy one of them first")
    return tuple(pairs)


def _are_disjoint(a: AST, b: AST, here: CallSite) -> bool:
    """Whether two parts of one array are known to be disjoint: they are on one axis."""
    return isinstance(a, Subscript) and isinstance(b, Subscript) and any(
        _ends_before(x, y, here) or _ends_before(y, x, here) or _differ(x, y, here)
        for x, y in zip(_axes(a, here.shapes.typing), _axes(b, here.shapes.typing)))


def _differ(x: AST, y: AST, here: CallSite) -> bool:
    return not isinstance(x, Slice) and not isinstance(y, Slice) and here.differ(x, y)


def _axes(part: Subscript, typing: Typing) -> Iterator[AST]:
    """The subscripts of the first axes of an array, slices and integers, up to the first of another kind."""
    for subscript in indices(part):
        if not isinstance(subscript, Slice) and typing.of(subscript).dtype != "int64":
            return
        yield subscript


def _ends_before(first: AST, second: AST, here: CallSite) -> bool:
    """Whether a slice or a number along an axis takes elements before those of another one only."""
    if any(isinstance(s, Slice) and s.step is not None for s in (first, second)):
        return False
    end = first.upper if isinstance(first, Slice) else BinOp(first, Add(), const(1))
    start = second.lower if isinstance(second, Slice) else second
    if end is None or start is None:
        return False
    if isinstance(first, Slice) and isinstance(second, Slice) and dump(end) == dump(start):
        return True
    own, last, begin = (here.size(s) for s in (end if isinstance(first, Slice) else first, end, start))
    if own is None or last is None or begin is None or not here.is_place(begin.plus(last, -1)):
        return False
    from_the_end = not own.terms and not begin.terms and own.constant < 0 and begin.constant < 0
    return here.is_place(own) or from_the_end


def specialized(kernel: Kernel, pairs: tuple[tuple[int, int], ...]) -> Kernel:
    """The kernel with each later parameter of a pair replaced by the earlier one."""
    parameters = [p.id for p in kernel.tree.args.args]
    gone = {parameters[k]: parameters[first] for k, first in pairs}
    bound = {n.id for n in walk(kernel.tree.body) if isinstance(n, Name) and isinstance(n.ctx, Store)}
    mapping = {p: q for p, q in gone.items() if p not in bound and q not in bound}
    body = rename(copy(kernel.tree.body), mapping)
    start = [at(assign(p, name(q)), kernel.tree) for p, q in gone.items() if p not in mapping]
    kept = [p for p in parameters if p not in gone]
    tree = at(function(kernel.tree.name, kept, [*start, *body]), kernel.tree)
    return replace(kernel, tree=tree, parameters=tuple(p for p in kernel.parameters if p not in gone))
