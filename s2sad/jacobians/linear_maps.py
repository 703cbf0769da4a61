"""Linear maps at one point: what a derivative does to directions, of which a matrix is made.

    J v     the tangent (`jacobian_map`)
    w J     the adjoint
    H v     the adjoint of the tangent (`second_order`)

Directions lie beside each other: those of a product are the columns of an array, and so is what comes of them.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol

import numpy as np


class LinearMap(Protocol):
    """A matrix that is known by its products; `taken` and `given` are the shapes that its columns and rows stand for,
    `dtype` that of its entries, `engine` what computes it."""
    taken: tuple[int, ...]
    given: tuple[int, ...]
    dtype: np.dtype[Any]
    engine: str

    def width(self, count: int | None, transposed: bool = False) -> int:
        """How many directions a product has at once where `count` are asked for; None: where many are."""
        ...

    def products(self, directions: Iterable[np.ndarray], width: int, transposed: bool = False) -> Iterator[np.ndarray]:
        """The matrix (or the transposed one) times arrays of `width` columns. Each holds until the next is asked for.
        """
        ...


def size(shape: Sequence[int]) -> int:
    """The number of elements."""
    return int(np.prod(shape, dtype=np.int64))


def dense(of: LinearMap, mode: str) -> np.ndarray:
    """The whole matrix, rows by columns: by columns for "forward", by rows for "reverse"."""
    forward = mode == "forward"
    made = np.empty((size(of.given), size(of.taken)), of.dtype)
    lines = made if forward else made.T
    width = of.width(lines.shape[1], not forward)
    products = of.products(_units(lines.shape[1], width), width, not forward)
    for first, found in zip(range(0, lines.shape[1], width), products):
        part = lines[:, first:first + width]
        part[...] = found[:, :part.shape[1]]
    return made


def _units(count: int, width: int) -> Iterator[np.ndarray]:
    """All unit vectors, so many at once, the last of them filled up with zeros."""
    made = np.zeros((count, width))
    for first in range(0, count, width):
        ones = made[first:first + width].reshape(-1)[::width + 1]
        ones[...] = 1.0
        yield made
        ones[...] = 0.0
