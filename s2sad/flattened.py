"""Calls with structures: taken apart into arrays and numbers at the door, and what comes back put together again.

    gradient(loss, wrt="p")(state, p)      the flat call's gradients of p_k, p_w  ->  a structure like p

The flat program is made once for what the arguments are made of (`normalize.fields`); everything behind it knows arrays
and numbers only.
"""
from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.binding import admitted, bind, describe, make_zero, misfit
from s2sad.diagnostics import Diagnostic, S2sadError, S2sadWarning
from s2sad.infer.types import FLOAT, NONE, UNKNOWN, Type, array
from s2sad.normalize.fields import Flat, fields
from s2sad.normalize.groups import Group, nothing
from s2sad.prepared import ForwardCall, ReverseCall, selection_of
from s2sad.selection import RETURN
from s2sad.structure import (
    Form, Structure, fits, form_of, is_held, is_structure, leaves, mapped, part_of, reached, step, steps,
    without_lengths,
)
from s2sad.variants import State

_PLAIN = frozenset((np.ndarray, float, int, bool, np.float64, type(None), str))
Path = tuple[str, Form, str]            # what the caller asked for, what it is, its path in one spelling


def flattened(state: State, args: Sequence[Any]) -> Flattened | None:
    """How a call with structures is taken apart; None if there is none among f's arguments and it asks for none."""
    if not state.asks and (_PLAIN.issuperset(map(type, args)) or not any(map(is_structure, args))):
        return None
    args = bind(state.kernel, args)
    forms = tuple(without_lengths(form_of(v, n)) for n, v in zip(state.parameters, args))
    key = ("flattened", forms)
    found = state.entries.get(key)
    if found is None:
        found = state.entries[key] = Flattened(state, forms)
    found.state.arrays = state.arrays
    return found


class Carrier:
    """What a differentiated function carries, in flat names."""

    def __init__(self, selection: tuple[Any, Any, str]):
        self.__s2sad_selection__ = selection


