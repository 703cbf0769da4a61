"""destination_passing: a function that returns arrays of its own, and is called more than once, writes them into arrays
of the caller's.

    def rhs(u):                         def rhs_into(u, du):
        du = np.zeros_like(u)               du[...] = 0.0
        for i in range(u.size):             for i in range(u.size):
            du[i] = ...                         du[i] = ...
        return du
    k1 = rhs(u)                         k1 = np.empty(u.shape)
                                        rhs_into(u, k1)

    def flow(u, v):                     def flow_into(u, v, flow_value):
        return u * v + np.roll(u, 1)        flow_value[...] = u * v + np.roll(u, 1)

Requires structured form and types; establishes structured form. The function stays one function, with one derivative,
where `inline` would copy it to each call, and compiling takes as many times longer; functions of a few operations
without a loop are inlined all the same. The shapes of its results must follow from the arguments.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.evaluate.call_graph import calls
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.normalize.calls.result_shapes import MAKERS, ResultShapes, Shapes, is_made
from s2sad.program import Kernel, Program
from s2sad.tree import (
    AST, Assign, Call, Constant, Expr, For, FunctionDef, Name, Return, Tuple, While, assign, at, call, call_name, const,
    copy, function, index, name, rebuild, user_call, walk, walk_statements,
)

_LEAST = 100    # nodes of a function without a loop that stays a function


@dataclass(frozen=True)
class DestinationVersion:
    """A function that writes what another one returns: its name in the program, and for every result the name that it
    has there and the call that makes an array for it, of the function's parameters."""
    kernel: str
    results: tuple[tuple[str, AST], ...]


class OwnedResults:
    """What a function in structured form returns, as far as it is its own; `shapes` are of its parameters."""

    def __init__(self, tree: FunctionDef, typing: Typing, called: Shapes):
        self.tree, self.sizes = tree, ResultShapes(tree, typing, called)
        last = tree.body[-1] if tree.body else None
        value = last.value if isinstance(last, Return) else None
        self.values: list[AST] = [] if value is None else list(value.elts) if isinstance(value, Tuple) else [value]
        self.shapes = [self.sizes.shape(v) if self.is_own(v) else None for v in self.values]

    def filled(self) -> dict[str, Assign]:
        """The statements that allocate results with a name, and may fill an array of the caller's instead."""
        words = {v.id for v in self.values if isinstance(v, Name)} - {p.id for p in self.tree.args.args}
        return {s.targets[0].id: s for s in self.tree.body if isinstance(s, Assign) and isinstance(
            s.targets[0], Name) and s.targets[0].id in words and not user_call(s.value)}

    def is_own(self, value: AST) -> bool:
        return value.id in self.sizes.made if isinstance(value, Name) else is_made(value)


def destination_passing(kernel: Kernel, found: OwnedResults, types: tuple[Type, ...],
                        program: Program) -> DestinationVersion | None:
    """The function that writes what `kernel` returns, which `program` has from now on; None where the function is to be
    inlined. `types` are those of the results."""
    known, filled = [s for s in found.shapes if s is not None], found.filled()
    names = [v.id for v in found.values if isinstance(v, Name)]
    if len(known) < len(types) or len(set(names)) < len(names) or not all(t.is_array for t in types) or (
            not _is_worthwhile(kernel, found.tree, program) or _reshapes(found.tree)):
        return None
    title = f"{kernel.name}_into"
    while title in program.kernels:
        title += "_"
    taken = Names(n.id for n in walk(found.tree) if isinstance(n, Name))
    words = [v.id if isinstance(v, Name) and v.id in filled else taken.numbered(f"{kernel.name}_value")
             for v in found.values]
    body = [_filled(s) if any(s is f for f in filled.values()) else s for s in found.tree.body[:-1]]
    stores = [at(_store(w, v), found.tree.body[-1]) for w, v in zip(words, found.values) if not (
        isinstance(v, Name) and v.id == w)]
    own = [p.id for p in found.tree.args.args]
    new = at(function(title, [*own, *words], [*(s for s in body if s is not None), *stores]), found.tree)
    program.kernels[title] = replace(kernel, name=title, tree=new, parameters=(*kernel.parameters, *words),
                                      results=len(words), nested=None)
    made = [call("numpy.empty", s, *dtype_of(t))
            for s, t in zip(known, types)]
    return DestinationVersion(title, tuple(zip(words, made)))


def _is_worthwhile(kernel: Kernel, tree: FunctionDef, program: Program) -> bool:
    """Whether a function is called more than once, and long."""
    if len(program.once(calls).get(kernel.name, ())) < 2:
        return False
    return any(isinstance(n, (For, While))
               for n in walk_statements(tree.body)) or _length(tree, program.once(_lengths)) > _LEAST


def _reshapes(tree: FunctionDef) -> bool:
    """Whether a function reshapes what it makes: how that lies in memory is then to be seen."""
    parameters = {p.id for p in tree.args.args}
    return any(call_name(n) in ("numpy.ravel", "numpy.reshape") and not (isinstance(n.args[0], Name)
               and n.args[0].id in parameters) for n in walk(tree.body) if isinstance(n, Call) and n.args)


def _lengths(program: Program) -> dict[str, int]:
    """The nodes of every function, and of those that it calls as often as it does."""
    found: dict[str, int] = {}
    for title, kernel in program.kernels.items():  # callees first
        found[title] = _length(kernel.tree, found)
    return found


def _length(tree: FunctionDef, lengths: Mapping[str, int]) -> int:
    return sum(1 + lengths.get(user_call(n) or "", 0) for n in walk(tree.body))


def _store(word: str, value: AST) -> AST:
    return Assign([index(name(word), Constant(Ellipsis, None))], value, None)


def _filled(statement: AST) -> AST | None:
    """The statement that fills a result where it was made; None if that is left to others."""
    assert isinstance(statement, Assign)
    called = call_name(statement.value) or ""
    value = const(MAKERS[called]) if MAKERS.get(called) is not None else None if called in MAKERS else statement.value
    return None if value is None else at(_store(statement.targets[0].id, value), statement)


def filling_call(statement: Assign | Expr, called: Call, version: DestinationVersion, arguments: Mapping[str, AST],
         fresh: list[str]) -> list[AST]:
    """The arrays made and the call that fills them, in place of a call; `arguments` by parameter, `fresh` the names of
    the arrays."""
    made = [at(assign(word, with_arguments(size, arguments)), statement)
            for word, (_, size) in zip(fresh, version.results)]
    filled = call(f"user.{version.kernel}", *map(copy, arguments.values()), *map(name, fresh))
    return [*made, at(Expr(at(filled, called)), statement)]


def with_arguments(size: AST, arguments: Mapping[str, AST]) -> AST:
    """A size of the parameters as one of the arguments."""
    return rebuild(size, lambda n: copy(arguments[n.id]) if isinstance(n, Name) and n.id in arguments else None)


__all__ = ["DestinationVersion", "OwnedResults", "destination_passing", "filling_call", "with_arguments"]
