"""What the analyses of one derivative share, and what each finds out for later ones and for `differentiate`."""
from __future__ import annotations

from collections.abc import Collection, Set
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from s2sad.passes import Context
from s2sad.program import Economy, TapeDtype
from s2sad.tree import AST, Call

if TYPE_CHECKING:
    from s2sad.analyze.activity import Activity
    from s2sad.analyze.callee_derivatives import ActivityPattern, Derive
    from s2sad.analyze.program_structure import ProgramStructure
    from s2sad.analyze.recording_plan import RecordingPlan, RecordingProblem
    from s2sad.analyze.request import DerivativeRequest
    from s2sad.analyze.unbounded_values import UnboundedValues
    from s2sad.analyze.uses import Choices


class CallFacts(Protocol):
    """What is known of statements that call other kernels."""

    def call_edges(self, node: Call) -> list[tuple[int, int | str]]: ...
    def unbounded(self, called: Call) -> UnboundedValues | None: ...
    def writes(self, statement: AST) -> list[AST]: ...
    def is_pure(self, node: Call) -> bool: ...
    def refills(self, node: Call, array: str, known: Set[str]) -> bool: ...
    def decides(self, called: Call) -> Collection[int]: ...
    def adjoint_after(self, statement: AST) -> bool: ...
    def unsupported(self, called: Call, pattern: ActivityPattern, mode: str) -> str: ...


@dataclass(kw_only=True)
class AnalysisContext(Context):
    """A kernel in normal form and the derivative that is wanted of it, with a table from each analysis."""
    request: DerivativeRequest
    mode: str                       # "adjoint" or "tangent"
    calls: CallFacts
    derive: Derive                  # makes the derivative of a callee
    choices: Choices = field(default_factory=dict)
    memory: Economy = "balanced"
    tape_dtype: TapeDtype = "float64"
    structure: ProgramStructure = field(init=False)
    activity: Activity = field(init=False)
    unbounded: UnboundedValues = field(init=False)
    problem: RecordingProblem = field(init=False)
    plan: RecordingPlan | None = None       # of an adjoint
