"""The nouns that the rooms hand to each other: a kernel, a program, a request, and what was generated."""
from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span
from s2sad.infer.types import Type
from s2sad.live_objects.guards import Guards
from s2sad.live_objects.registry import RegisteredDerivative

if TYPE_CHECKING:
    from s2sad.tree import FunctionDef

T = TypeVar("T")
_LONG = 200             # lines
MISFIT = " does not have the shape of the result"      # what a generated file says of a seed, after its name


@dataclass(frozen=True)
class NestedDerivative:
    """A derivative that a kernel calls: in the tree of the kernel that stands for it, a call of the function that is
    differentiated, and what its own results are like. By position among that one's parameters are what it is with
    respect to and of (-1: what is returned); `with_value`: what is returned comes first; `seeded`: seeds are its
    last parameters, as directions are of a tangent, else they are 1; a `matrix` is made of all unit ones. `made` names
    the kernel for each set of types that it is made for already, `standing` is the tree that stands for it."""
    mode: str
    wrt: tuple[int, ...]
    of: tuple[int, ...]
    with_value: bool = False
    seeded: bool = False
    matrix: bool = False
    made: tuple[tuple[tuple[Type, ...], str], ...] = ()
    standing: FunctionDef | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Kernel:
    """One user's function as read: its name in the program, its tree with resolved names, its source.

    `parameters` in order; `defaults` by name (Python values); `annotations` by name (their text); `own` is the
    derivative that the user gave it, `residual` the kernel that it makes zero, if it is an implicit function;
    `results` says how many of its last parameters take what the user's function returns; `nested` says which derivative
    of the one kernel that it calls it stands for; `unsure` are the names that may be read before they are bound, where
    that is known. Of an entry, `floats` are the parameters that may be floats by its text, `independents` those that a
    gradient is with respect to by default, `rest` what takes any further arguments, as it is written.
    """
    name: str
    tree: FunctionDef
    source: Source
    parameters: tuple[str, ...]
    defaults: dict[str, Any] = field(default_factory=dict)
    annotations: dict[str, str] = field(default_factory=dict)
    own: RegisteredDerivative | None = None
    residual: str = ""
    results: int = 0
    floats: tuple[str, ...] = ()
    independents: tuple[str, ...] = ()
    nested: NestedDerivative | None = None
    unsure: frozenset[str] | None = None
    rest: tuple[str, ...] = ()


@dataclass(frozen=True)
class Evaluation:
    """What the evaluator has computed away: the parts of arguments' structures by the parameters that they became, the
    loops that are written out, with their rounds, and the facts about arguments that the program is made for."""
    parameters: dict[str, str]
    unrolled: tuple[tuple[SourcePlace, int], ...]
    facts: tuple[tuple[Fact, Any], ...]


@dataclass(frozen=True)
class Program:
    """A kernel and every kernel that it calls, by name, callees before callers; `entry` is the last one's name.

    `constants` holds the numbers that kernels read from their module or closure, by the name behind
    `const.`; `arrays` the arrays read likewise, which become hidden parameters of every kernel on the way; `records`
    the classes that kernels make structures with, by the name behind `record.`; `guards` what was taken from outside to
    read it, `warned` the warnings; `refused` says why only the evaluator can tell what the program is, once it is known
    what `function` is given, `evaluated` so for some types of arguments; `evaluation` is what the evaluator has
    computed away; `files` are the paths of the files that were read, where no live function was.
    """
    entry: str
    kernels: dict[str, Kernel]
    constants: dict[str, Any] = field(default_factory=dict)
    arrays: dict[str, Any] = field(default_factory=dict)
    records: dict[str, type] = field(default_factory=dict)
    files: tuple[str, ...] = ()
    guards: Guards = field(default_factory=Guards, compare=False, repr=False)
    warned: tuple[str, ...] = ()
    refused: S2sadError | None = field(default=None, compare=False, repr=False)
    function: Any = field(default=None, compare=False, repr=False)
    replaced: frozenset[str] = field(default=frozenset(), compare=False, repr=False)    # parameters that objects lose
    changed_outside: frozenset[str] = field(default=frozenset(), compare=False, repr=False)     # objects of a bound one
    evaluated: dict[tuple[Type, ...], S2sadError] = field(default_factory=dict, compare=False, repr=False)
    evaluation: Evaluation | None = field(default=None, compare=False, repr=False)
    _tables: dict[Any, tuple[int, Any]] = field(default_factory=dict, init=False, compare=False, repr=False)

    def once(self, make: Callable[[Program], T]) -> T:
        """The table that `make` makes of all kernels, made once; where kernels have been added, once more."""
        found = self._tables.get(make)
        if found is None or found[0] != len(self.kernels):
            found = self._tables[make] = len(self.kernels), make(self)
        return found[1]

    @property
    def is_long(self) -> bool:
        """Whether its derivative may be nested deeper than Python's stack, which `deep_stack` asks."""
        return sum(map(_lines, self.kernels.values())) > _LONG


