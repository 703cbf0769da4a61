"""resized_buffers: a loop-carried array that changes its size has its buffer allocated anew where it is filled.

Used by `resolve_views`. Requires structured form and types; establishes for these names what `loop_carried` says.

    v = np.append(u, 1.0)           v = np.empty(u.shape[0] + 1)
    while v.size > 1:               ...
        v = v[1:] * v[:-1]          while v.size > 1:
                                        v_2 = np.empty(max(v.shape[0] - 1, 0))
                                        v_2[...] = v[1:] * v[:-1]
                                        v = np.empty_like(v_2)
                                        v[...] = v_2

That the size along an axis changes is found where a buffer is filled in a size that it cannot have (`ResizingError`);
from then on it is a symbol of its own, of which equalities hold up to the next time.
"""
from __future__ import annotations

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import ONE
from s2sad.normalize.buffers.access_paths import AccessPath
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.normalize.buffers.joins import Joins
from s2sad.normalize.shape_guards import shapes_equal
from s2sad.tree import (
    AST, Assert, Call, GtE, If, Name, Slice, Subscript, assign, attribute, call, children, compare, const, copy, dump,
    index, mult, name, names, tuple_of,
)

Axes = frozenset[int]
CHANGES = "'{}' may change its size from one iteration to the next"


class ResizingError(Exception):
    """A loop binds a name to an array that has another size along some axes: its buffer is allocated anew there."""

    def __init__(self, identifier: str, axes: Axes):
        super().__init__(identifier, axes)
        self.identifier, self.axes = identifier, axes


class ResizedBuffers(Joins):
    """How buffers take the content of their names."""
    resized: dict[str, Axes]            # names whose buffers are allocated anew, and the axes that change their size
    reserved: set[str]                  # the arrays in place of lists that double
    bound_at: dict[str, AST]            # the statement that has last bound a name of an array

    def fill(self, identifier: str, buffer: str, view: AccessPath, origin: AST) -> list[AST]:
        place = index(name(buffer), const(...))
        value = index(name(view[0]), *map(copy, view[1])) if view[1] else name(view[0])
        sizes = list(zip(self.shapes.of(name(buffer)), self.shapes.of(value)))
        resized = self.resized.get(identifier, frozenset())
        axes = frozenset(k for k, (old, new) in enumerate(sizes) if not self.may_be_equal(old, new))
        if not axes <= resized:
            if all(size is not None for _, size in sizes):
                raise ResizingError(identifier, axes | resized)
            self.report.error("S201", CHANGES.format(self.free.user_name(identifier)),
                              self.bound_at.get(identifier, origin),
                              help="give arrays of different sizes different names, or copy into one: x[...] = ...")
            return []
        said = const(CHANGES.format(self.free.user_name(identifier)))
        if identifier in self.resized:
            return self.reallocated(identifier, buffer, value, said, origin)
        checks = self.allocations.store_guards(place, value)
        checks = [Assert(c.test, said) if isinstance(c, Assert) else c for c in checks]
        value = self.materialized(place, value, checks, origin)
        return [*checks, assign(place, value)]

    def begin_resizing(self, buffer: str, axes: Axes) -> None:
        """From here on a buffer may have other sizes wherever it is filled; nothing is known of them for long."""
        shapes = self.shapes
        if buffer not in shapes.several:
            shapes.several |= {buffer}
            shapes.values = {n: None if v is not None and buffer in names(v) else v for n, v in shapes.values.items()}
        shapes.arrays[buffer] = tuple(shapes.own_symbol(buffer, k) if k in axes else d
                                      for k, d in enumerate(shapes.of(name(buffer))))
        shapes.forget_sizes({buffer})

    def reallocated(self, identifier: str, buffer: str, value: AST, said: AST, origin: AST) -> list[AST]:
        """The buffer in the size of what it takes."""
        made: list[AST] = []
        axes, kind = self.resized[identifier], self.typing.table[buffer]
        if buffer in names(value):
            held = self.typing.declare(self.free.fresh(f"{buffer}_next"), kind)
            made += self.allocations.allocate(held, kind, value, origin)
            value = name(held)
        for k, (old, new) in enumerate(zip(self.shapes.of(name(buffer)), self.shapes.of(value))):
            if k not in axes and old is not None and new is not None and old != new:
                made.append(Assert(shapes_equal(self.shapes.extent(old), self.shapes.extent(new)).test, said))
        self.begin_resizing(buffer, axes)
        sizes = self.shapes.arrays[buffer]
        made += self.allocations.allocate(buffer, kind, value, origin)
        self.shapes.arrays[buffer] = sizes
        self.refilled.append(buffer)
        return made

    def reserve(self, listed: AST, count: AST, origin: AST) -> list[AST]:
        """An array in place of a list twice as large where it is full; views of it are views of what it is then.

            if us_count >= us.shape[0]:
                us_full = np.empty_like(us)
                us_full[...] = us
                us = np.empty(2 * us.shape[0])
                us[:us_full.shape[0]] = us_full
        """
        path = self.access_path(listed)
        if path is None:
            return []
        buffer, part = path
        if part:
            self.report.error("S201", "a list in a list grows where it is not known how long it becomes", origin,
                              help="give it a name of its own")
            return []
        kind = self.typing.table[buffer]
        full = self.typing.declare(self.free.fresh(f"{buffer}_full"), kind)
        length, *inner = (index(attribute(name(buffer), "shape"), const(k)) for k in range(kind.rank))
        copied = self.allocations.allocate(full, kind, name(buffer), origin)
        self.depths[full] = self.depth
        self.begin_resizing(buffer, frozenset((0,)))
        self.refilled.append(buffer)
        double = mult(const(2), length)
        return [If(compare(count, GtE(), copy(length)), [
            *copied, assign(buffer, call("numpy.empty", tuple_of(double, *inner), *dtype_of(kind))),
            assign(index(name(buffer), Slice(None, index(attribute(name(full), "shape"), const(0)), None)), name(full)),
        ], [])]

    def may_be_equal(self, filled: Affine | None, size: Affine | None) -> bool:
        """Whether the size of an array at the end of an iteration may be the one that it had before: it is known to be,
        or nothing that it is made of changes in the loop."""
        if filled is None or size is None or size == ONE != filled:
            return False
        apart = self.shapes.reduced(size).plus(self.shapes.reduced(filled), -1)
        if not apart.terms:
            return apart.constant == 0
        return self.is_loop_invariant(size) and not self.symbols(size) <= self.symbols(filled)

    def symbols(self, size: Affine) -> set[str]:
        """What a size is made of, down to sizes of arrays and numbers."""
        return {dump(part) for symbol, _ in self.shapes.reduced(size).terms
                for part in _leaves(self.shapes.atoms[symbol])}

    def is_loop_invariant(self, size: Affine) -> bool:
        """Whether a size is made of what is from before the loop."""
        return all(n not in self.shapes.several and self.aliases.is_loop_invariant(n, self.typing.table[n].is_array)
                   for symbol, _ in self.shapes.reduced(size).terms for n in names(self.shapes.atoms[symbol]))


def _leaves(atom: AST) -> list[AST]:
    """The sizes of axes and the numbers in an expression of a size."""
    if isinstance(atom, (Name, Subscript)):
        return [atom]
    parts = [*atom.args, *(k.value for k in atom.keywords)] if isinstance(atom, Call) else children(atom)
    return [leaf for part in parts for leaf in _leaves(part)]
