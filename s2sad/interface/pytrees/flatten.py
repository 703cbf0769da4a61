"""The arguments of one call with structures as arrays and numbers, and the way back.

The flat program is made once for what the arguments are made of (`evaluate/specialize`); everything behind it knows
arrays and numbers only.
"""
from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from enum import Enum
from functools import partial
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any

import numpy as np

from s2sad.dispatch import artifacts
from s2sad.dispatch.artifacts import KeptResidual, ReadRecord
from s2sad.dispatch.arguments import bind, misfit
from s2sad.dispatch.deferred import compiler
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface.pytrees.flat_selection import FlatSelection, Path
from s2sad.infer.types import FLOAT, Type
from s2sad.interface.value_calls import selection_of
from s2sad.interface.selection import RETURN, Selection
from s2sad.program import DemandedFacts, Fact
from s2sad.pytree import (
    Form, PyTree, assign_part, form_of, is_held, is_structure, leaves, map_leaves, matches_form, part_of, places_of,
    step, steps, structures, without_lengths,
)
from s2sad.dispatch.cache import ProgramVersion

_NUMBERS = (int, float, np.integer, np.floating, complex)
_PLAIN = frozenset((np.ndarray, float, complex, int, bool, np.float64, type(None), str))
_NAMED = (str, int, np.integer, np.bool_, FunctionType, BuiltinFunctionType, MethodType, np.ufunc, type, Enum, partial,
          frozenset)
_UNNAMED = object()         # in place of what is no value to specialise for
Holder = tuple[str, str, Any, "str | int"]


def flatten(state: ProgramVersion, args: Sequence[Any]) -> Flattened | None:
    """The flat form of a call with structures; None if there is none among f's arguments and f needs none."""
    if any(isinstance(d, tuple) or _is_evaluated(d) for d in state.kernel.defaults.values()):
        args = bind(state.kernel, args)
    if not state.depends_on_structure and (_PLAIN.issuperset(map(type, args)) or not any(map(_is_evaluated, args))):
        return None
    args = bind(state.kernel, args)
    forms = tuple(without_lengths(form_of(v, n)) for n, v in zip(state.parameters, args))
    keys = tuple(map(_dict_keys, forms))
    demanded_key = "demanded", forms, keys
    while True:
        facts = _facts(state, forms, args, demanded_key)
        key = ("flattened", forms, keys, tuple((fact, _typed(value)) for fact, value in facts))
        found = state.entries.get(key)
        if found is not None and found.current():
            break
        try:
            found = state.entries[key] = Flattened(state, forms, facts)
            break
        except DemandedFacts as demanded:
            known = state.entries.setdefault(demanded_key, {})
            if demanded.facts <= known.keys():
                raise demanded.error from None
            known |= dict.fromkeys(sorted(demanded.facts))
            if any(value is _UNNAMED for _, value in _facts(state, forms, args, demanded_key)):
                del state.entries[demanded_key]
                raise demanded.error from None
    return found


def _is_evaluated(value: Any) -> bool:
    """Whether only the evaluator can make use of a value: a structure, a member of an enumeration."""
    return is_structure(value) or isinstance(value, Enum) and not isinstance(value, (int, str))


def _facts(state: ProgramVersion, forms: tuple[Form, ...], args: Sequence[Any], key: tuple[Any, ...]
           ) -> tuple[tuple[Fact, Any], ...]:
    """What must be known of the arguments before the run, as it is; `key` has what is demanded of such arguments."""
    demanded = state.entries.get(key)
    if not demanded:
        return ()
    values: dict[str, Any] = {}
    for name, form, value in zip(state.parameters, forms, args):
        map_leaves(form, value, name, lambda path, _, leaf: values.update({path: leaf}))
    for name, form, value in zip(state.parameters, forms, args):
        values.update(structures(form, value, name))
    values = {path: frozenset(v) if type(v) is set else v for path, v in values.items()}
    values.update({path: _UNNAMED for (path, what) in demanded if what == "value" and not isinstance(
        values[path], _NAMED)})
    return tuple((fact, _fact(fact, values)) for fact in demanded)


def _typed(value: Any) -> tuple[type, Any]:
    """What tells values apart that are equal: 1, True, an item of an IntEnum and NumPy's number."""
    return type(value), type(value)(map(_typed, value)) if type(value) in (frozenset, tuple) else value


