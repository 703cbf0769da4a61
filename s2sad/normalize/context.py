"""What the passes of `normalize` share, and the facts that each leaves for later ones."""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from s2sad.diagnostics import Report
from s2sad.evaluate.scope import KernelScope
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.passes import Callees
from s2sad.tree import Call, FunctionDef

if TYPE_CHECKING:
    from s2sad.normalize.calls.inline import Helpers
    from s2sad.normalize.dtypes.weak_results import KnownResults
    from s2sad.normalize.views.contiguity import Contiguity


@dataclass(kw_only=True)
class NormalContext(KernelScope):
    """One kernel for given types on its way to normal form."""
    callees: Callees
    helpers: Helpers
    known: KnownResults
    singles: bool                       # whether anything in the program is of float32
    pending: Report = field(init=False)                 # what contradicts itself, unless a check has more to say of it
    swapped: set[str] = field(default_factory=set)      # names that are bound to several arrays
    shared: bool = False                                # a store would tell a buffer from NumPy's array
    lists: Set[str] = frozenset()                       # the arrays in place of lists
    contiguity: Contiguity = field(init=False)
    contiguous: set[str] = field(default_factory=set)   # the parameters that must be
    guarded: bool = False                               # whether guards of shapes were added
    lowered: FunctionDef = field(init=False)            # the primal as it runs, and the types of its names
    lowered_types: Mapping[str, Type] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)   # the arrays that were contracted to numbers
    family: dict[str, str] = field(default_factory=dict)    # the variable of each name

    def fork(self) -> NormalContext:
        made = super().fork()
        made.contiguous = set(self.contiguous)
        return made

    @property
    def constants(self) -> dict[str, object]:
        """The values of names from outside."""
        return {**self.program.constants, **self.program.arrays}

    def typed(self, table: Mapping[str, Type], report: Report, final: bool = False) -> Typing:
        """The types of expressions over these of names."""
        given = {n: replace(t, ones=table[n].ones) if n in table else t for n, t in self.given.items()}
        return Typing({**table, **given}, self.callees.call_types, report, self.constants, final)

    def written(self, called: Call) -> tuple[int, ...]:
        """The positions of the arrays that a call writes."""
        return self.callees.of_call(called, self.typing).summary.written

    def written_arrays(self, called: Call) -> list[str]:
        """The arrays that a call writes."""
        return [base_name(called.args[k]) for k in self.written(called)]
