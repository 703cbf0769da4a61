"""reusable_memory: the entry's stacks, and an arena for its work arrays, become parameters, so that the caller can
reuse them in its next call.

    def f_adjoint(u, u_bar):                def f_adjoint_taped(u, u_bar, u_stack, arena):
        u_stack = np.empty(u.size)              u_stack = sized(u_stack, (u.size,))
        v = np.empty_like(u)                    v, top = allocate(arena, 0, u.shape)
        w_bar = np.zeros((n, 3))                w_bar, top = allocate_zeros(arena, top, (n, 3))
        p = a @ b                               p, top = allocate(arena, top, (a.shape[0], b.shape[1]))
                                                np.dot(a, b, out=p)
        ...                                     ...
                                                return u_stack, top
                                            def f_adjoint(u, u_bar):
                                                f_adjoint_taped(u, u_bar, np.empty(0), np.empty(0))

*Requires* finished text for Numba, whose arrays no function of the user's keeps. *Establishes* a function that is given
its memory and returns its stacks (larger ones may have replaced them) and how much of an arena it has use for, and the
public one. Fresh memory costs as much as the arithmetic: each page is faulted in anew.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from s2sad.blocks import with_blocks
from s2sad.differentiate.tape import Stack
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, Attribute, BinOp, Call, Constant, Expr, FunctionDef, Name, Return, Store, Tuple, assign, at,
    attribute, call, call_name, const, copy, function, index, name, names, tuple_of, walk, walk_statements,
)

_FRESH = {"numpy.empty", "numpy.zeros", "numpy.empty_like", "numpy.zeros_like", "numpy.copy", "numpy.matmul"}


@dataclass(frozen=True)
class ReusableMemory:
    """The two functions, the stacks as (name, dtype, rank), and whether an arena is given behind them."""
    taped: FunctionDef
    public: FunctionDef
    stacks: tuple[tuple[str, str, int], ...]
    arena: bool


def reusable_memory(made: FunctionDef, stacks: list[Stack], types: Mapping[str, Type], title: str, with_arena: bool
                    ) -> ReusableMemory | None:
    """The pair for a finished derivative, None if it has no memory to be kept; `title` is the name of the first."""
    if [s for s in walk_statements(made.body) if isinstance(s, Return)] not in ([], made.body[-1:]):
        return None
    allocated = _allocated_stacks(made.body)
    kept = {s.array: s for s in stacks if s.loops and s.array in allocated}
    arena = _Arena(made, types, set(kept))
    body = arena.block(made.body) if with_arena else made.body
    if not kept and not arena.used:
        return None
    parameters, given = [p.id for p in made.args.args], [*kept, *([arena.name] if arena.used else [])]
    body = _with_sized_stacks(body, kept)
    last = body.pop() if isinstance(body[-1], Return) else None
    values = list(last.value.elts) if last is not None and isinstance(last.value, Tuple) else []
    body.append(Return(tuple_of(*values, *map(name, [*kept, *([arena.top] if arena.used else [])]))))
    rank = {s: types[s].rank for s in kept}
    empty = [call("numpy.empty", const(0) if rank.get(s, 1) == 1 else tuple_of(*[const(0)] * rank[s]),
                  *(_dtype(types[s]) if s in kept else [])) for s in given]
    public = _public(made, call(f"user.{title}", *map(name, parameters), *empty), len(values))
    described = tuple((s, types[s].dtype, rank[s]) for s in kept)
    return ReusableMemory(function(title, [*parameters, *given], body), public, described, arena.used)


def _public(made: FunctionDef, called: AST, results: int) -> FunctionDef:
    """The function that has memory of its own for a call."""
    parameters = [p.id for p in made.args.args]
    body: list[AST] = [Expr(called)]
    if results:
        held = "returned" if "returned" not in parameters else "returned_"
        body = [assign(held, called),
                Return(tuple_of(*(index(name(held), const(k)) for k in range(results))))]
    return function(made.name, parameters, body)


# -- stacks ---------------------------------------------------------------------------------------------------------

def _allocated_stacks(block: list[AST]) -> set[str]:
    return {s.targets[0].id for s in walk_statements(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)
            and call_name(s.value) == "numpy.empty"}


def _with_sized_stacks(block: list[AST], kept: dict[str, Stack]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in kept and call_name(statement.value) == "numpy.empty":
            made.append(at(assign(target.id, call("runtime.sized", name(target.id), _stack_shape(
                copy(statement.value.args[0]), kept[target.id]))), statement))
        else:
            made.append(with_blocks(statement, lambda inner: _with_sized_stacks(inner, kept)))
    return made


def _stack_shape(shape: AST, stack: Stack) -> AST:
    """The shape as a tuple; a growing stack keeps the length that it has reached."""
    shape = _as_tuple(shape)
    if not stack.grows:
        return shape
    length = call("builtins.max", const(64), index(attribute(name(stack.array), "shape"), const(0)))
    if isinstance(shape, Tuple):
        return tuple_of(length, *shape.elts[1:])
    return BinOp(tuple_of(length), Add(), shape.right)


def _as_tuple(shape: AST) -> AST:
    return shape if _is_tuple(shape) else tuple_of(shape)


def _is_tuple(shape: AST) -> bool:
    """Whether a shape is spelled as a tuple; a length is none."""
    if isinstance(shape, BinOp):
        return _is_tuple(shape.left) or _is_tuple(shape.right)
    return isinstance(shape, Tuple) or isinstance(shape, Attribute) and shape.attr == "shape"


def _dtype(kind: Type) -> list[AST]:
    return [] if kind.dtype == "float64" else [name("numpy.bool_" if kind.dtype == "bool" else f"numpy.{kind.dtype}")]


# -- work arrays ----------------------------------------------------------------------------------------------------

class _Arena:
    """The work arrays of a function that have one size, and leave the function by no name."""

    def __init__(self, made: FunctionDef, types: Mapping[str, Type], stacks: set[str]):
        self.types, self.used = types, False
        free = Names({n.id for n in walk(made) if isinstance(n, Name)} | set(types))
        self.name, self.top = free.fresh("arena"), free.fresh("top")
        self.bound = Counter(n.id for n in walk(made.body) if isinstance(n, Name) and isinstance(n.ctx, Store))
        self.excluded = stacks | {p.id for p in made.args.args}
        self.refused = False
        for value in _returned(made.body):
            self.excluded |= set(names(value))
            self.refused = self.refused or not self.is_apart(value, made.body)

    def is_apart(self, value: AST, body: list[AST]) -> bool:
        """Whether what is returned is a number, or an array that certainly is no other name's."""
        if isinstance(value, Constant) or not isinstance(value, Name):
            return not any(self.types.get(n) is None or not self.types[n].is_number for n in names(value))
        kind = self.types.get(value.id)
        return kind is not None and kind.is_number or all(
            call_name(s.value) in _FRESH for s in walk_statements(body) if isinstance(s, Assign)
            for n in walk(s.targets) if isinstance(n, Name) and isinstance(n.ctx, Store) and n.id == value.id)

    def block(self, block: list[AST]) -> list[AST]:
        """The statements of a body, which runs once, with their allocations in the arena."""
        if self.refused:
            return block
        made: list[AST] = []
        for statement in block:
            made += [at(s, statement) for s in self.in_arena(statement) or [statement]]
        return made

    def in_arena(self, statement: AST) -> list[AST] | None:
        """What allocates the array of an assignment in the arena; None if nothing does."""
        if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name) or not isinstance(
                statement.value, Call):
            return None
        target, value = statement.targets[0].id, statement.value
        if self.bound[target] != 1 or target in self.excluded:
            return None
        if call_name(value) == "numpy.matmul":
            shape = self.product_shape(*value.args)
            return None if shape is None else [
                self.allocation("allocate", target, shape), Expr(call("numpy.dot", *value.args, out=name(target)))]
        shape = self.shape(value)
        if shape is None:
            return None
        how = "allocate_zeros" if "zeros" in (call_name(value) or "") else "allocate"
        filled = [assign(index(name(target), Constant(..., None)), value.args[0])]
        return [self.allocation(how, target, shape), *(filled if call_name(value) == "numpy.copy" else [])]

    def allocation(self, how: str, target: str, shape: AST) -> AST:
        place = name(self.top) if self.used else const(0)
        self.used = True
        return Assign([Tuple([Name(n, Store(), None, None) for n in (target, self.top)], Store())],
                      call(f"runtime.{how}", name(self.name), place, copy(shape)), None)

    def shape(self, value: Call) -> AST | None:
        """The shape of a new array of floats; None of anything else."""
        called = call_name(value)
        if called not in _FRESH or len(value.args) != 1 or value.keywords:
            return None
        if called in ("numpy.empty", "numpy.zeros"):
            return _as_tuple(value.args[0])
        model = value.args[0]
        return attribute(copy(model), "shape") if self.floats(model) else None

    def floats(self, node: AST) -> int:
        """The rank of a name's array of floats; 0 of anything else."""
        kind = self.types.get(node.id) if isinstance(node, Name) else None
        return kind.rank if kind is not None and kind.is_array and kind.dtype == "float64" else 0

    def product_shape(self, left: AST, right: AST) -> AST | None:
        """The shape of a product of arrays of one or two axes, each a name's or its transpose's."""
        sides = [self.axes(left), self.axes(right)]
        if not all(sides) or sum(map(len, sides)) < 3:
            return None
        return tuple_of(*sides[0][:-1], *(sides[1][1:] if len(sides[1]) > 1 else []))

    def axes(self, node: AST) -> list[AST]:
        """The lengths of the axes of such an array."""
        if call_name(node) == "numpy.transpose" and isinstance(node, Call) and len(node.args) == 1:
            return self.axes(node.args[0])[::-1]
        rank = self.floats(node)
        return [index(attribute(copy(node), "shape"), const(k)) for k in range(rank)] if rank < 3 else []


def _returned(block: list[AST]) -> list[AST]:
    """The values that a function returns."""
    found = [s.value for s in walk_statements(block) if isinstance(s, Return) and s.value is not None]
    return [v for value in found for v in (value.elts if isinstance(value, Tuple) else [value])]
