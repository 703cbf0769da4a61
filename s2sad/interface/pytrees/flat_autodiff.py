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
from s2sad.interface.pytrees.flatten import Flattened, flattened
from s2sad.infer.types import Type
from s2sad.interface.selection import RETURN, ReturnedValues, selected_of, selected_wrt
from s2sad.interface.shadow_calls import ShadowCall
from s2sad.pytree import PyTree, assign_part, is_held, is_structure, leaves, part_of, step
from s2sad.dispatch.cache import ProgramVersion

_READINGS = 512
Layout = list[tuple[str, str]]          # the role and the parameter of each argument


# -- autodiff -------------------------------------------------------------------------------------------------------

def flat_autodiff(state: ProgramVersion, mode: Mode, annotated: Sequence[Any], engine: str, seed: Any
                  ) -> tuple[Any] | None:
    """What `autodiff` returns, in a tuple of one; None if there is nothing to take apart."""
    plain = [a.value if isinstance(a, Annotation) else a for a in annotated]
    apart = flattened(state, plain)
    if apart is None:
        return None
    values = bind(state.kernel, plain)
    marks = [*annotated, *values[len(annotated):]]
    with apart.user_paths():
        return (_FlatAutodiff(apart, mode, marks, values, engine).called(seed),)


class _FlatAutodiff:
    """One call: the flat annotated arguments, and where what comes back belongs."""

    def __init__(self, apart: Flattened, mode: Mode, marks: list[Any], values: Sequence[Any], engine: str):
        self.apart, self.mode, self.engine = apart, mode, engine
        self.args = list(values)
        self.annotated: list[Any] = []
        self.active: list[tuple[str, Any, str | int] | None] = []   # where each Active float's adjoint is added
        self.shadowed: list[tuple[np.ndarray, str, Any, str | int]] = []
        flat = apart.values(self.args)
        self.flat = dict(zip(apart.paths, flat))
        for (parameter, form), mark in zip(apart.forms.items(), marks):
            if isinstance(form, PyTree):
                self._structure(parameter, form, mark)
            elif is_held(form):
                self.annotated.append(mark)
                if isinstance(mark, Active):
                    self.active.append(None)

    def _structure(self, parameter: str, form: PyTree, mark: Any) -> None:
        value = mark.value if isinstance(mark, Annotation) else mark
        suffix = "bar" if self.mode.reverse else "dot"
        floats = self.apart.floats(form, parameter)
        names = [self.apart.names[p] for p, t in leaves(form, parameter) if is_held(t)]
        if not isinstance(mark, (Const, Duplicated)) and (floats or isinstance(mark, Annotation)):
            what = "has no annotation" if not isinstance(mark, Annotation) else \
                f"is {type(mark).__name__}, and a structure"
            raise S2sadError(Diagnostic("S402", f"the argument '{parameter}' {what}", help=f"say Const({parameter}) "
                                        f"or Duplicated({parameter}, {parameter}_{suffix})"))
        if not isinstance(mark, Duplicated):
            self.annotated += [Const(self.flat[n]) for n in names]
            return
        shadows = self.apart.flat_parts((parameter, form, parameter), mark.shadow, "shadow", self.flat)
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
            name = self.apart.names.get(inner, "")
            if name in self.apart.cells and name in shadows:
                self.shadowed.append((shadows[name], form.kind, shadow, key))
            elif self.mode.reverse and name in shadows and not item.is_array:
                if form.fixed:
                    what = "a frozen dataclass" if form.kind == "record" else str(form)
                    raise S2sadError(Diagnostic("S402", f"the float '{inner}' lies in {what}: its adjoint cannot be "
                                                "added to the shadow", help="use s2sad.vjp or s2sad.gradient, which "
                                                f"return it, or hold '{inner}' in an array"))
                self.active.append((form.kind, shadow, key))

    def called(self, seed: Any) -> Any:
        apart = self.apart
        kinds = tuple(type(a) if isinstance(a, Annotation) else None for a in self.annotated)
        values = [a.value if isinstance(a, Annotation) else a for a in self.annotated]
        shadows = [a.shadow for a in self.annotated if isinstance(a, Duplicated)]
        key = (self.mode, self.engine, kinds, describe(values), describe(shadows))
        entry = apart.state.entries.get(key)
        if entry is None:
            entry = apart.state.entries[key] = AnnotatedCall(apart.state, self.mode, self.annotated, self.engine)
        if seed is not None and apart.result is not None:
            seed = apart.result_seed(seed)
        found = entry(values, shadows, seed)
        derivative, primal = found if self.mode.with_primal else (found, None)
        for cell, kind, holder, key in self.shadowed:
            assign_part(kind, holder, key, cell[0].item())
        if entry.keeps:
            apart.write_back(self.args, self.flat)
        if self.mode.reverse:
            derivative = self._added(derivative)
        elif apart.result is not None:
            derivative = apart.result_of(derivative)
        if not self.mode.with_primal:
            return derivative
        return derivative, primal if apart.result is None else apart.result_of(primal)

    def _added(self, derivative: tuple[Any, ...]) -> tuple[Any, ...]:
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
    if not state.asks and not any(map(is_structure, args)):
        return None
    unmeant = not state.asks and _only_lists_as_shadows(args)
    wrong: S2sadError | None = None
    for layout in islice(_layouts(state, mode, args, 0, 0), _READINGS):
        try:
            found = _reading(state, mode, layout, args, f)
        except S2sadError as error:     # of a shadow that is read as an argument, perhaps
            wrong = wrong or error
            continue
        if found is not None:
            with found[0].user_paths():
                return (_called(*found),)
    if unmeant:
        return None     # the list is refused as any shadow that is no array
    if wrong is not None:
        raise wrong
    raise S2sadError(Diagnostic("S405", f"'{state.kernel.name}.{mode}' was given {len(args)} arguments that do not fit "
                                "its signature", help=f"call {state.kernel.name}.{mode}({', '.join(state.parameters)}, "
                                "with a shadow after each that holds float arrays)"))


