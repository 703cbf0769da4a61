"""`autodiff`, `f.adjoint` and `f.tangent` with structures and their shadows.

    autodiff(Reverse, step, Duplicated(state, state_bar), Const(p), Active(dt))

A shadow is a structure of the same make. Arrays in it follow the shadow law. A number in a structure that is
`Duplicated` has its adjoint added to the number in the shadow (of one that the kernel assigns, in its place), so the
shadow must be one whose fields can be assigned; `f.adjoint` returns it with those of the other numbers, in order.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np

from s2sad.interface.autodiff import AnnotatedCall
from s2sad.interface.activities import Active, Annotation, Const, Duplicated, Mode
from s2sad.dispatch.arguments import INEXACT, bind, describe
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface.pytrees.flat_selection import Carrier
from s2sad.interface.pytrees.flatten import Flattened, flatten
from s2sad.infer.types import Type
from s2sad.interface.selection import RETURN, ReturnedValues, Selection, selected_of, selected_wrt
from s2sad.interface.shadow_calls import ShadowCall
from s2sad.pytree import PyTree, assign_part, is_held, is_structure, leaves, part_of, step
from s2sad.dispatch.cache import ProgramVersion

_READINGS = 512
Layout = list[tuple[str, str]]          # the role and the parameter of each argument


# -- autodiff -------------------------------------------------------------------------------------------------------

def flat_autodiff(state: ProgramVersion, mode: Mode, annotated: Sequence[Any], selection: Selection, seed: Any
                  ) -> tuple[Any] | None:
    """What `autodiff` returns, in a tuple of one; None if there is nothing to take apart."""
    plain = [a.value if isinstance(a, Annotation) else a for a in annotated]
    flattened = flatten(state, plain)
    if flattened is None:
        return None
    values = bind(state.kernel, plain)
    marks = [*annotated, *values[len(annotated):]]
    with flattened.user_paths():
        return (_FlatAutodiff(flattened, mode, marks, values, selection).call(seed),)


class _FlatAutodiff:
    """One call: the flat annotated arguments, and where what comes back belongs."""

    def __init__(self, flattened: Flattened, mode: Mode, marks: list[Any], values: Sequence[Any],
                 selection: Selection):
        self.flattened, self.mode, self.selection = flattened, mode, selection
        self.args = list(values)
        self.annotated: list[Any] = []
        self.active: list[tuple[str, Any, str | int] | None] = []   # where each Active float's adjoint is added
        self.shadowed: list[tuple[np.ndarray, str, Any, str | int]] = []
        flat = flattened.values(self.args)
        self.flat = dict(zip(flattened.paths, flat))
        for (parameter, form), mark in zip(flattened.forms.items(), marks):
            if isinstance(form, PyTree):
                self._structure(parameter, form, mark)
            elif is_held(form):
                self.annotated.append(mark)
                if isinstance(mark, Active):
                    self.active.append(None)

    def _structure(self, parameter: str, form: PyTree, mark: Any) -> None:
        value = mark.value if isinstance(mark, Annotation) else mark
        suffix = "bar" if self.mode.reverse else "dot"
        floats = self.flattened.floats(form, parameter)
        names = [self.flattened.names[p] for p, t in leaves(form, parameter) if is_held(t)]
        if not isinstance(mark, (Const, Duplicated)) and (floats or isinstance(mark, Annotation)):
            what = "has no annotation" if not isinstance(mark, Annotation) else \
                f"is {type(mark).__name__}, and a structure"
            raise S2sadError(Diagnostic("S402", f"the argument '{parameter}' {what}", help=f"say Const({parameter}) "
                                        f"or Duplicated({parameter}, {parameter}_{suffix})"))
        if self.flattened.leaves_another(parameter):
            raise S2sadError(Diagnostic("S402", f"'{self.flattened.title}' leaves something else in '{parameter}' than "
                                        "was there, which autodiff does not do", help="use s2sad.vjp or "
                                        "s2sad.gradient, which change no argument, or write arrays in place"))
        if not isinstance(mark, Duplicated):
            self.annotated += [Const(self.flat[n]) for n in names]
            return
        shadows = self.flattened.flat_parts((parameter, form, parameter), mark.shadow, "shadow", self.flat)
        self._places(form, mark.shadow, parameter, shadows)
        for name in names:
            leaf = self.flat[name]
            if name not in floats:
                self.annotated.append(Const(leaf) if isinstance(leaf, np.ndarray) else leaf)
            elif isinstance(leaf, np.ndarray) or not self.mode.reverse:
                self.annotated.append(type(mark)(leaf, shadows[name]))
            else:
                self.annotated.append(Active(leaf))
        assert value is not None

    def _places(self, form: PyTree, shadow: Any, path: str, shadows: dict[str, Any]) -> None:
        """Where the numbers of a shadow are."""
        for key, item in zip(form.keys, form.items):
            inner = step(form, path, key)
            if isinstance(item, PyTree):
                self._places(item, part_of(form.kind, shadow, key), inner, shadows)
                continue
            name = self.flattened.names.get(inner, "")
            if name in self.flattened.cells and name in shadows:
                self.shadowed.append((shadows[name], form.kind, shadow, key))
            elif self.mode.reverse and name in shadows and not item.is_array:
                if form.fixed:
                    what = "a frozen dataclass" if form.kind == "record" else str(form)
                    raise S2sadError(Diagnostic("S402", f"the float '{inner}' lies in {what}: its adjoint cannot be "
                                                "added to the shadow", help="use s2sad.vjp or s2sad.gradient, which "
                                                f"return it, or hold '{inner}' in an array"))
                self.active.append((form.kind, shadow, key))

    def call(self, seed: Any) -> Any:
        flattened = self.flattened
        kinds = tuple(type(a) if isinstance(a, Annotation) else None for a in self.annotated)
        values = [a.value if isinstance(a, Annotation) else a for a in self.annotated]
        shadows = [a.shadow for a in self.annotated if isinstance(a, Duplicated)]
        key = (self.mode, self.selection.engine, self.selection.recording, kinds, describe(values), describe(shadows))
        entry = flattened.state.entries.get(key)
        if entry is None:
            entry = AnnotatedCall(flattened.state, self.mode, self.annotated, self.selection)
            flattened.state.entries[key] = entry
        if seed is not None and flattened.result is not None:
            seed = flattened.result_seed(seed)
        found = entry(values, shadows, seed)
        derivative, primal = found if self.mode.with_primal else (found, None)
        for cell, kind, holder, key in self.shadowed:
            assign_part(kind, holder, key, cell[0].item())
        if entry.keeps:
            flattened.write_back(self.args, self.flat)
        if self.mode.reverse:
            derivative = self._add_to_shadows(derivative)
        elif flattened.result is not None:
            derivative = flattened.result_of(derivative)
        if not self.mode.with_primal:
            return derivative
        return derivative, primal if flattened.result is None else flattened.result_of(primal)

    def _add_to_shadows(self, derivative: tuple[Any, ...]) -> tuple[Any, ...]:
        """The derivatives of the caller's Active floats; those of numbers in structures go to their shadows."""
        left = []
        for place, value in zip(self.active, derivative):
            if place is None:
                left.append(value)
            else:
                assign_part(*place, part_of(*place) + value)
        return tuple(left)


