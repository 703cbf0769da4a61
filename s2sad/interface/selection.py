"""What is differentiated with respect to what: defaults, and the refusal of names that cannot be meant."""
from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from s2sad.dispatch.arguments import misfit
from s2sad.dispatch.cache import private_copy
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.types import Type, misfit_of
from s2sad.live_objects.unwrap import python_function
from s2sad.program import Recording

RETURN = "return"
Wrt = str | int | Iterable[str | int] | None
Copied = Callable[[Any, np.ndarray], np.ndarray]      # of a place and the array that is copied for it


class Selection(NamedTuple):
    """What a differentiated function carries."""
    wrt: tuple[str, ...] | None = None
    of: tuple[str, ...] | None = None
    engine: str = "auto"
    recording: Recording = Recording()


@dataclass(frozen=True)
class ReturnedValues:
    """The returned values: `floats` are the positions that have derivatives, `own` those that are no written
    argument, `aliases` the written argument at each other position, `arguments` the argument at each that has one."""
    types: tuple[Type, ...]
    floats: tuple[int, ...]
    own: tuple[int, ...]
    aliases: dict[int, str]
    arguments: dict[int, str]

    @classmethod
    def of(cls, summary: Any) -> ReturnedValues:
        types = tuple(summary.results)
        floats = tuple(k for k, t in enumerate(types) if t.is_inexact)
        aliases = {k: name for k, name in summary.returned.items() if k in floats and name in summary.written}
        return cls(types, floats, tuple(k for k in floats if k not in aliases), aliases, dict(summary.returned))

    def with_aliases(self, returned: Any, values: dict[str, Any]) -> Any:
        """What the function returned, with the caller's own arrays where it returned an argument."""
        if len(self.types) < 2:
            return values[self.arguments[0]] if self.arguments else returned
        return tuple(values[self.arguments[k]] if k in self.arguments else v for k, v in enumerate(returned))

    def structure(self, by_place: dict[int, Any]) -> Any:
        """The tangent of the returned value: as the value is, 0.0 where it depends on nothing, None where no float."""
        items = tuple(by_place.get(k, 0.0) if k in self.floats else None for k in range(len(self.types)))
        return items if len(items) > 1 else items[0] if items else None


def places(names: Sequence[str]) -> tuple[int, ...]:
    """The positions of the results that are named "return 0", "return 1", ..."""
    return tuple(int(name.partition(" ")[2]) for name in names)


def seeds_by_position(results: ReturnedValues, seed: Any, seeded: Sequence[int]) -> dict[int, Any]:
    """The seed of the returned value by position: a tuple of the same length for a tuple, None where `seeded` lacks
    the position."""
    if len(results.types) < 2:
        return {0: seed}
    seed = items_of_seed(seed, len(results.types))
    for place, item in enumerate(seed):
        if place not in seeded and item is not None:
            raise misfit(f"the seed of 'return' has a value at {place}, where the result is no float",
                         "give None there")
    return {place: seed[place] for place in seeded}


def items_of_seed(seed: Any, count: int) -> Sequence[Any]:
    """The seeds of several results; None for all where nothing is a float."""
    if seed is None:
        return (None,) * count
    if not isinstance(seed, (tuple, list)) or len(seed) != count:
        kind = type(seed).__name__
        what = f"a {kind} of {len(seed)}" if isinstance(seed, (tuple, list)) else f"of type {kind}"
        raise misfit(f"the seed of 'return' is {what}, the result is a tuple of {count}",
                     "give a tuple of the same length, with None for what is no float")
    return seed


def number_seed(seed: Any, name: str = RETURN, is_complex: bool = False) -> float | complex:
    """The seed of a float or complex result, or the tangent of such an argument."""
    if isinstance(seed, np.ndarray) and not seed.ndim:     # what NumPy gives where a contraction leaves no axis
        seed = seed[()]
    if is_complex and isinstance(seed, complex):
        return np.complex128(seed)
    if isinstance(seed, (bool, np.bool_)) or not isinstance(seed, (int, float, np.integer, np.floating)):
        wanted = "a complex number" if is_complex else "a float"
        raise misfit(f"the seed of '{name}' is of type {type(seed).__name__}, not {wanted}", f"give {wanted}")
    return np.complex128(seed) if is_complex else float(seed)


def result_seed(seed: Any, kind: Type) -> Any:
    """The seed of a result: a float, or a private copy of an array of the result's dtype and rank; whether it has the
    result's shape shows when that is there."""
    if kind.is_number:
        return number_seed(seed, is_complex=kind.is_complex)
    remedy = f"give an array of {kind.dtype} with {kind.rank} {'axis' if kind.rank == 1 else 'axes'}"
    if not isinstance(seed, np.ndarray):
        raise misfit(f"the seed of '{RETURN}' is of type {type(seed).__name__}, the result is an array", remedy)
    if seed.dtype != kind.dtype or seed.ndim != kind.rank:
        raise misfit(f"the seed of '{RETURN}' is an array of {seed.dtype} of shape {seed.shape}, the result one of "
                     f"{kind.dtype} with {kind.rank} {'axis' if kind.rank == 1 else 'axes'}", remedy)
    if (found := misfit_of(seed, "seed")) is not None:
        raise misfit(f"the seed of '{RETURN}' {found[0]}", remedy)
    return np.array(seed, order="C")


