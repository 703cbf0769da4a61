"""Plans: where a sparse matrix has entries, and which of its columns or rows one product tells at once."""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from typing import Any, Literal

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.extras import needed
from s2sad.jacobians.bidirectional import Colors, Pattern, by_columns, fewest
from s2sad.jacobians.coloring import count_of, loops, star_colored, starts_of
from s2sad.jacobians.linear_maps import LinearMap, size
from s2sad.jacobians.told_entries import ToldEntries
from s2sad.report.picture import figure_class

Mode = Literal["auto", "forward", "reverse", "both"]
PlanMode = Mode | Literal["symmetric"]
Widths = tuple[int, int]
_PRECISION = {"f": 1e-3, "d": 1e-7}     # by the character of a dtype


def scipy_sparse() -> Any:
    """SciPy's module of sparse matrices; raises S2sadError (S405) where it is not installed."""
    return needed("scipy.sparse", "a sparse matrix", "ask for the dense one")


@dataclass(frozen=True, eq=False)
class Plan:
    """How a sparse matrix is made: its pattern (CSR), the colours of its columns and of its rows, -1 where no product
    has them, for arguments of these shapes; an entry is told by its column, or by its row, of a symmetric matrix from
    either side. It is never changed, so that threads share it.

    `colors` counts the products that a matrix takes; `widths` are how many directions tangents and adjoints have at
    once by what was measured, 0 where nothing was. `save` and `load` keep it in a file (.npz), `picture` draws it.
    """
    taken: tuple[int, ...]
    given: tuple[int, ...]
    indptr: np.ndarray
    indices: np.ndarray
    column_colors: np.ndarray
    row_colors: np.ndarray
    mode: str
    widths: Widths = (0, 0)

    @classmethod
    def of(cls, starts: np.ndarray, indices: np.ndarray, of: LinearMap, mode: PlanMode) -> Plan:
        """The plan for the entries of a map, by rows: with "forward" or "reverse" products, or "both", whatever takes
        fewer; with what is cheapest ("auto"), where an adjoint costs two to three tangents; or with those of a
        "symmetric" matrix."""
        if mode == "symmetric":
            starts, indices, twins = symmetrized(starts, indices)
            colors = Colors(star_colored(starts, indices, twins, of.engine), np.full(len(starts) - 1, -1))
        else:
            pattern = Pattern(starts, indices, size(of.taken), of.engine)
            colors = (by_columns(pattern, pattern.turned()) if mode == "forward" else
                      by_columns(pattern.turned(), pattern).turned() if mode == "reverse" else
                      fewest(pattern, 2 if mode == "auto" else 1))
        return cls(of.taken, of.given, starts.astype(np.int32), indices.astype(np.int32), colors.columns, colors.rows,
                   colors.mode if mode in ("auto", "both") else mode)

    @property
    def counts(self) -> tuple[int, int]:
        """How many tangents and adjoints a matrix takes."""
        return count_of(self.column_colors), count_of(self.row_colors)

    @cached_property
    def colors(self) -> int:
        return sum(self.counts)

    @property
    def shape(self) -> tuple[int, int]:
        return size(self.given), size(self.taken)

    @cached_property
    def rows(self) -> np.ndarray:
        return np.repeat(np.arange(self.shape[0]), np.diff(self.indptr))

    @cached_property
    def told(self) -> tuple[ToldEntries, ...]:
        """What each kind of products tells."""
        columns, rows = self.column_colors, self.row_colors
        if self.mode == "forward":
            return ToldEntries(False, columns, None, self.indices, self.rows),
        if self.mode == "reverse":
            return ToldEntries(True, rows, None, self.rows, self.indices),
        alone = _alone(self.rows, columns[self.indices])
        if self.mode == "symmetric":
            by = self._either_side(alone)
            return ToldEntries(False, columns, None, self.indices[by], self.rows[by]),
        assert np.all(alone | _alone(self.indices, rows[self.rows])), "no colouring of columns and rows"
        first, second = np.flatnonzero(alone), np.flatnonzero(~alone)
        return (ToldEntries(False, columns, first, self.indices[first], self.rows[first]),
                ToldEntries(True, rows, second, self.rows[second], self.indices[second]))

    def _either_side(self, alone: np.ndarray) -> np.ndarray:
        """The entry that a product tells in place of each one: of a symmetric matrix that above the diagonal or that
        below, whichever is alone in its row with the colour of its column."""
        twins = symmetrized(self.indptr, self.indices)[2]
        every = np.arange(len(twins))
        above = np.where(self.rows <= self.indices, every, twins)
        assert np.all(alone | alone[twins]), "no star colouring"
        return np.where(alone[above], above, twins[above])

    def entries(self, of: LinearMap, check: bool, widths: Widths | None = None, threads: int = 1
                ) -> tuple[np.ndarray, np.ndarray]:
        """The entries of a linear map's matrix, by rows; and, if they are to be checked, what the map does to one more
        direction."""
        made, theirs, (first, *others) = np.empty(len(self.indices), of.dtype), np.zeros(0), self.told
        measured = widths or self.widths
        theirs = first.tell(of, made, self._probe if check else None, measured[first.transposed], threads)
        for told in others:
            told.tell(of, made, None, measured[told.transposed], threads)
        return made, theirs

    def agrees(self, of: LinearMap, entries: np.ndarray, theirs: np.ndarray, rounded: bool = False) -> bool:
        """Whether a matrix of these entries does the same to that direction, as one whose pattern is too small does
        not. Entries that are nothing but rounding errors differ from one direction to the next: what is that small
        beside the greatest is let pass if it may be `rounded`."""
        precision = _PRECISION[of.dtype.char]
        answers = self.indices if self.told[0].transposed else self.rows
        return loops(of.engine).agrees(entries, self._weights, answers, theirs, precision,
                                       1e-5 * precision if rounded else 0.0)

    def holds(self, starts: np.ndarray, indices: np.ndarray) -> bool:
        """Whether it has all entries of a pattern."""
        rows = np.repeat(np.arange(self.shape[0]), np.diff(starts))
        return bool(np.isin(rows * self.shape[1] + indices, self.rows * self.shape[1] + self.indices).all())

    @cached_property
    def _probe(self) -> np.ndarray:
        return np.random.default_rng(len(self.indices)).uniform(1.0, 2.0, len(self.told[0].color_of))

    @cached_property
    def _weights(self) -> np.ndarray:
        """What the check multiplies each entry with."""
        return self._probe[self.rows if self.told[0].transposed else self.indices]

    @cached_property
    def _made(self) -> dict[str, Any]:
        return {}

    def matrix(self, entries: np.ndarray, format: str = "csr") -> Any:
        """The sparse matrix with these entries, which are given by rows."""
        if format not in self._made:        # one whose entries are their places
            numbered = scipy_sparse().csr_array((np.arange(len(entries)), self.indices, self.indptr), shape=self.shape)
            self._made[format] = numbered.asformat(format)
        made = copy(self._made[format])
        made.data = entries if format == "csr" else entries[made.data]
        return made

    def check_shapes(self, of: LinearMap) -> None:
        """Raises unless it is for arguments of these shapes."""
        if (self.taken, self.given) != (of.taken, of.given):
            raise S2sadError(Diagnostic(
                "S405", f"the plan is for a matrix from {self.taken} to {self.given}, here it is from {of.taken} to "
                f"{of.given}", help="make one for these arguments: J.plan(*args)"))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes it to a file of NumPy's (.npz)."""
        np.savez(path, taken=self.taken, given=self.given, indptr=self.indptr, indices=self.indices,
                 column_colors=self.column_colors, row_colors=self.row_colors, mode=self.mode, widths=self.widths)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Plan:
        """A plan that `save` wrote."""
        with np.load(path) as held:
            taken, given, (tangents, adjoints) = (tuple(map(int, held[name])) for name in ("taken", "given", "widths"))
            return cls(taken, given, held["indptr"], held["indices"], held["column_colors"], held["row_colors"],
                       str(held["mode"]), (tangents, adjoints))

    def measured(self, widths: Widths) -> Plan:
        """The plan with these widths."""
        return replace(self, widths=widths)

    def picture(self, path: str | PathLike[str]) -> None:
        """Draws the pattern in its colours to a file that matplotlib writes; needs matplotlib (S405)."""
        figure = figure_class()(figsize=(5.0, 5.0), layout="constrained")
        axes = figure.add_subplot()
        size = max(0.2, min(40.0, 9e4 / max(self.shape) ** 2))
        colors = np.empty(len(self.indices), int)
        for told, before in zip(self.told, (0, self.counts[0])):
            colors[slice(None) if told.places is None else told.places] = told.color_of[told.asked] + before
        axes.scatter(self.indices, self.rows, c=colors, s=size, marker="s", cmap="tab20",
                     linewidths=0.0)
        axes.set(xlim=(-0.5, self.shape[1] - 0.5), ylim=(self.shape[0] - 0.5, -0.5), aspect="equal",
                 title=f"{len(self.indices):,} entries, {self.colors} products")
        figure.savefig(path)

    def __repr__(self) -> str:
        height, width = self.shape
        counts = " and ".join(f"{n} {kind}" for n, kind in zip(self.counts, ("forward", "reverse"))
                              ) if self.mode == "both" else f"{self.colors} {self.mode}"
        return f"<plan of a {height} x {width} matrix: {len(self.indices)} entries, {counts} products>"


def _alone(lines: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """Whether each entry is the only one of its colour in its line, and has one."""
    places = lines * (int(colors.max(initial=-1)) + 2) + colors + 1
    return (np.bincount(places, minlength=1)[places] == 1) & (colors >= 0)


def symmetrized(starts: np.ndarray, indices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The pattern of a matrix and its transpose (CSR), and where each entry stands on the other side.

    >>> symmetrized(np.array([0, 2, 2]), np.array([0, 1]))
    (array([0, 2, 3]), array([0, 1, 0]), array([0, 2, 1]))
    """
    count = len(starts) - 1
    rows, columns = np.repeat(np.arange(count), np.diff(starts)), indices.astype(np.int64)
    keys = np.unique(np.concatenate([rows * count + columns, columns * count + rows]))
    rows, columns = np.divmod(keys, max(count, 1))
    return starts_of(rows, count), columns, np.lexsort((rows, columns))
