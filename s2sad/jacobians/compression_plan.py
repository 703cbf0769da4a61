"""Plans: where a sparse matrix has entries, and which of its columns or rows one product tells at once."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.extras import needed
from s2sad.jacobians.coloring import colored
from s2sad.jacobians.linear_maps import LinearMap, size
from s2sad.report.picture import figure_class

_PRECISION = {"float32": 1e-3, "float64": 1e-7}


def scipy_sparse() -> Any:
    """SciPy's module of sparse matrices; raises S2sadError (S405) where it is not installed."""
    return needed("scipy.sparse", "a sparse matrix", "ask for the dense one")


@dataclass(frozen=True, eq=False)
class Plan:
    """How a sparse matrix is made: its pattern (CSR), the colours of its columns, or of its rows where it is made by
    adjoints, for arguments of these shapes. It is never changed, so that threads share it.

    `colors` counts the products that a matrix takes; `save` and `load` keep it in a file (.npz), `picture` draws it.
    """
    taken: tuple[int, ...]
    given: tuple[int, ...]
    indptr: np.ndarray
    indices: np.ndarray
    color_of: np.ndarray
    mode: str

    @classmethod
    def of(cls, rows: np.ndarray, columns: np.ndarray, taken: tuple[int, ...], given: tuple[int, ...], mode: str
           ) -> Plan:
        """The plan for entries, which are sorted by rows: by "forward" or "reverse" products, or "auto"."""
        height, width = size(given), size(taken)
        by_columns = None if mode == "reverse" else colored(columns, rows, width, height)
        by_rows = None if mode == "forward" else colored(rows, columns, height, width)
        # an adjoint costs two to three tangents
        forward = by_rows is None or by_columns is not None and by_columns.max(initial=0) <= 2 * by_rows.max(
            initial=0) + 1
        indptr = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=height))]).astype(np.int32)
        chosen = by_columns if forward else by_rows
        assert chosen is not None
        return cls(taken, given, indptr, columns.astype(np.int32), chosen, "forward" if forward else "reverse")

    @property
    def colors(self) -> int:
        return int(self.color_of.max(initial=-1)) + 1

    @property
    def shape(self) -> tuple[int, int]:
        return size(self.given), size(self.taken)

    @cached_property
    def rows(self) -> np.ndarray:
        return np.repeat(np.arange(self.shape[0]), np.diff(self.indptr))

    @cached_property
    def _places(self) -> np.ndarray:
        """Where each entry stands among the products, one after the other."""
        first, other = (self.indices, self.rows) if self.mode == "forward" else (self.rows, self.indices)
        return self.color_of[first] * (self.shape[0] if self.mode == "forward" else self.shape[1]) + other

    @cached_property
    def _directions(self) -> list[np.ndarray]:
        return [np.flatnonzero(self.color_of == color) for color in range(self.colors)]

    def entries(self, of: LinearMap) -> np.ndarray:
        """The entries of a linear map's matrix, by rows."""
        multiply = of.product if self.mode == "forward" else of.transposed_product
        direction = np.zeros(len(self.color_of))
        products = np.empty((self.colors, self.shape[0] if self.mode == "forward" else self.shape[1]), of.dtype)
        for line, members in zip(products, self._directions):
            direction[members] = 1.0
            line[...] = multiply(direction)
            direction[members] = 0.0
        return products.reshape(-1)[self._places]

    def matrix(self, entries: np.ndarray) -> Any:
        """The sparse matrix (CSR) with these entries."""
        return scipy_sparse().csr_array((entries, self.indices, self.indptr), shape=self.shape)

    @cached_property
    def _probe(self) -> np.ndarray:
        return np.random.default_rng(len(self.indices)).uniform(1.0, 2.0, self.shape[1])

    def holds(self, of: LinearMap, entries: np.ndarray) -> bool:
        """Whether a matrix gives what the linear map does for a direction that has not been asked for: a pattern that
        is too small does not."""
        theirs, terms = of.product(self._probe), entries * self._probe[self.indices]
        ours = np.bincount(self.rows, terms, self.shape[0])
        size = np.where(np.isfinite(theirs), np.abs(theirs), 0.0)
        scale = np.bincount(self.rows, np.abs(terms), self.shape[0]) + size
        with np.errstate(invalid="ignore"):     # what is not finite in the matrix is seen there
            close = np.abs(theirs - ours) <= _PRECISION[of.dtype.name] * scale
        return bool(np.all(close | ~np.isfinite(ours)))

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
        first = self.indices if self.mode == "forward" else self.rows
        axes.scatter(self.indices, self.rows, c=self.color_of[first], s=max(0.2, min(40.0, 9e4 / max(self.shape) ** 2)),
                     marker="s", cmap="tab20", linewidths=0.0)
        axes.set(xlim=(-0.5, self.shape[1] - 0.5), ylim=(self.shape[0] - 0.5, -0.5), aspect="equal",
                 title=f"{len(self.indices):,} entries, {self.colors} products")
        figure.savefig(path)

    def __repr__(self) -> str:
        height, width = self.shape
        return f"<plan of a {height} x {width} matrix: {len(self.indices)} entries, {self.colors} {self.mode} products>"
