"""What the steps towards structured form share: the kernel, its names, its program, and what is to be said."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.diagnostics import Report
from s2sad.naming import Names
from s2sad.normalize.memory import Memory
from s2sad.program import Kernel, Program
from s2sad.tree import AST, Constant, Name, assign, at, name


@dataclass
class Scope:
    """One kernel on its way; `memory` knows which of its names may share memory."""
    kernel: Kernel
    names: Names
    program: Program
    memory: Memory
    report: Report = field(init=False)

    def __post_init__(self) -> None:
        self.report = Report(self.kernel.source)

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
