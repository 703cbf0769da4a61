"""program_structure: where every statement of a function stands.

Requires normal form; establishes an order, the loops and branches around each statement, its block, and in that block
its segment: a run of statements on numbers and elements, or one statement of another kind (a loop, a call that writes,
a whole-array statement, an allocation).
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from s2sad import rules
from s2sad.analyze.context import AnalysisContext
from s2sad.liveness import base_name, targets
from s2sad.infer.inference import Typing
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Call, Compare, Constant, Eq, Expr, For, FunctionDef, If, Name, Subscript,
    While, call_name, walk,
)


@dataclass(frozen=True)
class StatementPlace:
    """Where a statement stands: `order` in the text, `loops` and `branches` (If, whether in its body) around it,
    outermost first; `block` and `segment` of it (for a statement in a branch of a segment: the segment's); `inside`,
    the loops and branches around it; `blocks`, all blocks around it, outermost first."""
    statement: AST
    order: int
    loops: tuple[AST, ...]
    branches: tuple[tuple[AST, bool], ...]
    block: int
    segment: int
    inside: tuple[AST, ...] = ()
    blocks: tuple[int, ...] = ()


@dataclass
class ProgramStructure:
    """The table: places by `id(statement)`, bindings of numbers by name, blocks with their segments; what stands in a
    loop by `id(loop)`."""
    function: FunctionDef
    typing: Typing
    places: dict[int, StatementPlace] = field(default_factory=dict)
    bindings: dict[str, list[AST]] = field(default_factory=dict)
    loop_of: dict[str, AST] = field(default_factory=dict)
    blocks: dict[int, list[list[AST]]] = field(default_factory=dict)
    inner: dict[int, list[StatementPlace]] = field(default_factory=dict)
    lengths: dict[tuple[str, int], int] = field(default_factory=dict)   # of axes, where an assertion says them
    simple: dict[int, bool] = field(default_factory=dict)       # asked for each value by all branches around it

    def is_simple(self, statement: AST) -> bool:
        """Whether a statement of the function is simple (see below)."""
        found = self.simple.get(id(statement))
        if found is None:
            found = self.simple[id(statement)] = is_simple(statement, self.typing, self.is_simple)
        return found

    def place(self, statement: AST) -> StatementPlace:
        return self.places[id(statement)]

    def before(self, a: AST, b: AST) -> bool:
        return self.place(a).order < self.place(b).order


def program_structure(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the table in `context.structure`."""
    context.structure = structure_of(function, context.typing)


def structure_of(function: FunctionDef, typing: Typing) -> ProgramStructure:
    """The table of a function."""
    table = ProgramStructure(function, typing)
    _Walk(table).block(function.body, Enclosing(), None)
    return table


def segments(block: list[AST], is_simple: Callable[[AST], bool]) -> list[list[AST]]:
    """The block cut into runs of simple statements and single compound ones."""
    cut: list[list[AST]] = []
    simple = False
    for statement in block:
        now = is_simple(statement)
        if now and simple:
            cut[-1].append(statement)
        else:
            cut.append([statement])
        simple = now
    return cut


def is_simple(statement: AST, typing: Typing, known: Callable[[AST], bool] | None = None) -> bool:
    """Whether a statement deals with numbers and elements only, so that it can be run again cheaply; `known` says so of
    the statements in a branch."""
    if isinstance(statement, If):
        return all(known(s) if known else is_simple(s, typing) for s in [*statement.body, *statement.orelse])
    if isinstance(statement, (For, While, Expr)) or is_allocation(statement):
        return isinstance(statement, Expr) and not isinstance(statement.value, Call)
    if isinstance(statement, (Assign, AugAssign)):
        if any(typing.of(t).is_array for t in targets(statement)):
            return False
        return not any(reads_whole(n, typing) for n in walk(statement.value))
    return True


def reads_whole(node: AST, typing: Typing) -> bool:
    """Whether a call reads whole arrays (and may write them), or is not to be run again."""
    function = call_name(node)
    if rules.find_array(function) is not None:
        return True
    return bool(function) and function.startswith("user.") and (
        any(typing.of(a).is_array for a in node.args) or typing.runs_once(node))


def heads(statement: AST) -> list[AST]:
    """The expressions of a statement itself, without its blocks."""
    if isinstance(statement, (If, While)):
        return [statement.test]
    if isinstance(statement, For):
        return [statement.iter]
    return [statement]


@dataclass(frozen=True)
class Enclosing:
    """What is around a block."""
    loops: tuple[AST, ...] = ()
    branches: tuple[tuple[AST, bool], ...] = ()
    inside: tuple[AST, ...] = ()
    blocks: tuple[int, ...] = ()


class _Walk:
    def __init__(self, table: ProgramStructure):
        self.table = table
        self.order = 0

    def block(self, block: list[AST], around: Enclosing, segment: tuple[int, int] | None) -> None:
        around = replace(around, blocks=(*around.blocks, id(block)))
        if segment is not None:
            for statement in block:
                self.statement(statement, around, segment)
            return
        cut = self.table.blocks[id(block)] = segments(block, self.table.is_simple)
        for number, run in enumerate(cut):
            for statement in run:
                self.statement(statement, around, (id(block), number))

    def statement(self, statement: AST, around: Enclosing, segment: tuple[int, int]) -> None:
        self.order += 1
        place = self.table.places[id(statement)] = StatementPlace(
            statement, self.order, around.loops, around.branches, *segment, around.inside, around.blocks)
        for loop in around.loops:
            self.table.inner[id(loop)].append(place)
        for target in targets(statement):
            if isinstance(target, Name):
                self.table.bindings.setdefault(target.id, []).append(statement)
        if isinstance(statement, Assert):
            self.table.lengths.update(_asserted_length(statement.test))
        inside = (*around.inside, statement)
        if isinstance(statement, If):
            own = segment if self.table.is_simple(statement) else None
            for chosen, block in ((True, statement.body), (False, statement.orelse)):
                self.block(block, replace(around, branches=(*around.branches, (statement, chosen)), inside=inside),
                           own)
        elif isinstance(statement, (For, While)):
            self.table.inner[id(statement)] = []
            if isinstance(statement, For):
                self.table.loop_of.setdefault(statement.target.id, statement)
            self.block(statement.body, replace(around, loops=(*around.loops, statement), inside=inside), None)


def _asserted_length(test: AST) -> dict[tuple[str, int], int]:
    """The length of an axis that `x.shape[0] == 3` says."""
    if not isinstance(test, Compare) or not isinstance(test.ops[0], Eq):
        return {}
    size, length = test.left, test.comparators[0]
    asked = isinstance(size, Subscript) and isinstance(size.value, Attribute) and size.value.attr == "shape"
    if not asked or not isinstance(size.slice, Constant) or not isinstance(length, Constant):
        return {}
    return {(base_name(size.value.value), size.slice.value): length.value}


def stored_arrays(statement: AST) -> list[AST]:
    """The array places that a simple store writes."""
    return [t for t in targets(statement) if isinstance(t, Subscript)]