def _dict_keys(form: Form) -> tuple[Any, ...]:
    """The keys of dicts, at all depths, told apart where they are equal."""
    if not isinstance(form, PyTree):
        return ()
    return tuple(map(_typed, form.keys)) if form.kind == "dict" else (), *map(_dict_keys, form.items)


def _fact(fact: Fact, values: Mapping[str, Any]) -> Any:
    """What is so of the value at a path: its shape, whether it is the one at another path, or the value."""
    path, what = fact
    if what.startswith("is "):
        return values[path] is values[what.removeprefix("is ")]
    return values[path].shape if what == "shape" else values[path]


def flat_call(state: ProgramVersion, f: Any, args: Sequence[Any], keywords: Mapping[str, Any] | None = None
                ) -> tuple[ProgramVersion, list[Any], Selection]:
    """The state and the values to work with, flat where there are structures, and what f carries in its names."""
    values = bind(state.kernel, args, keywords)
    flattened = flatten(state, values)
    if flattened is None:
        return state, values, selection_of(f)
    return flattened.state, flattened.values(values), flattened.carrier(f)[1].__s2sad_selection__


class Flattened(FlatSelection):
    """The flat program for arguments of one make, and the way there and back."""

    def __init__(self, state: ProgramVersion, forms: tuple[Form, ...], facts: tuple[tuple[Fact, Any], ...] = ()):
        self.facts = dict(facts)
        self.changed: frozenset[str] = frozenset()
        self.mutated: frozenset[str] = frozenset()
        self.live: frozenset[int] = frozenset()
        self.forms = dict(zip(state.parameters, forms))
        self.title, self.plain = state.kernel.name, state.kernel.independents
        kept = artifacts.load_residual(state.reading, state.function, forms, facts)
        if kept is None:
            self._take_apart(state, forms, facts)
        else:
            self.paths, self.cells, self.result = kept.paths, kept.cells, kept.result
            self.changed, self.mutated = kept.changed, kept.mutated
            self.state = ProgramVersion(kept.reading, state.function, True, lambda: self._flat(state, forms).program)
        self.names = {path: name for name, path in self.paths.items()}

    def _take_apart(self, state: ProgramVersion, forms: tuple[Form, ...], facts: tuple[tuple[Fact, Any], ...]) -> None:
        """Has it done by the compiler, and kept for other processes."""
        flat = self._flat(state, forms)
        program = flat.program
        self.paths, self.cells, self.result = flat.paths, flat.cells, flat.result
        self.changed, self.mutated, self.live = flat.changed, flat.mutated, flat.live
        reading = ReadRecord(program.kernels[program.entry], False, program.arrays, {}, program.guards, None,
                             program.warned)
        address = None if self.mutated and self.live else artifacts.store_residual(
            state.reading, state.function, forms, facts,
            KeptResidual(reading, self.paths, self.cells, self.result, self.changed, self.mutated))
        self.state = ProgramVersion(replace(reading, address=address), state.function, True).with_program(
            program, flat.normal)

    def _flat(self, state: ProgramVersion, forms: tuple[Form, ...]) -> Any:
        return compiler().flat_program(state.program, state.function, forms, state.guards.varying, self.facts)

    def prepared_for(self, state: ProgramVersion) -> Flattened:
        """The flat program of another reading of the function, with what was derived of this one."""
        found = Flattened(state, tuple(self.forms.values()), tuple(self.facts.items()))
        found.state.derive_as(self.state)
        return found

    def current(self) -> bool:
        """Whether all that was taken from outside is what it was."""
        return self.state.guards.hold()

    # -- there ---------------------------------------------------------------------------------------------------------

    def values(self, args: Sequence[Any]) -> list[Any]:
        """The flat arguments; a number that the kernel assigns is an array of one element."""
        found: list[Any] = []
        if self.cells:
            self._apart(args)
        if self.mutated:
            self._unshared(args)

        def add(path: str, kind: Type, leaf: Any) -> None:
            if is_held(kind):
                value = float(leaf) if kind == FLOAT else leaf
                found.append(np.array([value]) if self.names[path] in self.cells else value)
        for (parameter, form), value in zip(self.forms.items(), args):
            map_leaves(form, value, parameter, add)
        return found

    def _apart(self, args: Sequence[Any]) -> None:
        """Refuses a field that is passed twice and assigned: each name would have its own number."""
        seen: dict[tuple[int, str | int], str] = {}
        for name, _, holder, key in self.cell_holders(args, True):
            first = seen.setdefault((id(holder), key), name)
            if name != first and {name, first} & self.cells:
                raise S2sadError(Diagnostic("S404", f"'{self.paths[first]}' and '{self.paths[name]}' are one field of "
                                            "one object, and it is assigned", help="pass a copy of one of them"))

    def _unshared(self, args: Sequence[Any]) -> None:
        """Refuses an object that is given twice, or that the kernel reaches from outside, too, and changed."""
        seen: dict[int, str] = {}
        for (parameter, form), value in zip(self.forms.items(), args):
            for path, inner in structures(form, value, parameter):
                first = seen.setdefault(id(inner), path)
                if {path, first} & self.mutated and (path != first or id(inner) in self.live):
                    raise S2sadError(Diagnostic("S404", f"'{first}' and '{path}' are one object, which is changed"
                                                if path != first else f"'{path}' is changed, and is reached from "
                                                "outside, too", help="pass a copy"))

    def cell_holders(self, args: Sequence[Any], every: bool = False) -> Iterator[Holder]:
        """The cells, or every leaf, each with the structure that holds it, its kind and the key there."""
        for (parameter, form), value in zip(self.forms.items(), args):
            yield from self.cells_in(form, value, parameter, every)

    def write_back(self, args: Sequence[Any], flat: Mapping[str, Any]) -> None:
        """Gives the fields that the kernel assigns what their cells hold."""
        for name, kind, holder, key in self.cell_holders(args):
            assign_part(kind, holder, key, flat[name][0].item())

    def cells_in(self, form: Form, value: Any, path: str, every: bool = False) -> Iterator[Holder]:
        """The cells in one argument."""
        for key, item in zip(form.keys, form.items) if isinstance(form, PyTree) else ():
            assert isinstance(form, PyTree)
            inner = step(form, path, key)
            if isinstance(item, PyTree):
                yield from self.cells_in(item, part_of(form.kind, value, key), inner, every)
            elif self.names.get(inner) in (self.names.values() if every else self.cells):
                yield self.names[inner], form.kind, value, key

    @contextmanager
    def user_paths(self) -> Iterator[None]:
        """Errors name the caller's paths: state.u, not state_u."""
        try:
            yield
        except S2sadError as error:
            other = {n: p for n, p in self.paths.items() if n != p}
            if not other:
                raise
            pattern = re.compile(r"\b(" + "|".join(map(re.escape, sorted(other, key=len, reverse=True))) + r")\b")

            def with_paths(text: str) -> str:
                return pattern.sub(lambda m: other[m[1]], text)
            raise S2sadError(*(replace(d, message=with_paths(d.message), note=with_paths(d.note),
                                       help=with_paths(d.help))
                               for d in error.diagnostics)) from None

    # -- back ----------------------------------------------------------------------------------------------------------

    def with_floats(self, path: Path, args: Sequence[Any], found: Mapping[str, Any]) -> Any:
        """A part of the arguments with what was found in place of its floats; everything else as it is."""
        _, form, spelling = path
        return map_leaves(form, self.part(path, args), spelling,
                          lambda p, kind, leaf: self._new_leaf(p, kind, leaf, found))

    def _new_leaf(self, path: str, kind: Type, leaf: Any, found: Mapping[str, Any]) -> Any:
        name = self.names.get(path, "")
        if name not in found or not is_held(kind):
            return leaf
        return found[name][0].item() if name in self.cells else found[name]

    def part(self, path: Path, args: Sequence[Any]) -> Any:
        """The value of a part of the arguments."""
        root, *keys = steps(path[2]) or ("",)
        form, value = self.forms[str(root)], args[list(self.forms).index(str(root))]
        for key in keys:
            assert isinstance(form, PyTree)
            value, form = part_of(form.kind, value, key), form.items[form.keys.index(key)]
        return value

    def flat_parts(self, path: Path, value: Any, what: str, values: Mapping[str, Any]) -> dict[str, Any]:
        """A shadow, seed or tangent of something, by flat names; it must be of the same make."""
        name, form, spelling = path
        if not matches_form(form, value):
            what_form = "an array or a number" if isinstance(form, Type) else str(form)
            raise misfit(f"the {what} of '{name}' is of type {type(value).__name__} or has other parts: '{name}' is "
                         f"{what_form}", f"make one with s2sad.make_zero({name})")
        floats, fixed = set(self.floats(form, spelling)), {self.names[p] for p in places_of(form, spelling)}
        found: dict[str, Any] = {}

        def add(path: str, kind: Type, leaf: Any) -> None:
            flat = self.names.get(path, path)
            if flat in fixed and not np.array_equal(leaf, values[flat]):
                raise misfit(f"the {what} of '{name}' has its entries at other places than '{name}'",
                             f"make one with s2sad.make_zero({name})")
            if flat in floats:
                found[flat] = _cell_seed(leaf, values[flat], name, path) if flat in self.cells else leaf
        map_leaves(form, value, spelling, add)
        return found

    # -- results -------------------------------------------------------------------------------------------------------

    def result_seed(self, seed: Any) -> Any:
        """The seed of a structure that the kernel returns, as that of a tuple: None for what is no float."""
        found = self.result_leaves(seed)
        kinds = self._summary.results
        return tuple(s if t.is_inexact else None for s, t in zip(found, kinds)) if len(kinds) > 1 else found

    def result_leaves(self, seed: Any) -> Any:
        """A structure that is like what the kernel returns, as a tuple."""
        assert self.result is not None
        seed = _as_result(self.result, seed)
        if not matches_form(self.result, seed):
            raise misfit(f"the seed of 'return' is of type {type(seed).__name__} or has other parts: the result is "
                         f"{self.result}", "give a structure of the same make")
        found: list[Any] = []
        map_leaves(self.result, seed, RETURN, lambda path, kind, leaf: found.append(leaf) if is_held(kind) else None)
        return found[0] if len(found) == 1 else tuple(found)

    def result_of(self, returned: Any) -> Any:
        """What the kernel returns, put together."""
        assert self.result is not None
        count = sum(is_held(t) for _, t in leaves(self.result, RETURN))
        remaining = iter(returned if count > 1 else (returned,))
        return _unflatten(self.result, remaining)

    def flat_function(self, function: Callable[..., Any], args: Sequence[Any]) -> Callable[..., Any]:
        """The function, which takes structures like args, as one of flat arguments."""
        def called(*flat: Any) -> Any:
            by_name = dict(zip(self.paths, flat))
            own = [self.with_floats((p, form, p), args, by_name) for p, form in self.forms.items()]
            returned = function(*own)
            for name, kind, holder, key in self.cell_holders(own):
                by_name[name][0] = part_of(kind, holder, key)
            return returned if self.result is None else self.result_leaves(returned)
        return called


