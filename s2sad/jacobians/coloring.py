"""Colours of columns: those of one colour share no row, so that one product tells all of them.

Greedy partial distance-2 colouring: Gebremedhin, Manne and Pothen, What color is your Jacobian?, SIAM Review 47, 2005.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np


def grouped(keys: np.ndarray, values: np.ndarray, count: int) -> list[list[int]]:
    """The values of each key from 0 to count, in order."""
    order = np.argsort(keys, kind="stable")
    ends = np.cumsum(np.bincount(keys, minlength=count))[:-1]
    return [part.tolist() for part in np.split(values[order], ends)]


def greedy(columns: Sequence[Sequence[int]], rows: int, order: Iterable[int] | None = None) -> np.ndarray:
    """A colour for each column, given by its rows: the first that no column has with which it shares a row.

    >>> greedy([[0], [0, 1], [1]], 2)
    array([0, 1, 0])
    """
    taken = [0] * rows          # the colours of a row's columns, as bits
    colors = np.zeros(len(columns), int)
    for column in range(len(columns)) if order is None else order:
        near = 0
        for row in columns[column]:
            near |= taken[row]
        free = ~near & (near + 1)
        for row in columns[column]:
            taken[row] |= free
        colors[column] = free.bit_length() - 1
    return colors


def colored(keys: np.ndarray, values: np.ndarray, count: int, rows: int) -> np.ndarray:
    """The colours of the columns `keys` with rows `values`: in natural order or the largest first, what needs fewer."""
    columns = grouped(keys, values, count)
    natural = greedy(columns, rows)
    largest = greedy(columns, rows, np.argsort([-len(c) for c in columns], kind="stable"))
    return largest if largest.max(initial=0) < natural.max(initial=0) else natural
