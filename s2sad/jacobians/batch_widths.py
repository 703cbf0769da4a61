"""How many directions a derivative has at once: what was fastest of a few widths, for matrices of one shape.

Each width is a function of its own, which must be derived and compiled. So matrices are made with the width that their
number of products suggests until that has taken as long as their first call, in which it was compiled; then it is worth
while to try the others. No entry depends on the width but for rounding.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import TypeVar

from s2sad.jacobians.compression_plan import Widths

T = TypeVar("T")
Work = Callable[[Widths], T]                            # makes a matrix, by tangents and adjoints of these widths
Choices = Callable[[], Mapping[bool, Sequence[int]]]    # the widths to be tried, of adjoints under True

clock: Callable[[], float] = perf_counter
_ROUNDS = 3


class MeasuredWidths:
    """The widths for matrices of one shape; `found` once they were measured."""

    def __init__(self) -> None:
        self.found: Widths | None = None
        self._first: float | None = None
        self._since = 0.0

    def make(self, work: Work[T], choices: Choices) -> T:
        """A matrix, with what is known; what it takes counts."""
        if self.found is None and self._first is not None and self._since > self._first:
            self.measure(work, choices)
        if self.found is not None:
            return work(self.found)
        start = clock()
        made = work((0, 0))
        taken = clock() - start
        if self._first is None:
            self._first = taken
        else:
            self._since += taken
        return made

    def measure(self, work: Work[T], choices: Choices) -> Widths:
        """Tries the widths, if that was not done."""
        if self.found is None:
            found = [0, 0]
            for transposed, widths in choices().items():
                if len(widths) > 1:
                    taken = {width: self._seconds(work, found, transposed, width) for width in widths}
                    found[transposed] = min(widths, key=lambda width: taken[width])  # noqa: B023
            self.found = found[0], found[1]
        return self.found

    @staticmethod
    def _seconds(work: Work[T], found: Sequence[int], transposed: bool, width: int) -> float:
        tried = (found[0], width) if transposed else (width, found[1])
        work(tried)     # what must be compiled is
        taken = []
        for _ in range(_ROUNDS):
            start = clock()
            work(tried)
            taken.append(clock() - start)
        return min(taken)
