"""listing: a kernel and its derivative line by line, which line comes of which, and what is done with each.

Requires what the pipeline made and the findings; establishes, for every function of the generated file, the lines of
the user's functions that it comes of, its own lines, and the number of the statement (`link`) that both belong to.
A line of the kernel is active (it has an adjoint) or inactive, and may besides be recorded, recomputed, skipped (by the
forward sweep) and a kink; one of a docstring is words. A line of the derivative is of the forward or the reverse sweep,
and a record, a restore, a recomputation, an adjoint or of the primal.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from s2sad.liveness import base_name, targets
from s2sad.analyze.to_be_recorded import has_adjoint
from s2sad.differentiate.adjoint import REVERSE
from s2sad.emit.module import FunctionLines
from s2sad.program import Generated, Kernel, Program
from s2sad.report.findings import Findings, FoundPlace, RecordedValue
from s2sad.run.memory import byte_text
from s2sad.tree import (
    AST, Assign, AugAssign, Constant, Expr, For, FunctionDef, If, Return, While, is_comment, names, stmt, walk,
)
from s2sad.units import UnitDerivative, Unit, Units

_SIMPLE = (Assign, AugAssign, Expr, Return)


@dataclass(frozen=True)
class SourceLine:
    """A line of the user's; `link` is the statement's number, 0 for none; `notes` say what is done with it."""
    number: int
    text: str
    link: int = 0
    marks: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    badge: str = ""


@dataclass(frozen=True)
class Line:
    """A line of the generated file: `kind` is "primal", "record", "restore", "recompute", "adjoint", "comment" or "";
    `sweep` is "forward", "reverse" or ""."""
    number: int
    text: str
    link: int = 0
    kind: str = ""
    sweep: str = ""


@dataclass(frozen=True)
class Section:
    """A function of the user's."""
    name: str
    path: str
    lines: tuple[SourceLine, ...]


@dataclass(frozen=True)
class Listing:
    """A function of the generated file beside the functions that it comes of; `links` has the number of the statement
    at each line of the sources, by path and line."""
    name: str
    kernel: str
    sections: tuple[Section, ...]
    lines: tuple[Line, ...]
    active: tuple[str, ...]
    links: Mapping[tuple[str, int], int] = field(default_factory=dict)

    def link(self, place: FoundPlace, path: str) -> int:
        return self.links.get((place.path or path, place.line), 0)


def listings(program: Program, made: Generated, found: Mapping[str, Findings]) -> tuple[Listing, ...]:
    """The listings of a module's functions, the entry's first; `found` has the findings of the derivatives."""
    units: Units = made.facts["units"]
    derived = {d.function.name: d for d in units.derived.values()}
    text = made.text.splitlines()
    statements = _Statements([*program.kernels.values(), *(u.kernel for u in units.made.values())])
    listed = []
    for function in made.facts["functions"]:
        d = derived.get(function.name.removesuffix("_taped")) or derived.get(function.name)
        unit = d.unit if d is not None else units.titled.get(function.name)
        if unit is not None:
            listed.append(_Listing(statements, unit, d, function, text, found.get(function.name)).made())
    listed.sort(key=lambda each: (each.name != made.entry, each.name not in found))
    return tuple(listed)


class _Statements:
    """Which statement a line of a source belongs to: of a loop or branch its head alone."""

    def __init__(self, kernels: list[Kernel]):
        self.kernels = list({(k.source.path, k.tree.lineno): k for k in kernels}.values())
        self.heads: dict[tuple[str, int], int] = {}
        self.simple: set[tuple[str, int]] = set()
        self.texts: set[tuple[str, int]] = set()
        for kernel in self.kernels:
            for statement in walk(kernel.tree.body):
                if not isinstance(statement, stmt) or not getattr(statement, "lineno", None):
                    continue
                source, first = kernel.source.home(statement.lineno)
                lines = [(source.path, line) for line in range(first, first + _height(statement))]
                if _is_text(statement):
                    self.texts.update(lines)
                    continue
                self.simple |= {lines[0]} if isinstance(statement, _SIMPLE) else set()
                for line in lines:
                    self.heads.setdefault(line, first)

    def head(self, unit: Unit, statement: AST | None) -> tuple[str, int] | None:
        """The path and first line of the user's statement that a statement comes of."""
        if statement is None or getattr(statement, "lineno", None) is None:
            return None
        source, line = unit.kernel.source.home(statement.lineno)
        return source.path, self.heads.get((source.path, line), line)

    def around(self, path: str, line: int) -> Kernel | None:
        inside = [k for k in self.kernels if k.source.path == path and k.tree.lineno <= line <= _end(k.tree)]
        return max(inside, key=lambda k: k.tree.lineno, default=None)


