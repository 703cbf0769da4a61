"""Linear maps at one point: what a derivative does to directions, of which a matrix is made.

    J v     the tangent (`jacobian_map`)
    w J     the adjoint
    H v     the adjoint of the tangent (`second_order`)

Directions lie beside each other: those of a product are the columns of an array, and so is what comes of them.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import Any, Protocol

import numpy as np


class LinearMap(Protocol):
    """A matrix that is known by its products; `taken` and `given` are the shapes that its columns and rows stand for,
    `dtype` that of its entries, `engine` what computes it."""
    taken: tuple[int, ...]
    given: tuple[int, ...]
    dtype: np.dtype[Any]
    engine: str

    def width(self, count: int | None, transposed: bool = False, measured: int | None = None) -> int:
        """How many directions a product has at once where `count` are asked for, by what was measured if that is
        known; None: where many are."""
        ...

    def widths(self, count: int, transposed: bool = False) -> Sequence[int]:
        """The widths among which measuring decides, that of `width` first; none where nothing is to be decided."""
        ...

    def products(self, directions: Iterable[np.ndarray], width: int, transposed: bool = False) -> Iterator[np.ndarray]:
        """The matrix (or the transposed one) times arrays of `width` columns. Each holds until the next is asked for.
        """
        ...


def size(shape: Sequence[int]) -> int:
    """The number of elements."""
    return int(np.prod(shape, dtype=np.int64))


def take_products(of: LinearMap, batches: int, directions: Callable[[range], Iterable[np.ndarray]], width: int,
                  transposed: bool, threads: int, take: Callable[[int, np.ndarray], None]) -> None:
    """Gives `take` the product of each batch of directions, by its number. Threads share the batches, each with memory
    of its own, so that a product is the same whatever their number; what must be compiled is for the first one."""
    def some(mine: range) -> None:
        for k, found in zip(mine, of.products(directions(mine), width, transposed)):
            take(k, found)
    alone = batches if threads == 1 or batches < 3 else 1
    some(range(alone))
    rest, parts = range(alone, batches), min(threads, batches - alone)
    if parts == 0:
        return
    with ThreadPoolExecutor(parts) as pool:
        asked = [pool.submit(copy_context().run, some, rest[k * len(rest) // parts:(k + 1) * len(rest) // parts])
                 for k in range(parts)]
    for found in asked:
        found.result()


def dense(of: LinearMap, mode: str, measured: int | None = None, threads: int = 1) -> np.ndarray:
    """The whole matrix, rows by columns: by columns for "forward", by rows for "reverse"."""
    forward = mode == "forward"
    made = np.empty((size(of.given), size(of.taken)), of.dtype)
    lines = made if forward else made.T
    count = lines.shape[1]
    width = of.width(count, not forward, measured)

    def take(k: int, found: np.ndarray) -> None:
        part = lines[:, k * width:(k + 1) * width]
        part[...] = found[:, :part.shape[1]]
    take_products(of, -(-count // width), lambda mine: _units(count, width, mine), width, not forward, threads, take)
    return made


def _units(count: int, width: int, batches: range) -> Iterator[np.ndarray]:
    """The unit vectors of these batches, so many at once, the last of them filled up with zeros."""
    made = np.zeros((count, width))
    for k in batches:
        ones = made[k * width:(k + 1) * width].reshape(-1)[::width + 1]
        ones[...] = 1.0
        yield made
        ones[...] = 0.0
