"""The sparsity pattern of a linear map, from products with nan: what depends on a column is nan where the column is.

Columns are asked for in blocks, which are halved until each has one column. Blocks that no row shares are asked for
at once: they have one colour, and a row tells by which of them it is nan. A stencil of k colours takes some 2 k log2(n)
products. A product of nan is nan whatever its partial, zero too, so that the pattern is that of the way that the run
takes, and not of the values on it; only where a partial may be infinite, and is exactly zero, its column is not seen.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from s2sad.jacobians.coloring import greedy, grouped
from s2sad.jacobians.linear_maps import LinearMap, size


@dataclass
class Blocks:
    """Ranges of columns, and the pairs of rows and blocks that depend on each other."""
    starts: np.ndarray
    ends: np.ndarray
    rows: np.ndarray
    blocks: np.ndarray


def pattern_of(of: LinearMap) -> tuple[np.ndarray, np.ndarray]:
    """The rows and columns of the entries that can be other than zero, sorted by rows."""
    rows, columns = size(of.given), size(of.taken)
    with np.errstate(all="ignore"):
        first = np.flatnonzero(np.isnan(of.product(np.full(columns, np.nan)))) if rows and columns else np.zeros(0, int)
        found = Blocks(np.array([0]), np.array([columns]), first, np.zeros(len(first), int))
        while len(found.rows) and (found.ends - found.starts).max() > 1:
            found = _halved(of, found, rows, columns)
    order = np.lexsort((found.blocks, found.rows))
    return found.rows[order], found.starts[found.blocks[order]]


def _halved(of: LinearMap, whole: Blocks, rows: int, columns: int) -> Blocks:
    """The blocks in halves, and which rows depend on each; blocks of one column stay."""
    middle = (whole.starts + whole.ends + 1) // 2
    wide = whole.ends - whole.starts > 1
    left = np.cumsum(1 + wide) - 1 - wide
    starts, ends = np.empty(int((1 + wide).sum()), int), np.empty(int((1 + wide).sum()), int)
    starts[left], ends[left] = whole.starts, middle
    starts[left[wide] + 1], ends[left[wide] + 1] = middle[wide], whole.ends[wide]
    halves = np.repeat(np.arange(len(starts)), ends - starts)     # of each column
    stay = ~wide[whole.blocks]
    made = [(whole.rows[stay], left[whole.blocks[stay]])]
    colors = greedy(grouped(whole.blocks, whole.rows, len(whole.starts)), rows)
    for color in range(colors.max() + 1):
        mine = colors[whole.blocks] == color
        owner = np.full(rows, -1)
        owner[whole.rows[mine]] = whole.blocks[mine]
        blocks = np.flatnonzero((colors == color) & wide)
        for side in (0, 1) if len(blocks) else ():
            asked = np.zeros(len(starts), bool)
            asked[left[blocks] + side] = True
            hit = np.flatnonzero(np.isnan(of.product(np.where(asked[halves], np.nan, 0.0))))
            hit = hit[(owner[hit] >= 0) & wide[owner[hit]]]
            made.append((hit, left[owner[hit]] + side))
    return Blocks(starts, ends, np.concatenate([r for r, _ in made]), np.concatenate([b for _, b in made]))