# -- f.adjoint and f.tangent ----------------------------------------------------------------------------------------

def shadowed(state: ProgramVersion, mode: str, args: Sequence[Any], f: Any) -> tuple[Any] | None:
    """What `f.adjoint` or `f.tangent` returns, in a tuple of one; None if there is nothing to take apart."""
    if not state.depends_on_structure and not any(map(is_structure, args)):
        return None
    unmeant = not state.depends_on_structure and _only_lists_as_shadows(args)
    wrong: S2sadError | None = None
    for layout in islice(_layouts(state, mode, args, 0, 0), _READINGS):
        try:
            found = _reading(state, mode, layout, args, f)
        except S2sadError as error:     # of a shadow that is read as an argument, perhaps
            wrong = wrong or error
            continue
        if found is not None:
            with found[0].user_paths():
                return (_call(*found),)
    if unmeant:
        return None     # the list is refused as any shadow that is no array
    if wrong is not None:
        raise wrong
    raise S2sadError(Diagnostic("S405", f"'{state.kernel.name}.{mode}' was given {len(args)} arguments that do not fit "
                                "its signature", help=f"call {state.kernel.name}.{mode}({', '.join(state.parameters)}, "
                                "with a shadow after each that holds float arrays)"))


def _reading(state: ProgramVersion, mode: str, layout: Layout, args: Sequence[Any], f: Any) -> tuple[Any, ...] | None:
    """What a list of arguments means that is read so; None if it cannot be."""
    flattened = flatten(state, [args[k] for k, (role, _) in enumerate(layout) if role == "primal"])
    if flattened is None:
        return None
    with flattened.user_paths():
        carrier = flattened.carrier(f)[1]
        values = flattened.values([args[k] for k, (role, _) in enumerate(layout) if role == "primal"])
        shadows = _shadowed_leaves(flattened, mode, values, carrier)
        roles = [(role, p) for p, form in flattened.forms.items() for role in ("primal", "shadow")
                 if role == "primal" or any(path in shadows for path, _ in leaves(form, p))]
        fits = roles == layout and len(args) - len(layout) == _seeds(flattened, mode, values, carrier)
    return (flattened, mode, layout, args, shadows, carrier) if fits else None