def _end(tree: FunctionDef) -> int:
    return getattr(tree, "end_lineno", None) or tree.lineno


def _is_text(statement: AST) -> bool:
    """Whether a statement is a docstring or a comment."""
    return isinstance(statement, Expr) and isinstance(statement.value, Constant)


def _height(statement: AST) -> int:
    """The lines of a statement, of a loop or branch those of its head."""
    last = statement.iter if isinstance(statement, For) else (
        statement.test if isinstance(statement, (If, While)) else statement)
    end = statement.lineno if isinstance(statement, FunctionDef) else getattr(last, "end_lineno", None) or 0
    return max(1, end - statement.lineno + 1)


class _Listing:
    """The making of one listing."""

    def __init__(self, statements: _Statements, unit: Unit, derived: UnitDerivative | None, function: FunctionLines,
                 text: list[str], found: Findings | None):
        self.statements, self.unit, self.derived, self.function = statements, unit, derived, function
        self.text, self.found = text, found
        self.numbers: dict[tuple[str, int], int] = {}

    def made(self) -> Listing:
        lines = tuple(self.lines())
        own = self.unit.kernel
        kernels = {own.source.path: {own.tree.lineno: own}}
        for path, line in list(self.numbers):
            kernel = self.statements.around(path, line)
            if kernel is not None:
                kernels.setdefault(path, {}).setdefault(kernel.tree.lineno, kernel)
        sections = tuple(self.section(k) for by_line in kernels.values() for _, k in sorted(
            by_line.items(), key=lambda pair: (pair[1] is not own, pair[0])))
        links = {(s.path, line.number): line.link for s in sections for line in s.lines if line.link}
        active = tuple(v.variable for v in self.found.variables if v.active) if self.found else ()
        return Listing(self.function.name, own.name, sections, lines, active, links)

    def number(self, head: tuple[str, int] | None) -> int:
        return 0 if head is None else self.numbers.setdefault(head, len(self.numbers) + 1)

    # -- the derivative ---------------------------------------------------------------------------------------------

    def lines(self) -> Iterator[Line]:
        first, kinds = self.function.first, _Kinds(self.function, self.derived)
        sweep = ""
        for k, statement in enumerate(self.function.statements):
            if statement is not None and is_comment(statement) and self.derived is not None:
                said = str(statement.value.value)
                sweep = "reverse" if said == REVERSE else "forward" if said.startswith("forward sweep") else sweep
            yield Line(first + k + 1, self.text[first + k], self.number(self.statements.head(self.unit, statement)),
                       kinds.kind(statement, sweep), sweep)

    # -- the sources ------------------------------------------------------------------------------------------------

    def section(self, kernel: Kernel) -> Section:
        source, first, last = kernel.source, kernel.tree.lineno, _end(kernel.tree)
        marks, notes, badges = self.marks(), self.notes(), self.badges()
        lines = []
        for number in range(first, last + 1):
            head = self.statements.heads.get((source.path, number))
            key = (source.path, number if head is None else head)
            link = 0 if head is None else self.number(key)
            here = marks.get(key, {}) if link else {"words": None} if key in self.statements.texts else {}
            lines.append(SourceLine(number, source.line(number), link, tuple(here), tuple(notes.get(key, {})),
                                    badges.get(key, "") if key[1] == number else ""))
        return Section(kernel.name, source.path, tuple(lines))

    def key(self, place: FoundPlace) -> tuple[str, int]:
        path = place.path or self.unit.kernel.source.path
        return path, self.statements.heads.get((path, place.line), place.line)

    def marks(self) -> dict[tuple[str, int], dict[str, None]]:
        """What is done with each statement; the values are empty, the keys keep their order."""
        marks: dict[tuple[str, int], dict[str, None]] = {}
        if self.derived is None or self.found is None:
            return marks
        activity: dict[tuple[str, int], bool] = {}
        for statement in walk(self.unit.function.body):
            head = self.statements.head(self.unit, statement) if isinstance(statement, _SIMPLE) else None
            if head in self.statements.simple:
                active = has_adjoint(statement, self.unit.typing, self.derived.activity.active)
                activity[head] = activity.get(head, False) or active
        for head, active in activity.items():
            marks.setdefault(head, {})["active" if active else "inactive"] = None
        found = self.found
        said = [("recorded", [s.place for s in found.recorded]),
                ("recomputed", [*(a.place for a in found.again), *found.reversed_again]),
                ("skipped", list(found.dropped)), ("kink", [k.place for k in found.kinks])]
        for mark, places in said:
            for place in places:
                marks.setdefault(self.key(place), {})[mark] = None
        return marks

    def badges(self) -> dict[tuple[str, int], str]:
        """The bytes that are recorded at each statement."""
        stacks: dict[tuple[str, int], list[RecordedValue]] = {}
        for stacked in self.found.recorded if self.found else ():
            stacks.setdefault(self.key(stacked.place), []).append(stacked)
        badges = {}
        for key, here in stacks.items():
            known = [s.bytes for s in here if s.bytes is not None and not s.grows]
            parts = [byte_text(sum(known)) if known else "recorded" if not all(s.grows for s in here) else "",
                     "grows" if any(s.grows for s in here) else ""]
            badges[key] = " + ".join(filter(None, parts))
        return badges

    def notes(self) -> dict[tuple[str, int], dict[str, None]]:
        notes: dict[tuple[str, int], dict[str, None]] = {}

        def note(place: FoundPlace, words: str) -> None:
            notes.setdefault(self.key(place), {})[words] = None
        found = self.found
        if found is None:
            return notes
        for stacked in found.recorded:
            note(stacked.place, f"records {stacked.name}: {stacked.size}")
            for place in stacked.needed_by:
                note(place, f"needs {stacked.name}, what was recorded at line {stacked.place.line}")
        for kink in found.kinks:
            note(kink.place, f"not differentiable: {kink.what}")
        for again in found.again:
            note(again.place, f"{again.variable} is {again.how} in the reverse sweep")
        for places, words in ((found.dropped, "left out of the forward sweep"),
                              (found.reversed_again, "run in the reverse sweep only"),
                              (found.loops, "run forward and back per iteration"),
                              (found.interpreted, "run by the interpreter, which Numba's code calls")):
            for place in places:
                note(place, words)
        return notes


