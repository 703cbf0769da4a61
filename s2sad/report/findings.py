"""findings: the facts of every derivative in a generated module, as a frozen table; texts only, no trees.

Requires what the pipeline made (`Units`); establishes, per function, the verdict for every variable, what is recorded
and computed again, what the forward sweep leaves out, the loops that run forward and back per iteration, and the
places where the function is not differentiable.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from s2sad.liveness import targets
from s2sad.emit.origins import text_of
from s2sad.emit.stack_report import StackEntry, recorded_by
from s2sad.report.kinks import kinks
from s2sad.run.memory import Footprint, byte_text
from s2sad.rules.transforms import TRANSFORMS
from s2sad.tree import (
    AST, AnnAssign, Assign, AugAssign, Expr, For, Name, call_name, is_comment, names, stored_names, walk,
    walk_statements,
)
from s2sad.units import UnitDerivative, Unit

_LONGEST = 90


@dataclass(frozen=True)
class FoundPlace:
    """A statement: its line and its text, and its file where that is not the kernel's."""
    line: int
    text: str
    path: str = ""


@dataclass(frozen=True)
class Verdict:
    variable: str
    type: str
    active: bool
    reason: str


@dataclass(frozen=True)
class RecordedValue:
    """A recorded value; `bytes` for concrete arguments, of one push if it `grows` and nobody knows how often, None if
    not known."""
    name: str
    what: str
    dtype: str
    place: FoundPlace
    needed_by: tuple[FoundPlace, ...]
    formula: str
    bytes: int | None
    grows: bool

    @property
    def size(self) -> str:
        """The bytes in words, and where they are known also the number."""
        if self.dtype == "any":
            return "bytes known only at run time"
        pushed = self.formula.endswith(" per push")
        each = self.formula.removesuffix(" per push")
        known = self.bytes is not None and (each != str(self.bytes) or pushed and not self.grows)
        counted = f"{byte_text(self.bytes or 0)}{', ' if pushed and not self.grows else ' = '}" if known else ""
        return f"{counted}{each} bytes" + (" per push" if pushed else "") + (
            ", the number of pushes is known only at run time" if self.grows else "")


@dataclass(frozen=True)
class RecomputedValue:
    """A value that is not recorded: `how` the reverse sweep has it again."""
    variable: str
    how: str
    place: FoundPlace


@dataclass(frozen=True)
class Kink:
    """A place where the function is not differentiable, and what is done there."""
    place: FoundPlace
    what: str


@dataclass(frozen=True)
class Findings:
    """What was found about one derivative."""
    name: str
    kernel: str
    path: str
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    variables: tuple[Verdict, ...]
    recorded: tuple[RecordedValue, ...]
    again: tuple[RecomputedValue, ...]
    dropped: tuple[FoundPlace, ...]
    reversed_again: tuple[FoundPlace, ...]
    loops: tuple[FoundPlace, ...]
    kinks: tuple[Kink, ...]
    interpreted: tuple[FoundPlace, ...] = ()
    calls: tuple[str, ...] = ()


def findings(derived: UnitDerivative, taken: Footprint | None, engine: str) -> Findings:
    """The table of one derivative; `taken` is the memory for concrete arguments, None without any."""
    unit = derived.unit
    reads = [(n, p) for n, role, p in derived.made.parameters if role != "primal"]
    names_wrt = [p for n, p in reads if p in derived.activity.active or p in derived.made.returns]
    written = {p.id for k, p in enumerate(unit.function.args.args) if k in unit.summary.written}
    of = [p for _, p in reads if p in written or p.startswith("return ")]
    dropped, later = _sweep(derived)
    return Findings(
        derived.function.name, unit.kernel.name, unit.kernel.source.path,
        tuple(dict.fromkeys([*names_wrt, *(r for r in derived.made.returns if r in unit.typing.table)])), tuple(of),
        tuple(_verdicts(derived)), tuple(_recorded(derived, taken)),
        tuple(_recomputed(derived)), dropped, later, tuple(_loops(derived)),
        tuple(Kink(place_of(s, unit), what) for s, what in kinks(unit, derived.activity)),
        tuple(dict.fromkeys(_interpreted(unit))) if engine == "numba" else (),
        tuple(dict.fromkeys(called.removeprefix("user.") for n in walk(derived.function.body)
                            if (called := call_name(n) or "").startswith("user."))))


