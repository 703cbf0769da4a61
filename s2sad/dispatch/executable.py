"""A generated function that is loaded: how its arguments are put together and checked, and how it is called."""
from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from operator import itemgetter
from types import FunctionType
from typing import Any

import numpy as np

from s2sad.dispatch.deferred import compiler
from s2sad.dispatch.index_check import IndexCheck
from s2sad.dispatch.limited_memory import LimitedMemory
from s2sad.dispatch.memory_check import MemoryCheck
from s2sad.dispatch.memory_reuse import MemoryReuse, memory_at_first
from s2sad.infer.types import Type
from s2sad.program import Generated, Parameter
from s2sad.live_objects.registry import RegisteredRule
from s2sad.run.compiled import compiled, prepare
from s2sad.run.unsigned_elements import Known
from s2sad.run.exceptions import CAUGHT, ExceptionMeanings
from s2sad.run.memory import Memory, footprint_of, memory_of
from s2sad.run.module_loader import keep_loaded, load
from s2sad.run.overlap import Check, Slot
from s2sad.run.through_python import files_emptied_on_error
from s2sad.runtime import on_disk

HIDDEN = "array."
_KINDS = {"float64": float, "float32": np.float32, "complex128": complex}


def as_it_is(value: Any) -> Any:
    return value


def kind_of(kind: Type) -> Callable[[Any], Any]:
    """What makes a result of this type a number of Python's, or one of float32."""
    return _KINDS.get(kind.dtype, as_it_is) if kind.is_number else as_it_is


def _fits(arguments: Sequence[Any]) -> None:
    """Nothing is recorded that could be too large."""


