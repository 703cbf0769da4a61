"""shadows: the shadow of each name in an adjoint, and where it is initialized.

    for i in range(n):                   for i in range(n - 1, -1, -1):
        t = x[i] * x[i]          ->          t_bar = 0.0
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.analyze.callee_derivatives import CalleeDerivative, is_kernel_call
from s2sad.analyze.reallocated_arrays import outlives_loop, allocation_loops
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.request import DerivativeRequest
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import Shapes
from s2sad.naming import Names
from s2sad.tree import AST, Assign, AugAssign, Call, Name, Return, assign, call, const, copy, name, walk


class Shadows:
    """The shadows of one function's active names."""
    structure: ProgramStructure
    typing: Typing
    active: frozenset[str]
    request: DerivativeRequest
    free: Names
    shapes: Shapes
    parameters: list[str]
    written: set[str]
    shadows: dict[str, str]
    scopes: dict[int, list[str]]
    own: set[str]

    def shadow(self, primal: str) -> str:
        if primal not in self.shadows:
            self.shadows[primal] = self.typing.declare(self.free.fresh(f"{primal}_bar"), self.typing.table[primal])
            self.shapes.note_same_shape(self.shadows[primal], primal)
        return self.shadows[primal]

    def private_shadows(self) -> list[tuple[str, str]]:
        """Private shadows for arrays that are inputs of the request, but whose final content is no output."""
        added: list[tuple[str, str]] = []
        for parameter in self.parameters:
            if (self.typing.table[parameter].is_array and parameter in self.request.wrt
                    and parameter not in self.request.of and parameter in self.written and parameter in self.active):
                public = self.shadows[parameter]
                own = self.typing.declare(self.free.fresh(f"{parameter}_shadow"), self.typing.table[parameter])
                self.shadows[parameter] = own
                added.append((public, own))
        self.own = {own for _, own in added}
        return added

    def find_scopes(self) -> None:
        """For every active name the innermost block around all of its uses."""
        outermost = (id(self.structure.function.body),)
        chains: dict[str, list[tuple[int, ...]]] = {p: [outermost] for p in self.parameters if p in self.active}
        for place in self.structure.places.values():
            statement = place.statement
            if isinstance(statement, (Assign, AugAssign, Return)) or is_kernel_call(statement):
                for part in walk(statement):
                    if isinstance(part, Name) and part.id in self.active:
                        chains.setdefault(part.id, []).append(place.blocks)
        for used, found in chains.items():
            if outlives_loop(self.structure, used):           # what the last array is used for lies outside
                found.append(self.structure.place(allocation_loops(self.structure, used)[0]).blocks)
            common = [b for level, b in enumerate(found[0])
                      if all(len(c) > level and c[level] == b for c in found[1:])]
            self.scopes.setdefault(common[-1], []).append(used)

    def zeros(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for used in self.scopes.get(id(block), []):
            kind = self.typing.table[used]
            if self.request.accumulates and used in self.request.wrt:
                continue
            if kind.is_number and kind.is_inexact:
                made.append(assign(self.shadow(used), const(0.0)))
            elif kind.is_array and (used not in self.parameters or used not in (*self.request.wrt, *self.request.of)
                                    or self.shadow(used) in self.own):
                made.append(assign(self.shadow(used), call("numpy.zeros_like", name(used))))
        return made


def with_shadows(called: Call, callee: CalleeDerivative, shadow: Callable[[AST], AST]) -> list[AST]:
    """The arguments of a call of a derivative: those of the kernel's call, those that have one each with its shadow."""
    args: list[AST] = []
    for position, argument in enumerate(called.args):
        args.append(copy(argument))
        if position in callee.shadows:
            args.append(shadow(argument))
    return args
