"""The sparsity pattern of a linear map, from products with nan: what depends on a column is nan where the column is.

Columns are asked for in blocks, which are parted until each has one column. Blocks that no row shares are asked for at
once: they have one colour, and a row tells by which of them it is nan; several colours, and several parts of a block,
are asked for by the directions of one batch. A stencil of k colours takes some 2 k log2(n) products. A product of nan
is nan whatever its partial, zero too, so that the pattern is that of the way that the run takes, and not of the values
on it; only where a partial may be infinite, and is exactly zero, its column is not seen.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from s2sad.jacobians.coloring import count_of, loops, starts_of
from s2sad.jacobians.linear_maps import LinearMap, size


@dataclass
class Blocks:
    """Ranges of columns, from each of `bounds` to the next, and which rows depend on each: its list among `rows`."""
    bounds: np.ndarray
    starts: np.ndarray
    rows: np.ndarray


def pattern_of(of: LinearMap) -> tuple[np.ndarray, np.ndarray]:
    """The entries that can be other than zero, by rows (CSR): where each row's columns start, and the columns."""
    rows, columns = size(of.given), size(of.taken)
    found = Blocks(np.array([0, columns]), np.array([0, rows]), np.arange(rows))
    with np.errstate(all="ignore"):
        while len(found.rows) and columns:
            found = _parted(of, found, rows, columns)
            if len(found.bounds) == columns + 1:
                return loops(of.engine).turned(found.starts, found.rows, rows)
    return np.zeros(rows + 1, int), np.zeros(0, int)


def _parted(of: LinearMap, whole: Blocks, rows: int, columns: int) -> Blocks:
    """The blocks in parts, and which rows depend on each."""
    colors = loops(of.engine).first_fit(whole.starts, whole.rows, starts_of(whole.rows, rows),
                                        np.arange(len(whole.starts) - 1))
    sizes = np.diff(whole.bounds)
    most = min(max(2, of.width(None) // count_of(colors)), int(sizes.max()))
    parts = np.minimum(sizes, most)
    owner = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    bounds = np.append(whole.bounds[owner] + sizes[owner] * part // parts[owner], columns)
    lanes = np.repeat(colors[owner] * most + part, np.diff(bounds))
    told = _told(of, lanes, count_of(colors) * most)
    return Blocks(bounds, *loops(of.engine).parted(whole.starts, whole.rows, colors * most, parts, told))


def _told(of: LinearMap, lanes: np.ndarray, count: int) -> np.ndarray:
    """Where products are nan, for `count` directions in which the columns of one lane each are."""
    width = of.width(None)

    def directions() -> Iterator[np.ndarray]:
        made = np.empty((len(lanes), width))
        for first in range(0, count, width):
            made.fill(0.0)
            mine = np.flatnonzero((lanes >= first) & (lanes < first + width))
            made[mine, lanes[mine] - first] = np.nan
            yield made
    return np.concatenate([np.isnan(found) for found in of.products(directions(), width)], axis=1)
