"""derivative: the function of a derivative, with the roles of its parameters and the shadows of its names."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.differentiate.tape import Tape
from s2sad.infer.types import Type
from s2sad.tree import AST, FunctionDef


@dataclass
class Derivative:
    """A derivative: the function, the shadow of every name, its parameters as (name, role, primal), its returns; the
    lists of what a user's first halves keep, each with the call; the arrays that sum what shadows gain; of a loop that
    keeps snapshots, the arrays of these, each with what it keeps, how many, the name of the number of steps, and
    whether the adjoint of a step runs a part of it; the types of names under which versions of a variable come."""
    function: FunctionDef
    shadows: dict[str, str]
    parameters: list[tuple[str, str, str]] = field(default_factory=list)
    returns: list[str] = field(default_factory=list)
    tape: Tape | None = None
    kept: list[tuple[str, AST]] = field(default_factory=list)
    sums: set[str] = field(default_factory=set)
    snapshots: dict[str, AST] = field(default_factory=dict)
    rows: AST | None = None
    trips: str = ""
    again: bool = True
    coalesced: dict[str, Type] = field(default_factory=dict)