@dataclass(frozen=True)
class FlatProgram:
    """A program of arrays and numbers, made for arguments of some forms; `paths` has, for each of the entry's
    parameters, what a user calls it, `cells` the parameters that are arrays of one element, `result` what structure is
    returned, `changed` the paths of structures that are changed otherwise, `mutated` of those that are at any time,
    `live` what is taken from outside, by id, `normal` its normal form, where it was made."""
    program: Program
    paths: dict[str, str]
    cells: frozenset[str]
    result: Any = None
    changed: frozenset[str] = frozenset()
    mutated: frozenset[str] = frozenset()
    live: frozenset[int] = frozenset()
    normal: Mapping[Any, Any] = field(default_factory=dict)


def _lines(kernel: Kernel) -> int:
    """How many lines of its source a kernel takes."""
    first, last = kernel.tree.lineno, kernel.tree.end_lineno
    return 0 if first is None or last is None else last - first + 1


@dataclass(frozen=True)
class EntrySummary:
    """What an entry writes and returns: names of parameters, types of results, results that are written arguments;
    whether it holds guards that arrays have one shape, which parameters must be contiguous, and which objects from
    outside hold something else in the end."""
    written: tuple[str, ...]
    results: tuple[Type, ...]
    returned: dict[int, str]
    guarded: bool = False
    contiguous: tuple[str, ...] = ()
    changed_outside: tuple[str, ...] = ()


Fact = tuple[str, str]      # a path of an argument, and what of it: "value", "shape", "is PATH"


class DemandedFacts(Exception):
    """Facts about arguments without which a program cannot be evaluated; `error` is what is said without them."""

    def __init__(self, facts: frozenset[Fact], error: S2sadError):
        super().__init__(str(error))
        self.facts, self.error = facts, error


class UnmadeDerivative(Exception):
    """A kernel that stands for a derivative is called with arguments of these types, and is to be made first."""

    def __init__(self, kernel: str, types: tuple[Type, ...]):
        super().__init__(kernel)
        self.kernel, self.types = kernel, types


def for_types(kernel: Kernel, types: tuple[Type, ...]) -> str:
    """The kernel that is called with arguments of these types: one that stands for a derivative is made for each set.
    Raises where it is to be made first."""
    nested = kernel.nested
    if nested is None:
        return kernel.name
    found = dict(nested.made).get(types)
    if found is not None:
        return found
    if any(t.kind == "unknown" for t in types):
        raise S2sadError(Diagnostic("S203", f"the derivative '{kernel.name}' is called with ("
                                    f"{', '.join(map(str, types))})", help="call it with arguments of known types"))
    raise UnmadeDerivative(kernel.name, types)


Table = tuple[tuple[int, int], ...]
NOTHING = (-1, -1)      # the entry behind the entries for a step


@dataclass(frozen=True)
class Schedule:
    """A schedule for a number of steps: how many rows it needs, whether it asks for a disk, and its entries, each a
    step and the row of the state before it."""
    title: str
    steps: int
    rows: int
    on_disk: bool
    entries: Table


@dataclass(frozen=True)
class Snapshots:
    """How many states a loop keeps in place of a tape, as `checkpoint` and `timesteps` take it.

    Args: count, how many, or a schedule object of the package checkpoint-schedules; on_disk, a folder in which files
    hold them, through memory maps: they have no name there, are no one else's, and are gone when the call is over,
    however it ends. Literature: Griewank and Walther, ACM TOMS 26, 2000; Maddison, J. Comput. Sci. 82, 2024.

    >>> Snapshots(20, on_disk="/scratch").on_disk
    '/scratch'
    """
    count: Any
    on_disk: str | os.PathLike[str] | None = None
    schedule: Schedule | None = None    # the table of one


Checkpoints = tuple[tuple[str, Snapshots], ...]     # loops as the user calls them


