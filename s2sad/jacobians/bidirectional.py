"""Colours of columns and of rows at once: what is dense goes the one way, the rest the other.

    * * * * *       one product with a row of ones tells the first row, one with the first column that column, one with
    * *             all others together the diagonal: of an arrow of any size 3 products tell all entries, of its
    *   *           columns alone, or of its rows, as many as it has
    *     *
    *       *

Hossain and Steihaug, Computing a sparse Jacobian matrix by rows and columns, Optim. Methods Softw. 10, 1998; Coleman
and Verma, The efficient computation of sparse Jacobian matrices using automatic differentiation, SIAM J. Sci. Comput.
19, 1998.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from s2sad.jacobians.coloring import colored, count_of, loops, starts_of


@dataclass(frozen=True, eq=False)
class Pattern:
    """The entries of a matrix, by rows: where the list of each starts, and the columns; `width` is their number."""
    starts: np.ndarray
    members: np.ndarray
    width: int
    engine: str

    @property
    def lines(self) -> np.ndarray:
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))

    @property
    def longest(self) -> int:
        """The most entries of a row: its columns have as many colours."""
        return int(np.diff(self.starts).max(initial=0))

    def turned(self) -> Pattern:
        """The same by columns."""
        starts, members = loops(self.engine).turned(self.starts, self.members, self.width)
        return Pattern(starts, members, len(self.starts) - 1, self.engine)

    def only(self, kept: np.ndarray) -> Pattern:
        """The entries of some of the rows: the others are empty."""
        chosen = kept[self.lines]
        return Pattern(starts_of(self.lines[chosen], len(kept)), self.members[chosen], self.width, self.engine)


@dataclass(frozen=True, eq=False)
class Colors:
    """The colours of columns and of rows, -1 for those that no product has."""
    columns: np.ndarray
    rows: np.ndarray

    def cost(self, adjoint: int) -> int:
        """How many products there are, where one with a row counts as several."""
        return count_of(self.columns) + adjoint * count_of(self.rows)

    def turned(self) -> Colors:
        return Colors(self.rows, self.columns)

    @property
    def mode(self) -> str:
        by_column, by_row = count_of(self.columns), count_of(self.rows)
        return "both" if by_column and by_row else "reverse" if by_row else "forward"


def by_columns(pattern: Pattern, turned: Pattern) -> Colors:
    """Columns of one colour share no row."""
    return Colors(colored(turned.starts, turned.members, pattern.starts, pattern.engine),
                  np.full(len(pattern.starts) - 1, -1))


def fewest(pattern: Pattern, adjoint: int) -> Colors:
    """The colours that take the fewest products, of which one with a row counts as `adjoint` others: of columns, of
    rows, or of both. What cannot be fewer is not coloured, which takes long where rows or columns are."""
    turned = pattern.turned()
    ways = [(pattern.longest, lambda: by_columns(pattern, turned)),
            (adjoint * turned.longest, lambda: by_columns(turned, pattern).turned())]
    limit = min(least for least, _ in ways)
    for least, most in _lengths(pattern, adjoint, 1, limit):
        ways.append((least, lambda most=most: _apart(pattern, most)))
    for least, most in _lengths(turned, 1, adjoint, limit):
        ways.append((least, lambda most=most: _apart(turned, most).turned()))
    found: Colors | None = None
    for least, colors in sorted(ways, key=lambda way: way[0]):
        if found is None or least < found.cost(adjoint):
            found = min(filter(None, (found, colors())), key=lambda c: c.cost(adjoint))
    assert found is not None
    return found


def _lengths(pattern: Pattern, own: int, other: int, limit: int) -> Iterator[tuple[int, int]]:
    """The length beyond which lines go their own way, with the fewest products that may do, if less than `limit` can:
    there are no fewer than any line of the rest has entries, and than long lines share a member. A product with a line
    costs `own`, one with a member `other`."""
    lengths = np.diff(pattern.starts)
    sizes, counts = np.unique(lengths[lengths > 0], return_counts=True)
    sizes, counts = sizes[::-1], counts[::-1]
    told = np.cumsum(sizes * counts)[:-1]
    least = own * -(-told // max(pattern.width, 1)) + other * sizes[1:]
    if not len(least) or least.min() >= limit:
        return
    found, of_lines = None, lengths[pattern.lines]
    order = np.argsort(-of_lines, kind="stable")
    shared, first = np.zeros(pattern.width, int), 0
    for last, rest in zip(told, sizes[1:]):
        shared += np.bincount(pattern.members[order[first:last]], minlength=pattern.width)
        first = last
        if own * shared.max() >= limit:
            break
        if own * shared.max() + other * rest < limit:
            limit = int(own * shared.max() + other * rest)
            found = limit, int(rest)
    if found is not None:
        yield found


def _apart(pattern: Pattern, most: int) -> Colors:
    """The colours where rows of more than `most` entries are told by themselves, all other entries by their columns."""
    long = np.diff(pattern.starts) > most
    rest, own = pattern.only(~long), pattern.only(long)
    of_rest, of_own = rest.turned(), own.turned()
    columns = colored(of_rest.starts, of_rest.members, rest.starts, pattern.engine)
    rows = colored(own.starts, own.members, of_own.starts, pattern.engine)
    return Colors(np.where(np.diff(of_rest.starts) > 0, columns, -1), np.where(long, rows, -1))
