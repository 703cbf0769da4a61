"""Enzyme's annotated call: every argument has an annotation, and primals hold what they should after.

The derivative may leave anything in a written argument; so unless all of these are NoNeed it runs on private copies,
and the primal on the caller's arrays.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from s2sad.interface.activities import Active, Annotation, Duplicated, DuplicatedNoNeed, Mode
from s2sad.dispatch.arguments import INEXACT, kernel_value, bind, coercion, make_zero, misfit, shadow, check_writable
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span
from s2sad.dispatch.executable import Executable
from s2sad.program import Recording, Request
from s2sad.interface.selection import (
    RETURN, ReturnedValues, Selection, array_seed, places, result_seed, selected_of, selected_wrt, seeds_by_position,
)
from s2sad.dispatch.cache import ProgramVersion


class AnnotatedCall:
    """A prepared `autodiff`: which arguments are active is known, and what their primals must hold afterwards."""

    def __init__(self, state: ProgramVersion, mode: Mode, annotated: Sequence[Any], selection: Selection):
        self.state, self.mode, self.engine, self.recording = state, mode, selection.engine, selection.recording
        names = state.parameters
        bound = bind(state.kernel, annotated)
        self.marks = dict(zip(names, annotated))
        for name, mark in self.marks.items():
            _admissible(name, mark, mode)
        self.active = tuple(n for n, a in self.marks.items() if isinstance(a, Active))
        self.duplicated = tuple(n for n, a in self.marks.items() if isinstance(a, Duplicated))
        primals = [a.value if isinstance(a, Annotation) else a for a in annotated]
        self._convert(primals, bound)
        values = self.values_of(primals)
        self.types = state.types(values)
        self.summary = state.summary(self.types)
        for changed in self.summary.changed_outside:
            raise S2sadError(Diagnostic("S402", f"'{state.kernel.name}' leaves something else in '{changed}' than was "
                                        "there, which autodiff does not do", help="use s2sad.vjp or s2sad.gradient, "
                                        "which change no argument, or write arrays in place"))
        self.results = ReturnedValues.of(self.summary)
        self.written = [k for k, n in enumerate(names)
                        if n in self.summary.written and isinstance(values[k], np.ndarray)]
        for k in self.written:
            check_writable(names[k], values[k])
        noneed = {n for n, a in self.marks.items() if isinstance(a, DuplicatedNoNeed)}
        self.keeps = mode.with_primal or any(names[k] not in noneed for k in self.written)
        self.variant = self._derive()
        self.places = () if self.variant is None else places(
            [p.primal for p in self.variant.seeds] if mode.reverse else
            [r for r in self.variant.generated.returns if r.startswith(RETURN)])
        self._plain = [n for n, a in self.marks.items() if isinstance(a, Duplicated)
                       and type(a.shadow) is not np.ndarray and isinstance(a.shadow, np.ndarray)]
        self._ready = False

    def _convert(self, primals: list[Any], bound: list[Any]) -> None:
        """What turns the arguments into values of the kernel's types, and the defaults of those left out."""
        names = self.state.parameters
        floats = self.state.floats | set(self.active) | {
            n for n in self.duplicated if not isinstance(self.marks[n].value, np.ndarray)}
        self.tail = [kernel_value(n, v, n in floats) for n, v in zip(names[len(primals):], bound[len(primals):])]
        self.coercions = [(k, how) for k, (n, v) in enumerate(zip(names, primals))
                          if (how := coercion(n, v, n in floats)) is not None]

    def _derive(self) -> Executable | None:
        """The variant, or None where no selected output can depend on a selected input."""
        names, name = self.state.parameters, self.state.kernel.name
        marked = tuple(n for n in names if n in self.active or n in self.duplicated)
        of = (*(n for n in self.duplicated if names.index(n) in self.written),
              *((RETURN,) if self.results.own else ()))
        if marked:
            self._refuse_returned(selected_wrt(name, names, self.types, marked))
        if not marked or not of:
            return None
        wrt = selected_wrt(name, names, self.types, marked)
        of = selected_of(name, names, self.types, self.summary, of)
        mode, recording = ("adjoint", self.recording) if self.mode.reverse else ("tangent", Recording())
        variant = self.state.variant(Request(mode, self.types, wrt, of, recording=recording), self.engine)
        lost = [(n, s) for n, s in variant.generated.facts.get("unshadowed", {}).items() if n in self.marks]
        if lost:
            program = self.state.program
            source = program.kernels[program.entry].source
            raise S2sadError(*(_missing_shadow(n, s, source, self.mode) for n, s in lost))
        return variant

    def _refuse_returned(self, wrt: tuple[str, ...]) -> None:
        """Refuses arguments that are Const, and are returned with active values in them."""
        for name in sorted({*self.results.aliases.values()} - {*self.duplicated}):
            if self.state.parameters.index(name) not in self.written:
                continue
            request = Request("adjoint", self.types, wrt, (name,))
            found = self.state.variant(request, self.engine).generated.facts
            if not {*wrt} <= {*found.get("independent", ())}:
                raise S2sadError(Diagnostic(
                    "S406", f"the argument '{name}' is Const, but active values are stored in it and it is returned",
                    help=f"say Duplicated({name}, s2sad.make_zero({name})), or return nothing"))

    def __call__(self, primals: Sequence[Any], shadows: Sequence[Any], seed: Any) -> Any:
        values = self.values_of(primals)
        by_name = dict(zip(self.state.parameters, values))
        owned = dict(zip(self.duplicated, shadows))
        if not self._ready or not self.mode.reverse:
            owned = {n: shadow(f"{n}_{'bar' if self.mode.reverse else 'dot'}", s, n, by_name[n])
                     for n, s in owned.items()}
        for name in self._plain:
            owned[name] = np.asarray(owned[name])
        seeds = self.seeds_of(seed, by_name)
        if self.variant is None:
            self._refuse_overlap(values)
            self.state.check_bounds(values, self.engine)
            primal = self.run_primal(values)
            return self._returned({} if self.mode.reverse else self.zeros_of(primal), primal, by_name, owned)
        returned = self._derived(values, by_name, owned, seeds)
        primal = self.run_primal(values) if self.keeps else None
        return self._returned(dict(zip(self.variant.generated.returns if self.mode.reverse else self.places, returned)),
                            primal, by_name, owned)

    def _derived(self, values: list[Any], by_name: dict[str, Any], shadows: dict[str, Any],
                 seeds: dict[int, Any]) -> tuple[Any, ...]:
        """Calls the derivative, on copies of what it may write unless nobody needs that; nothing has been written
        when it refuses."""
        variant, state = self.variant, self.state
        assert variant is not None
        ordered = [seeds.get(k, 0.0) for k in self.places] if self.mode.reverse else []
        arguments = variant.assemble(by_name, shadows, ordered, state.arrays_by_name())
        shared = variant.shared_arrays(arguments)
        copied = [by_name[state.parameters[k]] for k in self.written] if self.keeps else []
        variant = variant.for_call(arguments, sum(array.nbytes for array in copied))
        if self.keeps or state.arrays:
            own = dict(zip(state.parameters, state.with_private_copies(values, self.types))) if self.keeps else by_name
            arguments = variant.assemble(own, shadows, ordered, state.private_outside_arrays(self.types))
        if not self._ready:
            variant.prepare(arguments)
            self._ready = True
        for place, name in self.results.aliases.items():
            if place in seeds and self.mode.reverse:
                shadows[name] += seeds[place]
        return variant.run(arguments, shared)

    def values_of(self, primals: Sequence[Any]) -> list[Any]:
        values = [*primals, *self.tail]
        for k, how in self.coercions:
            values[k] = how(values[k])
        return values

    def _refuse_overlap(self, values: list[Any]) -> None:
        check = self.state.overlap_check(self.types)
        if check is not None:
            check(values)

    def run_primal(self, values: list[Any]) -> Any:
        returned = self.state.primal(self.types, self.engine)(*values)
        return self.results.with_aliases(returned, dict(zip(self.state.parameters, values)))

    def zeros_of(self, primal: Any) -> dict[int, Any]:
        """The tangents of arrays that depend on nothing."""
        parts = primal if isinstance(primal, tuple) else (primal,)
        return {k: make_zero(parts[k]) for k in self.results.own if self.results.types[k].is_array}

    def _returned(self, found: dict[Any, Any], primal: Any, values: dict[str, Any], shadows: dict[str, Any]) -> Any:
        if self.mode.reverse:
            derivative = tuple(found[n] if n in found else make_zero(values[n]) for n in self.active)
        else:
            aliased = {k: shadows[n] if n in shadows else None for k, n in self.results.aliases.items()}
            derivative = self.results.structure({**found, **aliased})
        return (derivative, primal) if self.mode.with_primal else derivative

    def seeds_of(self, seed: Any, values: dict[str, Any]) -> dict[int, Any]:
        """The adjoints of the returned values, by position; what is Const has none."""
        results = self.results
        seeded = [k for k in results.floats if results.aliases.get(k, "") in ("", *self.duplicated)]
        if not self.mode.reverse or not seeded:
            if seed is not None:
                raise misfit("a seed was given, and " + ("the function returns no float that has a shadow"
                             if self.mode.reverse else "forward modes take none"), "leave it out")
            return {}
        if seed is None:
            several = len(results.types) > 1
            if several or results.types[0].is_array or results.types[0].is_complex:
                what = "several values" if several else "an array" if results.types[0].is_array else "a complex number"
                raise misfit(f"the seed of 'return' is missing: the function returns {what}",
                             "give seed=..., shaped as that")
            return {0: 1.0}
        found = seeds_by_position(results, seed, seeded)
        return {k: result_seed(s, results.types[k]) if k in results.own
                else array_seed(RETURN, s, values[results.aliases[k]]) for k, s in found.items()}


