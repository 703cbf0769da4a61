"""shared_buffers: names that choose between arrays, in forms in which none shares its buffer with another one.

Both passes run where a store would make a buffer differ from NumPy's array (`Aliases.check`), before the passes of the
room are tried once more.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.normalize.buffers.argument_rotation import Swap, swaps_of
from s2sad.normalize.context import NormalContext
from s2sad.normalize.lists.list_contents import ListContents, Writes
from s2sad.normalize.shape_guards import EXCHANGED
from s2sad.normalize.single_assignment import breaks
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Break, Call, Eq, Expr, For, FunctionDef, If, List, Name, Raise, Return, Tuple,
    While, assign, at, attribute, call, compare, const, copy, dump, head_copy, index, name, names, stored_names,
    times_bound, walk, walk_statements,
)


def swap_contents(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function in which names that swap arrays in a branch swap what these hold; the same one if none do.

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
    arrays that the function makes, of one dtype and one shape, and where no other name that is used later is bound to
    one of them, or to a part.
    """
    typing, writes = context.typing, context.written
    if not any(isinstance(n, If) for n in walk_statements(function.body)):
        return function
    made, new = _SwapContents(function, typing, writes), copy(function)
    new.body = made.block(function.body, False)
    return new if made.changed else function


class _SwapContents:
    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.function, self.typing, self.changed = function, typing, False
        self.contents = ListContents(function, typing, writes)
        self.in_tuples = {n for s in walk_statements(function.body) if isinstance(s, Assign)
                     and isinstance(s.value, (Tuple, List))
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
        pair, holders = set(swap.origins), {n for s in swap.statements for n in stored_names(s)}
        kinds = [self.typing.of(name(n)) for n in sorted(pair)]
        after = self.contents.uses.after[id(swap.statements[-1])]
        swapping = {id(s) for s in self.swapping(pair)}
        bound = [s for s in walk_statements(self.function.body) if isinstance(s, Assign)
                 and pair & set(stored_names(s.targets[0]))
                 and id(s) not in swapping]
        fresh = all(isinstance(s.targets[0], Name) and not self.contents.sources(s.value) for s in bound)
        shared = self.contents.component(pair) - pair
        unshared = not shared & after and not shared & self.contents.parameters and not holders & after - pair
        return len(pair) == 2 and kinds[0] == kinds[1] and fresh and unshared and not pair & (
            self.contents.parameters | self.in_tuples)

    def swapping(self, pair: set[str]) -> list[AST]:
        """The statements of all swaps of a pair of names."""
        blocks = [self.function.body, *(b for s in walk_statements(self.function.body)
                                        if isinstance(s, (If, For, While))
                                        for b in (s.body, s.orelse))]
        return [s for b in blocks for swap in swaps_of(b, self.typing) if set(swap.origins) == pair
                for s in swap.statements]

    def stores(self, swap: Swap) -> list[AST]:
        self.changed = True
        a, b = sorted(swap.origins)
        holder = next(n for s in swap.statements for n in stored_names(s) if n not in swap.origins)
        whole = const(...)
        made = [Assert(compare(attribute(name(a), "shape"), Eq(), attribute(name(b), "shape")), const(EXCHANGED)),
                assign(holder, call("numpy.copy", name(a))), assign(index(name(a), whole), name(b)),
                assign(index(name(b), copy(whole)), name(holder))]
        return [at(s, swap.statements[0]) for s in made]


_MOST = 120         # statements that are duplicated in one function


def tail_duplication(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function in which what follows a branch that chooses arrays for names goes into both of its sides.

        def f(a, b, x, n):                      def f(a, b, x, n):
            for k in range(n):                      for k in range(n):
                if k % 2 == 0:                          if k % 2 == 0:
                    source = a                              source = a
                    target = b                              target = b
                else:                                       target[0] = source[1] * x[k]
                    source = b                          else:
                    target = a                              source = b
                target[0] = source[1] * x[k]                target = a
                                                            target[0] = source[1] * x[k]

    Requires structured form and types; establishes for each side of a branch arrays of its own. Behind one there is one
    array for a name, into which those of both sides would be copied: where one is stored into, and the copy would
    differ, each side goes on with the arrays that it has. What follows is taken as far as such a name is used in the
    block, and not at all where it is long. The context gains the names that are bound again: they may be other arrays
    from here on.
    """
    new = function
    if any(isinstance(n, If) for n in walk_statements(function.body)):
        made, changed = _TailDuplication(function, context.typing, context.written), copy(function)
        changed.body = made.block(function.body)
        new = changed if made.left < _MOST else function
    context.swapped = {n for n, times in times_bound(new.body, Assign).items() if times > 1}
    return new


class _TailDuplication:
    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.contents, self.left = ListContents(function, typing, writes), _MOST

    def block(self, block: list[AST]) -> list[AST]:
        block = self.merge_branches(block)
        for position, statement in enumerate(block):
            if isinstance(statement, If) and (end := self.end(statement, block, position + 1)) is not None:
                moved = block[position + 1:end]
                self.left -= _length(moved)
                made = at(If(statement.test, *([*arm, *map(copy, moved)] for arm in (
                    statement.body, statement.orelse))), statement)
                return [*map(self.statement, block[:position]), self.statement(made),
                        *self.block(block[end:])]
        return [self.statement(s) for s in block]

    def merge_branches(self, block: list[AST]) -> list[AST]:
        """A block in which two such branches after one another that ask the same are one."""
        made: list[AST] = []
        for s in block:
            last = made[-1] if made else None
            if isinstance(s, If) and isinstance(last, If) and dump(s.test) == dump(last.test) and _names_alone(
                    last) and self.chosen(last) and self.chosen(s):
                made[-1] = at(If(last.test, [*last.body, *s.body], [*last.orelse, *s.orelse]), last)
            else:
                made.append(s)
        return made

    def statement(self, statement: AST) -> AST:
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if isinstance(inner := getattr(statement, field, None), list):
                setattr(new, field, self.block(inner))
        return new

    def end(self, branch: If, block: list[AST], start: int) -> int | None:
        """Where in a block what goes into a branch ends; None if nothing does."""
        chosen = self.chosen(branch)
        if not chosen:
            return None
        own = self.views_bound(chosen, block[start:])
        used = [k for k in range(start, len(block)) if own & set(names(block[k])) and not isinstance(block[k], Return)]
        if not used:
            return None
        end = used[-1] + 1
        if any(isinstance(s, If) and breaks(s) or isinstance(s, Break) for s in block[start:end]):
            end = len(block)
        together, moved = self.contents.component(chosen), block[start:end]
        stored = {n for s in walk(moved) for n in self.contents.stored_arrays(s)}
        return end if stored & together and _length(moved) <= self.left else None

    def chosen(self, branch: If) -> set[str]:
        """The names that may be bound to different arrays behind a branch, one of which has a name before it."""
        arms = [self.bound(arm) for arm in (branch.body, branch.orelse)]
        return {n for n in {**arms[0], **arms[1]} if arms[0].get(n) != arms[1].get(n) and (
            arms[0].get(n) or arms[1].get(n))}

    def bound(self, block: list[AST]) -> dict[str, tuple[str, ...]]:
        """The texts of what the names of arrays are bound to in a block, and in the branches in it; empty where it is
        a new array."""
        found: dict[str, tuple[str, ...]] = {}
        for s in block:
            if isinstance(s, If):
                arms = [self.bound(arm) for arm in (s.body, s.orelse)]
                for n in {**arms[0], **arms[1]}:
                    found[n] = (*arms[0].get(n, ("",)), *arms[1].get(n, ("",)))
            elif isinstance(s, Assign) and isinstance(s.targets[0], Name) and self.contents.typing.of(
                    s.targets[0]).is_array:
                found[s.targets[0].id] = (dump(s.value),) if self.contents.sources(s.value) else ()
        return found

    def views_bound(self, chosen: set[str], block: list[AST]) -> set[str]:
        """The names that are bound to different arrays, with those that are bound to parts of them in a block."""
        found = set(chosen)
        bound = [s for s in walk_statements(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
        while more := {s.targets[0].id for s in bound if self.contents.sources(s.value) & found} - found:
            found |= more
        return found


def _names_alone(branch: If) -> bool:
    """Whether a branch binds names alone, and none that its test reads."""
    bound = [*branch.body, *branch.orelse]
    return all(isinstance(s, Assign) and isinstance(s.targets[0], Name) and not any(
        isinstance(n, Call) for n in walk(s.value)) for s in bound) and not set(stored_names(bound)) & set(
        names(branch.test))


def _length(block: list[AST]) -> int:
    return sum(isinstance(s, (Assign, AugAssign, If, For, While, Expr, Assert, Raise)) for s in walk_statements(block))