def without_warnings(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function without NumPy's warnings: inf and nan are results of a derivative, and compiled code does not
    warn of them either. `np.errstate` with raise or call holds."""
    def called(*arguments: Any) -> Any:
        kept: dict[str, Any] = {kind: "ignore" for kind, done in np.geterr().items() if done == "warn"}
        with np.errstate(**kept):
            return function(*arguments)
    return called


def _known(generated: Generated, forwards: Collection[str]) -> dict[str, Known] | None:
    """What is known of the parameters of a generated function where the elements of some are not negative."""
    every = {p.name: p for p in (*generated.facts.get("taken", ()), *generated.parameters)}
    return {n: Known(p.type.rank, n in forwards, n in forwards) for n, p in every.items()
            if p.type.is_array or p.type.is_number} if forwards else None


class OnDisk:
    """A derivative that keeps snapshots in files of folders."""

    def __init__(self, function: Callable[..., Any], folders: tuple[str, ...]):
        self.function, self.folders = function, folders

    def __call__(self, *arguments: Any) -> Any:
        for folder in self.folders:
            on_disk(np.empty(0), 0, folder)     # while the arguments are as they were
        with files_emptied_on_error():
            return self.function(*arguments)


class Executable:
    """A generated function, loaded and, under Numba, compiled; how its arguments are put together and checked. One with
    `limited` memory has calls run by others, which keep snapshots; `check_indices` looks at what may be out of
    bounds. Calls in which it finds no negative element run as `unsigned`, for which none of `forwards` has one."""
    limited: LimitedMemory | None = None
    check_indices: IndexCheck | None = None
    unsigned: Callable[[], Executable] | None = None
    unrolled = False        # whether vectors are made of what LLVM has written out

    def __init__(self, generated: Generated, engine: str, summary: Any, kernel: str,
                 registered: tuple[RegisteredRule, ...] = (), function: FunctionType | None = None,
                 forwards: Collection[str] = ()):
        self.generated, self.engine, self.kernel = generated, engine, kernel
        self.parameters: tuple[Parameter, ...] = generated.parameters
        plain = tuple(generated.facts.get("wrappers", ()))
        moving = bool(registered) or generated.facts.get("moving", False)
        guards = tuple(generated.facts.get("guards", ()))
        facts = generated.facts
        entries = [facts[k] for k in ("taped", "forward") if facts.get(k)] + [generated.entry]
        module = (compiled(generated.text, generated.entry, plain=plain, user_functions=moving, guards=guards,
                           entries=entries, unrolled=self.unrolled, distinct=facts.get("distinct", ()),
                           known=_known(generated, forwards))
                  if engine == "numba" else load(generated.text, generated.entry, own=bool(registered), guards=guards))
        self.failures = ExceptionMeanings(generated.facts, str(module.__file__), kernel)
        keep_loaded(module, self)
        if registered and engine == "numpy":
            compiler().checked_constants(module, registered)
            if "units" in generated.facts:
                compiler().checked_derivatives(module, generated.facts["units"])
        taped = facts.get("taped") if engine == "numba" else None
        self.module = module
        self.dispatcher: Callable[..., Any] = getattr(module, taped or generated.entry)
        self._first = memory_at_first(facts) if taped else ()
        self._reuse = MemoryReuse(self.dispatcher, self._first, facts["arena"], function) if taped else None
        self.function: Callable[..., Any] = self.in_folders(
            self._reuse if self._reuse is not None else
            without_warnings(self.dispatcher) if engine == "numpy" else self.dispatcher)
        self.check_memory = MemoryCheck(generated, kernel, summary.written) if any(
            a.place is not None for a in generated.facts.get("recorded", ())) else _fits
        self.shadows = {p.primal: p for p in self.parameters if p.role == "shadow"}
        self.seeds = tuple(p for p in self.parameters if p.role == "seed")
        self._written = frozenset(summary.written)
        self._check: Check | None = None
        self.array_places = tuple(k for k, p in enumerate(self.parameters) if p.type.is_array)
        self._pick = itemgetter(*self.array_places) if len(self.array_places) > 1 else None
        self._only = self.array_places[0] if len(self.array_places) == 1 else None
        types = {p.name: p.type for p in (*generated.facts.get("taken", ()), *self.parameters)}
        types |= {f"return {k}": t for k, t in enumerate(summary.results)}
        if len(summary.results) == 1:
            types["result"] = summary.results[0]
        self._kinds = [kind_of(types[r]) if r in types else as_it_is for r in generated.returns]

    def in_folders(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, which keeps snapshots in the folders of the derivative."""
        folders = self.generated.facts.get("folders", ())
        return OnDisk(function, folders) if folders else function

    @property
    def check(self) -> Check:
        """The check of shapes and memory for the array arguments, in the order of the signature."""
        if self._check is None:
            slots = []
            for k in self.array_places:
                p = self.parameters[k]
                slots.append(Slot(p.name, p.role, p.primal or p.name,
                                  p.role == "shadow" or (p.primal or p.name) in self._written))
            self._check = Check(slots, self.engine)
        return self._check

    def assemble(self, values: Mapping[str, Any], shadows: Mapping[str, Any], seeds: Sequence[Any],
                 hidden: Mapping[str, Any]) -> list[Any]:
        """The positional arguments of the generated function."""
        remaining = iter(seeds)
        arguments = []
        for p in self.parameters:
            if p.role == "shadow":
                arguments.append(shadows[p.primal])
            elif p.role == "seed":
                arguments.append(next(remaining))
            elif p.name.startswith(HIDDEN):
                arguments.append(hidden[p.name])
            else:
                arguments.append(values[p.name])
        return arguments

    def shared_arrays(self, arguments: Sequence[Any]) -> tuple[int, ...]:
        """Raises unless shapes fit and memory lies apart; the places of shadows that need memory of their own."""
        if self._pick is None:
            return () if self._only is None else self.check((arguments[self._only],))
        shared = self.check(self._pick(arguments))
        return tuple([self.array_places[k] for k in shared]) if shared else ()

    def for_call(self, arguments: list[Any] | tuple[Any, ...], copies: int = 0, bare: bool = False) -> Executable:
        """What runs a call whose caller makes `copies`, and if it is `bare` others that nothing looks at; raises
        S2sadError where the memory cannot be had, IndexError where an index is out of bounds."""
        found = self
        if self.check_indices is not None and self.check_indices(arguments) and self.unsigned is not None and not bare:
            found = self.unsigned()
        if self.limited is not None:
            taken = self.generated.facts.get("taken", self.parameters)
            values = {p.name: a for p, a in zip(taken, arguments) if p.role == "primal"}
            found = self.limited.executable(arguments, values, copies)
        found.check_memory(arguments)
        return found

    @property
    def kept_bytes(self) -> int:
        """The bytes of the tape that is kept for the next call of this thread."""
        return 0 if self._reuse is None else self._reuse.stack_bytes

    def forget_tape(self) -> None:
        """Keeps none of this thread any more."""
        if self._reuse is not None:
            self._reuse.kept().drop()

    def memory(self, values: Mapping[str, Any], copies: int = 0) -> Memory:
        """What a call takes for these values of the kernel's parameters by name, of which the caller makes `copies`."""
        if self.limited is not None:
            plan = self.limited.plan(values, copies)
            return memory_of(plan.generated, plan.found, copies)
        return memory_of(self.generated, footprint_of(self.generated, values, self._written), copies)

    def prepare_call(self, arguments: Sequence[Any]) -> None:
        """Compiles what `for_call` is asked for."""
        self.prepare(arguments)

    def prepare(self, arguments: Sequence[Any]) -> None:
        """Compiles for the types of these arguments, or reads Numba's cache."""
        self.prepare_function(self.dispatcher, [*arguments, *self._first], self.generated.entry)

    def prepare_function(self, dispatcher: Callable[..., Any], arguments: Sequence[Any], title: str) -> None:
        """The same for a function of the module."""
        if self.engine == "numba":
            try:
                prepare(dispatcher, arguments, f"'{title}' of '{self.kernel}'")
            except Exception:  # whatever it is: Numba raises more than its own errors on code that it does not know
                units = self.generated.facts.get("units")   # not of one that was kept: it calls nothing of the user's
                wrong = None if units is None else compiler().uncompiled(units)
                if wrong is not None:
                    raise wrong from None
                raise

    def run(self, arguments: Sequence[Any], shared: tuple[int, ...] = ()) -> tuple[Any, ...]:
        """Calls the generated function; always a tuple, in the order of `generated.returns`."""
        try:
            returned = self.call_with_private_shadows(arguments, shared) if shared else self.function(*arguments)
        except CAUGHT as error:
            raise self.meaning(error, arguments) from None
        return () if returned is None else tuple([kind(v) for kind, v in zip(self._kinds, returned)])

    def meaning(self, error: BaseException, arguments: Sequence[Any]) -> BaseException:
        """What to raise in place of an exception of a call with these arguments."""
        if isinstance(error, MemoryError):
            return self.check_memory.meaning(error, arguments) if isinstance(self.check_memory, MemoryCheck) else error
        return self.failures.meaning(error)

    def call(self, *arguments: Any) -> Any:
        """Calls the generated function, and gives what it gives."""
        try:
            return self.function(*arguments)
        except CAUGHT as error:
            raise self.failures.meaning(error) from None

    def call_with_private_shadows(self, arguments: Sequence[Any], shared: tuple[int, ...]) -> Any:
        """Calls it with private shadows for arguments that are one array, and adds these to the caller's."""
        own = list(arguments)
        for place in shared:
            own[place] = np.zeros_like(arguments[place])
        returned = self.function(*own)
        for place in shared:
            arguments[place][...] += own[place]
        return returned


class ManyDirections(Executable):
    """A derivative for many directions at once: what it returns has their axis."""
    unrolled = True

    def __init__(self, generated: Generated, engine: str, summary: Any, kernel: str,
                 registered: tuple[RegisteredRule, ...] = (), function: FunctionType | None = None,
                 forwards: Collection[str] = ()):
        super().__init__(generated, engine, summary, kernel, registered, function, forwards)
        self._kinds = [as_it_is] * len(generated.returns)
        self.check_memory = _fits
