"""swap_contents: names that swap their arrays in a branch swap what the arrays hold.

    def f(x, n):                    def f(x, n):
        a = np.zeros(n)                 a = np.zeros(n)
        b = np.ones(n)                  b = np.ones(n)
        for k in range(n):              for k in range(n):
            a[k] = x[k] * b[0]              a[k] = x[k] * b[0]
            if a[0] > b[0]:                 if a[0] > b[0]:
                before = a                      assert a.shape == b.shape
                a = b                           before = np.copy(a)
                b = before                      a[...] = b
        return a[0]                             b[...] = before
                                        return a[0]

Requires structured form and types; establishes that such names keep their arrays. That is the same where both are
arrays that the function makes, of one dtype and one shape, and where nothing else that is used later stands for one of
them, or for a part.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.normalize.context import NormalContext
from s2sad.normalize.shape_guards import EXCHANGED
from s2sad.normalize.buffers.argument_rotation import Swap, swaps_of
from s2sad.normalize.lists.lists_of_views import ListContents, Writes
from s2sad.tree import (
    AST, Assert, Assign, Eq, For, FunctionDef, If, List, Name, Tuple, While, assign, at, attribute, call, compare,
    const, copy, head_copy, index, name, names, stored_names, walk,
)


def swap_contents(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such stores; the same one if there are none."""
    typing, writes = context.typing, context.written
    if not any(isinstance(n, If) for n in walk(function.body)):
        return function
    made, new = _SwapContents(function, typing, writes), copy(function)
    new.body = made.block(function.body, False)
    return new if made.changed else function


class _SwapContents:
    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.function, self.typing, self.changed = function, typing, False
        self.held = ListContents(function, typing, writes)
        self.kept = {n for s in walk(function.body) if isinstance(s, Assign) and isinstance(s.value, (Tuple, List))
                     for n in names(s.value)}

    def block(self, block: list[AST], inside: bool) -> list[AST]:
        found = [s for s in swaps_of(block, self.typing) if self.is_plain(s)] if inside else []
        gone = {id(s): swap for swap in found for s in swap.statements}
        made: list[AST] = []
        for s in block:
            if id(s) in gone:
                made += self.stores(gone[id(s)]) if s is gone[id(s)].statements[0] else []
                continue
            new = head_copy(s)
            if isinstance(s, (If, For, While)):
                new.body = self.block(s.body, isinstance(s, If))
                new.orelse = self.block(s.orelse, isinstance(s, If))
            made.append(new)
        return made

    def is_plain(self, swap: Swap) -> bool:
        """Whether two arrays of the function's own are swapped, which no other name that is used later shares."""
        pair, holders = set(swap.given), {n for s in swap.statements for n in stored_names(s)}
        kinds = [self.typing.of(name(n)) for n in sorted(pair)]
        after = self.held.references.after[id(swap.statements[-1])]
        swapping = {id(s) for s in self.swapping(pair)}
        bound = [s for s in walk(self.function.body) if isinstance(s, Assign) and pair & set(stored_names(s.targets[0]))
                 and id(s) not in swapping]
        fresh = all(isinstance(s.targets[0], Name) and not self.held.sources(s.value) for s in bound)
        shared = self.held.component(pair) - pair
        return len(pair) == 2 and kinds[0] == kinds[1] and fresh and not pair & (self.held.parameters | self.kept) and (
            not shared & after and not shared & self.held.parameters and not holders & after - pair)

    def swapping(self, pair: set[str]) -> list[AST]:
        """The statements of all swaps of a pair of names."""
        blocks = [self.function.body, *(b for s in walk(self.function.body) if isinstance(s, (If, For, While))
                                        for b in (s.body, s.orelse))]
        return [s for b in blocks for swap in swaps_of(b, self.typing) if set(swap.given) == pair
                for s in swap.statements]

    def stores(self, swap: Swap) -> list[AST]:
        self.changed = True
        a, b = sorted(swap.given)
        holder = next(n for s in swap.statements for n in stored_names(s) if n not in swap.given)
        whole = const(...)
        made = [Assert(compare(attribute(name(a), "shape"), Eq(), attribute(name(b), "shape")), const(EXCHANGED)),
                assign(holder, call("numpy.copy", name(a))), assign(index(name(a), whole), name(b)),
                assign(index(name(b), copy(whole)), name(holder))]
        return [at(s, swap.statements[0]) for s in made]
