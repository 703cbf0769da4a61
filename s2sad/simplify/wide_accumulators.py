"""wide_accumulators: shadows of float32 that a loop increments repeatedly are accumulated in float64, and rounded once.

    def f(x: float32[:], p: float32[:], y: float32[:]):
        for i in range(x.size):
            y[i] = p[0] * x[i]

in its adjoint:

    def f_adjoint(...):                 def f_adjoint(...):
        ...                                 ...
        for i in range(x.size):             p_bar_sum = 0.0
            ...                             for i in range(x.size):
            p_bar[0] += x[i] * seed             ...
            x_bar[i] += p[0] * seed             p_bar_sum += x[i] * seed
                                                x_bar[i] += p[0] * seed
                                            if p_bar_sum != 0.0:
                                                p_bar[0] += p_bar_sum

Rows, numbers and reductions likewise:

    for i in range(n):                          b_bar_sum = np.zeros(b_bar.shape)
        for j in range(m):                      for i in range(n):
            b_bar[j] += x[i, j] * seed              for j in range(m):
                                                        b_bar_sum[j] += x[i, j] * seed
                                                b_bar[...] += b_bar_sum

    for i in range(n):                          sum = 0.0
        p_bar[0] += x[i] * seed                 for i in range(n):
                                                    sum += x[i] * seed
                                                if sum != 0.0:
                                                    p_bar[0] += sum

    b_bar[...] += np.sum(seed, axis=0)          b_bar[...] += np.sum(seed, axis=0, dtype=np.float64)

    a_bar = 0.0                                 a_bar = np.float64(0.0)                     where NumPy runs it
    for i in range(n):                          for i in range(n):
        a_bar += x[i] * seed                        a_bar += x[i] * seed

`wide_accumulators` *requires* a derivative before it is simplified, and transforms its outermost loops; `wide_numbers`
takes a finished one for NumPy, where a Python float becomes float32 as soon as it meets one. They *establish* the same
sums with less rounding.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from s2sad.differentiate.adjoint import REVERSE
from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.types import FLOAT
from s2sad.naming import Names
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Call, Constant, FloorDiv, For, FunctionDef, If, Mod, Name, NotEq, Slice, Store,
    Sub, Subscript, While, assign, at, attribute, augment, call, call_name, compare, const, copy, dump, index, indices,
    keyword, name, names, rebuild, rename, stored_names, walk, walk_statements,
)

_FEW_ITERATIONS = 64       # a serial sum of so many terms loses a few units in the last place


def uses_float32(typing: Typing) -> bool:
    """Whether a function computes with float32 numbers."""
    return any(t.dtype == "float32" for t in typing.table.values())


def is_real(typing: Typing) -> bool:
    """Whether no number of a function is complex: a finished name does not say which ones are."""
    return not any(t.is_complex for t in typing.table.values())


def wide_accumulators(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The derivative with float64 accumulators for shadows of float32, and the arrays among these accumulators."""
    shadows, typing, free = context.shadows, context.typing, context.names
    single = {s for s in shadows if typing.table[s].is_array and typing.table[s].dtype == "float32"}
    new, known = copy(function), set(typing.table)
    new.body = [rebuild(s, lambda n: _with_wide_sums(n, {*shadows}, typing, free)) for s in _block(
        new.body, single, typing, free)]
    context.sums = {n for n in typing.table if n not in known and typing.table[n].is_array}
    return new


def _with_wide_sums(node: AST, shadows: set[str], typing: Typing, free: Names) -> AST | None:
    """An increment, or a seed, with the sums in it in float64."""
    is_increment = isinstance(node, AugAssign) and base_name(node.target) in shadows
    if not is_increment and not (isinstance(node, Assign) and isinstance(node.targets[0], Name) and free.hints.get(
            node.targets[0].id) == "seed" and call_name(node.value) == "numpy.sum"):
        return None

    def change(n: AST) -> AST | None:
        if not isinstance(n, Call) or call_name(n) != "numpy.sum" or typing.of(n.args[0]).dtype != "float32":
            return None
        return at(Call(n.func, n.args, [*n.keywords, keyword("dtype", name("numpy.float64"))]), n)
    return rebuild(node, lambda n: None if n is node else change(n))


