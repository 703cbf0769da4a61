"""What a kernel writes and returns, and values in a row as tuples within tuples."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from s2sad.infer.types import Type

Structure = tuple[Any, ...] | None


@dataclass(frozen=True)
class EntrySummary:
    """What an entry writes and returns: names of parameters, types of results, results that are written arguments;
    whether it holds guards that arrays have one shape, how results are put into tuples, and which parameters must be
    contiguous."""
    written: tuple[str, ...]
    results: tuple[Type, ...]
    returned: dict[int, str]
    guarded: bool = False
    structure: Structure = None
    contiguous: tuple[str, ...] = ()


def leaves(structure: Any) -> list[Any]:
    """The single values of tuples within tuples, in order.

    >>> leaves(((1, 2), 3))
    [1, 2, 3]
    """
    return [leaf for item in structure for leaf in leaves(item)] if isinstance(structure, tuple) else [structure]


def nested(values: Iterable[Any], structure: Structure, made: Callable[[list[Any]], Any] = tuple) -> Any:
    """Values in a row as tuples within tuples.

    >>> nested([1, 2, 3], ((None, None), None))
    ((1, 2), 3)
    """
    left = iter(values)

    def take(part: Structure) -> Any:
        return next(left) if part is None else made([take(p) for p in part])
    return take(structure)