class _Kinds:
    """What the statements of a derivative are, by what flows into them: an adjoint reads or binds what comes of a
    shadow, a record binds a stack, a restore reads one."""

    def __init__(self, function: FunctionLines, derived: UnitDerivative | None):
        self.derived = derived
        self.stacks: set[str] = set()
        self.adjoints: set[str] = set()
        if derived is None:
            return
        tape = derived.made.tape
        if tape is not None:
            made = {n for s in tape.stacks.values() for n in (s.array, s.top) if n}
            self.stacks = made | {w for n in made if (w := tape.free.hints.get(n))}
        self.adjoints = {n for n, role, _ in derived.made.parameters if role != "primal"}
        self.adjoints |= {s for s in derived.made.shadows.values()}
        flows = [({*names(s)}, {b for t in targets(s) if (b := base_name(t))}) for s in dict.fromkeys(
            function.statements) if isinstance(s, (Assign, AugAssign))]
        size = -1
        while size != len(self.adjoints):
            size = len(self.adjoints)
            for used, bound in flows:
                self.adjoints |= bound if self.adjoints & used else set()

    def kind(self, statement: AST | None, sweep: str) -> str:
        if statement is None or isinstance(statement, (FunctionDef, For, If, While)):
            return ""
        if _is_text(statement):
            return "comment"
        if self.derived is None:
            return "primal"
        used = set(names(statement))
        bound = {base_name(t) for t in targets(statement)} if isinstance(statement, (Assign, AugAssign)) else set()
        if bound & self.stacks:
            return "record"
        if (used | bound) & self.adjoints or isinstance(statement, Return):
            return "adjoint"
        if used & self.stacks:
            return "restore"
        return "recompute" if sweep == "reverse" else "primal"
