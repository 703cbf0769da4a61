"""The entries that products of one kind tell: those of the columns of one colour, or of the rows, at once."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.jacobians.coloring import count_of, starts_of
from s2sad.jacobians.linear_maps import LinearMap, take_products


@dataclass(frozen=True)
class Batch:
    """Directions that are asked for at once; which entries they tell, and where these stand in what comes of them."""
    directions: np.ndarray
    entries: Any
    places: np.ndarray


@dataclass(frozen=True, eq=False)
class ToldEntries:
    """What products with a matrix, or with the transposed one, tell: its entries at `places` (None: all of them), by
    the column of each, or its row, which is `asked` for, and the row, or the column, that `answers`. Columns and rows
    have colours, -1 where none of these products has them."""
    transposed: bool
    color_of: np.ndarray
    places: np.ndarray | None
    asked: np.ndarray
    answers: np.ndarray

    @cached_property
    def colors(self) -> int:
        return count_of(self.color_of)

    @cached_property
    def _batches(self) -> dict[tuple[int, bool], list[Batch]]:
        return {}

    def batches(self, width: int, probe: np.ndarray | None) -> list[Batch]:
        """The directions of all colours, so many at once, and `probe` behind them."""
        key = width, probe is not None
        if key not in self._batches:
            colors, count = self.color_of[self.asked], -(-(self.colors + key[1]) // width)
            # no entry has to be picked where one batch has them all
            order = None if self.colors <= width else np.argsort(colors // width, kind="stable")
            ends, made = starts_of(colors // width, count), []
            for k, (first, last) in enumerate(zip(ends, ends[1:])):
                mine = slice(first, last) if order is None else order[first:last]
                directions = np.zeros((len(self.color_of), width))
                members = np.flatnonzero((self.color_of >= 0) & (self.color_of // width == k))
                directions[members, self.color_of[members] - k * width] = 1.0
                if probe is not None and k == count - 1:
                    directions[:, self.colors - k * width] = probe
                places = self.answers[mine].astype(np.intp) * width + (colors[mine] - k * width)
                made.append(Batch(directions, mine if self.places is None else self.places[mine], places))
            self._batches[key] = made
        return self._batches[key]

    def tell(self, of: LinearMap, entries: np.ndarray, probe: np.ndarray | None, measured: int | None, threads: int
             ) -> np.ndarray:
        """Puts the entries of a linear map's matrix among `entries`; what the map does to `probe`, if there is one."""
        width = of.width(self.colors + (probe is not None), self.transposed, measured)
        batches, theirs = self.batches(width, probe), [np.zeros(0)]

        def take(k: int, found: np.ndarray) -> None:
            entries[batches[k].entries] = found.reshape(-1).take(batches[k].places)
            if probe is not None and k == len(batches) - 1:
                theirs[0] = found[:, self.colors % width].astype(float)
        take_products(of, len(batches), lambda mine: (batches[k].directions for k in mine), width, self.transposed,
                      threads, take)
        return theirs[0]
