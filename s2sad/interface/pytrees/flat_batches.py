"""Structures whose floats have one more axis, the first: taken apart into one for each direction, and back."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import misfit
from s2sad.pytree import PyTree, form_of, map_leaves


def directions_of(given: Mapping[str, Any]) -> tuple[int, list[dict[str, Any]]]:
    """How many directions there are, and what is given by name for each; of none, one of zeros. Raises S2sadError
    (S403) where names have not as many."""
    counts: dict[str, int] = {}
    for name, value in given.items():
        changed_floats(value, lambda leaf, name=name: _count(counts, name, leaf))
    found = sorted(set(counts.values()))
    if not found:
        raise misfit("no directions were given", 'give a dict by name: {"x": an array of shape (k, ...)}')
    if len(found) > 1:
        first, other = list(counts)[0], next(n for n in counts if counts[n] != next(iter(counts.values())))
        raise misfit(f"'{first}' has {counts[first]} directions, '{other}' has {counts[other]}",
                     "give all of them as many")
    return found[0], [{n: changed_floats(v, lambda leaf, k=k: _one(leaf, k)) for n, v in given.items()}
                      for k in range(max(found[0], 1))]


def _count(counts: dict[str, int], name: str, leaf: np.ndarray) -> np.ndarray:
    if counts.setdefault(name, len(leaf)) != len(leaf):
        raise misfit(f"parts of '{name}' have {counts[name]} directions and {len(leaf)}", "give all of them as many")
    return leaf


def _one(leaf: np.ndarray, k: int) -> Any:
    found = leaf[k] if len(leaf) else np.zeros(leaf.shape[1:], leaf.dtype)
    return found if found.ndim else found.item()


def changed_floats(value: Any, change: Callable[[np.ndarray], Any]) -> Any:
    """A structure with something in place of its arrays of floats."""
    if isinstance(value, np.ndarray):
        return change(value) if value.ndim and value.dtype.kind in "fc" else value
    form = form_of(value, "")
    return map_leaves(form, value, "", lambda _, kind, leaf: changed_floats(leaf, change) if isinstance(
        leaf, np.ndarray) else leaf) if isinstance(form, PyTree) else value


def stacked(each: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Flat values of all directions, by name; tuples item by item."""
    return {n: _stacked([e[n] for e in each]) for n in each[0]}


def _stacked(values: Sequence[Any]) -> Any:
    first = values[0]
    if isinstance(first, tuple):
        return tuple(_stacked(items) for items in zip(*values))
    return np.array(values) if isinstance(first, (float, complex, np.ndarray, np.number)) else first


def apart(found: Mapping[str, Any], count: int) -> list[dict[str, Any]]:
    """What was found for all directions, for each."""
    return [{n: _at(v, k) for n, v in found.items()} for k in range(count)]


def _at(value: Any, k: int) -> Any:
    if isinstance(value, tuple):
        return tuple(_at(v, k) for v in value)
    return None if value is None else _one(value[k:k + 1], 0)


def together(each: Sequence[Mapping[str, Any]], count: int) -> dict[str, Any]:
    """Structures for each direction as structures whose floats have one more axis, of so many."""
    made = {name: _together([e[name] for e in each]) for name in each[0]}
    return made if count else {name: changed_floats(value, lambda leaf: leaf[:0]) for name, value in made.items()}


def _together(values: Sequence[Any]) -> Any:
    form = form_of(values[0], "")
    if not isinstance(form, PyTree):
        return _stacked(values)
    leaves: list[list[Any]] = [[] for _ in values]
    for mine, value in zip(leaves, values):
        map_leaves(form, value, "", lambda _, kind, leaf, mine=mine: mine.append(leaf))
    joined = iter([_stacked(of_all) for of_all in zip(*leaves)])
    return map_leaves(form, values[0], "", lambda *_: next(joined))

