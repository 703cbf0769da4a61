"""unit: a kernel for one set of argument types, and the summary of a call of it."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.liveness import Accesses, Liveness
from s2sad.infer.index_systems import IndexBounds
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.differentiate.user_functions import UserFunction
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.normalize.calls.outlining import OutlinedLoop
from s2sad.program import Kernel
from s2sad.tree import FunctionDef


@dataclass(frozen=True)
class UnitSummary:
    """The effect of a call: positions of stored arrays, edges (argument, argument or "return k") of dependence."""
    written: tuple[int, ...]
    results: tuple[Type, ...]
    returned: dict[int, str]
    edges: tuple[tuple[int, int | str], ...]
    pure: bool


@dataclass
class Unit:
    """A kernel for one set of argument types, in normal form; `numbers` has the array that each number replaces.
    `runs_once` if the reverse sweep does not run it again, `has_state` if that is since a user's own derivative is in
    it; `loop` is what an outlined loop consists of, `outlined` if it is such a loop or its step."""
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
    runs_once: bool = False
    has_state: bool = False
    outlined: bool = False
    loop: OutlinedLoop | None = None
    numbers: dict[str, str] = field(default_factory=dict)
    lowered_types: dict[str, Type] = field(default_factory=dict)
    contiguous: tuple[int, ...] = ()            # the parameters that must be
    index_bounds: IndexBounds | None = None     # of the kernel as it is run, once asked for

    @property
    def owner(self) -> UserFunction:
        """The signature of a function with a derivative of the user's own."""
        assert self.kernel.own is not None
        parameters = [p.id for p in self.function.args.args]
        return UserFunction(self.title, self.kernel.own, dict(zip(parameters, self.types)), self.summary.results,
                            frozenset(parameters[k] for k in self.summary.written))

    def read_first(self) -> set[str]:
        """The parameters that are live at the start of the kernel."""
        live = Liveness(self.function, set(), Accesses(), strong=False)
        return live.start & {p.id for p in self.function.args.args}