def _only_lists_as_shadows(args: Sequence[Any]) -> bool:
    """Whether lists behind arrays are all that may be a structure."""
    return all(type(b) is list and isinstance(a, np.ndarray) for a, b in zip((None, *args), args) if is_structure(b))


def _layouts(state: ProgramVersion, mode: str, args: Sequence[Any], start: int, done: int) -> Iterator[Layout]:
    """The ways to read a list of arguments as parameters each followed, or not, by what may be its shadow."""
    names = state.parameters
    if done == len(names):
        yield []
        return
    if start >= len(args):
        return
    if start + 1 < len(args) and _could_be_shadow(mode, args[start], args[start + 1]):
        for rest in _layouts(state, mode, args, start + 2, done + 1):
            yield [("primal", names[done]), ("shadow", names[done]), *rest]
    for rest in _layouts(state, mode, args, start + 1, done + 1):
        yield [("primal", names[done]), *rest]


def _could_be_shadow(mode: str, value: Any, following: Any) -> bool:
    if is_structure(value):
        return type(value) is type(following)
    if isinstance(value, np.ndarray):
        return value.dtype.name in INEXACT and isinstance(following, np.ndarray) and following.ndim == value.ndim
    return mode == "tangent" and isinstance(value, (float, int)) and isinstance(following, (float, int))


def _shadowed_leaves(flattened: Flattened, mode: str, values: list[Any], carrier: Carrier) -> set[str]:
    """The paths of the leaves that have a shadow."""
    state = flattened.state
    types = state.types(values)
    wrt, of = carrier.__s2sad_selection__[:2]
    wrt = selected_wrt(flattened.title, state.parameters, types, wrt)
    of = selected_of(flattened.title, state.parameters, types, state.summary(types), of)
    return {flattened.paths[n] for n, t in zip(state.parameters, types)
            if (n in wrt or n in of) and t.is_inexact and (t.is_array or mode == "tangent")}


def _seeds(flattened: Flattened, mode: str, values: list[Any], carrier: Carrier) -> int:
    types = flattened.state.types(values)
    summary = flattened.state.summary(types)
    of = selected_of(flattened.title, flattened.state.parameters, types, summary, carrier.__s2sad_selection__[1])
    return len(ReturnedValues.of(summary).own) if mode == "adjoint" and RETURN in of else 0


def _call(flattened: Flattened, mode: str, layout: Layout, args: Sequence[Any], shadows: set[str], carrier: Carrier
            ) -> Any:
    own = [args[k] for k, (role, _) in enumerate(layout) if role == "primal"]
    values = dict(zip(flattened.paths, flattened.values(own)))
    bars: dict[str, Any] = {}
    cells: list[tuple[np.ndarray, str, Any, str | int]] = []
    for k, (role, parameter) in enumerate(layout):
        if role == "shadow":
            form = flattened.forms[parameter]
            if isinstance(form, Type):
                bars[parameter] = args[k]
                continue
            found = flattened.flat_parts((parameter, form, parameter), args[k], "shadow", values)
            bars |= {n: v for n, v in found.items() if flattened.paths[n] in shadows}
            cells += [(bars[n], kind, v, i) for n, kind, v, i in flattened.cells_in(form, args[k], parameter)
                      if n in bars]
    flat: list[Any] = []
    for name, value in values.items():
        flat += [value, bars[name]] if name in bars else [value]
    flat += args[len(layout):]
    key = (f"{mode} {carrier.__s2sad_selection__!r}", describe(flat))
    entry = flattened.state.entries.get(key)
    if entry is None:
        entry = ShadowCall(flattened.state, mode, tuple(flat), carrier.__s2sad_selection__)
        flattened.state.entries[key] = entry
    returned = entry(tuple(flat))
    for cell, kind, holder, item in cells:
        assign_part(kind, holder, item, cell[0].item())
    return returned


# -- the rest of what a differentiated function has -------------------------------------------------------------------

def primal(flattened: Flattened, args: Sequence[Any], engine: str) -> Any:
    """What the compiled primal returns; fields that it assigns are assigned."""
    state = flattened.state
    with flattened.user_paths():
        values = flattened.values(args)
        types = state.types(values)
        function, disjoint = state.primal(types, engine), state.overlap_check(types)
        if disjoint is not None:
            disjoint(values)
        state.check_bounds(values, engine)
    flat = dict(zip(state.parameters, values))
    returned = ReturnedValues.of(state.summary(types)).with_aliases(function(*values), flat)
    flattened.write_back(args, flat)
    return returned if flattened.result is None else flattened.result_of(returned)
