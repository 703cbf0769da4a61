"""What a derivative is made of, and what is known of it when it is made."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from s2sad.analyze.context import AnalysisContext

if TYPE_CHECKING:
    from s2sad.differentiate.derivative import Derivative


@dataclass(kw_only=True)
class DifferentiationContext(AnalysisContext):
    """One derivative; `title` is the name of its function, `family` has the variable of the user's that a name is a
    version of."""
    title: str
    family: Mapping[str, str]
    flat: bool = False              # a tangent that returns results and tangents side by side
    derivative: Derivative = field(init=False)
