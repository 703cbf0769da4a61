"""Calls of derivatives for many directions at once: their arrays have one more axis, the first.

A derivative for many takes them as its engine lays them out (`optimize/directions/layouts.py`): under Numba in blocks
of its width, the last of them filled with zeros; under NumPy in a list of all. Where there is none, the derivative for
one is called for each.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import misfit
from s2sad.dispatch.executable import Executable
from s2sad.dispatch.memory_reuse import CallCopies
from s2sad.infer.types import Type, misfit_of
from s2sad.interface.selection import RETURN, places, seeds_by_position
from s2sad.interface.value_calls import ForwardCall, PreparedCall, ReverseCall

WIDTHS = (4, 8, 12, 16)
_AT_A_TIME = 4096       # numbers of each direction that are copied


def width_for(count: int) -> int:
    """How many directions a derivative for Numba takes at once where so many are given."""
    return next((w for w in WIDTHS if count <= w), WIDTHS[-1])


# -- what is given ----------------------------------------------------------------------------------------------------

def directions(name: str, given: Any, kind: Type, shape: tuple[int, ...] | None) -> np.ndarray:
    """The directions of a value of this type, one after the other; raises S2sadError (S403) where they do not fit.
    The shape of a result is None: the generated text asks."""
    dtype = kind.dtype if kind.is_array else "complex128" if kind.is_complex else "float64"
    sizes = ", ".join(["k", *(map(str, shape) if shape is not None else ["..."] * kind.rank)])
    remedy = f"give an array of {dtype} of shape ({sizes}{',' if sizes == 'k' else ''}), k directions"
    if not isinstance(given, np.ndarray):
        raise misfit(f"the directions of '{name}' are of type {type(given).__name__}", remedy)
    if given.dtype != dtype or given.ndim != kind.rank + 1 or shape is not None and given.shape[1:] != shape:
        raise misfit(f"the directions of '{name}' are an array of {given.dtype} of shape {given.shape}", remedy)
    if (found := misfit_of(given, "seed")) is not None:
        raise misfit(f"the directions of '{name}' {found[0]}", remedy)
    return given


def count_of(given: Mapping[str, np.ndarray]) -> int:
    """How many directions there are, of each name as many."""
    if not given:
        raise misfit("no directions were given", 'give a dict by name: {"x": an array of shape (k, ...)}')
    first = next(iter(given))
    for name, found in given.items():
        if len(found) != len(given[first]):
            raise misfit(f"'{first}' has {len(given[first])} directions, '{name}' has {len(found)}",
                         "give all of them as many")
    return len(given[first])


# -- how they lie -----------------------------------------------------------------------------------------------------

class Lists:
    """For NumPy: a list of arrays or numbers."""

    def shadow(self, name: Any, like: Any, count: int, given: np.ndarray | None, kept: bool = True) -> list[Any]:
        """The directions of a value, zeros if none are given."""
        if given is not None:
            return [d.item() if not d.ndim else d for d in np.array(given, order="C")]
        return [np.zeros(like.shape, like.dtype) if isinstance(like, np.ndarray) else 0.0 * like for _ in range(count)]

    def found(self, value: Any, count: int) -> np.ndarray:
        """What a derivative has left for directions."""
        return np.array(value)

    own = found

    def add(self, shadow: Any, given: np.ndarray) -> None:
        for k, more in enumerate(given):
            shadow[k] += more


class Lanes:
    """For Numba: an array with the directions along its last axis, so many as its derivative takes."""

    def __init__(self, width: int, copies: CallCopies):
        self.width, self._copies = width, copies

    def shadow(self, name: Any, like: Any, count: int, given: np.ndarray | None, kept: bool = True) -> np.ndarray:
        """The directions of a value, zeros where none are given, in memory that is `kept` for the next call or not."""
        shape, dtype = np.shape(like) if given is None else given.shape[1:], getattr(given, "dtype", None)
        whole, kind = (*shape, self.width), np.dtype(dtype or getattr(like, "dtype", type(like)))
        if given is None and not kept:
            return np.zeros(whole, kind)
        made = self._copies.memory(("directions", name), whole, kind) if kept else np.empty(whole, kind)
        if given is None:
            made.fill(0)
        else:
            lanes = made.reshape(-1, self.width)
            _transpose(given.reshape(len(given), -1), lanes[:, :len(given)])
            lanes[:, len(given):] = 0
        return made

    def found(self, value: Any, count: int) -> np.ndarray:
        """What a derivative has left for directions."""
        made = np.empty((count, *value.shape[:-1]), value.dtype)
        _transpose(value.reshape(-1, self.width)[:, :count], made.reshape(count, -1))
        return made

    def own(self, value: Any, count: int) -> np.ndarray:
        """The same of memory that is not kept: a view, since a copy of large arrays takes as long as their derivative,
        unless that would hold more than twice the memory."""
        last = value.ndim - 1
        return value[..., :count].transpose(last, *range(last)) if 2 * count > self.width else self.found(value, count)

    def add(self, shadow: Any, given: np.ndarray) -> None:
        shadow[..., :len(given)] += np.moveaxis(given, 0, -1)


def _transpose(source: np.ndarray, target: np.ndarray) -> None:
    """Copies what has the directions along one axis to where they lie along the other, in parts that caches hold."""
    along = np.argmax(source.shape)
    for first in range(0, source.shape[along], _AT_A_TIME):
        part = slice(first, first + _AT_A_TIME)
        if along == 0:
            target[:, part] = source[part].T
        else:
            target[part] = source[:, part].T


def _blocks(count: int, width: int) -> Iterator[slice]:
    """The directions of each call."""
    for first in range(0, count, width):
        yield slice(first, min(first + width, count))


def _at_least_one(given: dict[Any, np.ndarray]) -> dict[Any, np.ndarray]:
    """The directions, one of zeros if there are none: what is found for it has a shape."""
    return {n: d if len(d) else np.zeros((1, *d.shape[1:]), d.dtype) for n, d in given.items()}


class BatchCall:
    """What a prepared call does with `count` directions: `many` takes them, None where they are taken one by one."""

    def __init__(self, call: PreparedCall, count: int, width: int | None = None):
        self.call, self.count = call, count
        chosen = width or width_for(count)
        self.many = call.many(chosen)
        in_lists = self.many is None or self.many.engine == "numpy"
        self._copies = CallCopies(call.kept)
        self.layout: Lists | Lanes = Lists() if in_lists else Lanes(chosen, self._copies)
        self.width = width or max(count, 1) if in_lists else chosen

    def run(self, one: Callable[[int], dict[str, Any]],
            block: Callable[[Executable, slice], dict[str, Any]]) -> dict[str, Any]:
        """What `block` finds for some directions at a time, or `one` for each, put together."""
        if self.many is not None:
            found = [block(self.many, part) for part in _blocks(max(self.count, 1), self.width)]
        else:
            found = [_with_axis(one(k)) for k in range(max(self.count, 1))]
        self._copies.end()
        return _joined(found, self.count)


def _with_axis(found: Any) -> Any:
    """The results for one direction as those for many."""
    if isinstance(found, dict):
        return {name: _with_axis(value) for name, value in found.items()}
    if isinstance(found, (tuple, list)):
        return type(found)(map(_with_axis, found))
    return None if found is None else np.array(found)[None]


def _joined(found: Sequence[Any], count: int) -> Any:
    """The results for all directions."""
    first = found[0]
    if isinstance(first, dict):
        return {name: _joined([f[name] for f in found], count) for name in first}
    if isinstance(first, (tuple, list)):
        return type(first)(_joined(parts, count) for parts in zip(*found))
    return None if first is None else first[:count] if len(found) == 1 else np.concatenate(found)


def _of_each(found: Any, turn: Callable[[Any], Any]) -> Any:
    if isinstance(found, tuple):        # a list is what NumPy's layout has for one result
        return tuple(_of_each(f, turn) for f in found)
    return None if found is None else turn(found)


# -- the two modes ----------------------------------------------------------------------------------------------------

def jvp(call: ForwardCall, args: Sequence[Any], tangents: Mapping[str, Any], width: int | None = None
        ) -> dict[str, Any]:
    """The tangents of the outputs along many directions."""
    values, kinds = call.values_of(args), dict(zip(call.names, call.types))
    by_name = dict(zip(call.names, values))
    given = {n: directions(n, tangents[n], kinds[n], np.shape(by_name[n])) for n in call.wrt}
    batch = BatchCall(call, count_of(given), width)
    given, seen = _at_least_one(given), {*call.requested} - {RETURN}

    def one(k: int) -> dict[str, Any]:
        return call.jvp(args, {n: _single(d, k) for n, d in given.items()})

    def block(many: Executable, part: slice) -> dict[str, Any]:
        held, count = dict(zip(call.names, call.private_copies(args, whole=True))), part.stop - part.start
        shadows = {n: batch.layout.shadow(n, held[n], count, given[n][part] if n in given else None, n not in seen)
                   for n in many.shadows}
        found = call.outputs(shadows, call.call(many, held, shadows), many.generated.returns)
        return {n: batch.layout.own(v, count) if n in seen else _of_each(v, lambda value: _leaf(batch, value, count))
                for n, v in found.items()}
    return batch.run(one, block)


def _leaf(batch: BatchCall, value: Any, count: int) -> np.ndarray:
    return np.zeros(count) if isinstance(value, float) else batch.layout.found(value, count)


def _single(given: np.ndarray, k: int) -> Any:
    """One of several directions."""
    found = given[k]
    return found if found.ndim else found.item()


def vjp(call: ReverseCall, args: Sequence[Any], seeds: Mapping[str, Any], width: int | None = None) -> dict[str, Any]:
    """The gradients for many seeds."""
    values, kinds = call.values_of(args), dict(zip(call.names, call.types))
    by_name = dict(zip(call.names, values))
    given = {n: directions(n, s, kinds[n], np.shape(by_name[n])) for n, s in seeds.items() if n != RETURN}
    results = {} if RETURN not in seeds else {
        k: directions(RETURN, s, call.results.types[k], None)
        for k, s in seeds_by_position(call.results, seeds[RETURN], call.results.floats).items()}
    several = len(call.results.types) > 1
    named = {f"{RETURN}[{k}]" if several else RETURN: s for k, s in results.items()}
    batch = BatchCall(call, count_of({**given, **named}), width)
    given, results = _at_least_one(given), _at_least_one(results)

    def one(k: int) -> dict[str, Any]:
        own = {n: _single(s, k) for n, s in given.items()}
        if RETURN in seeds:
            items = [_single(results[p], k) if p in results else None for p in range(len(call.results.types))]
            own[RETURN] = tuple(items) if several else items[0]
        return call.vjp(args, own)

    def block(many: Executable, part: slice) -> dict[str, Any]:
        held, count = dict(zip(call.names, call.private_copies(args, whole=True))), part.stop - part.start
        layout = batch.layout
        shadows = {n: layout.shadow(n, held[n], count, given[n][part] if n in given and n in call.of else None,
                                    n not in call.wrt) for n in many.shadows}
        by_place = {k: s[part] for k, s in results.items()}
        for place, name in call.results.aliases.items():
            if place in by_place:
                layout.add(shadows[name], by_place.pop(place))
        own = [layout.shadow(k, None, count, by_place[k]) for k in places([p.primal for p in many.seeds])]
        returned = dict(zip(many.generated.returns, call.call(many, held, shadows, own)))
        return {n: layout.own(shadows[n], count) if n in shadows else layout.found(returned[n], count)
                for n in call.wrt}
    if batch.many is not None:
        call.warn_of_zeros(batch.many)
    return batch.run(one, block)
