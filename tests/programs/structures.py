"""Random programs with objects, lists, dicts and functions: f(x) of four floats, which gives a float.

What is written may alias, grow, be bound anew, be changed in helpers, loops and branches; a program
that Python does not run to a finite number is no test. `source(seed)` is a module with two classes and `f`.
"""
from __future__ import annotations

import random

HEAD = '''import numpy as np


class Base:
    k = 1.5

    def __init__(self, w, t):
        self.w, self.t = w, t
        self.h = [t]

    def step(self, v):
        self.t = self.t + v
        if self.t > 2.0:
            return self.t * 0.5
        return self.t

    def mix(self, u):
        self.t += 0.25
        return self.w * self.k + u

    def grow(self, v):
        self.w = self.w * v
        self.h.append(v)
        return self.w


class Derived(Base):
    k = 0.5

    def step(self, v):
        if v < 0.0:
            self.w += v
            return super().step(v) + self.h[0]
        return super().step(v * self.k)


'''
# by kind of variable, what makes a number or an array of one; {v} is its name, {n} a number, {a} an array
NUMBERS = {"number": ["{v}"], "object": ["{v}.t", "{v}.step({n})"],
           "numbers": ["{v}[0]", "{v}[-1]", "sum({v})", "len({v})"],  "dict": ['{v}["k"]'],
           "function": ["{v}({n})"], "array": ["np.sum({v})"]}
ARRAYS = {"array": ["{v}"], "object": ["{v}.w", "{v}.mix({a})"], "arrays": ["{v}[0]", "{v}[-1]"],
          "dict": ['{v}["a"]', '{v}["b"]']}
CHANGES = {
    "object": ["{v}.t = {n}", "{v}.t += {n}", "{v}.w = {a}", "{v}.w += {n}", "{v}.w[1] = {n}", "{v}.w[:2] *= {n}",
               "{v}.step({n})", "{v}.grow({n})", "{v}.h.append({n})"],
    "arrays": ["{v}[0] = {a}", "{v}[-1] += {a}", "{v}[1] *= {n}", "{v}.append({a})", "{v} = list({v})",
               "{v} = {v}[::-1]", "{v} = [q * 0.5 for q in {v}]"],
    "numbers": ["{v}[0] = {n}", "{v}[-1] += {n}", "{v}.append({n})", "{v}.insert(1, {n})", "{v}.append({v}.pop(0))",
                "{v}.reverse()", "{v} = {v} + [{n}]", "{v} += [{n}]"],
    "dict": ['{v}["k"] += {n}', '{v}["a"] = {a}', '{v}["b"] *= {n}', '{v}["a"], {v}["b"] = {v}["b"], {a}'],
    "array": ["{v}[0] = {n}", "{v} += {a}", "{v} *= {n}", "{v}[1:] += {n}", "{v} = {a}"],
    "number": ["{v} += {n}", "{v} *= {n}", "{v} = {n}"]}
MADE = {"number": "{n}", "array": "{a}", "arrays": "[{a}, {a}]", "numbers": "[{n}, {n}, {n}]",
        "object": "Base({a}, {n})", "dict": '{{"a": {a}, "b": {a}, "k": {n}}}', "function": "lambda p: p * {n}"}
RETURNED = {"number": "{v}", "array": "np.sum({v})", "numbers": "sum({v})", "arrays": "sum(np.sum(q) for q in {v})",
            "object": "np.sum({v}.w) * {v}.t", "dict": 'np.sum({v}["a"]) + {v}["k"] * np.sum({v}["b"])',
            "function": "{v}(0.3)"}