def _missing_shadow(name: str, store: Any, source: Source, mode: Mode) -> Diagnostic:
    place = Span.of(source, store) if getattr(store, "lineno", None) else None
    message = f"the argument '{name}' is Const, but active values are stored in it and read again"
    return Diagnostic("S406", message, place,
                      note="depends on an argument with a derivative, and an output depends on it",
                      help=f"say Duplicated({name}, s2sad.make_zero({name})), or Const for what is stored here")


def _admissible(name: str, mark: Any, mode: Mode) -> None:
    """Refuses an annotation that does not fit its argument or the mode."""
    value = mark.value if isinstance(mark, Annotation) else mark
    is_array = isinstance(value, np.ndarray)
    number = isinstance(value, (int, float, complex, np.integer, np.floating)) and not isinstance(value, bool)
    if not isinstance(mark, Annotation):
        if is_array or isinstance(value, (float, complex, np.floating)):
            raise _refused(f"the argument '{name}' has no annotation",
                           f"say {_fitting_marks(name, is_array, mode)}")
    elif isinstance(mark, Active) and not mode.reverse:
        raise _refused(f"the argument '{name}' is Active, which means nothing in a forward mode",
                       f"use Duplicated({name}, {name}_dot)")
    elif isinstance(mark, Active) and not number:
        raise _refused(f"the argument '{name}' is Active, but no float", f"say {_fitting_marks(name, is_array, mode)}")
    elif isinstance(mark, Duplicated):
        if number and mode.reverse:
            raise _refused(f"the argument '{name}' is a float, which cannot be Duplicated in reverse",
                           f"use Active({name})")
        if not number and not (is_array and value.dtype.name in INEXACT):
            raise _refused(f"the argument '{name}' is Duplicated, but holds no floats", f"use Const({name})")


def _fitting_marks(name: str, is_array: bool, mode: Mode) -> str:
    suffix = "bar" if mode.reverse else "dot"
    active = f"Active({name})" if mode.reverse and not is_array else f"Duplicated({name}, {name}_{suffix})"
    return f"Const({name}) or {active}"


def _refused(message: str, remedy: str) -> S2sadError:
    return S2sadError(Diagnostic("S402", message, help=remedy))
