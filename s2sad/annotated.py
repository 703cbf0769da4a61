"""Enzyme's annotated call: every argument says what is to be done with it, and primals hold what they should after.

The derivative may leave anything in a written argument; so unless all of these are NoNeed it runs on private copies,
and the primal on the caller's arrays.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from s2sad.annotations import Active, Annotation, BatchDuplicated, Duplicated, DuplicatedNoNeed, Mode
from s2sad.binding import FLOATS, admitted, bind, make_zero, misfit, shadow, types as types_of, written_argument
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import Request
from s2sad.selection import RETURN, Results, array_seed, number_seed, selected_of, selected_wrt, structured
from s2sad.variants import State, Variant


class AnnotatedCall:
    """A prepared `autodiff`: which arguments are active is known, and what their primals must hold afterwards."""

    def __init__(self, state: State, mode: Mode, annotated: Sequence[Any], engine: str):
        self.state, self.mode, self.engine = state, mode, engine
        names = state.parameters
        bound = bind(state.kernel, annotated)
        self.marks = dict(zip(names, annotated))
        for name, given in self.marks.items():
            _admissible(name, given, mode)
        self.active = tuple(n for n, a in self.marks.items() if isinstance(a, Active))
        self.duplicated = tuple(n for n, a in self.marks.items() if isinstance(a, Duplicated))
        self.floats = state.floats | set(self.active) | {
            n for n in self.duplicated if not isinstance(self.marks[n].value, np.ndarray)}
        self.tail = [admitted(n, v, n in state.floats)
                     for n, v in zip(names[len(annotated):], bound[len(annotated):])]
        values = self._values([a.value if isinstance(a, Annotation) else a for a in annotated])
        self.types = types_of(values)
        self.summary = state.summary(self.types)
        self.results = Results.of(self.summary)
        self.written = [k for k, n in enumerate(names)
                        if n in self.summary.written and isinstance(values[k], np.ndarray)]
        for k in self.written:
            written_argument(names[k], values[k])
        noneed = {n for n, a in self.marks.items() if isinstance(a, DuplicatedNoNeed)}
        self.keeps = mode.with_primal or any(names[k] not in noneed for k in self.written)
        self.variant = self._made()
        self._ready = False

    def _made(self) -> Variant | None:
        """The variant, or None where nothing is active."""
        names, name = self.state.parameters, self.state.kernel.name
        marked = tuple(n for n in names if n in self.active or n in self.duplicated)
        if not marked:
            return None
        wrt = selected_wrt(name, names, self.types, marked)
        chosen = (*(n for n in self.duplicated if names.index(n) in self.written),
                  *((RETURN,) if self.results.own else ()))
        of = selected_of(name, names, self.types, self.summary, chosen or None)
        variant = self.state.variant(Request("adjoint" if self.mode.reverse else "tangent", self.types, wrt, of),
                                     self.engine)
        lost = [n for n in of if n != RETURN and n not in variant.shadows]
        if lost:
            raise S2sadError(Diagnostic("S901", f"internal error: the derivative has no shadow for {', '.join(lost)}"))
        return variant

    def __call__(self, annotated: Sequence[Any], given: Sequence[Any], seed: Any) -> Any:
        values = self._values(given)
        names = self.state.parameters
        by_name = dict(zip(names, values))
        shadows = {n: shadow(f"{n}_{'bar' if self.mode.reverse else 'dot'}", a.shadow, n, by_name[n])
                   for n, a in zip(names, annotated) if isinstance(a, Duplicated)}
        seeds = self._seeds(seed, values)
        if self.variant is None:
            return self._answer({}, self._primal(values), by_name, shadows)
        returned, variant = self._derived(values, shadows, seeds), self.variant
        primal = self._primal(values) if self.keeps else None
        if self.mode.reverse:
            found = dict(zip(variant.generated.returns, returned))
        else:
            found = dict(zip(self.results.places(variant.generated.returns), returned))
        return self._answer(found, primal, by_name, shadows)

    def _derived(self, values: list[Any], shadows: dict[str, Any], seeds: dict[int, Any]) -> tuple[Any, ...]:
        variant, names = self.variant, self.state.parameters
        assert variant is not None
        hidden = self.state.arrays_by_name()
        places = self.results.places([p.name for p in variant.seeds])
        ordered = [seeds.get(k, 0.0) if k not in self.results.aliases else 0.0 for k in places]
        arguments = variant.assemble(dict(zip(names, values)), shadows, ordered, hidden)
        shared = variant.checked(arguments) if self._ready else variant.check.exact(
            [arguments[k] for k in variant.array_places])
        if not self._ready:
            self.state.first_run(values, self.engine)
        if self.keeps:
            own = self.state.copied(values, self.types)
            arguments = variant.assemble(dict(zip(names, own)), shadows, ordered, hidden)
        if not self._ready:
            variant.prepare(arguments)
            self._ready = True
        for place, name in self.results.aliases.items():
            if place in seeds and self.mode.reverse:
                shadows[name] += seeds[place]
        return variant.run(arguments, shared)

    def _values(self, given: Sequence[Any]) -> list[Any]:
        names = self.state.parameters
        return [admitted(n, v, n in self.floats) for n, v in zip(names, given)] + self.tail

    def _primal(self, values: list[Any]) -> Any:
        returned = self.state.primal(self.types, self.engine)(*values)
        aliases, by_name = self.results.aliases, dict(zip(self.state.parameters, values))
        if len(self.results.types) > 1:
            return tuple(by_name[aliases[k]] if k in aliases else v for k, v in enumerate(returned))
        return by_name[aliases[0]] if aliases else returned

    def _answer(self, found: dict[Any, Any], primal: Any, values: dict[str, Any], shadows: dict[str, Any]) -> Any:
        if self.mode.reverse:
            derivative = tuple(found[n] if n in found else make_zero(values[n]) for n in self.active)
        else:
            aliased = {k: shadows[n] for k, n in self.results.aliases.items() if n in shadows}
            derivative = self.results.structure({**found, **aliased})
        return (derivative, primal) if self.mode.with_primal else derivative

    def _seeds(self, seed: Any, values: list[Any]) -> dict[int, Any]:
        """The adjoints of the returned values, by position."""
        types, floats = self.results.types, self.results.floats
        if not self.mode.reverse or not floats:
            if seed is not None:
                raise misfit("a seed was given, and " + ("the function returns no float" if self.mode.reverse else
                             "forward modes take none"), "leave it out")
            return {}
        if seed is None:
            if len(types) > 1 or types[0].is_array:
                raise misfit("the seed of 'return' is missing: the function returns "
                             f"{'several values' if len(types) > 1 else 'an array'}", "give seed=..., shaped as that")
            return {0: 1.0}
        return {k: self._seed_at(k, s, values) for k, s in structured(self.results, seed).items()}

    def _seed_at(self, place: int, seed: Any, values: list[Any]) -> Any:
        if not self.results.types[place].is_array:
            return number_seed(seed)
        name = self.results.aliases.get(place)
        if name is None:
            return array_seed(RETURN, seed, self.state.result_at(place, values, self.types, self.engine))
        if name not in self.duplicated:
            raise S2sadError(Diagnostic("S402", f"a seed was given for the returned argument '{name}', which is Const",
                                        help=f"annotate it with Duplicated({name}, ...)"))
        return array_seed(RETURN, seed, values[self.state.parameters.index(name)])


def _admissible(name: str, given: Any, mode: Mode) -> None:
    """Refuses an annotation that does not fit its argument or the mode."""
    value = given.value if isinstance(given, Annotation) else given
    is_array = isinstance(value, np.ndarray)
    number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    if not isinstance(given, Annotation):
        if is_array or isinstance(value, (float, np.floating)):
            raise _refused(f"the argument '{name}' has no annotation",
                           f"say {_choices(name, is_array, mode)}")
    elif isinstance(given, BatchDuplicated):
        raise _refused(f"the argument '{name}' is BatchDuplicated, which is not supported",
                       f"call once for each direction with Duplicated({name}, shadow)")
    elif isinstance(given, Active) and not mode.reverse:
        raise _refused(f"the argument '{name}' is Active, which means nothing in a forward mode",
                       f"use Duplicated({name}, {name}_dot)")
    elif isinstance(given, Active) and not number:
        raise _refused(f"the argument '{name}' is Active, but no float", f"say {_choices(name, is_array, mode)}")
    elif isinstance(given, Duplicated):
        if number and mode.reverse:
            raise _refused(f"the argument '{name}' is a float, which cannot be Duplicated in reverse",
                           f"use Active({name})")
        if not number and not (is_array and value.dtype.name in FLOATS):
            raise _refused(f"the argument '{name}' is Duplicated, but holds no floats", f"use Const({name})")


def _choices(name: str, is_array: bool, mode: Mode) -> str:
    suffix = "bar" if mode.reverse else "dot"
    active = f"Active({name})" if mode.reverse and not is_array else f"Duplicated({name}, {name}_{suffix})"
    return f"Const({name}) or {active}"


def _refused(message: str, remedy: str) -> S2sadError:
    return S2sadError(Diagnostic("S402", message, help=remedy))
