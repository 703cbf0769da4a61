"""given_results: a function with loops that returns arrays of its own, and is called more than once, writes them into
arrays that it is given.

    def rhs(u):                         def rhs_into(u, du):
        du = np.zeros_like(u)               du[...] = 0.0
        for i in range(u.size):             for i in range(u.size):
            du[i] = ...                         du[i] = ...
        return du
    k1 = rhs(u)                         du = np.empty_like(u)
                                        rhs_into(u, du)
                                        k1 = du

Requires structured form; establishes it. The function stays one function, with one derivative, where `inlined` would
write it out as often as it is called. Every result is made once, by a statement of the function's own whose size
follows from what is given.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

from s2sad.program import Kernel, Program
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Call, Constant, Expr, For, FunctionDef, Name, Return, Store, Subscript, Tuple,
    UnaryOp, While, assign, at, call, call_name, const, copy, function, index, name, rebuild, walk,
)

_FILLS = {"numpy.empty": None, "numpy.empty_like": None, "numpy.zeros": 0.0, "numpy.zeros_like": 0.0,
          "numpy.ones": 1.0, "numpy.ones_like": 1.0}
_OF_SIZES = ("builtins.len", "builtins.max", "builtins.min", "builtins.int")


@dataclass(frozen=True)
class Given:
    """A function that writes what another one returns: its name in the program, and for every result the name that it
    has there and the call that makes an array for it, of the function's parameters."""
    kernel: str
    results: tuple[tuple[str, AST], ...]


def given_results(kernel: Kernel, tree: FunctionDef, program: Program) -> Given | None:
    """The function that writes what `kernel` returns, `tree` in structured form, which `program` has from now on; None
    where the function is to be written out."""
    last = tree.body[-1] if tree.body else None
    if not isinstance(last, Return) or not any(isinstance(n, (For, While)) for n in walk(tree.body)) or sum(
            call_name(n) == f"user.{kernel.name}" for k in program.kernels.values() for n in walk(k.tree.body)) < 2:
        return None
    values = list(last.value.elts) if isinstance(last.value, Tuple) else [last.value]
    results = [v.id for v in values if isinstance(v, Name)]
    sizes = _Sizes(tree)
    made = [sizes.made.get(r) for r in results]
    if len(results) < len(values) or len(set(results)) < len(results) or any(m is None for m in made):
        return None
    title = f"{kernel.name}_into"
    while title in program.kernels:
        title += "_"
    own = tuple(p.id for p in tree.args.args)
    body = [_filled(s) if isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id in results else s
            for s in tree.body[:-1]]
    new = at(function(title, [*own, *results], [s for s in body if s is not None]), tree)
    program.kernels[title] = replace(kernel, name=title, tree=new, parameters=(*kernel.parameters, *results))
    return Given(title, tuple((r, m) for r, m in zip(results, made) if m is not None))


def _filled(statement: Assign) -> AST | None:
    """The statement that fills a result as the function makes it; None if that is for it to fill."""
    value = _FILLS[call_name(statement.value) or ""]
    if value is None:
        return None
    return at(Assign([index(statement.targets[0], Constant(Ellipsis, None))], const(value), None), statement)


class _Sizes:
    """The arrays that a function makes once and whose sizes follow from its parameters; `made` has the calls that make
    such arrays, of the parameters."""

    def __init__(self, tree: FunctionDef):
        self.bound = Counter(n.id for n in walk(tree.body) if isinstance(n, Name) and isinstance(n.ctx, Store))
        self.known: dict[str, AST] = {p.id: name(p.id) for p in tree.args.args}
        self.made: dict[str, AST] = {}
        for statement in tree.body:
            target = statement.targets[0] if isinstance(statement, Assign) else None
            for node in walk(statement):
                if isinstance(node, Name) and isinstance(node.ctx, Store) and node is not target:
                    self.known.pop(node.id, None)
            if isinstance(target, Name):
                self.binds(target.id, statement.value)

    def binds(self, word: str, value: AST) -> None:
        """Takes note of a name that a statement binds."""
        self.known.pop(word, None)
        if call_name(value) in _FILLS and self.bound[word] == 1:
            made = self.allocation(value)
            self.made |= {} if made is None else {word: made}
        elif (found := self.size(value)) is not None:
            self.known[word] = found

    def allocation(self, called: AST) -> AST | None:
        """The call that makes an empty array of the same kind."""
        assert isinstance(called, Call)
        like = (call_name(called) or "").endswith("_like")
        first, *rest = called.args
        if called.keywords or any(not isinstance(a, (Name, Constant)) or not _is_type(a) for a in rest):
            return None
        if like and isinstance(first, Name) and first.id in self.made and not rest:
            return copy(self.made[first.id])
        size = self.known.get(first.id) if like and isinstance(first, Name) else None if like else self.size(first)
        if size is None or like and not isinstance(size, Name):
            return None
        return call("numpy.empty_like" if like else "numpy.empty", copy(size), *map(copy, rest))

    def size(self, node: AST) -> AST | None:
        """An integer, or a shape, of the parameters; None for anything else."""
        if isinstance(node, Constant):
            return copy(node)
        if isinstance(node, Name):
            return copy(self.known[node.id]) if node.id in self.known else None
        array = node.value if isinstance(node, Subscript) and isinstance(node.slice, Constant) else node
        if isinstance(array, Attribute):
            base = self.size(array.value) if isinstance(array.value, Name) and array.attr in ("shape", "size") else None
            return None if not isinstance(base, Name) else rebuild(node, lambda n: base if n is array.value else None)
        if not isinstance(node, (BinOp, UnaryOp, Tuple)) and call_name(node) not in _OF_SIZES:
            return None
        parts = {id(part): self.size(part) for part in _operands(node)}
        if any(part is None for part in parts.values()):
            return None
        return rebuild(node, lambda n: parts.get(id(n)))


def _operands(node: AST) -> list[AST]:
    if isinstance(node, BinOp):
        return [node.left, node.right]
    return [node.operand] if isinstance(node, UnaryOp) else list(node.elts if isinstance(node, Tuple) else node.args)


def _is_type(node: AST) -> bool:
    return isinstance(node, Name) and node.id.startswith(("numpy.", "builtins."))


def into(statement: Assign | Expr, called: Call, given: Given, arguments: Mapping[str, AST],
         fresh: list[str]) -> list[AST]:
    """The arrays made and the call that fills them, in place of a call; `arguments` by parameter, `fresh` the names of
    the arrays."""
    def placed(node: AST) -> AST:
        return rebuild(node, lambda n: copy(arguments[n.id]) if isinstance(n, Name) and n.id in arguments else None)
    made = [at(assign(word, placed(size)), statement) for word, (_, size) in zip(
        fresh, given.results)]
    filled = call(f"user.{given.kernel}", *map(copy, arguments.values()), *map(name, fresh))
    return [*made, at(Expr(at(filled, called)), statement)]


__all__ = ["Given", "given_results", "into"]