def _reading(state: ProgramVersion, mode: str, layout: Layout, args: Sequence[Any], f: Any) -> tuple[Any, ...] | None:
    """What a list of arguments means that is read so; None if it cannot be."""
    apart = flattened(state, [args[k] for k, (role, _) in enumerate(layout) if role == "primal"])
    if apart is None:
        return None
    with apart.user_paths():
        carrier = apart.carried(f)[1]
        values = apart.values([args[k] for k, (role, _) in enumerate(layout) if role == "primal"])
        shadows = _implied(apart, mode, values, carrier)
        roles = [(role, p) for p, form in apart.forms.items() for role in ("primal", "shadow")
                 if role == "primal" or any(path in shadows for path, _ in leaves(form, p))]
        fits = roles == layout and len(args) - len(layout) == _seeds(apart, mode, values, carrier)
    return (apart, mode, layout, args, shadows, carrier) if fits else None


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
    if start + 1 < len(args) and _alike(mode, args[start], args[start + 1]):
        for rest in _layouts(state, mode, args, start + 2, done + 1):
            yield [("primal", names[done]), ("shadow", names[done]), *rest]
    for rest in _layouts(state, mode, args, start + 1, done + 1):
        yield [("primal", names[done]), *rest]


def _alike(mode: str, value: Any, following: Any) -> bool:
    if is_structure(value):
        return type(value) is type(following)
    if isinstance(value, np.ndarray):
        return value.dtype.name in INEXACT and isinstance(following, np.ndarray) and following.ndim == value.ndim
    return mode == "tangent" and isinstance(value, (float, int)) and isinstance(following, (float, int))


def _implied(apart: Flattened, mode: str, values: list[Any], carrier: Carrier) -> set[str]:
    """The paths of the leaves that have a shadow."""
    state = apart.state
    types = state.types(values)
    wrt, of, _ = carrier.__s2sad_selection__
    wrt = selected_wrt(apart.title, state.parameters, types, wrt)
    of = selected_of(apart.title, state.parameters, types, state.summary(types), of)
    return {apart.paths[n] for n, t in zip(state.parameters, types)
            if (n in wrt or n in of) and t.is_inexact and (t.is_array or mode == "tangent")}


def _seeds(apart: Flattened, mode: str, values: list[Any], carrier: Carrier) -> int:
    types = apart.state.types(values)
    summary = apart.state.summary(types)
    of = selected_of(apart.title, apart.state.parameters, types, summary, carrier.__s2sad_selection__[1])
    return len(ReturnedValues.of(summary).own) if mode == "adjoint" and RETURN in of else 0


def _called(apart: Flattened, mode: str, layout: Layout, args: Sequence[Any], shadows: set[str], carrier: Carrier
            ) -> Any:
    own = [args[k] for k, (role, _) in enumerate(layout) if role == "primal"]
    values = dict(zip(apart.paths, apart.values(own)))
    bars: dict[str, Any] = {}
    cells: list[tuple[np.ndarray, str, Any, str | int]] = []
    for k, (role, parameter) in enumerate(layout):
        if role == "shadow":
            form = apart.forms[parameter]
            if isinstance(form, Type):
                bars[parameter] = args[k]
                continue
            found = apart.flat_parts((parameter, form, parameter), args[k], "shadow", values)
            bars |= {n: v for n, v in found.items() if apart.paths[n] in shadows}
            cells += [(bars[n], kind, v, i) for n, kind, v, i in apart.held(form, args[k], parameter) if n in bars]
    flat: list[Any] = []
    for name, value in values.items():
        flat += [value, bars[name]] if name in bars else [value]
    flat += args[len(layout):]
    key = (f"{mode} {carrier.__s2sad_selection__!r}", describe(flat))
    entry = apart.state.entries.get(key)
    if entry is None:
        entry = apart.state.entries[key] = ShadowCall(apart.state, mode, tuple(flat), carrier.__s2sad_selection__)
    returned = entry(tuple(flat))
    for cell, kind, holder, item in cells:
        assign_part(kind, holder, item, cell[0].item())
    return returned


# -- the rest of what a differentiated function has -------------------------------------------------------------------

def primal(apart: Flattened, args: Sequence[Any], engine: str) -> Any:
    """What the compiled primal returns; fields that it assigns are assigned."""
    state = apart.state
    with apart.user_paths():
        values = apart.values(args)
        types = state.types(values)
        function, disjoint = state.primal(types, engine), state.apart(types)
        if disjoint is not None:
            disjoint(values)
        state.first_run(values, engine)
    flat = dict(zip(state.parameters, values))
    returned = ReturnedValues.of(state.summary(types)).with_aliases(function(*values), flat)
    apart.write_back(args, flat)
    return returned if apart.result is None else apart.result_of(returned)