def _block(block: list[AST], single: set[str], typing: Typing, free: Names) -> list[AST]:
    made: list[AST] = []
    for s in block:
        if isinstance(s, (For, While)):
            made += _widen_loop(s, single, typing, free)
        else:
            made.append(with_blocks(s, lambda block: _block(block, single, typing, free)))
    return made


def _widen_loop(loop: AST, single: set[str], typing: Typing, free: Names) -> list[AST]:
    """The loop with an accumulator for each array that it only increments, and some element of it repeatedly."""
    nest = _OutermostLoop(loop)
    before: list[AST] = []
    after: list[AST] = []
    for array in dict.fromkeys(n.id for n in walk(loop) if isinstance(n, Name) and n.id in single):
        increments = [(s, e) for s, e in nest.increments if base_name(s.target) == array]
        sizes = sum(isinstance(n, Name) and n.id == array for m in walk(loop) if getattr(m, "attr", "") == "shape"
                    for n in walk(m))
        mentions = sum(isinstance(n, Name) and n.id == array for n in walk(loop))
        if mentions != len(increments) + sizes or not any(nest.may_repeat(s.target, e) for s, e in increments):
            continue
        places = {dump(s.target): s.target for s, _ in increments}
        if all(nest.is_invariant(p) and typing.of(p).is_number for p in places.values()):
            for key, place in places.items():
                total = typing.declare(free.fresh(f"{array}_sum"), FLOAT)
                before.append(at(assign(total, const(0.0)), loop))
                increment = at(augment(copy(place), Add(), name(total)), loop)
                # a loop that never runs may have no such element: hence the test
                after.append(at(If(compare(name(total), NotEq(), const(0.0)), [increment], []), loop))
                loop = _accumulate_in_scalar(loop, key, total)
        elif not any(nest.lies_in_invariant_part(p) for p in places.values()):
            total = typing.declare(free.fresh(f"{array}_sum"), replace(typing.table[array], dtype="float64"))
            before.append(at(assign(total, call("numpy.zeros", attribute(name(array), "shape"))), loop))
            after.append(at(augment(index(name(array), const(...)), Add(), name(total)), loop))
            loop = rename(loop, {array: total})
    return [*before, loop, *after]


def _accumulate_in_scalar(loop: AST, place: str, total: str) -> AST:
    """The loop that increments a number in place of an element."""
    def change(n: AST) -> AST | None:
        fits = isinstance(n, AugAssign) and isinstance(n.target, Subscript) and dump(n.target) == place
        return at(augment(total, n.op, n.value), n) if fits else None
    return rebuild(loop, change)


