"""A kernel for given types, and the summary of what a call of it does."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.liveness import Accesses, Liveness
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.differentiate.user_functions import UserFunction
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.program import Kernel
from s2sad.tree import FunctionDef


@dataclass(frozen=True)
class UnitSummary:
    """What a call of a unit does: positions written, pairs (argument, argument or "return k") of dependence."""
    written: tuple[int, ...]
    results: tuple[Type, ...]
    returned: dict[int, str]
    edges: tuple[tuple[int, int | str], ...]
    pure: bool


@dataclass
class Unit:
    """A kernel for given types, in normal form; `numbers` says of which array a number has taken the place."""
    kernel: Kernel
    title: str
    types: tuple[Type, ...]
    function: FunctionDef
    typing: Typing
    family: dict[str, str]
    names: Names
    lowered: FunctionDef
    structure: ProgramStructure
    summary: UnitSummary
    guarded: bool = False
    pairs: tuple[tuple[int, int], ...] = ()
    once: bool = False
    numbers: dict[str, str] = field(default_factory=dict)
    lowered_types: dict[str, Type] = field(default_factory=dict)
    contiguous: tuple[int, ...] = ()            # the parameters that must be

    @property
    def owner(self) -> UserFunction:
        """What stands of it where its derivative is the user's own."""
        assert self.kernel.own is not None
        parameters = [p.id for p in self.function.args.args]
        return UserFunction(self.title, self.kernel.own, dict(zip(parameters, self.types)), self.summary.results,
                            frozenset(parameters[k] for k in self.summary.written))

    def read_first(self) -> set[str]:
        """The parameters whose content at its start the kernel may read."""
        live = Liveness(self.function, set(), Accesses(), strong=False)
        return live.start & {p.id for p in self.function.args.args}
