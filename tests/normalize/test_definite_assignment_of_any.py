"""Generated loops and branches that bind few names on some ways: the form raises where Python does."""
from __future__ import annotations

import random

import numpy as np
import pytest

from tests.normalize.structured_form import run_both, shown

NAMES = ("p", "q", "w")
RANGES = ("n", "m", "1, n", "n - 1, -1, -1", "2", "0", "1, 3", "m, 0, -1", "n, n + 2", "-1, n", "x.size - 1, -1, -2")


class Writer:
    """Writes one function."""

    def __init__(self, seed: int):
        self.random = random.Random(seed)
        self.fuel = self.random.randint(4, 10)
        self.lines = ["def f(x, n, m, v):", "    s = 0.0"]
        for _ in range(3):
            self.block(1, ())
        self.lines += ["    if n > 1000:", "        p, q, w = 1.0, 2.0, 3.0",      # all are the function's own
                       f"    return s + {self.random.choice(NAMES)}"]

    def number(self, counters: tuple[str, ...]) -> str:
        return self.random.choice((*NAMES, *NAMES, *counters[-1:], "v", "x[0]"))

    def test(self, counters: tuple[str, ...]) -> str:
        pick, kind = self.random.choice, self.random.randrange(8)
        if kind < 3 and counters:
            return f"{pick(counters)} {pick(('>', '>=', '<', '<=', '==', '!='))} {pick(('0', '1', '2', '-1', 'm - 1'))}"
        if kind == 3 and counters:
            return pick(counters)
        if kind == 4:
            return f"not ({self.test(counters)})"
        if kind == 5:
            return f"({self.test(counters)} {pick(('and', 'or'))} {self.test(counters)})"
        if kind == 6:
            return f"{self.number(counters)} < {self.number(counters)}"
        return pick(("v > 0.5", "n > 1", "m > n", "x[1] > 0.5", "s < 4.0"))

    def block(self, indent: int, counters: tuple[str, ...]) -> None:
        for _ in range(self.random.randint(1, 3) if self.fuel > 0 else 0):
            self.fuel -= 1
            self.statement(indent, counters)
        self.put(indent, "s = s + 0.25")

    def put(self, indent: int, text: str) -> None:
        self.lines.append("    " * indent + text)

    def statement(self, indent: int, counters: tuple[str, ...]) -> None:
        kind, nested, name = self.random.randrange(13), indent < 5, self.random.choice(NAMES)
        if kind < 3:
            self.put(indent, f"{name} = {self.number(counters)}")
        elif kind < 6:
            self.put(indent, f"{'s' if kind < 5 else name} += {self.number(counters)}")
        elif kind < 8 and nested:
            self.put(indent, f"if {self.test(counters)}:")
            self.block(indent + 1, counters)
            self.otherwise(indent, counters)
        elif kind < 11 and nested:
            counter = "ijkl"[indent - 1]
            self.put(indent, f"for {counter} in range({self.random.choice((*RANGES, *counters))}):")
            self.block(indent + 1, (*counters, counter))
            self.otherwise(indent, counters)
        elif kind == 11 and counters:
            self.put(indent, f"if {self.test(counters)}:")
            self.put(indent + 1, self.random.choice(("break", "continue", "return s")))

    def otherwise(self, indent: int, counters: tuple[str, ...]) -> None:
        if self.random.random() < 0.3:
            self.put(indent, "else:")
            self.block(indent + 1, counters)


@pytest.mark.parametrize("first", range(0, 120, 20))
def test_generated_programs(first):
    for seed in range(first, first + 20):
        text = "\n".join(Writer(seed).lines) + "\n"
        for n, m, v in ((0, 1, 0.2), (1, 2, 0.9), (3, 0, 0.2), (3, 2, 0.9), (0, 0, 0.9), (1, 1, 0.2)):
            original, ours = run_both(text, np.array([v, 0.7, 0.1]), n, m, v)
            assert ours == original, text + "\n# becomes\n" + shown(text)
