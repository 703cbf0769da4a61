"""The two halves of `f.adjoint` as calls of their own: `f.augmented(...)` and `f.reverse(tape, ...)`.

    result, tape = f.augmented(u, dt)       runs f, which writes its arguments as ever
    dt_bar, = f.reverse(tape, u_bar)        takes the shadows and seeds of f.adjoint

One instance serves all later calls with arguments of the same types. Nothing is written before everything fits.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import check_writable, coercion, describe, kernel_value, shadow
from s2sad.dispatch.cache import ProgramVersion, check_contiguous
from s2sad.dispatch.split_executable import SplitExecutable, arrays_in
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface.selection import ReturnedValues, Selection, places, result_seed, selected_of, selected_wrt
from s2sad.interface.shadow_signature import argument_text
from s2sad.interface.tapes import Tape
from s2sad.program import Request
from s2sad.run.memory import Memory
from s2sad.run.overlap import Check, Slot, overlap


@dataclass(frozen=True)
class PrimalShapes:
    """What a reverse sweep asks of the primals that its shadows belong to: stand-ins for arguments, which take no
    memory (those that share theirs are themselves), and the shapes of results."""
    arguments: dict[str, Any]
    results: dict[int, tuple[int, ...]]


Sweep = Callable[[Tape, Sequence[Any], bool], Any]
"""The reverse sweep over a tape: it is given shadows and seeds, and told whether to keep the tape."""


@dataclass(frozen=True)
class Augmented:
    """What a call of `f.augmented` has found: the result, the entries of the tape and whose they are, and the reverse
    sweep over it."""
    result: Any
    entries: tuple[Any, ...]
    variant: SplitExecutable
    sweep: Sweep


def split_call(state: ProgramVersion, values: Sequence[Any], selection: Selection) -> SplitCall:
    """The prepared call for values of these types."""
    key = (f"split {selection!r}", describe(values))
    entry = state.entries.get(key)
    if entry is None:
        entry = state.entries[key] = SplitCall(state, values, selection)
    return entry


class SplitCall:
    """A prepared `f.augmented(...)`, and the reverse sweeps over its tapes."""

    def __init__(self, state: ProgramVersion, values: Sequence[Any], selection: Selection):
        self.state, names, title = state, state.parameters, state.kernel.name
        self._coercions = [(k, how) for k, (n, v) in enumerate(zip(names, values))
                           if (how := coercion(n, v, n in state.floats)) is not None]
        values = [kernel_value(n, v, n in state.floats) for n, v in zip(names, values)]
        self.types = state.types(values)
        self.summary = state.summary(self.types)
        self.results = ReturnedValues.of(self.summary)
        for changed in self.summary.changed_outside:
            raise leaves_another(title, changed)
        for name, value in zip(names, values):
            if name in self.summary.written:
                check_writable(name, value)
        self._apart = state.overlap_check(self.types)
        self._check_memory(values)
        wrt = selected_wrt(title, names, self.types, selection.wrt)
        of = selected_of(title, names, self.types, self.summary, selection.of)
        variant = state.variant(Request("adjoint", self.types, wrt, of, recording=selection.recording, split=True),
                                selection.engine)
        assert isinstance(variant, SplitExecutable)
        self.variant = variant
        self.shadowed = [p for p in variant.parameters if p.role == "shadow" and p.type.is_array]
        self._seed_places = places([p.primal for p in variant.seeds])
        self._runs(self._arguments(values)).prepare_call(self._arguments(values))
        self._prepared: set[SplitExecutable] = set()        # those whose reverse sweep is compiled

    # -- forward -----------------------------------------------------------------------------------------------------

    def augmented(self, values: Sequence[Any]) -> Augmented:
        """Runs f."""
        values = list(values)
        for k, how in self._coercions:
            values[k] = how(values[k])
        self._check_memory(values)
        by_name = dict(zip(self.state.parameters, values))
        arguments = self._arguments(values)
        variant = self._runs(arguments)
        returned, entries = variant.augmented(arguments)
        self._refuse_shared(variant, entries, by_name, returned)
        shapes = {k: returned[k].shape for k, t in enumerate(self.results.types) if t.is_array}
        found = returned if len(returned) > 1 else returned[0] if returned else None
        sweep = partial(self.reverse, variant, PrimalShapes(self._stand_ins(by_name), shapes))
        return Augmented(self.results.with_aliases(found, by_name), entries, variant, sweep)

    def memory(self, values: Sequence[Any]) -> Memory:
        """What both halves take."""
        return self.variant.memory({**dict(zip(self.state.parameters, values)), **self.state.arrays_by_name()})

    def _runs(self, arguments: list[Any]) -> SplitExecutable:
        """What runs a call with these arguments."""
        found = self.variant.for_call(arguments)
        assert isinstance(found, SplitExecutable)
        return found

    def _check_memory(self, values: Sequence[Any]) -> None:
        if self._apart is not None:
            self._apart(values)
        if self.summary.contiguous:
            check_contiguous(self.summary, dict(zip(self.state.parameters, values)))

    def _arguments(self, values: Sequence[Any]) -> list[Any]:
        by_name = {**dict(zip(self.state.parameters, values)), **self.state.arrays_by_name()}
        return [by_name[n] for n in self.variant.taken]

    def _stand_ins(self, values: dict[str, Any]) -> dict[str, Any]:
        """For each argument that has a shadow an array of its shape and dtype."""
        arrays = {p.primal: values[p.primal] for p in self.shadowed}
        sharing = {n for n, a in arrays.items() if any(m != n and overlap(a, b) for m, b in arrays.items())}
        return {n: a if n in sharing else np.broadcast_to(np.zeros((), a.dtype), a.shape) for n, a in arrays.items()}

    def _refuse_shared(self, variant: SplitExecutable, entries: Sequence[Any], values: dict[str, Any],
                       returned: Sequence[Any]) -> None:
        """Refuses what a function with an adjoint of its own keeps if somebody else may write it."""
        saved = [v for v, (kind, _) in zip(entries, variant.tape) if not kind.is_array and not kind.is_number]
        if not saved:
            return
        others = [(f"the argument '{n}'", v) for n, v in values.items()]
        others += [("what it returns", v) for v in returned] + [("an array of its own", v) for v in entries]
        for array in arrays_in(saved):
            for what, other in others:
                if isinstance(other, np.ndarray) and overlap(array, other):
                    raise S2sadError(Diagnostic(
                        "S409", f"'{self.state.kernel.name}' calls a function with an adjoint of its own, and what "
                        f"that saves shares memory with {what}, which may change before the reverse sweep",
                        help="let its first half save a copy"))

    # -- reverse -----------------------------------------------------------------------------------------------------

    def reverse(self, variant: SplitExecutable, primals: PrimalShapes, tape: Tape, given: Sequence[Any], keep: bool
                ) -> Any:
        """The adjoints of float scalars, as a tuple, None without any."""
        arguments = self._fitted(primals, given)
        check = Check([*(Slot(p.primal, "primal", p.primal, False) for p in self.shadowed),
                       *(Slot(p.name, "shadow", p.primal, True) for p in self.shadowed)], "numpy")
        shared = check([*(primals.arguments[p.primal] for p in self.shadowed), *arguments[:len(self.shadowed)]])
        entries = tape.entries()
        if variant not in self._prepared:
            variant.prepare([entries, *arguments])
            self._prepared.add(variant)
        entries = tape.take(keep)
        return variant.run([entries, *arguments], tuple(k + 1 - len(self.shadowed) for k in shared)) or None

    def _fitted(self, primals: PrimalShapes, given: Sequence[Any]) -> list[Any]:
        """The shadows and seeds as the reverse sweep takes them; raises S2sadError if one does not fit."""
        names = [p.name for p in (*self.shadowed, *self.variant.seeds)]
        if len(given) != len(names):
            raise misfit_of_signature(self.state.kernel.name, given, names)
        found = [shadow(p.name, value, p.primal, primals.arguments[p.primal])
                 for p, value in zip(self.shadowed, given)]
        for p, place, value in zip(self.variant.seeds, self._seed_places, given[len(found):]):
            seed = result_seed(value, p.type)
            if p.type.is_array and seed.shape != primals.results[place]:
                raise S2sadError(Diagnostic("S403", f"the seed '{p.name}' has shape {seed.shape}, what "
                                            f"'{self.state.kernel.name}' returns there has {primals.results[place]}",
                                            help="give an array of its shape"))
            found.append(seed)
        return found


def leaves_another(title: str, changed: str) -> S2sadError:
    """The error for a function that leaves another array or object somewhere in its arguments."""
    return S2sadError(Diagnostic("S409", f"'{title}' leaves something else in '{changed}' than was there, which "
                                 f"{title}.augmented does not do", help="use s2sad.vjp, which changes no argument, or "
                                 "write arrays in place"))


def misfit_of_signature(title: str, given: Sequence[Any], names: Sequence[str]) -> S2sadError:
    """The error for another number of shadows and seeds than there are."""
    note = f"given were {', '.join(map(argument_text, given))}" if given else ""
    what = f"{len(given)} argument{'s' * (len(given) != 1)}" if given else "nothing"
    return S2sadError(Diagnostic("S405", f"'{title}.reverse' was given {what} behind the tape, and takes {len(names)}",
                                 note=note, help=f"call {title}.reverse({', '.join(['tape', *names])})"))
