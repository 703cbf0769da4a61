"""The derivatives of one function: derived once for each request, compiled, and kept.

A `DerivativeCache` lies in the side table of its function. It has one `ProgramVersion` for each set of values of the
constants that the function reads, and a version one `Executable` for each (mode, types, wrt, of, engine).
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from types import FunctionType, MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np

from s2sad.dispatch import artifacts
from s2sad.dispatch.artifacts import ReadRecord
from s2sad.dispatch.arguments import float_parameters, types as types_of
from s2sad.run.compiler_lock import COMPILER_LOCK
from s2sad.dispatch.deferred import compiler
from s2sad.diagnostics import Diagnostic, S2sadError, WaitingForFacts
from s2sad.dispatch.checked_primal import CheckedPrimal
from s2sad.dispatch.executable import Executable, HIDDEN, ManyDirections
from s2sad.dispatch.index_check import IndexCheck
from s2sad.dispatch.limited_memory import LimitedMemory
from s2sad.dispatch.split_executable import SplitExecutable
from s2sad.live_objects.guards import Guards, Path, VaryingNumber, current, recording, same
from s2sad.infer.types import Type
from s2sad.live_objects.unwrap import by_position, python_function
from s2sad.program import EntrySummary, Program, Request
from s2sad.run.progress import Working
from s2sad.live_objects.registry import GIVEN, RegisteredRule
from s2sad.run.compiled import chosen, interpreting
from s2sad.run.overlap import Check, Slot
from s2sad.live_objects.side_table import side_table

_KEPT = 16      # states: values that go back and forth find theirs again
_CHANGES = 4    # of a number from outside: from then on it is an argument


def derivatives_of(f: Any) -> DerivativeCache:
    """The derivatives of a plain function, a differentiated one or a Numba dispatcher."""
    function = python_function(f)
    if function is None:
        raise S2sadError(compiler().not_a_function(f))
    with COMPILER_LOCK:
        table = side_table(function)
        if "derivatives" not in table:
            table["derivatives"] = DerivativeCache(function)
        return table["derivatives"]


class DerivativeCache:
    """All that was derived from one function."""

    def __init__(self, function: FunctionType):
        self.function = function
        self._states: list[ProgramVersion] = []
        self._current: ProgramVersion | None = None
        self._changes: Counter[Path] = Counter()
        self._varying: frozenset[Path] = frozenset()    # numbers that have changed often: arguments of derivatives

    def state(self) -> ProgramVersion:
        """The state for the values that the function's constants have now."""
        last = self._current
        if last is not None and last.is_current():
            return last
        with COMPILER_LOCK:
            found = next((s for s in self._states if s.is_current()), None) or self._load_stored() or self._read()
            self._states = [*(s for s in self._states[-_KEPT:] if s is not found), found]
            self._current = found
            return found

    def with_constants(self) -> ProgramVersion:
        """The state in which each number from outside is a constant, however often it has changed: for texts and
        bare functions."""
        state = self.state()
        varies = any(isinstance(a, VaryingNumber) for a in state.arrays)
        return ProgramVersion.of(compiler().program(self.function), self.function) if varies else state

    def _load_stored(self) -> ProgramVersion | None:
        """The state for what another process has read, if the function reads the same here."""
        known = None if self._states else artifacts.load_reading(self.function)
        return None if known is None else ProgramVersion(known, self.function)

    def _read(self) -> ProgramVersion:
        """The state for what the function reads now."""
        found = self._state_of(compiler().program(self.function, self._varying))
        last = self._current
        changed = [] if last is None else found.guards.changed_numbers(last.guards)
        self._changes.update(changed)
        for path in changed:
            if last is not None and self._changes[path] == _CHANGES:
                found = self._generalized(path, last) or found
        return found

    def _generalized(self, path: Path, last: ProgramVersion) -> ProgramVersion | None:
        """The state in which a number that changes is an argument, with all that the last one has derived; None where
        it must be known when a derivative is made."""
        varying = self._varying | {path}
        try:
            made = ProgramVersion.of(compiler().program(self.function, varying), self.function)
            made.derive_as(last)
        except S2sadError:
            return None
        self._varying, self._states = varying, []
        return made

    def _state_of(self, program: Program) -> ProgramVersion:
        """The state for another reading of the function."""
        for state in self._states:
            if state.serves(program):
                state.adopt(program)
                return state
        found = ProgramVersion.of(program, self.function)
        artifacts.store_reading(found.reading, self.function)
        return found


