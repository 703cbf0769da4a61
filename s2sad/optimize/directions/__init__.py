"""A finished derivative for many directions at once: the primal and its tape once, what depends on shadows for each.

In come the functions of a module, in the dialect of their engine; out go the same with more in their shadows. Who asks
gets `OneByOne` where a derivative has to be called for one direction at a time.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence

from s2sad.optimize.directions.dependent_names import OneByOne as OneByOne, Types, dependent_names
from s2sad.optimize.directions.direction_loops import direction_loops
from s2sad.infer.types import Type
from s2sad.tree import FunctionDef


def for_directions(functions: Sequence[FunctionDef], entry: str, given: Iterable[str], types: Types, engine: str,
                   width: int, results: Sequence[Type]) -> list[FunctionDef]:
    """The functions for `width` directions under Numba, for as many as are given under NumPy; of the entry, `given`
    are the shadows and seeds, `results` the types of what it returns for one direction."""
    return direction_loops(functions, dependent_names(functions, entry, given, types), entry, engine, width, results)