def _interpreted(unit: Unit) -> Iterator[FoundPlace]:
    """The statements with a function that compiled code has the interpreter run."""
    for statement in walk_statements(unit.function.body):
        if isinstance(statement, (Assign, AugAssign)) and call_name(statement.value) in TRANSFORMS:
            yield place_of(statement, unit)


def place_of(statement: AST, unit: Unit) -> FoundPlace:
    """A statement's line and text."""
    source, line = unit.kernel.source.home(statement.lineno)
    return FoundPlace(line, text_of(statement, unit.kernel.source, _LONGEST),
                      "" if source is unit.kernel.source else source.path)


# -- variables ------------------------------------------------------------------------------------------------------

def _verdicts(derived: UnitDerivative) -> Iterator[Verdict]:
    """Every name of the user's function, in the order of its text."""
    unit, table = derived.unit, derived.unit.typing.table
    versions: dict[str, list[str]] = {}
    for version, variable in unit.family.items():
        versions.setdefault(variable, []).append(version)
    for version in table:
        if (variable := _variable(version, unit)) in unit.numbers.values() and version != variable:
            versions.setdefault(variable, [variable]).append(version)
    own = [*unit.kernel.parameters, *stored_names(unit.kernel.tree.body)]
    present = set(names(unit.function.body)) | set(stored_names(unit.function.body)) | set(unit.kernel.parameters)
    for variable in dict.fromkeys(own):
        found = [v for v in versions.get(variable, [variable]) if v in table]
        if not found or not present.intersection(found):
            yield _replaced(variable, derived)
            continue
        yield Verdict(variable, str(table[found[0]]), *_verdict(found, derived))


def _variable(version: str, unit: Unit) -> str:
    """The variable of the user's for which a name stands, itself or as the number in an array's place."""
    variable = unit.family.get(version, version)
    return unit.numbers.get(variable, variable)


def _replaced(variable: str, derived: UnitDerivative) -> Verdict:
    """The verdict for a name in whose place stands what it was a name for, as a view's array."""
    for statement in walk_statements(derived.unit.kernel.tree.body):
        if isinstance(statement, (Assign, For)) and variable in stored_names(statement):
            for base in names(statement.iter if isinstance(statement, For) else statement.value):
                kind = derived.unit.typing.table.get(base)
                if kind is not None and kind.is_array:
                    active, reason = _verdict([base], derived)
                    return Verdict(variable, "", active, f"{reason}, as {base}, which stands in its place")
    return Verdict(variable, "", False, "inactive: it stands for something else, which stands in its place")


def _verdict(versions: list[str], derived: UnitDerivative) -> tuple[bool, str]:
    found, table = derived.activity, derived.unit.typing.table
    if found.active.intersection(versions):
        return True, "active"
    if not any(table[v].is_inexact for v in versions):
        return False, f"inactive: {table[versions[0]].dtype or table[versions[0]].kind} has no derivative"
    if not found.varied.intersection(versions):
        return False, "inactive: it never depends on an input"
    if not found.useful.intersection(versions):
        return False, "inactive: it reaches no output"
    return False, "inactive: where it depends on an input it reaches no output"


# -- what is recorded, and what is not ------------------------------------------------------------------------------

def _recorded(derived: UnitDerivative, taken: Footprint | None) -> list[RecordedValue]:
    """The stacks, the largest first, then those that grow."""
    found = [*(_stacked(r, derived, taken) for r in recorded_by(derived)), *_saved_lists(derived)]
    return sorted(found, key=lambda s: (s.grows, -(s.bytes or 0)))


