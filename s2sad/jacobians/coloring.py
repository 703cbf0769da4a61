"""Colours of columns: those of one colour share no row, so that one product tells all of them.

Of a symmetric matrix an entry is told by its row or by its column: columns of one colour may share a row where each of
its entries there stands alone on the other side. As a graph, edges between two colours are stars. Greedy partial
distance-2 and star colouring: Gebremedhin, Manne and Pothen, What color is your Jacobian?, SIAM Review 47, 2005.
"""
from __future__ import annotations

from functools import cache
from importlib import util
from pathlib import Path
from typing import Any

import numpy as np

from s2sad.jacobians import entry_arrays
from s2sad.run.compiled import compiled


@cache
def loops(engine: str) -> Any:
    """The functions of `entry_loops`: compiled, and kept on disk, for Numba; those of `entry_arrays` for NumPy."""
    if engine == "numpy":
        return entry_arrays
    found = util.find_spec("s2sad.jacobians.entry_loops")
    assert found is not None and found.origin is not None
    return compiled(Path(found.origin).read_text(encoding="utf-8"), "entry_loops")


def colored(starts: np.ndarray, members: np.ndarray, others: np.ndarray, engine: str) -> np.ndarray:
    """The colours of columns, given by the lists of their rows, of which `others` are the starts by row: in natural
    order or the largest first, what needs fewer."""
    fit = loops(engine).first_fit
    natural = fit(starts, members, others, np.arange(len(starts) - 1))
    if count_of(natural) == np.diff(others).max(initial=0):     # fewer than a row has columns there cannot be
        return natural
    largest = fit(starts, members, others, np.argsort(-np.diff(starts), kind="stable"))
    return largest if count_of(largest) < count_of(natural) else natural


def star_colored(starts: np.ndarray, indices: np.ndarray, twins: np.ndarray, engine: str) -> np.ndarray:
    """The colours of the columns of a symmetric pattern, each entry of which stands at `twins` on the other side: those
    of a star colouring in natural order or the largest first, or of columns that share no row; what needs fewest."""
    fit, every = loops(engine).star_fit, np.arange(len(starts) - 1)
    largest = np.argsort(-np.diff(starts), kind="stable")
    return min((fit(starts, indices, twins, every), fit(starts, indices, twins, largest),
                colored(starts, indices, starts, engine)), key=count_of)


def starts_of(keys: np.ndarray, count: int) -> np.ndarray:
    """Where the list of each key from 0 to `count` starts, and where the last one ends.

    >>> starts_of(np.array([0, 2, 2]), 3)
    array([0, 1, 1, 3])
    """
    return np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=count))])


def count_of(colors: np.ndarray) -> int:
    """How many colours there are."""
    return int(colors.max(initial=-1)) + 1
