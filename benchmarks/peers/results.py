"""What is stored of the comparison, read: times that repeat, errors, slopes, who is fastest."""
from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.tables import NOISE, noise
from benchmarks.peers.tools import DIFFERENCES, OURS, PRIMALS
from s2sad.report.timing import Times

LOSES = 1.05    # s2sad is called slower from this factor on
SINGLE = "s2sad, Numba, float32"
DOUBLE = tuple(variant for variant in OURS if variant != SINGLE)


@dataclass(frozen=True)
class Kernel:
    """The stored results of one kernel."""
    name: str
    stored: dict[str, Any]

    @property
    def sizes(self) -> list[int]:
        """The sizes that were measured, ascending."""
        return sorted(map(int, self.stored["sizes"]))

    @property
    def exact(self) -> int | None:
        """The size at which errors were measured."""
        return next((n for n in self.sizes if self.stored["sizes"][str(n)]["exact"]), None)

    @property
    def variants(self) -> list[str]:
        """All variants that were tried, in their order."""
        return list(self.stored["sizes"][str(self.sizes[0])]["variants"])

    def line(self, variant: str, size: int) -> dict[str, Any]:
        """What is stored of a variant at a size; empty where it had been left out before."""
        return self.stored["sizes"][str(size)]["variants"].get(variant, {})

    def times(self, variant: str, size: int) -> Times | None:
        """The quartiles of a time, None where the variant was left out."""
        line = self.line(variant, size)
        return Times(**line["times"]) if "times" in line and "left" not in line else None

    def median(self, variant: str, size: int) -> float | None:
        """The median of a time that repeats."""
        found = self.times(variant, size)
        return found.median if found is not None and noise(found) <= NOISE else None

    def fastest(self, variants: Iterable[str], size: int) -> tuple[str, float] | None:
        """The variant with the smallest median of those that repeat."""
        found = [(median, v) for v in variants if (median := self.median(v, size)) is not None]
        return (min(found)[1], min(found)[0]) if found else None

    def error(self, variant: str) -> float | None:
        """The error at the size that is exact."""
        return None if self.exact is None or "left" in self.line(variant, self.exact) else self.line(
            variant, self.exact).get("error")

    def why(self, variant: str) -> str | None:
        """Why a variant was left out, with the size from which on."""
        for size in self.sizes:
            line = self.line(variant, size)
            if "left" in line:
                return line["left"] if size == self.sizes[0] else f"n = {size}: {line['left']}"
            if "later" in line:
                return line["later"]
        return None

    def memory(self, variant: str, size: int) -> float | None:
        """The bytes that a gradient needs beside the kernel's arguments."""
        line = self.line(variant, size)
        return None if "left" in line else line.get("memory")

    @property
    def others(self) -> list[str]:
        """The variants of other tools that differentiate: no differences, nothing by hand."""
        return [v for v in self.variants if v not in (*PRIMALS, *OURS, *DIFFERENCES, "by hand")]


def slope(sizes: Sequence[float], values: Sequence[float]) -> float:
    """The exponent of growth: the slope of the logarithms, by least squares.

    >>> round(slope([10.0, 100.0, 1000.0], [2e-3, 2e-1, 2e1]), 6)
    2.0
    """
    x, y = [math.log(s) for s in sizes], [math.log(v) for v in values]
    middle, level = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - middle) * (b - level) for a, b in zip(x, y))
            / sum((a - middle) ** 2 for a in x))