class Flattened:
    """The flat program for arguments of one make, and the way there and back."""

    def __init__(self, state: State, forms: tuple[Form, ...]):
        flat: Flat = fields(state.program, forms)
        self.forms = dict(zip(state.parameters, forms))
        self.cells, self.paths = flat.cells, flat.paths
        self.names = {path: name for name, path in flat.paths.items()}
        self.state = State(flat.program, state.function, flat=True)
        self.result = None if flat.result is None else _form_of_result(flat.result)
        self.title = state.kernel.name

    # -- there ---------------------------------------------------------------------------------------------------------

    def values(self, args: Sequence[Any]) -> list[Any]:
        """The flat arguments; a number that the kernel assigns is an array of one element."""
        found: list[Any] = []
        seen: dict[tuple[int, Any], np.ndarray] = {}

        def add(path: str, kind: Type, leaf: Any) -> None:
            if is_held(kind):
                name = self.names[path]
                found.append(_cell(self._number(name, leaf)) if name in self.cells else leaf)
        for (parameter, form), value in zip(self.forms.items(), args):
            mapped(form, value, parameter, add)
        self._same_cells(args, found, seen)
        return found

    def _number(self, name: str, leaf: Any) -> Any:
        return admitted(name, leaf, name in self.state.floats)

    def _same_cells(self, args: Sequence[Any], found: list[Any], seen: dict[tuple[int, Any], np.ndarray]) -> None:
        """A field of one object that is given twice is one cell."""
        if not self.cells:
            return
        places = {n: k for k, n in enumerate(self.paths)}
        for name, holder, key in self.holders(args):
            found[places[name]] = seen.setdefault((id(holder), key), found[places[name]])

    def holders(self, args: Sequence[Any]) -> Iterator[tuple[str, Any, str | int]]:
        """The cells, with the object that holds each and its key there."""
        for (parameter, form), value in zip(self.forms.items(), args):
            yield from self._holders(form, value, parameter)

    def _holders(self, form: Form, value: Any, path: str) -> Iterator[tuple[str, Any, str | int]]:
        for key, item in zip(form.keys, form.items) if isinstance(form, Structure) else ():
            assert isinstance(form, Structure)
            inner = step(form, path, key)
            if isinstance(item, Structure):
                yield from self._holders(item, part_of(form.kind, value, key), inner)
            elif self.names.get(inner) in self.cells:
                yield self.names[inner], value, key

    @contextmanager
    def told(self) -> Iterator[None]:
        """Errors name what the caller wrote: state.u, not state_u."""
        try:
            yield
        except S2sadError as error:
            other = {n: p for n, p in self.paths.items() if n != p}
            if not other:
                raise
            pattern = re.compile(r"\b(" + "|".join(map(re.escape, sorted(other, key=len, reverse=True))) + r")\b")

            def said(text: str) -> str:
                return pattern.sub(lambda m: other[m[1]], text)
            raise S2sadError(*(replace(d, message=said(d.message), note=said(d.note), help=said(d.help))
                               for d in error.diagnostics)) from None

    # -- names ---------------------------------------------------------------------------------------------------------

    def asked(self, names: Sequence[str] | None, what: str) -> list[Path]:
        """What names mean: a parameter, or a part of one; by default every parameter that holds a float."""
        if names is None:
            return [(p, f, p) for p, f in self.forms.items() if self.floats(f, p)]
        return [self._asked(n, what) for n in names]

    def _asked(self, name: str, what: str) -> Path:
        keys = steps(name)
        root = str(keys[0]) if keys else name
        if keys is None or root not in self.forms:
            raise _refused(f"{what} names '{name}', which is no parameter of '{self.title}'",
                           f"its parameters are {', '.join(self.forms)}")
        found = reached(self.forms[root], root, keys[1:])
        if found is None:
            parts = [path for path, _ in leaves(self.forms[root], root)]
            raise _refused(f"{what} names '{name}', and '{root}' has no such part",
                           f"its parts are {', '.join(parts[:12])}{', ...' if len(parts) > 12 else ''}")
        return name, *found

    def floats(self, form: Form, path: str) -> list[str]:
        """The flat names of the floats in something."""
        return [self.names[p] for p, t in leaves(form, path) if is_held(t) and (
            t.is_float or t.is_number and self.names[p] in self.state.floats)]

    def flat_names(self, paths: Sequence[Path], what: str) -> tuple[str, ...]:
        """The flat names of what was asked for."""
        found: list[str] = []
        for name, form, path in paths:
            own = self.floats(form, path)
            if isinstance(form, Structure) and not own:
                raise _refused(f"{what} names '{name}', which holds no float")
            found += own or [self.names.get(path, path)]
        return tuple(dict.fromkeys(found))

    def carried(self, f: Any) -> tuple[list[Path] | None, Carrier]:
        """What a differentiated function carries: its wrt, and all of it in flat names."""
        wrt, of, engine = selection_of(f)
        inputs = None if wrt is None else self.asked(wrt, "wrt")
        return inputs, Carrier((None if inputs is None else self.flat_names(inputs, "wrt"), self.outputs(of), engine))

    def outputs(self, of: Sequence[str] | None) -> tuple[str, ...] | None:
        """The flat names of outputs: of a structure what is written."""
        if of is None:
            return None
        found: list[str] = [RETURN] if RETURN in of else []
        for path in self.asked([n for n in of if n != RETURN], "of"):
            found += self.written(path)
        return tuple(dict.fromkeys(found))

    def written(self, path: Path) -> list[str]:
        """The floats in something that the kernel writes; a leaf of its own is given as it is."""
        name, form, spelling = path
        if isinstance(form, Type):
            return [self.names.get(spelling, spelling)]
        found = [n for n in self.floats(form, spelling) if n in self._summary.written]
        if not found:
            raise _refused(f"'{name}' is no output of '{self.title}', which writes no float in it")
        return found

    # -- back ----------------------------------------------------------------------------------------------------------

    def gathered(self, path: Path, args: Sequence[Any], found: Mapping[str, Any]) -> Any:
        """A part of the arguments with what was found in place of its floats; everything else as it is."""
        _, form, spelling = path
        return mapped(form, self.part(path, args), spelling, lambda p, kind, leaf: self._back(p, kind, leaf, found))

    def _back(self, path: str, kind: Type, leaf: Any, found: Mapping[str, Any]) -> Any:
        name = self.names.get(path, "")
        if name not in found or not is_held(kind):
            return leaf
        return float(found[name][0]) if name in self.cells else found[name]

    def part(self, path: Path, args: Sequence[Any]) -> Any:
        """The value of a part of the arguments."""
        keys = steps(path[2]) or ()
        form = self.forms[str(keys[0])]
        value = args[list(self.forms).index(str(keys[0]))]
        for key in keys[1:]:
            assert isinstance(form, Structure)
            value, form = part_of(form.kind, value, key), form.items[form.keys.index(key)]
        return value

    def spread(self, path: Path, given: Any, what: str, values: Mapping[str, Any]) -> dict[str, Any]:
        """A shadow, seed or tangent of something, by flat names; it must be of the same make."""
        name, form, spelling = path
        if not fits(form, given):
            what_form = "an array or a number" if isinstance(form, Type) else str(form)
            raise misfit(f"the {what} of '{name}' is of type {type(given).__name__} or has other parts: '{name}' is "
                         f"{what_form}", f"make one with s2sad.make_zero({name})")
        floats = set(self.floats(form, spelling))
        found: dict[str, Any] = {}

        def add(path: str, kind: Type, leaf: Any) -> None:
            flat = self.names.get(path, path)
            if flat in floats:
                found[flat] = _cell_seed(leaf, values[flat], name, path) if flat in self.cells else leaf
        mapped(form, given, spelling, add)
        return found

    # -- drivers -------------------------------------------------------------------------------------------------------

    def gradient(self, f: Any, args: Sequence[Any], names: Sequence[str] | None) -> tuple[Any, Any]:
        """The value, and the gradients as `gradient` gives them."""
        with self.told():
            asked, call, values = self._reverse(f, args, (RETURN,), names, True)
            shadows, returned = call.run(values, {RETURN: 1.0})
            found = self._answered(f, names, asked, call, args, call.gradients(shadows, returned))
        return returned[0], found[asked[0][0]] if len(asked) == 1 else found

    def vjp(self, f: Any, args: Sequence[Any], seeds: Mapping[str, Any], names: Sequence[str] | None) -> dict[str, Any]:
        with self.told():
            values = dict(zip(self.paths, self.values(args)))
            flat, kept = self._seeds(seeds, values)
            asked, call, ordered = self._reverse(f, args, tuple(flat), names, False)
            found = call.vjp(ordered, flat)
            for name, seed in kept.items():
                if name in found:
                    found[name] = found[name] + seed
            return self._answered(f, names, asked, call, args, found)

    def _seeds(self, seeds: Mapping[str, Any], values: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
        """The seeds of what is written, by flat names, and those of what stays as it is."""
        flat: dict[str, Any] = {}
        kept: dict[str, Any] = {}
        for name, seed in seeds.items():
            if name == RETURN:
                flat[RETURN] = seed if self.result is None else self.result_leaves(seed)
                continue
            path = self._asked(name, "seeds")
            written = self.written(path)
            for leaf, given in self.spread(path, seed, "seed", values).items():
                (flat if leaf in written else kept)[leaf] = given
            for leaf in written:
                flat.setdefault(leaf, seed)  # not a float: refused as any other
        return flat, kept

    def _reverse(self, f: Any, args: Sequence[Any], outputs: tuple[str, ...], names: Sequence[str] | None,
                 with_value: bool) -> tuple[list[Path], ReverseCall, list[Any]]:
        values = self.values(args)
        inputs, carrier = self.carried(f)
        asked = self.asked(names, "wrt") if names is not None or inputs is None else inputs
        wrt = self.flat_names(asked, "wrt") if asked else None
        key = ("reverse", with_value, outputs, wrt, carrier.__s2sad_selection__, describe(values))
        call = self.state.entries.get(key)
        if call is None:
            call = self.state.entries[key] = ReverseCall(self.state, carrier, tuple(values), outputs, wrt, with_value)
            call.in_vain = ()
        return asked, call, values

    def _answered(self, f: Any, names: Sequence[str] | None, asked: list[Path], call: ReverseCall,
                  args: Sequence[Any], found: Mapping[str, Any]) -> dict[str, Any]:
        lost = set(call.rv.generated.facts.get("independent", ()))
        explicit = names is not None or selection_of(f)[0] is not None
        for name, form, path in asked if explicit else ():
            if set(self.floats(form, path)) <= lost:
                message = f"no output asked for of '{self.title}' depends on '{name}': its gradient is zero"
                warnings.warn(message, S2sadWarning, stacklevel=4)
        return {path[0]: self.gathered(path, args, found) for path in asked}

    def jvp(self, f: Any, args: Sequence[Any], tangents: Mapping[str, Any], of: Sequence[str] | None) -> dict[str, Any]:
        with self.told():
            values = self.values(args)
            by_name = dict(zip(self.paths, values))
            flat: dict[str, Any] = {}
            for name, given in tangents.items():
                path = self._asked(name, "tangents")
                own = self.spread(path, given, "tangent", by_name)
                flat |= own or {self.flat_names([path], "tangents")[0]: given}
            _, carrier = self.carried(f)
            outputs = self.outputs(of)
            key = ("forward", tuple(flat), outputs, carrier.__s2sad_selection__, describe(values))
            call = self.state.entries.get(key)
            if call is None:
                call = self.state.entries[key] = ForwardCall(self.state, carrier, tuple(values), tuple(flat), outputs)
            found = call.jvp(values, flat)
            return self._tangents(args, of if of is not None else selection_of(f)[1], found, flat)

    def _tangents(self, args: Sequence[Any], of: Sequence[str] | None, found: dict[str, Any],
                  given: Mapping[str, Any]) -> dict[str, Any]:
        """The tangents of outputs: of what a structure holds and the kernel does not write, those that it had."""
        if of is None:
            roots = {self.paths[n].partition(".")[0].partition("[")[0] for n in found if n != RETURN}
            of = [*(p for p in self.forms if p in roots), *([RETURN] if RETURN in found else [])]
        answer: dict[str, Any] = {}
        for name in of:
            if name == RETURN:
                answer[name] = found[RETURN] if self.result is None else self.result_of(found[RETURN])
                continue
            path = self._asked(name, "of")
            floats = self.floats(path[1], path[2])
            held = {n: found.get(n, given.get(n)) for n in floats}
            zeros = {n: make_zero(v) for n, v in zip(self.paths, self.values(args)) if held.get(n, 0) is None}
            answer[name] = self.gathered(path, args, {**held, **zeros})
        return answer

    # -- results -------------------------------------------------------------------------------------------------------

    def result_leaves(self, seed: Any) -> Any:
        """The seed of a structure that the kernel returns, as that of a tuple."""
        assert self.result is not None
        if not fits(self.result, seed):
            raise misfit(f"the seed of 'return' is of type {type(seed).__name__} or has other parts: the result is "
                         f"{self.result}", "give a structure of the same make")
        found: list[Any] = []
        mapped(self.result, seed, RETURN, lambda path, kind, leaf: found.append(leaf) if is_held(kind) else None)
        return found[0] if len(found) == 1 else tuple(found)

    def result_of(self, returned: Any) -> Any:
        """What the kernel returns, put together."""
        assert self.result is not None
        count = sum(is_held(t) for _, t in leaves(self.result, RETURN))
        remaining = iter(returned if count > 1 else (returned,))
        return _built(self.result, remaining)

    @cached_property
    def _summary(self) -> Any:
        """What the kernel writes."""
        kinds = [t for p, f in self.forms.items() for _, t in leaves(f, p) if is_held(t)]
        types = [array(t.dtype, 1) if n in self.cells else FLOAT if n in self.state.floats and t.is_number else t
                 for n, t in zip(self.paths, kinds)]
        return self.state.summary(tuple(types))


def _form_of_result(group: Group) -> Form:
    items = tuple(_form_of_result(i) if isinstance(i, Group) else NONE if nothing(i) else UNKNOWN for i in group.items)
    return replace(group.form, items=items)


def _built(form: Form, remaining: Iterator[Any]) -> Any:
    """A structure whose leaves are given in order."""
    if isinstance(form, Type):
        return next(remaining) if is_held(form) else None
    items = [_built(i, remaining) for i in form.items]
    if form.kind == "named" and form.made is not None:
        return form.made._make(items)  # pyright: ignore[reportAttributeAccessIssue]
    if form.kind == "dict":
        return dict(zip(form.keys, items))
    if form.kind == "record" and form.made is not None:
        new = form.made.__new__(form.made)
        for key, item in zip(form.keys, items):
            object.__setattr__(new, str(key), item)
        return new
    return items if form.kind == "list" else tuple(items)


def _cell(value: Any) -> np.ndarray:
    return np.array([value])


def _cell_seed(given: Any, like: np.ndarray, name: str, path: str) -> np.ndarray:
    if isinstance(given, (bool, np.bool_)) or not isinstance(given, (int, float, np.integer, np.floating)):
        raise misfit(f"the part '{path}' of what was given for '{name}' is of type {type(given).__name__}, not a float",
                     "give a float")
    return np.array([given], like.dtype)


def _refused(message: str, remedy: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S401", message, help=remedy))
