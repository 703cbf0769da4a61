"""passes: what a pass is, what the passes of a function share, and the loop that runs them.

A room opens with its passes in order, and that tuple is what runs:

    PASSES = (Pass(overflow), Pass(lu, when=in_loops), Repeat((Pass(split), Pass(widen))), Pass(anf, form="atoms"))

    tree = run(PASSES, tree, context)

After each pass what it found wrong is raised, the normal form is verified where one is named, and `context.watch` is
shown the tree under the pass's name: `s2sad stages` prints what it sees.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from s2sad.diagnostics import Report, S2sadError
from s2sad.form import verify
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.program import Kernel, Program, Snapshots
from s2sad.tree import Call, FunctionDef

C = TypeVar("C", bound="Context")
Watch = Callable[[str, FunctionDef], object]


def unwatched(stage: str, function: FunctionDef) -> None:
    """What is shown the stages where nobody looks."""


class Callees(Protocol):
    """The functions that calls call, each made when it is first called for; `checkpoints` are the places of loops that
    keep snapshots, with how many, `outlined_at` the places of loops that were looked at."""
    checkpoints: Mapping[tuple[str, int, int], Snapshots]
    outlined_at: set[tuple[str, int, int]]

    def unit(self, kernel: str, types: tuple[Type, ...], pairs: tuple[tuple[int, int], ...] = ()) -> Any: ...
    def of_call(self, called: Call, typing: Typing) -> Any: ...
    def call_types(self, kernel: str, types: tuple[Type, ...]) -> tuple[Type, ...]: ...
    def call_writes(self, node: Call) -> list[str]: ...
    def written_in(self, tree: FunctionDef) -> set[str]: ...
    def runs_once(self, node: Call) -> bool: ...
    def has_state(self, node: Call) -> bool: ...
    def outlined(self, kernel: Kernel, context: Any, loop: Any, marks: list[Any]) -> str: ...


@dataclass(kw_only=True)
class Context:
    """What the passes of one function share; what a pass finds out for later ones lies in the context of its room."""
    program: Program
    kernel: Kernel
    names: Names
    engine: str = "numpy"
    watch: Watch = unwatched
    report: Report = field(init=False)
    typing: Typing = field(init=False)      # once types are known

    def __post_init__(self) -> None:
        self.report = Report(self.kernel.source)

    @property
    def in_loops(self) -> bool:
        """Whether whole-array statements become loops."""
        return self.engine == "numba"

    def fork(self: C) -> C:
        """A copy for passes whose findings and names may be dropped: it shares facts, but neither."""
        made = copy(self)
        made.names, made.report = self.names.copy(), Report(self.report.source)
        made.typing = self.typing.copy(made.report, self.typing.final)
        return made

    def begin(self, tree: FunctionDef) -> None:
        """Called before each pass, with its argument."""


@dataclass(frozen=True)
class Pass:
    """A transformation or a check: `function(tree, context)` gives the tree, None if it only looks; `name` is that of
    its stage. `when` says for which context it runs, `form` the normal form that holds after it."""
    function: Callable[[FunctionDef, Any], FunctionDef | None]
    name: str = ""
    when: Callable[[Any], bool] | None = None
    form: str = ""

    @property
    def title(self) -> str:
        return self.name or self.function.__name__


@dataclass(frozen=True)
class Repeat:
    """Passes that run again, from the first on, whenever one after the `again`th has changed the tree."""
    passes: tuple[Pass, ...]
    again: int


@dataclass(frozen=True)
class Alternative:
    """Passes; where they are refused with the verdict, each of the `changes` in turn changes the tree before them, and
    if it does, the passes run on that. What is refused after all of them is the refusal of the tree before."""
    passes: tuple[Pass, ...]
    verdict: Callable[[Any], bool]
    changes: tuple[tuple[Pass, ...], ...]


Passes = tuple[Pass | Repeat | Alternative, ...]


def run(passes: Passes, tree: FunctionDef, context: Context) -> FunctionDef:
    """The tree after all passes that run in this context."""
    for item in passes:
        if isinstance(item, Repeat):
            tree = _repeated(item, tree, context)
        elif isinstance(item, Alternative):
            tree = _either(item, tree, context)
        elif item.when is None or item.when(context):
            tree = _one(item, tree, context)
    return tree


def _one(step: Pass, tree: FunctionDef, context: Context) -> FunctionDef:
    context.begin(tree)
    made = step.function(tree, context)
    context.report.finish()
    made = tree if made is None else made
    if step.form:
        verify(made, step.form, step.title)
    context.watch(step.title, made)
    return made


def _repeated(item: Repeat, tree: FunctionDef, context: Context) -> FunctionDef:
    while True:
        for number, step in enumerate(item.passes):
            if step.when is not None and not step.when(context):
                continue
            made = _one(step, tree, context)
            changed, tree = made is not tree, made
            if changed and number >= item.again:
                break
        else:
            return tree


def _either(item: Alternative, tree: FunctionDef, context: Context) -> FunctionDef:
    before = context.fork()
    try:
        return run(item.passes, tree, context)
    except S2sadError:
        if not item.verdict(context):
            raise
        for change in item.changes:
            vars(context).update(vars(before))
            changed = run(change, tree, context)
            before = context.fork()
            if changed is tree:
                continue
            tree = changed
            try:
                return run(item.passes, tree, context)
            except S2sadError:
                pass
        raise


def each(passes: Passes) -> Iterator[Pass]:
    """The passes one by one."""
    for item in passes:
        if isinstance(item, Alternative):
            yield from (step for change in item.changes for step in change)
        yield from (item,) if isinstance(item, Pass) else item.passes