def array_seed(name: str, seed: Any, like: np.ndarray, copied: Copied | None = None) -> np.ndarray:
    """A private copy of an array seed, which must have the dtype and shape of its output; `copied` makes it."""
    if not isinstance(seed, np.ndarray):
        raise misfit(f"the seed of '{name}' is of type {type(seed).__name__}, its output is an array",
                     f"give an array of {like.dtype} of shape {like.shape}")
    if seed.dtype != like.dtype or seed.shape != like.shape:
        raise misfit(f"the seed of '{name}' is an array of {seed.dtype} of shape {seed.shape}, its output one of "
                     f"{like.dtype} of shape {like.shape}", f"give an array of {like.dtype} of shape {like.shape}")
    if (found := misfit_of(seed, "seed")) is not None:
        raise misfit(f"the seed of '{name}' {found[0]}", f"give an array of {like.dtype} of shape {like.shape}")
    return private_copy(seed) if copied is None else copied(("seed", name), seed)


def uncopied(place: Any, array: np.ndarray) -> np.ndarray:
    """An array as it is, or a copy that is in C order."""
    return array if array.flags.carray else private_copy(array)


def names_of(chosen: Wrt, f: Any, what: str = "wrt") -> tuple[str, ...] | None:
    """One name or several as a tuple; a position among f's parameters becomes its name."""
    if chosen is None or isinstance(chosen, str):
        return None if chosen is None else (chosen,)
    if type(chosen) is tuple and all(type(n) is str for n in chosen):
        return chosen
    several = chosen if isinstance(chosen, Iterable) and not isinstance(chosen, np.ndarray) else (chosen,)
    return tuple(_name_at(n, f, what) for n in several)


def _name_at(place: Any, f: Any, what: str) -> str:
    if isinstance(place, str):
        return place
    if isinstance(place, bool) or not isinstance(place, (int, np.integer)):
        word = type(place).__name__
        raise _refused(f"{what} holds {'an' if word[0] in 'aeiou' else 'a'} {word}",
                       'give names of parameters, or their positions: "x", 0, ("x", "y")')
    function = python_function(f)
    names = list(inspect.signature(function).parameters) if function is not None else []
    if not -len(names) <= place < len(names):
        raise _refused(f"{what} names the parameter at {place}, and '{getattr(function, '__name__', f)}' has "
                       f"{len(names)}", f"its parameters are {', '.join(names)}")
    return names[place]


def selected_wrt(function: str, parameters: Sequence[str], types: Sequence[Type],
                 wrt: tuple[str, ...] | None) -> tuple[str, ...]:
    """The independents in the order of the signature; default: every float array and float scalar."""
    kinds = dict(zip(parameters, types))
    if wrt is None:
        found = tuple(p for p in parameters if kinds[p].is_inexact)
        if not found:
            raise _refused(f"'{function}' was given no float to differentiate with respect to", *_unreal(kinds))
        return found
    for name in wrt:
        if name not in kinds:
            raise _refused(f"wrt names '{name}', which is no parameter of '{function}'",
                           f"its parameters are {', '.join(parameters)}")
        if not kinds[name].is_inexact:
            raise _refused(f"wrt names '{name}', which is {_described(kinds[name])}", _remedy(name, kinds[name]))
    return tuple(p for p in parameters if p in wrt)


def selected_of(function: str, parameters: Sequence[str], types: Sequence[Type], summary: Any,
                of: tuple[str, ...] | None) -> tuple[str, ...]:
    """The dependents: names of written float arrays, in order, then "return" for results of their own; a returned
    argument goes by its name."""
    results = ReturnedValues.of(summary)
    written = [p for p, t in zip(parameters, types) if p in summary.written and t.is_inexact and t.is_array]
    if of is None:
        found = (*written, *((RETURN,) if results.own else ()))
        if not found:
            integers = {p: t for p, t in zip(parameters, types) if p in summary.written}
            raise _refused(f"'{function}' has nothing to differentiate: it writes no float array and returns no float",
                           *_unreal(integers))
        return found
    for name in of:
        _check_output(function, name, dict(zip(parameters, types)), written, summary.written, results)
    wanted = set(of)
    if RETURN in of:
        wanted.update(results.aliases.values())
        if not results.own:
            wanted.discard(RETURN)
    return (*(p for p in written if p in wanted), *((RETURN,) if RETURN in wanted else ()))


def _check_output(function: str, name: str, kinds: dict[str, Type], floats: Sequence[str], written: Sequence[str],
                  results: ReturnedValues) -> None:
    known = [*floats, *([RETURN] if results.floats else [])]
    remedy = f"its outputs are {', '.join(known)}" if known else ""
    if name == RETURN:
        if not results.floats:
            raise _refused(f"'{function}' returns no float", remedy)
    elif name not in kinds:
        raise _refused(f"'{name}' is no output of '{function}'", remedy)
    elif name not in written:
        raise _refused(f"'{name}' is no output of '{function}', which does not write it", remedy)
    elif name not in floats:
        raise _refused(f"the output '{name}' of '{function}' is {_described(kinds[name])}", _remedy(name, kinds[name]))


def _described(type_: Type) -> str:
    if type_.is_array:
        return f"an array of {type_.dtype}"
    if type_.is_integer:
        return "a bool" if type_.dtype == "bool" else "an integer"
    return {"none": "None", "text": "a str"}.get(type_.kind, f"of type {type_}")


def _unreal(kinds: dict[str, Type]) -> tuple[str, str]:
    """Of the first argument that may have been meant to hold floats: what to give instead, and what it is."""
    for name, type_ in kinds.items():
        if (type_.is_array or type_.is_integer) and type_.dtype != "bool":
            return _remedy(name, type_), f"'{name}' is {_described(type_)}"
    return "", ""


def _remedy(name: str, type_: Type) -> str:
    if type_.is_array:
        return f"pass {name}.astype(float) if it holds real quantities"
    return "give a float (3.0, not 3) if it is a real quantity" if type_.is_integer else ""


def _refused(message: str, remedy: str = "", note: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S401", message, note=note, help=remedy))
