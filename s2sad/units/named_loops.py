"""named_loops: the loops of a program that keep snapshots, found by what a user calls them.

    "k"             the loop over k of the function that is differentiated: for k in ..., for k, x in enumerate(...)
    "advance.k"     the one of a function that it calls
    "line 14"       the loop that begins in this line
"""
from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import Checkpoints, Kernel, Program, Snapshots, SourcePlace
from s2sad.read.marked_loops import snapshots_said
from s2sad.tree import AST, For, Name, While, walk, walk_statements

Place = tuple[str, int, int]

_TARGET = re.compile(r"for\b(.+?)\bin\b")
_NAME = re.compile(r"\b[^\W\d]\w*")


@dataclass(frozen=True)
class NamedLoop:
    """A loop of a kernel."""
    kernel: Kernel
    node: AST

    @property
    def counters(self) -> tuple[str, ...]:
        """What the loop binds for each step, by the user's names (nothing if it is a `while`)."""
        return _bound_at(self.place) or (
            tuple(n.id for n in walk(self.node.target) if isinstance(n, Name)) if isinstance(self.node, For) else ())

    @property
    def place(self) -> SourcePlace:
        return SourcePlace.of(self.kernel.source, self.node)

    def is_called(self, wanted: str, entry: str) -> bool:
        """Whether a user calls it so."""
        function, _, counter = wanted.rpartition(".")
        if wanted == f"line {self.place.line}":
            return True
        return self.kernel.name == (function or entry) and counter in self.counters

    def shown(self, entry: str) -> str:
        """What a user may call it."""
        line = f'"line {self.place.line}"'
        if not self.counters:
            return line
        return f'"{self.counters[0]}"' if self.kernel.name == entry else f'"{self.kernel.name}.{self.counters[0]}"'


def loops_that_keep(program: Program, wanted: Checkpoints) -> Mapping[Place, Snapshots]:
    """How many snapshots are kept by the loops at these places, those that are wanted and those of which the text says
    so; raises S2sadError for a name of no loop, or of several."""
    there = loops_of(program) if wanted else []
    found = dict(program.once(_said))
    for name, snapshots in wanted:
        loops = [loop for loop in there if loop.is_called(name, program.entry)]
        if len({place_of(loop) for loop in loops}) != 1:
            raise _refused(program, name, loops, there)
        found[place_of(loops[0])] = snapshots
    return found


def check_outlined(program: Program, kept: Collection[Place], there: Collection[Place]) -> None:
    """Refuses a loop of the program that is to keep snapshots and is not there any more where derivatives are made."""
    for loop in loops_of(program):
        if place_of(loop) in kept and place_of(loop) not in there:
            raise _keeps_none(loop.place)


def user_names(program: Program) -> Mapping[Place, str]:
    """What a user may call each loop."""
    there = loops_of(program)
    found: dict[Place, str] = {}
    for loop in there:
        shown = loop.shown(program.entry).strip('"')
        several = {place_of(other) for other in there if other.is_called(shown, program.entry)}
        found[place_of(loop)] = shown if len(several) == 1 else f"line {loop.place.line}"
    return found


def _said(program: Program) -> Mapping[Place, Snapshots]:
    """The loops of which the text says that they keep snapshots."""
    there = {loop.place for loop in loops_of(program)}
    sources = dict.fromkeys(k.source for k in program.kernels.values())
    return {(p.path, p.line, p.column): n for source in sources for p, n in snapshots_said(source, there)}


def place_of(loop: NamedLoop) -> Place:
    return loop.place.path, loop.place.line, loop.place.column


def loops_of(program: Program) -> list[NamedLoop]:
    """The loops of all functions of a program, those of the entry first."""
    kernels = sorted(program.kernels.values(), key=lambda k: k.name != program.entry)
    return [NamedLoop(kernel, node) for kernel in kernels for node in walk_statements(kernel.tree.body)
            if isinstance(node, (For, While)) and getattr(node, "lineno", None)]


def _bound_at(place: SourcePlace) -> tuple[str, ...]:
    """The names that the loop at a place of the user's text binds for each step."""
    head = _TARGET.match(place.text[place.column:])
    return tuple(_NAME.findall(head[1])) if head else ()


def _written_out(program: Program, name: str) -> SourcePlace | None:
    """The place of the loop of that name of the user's which the evaluator has written out."""
    unrolled = program.evaluation.unrolled if program.evaluation is not None else ()
    counter = name.rpartition(".")[2]
    return next((p for p, _ in unrolled if name == f"line {p.line}" or counter in _bound_at(p)), None)


def _keeps_none(place: SourcePlace) -> S2sadError:
    return S2sadError(Diagnostic("S408", "this loop is written out before the run, and keeps no snapshots",
                                 place.span(), help="leave it out of 'checkpoint'"))


def _refused(program: Program, name: str, loops: list[NamedLoop], there: list[NamedLoop]) -> S2sadError:
    if loops:
        lines = ", ".join(dict.fromkeys(f'"line {loop.place.line}"' for loop in loops))
        return S2sadError(Diagnostic("S408", f"checkpoint names {name!r}, and {len(loops)} loops of '{program.entry}' "
                                     "are called so", loops[0].place.span(), help=f"say which one: {lines}"))
    place = _written_out(program, name)
    if place is not None:
        return _keeps_none(place)
    shown = ", ".join(dict.fromkeys(loop.shown(program.entry) for loop in there))
    listed = f"its loops are {shown}" if shown else "it has no loops"
    return S2sadError(Diagnostic("S408", f"checkpoint names {name!r}, which is no loop of '{program.entry}'",
                                 help=listed))