class _OutermostLoop:
    """An outermost loop: the increments of array elements in it, each with its enclosing loops."""

    def __init__(self, loop: AST):
        self.bound = set(stored_names([loop]))
        loops = [n for n in walk_statements(loop) if isinstance(n, For)]
        self.counters = {n.target.id for n in loops}
        self.bounds = {dump(part) for n in loops for part in walk(n.iter)}
        self.increments = list(self._find_increments([loop], ()))
        self.definitions: dict[str, list[AST]] = {}
        for s in walk_statements(loop):
            for target in s.targets if isinstance(s, Assign) else ():
                for n in walk(target):
                    if isinstance(n, Name) and isinstance(n.ctx, Store):
                        self.definitions.setdefault(n.id, []).append(s.value)

    def _find_increments(self, block: list[AST],
                         enclosing: tuple[AST, ...]) -> Iterator[tuple[AugAssign, tuple[AST, ...]]]:
        for s in block:
            if isinstance(s, (For, While)):
                yield from self._find_increments(s.body, (*enclosing, s))
            elif isinstance(s, If):
                yield from self._find_increments([*s.body, *s.orelse], enclosing)
            elif isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) and isinstance(s.target, Subscript):
                yield s, enclosing

    def may_repeat(self, target: AST, enclosing: tuple[AST, ...]) -> bool:
        """Whether several iterations may increment one element."""
        once = {c for i in indices(target) if (c := self._counter_of(i))}
        return any(isinstance(loop, While) or loop.target.id not in once and not _has_few_iterations(loop)
                   for loop in enclosing)

    def _counter_of(self, place: AST) -> str:
        """The counter of which a subscript is an injective function; "" if there is none."""
        seen: set[str] = set()
        waiting = [place]
        while waiting:
            node = waiting.pop()
            if isinstance(node, Slice) or any(map(self._is_not_injective, walk(node))):
                return ""
            fresh = [n for n in names(node) if n in self.bound and n not in seen]
            seen |= set(fresh)
            waiting += [d for n in fresh if n not in self.counters for d in self.definitions.get(n, [])]
        found = seen & self.counters
        return found.pop() if len(found) == 1 else ""

    def _is_not_injective(self, node: AST) -> bool:
        """Whether a part of a subscript may have one value for several counts: an element of an array, a quotient, or a
        remainder unless it is by the loop's own bound."""
        if isinstance(node, BinOp):
            return isinstance(node.op, FloorDiv) or isinstance(node.op, Mod) and dump(node.right) not in self.bounds
        return isinstance(node, Subscript) and getattr(node.value, "attr", "") != "shape"

    def is_invariant(self, target: AST) -> bool:
        """Whether a reference is to one element throughout the loop."""
        return all(self._is_invariant_subscript(i) for i in indices(target))

    def lies_in_invariant_part(self, target: AST) -> bool:
        """Whether a reference is to one part of its array throughout the loop."""
        return any(self._is_invariant_subscript(i) and not isinstance(i, Constant) for i in indices(target))

    def _is_invariant_subscript(self, place: AST) -> bool:
        whole = isinstance(place, Slice) or isinstance(place, Constant) and place.value is Ellipsis
        return not whole and not self.bound & set(names(place))


def _has_few_iterations(loop: For) -> bool:
    """Whether a loop has few iterations, by its text."""
    numbers = [whole_number(b) for b in loop.iter.args[:2]]
    return all(n is not None and -1 <= n <= _FEW_ITERATIONS for n in numbers)


def wide_numbers(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The finished derivative with float64 scalars for the accumulators of loops in the reverse sweep that are not the
    kernel's own numbers; all of them are real.

        def f(x: float32[:], a: float32, y: float32[:]):
            for i in range(x.size):
                y[i] = a * x[i]

    in its adjoint:

        def f_adjoint(...):                         def f_adjoint(...):
            a_bar = 0.0                                 a_bar = np.float64(0.0)
            for i in range(x.size - 1, -1, -1):         for i in range(x.size - 1, -1, -1):
                ...                                         ...
            return (a_bar,)                             return (a_bar,)
    """
    own = {n for pair in context.kernel_names.items() for n in pair}
    start = next((k for k, s in enumerate(function.body) if isinstance(getattr(s, "value", None), Constant)
                  and s.value.value == REVERSE), len(function.body))
    added = {n for s in function.body[start:] for loop in walk_statements(s) if isinstance(loop, (For, While))
             for n in _accumulators(loop) if n not in own and not _is_counter(n, context.typing)}
    if not added:
        return function

    def change(node: AST) -> AST | None:
        target = node.targets[0] if isinstance(node, Assign) else None
        if not isinstance(target, Name) or target.id not in added:
            return None
        return at(assign(target.id, call("numpy.float64", node.value)), node)
    new = copy(function)
    new.body = [*new.body[:start], *(rebuild(s, change) for s in new.body[start:])]
    return new


def _is_counter(number: str, typing: Typing) -> bool:
    """Whether a number is an integer; a name that simplification has made is that of a gain."""
    return number in typing.table and typing.table[number].is_integer


def _accumulators(loop: AST) -> set[str]:
    """The numbers that a loop increments and does not bind."""
    added = {s.target.id for s in walk_statements(loop) if isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub))
             and isinstance(s.target, Name)}
    return added - {t.id for s in walk_statements(loop) if isinstance(s, Assign) for t in walk(s.targets)
                     if isinstance(t, Name) and isinstance(t.ctx, Store)}


__all__ = ["is_real", "uses_float32", "wide_numbers", "wide_accumulators"]
