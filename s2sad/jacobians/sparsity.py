"""The sparsity pattern of a linear map, from products with nan: what depends on a column is nan where the column is.

Columns are asked for in blocks, which are parted until each has one column. Blocks that no row shares are asked for at
once: they have one colour, and a row tells by which of them it is nan; several colours, and several parts of a block,
are asked for by the directions of one batch. A stencil of k colours takes some 2 k log2(n) products. Rows that have far
more blocks than all others are asked for by themselves: one adjoint tells a row. A product of nan is nan whatever its
partial, zero too, so that the pattern is that of the way that the run takes, and not of the values on it; only where a
partial may be infinite, and is exactly zero, its column is not seen.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from s2sad.diagnostics import S2sadError
from s2sad.jacobians.coloring import count_of, loops, starts_of
from s2sad.jacobians.linear_maps import LinearMap, size

_GAIN = 16      # products that are spared where rows are asked for by themselves


@dataclass
class Blocks:
    """Ranges of columns, from each of `bounds` to the next, and which rows depend on each: its list among `rows`."""
    bounds: np.ndarray
    starts: np.ndarray
    rows: np.ndarray

    def without(self, rows: np.ndarray, count: int) -> Blocks:
        """The blocks without some of the rows, of which there are so many."""
        gone = np.zeros(count, bool)
        gone[rows] = True
        kept, owner = ~gone[self.rows], np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        return Blocks(self.bounds, starts_of(owner[kept], len(self.starts) - 1), self.rows[kept])


def pattern_of(of: LinearMap) -> tuple[np.ndarray, np.ndarray]:
    """The entries that can be other than zero, by rows (CSR): where each row's columns start, and the columns."""
    rows, columns = size(of.given), size(of.taken)
    found, alone = Blocks(np.array([0, columns]), np.array([0, rows]), np.arange(rows)), np.zeros(0, int)
    starts, members, done = np.zeros(rows + 1, int), np.zeros(0, int), columns == 0
    with np.errstate(all="ignore"):
        while len(found.rows) and not done:
            found = _parted(of, found, rows, columns)
            done = len(found.bounds) == columns + 1
            if done:
                starts, members = loops(of.engine).turned(found.starts, found.rows, rows)
            elif len(long := _long_rows(of, found, rows)):
                alone, found = np.concatenate([alone, long]), found.without(long, rows)
        return _with_rows(of, starts, members, alone) if len(alone) else (starts, members)


def _long_rows(of: LinearMap, found: Blocks, rows: int) -> np.ndarray:
    """Rows that take fewer products by themselves, two tangents for each, than their blocks have colours."""
    hits = np.bincount(found.rows, minlength=rows)
    most = np.append(-np.sort(-hits), 0)        # of the rows that are left, where so many are gone
    costs = most + 2 * np.arange(rows + 1)
    best = int(costs.argmin())
    if costs[0] - costs[best] < _GAIN or not _has_adjoint(of):
        return np.zeros(0, int)
    return np.flatnonzero(hits > most[best])


def _has_adjoint(of: LinearMap) -> bool:
    try:
        return of.width(None, True) > 0
    except S2sadError:      # there are tangents only
        return False


def _with_rows(of: LinearMap, starts: np.ndarray, members: np.ndarray, alone: np.ndarray
               ) -> tuple[np.ndarray, np.ndarray]:
    """The pattern with these rows, which have none in it, from an adjoint for each."""
    lanes = np.full(len(starts) - 1, -1)
    lanes[alone] = np.arange(len(alone))
    columns, which = np.nonzero(_told(of, lanes, len(alone), True)[:, :len(alone)])
    keys = np.concatenate([np.repeat(np.arange(len(starts) - 1), np.diff(starts)), alone[which]])
    order = np.argsort(keys, kind="stable")
    return starts_of(keys, len(starts) - 1), np.concatenate([members, columns])[order]


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


def _told(of: LinearMap, lanes: np.ndarray, count: int, transposed: bool = False) -> np.ndarray:
    """Where products are nan, for `count` directions in which the columns, or the rows, of one lane each are."""
    width = of.width(None, transposed)

    def directions() -> Iterator[np.ndarray]:
        made = np.empty((len(lanes), width))
        for first in range(0, count, width):
            made.fill(0.0)
            mine = np.flatnonzero((lanes >= first) & (lanes < first + width))
            made[mine, lanes[mine] - first] = np.nan
            yield made
    return np.concatenate([np.isnan(found) for found in of.products(directions(), width, transposed)], axis=1)
