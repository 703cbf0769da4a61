"""What was found about a derivative: the facts that the header prints and that `explain` reports."""
from __future__ import annotations

from typing import Any

from s2sad.program import Request
from s2sad.tree import Name, walk
from s2sad.units import Derived


def facts(derived: Derived, request: Request) -> dict[str, Any]:
    """The facts of one derivative, for the wrapper and for reports."""
    active = derived.activity.active
    return {"independent": tuple(w for w in request.wrt if w not in active), "derived": derived}


def recorded_lines(derived: Derived) -> list[str]:
    """One line for every stack, or one that says that there is none."""
    tape = derived.made.tape
    kept = {n for n in _names(derived)}
    stacks = [s for s in tape.stacks.values() if s.array in kept] if tape else []
    if not stacks:
        return ["It records nothing."]
    return ["It records:"] + [f"    {s.array}" for s in stacks]


def _names(derived: Derived) -> set[str]:
    return {n.id for n in walk(derived.function.body) if isinstance(n, Name)}
