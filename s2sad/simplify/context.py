"""What the passes on a derivative share, in `simplify` and in `optimize`, and what each finds out for later ones."""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from s2sad.infer.types import Type
from s2sad.passes import Context
from s2sad.simplify.call_effects import Effects
from s2sad.tree import FunctionDef


@dataclass(frozen=True)
class InlinedFunction:
    """A finished function of numbers, with the types of its names."""
    function: FunctionDef
    types: Mapping[str, Type]


@dataclass(kw_only=True)
class DerivativeContext(Context):
    """One derivative; `types` are those of its names."""
    types: Mapping[str, Type]
    effects: Effects
    live_out: set[str]                  # the arrays whose content the caller reads
    adjoint: bool
    family: Mapping[str, str] = field(default_factory=dict)     # the names that stand for versions of a variable
    kernel_names: Mapping[str, str] = field(default_factory=dict)   # those of the kernel's own
    kept_names: Set[str] = frozenset()                                # the names that are not folded away
    shadows: Mapping[str, str] = field(default_factory=dict)    # of every shadow the primal
    has_float32: bool = False                                        # an adjoint with numbers of float32
    renamed: dict[str, str] = field(default_factory=dict)       # the names that versions have in the end
    sums: Set[str] = frozenset()        # arrays that sum in float64 what arrays of float32 gain
    stacks: Set[str] = frozenset()      # the arrays of the tape, and the numbers that say how high they are
    tops: Set[str] = frozenset()
    gaining: Set[str] = frozenset()     # the arrays that gain, and the numbers that do in any order
    numbers: Set[str] = frozenset()
    seeds: Set[str] = frozenset()       # the numbers that are given as seeds
    writing: Set[str] = frozenset()     # the functions called that write arrays
    system_math: Set[str] = frozenset()     # the functions that stay the system's,
    called_math: Mapping[str, bool] = field(default_factory=dict)   # and whether those that are called became ours
    inlined: Mapping[str, InlinedFunction] = field(default_factory=dict)    # the functions that calls are replaced by

    @staticmethod
    def parameters(function: FunctionDef) -> set[str]:
        """A function's parameters, which keep their names."""
        return {p.id for p in function.args.args}
