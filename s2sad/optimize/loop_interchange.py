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

Where more is in the outer loop than the inner one, it is distributed before; numbers that one part hands on are in rows
then.

    def f(a: float64[:, :], q: float64[:], r: float64[:]):
        for j in range(a.shape[1]):
            r[j] = np.dot(q, a[:, j])

in its adjoint:

    def f_adjoint(...):                             def f_adjoint(...):
        ...                                             ...
                                                        seed_row = np.empty(a.shape[1])
        for j in range(a.shape[1]):                     for j in range(a.shape[1]):
            seed = r_bar[j]                                 seed = r_bar[j]
            r_bar[j] = 0.0                                  r_bar[j] = 0.0
                                                            seed_row[j] = seed
            for i in range(q_bar.shape[0]):             for i in range(q_bar.shape[0]):
                                                            for j in range(a.shape[1]):
                q_bar[i] += seed * a[i, j]                      q_bar[i] += seed_row[j] * a[i, j]
            for i in range(a_bar.shape[0]):             for i in range(a_bar.shape[0]):
                                                            for j in range(a.shape[1]):
                a_bar[i, j] += seed * q[i]                      a_bar[i, j] += seed_row[j] * q[i]

Where neither loop is the innermost one, the outer one goes into the other if it stands behind that in the subscripts:

    def f(c: float64[:, :, :]):
        for k in range(1, c.shape[2]):
            for i in range(c.shape[0]):
                for j in range(c.shape[1]):
                    c[i, j, k] *= c[i, j, k - 1]

in its adjoint:

    def f_adjoint(...):                                     def f_adjoint(...):
        ...                                                     ...
        for k in range(c.shape[2] - 1, 0, -1):                  for i in range(c.shape[0]):
            for i in range(c.shape[0]):                             for k in range(c.shape[2] - 1, 0, -1):
                for j in range(c.shape[1]):                             for j in range(c.shape[1]):
                    ...                                                     ...

*Requires* a finished adjoint for Numba. *Establishes* the same values, sums in another order. Legal where iterations of
the outer loop share nothing but increments of shadows, and sums whose order is free: its counter stands in one
subscript of all references to an array that is stored into, no bound changes on the way, and no number flows between
iterations. (Where one is built on the last, the inner loop would be a chain.) Taken where fewer references then have
the inner counter in a subscript before the last. Where the innermost loop stays, the iterations of either of the two
may be the ones that share nothing; what one of them walks then stays in the cache while the other runs. (Allen,
Kennedy, PLDI 1984; Kennedy, McKinley, SC 1990.)
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Set
from dataclasses import dataclass

from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.optimize.array_contraction import Mentions
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_bounds import (
    CountedLoop, bound_names, counted_loop, counter_offset, is_loop_free, is_nonnegative, stored_elements,
)
from s2sad.optimize.loop_nests import LoopPass
from s2sad.optimize.statement_order import (
    is_accumulator, is_incremented, is_short, is_transposed, may_change_places, numbers_stay, stands_behind, strides,
    upward_exposed,
)
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Constant, For, FunctionDef, Name, Subscript, assign, at, augment, call,
    copy, index, indices, is_comment, name, names, rebuild, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = True


