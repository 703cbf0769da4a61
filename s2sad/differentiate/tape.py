"""Tape placement: for every value recorded, the local names that hold it between the sweeps.

A push outside of loops is a number. Inside loops with known trips the stack is an array with one index a loop, written
at the counters; elsewhere it is an array and an integer, and doubles when it is full.

    u_stack = np.empty((len(range(steps)),) + u.shape)     x_stack, x_top = np.empty(64), 0
    for s in range(steps):                                 while ...:
        u_stack[s] = u                                         x_stack = grow(x_stack, x_top)
                                                               x_stack[x_top] = x
                                                               x_top += 1
"""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.analyze.dependence import range_parts
from s2sad.analyze.structure import Structure
from s2sad.infer.infer import Typing
from s2sad.infer.types import INT, UNKNOWN, Type, array
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, BinOp, Constant, For, Name, Sub, Subscript, assign, attribute, augment, call, const, copy, index,
    indices, name, names, sub, tuple_of, walk,
)

_FIRST = 64


@dataclass
class Stack:
    """One stack: its names, the counters that index it if it does not grow, and for reports what lies in one entry
    (`kind`, an array type with its `shape`) and how many entries each loop makes (`sizes`; none known if it grows)."""
    array: str
    top: str = ""
    loops: tuple[AST, ...] = ()
    counters: tuple[AST, ...] = ()
    kind: Type = UNKNOWN
    shape: AST | None = None
    sizes: tuple[AST, ...] = ()


@dataclass
class Tape:
    """All stacks of a function; `allocations` by the id of the loop before which they stand."""
    structure: Structure
    typing: Typing
    free: Names
    rerun: frozenset[int]
    stacks: dict[str, Stack] = field(default_factory=dict)
    allocations: dict[int, list[AST]] = field(default_factory=dict)

    def stack(self, key: str, wanted: str, kind: Type, loops: tuple[AST, ...], shape: AST | None) -> Stack:
        """The stack of a value of type `kind` (an array type with its `shape`) pushed inside `loops`."""
        if key not in self.stacks:
            self.stacks[key] = self._made(wanted, kind, loops, shape)
        return self.stacks[key]

    def _made(self, wanted: str, kind: Type, loops: tuple[AST, ...], shape: AST | None) -> Stack:
        last = max((k for k, loop in enumerate(loops) if id(loop) in self.rerun), default=-1)
        inner, home = loops[last + 1:], loops[:1] if last < 0 else loops[min(k for k, x in enumerate(loops)
                                                                            if id(x) in self.rerun):][:1]
        made = Stack(self.free.fresh(f"{wanted}_stack" if inner else f"{wanted}_before"), loops=inner, kind=kind,
                     shape=shape)
        if not inner:
            self.typing.table[made.array] = kind
            return made
        sizes = [self._trips(loop) for loop in inner]
        outside = self._bound_before(home[0])
        if all(s is not None and set(names(s)) <= outside for s in sizes):
            made.counters = tuple(self._counter(loop) for loop in inner)
            whole: list[AST] = [s for s in sizes if s is not None]
            made.sizes = tuple(whole)
            allocated = [self._allocate(made.array, kind, whole, shape)]
        else:
            made.top = self.free.fresh(f"{wanted}_top")
            self.typing.table[made.top] = INT
            allocated = [self._allocate(made.array, kind, [const(_FIRST)], shape), assign(made.top, const(0))]
        self.typing.table[made.array] = array(kind.dtype, kind.rank + max(1, len(made.counters)))
        self.allocations.setdefault(id(home[0]), []).extend(allocated)
        return made

    def _allocate(self, target: str, kind: Type, sizes: list[AST], shape: AST | None) -> AST:
        dtype = [] if kind.dtype == "float64" else [name("numpy.bool_" if kind.dtype == "bool"
                                                         else f"numpy.{kind.dtype}")]
        size: AST = sizes[0] if len(sizes) == 1 and shape is None else tuple_of(*sizes)
        if shape is not None:
            size = BinOp(tuple_of(*sizes), Add(), shape)
        return assign(target, call("numpy.empty", size, *dtype))

    def _bound_before(self, loop: AST) -> set[str]:
        """The names that are bound, for good, before a loop."""
        place = self.structure.place(loop)
        before = {p.id for p in self.structure.function.args.args}
        for number, bound in self.structure.bindings.items():
            first = self.structure.place(bound[0])
            if len(bound) == 1 and first.order < place.order and not first.loops:
                before.add(number)
        return before

    def _trips(self, loop: AST) -> AST | None:
        if not isinstance(loop, For) or any(type(n).__name__ == "Break" for n in walk(loop.body)):
            return None
        start, stop, step = range_parts(loop)
        if step not in (1, -1) or any(isinstance(n, Subscript) and isinstance(n.value, Name) for n in walk(loop.iter)):
            return None
        plain = isinstance(start, Constant) and start.value == 0 and step == 1
        return copy(stop) if plain and self._is_size(stop) else call("builtins.len", copy(loop.iter))

    def _is_size(self, node: AST) -> bool:
        """Whether a number is a size of an array, and so not negative."""
        if isinstance(node, Name):
            bound = self.structure.bindings.get(node.id, [])
            return len(bound) == 1 and hasattr(bound[0], "value") and self._is_size(bound[0].value)
        text = node.func if hasattr(node, "func") else node
        if isinstance(text, Subscript) and isinstance(text.value, AST):
            return getattr(text.value, "attr", "") == "shape"
        return getattr(text, "attr", "") == "size" or getattr(text, "id", "") == "builtins.len"

    def _counter(self, loop: AST) -> AST:
        assert isinstance(loop, For)
        start, _, step = range_parts(loop)
        counter = name(loop.target.id)
        if step == -1:
            return BinOp(copy(start), Sub(), counter)
        return counter if isinstance(start, Constant) and start.value == 0 else sub(counter, copy(start))

    # -- statements --------------------------------------------------------------------------------------------------

    def push(self, stack: Stack, value: AST) -> list[AST]:
        whole = self.typing.of(value).is_array
        if not stack.counters and not stack.top:
            return [assign(stack.array, call("numpy.copy", value) if whole else value)]
        cell = self.cell(stack)
        if not stack.top:
            return [assign(cell, value)]
        return [assign(stack.array, call("runtime.grow", name(stack.array), name(stack.top))), assign(cell, value),
                augment(stack.top, Add(), const(1))]

    def cell(self, stack: Stack) -> AST:
        if not stack.counters and not stack.top:
            return name(stack.array)
        return index(name(stack.array), *(map(copy, stack.counters) if stack.counters else [name(stack.top)]))

    def pop(self, stack: Stack, target: AST) -> list[AST]:
        made: list[AST] = [augment(stack.top, Sub(), const(1))] if stack.top else []
        return [*made, assign(target, self.cell(stack))]


def shape_of(place: AST, typing: Typing) -> AST | None:
    """The shape of what a store overwrites, None for an element."""
    if not typing.of(place).is_array:
        return None
    base = place.value if isinstance(place, Subscript) else place
    done = 0 if isinstance(place, Name) else sum(
        not (isinstance(s, Constant) and s.value is Ellipsis) for s in indices(place))
    if not done:
        return attribute(copy(base), "shape")
    rank = typing.of(base).rank
    return tuple_of(*(index(attribute(copy(base), "shape"), const(k)) for k in range(done, rank)))


