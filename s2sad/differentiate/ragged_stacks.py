"""ragged_stacks: the elements of arrays of several sizes, one array after the other, last on top.

    w_stack = grow(w_stack, w_top + w.size)         w_top -= w.size
    for i in range(w.shape[0]):                     for i in range(w.shape[0]):
        w_stack[w_top + i] = w[i]                       w[i] = w_stack[w_top + i]
    w_top += w.size
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.tree import (
    AST, Add, add, assign, attribute, augment, call, const, copy, counted_for, index, mult, name,
)


@dataclass(frozen=True)
class RecordedRegion:
    """An array, or with `kept` subscripts a row of one; the counters of its remaining axes."""
    base: AST
    kept: tuple[AST, ...]
    counters: tuple[str, ...]

    def extent(self, axis: int) -> AST:
        return index(attribute(copy(self.base), "shape"), const(len(self.kept) + axis))

    @property
    def size(self) -> AST:
        if not self.kept:
            return attribute(copy(self.base), "size")
        product = self.extent(0)
        for axis in range(1, len(self.counters)):
            product = mult(product, self.extent(axis))
        return product

    @property
    def element(self) -> AST:
        return index(copy(self.base), *map(copy, self.kept), *map(name, self.counters))

    def offset(self) -> AST:
        """The row-major offset of the element at the counters."""
        found: AST = name(self.counters[0])
        for axis in range(1, len(self.counters)):
            found = add(mult(found, self.extent(axis)), name(self.counters[axis]))
        return found

    def over(self, body: list[AST]) -> AST:
        """The statements for every element."""
        for axis in range(len(self.counters) - 1, -1, -1):
            body = [counted_for(self.counters[axis], [self.extent(axis)], body)]
        return body[0]


def push_region(stack: str, top: str, region: RecordedRegion) -> list[AST]:
    """The push of all elements of a region."""
    return [assign(stack, call("runtime.grow", name(stack), add(name(top), region.size))),
            region.over([assign(index(name(stack), add(name(top), region.offset())), region.element)]),
            augment(top, Add(), region.size)]


def pop_region(stack: str, top: str, region: RecordedRegion) -> AST:
    """The pop of a region, of the elements from `top` on."""
    return region.over([assign(region.element, index(name(stack), add(name(top), region.offset())))])