def loop_interchange(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The adjoint with such loops interchanged, innermost first."""
    interchange = _Interchange(function, context)
    made = with_body(function, interchange.block(function.body, {}, None))
    context.types = interchange.types
    return made


@dataclass
class _Part:
    """Statements of a loop that get a loop of their own: an inner loop that changes places with it, or others."""
    body: list[AST]
    inner: For | None = None

    def exposed(self) -> set[str]:
        """The names that it may read before it binds them."""
        return _exposed(self.body)

    def read(self, number: str, element: Subscript) -> None:
        """Has it read an element, or sum into it, in place of a number."""
        def change(node: AST) -> AST | None:
            if isinstance(node, AugAssign) and isinstance(node.target, Name) and node.target.id == number:
                return at(augment(copy(element), node.op, rebuild(node.value, change)), node)
            return copy(element) if isinstance(node, Name) and node.id == number else None
        if self.inner is None:
            self.body.insert(0, at(assign(number, copy(element)), self.body[0]))
            return
        body = [rebuild(s, change) for s in self.inner.body]
        self.inner = at(For(self.inner.target, self.inner.iter, body, [], None), self.inner)
        self.body = [self.inner]


class _Interchange(LoopPass):
    """The pass over one function; `own` are arrays that share no memory."""

    def __init__(self, function: FunctionDef, context: DerivativeContext):
        self.types, self.sums, self.writing = dict(context.types), context.numbers, context.writing
        self.shadows, self.free = context.gaining, context.names
        self.counters = {n.target.id for n in walk_statements(function.body) if isinstance(n, For)}
        self.mentions = Counter(n.id for n in walk(function) if isinstance(n, Name))
        self.own = IterationSpaces(function, context.writing).own | context.stacks
        super().__init__()

    def statement(self, statement: AST, least: Mapping[str, int]) -> list[AST]:
        new = self.with_inner_blocks(statement, least)
        return self.loop(new, least) if isinstance(new, For) else [new]

    def loop(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """The loop, or what takes its place."""
        outer = counted_loop(loop)
        if outer is None or is_short(outer):
            return [loop]
        if self.is_wanted_within(loop, outer, least):
            return [self.made(loop, _Part(loop.body, loop.body[0]))]
        parts = self.parts(loop, outer, least)
        inner = [p.inner for p in parts if p.inner]
        if not inner or len(parts) > 1 and not self.is_distributable(loop, outer, parts, least):
            return [loop]
        if len(parts) > 1:
            self.expand(parts, loop.body, outer)
        return [self.made(loop, p) for p in parts]

    def made(self, loop: For, part: _Part) -> AST:
        if part.inner is None:
            return at(For(loop.target, loop.iter, part.body, [], None), loop)
        within = at(For(loop.target, loop.iter, part.inner.body, [], None), part.inner)
        return at(For(part.inner.target, part.inner.iter, [within], [], None), loop)

    def parts(self, loop: For, outer: CountedLoop, least: Mapping[str, int]) -> list[_Part]:
        """What the loop does, where the inner loops that are to change places with it are apart."""
        found: list[_Part] = []
        for statement in loop.body:
            if isinstance(statement, For) and self.is_wanted(statement, loop, outer, least):
                found.append(_Part([statement], statement))
            elif found and found[-1].inner is None:
                found[-1].body.append(statement)
            else:
                found.append(_Part([statement]))
        return [p for p in found if not all(map(is_comment, p.body))]

    def is_wanted(self, loop: For, around: For, outer: CountedLoop, least: Mapping[str, int]) -> bool:
        """Whether an inner loop may change places with the one around it, and should."""
        inner, body = counted_loop(loop), loop.body
        return (inner is not None and is_loop_free(body, self.writing)
                and strides(body, outer.counter) < strides(body, inner.counter)
                and may_change_places(outer, inner, around.body) and numbers_stay(body, self.sums)
                and all(self.is_free(a, outer, body, least) for a in {base_name(t) for t in stored_elements(body)}))

    def is_wanted_within(self, loop: For, outer: CountedLoop, least: Mapping[str, int]) -> bool:
        """Whether a loop may go into the one that it consists of, in which there is another one, and should."""
        loops, body = _nest(loop)
        inner = counted_loop(loops[1]) if len(loops) > 2 else None
        return (inner is not None and all(map(counted_loop, loops)) and is_loop_free(body, self.writing)
                and stands_behind(outer.counter, inner.counter, body)
                and all(may_change_places(outer, b, body) for b in map(counted_loop, loops[1:]) if b)
                and numbers_stay(body, self.sums)
                and all(self.is_apart(a, inner, body, least) for a in {base_name(t) for t in stored_elements(body)}))

    def is_free(self, array: str, loop: CountedLoop, body: list[AST], least: Mapping[str, int]) -> bool:
        """Whether what the iterations do with an array may be done in any order."""
        return self.is_apart(array, loop, body, least) or array in self.shadows and array in self.own and (
            is_incremented(array, body))

    def is_apart(self, array: str, loop: CountedLoop, body: list[AST], least: Mapping[str, int]) -> bool:
        """Whether no two iterations of a loop mention the same element of an array: it is mentioned by elements alone,
        and one subscript of all of them is the counter plus one number, and not negative."""
        found = [indices(n) for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]
        ends = loop.ends()
        rank = self.types[array].rank if array in self.types else 0
        if array not in self.own or ends is None or not Mentions(body).only_by_elements(array) or is_transposed(
                array, body) or any(len(s) != rank or not all(map(self.is_of_axis, s)) for s in found):
            return False
        shifts = [{counter_offset(subscripts[axis], loop.counter) for subscripts in found} for axis in range(rank)]
        return any(len(s) == 1 and (shift := next(iter(s))) is not None and is_nonnegative(
            ends[0].shift(shift), least) for s in shifts)

    def is_of_axis(self, subscript: AST) -> bool:
        """Whether a subscript stands for one axis, and is no array."""
        if isinstance(subscript, Constant) and type(subscript.value) is not int:
            return False
        sizes = {id(n.value) for n in walk(subscript) if isinstance(n, Attribute)}
        return all(id(n) in sizes or self.is_number_name(n.id) for n in walk(subscript) if isinstance(n, Name))

    def is_number_name(self, identifier: str) -> bool:
        kind = self.types.get(identifier)
        return "." in identifier or identifier in self.counters or kind is not None and kind.is_number

    def is_distributable(self, loop: For, outer: CountedLoop, parts: list[_Part], least: Mapping[str, int]) -> bool:
        """Whether the iterations share nothing but increments of shadows, and hand on numbers that may be in rows."""
        ends, body = outer.ends(), loop.body
        arrays = {n.id for n in walk(body) if isinstance(n, Name) and not self.is_number_name(n.id)}
        if ends is None or not is_nonnegative(ends[0], least) or not arrays <= self.own or not _is_simple(
                body, self.writing):
            return False
        return self.hands_on_rows(parts, body) and all(
            self.is_free(a, outer, body, least) for a in {base_name(t) for t in stored_elements(body)})

    def hands_on_rows(self, parts: list[_Part], body: list[AST]) -> bool:
        """Whether each number that a part reads, and the loop binds, was bound by statements right in the loop; inner
        loops that change places may sum into it."""
        bound = bound_names(body) - {s.target.id for s in walk_statements(body) if isinstance(s, For)}
        inside = Counter(n.id for n in walk(body) if isinstance(n, Name))
        known: set[str] = set()
        for part in parts:
            ending = bound_names(part.body)
            for n in part.exposed() & bound:
                kind = self.types.get(n)
                if n in self.sums and is_accumulator(n, body):
                    continue
                if n not in known or kind is None or kind.dtype != "float64":
                    return False
                if part.inner and n in ending:
                    if not is_accumulator(n, part.body) or inside[n] != self.mentions[n]:
                        return False
                    ending = ending - {n}
            known = known - ending | bound_names([s for s in part.body if isinstance(s, (Assign, AugAssign))])
        return True

    def expand(self, parts: list[_Part], body: list[AST], outer: CountedLoop) -> None:
        """Numbers that later parts read become rows."""
        for k, part in enumerate(parts):
            for n in sorted(bound_names(part.body)):
                readers = []
                for later in parts[k + 1:]:
                    readers += [later] if n in later.exposed() else []
                    if n in bound_names(later.body) and not later.inner:
                        break
                if part.inner or not readers or n in self.sums and is_accumulator(n, body):
                    continue
                row = self.free.fresh(f"{n}_row")
                self.types[row] = Type("array", "float64", rank=1)
                self.hoisted.append(assign(row, call("numpy.empty", outer.extent())))
                element = index(name(row), name(outer.counter))
                part.body.append(at(assign(copy(element), name(n)), part.body[-1]))
                for reader in readers:
                    reader.read(n, element)


def _nest(loop: For) -> tuple[list[For], list[AST]]:
    """The loops of a perfect nest, and its body."""
    loops, body = [loop], loop.body
    while len(body) == 1 and isinstance(body[0], For):
        loops.append(body[0])
        body = body[0].body
    return loops, body


def _exposed(block: list[AST]) -> set[str]:
    """The names that a block may read before it binds them, loops within it, too."""
    found: set[str] = set()
    sure: set[str] = set()
    for statement in block:
        if isinstance(statement, For):
            found |= (set(names(statement.iter)) | _exposed(statement.body) - {statement.target.id}) - sure
        else:
            found |= upward_exposed([statement]) - sure
            sure |= bound_names([statement]) if isinstance(statement, (Assign, AugAssign)) else set()
    return found


def _is_simple(block: list[AST], writing: Set[str]) -> bool:
    """Whether a block has counted loops, what loops may be left without, and assertions of sizes."""
    return all(counted_loop(s) is not None and _is_simple(s.body, writing) if isinstance(s, For)
               else _is_of_sizes(s.test) if isinstance(s, Assert) else is_loop_free([s], writing) for s in block)


def _is_of_sizes(test: AST) -> bool:
    """Whether an assertion says the same in every iteration, and whatever has been done before it."""
    sizes = {id(n.value) for n in walk(test) if isinstance(n, Attribute) and n.attr in ("shape", "size")}
    return all(id(n) in sizes or "." in n.id for n in walk(test) if isinstance(n, Name))


__all__ = ["loop_interchange"]