Economy = Literal["least", "balanced", "fastest"]
TapeDtype = Literal["float64", "float32"]


@dataclass(frozen=True)
class Recording:
    """How an adjoint has again what is overwritten: the `loops` that keep snapshots, or the bytes that a call may take
    beside its arguments, within which loops are chosen once sizes are known (`limit`, 0 for none); what counts where
    `memory` costs time; and in what floats of double precision are recorded, where that decides nothing."""
    loops: Checkpoints = ()
    limit: int = 0
    memory: Economy = "balanced"
    tape_dtype: TapeDtype = "float64"

    def keeping(self, loops: Checkpoints) -> Recording:
        """The same where these loops keep snapshots."""
        return replace(self, loops=loops, limit=0)


@dataclass(frozen=True)
class Request:
    """A derivative to be made: `mode` is "adjoint", "tangent" or "primal"; types by position.

    `wrt` and `of` are names of parameters; `of` may hold "return". `engine` is "numpy" or "numba", `level`
    "plain" or "fast". `with_primal` also returns the primal's result. `assumed` has a reason for every parameter whose
    type is an assumption; `recording` is an adjoint's. With `split` the two sweeps of the adjoint are two functions.
    With a `width` it is for that many directions at once, under NumPy for any number.
    """
    mode: str
    types: tuple[Type, ...]
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    engine: str = "numpy"
    level: str = "plain"
    with_primal: bool = False
    standalone: bool = False
    assumed: tuple[tuple[str, str], ...] = ()
    recording: Recording = Recording()
    split: bool = False
    width: int = 0


@dataclass(frozen=True)
class Parameter:
    """A parameter of a generated function: `role` is "primal", "shadow" (of `primal`), "seed" or "tape"."""
    name: str
    role: str
    primal: str
    type: Type


@dataclass(frozen=True)
class SourcePlace:
    """A place in the kernel's source that needs no source: the path, the line with its number, and columns in it."""
    path: str
    line: int
    column: int
    end_column: int
    text: str

    @classmethod
    def of(cls, source: Source, node: Any) -> SourcePlace:
        """The place of a node, which has one."""
        span = Span.of(source, node)
        text = span.source.line(span.line)
        end = span.end_column if span.end_line == span.line else len(text)
        return cls(span.source.path, span.line, span.column, end, text)

    def span(self) -> Span:
        """The place for a diagnostic."""
        return Span(Source(self.path, self.text, self.line), self.line, self.column, self.line, self.end_column)


@dataclass(frozen=True)
class TextGuard:
    """An assertion of a generated text that a sweep made: its message, what to do, where its statement
    is in the kernel, and what it compares, as the text has it; `seed` is the seed that it is about, "" for none."""
    message: str
    help: str
    place: SourcePlace | None
    compared: tuple[str, ...] = ()
    seed: str = ""


@dataclass(frozen=True)
class RecordedArray:
    """An array of a generated module that holds a "tape" or "snapshots" (`kind`): the function and its name there, the
    derivative of which that is a part, the place of the loop whose steps fill it and what a user calls that loop (None
    and "" outside of loops)."""
    function: str
    name: str
    kind: str
    derivative: str
    place: SourcePlace | None = None
    loop: str = ""


@dataclass(frozen=True)
class SnapshotLoop:
    """A loop that keeps `snapshots`: the function of a generated module that runs it, what a user calls it, its place,
    the name that holds the number of steps, whether that is known before the first one, and whether the adjoint of a
    step runs a part of it again."""
    function: str
    loop: str
    place: SourcePlace | None
    snapshots: Snapshots
    steps: str
    is_counted: bool
    runs_in_adjoint: bool = True


@dataclass(frozen=True)
class IndexLimit:
    """An affine form of the arguments of a call: each term has a parameter's name, what of it counts (None for an
    integer, the size of an axis, the "least" or the "greatest" element of an array), and a factor."""
    terms: tuple[tuple[str, int | str | None, int], ...]
    constant: int


@dataclass(frozen=True)
class Generated:
    """A generated module: its text, the entry function's name and signature, and what is to be reported.

    `returns` names what the function returns, in order: the parameters whose adjoints come back (adjoint),
    preceded by "result" with `with_primal`; for a tangent the results' tangents.
    """
    text: str
    entry: str
    parameters: tuple[Parameter, ...]
    returns: tuple[str, ...]
    facts: dict[str, Any] = field(default_factory=dict)
