"""Programs in which names leave their arrays, and arrays have several names: stores, bindings, helpers that write an
argument and give it back or another array, in loops and branches."""
from __future__ import annotations

from tests.programs import Program
from tests.programs.expressions import Choices

_HEAD = '''import numpy as np


def scale(x, c):
    x[0] = x[0] * c
    x = x * 0.9
    x[1] = 0.3
    return x[0] + x[2]


def moved(x, c):
    x[1] = c * x[0]
    if x[1] > 0.1:
        x = x * 0.8
    return x


def kernel(u, v, c, n):
    s = 0.0
'''


class _Writer:
    def __init__(self, choices: Choices):
        self.choices, self.lines, self.names = choices, [], ["u", "v"]

    def name(self) -> str:
        return self.choices.pick(self.names)

    def place(self) -> str:
        return f"{self.name()}[{self.choices.integer(0, 3)}]"

    def write(self, depth: int, line: str) -> None:
        self.lines.append("    " * depth + line)

    def statement(self, depth: int, loops: int) -> None:
        self.choices.pick([self.store, self.store, self.store, self.change, self.bind, self.bind, self.bind, self.call,
                           self.alias, self.alias, self.read, self.branch, self.loop, self.leave])(depth, loops)

    def store(self, depth: int, _: int) -> None:
        factor = self.choices.pick(["0.9", "c", f"np.sin({self.place()})"])
        self.write(depth, f"{self.place()} = {self.place()} * {factor}")

    def change(self, depth: int, _: int) -> None:
        n = self.name()
        self.write(depth, self.choices.pick([f"{n} *= 0.8", f"{n}[1:] += 0.3 * {self.name()}[:-1]"]))

    def bind(self, depth: int, _: int) -> None:
        bound, other = self.name(), self.name()
        self.write(depth, f"{bound} = " + self.choices.pick([
            f"{other} * 0.9 + 0.05", f"np.cos({other})", f"{bound} + 0.1 * {other}", f"{other}.copy()",
            f"np.where({other} > 0.1, {other}, 0.5 * {bound})"]))

    def alias(self, depth: int, _: int) -> None:
        bound = self.choices.pick(["u", "v", "w", "z"])
        self.write(depth, f"{bound} = {self.name()}")
        self.names += [] if bound in self.names else [bound]

    def call(self, depth: int, _: int) -> None:
        n = self.name()
        self.write(depth, self.choices.pick([f"s += scale({n}, c)", f"{self.name()} = moved({n}, c)"]))

    def read(self, depth: int, _: int) -> None:
        whole, product = f"np.sum({self.name()} ** 2) * 0.1", f"{self.place()} * {self.place()}"
        self.write(depth, f"s += {self.choices.pick([whole, product])}")

    def leave(self, depth: int, loops: int) -> None:
        if loops:
            self.write(depth, f"if {self.place()} > 0.9:")
            self.write(depth + 1, self.choices.pick(["break", "continue"]))
        else:
            self.read(depth, loops)

    def branch(self, depth: int, loops: int) -> None:
        self.write(depth, f"if {self.place()} > 0.1:")
        self.block(depth + 1, loops, 2)
        if self.choices.chance(50):
            self.write(depth, "else:")
            self.block(depth + 1, loops, 1)

    def loop(self, depth: int, loops: int) -> None:
        if loops == 2:
            self.read(depth, loops)
            return
        self.write(depth, f"for k{loops} in range({self.choices.pick(['n', '2', '3'])}):")
        self.block(depth + 1, loops + 1, 4)

    def block(self, depth: int, loops: int, most: int) -> None:
        """What is named in a block has a name in it alone."""
        before = list(self.names)
        for _ in range(self.choices.integer(1, most)):
            self.statement(depth, loops)
        self.names = before


def random_program(seed: int) -> Program:
    """The program with this number."""
    writer = _Writer(Choices.seeded(seed))
    for _ in range(writer.choices.integer(0, 2)):
        writer.statement(1, 0)
    writer.loop(1, 0)
    for _ in range(writer.choices.integer(0, 2)):
        writer.statement(1, 0)
    writer.write(1, f"return s + np.sum({writer.name()} * {writer.name()}) + {writer.name()}[1]")
    return Program(_HEAD + "\n".join(writer.lines) + "\n", "kernel",
                   (("u", "vector"), ("v", "vector"), ("c", "float"), ("n", "int")), ("u", "v", "c"),
                   ("u", "v", "return"), seed=seed)
