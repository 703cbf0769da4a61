"""What the steps towards structured form share: the kernel, its names, its program, and what is to be said."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.evaluate.effects import Memory
from s2sad.infer.types import Type
from s2sad.passes import Context
from s2sad.tree import (
    AST, Assign, Call, Constant, FunctionDef, Name, assign, at, name, names, stored_names, walk_statements,
)


@dataclass(kw_only=True)
class KernelScope(Context):
    """One kernel on its way; `memory` knows which of its names may share memory."""
    given: dict[str, Type] = field(default_factory=dict)        # the types of the parameters, once they are known
    _tree: FunctionDef | None = field(init=False, default=None)
    _memory: Memory | None = field(init=False, default=None)
    _sequences: set[str] | None = field(init=False, default=None)

    def begin(self, tree: FunctionDef) -> None:
        self._tree, self._memory = tree, None       # the pass before has made names

    @property
    def memory(self) -> Memory:
        """Of the tree that the pass was given, and of the names that it has made."""
        if self._memory is None:
            assert self._tree is not None
            self._memory = Memory(self._tree, self.program)
        return self._memory

    @property
    def sequences(self) -> set[str]:
        """The kernel's names that hold no results of functions, which may be tuples."""
        if self._sequences is None:
            tree = self.kernel.tree
            bound = [s for s in walk_statements(tree.body) if isinstance(s, Assign)]
            results: set[str] = set()
            while more := {n for s in bound if isinstance(s.value, Call) or results.intersection(names(s.value))
                           for n in stored_names(s)} - results:
                results |= more
            self._sequences = {p.id for p in tree.args.args}.union(*map(stored_names, bound)) - results
        return self._sequences

    def fresh(self, wanted: str) -> str:
        """A new name: the wanted one, else numbered from 2."""
        return self.names.numbered(wanted)

    def refuse(self, node: AST, message: str, help: str = "", code: str = "S201") -> None:
        self.report.error(code, message, node, help=help)

    def held(self, value: AST, wanted: str, into: list[AST]) -> AST:
        """A name for the value as it is at this point: the assignment goes into the given statements."""
        if isinstance(value, Constant):
            return value
        new = self.fresh(wanted)
        self.memory.bind([new], value)
        into.append(at(assign(new, value), value) if getattr(value, "lineno", None) else assign(new, value))
        return name(new)


def atomic(node: AST) -> bool:
    """Whether an expression is a name or a constant: reading it twice, or later, is free and the same."""
    return isinstance(node, (Constant, Name))
