"""Generated control flow over integers: nested loops and branches with every jump, calls that write, lazy operators."""
from __future__ import annotations

import os

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from s2sad.diagnostics import S2sadError
from tests.normalize.structured_form import run_both, shown

HELPERS = '''
def push(x, v):
    x[0] = (x[0] * 3 + v) % 97
    return x[0] % 5 - 1
def both(x, v):
    x[v % 3] = (x[v % 3] + v) % 89
    return x[1] % 7, v - 1
def pure(a, b=2):
    return a * b - 1
'''
NAMES = ("a", "b", "c", "i", "j")


class Writer:
    """Writes one function; `draw(k)` gives an integer below k."""

    def __init__(self, draw):
        self._below = draw
        self.fuel = 14
        self.lines: list[str] = []

    def pick(self, items):
        return items[self._below(len(items))]

    def number(self, depth=2) -> str:
        kind = self._below(12 if depth else 3)
        if kind == 0:
            return str(self._below(6) - 1)
        if kind <= 2:
            return self.pick(NAMES)
        inner = lambda: self.number(depth - 1)  # noqa: E731
        return [lambda: f"({inner()} + {inner()})", lambda: f"({inner()} - {inner()} * 2)", lambda: f"x[{inner()} % 3]",
                lambda: f"push(x, {inner()})", lambda: f"({inner()} if {self.test(depth - 1)} else {inner()})",
                lambda: f"pure({inner()})", lambda: f"pure(b={inner()}, a={inner()})", lambda: f"both(x, {inner()})[1]",
                lambda: f"({inner()} {self.pick(('and', 'or'))} {inner()})"][kind - 3]()

    def test(self, depth=2) -> str:
        kind = self._below(6 if depth > 0 else 1)
        if kind <= 2:
            lower = max(depth - 1, 0)
            return f"{self.number(lower)} {self.pick(('<', '==', '>=', '!='))} {self.number(lower)}"
        if kind == 3:
            return f"{self.number(depth - 1)} < {self.number(depth - 1)} <= {self.number(depth - 1)}"
        if kind == 4:
            return f"not ({self.test(depth - 1)})"
        return f"({self.test(depth - 1)}) {self.pick(('and', 'or'))} ({self.test(depth - 1)})"

    def block(self, indent: int, loops: int) -> None:
        before = len(self.lines)
        for _ in range(1 + self._below(3)):
            if self.fuel <= 0:
                break
            self.fuel -= 1
            self.statement(indent, loops)
        if len(self.lines) == before:
            self.put(indent, "pass")

    def put(self, indent: int, text: str) -> None:
        self.lines.append("    " * indent + text)

    def statement(self, indent: int, loops: int) -> None:
        kind = self._below(16)
        if kind <= 3:
            self.simple(indent)
        elif kind <= 7:
            self.branch(indent, loops)
        elif kind <= 10 and loops < 3:
            self.loop(indent, loops)
        elif kind == 11:
            self.put(indent, f"return {self.number(1)}")
        elif loops and kind <= 13:
            self.put(indent, "continue")
        elif loops:
            self.put(indent, "break")
        else:
            self.simple(indent)

    def simple(self, indent: int) -> None:
        v, w = self.pick(NAMES), self.pick(NAMES)
        self.put(indent, [
            lambda: f"{v} = ({self.number()}) % 50", lambda: f"{v} += {self.number(1)}",
            lambda: f"x[{self.number(1)} % 3] = ({self.number()}) % 50", lambda: f"x[{v} % 3] -= {self.number()}",
            lambda: f"{v}, {w if w != v else 'other'} = ({self.number(1)}) % 9, {self.number(1)}",
            lambda: f"{v}, x[{w} % 3] = {w}, {self.number(1)}",
            lambda: f"{v} = x[{w} % 3] = ({self.number(1)}) % 50" if v != w else "pass",
            lambda: f"{v}, x[1] = both(x, {w})", lambda: f"push(x, {self.number(1)})",
            lambda: f"x[{v} % 3], x[{w} % 3] = x[{w} % 3], x[{v} % 3]",
        ][self._below(10)]())

    def branch(self, indent: int, loops: int) -> None:
        self.put(indent, f"if {self.test()}:")
        self.block(indent + 1, loops)
        if self._below(2):
            self.put(indent, f"elif {self.test()}:")
            self.block(indent + 1, loops)
        if self._below(2):
            self.put(indent, "else:")
            self.block(indent + 1, loops)

    def loop(self, indent: int, loops: int) -> None:
        v, w = self.pick(NAMES), self.pick(NAMES)
        head = self._below(9)
        if head <= 2:
            # every while spends of one supply, so that all end
            self.put(indent, "while True:" if head == 0 else f"while {self.test()}:")
            self.put(indent + 1, "spent[0] += 1")
            self.put(indent + 1, "if spent[0] > 30:")
            self.put(indent + 2, "break" if self._below(2) else f"return {self.pick(NAMES)}")
        else:
            self.put(indent, [
                lambda: f"for {v} in range(({self.number(1)}) % 4):",
                lambda: f"for {v} in range({self.pick(NAMES)} % 5, -1, -2):",
                lambda: f"for {v} in x:", lambda: f"for {v}, {w} in enumerate(x, {self._below(3)}):",
                lambda: f"for {v}, {w} in zip(range(x[0] % 4), reversed(x)):",
                lambda: f"for {v}, {w} in np.ndindex(2, x[1] % 3):"][head - 3]() if head != 8 or v != w
                else f"for {v} in (1, {w}, 3):")
            self.put(indent + 1, "spent[0] += 1")
            self.put(indent + 1, "if spent[0] > 60:")
            self.put(indent + 2, "return -1")
        self.block(indent + 1, loops + 1)
        if self._below(3) == 0:
            self.put(indent, "else:")
            self.block(indent + 1, loops)


@st.composite
def programs(draw, unbound=0):
    writer = Writer(lambda below: draw(st.integers(0, below - 1)))
    writer.put(0, "def f(x, spent, a, b):")
    for name, value in (("c", 1), ("i", 2), ("j", 3))[draw(st.integers(0, unbound)):]:
        writer.put(1, f"{name} = {value}")
    for _ in range(3):
        writer.block(1, 0)
    if unbound:
        writer.put(1, "if spent[0] > 1000:")       # all are the function's own
        writer.put(2, "c, i, j = a, a, a")
    writer.put(1, "return a + 7 * b + 31 * c + 101 * i + 1001 * j")
    return HELPERS + "\n".join(writer.lines) + "\n"


@settings(max_examples=int(os.environ.get("S2SAD_STRUCTURED_EXAMPLES", "150")))
@given(programs())
def test_generated_programs(text):
    for a in (-1, 0, 4):
        original, ours = run_both(text, np.array([3, a, 5]), np.array([0]), a, 2)
        assert ours == original, text + "\n# becomes\n" + shown(text)


@settings(max_examples=int(os.environ.get("S2SAD_STRUCTURED_EXAMPLES", "150")))
@given(programs(unbound=3))
def test_names_that_some_ways_do_not_bind(text):
    for a in (-1, 0, 4):
        try:
            original, ours = run_both(text, np.array([3, a, 5]), np.array([0]), a, 2)
        except S2sadError as refused:       # some ways never bind it
            assert "before it is bound" in str(refused) or "bound on some ways only" in str(refused), text
            return
        assert ours == original, text + "\n# becomes\n" + shown(text)
