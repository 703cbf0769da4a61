"""Programs with lists and queues whose length only the run knows: filled, emptied, bound anew, gone through at once."""
from __future__ import annotations

from tests.programs import Program
from tests.programs.expressions import Choices

_HEAD = '''from collections import deque

import numpy as np


def kernel(x, n):
    s = 0.0
'''


class _Writer:
    def __init__(self, choices: Choices):
        self.choices, self.lines = choices, []
        self.queues = {name: choices.chance(65) for name in ("h", "q")[:choices.pick([1, 2, 2])]}

    def name(self) -> str:
        return self.choices.pick([*self.queues])

    def write(self, depth: int, *lines: str) -> None:
        self.lines += ["    " * depth + line for line in lines]

    def begin(self) -> None:
        for name, is_queue in self.queues.items():
            kept = self.choices.pick([2, 3])
            self.write(1, f"{name} = " + self.choices.pick([
                f"deque([x[0], x[1]], maxlen={kept})", f"deque(maxlen={kept})", "deque()", "deque([x[0]])"]
                if is_queue else ["[]", "[x[0], x[2]]", "[0.5]"]))

    def value(self) -> str:
        n = self.name()
        return self.choices.pick([
            "x[k % 4] * 0.9", "np.sin(x[k % 4])", "s * 0.3", f"({n}[-1] * x[1] if len({n}) > 0 else x[2])",
            f"({n}[0] + 0.1 if {n} else 0.2)", f"0.1 * len({n}) * x[0]", f"sum({n}) * 0.2"])

    def statement(self, depth: int) -> None:
        write = self.choices.pick([
            self.append, self.append, self.append, self.take, self.take, self.store, self.through, self.through,
            self.empty, self.branch, self.rebind, self.extend, self.read])
        write(depth, self.name())

    def append(self, depth: int, n: str) -> None:
        self.write(depth, f"{n}.append({self.value()})")

    def take(self, depth: int, n: str) -> None:
        if self.queues[n] and self.choices.chance(50):
            self.write(depth, f"if {n}:", f"    s += {n}.popleft() ** 2")
        else:
            self.write(depth, f"if len({n}) > {self.choices.integer(0, 2)}:", f"    s += {n}.pop() * x[1]")

    def store(self, depth: int, n: str) -> None:
        self.write(depth, f"if len({n}) > 1:", f"    {n}[{self.choices.pick([-1, 0, 1, -2])}] = {self.value()}")

    def through(self, depth: int, n: str) -> None:
        other = self.name()
        if self.choices.chance(40):
            second = self.choices.pick([other, f"reversed({other})"])
            self.write(depth, f"for a, b in zip({n}, {second}):", "    s += a * b")
        else:
            self.write(depth, f"for a in {n}:", f"    s += a * {self.choices.pick(['a', '0.3', 'x[0]'])}")

    def empty(self, depth: int, n: str) -> None:
        self.write(depth, f"if s > {self.choices.pick([0.5, 1.0, 2.0])}:", f"    {n}.clear()")

    def branch(self, depth: int, _: str) -> None:
        self.write(depth, "if x[k % 4] > 0.2:")
        self.statement(depth + 1)

    def rebind(self, depth: int, n: str) -> None:
        if self.queues[n]:
            self.read(depth, n)
        else:
            self.write(depth, f"{n} = " + self.choices.pick([
                f"[a * 0.9 for a in {n}]", f"[{n}[-1]] if len({n}) else [x[3]]", "[x[0] * s]"]))

    def extend(self, depth: int, n: str) -> None:
        other = self.choices.pick([m for m in self.queues if m != n] or ["[x[0], s * 0.1]"])
        self.write(depth, f"{n}.extend({other})")

    def read(self, depth: int, n: str) -> None:
        self.write(depth, *self.choices.pick([
            [f"if k > 1 and len({n}) > 0:", f"    s += {n}[-1]"], [f"s += max({n}) if {n} else 0.0"]]))


def random_program(seed: int) -> Program:
    """The program with this number."""
    writer = _Writer(Choices.seeded(seed))
    writer.begin()
    writer.write(1, "for k in range(n + 2):")
    for _ in range(writer.choices.integer(2, 5)):
        writer.statement(2)
    n = writer.name()
    writer.write(1, f"return s + 0.1 * len({n}) * x[1] + ({n}[-1] if len({n}) > 0 else x[0])")
    return Program(_HEAD + "\n".join(writer.lines) + "\n", "kernel", (("x", "vector"), ("n", "int")), ("x",),
                   ("return",), seed=seed)