def _stacked(recorded: StackEntry, derived: UnitDerivative, taken: Footprint | None) -> RecordedValue:
    unit = derived.unit
    needed = tuple(dict.fromkeys(place_of(s, unit) for s in recorded.readers))
    stack = None if taken is None else taken.stack(derived.function.name, recorded.array)
    known = recorded.bytes_of_number if stack is None else stack.each if stack.unknown else stack.bytes
    return RecordedValue(recorded.array, recorded.what, recorded.dtype, place_of(recorded.statement, unit), needed,
                         recorded.formula, None if taken is None or known == 0 and not taken.is_complete else known,
                         recorded.grows and (stack is None or stack.unknown))


def _saved_lists(derived: UnitDerivative) -> Iterator[RecordedValue]:
    """The lists of what the first halves of a user's adjoints keep."""
    for stack, statement in derived.made.kept:
        place = place_of(statement, derived.unit)
        yield RecordedValue(stack, f"what `{place.text}` keeps", "any", place, (place,), "its own", None, True)


def _recomputed(derived: UnitDerivative) -> Iterator[RecomputedValue]:
    """The values that the reverse sweep computes again or reads back."""
    plan, unit = derived.plan, derived.unit
    if plan is None:
        return
    keys = dict.fromkeys(k for group in (*plan.early.values(), *plan.late.values()) for k in group)
    found = []
    for key in keys:
        value = plan.values[key]
        variable = _variable(value.name, unit)
        if variable not in set(stored_names(unit.kernel.tree.body)):
            continue
        stored = plan.reloaded.get(key)
        how = "computed again" if stored is None else f"read back from where `{place_of(stored, unit).text}` stored it"
        found.append(RecomputedValue(variable, how, place_of(value.bindings[0], unit)))
    yield from sorted(dict.fromkeys(found), key=lambda a: (a.place.line, a.variable))


def _sweep(derived: UnitDerivative) -> tuple[tuple[FoundPlace, ...], tuple[FoundPlace, ...]]:
    """The primal's statements that the derivative never runs, and those that it runs in the reverse sweep alone."""
    if derived.plan is None:
        return (), ()
    unit, body = derived.unit, derived.function.body
    marks = [k for k, s in enumerate(body) if is_comment(s)]
    cut = marks[-1] if marks else 0
    forward, back = set(_primal(body[:cut], derived)), set(_primal(body[cut:], derived))
    own = {(s.lineno, s.col_offset) for s in walk_statements(unit.kernel.tree.body)
           if isinstance(s, (Assign, AnnAssign, AugAssign, Expr))}
    dropped, later = [], []
    for statement in walk(unit.function.body):
        where = (getattr(statement, "lineno", 0), getattr(statement, "col_offset", 0))
        if isinstance(statement, (Assign, AugAssign, Expr)) and where in own and where not in forward:
            (later if where in back else dropped).append(place_of(statement, unit))
    return tuple(dict.fromkeys(dropped)), tuple(dict.fromkeys(later))


def _primal(block: list[AST], derived: UnitDerivative) -> Iterator[tuple[int, int]]:
    """The places of the primal's own statements in a part of its derivative: no adjoints, pushes and pops."""
    unit, tape = derived.unit, derived.made.tape
    stacks = {n for s in tape.stacks.values() for n in (s.array, s.top)} if tape else set()
    own = {*unit.typing.table, *unit.family.values(), *unit.names.hints.values()}
    others = {*derived.made.shadows.values(), *stacks}
    for statement in walk_statements(block):
        if not isinstance(statement, (Assign, AugAssign, Expr)) or getattr(statement, "lineno", None) is None:
            continue
        used = {n.id for n in walk(statement) if isinstance(n, Name)}
        bound = {n.id for t in targets(statement) for n in walk(t) if isinstance(n, Name)}
        if not used & others and bound <= own:
            yield statement.lineno, statement.col_offset


def _loops(derived: UnitDerivative) -> Iterator[FoundPlace]:
    if derived.plan is not None:
        for place in derived.structure.places.values():
            if id(place.statement) in derived.plan.rerun:
                yield place_of(place.statement, derived.unit)