def _as_result(form: Form, value: Any) -> Any:
    """A seed with lists and tuples as in a result, and a None for each item of what is None as a whole."""
    if not isinstance(form, PyTree) or form.kind not in ("list", "tuple"):
        return value
    if value is None:
        value = (None,) * len(form.items)
    if type(value) not in (list, tuple):
        return value
    if len(value) != len(form.items):
        raise misfit(f"the seed of 'return' is a {type(value).__name__} of {len(value)}, the result is a {form.kind} "
                     f"of {len(form.items)}", f"give a {form.kind} of the same length, with None for what is no float")
    return (list if form.kind == "list" else tuple)(map(_as_result, form.items, value))


def _unflatten(form: Form, remaining: Iterator[Any]) -> Any:
    """A structure of leaves in order."""
    if isinstance(form, Type):
        found = next(remaining) if is_held(form) else None
        return float(found) if type(found) is np.float64 else found
    items = [_unflatten(i, remaining) for i in form.items]
    if form.kind == "named" and form.made is not None:
        return tuple.__new__(form.made, items)  # pyright: ignore[reportArgumentType]
    if form.kind == "dict":
        return dict(zip(form.keys, items))
    if form.kind == "record" and form.made is not None:
        new = object.__new__(form.made)
        for key, item in zip(form.keys, items):
            object.__setattr__(new, str(key), item)
        return new
    return items if form.kind == "list" else tuple(items)


def _cell_seed(value: Any, like: np.ndarray, name: str, path: str) -> np.ndarray:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, _NUMBERS[:4 + np.iscomplexobj(like)]):
        raise misfit(f"the part '{path}' of what was given for '{name}' is of type {type(value).__name__}, not a float",
                     "give a float")
    return np.array([value], like.dtype)
