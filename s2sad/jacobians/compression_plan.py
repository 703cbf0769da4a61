"""Plans: where a sparse matrix has entries, and which of its columns or rows one product tells at once."""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.extras import needed
from s2sad.jacobians.coloring import colored, count_of, loops, star_colored, starts_of
from s2sad.jacobians.linear_maps import LinearMap, size
from s2sad.report.picture import figure_class

_PRECISION = {"f": 1e-3, "d": 1e-7}     # by the character of a dtype


def scipy_sparse() -> Any:
    """SciPy's module of sparse matrices; raises S2sadError (S405) where it is not installed."""
    return needed("scipy.sparse", "a sparse matrix", "ask for the dense one")


@dataclass(frozen=True)
class Batch:
    """Directions that are asked for at once; which entries they tell, and where these stand in what comes of them."""
    directions: np.ndarray
    entries: Any
    places: np.ndarray


@dataclass(frozen=True, eq=False)
class Plan:
    """How a sparse matrix is made: its pattern (CSR), the colours of its columns, or of its rows where it is made by
    adjoints, for arguments of these shapes. Of a symmetric one an entry may be taken from the other side. It is never
    changed, so that threads share it.

    `colors` counts the products that a matrix takes; `save` and `load` keep it in a file (.npz), `picture` draws it.
    """
    taken: tuple[int, ...]
    given: tuple[int, ...]
    indptr: np.ndarray
    indices: np.ndarray
    color_of: np.ndarray
    mode: str

    @classmethod
    def of(cls, starts: np.ndarray, indices: np.ndarray, of: LinearMap, mode: str) -> Plan:
        """The plan for the entries of a map, by rows: with "forward" or "reverse" products, or what takes fewer; or
        with those of a "symmetric" matrix."""
        if mode == "symmetric":
            starts, indices, twins = symmetrized(starts, indices)
            return cls(of.taken, of.given, starts.astype(np.int32), indices.astype(np.int32),
                       star_colored(starts, indices, twins, of.engine), mode)
        by_column, rows = loops(of.engine).turned(starts, indices, size(of.taken))
        columns = None if mode == "reverse" else colored(by_column, rows, starts, of.engine)
        chosen, forward = columns, True
        # an adjoint costs two to three tangents; a column has no more rows than there are colours of these
        if columns is None or mode == "auto" and count_of(columns) > 2 * np.diff(by_column).max(initial=0):
            chosen = colored(starts, indices, by_column, of.engine)
            forward = columns is not None and count_of(columns) <= 2 * count_of(chosen)
        chosen = columns if forward else chosen
        assert chosen is not None
        return cls(of.taken, of.given, starts.astype(np.int32), indices.astype(np.int32), chosen,
                   "forward" if forward else "reverse")

    @cached_property
    def colors(self) -> int:
        return count_of(self.color_of)

    @property
    def shape(self) -> tuple[int, int]:
        return size(self.given), size(self.taken)

    @cached_property
    def rows(self) -> np.ndarray:
        return np.repeat(np.arange(self.shape[0]), np.diff(self.indptr))

    @property
    def _asked(self) -> np.ndarray:
        """The column of each entry, or its row where it is made by adjoints: what directions are of."""
        return self.rows if self.mode == "reverse" else self.indices

    @property
    def _answers(self) -> np.ndarray:
        return self.indices if self.mode == "reverse" else self.rows

    @cached_property
    def _told_by(self) -> Any:
        """The entry that a product tells in place of each one: of a symmetric matrix that above the diagonal or that
        below, whichever is alone in its row with the colour of its column."""
        if self.mode != "symmetric":
            return slice(None)
        places = self.rows * max(self.colors, 1) + self.color_of[self.indices]
        alone = np.bincount(places, minlength=1)[places] == 1
        twins = symmetrized(self.indptr, self.indices)[2]
        every = np.arange(len(twins))
        above = np.where(self.rows <= self.indices, every, twins)
        assert np.all(alone | alone[twins]), "no star colouring"
        return np.where(alone[above], above, twins[above])

    @cached_property
    def _batches(self) -> dict[tuple[int, bool], list[Batch]]:
        return {}

    def batches(self, width: int, check: bool) -> list[Batch]:
        """The directions of all colours, so many at once, and that of the check behind them."""
        if (width, check) not in self._batches:
            colors, count = self.color_of[self._asked[self._told_by]], -(-(self.colors + check) // width)
            answers = self._answers[self._told_by]
            # no entry has to be picked where one batch has them all
            order = None if self.colors <= width else np.argsort(colors // width, kind="stable")
            ends, made = starts_of(colors // width, count), []
            for k, (first, last) in enumerate(zip(ends, ends[1:])):
                mine = slice(first, last) if order is None else order[first:last]
                directions = np.zeros((len(self.color_of), width))
                members = np.flatnonzero(self.color_of // width == k)
                directions[members, self.color_of[members] - k * width] = 1.0
                if check and k == count - 1:
                    directions[:, self.colors - k * width] = self._probe
                places = answers[mine].astype(np.intp) * width + (colors[mine] - k * width)
                made.append(Batch(directions, mine, places))
            self._batches[width, check] = made
        return self._batches[width, check]

    def entries(self, of: LinearMap, check: bool) -> tuple[np.ndarray, np.ndarray]:
        """The entries of a linear map's matrix, by rows; and, if they are to be checked, what the map does to one more
        direction."""
        transposed = self.mode == "reverse"
        width = of.width(self.colors + check, transposed)
        batches = self.batches(width, check)
        made, theirs = np.empty(len(self.indices), of.dtype), np.zeros(0)
        for batch, found in zip(batches, of.products((b.directions for b in batches), width, transposed)):
            made[batch.entries] = found.reshape(-1).take(batch.places)
            if check and batch is batches[-1]:
                theirs = found[:, self.colors % width].astype(float)
        return made, theirs

    def agrees(self, of: LinearMap, entries: np.ndarray, theirs: np.ndarray, rounded: bool = False) -> bool:
        """Whether a matrix of these entries does the same to that direction, as one whose pattern is too small does
        not. Entries that are nothing but rounding errors differ from one direction to the next: what is that small
        beside the greatest is let pass if it may be `rounded`."""
        precision = _PRECISION[of.dtype.char]
        return loops(of.engine).agrees(entries, self._weights, self._answers, theirs, precision,
                                       1e-5 * precision if rounded else 0.0)

    def holds(self, starts: np.ndarray, indices: np.ndarray) -> bool:
        """Whether it has all entries of a pattern."""
        rows = np.repeat(np.arange(self.shape[0]), np.diff(starts))
        return bool(np.isin(rows * self.shape[1] + indices, self.rows * self.shape[1] + self.indices).all())

    @cached_property
    def _probe(self) -> np.ndarray:
        return np.random.default_rng(len(self.indices)).uniform(1.0, 2.0, len(self.color_of))

    @cached_property
    def _weights(self) -> np.ndarray:
        """What the check multiplies each entry with."""
        return self._probe[self._asked]

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
                 color_of=self.color_of, mode=self.mode)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Plan:
        """A plan that `save` wrote."""
        with np.load(path) as held:
            taken, given = (tuple(map(int, held[name])) for name in ("taken", "given"))
            return cls(taken, given, held["indptr"], held["indices"], held["color_of"], str(held["mode"]))

    def picture(self, path: str | PathLike[str]) -> None:
        """Draws the pattern in its colours to a file that matplotlib writes; needs matplotlib (S405)."""
        figure = figure_class()(figsize=(5.0, 5.0), layout="constrained")
        axes = figure.add_subplot()
        size = max(0.2, min(40.0, 9e4 / max(self.shape) ** 2))
        axes.scatter(self.indices, self.rows, c=self.color_of[self._asked], s=size, marker="s", cmap="tab20",
                     linewidths=0.0)
        axes.set(xlim=(-0.5, self.shape[1] - 0.5), ylim=(self.shape[0] - 0.5, -0.5), aspect="equal",
                 title=f"{len(self.indices):,} entries, {self.colors} products")
        figure.savefig(path)

    def __repr__(self) -> str:
        height, width = self.shape
        return f"<plan of a {height} x {width} matrix: {len(self.indices)} entries, {self.colors} {self.mode} products>"


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