class Program:
    """One program on its way: its lines, and the kinds of the variables that are bound here."""

    numbers, arrays, changes, made = NUMBERS, ARRAYS, CHANGES, MADE

    def __init__(self, seed: int):
        self.random, self.lines, self.depth, self.loops, self.count = random.Random(seed), [], 1, 0, 0
        self.kinds: dict[str, str] = {}

    def write(self, line: str) -> None:
        self.lines.append("    " * self.depth + line)

    def fresh(self) -> str:
        self.count += 1
        return f"v{self.count}"

    def variable(self, kind: str) -> str | None:
        found = [v for v, k in self.kinds.items() if k == kind]
        return self.random.choice(found) if found else None

    def filled(self, form: str, variable: str | None = None, depth: int = 1) -> str:
        """A form with numbers and arrays of its own in each place."""
        form = form.replace("{v}", variable or "")
        while "{n}" in form:
            form = form.replace("{n}", self.number(depth + 1), 1)
        while "{a}" in form:
            form = form.replace("{a}", self.array(depth + 1), 1)
        return form.replace("{{", "{").replace("}}", "}")

    def of_variable(self, forms: dict[str, list[str]], depth: int) -> str | None:
        kind = self.random.choice(list(forms))
        variable = self.variable(kind)
        return self.filled(self.random.choice(forms[kind]), variable, depth) if variable else None

    def number(self, depth: int = 0) -> str:
        choice = self.random.randrange(3 if depth > 2 else 6)
        if choice > 2 and (found := self.of_variable(self.numbers, depth)):
            return found
        if choice == 0 or depth > 2:
            return self.random.choice(["0.5", "1.5", "-0.7", f"x[{self.random.randrange(4)}]"])
        forms = ["({n} + {n})", "({n} * {n})", "({n} - {n})", "np.sin({n})", "np.sum({a})"]
        return self.filled(self.random.choice(forms), depth=depth)

    def array(self, depth: int = 0) -> str:
        choice = self.random.randrange(2 if depth > 2 else 5)
        if choice > 1 and (found := self.of_variable(self.arrays, depth)):
            return found
        if choice == 0 or depth > 2:
            return "x"
        return self.filled(self.random.choice(["({a} + {a})", "({n} * {a})", "np.sin({a})", "{a}.copy()"]), depth=depth)

    def test(self) -> str:
        return self.filled(self.random.choice(
            ["{n} > 1.0", "x[1] < 1.0", "x[0] > 0.1 and {n} < 2.0", "not x[2] > 1.0", "True", "1 > 2"]))

    def bind(self, variable: str, kind: str) -> None:
        self.kinds[variable] = kind

    # -- statements --------------------------------------------------------------------------------------------------
    def statement(self) -> None:
        forms = [self.make, self.change, self.change, self.alias, self.branch, self.loop, self.jump, self.define]
        self.random.choice(forms[:4] if self.depth > 3 else forms)()

    def make(self) -> None:
        kind = self.random.choice(list(self.made))
        form = self.made[kind].replace("Base", self.random.choice(["Base", "Derived"]))
        value, variable = self.filled(form), self.fresh()
        self.write(f"{variable} = {value}")
        self.bind(variable, kind)

    def change(self) -> None:
        kind = self.random.choice(list(self.changes))
        variable = self.variable(kind)
        if variable:
            self.write(self.filled(self.random.choice(self.changes[kind]), variable))

    def alias(self) -> None:
        kind = self.random.choice(["arrays", "numbers", "object", "dict", "array"])
        variable = self.variable(kind)
        if variable:
            other = self.fresh() if self.random.random() < 0.6 else self.variable(kind) or variable
            self.write(f"{other} = {variable}")
            self.bind(other, kind)

    def branch(self) -> None:
        self.write(f"if {self.test()}:")
        self.block()
        if self.random.random() < 0.6:
            self.write("else:")
            self.block()

    def loop(self) -> None:
        kinds = dict(self.kinds)
        kind = self.random.choice(["range", "size", "numbers", "arrays", "while"])
        through, variable = self.variable(kind) if kind in ("numbers", "arrays") else None, self.fresh()
        if through:
            self.write(f"for {variable} in list({through}):")
            self.bind(variable, kind[:-1])
        elif kind == "while":
            self.write(f"{variable} = 0")
            self.write(f"while {variable} < 3:")
            self.lines.append("    " * (self.depth + 1) + f"{variable} += 1")
        else:
            self.write(f"for {variable} in range({'x.size' if kind == 'size' else 3}):")
        self.loops += 1
        self.block()
        self.loops -= 1
        self.kinds = kinds

    def jump(self) -> None:
        if self.loops:
            self.write(f"if {self.test()}:")
            self.lines.append("    " * (self.depth + 1) + self.random.choice(["break", "continue"]))

    def define(self) -> None:
        name, kinds, loops = self.fresh(), dict(self.kinds), self.loops
        self.write(f"def {name}(p):")
        self.depth, self.loops = self.depth + 1, 0
        changed = self.variable("object")
        if changed:
            self.write(f"{changed}.t += {self.number(2)}")
        self.bind("p", "number")
        if self.random.random() < 0.5:
            self.write(f"if {self.test()}:")
            self.lines.append("    " * (self.depth + 1) + f"return {self.number(1)}")
        self.write(f"return {self.number(1)}")
        self.depth, self.loops, self.kinds = self.depth - 1, loops, kinds
        self.bind(name, "function")

    def block(self) -> None:
        kinds = dict(self.kinds)
        self.depth += 1
        for _ in range(self.random.randrange(1, 4)):
            self.statement()
        self.write("pass")
        self.depth -= 1
        self.kinds = kinds


def source(seed: int) -> str:
    """The module of a program."""
    program = Program(seed)
    for _ in range(program.random.randrange(6, 16)):
        program.statement()
    parts = [RETURNED[k].replace("{v}", v) for v, k in program.kinds.items()]
    program.write("return " + " + ".join(parts[:8] or ["x[0]"]))
    return HEAD + "def f(x):\n" + "\n".join(program.lines) + "\n"
