"""wide_sums: what float32 shadows gain again and again is summed in float64, and rounded once.

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

`wide_sums` takes a derivative before it is simplified, of which the loops that no loop is around are looked at;
`wide_numbers` takes one for NumPy that is finished: a float of Python's is one of float32 as soon as it meets one.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from s2sad.analyze.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.infer import Typing
from s2sad.infer.laws import whole_number
from s2sad.infer.types import FLOAT
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Call, Constant, FloorDiv, For, FunctionDef, If, Mod, Name, NotEq, Slice, Store,
    Sub, Subscript, While,
    assign, at, attribute, augment, call, call_name, compare, const, copy, dump, index, indices, keyword, name, names,
    rebuild, rename, stored_names, walk,
)

_FEW = 64       # so many gains, one after the other, lose no more than some units in the last place


def is_single(typing: Typing) -> bool:
    """Whether a function computes with float32 numbers."""
    return any(t.dtype == "float32" for t in typing.table.values())


def is_real(typing: Typing) -> bool:
    """Whether no number of a function is complex: a finished name does not say which ones are."""
    return not any(t.is_complex for t in typing.table.values())


def wide_sums(function: FunctionDef, shadows: Iterable[str], typing: Typing, free: Names
              ) -> tuple[FunctionDef, set[str]]:
    """The derivative with sums of what shadows of float32 gain, and the arrays that hold them."""
    single = {s for s in shadows if typing.table[s].is_array and typing.table[s].dtype == "float32"}
    new, known = copy(function), set(typing.table)
    new.body = [rebuild(s, lambda n: _summed(n, {*shadows}, typing, free)) for s in _block(
        new.body, single, typing, free)]
    return new, {n for n in typing.table if n not in known and typing.table[n].is_array}


def _summed(node: AST, shadows: set[str], typing: Typing, free: Names) -> AST | None:
    """A gain, or a seed, with the sums in it in float64."""
    gain = isinstance(node, AugAssign) and base_name(node.target) in shadows
    if not gain and not (isinstance(node, Assign) and isinstance(node.targets[0], Name) and free.wanted.get(
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
            made += _loop(s, single, typing, free)
        else:
            made.append(with_blocks(s, lambda block: _block(block, single, typing, free)))
    return made


def _loop(loop: AST, single: set[str], typing: Typing, free: Names) -> list[AST]:
    """The loop with sums of their own for the arrays that it only adds to, and to one element repeatedly."""
    nest = _Nest(loop)
    before: list[AST] = []
    after: list[AST] = []
    for array in dict.fromkeys(n.id for n in walk(loop) if isinstance(n, Name) and n.id in single):
        gains = [(s, around) for s, around in nest.gains if base_name(s.target) == array]
        sizes = sum(isinstance(n, Name) and n.id == array for m in walk(loop) if getattr(m, "attr", "") == "shape"
                    for n in walk(m))
        if sum(isinstance(n, Name) and n.id == array for n in walk(loop)) != len(gains) + sizes or not any(
                nest.repeats(s.target, around) for s, around in gains):
            continue
        places = {dump(s.target): s.target for s, _ in gains}
        if all(nest.stays(p) and typing.of(p).is_number for p in places.values()):
            for key, place in places.items():
                total = free.fresh(f"{array}_sum")
                typing.table[total] = FLOAT
                before.append(at(assign(total, const(0.0)), loop))
                gained = at(augment(copy(place), Add(), name(total)), loop)     # a loop without turns has no place
                after.append(at(If(compare(name(total), NotEq(), const(0.0)), [gained], []), loop))
                loop = _with_total(loop, key, total)
        elif not any(nest.is_part(p) for p in places.values()):
            total = free.fresh(f"{array}_sum")
            typing.table[total] = replace(typing.table[array], dtype="float64")
            before.append(at(assign(total, call("numpy.zeros", attribute(name(array), "shape"))), loop))
            after.append(at(augment(index(name(array), const(...)), Add(), name(total)), loop))
            loop = rename(loop, {array: total})
    return [*before, loop, *after]


def _with_total(loop: AST, place: str, total: str) -> AST:
    """The loop that adds to a number in place of an element."""
    def change(n: AST) -> AST | None:
        fits = isinstance(n, AugAssign) and isinstance(n.target, Subscript) and dump(n.target) == place
        return at(augment(total, n.op, n.value), n) if fits else None
    return rebuild(loop, change)


class _Nest:
    """A loop that no loop is around: what it adds to arrays, each with the loops around it."""

    def __init__(self, loop: AST):
        self.bound = set(stored_names([loop]))
        loops = [n for n in walk(loop) if isinstance(n, For)]
        self.counters = {n.target.id for n in loops}
        self.bounds = {dump(part) for n in loops for part in walk(n.iter)}
        self.gains = list(self._gains([loop], ()))
        self.definitions: dict[str, list[AST]] = {}
        for s in walk(loop):
            for target in s.targets if isinstance(s, Assign) else ():
                for n in walk(target):
                    if isinstance(n, Name) and isinstance(n.ctx, Store):
                        self.definitions.setdefault(n.id, []).append(s.value)

    def _gains(self, block: list[AST], around: tuple[AST, ...]) -> Iterator[tuple[AugAssign, tuple[AST, ...]]]:
        for s in block:
            if isinstance(s, (For, While)):
                yield from self._gains(s.body, (*around, s))
            elif isinstance(s, If):
                yield from self._gains([*s.body, *s.orelse], around)
            elif isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) and isinstance(s.target, Subscript):
                yield s, around

    def repeats(self, target: AST, around: tuple[AST, ...]) -> bool:
        """Whether a gain may go to one element many times."""
        once = {c for i in indices(target) if (c := self._counter(i))}
        return any(isinstance(loop, While) or loop.target.id not in once and not _is_short(loop) for loop in around)

    def _counter(self, place: AST) -> str:
        """The counter that a subscript follows, element by element; "" if there is no such."""
        seen: set[str] = set()
        waiting = [place]
        while waiting:
            node = waiting.pop()
            if isinstance(node, Slice) or any(map(self._is_repeated, walk(node))):
                return ""
            fresh = [n for n in names(node) if n in self.bound and n not in seen]
            seen |= set(fresh)
            waiting += [d for n in fresh if n not in self.counters for d in self.definitions.get(n, [])]
        found = seen & self.counters
        return found.pop() if len(found) == 1 else ""

    def _is_repeated(self, node: AST) -> bool:
        """Whether a part of a subscript may be the same for several counts: what an array holds, a quotient, or a
        remainder but that of the loop's own bound."""
        if isinstance(node, BinOp):
            return isinstance(node.op, FloorDiv) or isinstance(node.op, Mod) and dump(node.right) not in self.bounds
        return isinstance(node, Subscript) and getattr(node.value, "attr", "") != "shape"

    def stays(self, target: AST) -> bool:
        """Whether a place is one element throughout the loop."""
        return all(self._is_fixed(i) for i in indices(target))

    def is_part(self, target: AST) -> bool:
        """Whether a place lies in a part of its array that the loop does not leave."""
        return any(self._is_fixed(i) and not isinstance(i, Constant) for i in indices(target))

    def _is_fixed(self, place: AST) -> bool:
        whole = isinstance(place, Slice) or isinstance(place, Constant) and place.value is Ellipsis
        return not whole and not self.bound & set(names(place))


def _is_short(loop: For) -> bool:
    """Whether a loop has few turns, by its text."""
    numbers = [whole_number(b) for b in loop.iter.args[:2]]
    return all(n is not None and -1 <= n <= _FEW for n in numbers)


def wide_numbers(function: FunctionDef, own: set[str], reverse: str) -> FunctionDef:
    """The finished derivative with numbers of 64 bits for what loops of the reverse sweep add to numbers that are not
    the kernel's own; all of them are real."""
    start = next((k for k, s in enumerate(function.body) if isinstance(getattr(s, "value", None), Constant)
                  and s.value.value == reverse), len(function.body))
    added = {n for s in function.body[start:] for loop in walk(s) if isinstance(loop, (For, While))
             for n in _added(loop) if n not in own}
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


def _added(loop: AST) -> set[str]:
    """The numbers to which a loop adds, and which it does not bind."""
    gained = {s.target.id for s in walk(loop) if isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub))
              and isinstance(s.target, Name)}
    return gained - {t.id for s in walk(loop) if isinstance(s, Assign) for t in walk(s.targets)
                     if isinstance(t, Name) and isinstance(t.ctx, Store)}


__all__ = ["is_real", "is_single", "wide_numbers", "wide_sums"]