@runtime_checkable
class RepreparedCall(Protocol):
    """A prepared call that is prepared again for another reading of its function."""

    def prepared_for(self, state: ProgramVersion) -> RepreparedCall: ...


class ProgramVersion:
    """A program whose constants are known, and what was derived from it. `entries` keeps prepared calls by their
    callers' keys. A `flat` one takes the leaves of structures; one that `depends_on_structure` is another for
    arguments of another make."""

    def __init__(self, reading: ReadRecord, function: FunctionType, flat: bool = False,
                 read: Callable[[], Program] | None = None):
        self.reading, self.function, self.flat = reading, function, flat
        self.depends_on_structure, self.kernel = reading.depends_on_structure, reading.kernel
        self.parameters = self.kernel.parameters
        self.floats = float_parameters(self.kernel)
        self.entries: dict[Any, Any] = {}
        self._variants: dict[Any, Executable] = {}
        self._summaries: dict[tuple[Type, ...], EntrySummary] = {}
        self._forms: dict[Any, Any] = {}
        self._read, self._program = read or self._read_again, None
        self.registered: tuple[RegisteredRule, ...] = ()
        self._compiled_in = Guards()        # what functions with derivatives of their own read, which nobody else does
        self._frozen: list[tuple[Any, list[str]]] = []
        self._set_guards(reading.guards, reading.arrays)

    @classmethod
    def of(cls, program: Program, function: FunctionType) -> ProgramVersion:
        """The state for a program that was read."""
        kernel, given = compiler().entry_kernel(program), compiler().registered_rules(program)
        held = (*program.arrays.values(), *program.records.values())
        address = None if given else artifacts.address(program.guards, function, held, kernel)
        made = cls(ReadRecord(kernel, program.refused is not None, program.arrays, program.records, program.guards,
                              address, program.warned), function)
        return made.with_program(program)

    def with_program(self, program: Program, normal: Mapping[Any, Any] = MappingProxyType({})) -> ProgramVersion:
        """The state, whose program was read, and brought to these normal forms."""
        self._forms |= normal
        self._program, self.registered = program, compiler().registered_rules(program)
        with recording(self._compiled_in):
            self._frozen = [(g.plain, compiler().compiled_in(g.plain)) for g in self.registered
                            if isinstance(g.plain, FunctionType)]
        return self

    @property
    def program(self) -> Program:
        """The program; of a state that another process has read it is read now."""
        if self._program is None:
            with COMPILER_LOCK:
                self._program = self._read()
        return self._program

    def _read_again(self) -> Program:
        program = compiler().program(self.function)
        if artifacts.address(program.guards, self.function, (), self.kernel) != self.reading.address:
            raise S2sadError(Diagnostic("S405", f"what '{self.kernel.name}' reads from outside was changed while its "
                                        "derivative was made", help="call it again"))
        return program

    @property
    def _address(self) -> str | None:
        """Where derivatives are kept; nowhere if more than reading has taken stands behind them."""
        return None if self.program.evaluated else self.reading.address

    def derive_as(self, other: ProgramVersion) -> None:
        """Derives what another reading has derived; raises S2sadError for what is refused."""
        for request, engine in other._variants:
            self.variant(request, engine)
        for key, entry in other.entries.items():
            if isinstance(entry, RepreparedCall):
                self.entries[key] = entry.prepared_for(self)

    def adopt(self, program: Program) -> None:
        """From now on the state is for what this reading took."""
        self._set_guards(program.guards, program.arrays)

    def _set_guards(self, guards: Guards, arrays: Mapping[str, Any]) -> None:
        self.guards, self.arrays = guards, tuple(arrays.values())
        self._edition = GIVEN.edition

    def is_current(self) -> bool:
        """Whether all that was taken from outside is what it was."""
        return self._edition == GIVEN.edition and self.guards.hold() and self.unchanged()

    def unchanged(self) -> bool:
        """Whether the functions with derivatives of their own are what they were."""
        return all(g.reachable() for g in self.registered) and self._compiled_in.hold()

    def serves(self, program: Program) -> bool:
        """Whether what was derived here holds for another reading of the same function."""
        if self._program is not None:
            return (self.registered == compiler().registered_rules(program) and self.unchanged()
                    and compiler().same_program(self._program, program))
        defaults, known = program.kernels[program.entry].defaults, self.kernel.defaults
        if artifacts.address(program.guards, self.function, (), self.kernel) != self.reading.address or any(
                n not in known or not same(known[n], value) for n, value in defaults.items()):
            return False    # an address does not tell one list from another
        self._program = program
        return True

    def summary(self, types: tuple[Type, ...]) -> EntrySummary:
        """The kernel's writes and results for these types."""
        found = self._summaries.get(types) or artifacts.load_summary(self.reading.address, types)
        if found is None:
            with Working(f"reading '{self.kernel.name}'"):
                try:
                    found = compiler().summary(self.program, types, self._forms)
                except WaitingForFacts as waits:
                    self._demand_facts(waits)
                    raise
            artifacts.store_summary(self._address, types, found)
        if types not in self._summaries:
            self._summaries[types] = found
            for array in (n for n in found.returned.values() if n.startswith(HIDDEN)):
                raise S2sadError(Diagnostic("S201", f"'{self.kernel.name}' returns '{array[len(HIDDEN):]}', an array "
                                            "of its module", help="pass the array as an argument"))
        return found

    def _demand_facts(self, waits: WaitingForFacts) -> None:
        """From now on the program is made for what is known of the arguments."""
        made = compiler().waiting(self.function, waits, self.guards.varying)
        self._program, self.depends_on_structure, self.kernel = made, True, compiler().entry_kernel(made)
        self.floats = float_parameters(self.kernel)
        self._forms.clear()

    def types(self, values: Sequence[Any]) -> tuple[Type, ...]:
        """The types of values; lengths of 1 count where the kernel joins arrays of shapes not known to be equal."""
        found = types_of(values)
        if not any(t.ones for t in found):
            return found
        plain = tuple(t.plain for t in found)
        try:
            return found if self.summary(plain).guarded else plain
        except WaitingForFacts:
            raise
        except S2sadError:
            return found    # np.squeeze without an axis asks for them

    def variant(self, request: Request, engine: str) -> Executable:
        """The generated function for a request, made once; `engine` may be "auto"."""
        if engine == "auto":
            interpreting()
        engine = chosen(engine)
        key, recording = (request, engine), request.recording
        if engine == "numba":
            self.check_frozen_arrays()
        with COMPILER_LOCK:
            if key not in self._variants:
                request = Request(request.mode, request.types, request.wrt, request.of, engine, "fast",
                                  request.with_primal, split=request.split, width=request.width,
                                  recording=recording.keeping(recording.loops))
                generated = artifacts.load_generated(self.reading.address, request)
                if generated is None:
                    with Working(f"deriving the {request.mode} of '{self.kernel.name}'"):
                        generated = compiler().derived(self.program, request, self._forms)
                    artifacts.store_generated(self._address, request, generated)
                loaded = SplitExecutable if request.split else ManyDirections if request.width else Executable
                summary = self.summary(request.types)
                made = self._variants[key] = loaded(generated, engine, summary, self.kernel.name, self.registered,
                                                    self.function)
                if engine == "numba":
                    check = IndexCheck(generated, lambda values: self._run_checked(values, request.types, engine))
                    made.check_indices = check if check.is_needed else None
                    if check.scanned and not request.width and not recording.limit and request.mode != "primal":
                        made.unsigned = cache(lambda: loaded(
                            generated, engine, summary, self.kernel.name, self.registered, self.function,
                            forwards=check.scanned))
                if recording.limit:
                    made.limited = LimitedMemory(recording.limit, self.kernel.name, summary.written,
                                                 lambda loops: self.variant(
                        replace(key[0], recording=recording.keeping(loops)), engine))
            return self._variants[key]

    def check_frozen_arrays(self) -> None:
        """Raises if a function with a derivative of its own reads an array of its module: Numba would compile its
        content in."""
        for given, array in ((g, a) for g, arrays in self._frozen for a in arrays):
            raise S2sadError(Diagnostic("S407", f"'{given.__name__}' reads the array '{array}' of its module, whose "
                                        "content Numba would not look at again", help="pass it as an argument; "
                                        'engine="numpy" calls it as it is'))

    def primal(self, types: tuple[Type, ...], engine: str) -> Callable[..., Any]:
        """The primal for positional values: the function itself under NumPy, compiled under Numba."""
        if chosen(engine) == "numpy" and not self.flat:
            return by_position(self.function)
        variant = self.variant(Request("primal", types, (), ()), engine)
        hidden = tuple(p.name for p in variant.generated.parameters if p.name.startswith(HIDDEN))
        values = self.arrays_by_name()
        return _with_trailing(variant.call, tuple(values[h] for h in hidden)) if hidden else variant.call

    def check_bounds(self, values: Sequence[Any], engine: str) -> None:
        """Raises where the primal asks for an element that is not there, before anything is written."""
        if chosen(engine) != "numpy":
            variant = self.variant(Request("primal", self.types(values), (), ()), engine)
            if variant.check_indices is not None:
                variant.check_indices(variant.assemble(
                    dict(zip(self.parameters, values)), {}, (), self.arrays_by_name()))

    def _run_checked(self, given: Mapping[str, Any], types: tuple[Type, ...], engine: str) -> None:
        """Runs the primal with bounds checks, on copies."""
        key = ("checked", types)
        with COMPILER_LOCK:
            if key not in self.entries:
                primal = self.variant(Request("primal", types, (), ()), engine)
                self.entries[key] = CheckedPrimal(primal, bool(self.registered))
        checked, values = self.entries[key], [given[p] for p in self.parameters]

        def copies() -> list[Any]:
            own = dict(zip(self.parameters, self.with_private_copies(values, types)))
            return checked.variant.assemble(own, {}, (), self.private_outside_arrays(types))
        checked(copies)

    def overlap_check(self, types: tuple[Type, ...]) -> Callable[[Sequence[Any]], None] | None:
        """A function that refuses values whose arrays share memory, with another or in themselves, where they are
        written; None if none can."""
        key = ("overlap", types)
        if key not in self.entries:
            places = [k for k, t in enumerate(types) if t.is_array]
            names = [*(self.parameters[k] for k in places), *self._arrays()]
            slots = [Slot(n, "primal", n, n in self.summary(types).written) for n in names]
            check = Check(slots, "numpy") if any(s.written for s in slots) else None
            self.entries[key] = check and (lambda values: check.exact([*[values[k] for k in places], *(
                self._arrays().values() if self.arrays else ())]) and None)
        return self.entries[key]

    def with_private_copies(self, values: Sequence[Any], types: tuple[Type, ...]) -> list[Any]:
        """The values, with copies of the arrays that the function may write."""
        summary = self.summary(types)
        check_contiguous(summary, dict(zip(self.parameters, values)))
        return [private_copy(v) if name in summary.written and isinstance(v, np.ndarray) else v
                for name, v in zip(self.parameters, values)]

    def arrays_by_name(self) -> dict[str, Any]:
        """The arrays that the function reads from its module or closure, and the numbers there that vary, by their
        parameters' names."""
        return dict(zip((HIDDEN + x for x in self.reading.arrays), map(current, self.arrays))) if self.arrays else {}

    def _arrays(self) -> dict[str, np.ndarray]:
        return {n: a for n, a in self.arrays_by_name().items() if isinstance(a, np.ndarray)}

    def private_outside_arrays(self, types: tuple[Type, ...]) -> dict[str, Any]:
        """`arrays_by_name` with copies of what the function writes: no derivative changes its module."""
        if not self.arrays:
            return {}
        summary = self.summary(types)
        check_contiguous(summary, self.arrays_by_name())
        return {n: private_copy(a) if n in summary.written else a for n, a in self.arrays_by_name().items()}


def check_contiguous(summary: Any, values: Mapping[str, Any]) -> None:
    """Refuses an array that has to be contiguous and is not."""
    for name in summary.contiguous:
        if name in values and not values[name].flags.c_contiguous:
            raise S2sadError(Diagnostic(
                "S405", f"'{name.removeprefix(HIDDEN)}' is not contiguous, where it or an array made like it is "
                "reshaped and written", note="NumPy writes a copy of it then",
                help="pass np.ascontiguousarray(...), or write it as a loop"))


def private_copy(array: np.ndarray) -> np.ndarray:
    """A copy of an array that a function may write."""
    return np.array(array, order="C")


def _with_trailing(function: Callable[..., Any], trailing: tuple[Any, ...]) -> Callable[..., Any]:
    return lambda *args: function(*args, *trailing)
