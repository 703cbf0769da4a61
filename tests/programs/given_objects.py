"""Random programs of objects that are given: f(x, s) of four floats and an object, which gives a float.

As in `structures`, and the object is reached in many ways: objects in objects, lists and dicts, one object or array in
two places; its numbers, truth values and arrays are assigned, in helpers, loops, branches and methods. The helpers of
the module take and return arrays and objects, and may be called with one twice.
"""
from __future__ import annotations

import random
from typing import Any

import numpy as np

from tests.programs import structures
from tests.programs.structures import ARRAYS, CHANGES, MADE, NUMBERS, RETURNED, Program

HEAD = "import copy\n" + structures.HEAD + '''class Given:

    def __init__(self, first, second, parts, u, v, named):
        self.first, self.second, self.parts, self.u, self.v, self.named = first, second, parts, u, v, named
        self.t, self.k, self.on, self.h = 0.7, 1, True, [0.4, 1.2]

    def turn(self, v):
        if self.on:
            self.t = self.t * v
            self.on = self.t > 0.0
            return self.t
        self.k = (self.k + 1) % 3
        return self.first.step(v) + self.u[self.k]


def pieces(u, k):
    for e in u:
        if e > 1.5:
            return
        yield e * k


def total(*numbers, **more):
    return sum(numbers) * 0.5 + sum(more.values())


'''
# one object has these names: its kind by name
GIVEN = {"x": "array", "s": "given", "s.first": "object", "s.second": "object", "s.parts": "objects", "s.u": "array",
         "s.v": "array", "s.named": "dict", 's.named["o"]': "object", "s.t": "number", "s.k": "integer",
         "s.on": "flag", "s.h": "numbers", "s.first.t": "number", "s.second.t": "number", "s.parts[0]": "object",
         "s.parts[-1].t": "number", "s.first.w": "array", "s.first.h": "numbers", "s.first.h[0]": "number"}
MORE_NUMBERS = {"given": ["{v}.turn({n})"], "integer": ["{v}", "x[{v} % 4]"], "flag": ["(1.5 if {v} else {n})"],
                "objects": ["{v}[0].t", "sum(o.t for o in {v})"], "functions": ["{v}[-1]({n})",
                                                                              "sum(g({n}) for g in {v})"],
                "numbers": [*NUMBERS["numbers"], "total(*{v})", "total({n}, *{v}, k={n})"],
                "array": [*NUMBERS["array"], "sum(pieces({v}, {n}))", "{v}[1]", "np.dot({v}, {a})", "{v}[::-1][0]",
                          "({n} if {v}[2] > 0.8 else {n})", "max({v}[0], {n})"],
                "dict": [*NUMBERS["dict"], "sum(np.sum({v}[q]) for q in ('a', 'b', 'k'))"]}
MORE_CHANGES = {
    "given": ["{v}.turn({n})", "{v}.u, {v}.v = {v}.v, {v}.u", "{v}.u = {v}.v", "{v}.v = {a}", "{v}.first = {v}.second",
              "{v}.first, {v}.second = {v}.second, {v}.first", "{v}.first.w = {v}.u", "{v}.second.t = {v}.t",
              "{v}.h = [{n}, {n}]", "{v}.parts[0] = {v}.first", "{v}.t, {v}.first.t = {v}.first.t, {n}"],
    "integer": ["{v} += 1", "{v} = ({v} * 2 + 1) % 3", "{v} = len(x) - {v}", "{v} = {v} if {n} > 1.0 else 2"],
    "flag": ["{v} = not {v}", "{v} = {n} > 0.5", "{v} = {v} and {n} < 1.0", "{v} = False"],
    "objects": ["{v}[0], {v}[1] = {v}[1], {v}[0]", "{v}[0].t += {n}", "{v}[-1].w = {v}[0].w",
                "{v} = [Base(o.w, o.t * {n}) for o in {v}]", "for o in {v}: o.t *= {n}",
                "for o in {v}: o.w = o.w * {n}"],
    "functions": ["{v}.append(lambda p: p * {n})", "{v}[0] = {v}[-1]"],
    "numbers": [*CHANGES["numbers"], "for e in {v}: {v}[-1] += e", "{v} = [e * {n} for e in {v} if e > 0.0]",
                "{v}[1] *= {n}", "{v}[0], {v}[-1] = {v}[-1], {n}", "{v}[1:] = [{n}]", "del {v}[1:]",
                "{v}.extend(pieces(x, {n}))"],
    "arrays": [*CHANGES["arrays"], "for q in {v}: q *= {n}", "for q in {v}: q[1:] += {n}",
               "{v}[0], {v}[1] = {v}[1], {v}[0]"],
    "array": [*CHANGES["array"], "{v}[:] = {v}[::-1]", "np.multiply({v}, {a}, out={v})", "{v} = {v}[::-1]",
              "{v}[::-1][:2] = {n}", "{v} = np.where({v} > 0.6, {a}, {n})", "{v} = np.array([e * {n} for e in {v}])",
              "{v}[1], {v}[2] = {v}[2], {n}"],
    "object": [*CHANGES["object"], "{v}.w = {v}.w[::-1]", "{v}.t = {v}.h[0] = {n}", "{v}.w, {v}.t = {a}, {v}.w[1]",
               "{v}.t, {v}.h[0] = {v}.h[0], {v}.t", "{v}.h[0] += {n}", "{v}.w[0] = {v}.t"],
    "dict": [*CHANGES["dict"], '{v}["k"] = {v}["k"] * {n}', '{v}["a"][1] = {n}', '{v}["a"] = {v}["b"]',
             '{v}.update(k={n}, b={a})']}
MORE_MADE = {"objects": "[Base({a}, {n}), Derived({a}, {n})]", "functions": "[lambda p: p + {n}, lambda p: p * {n}]",
             "array": "{a}[::-1]", "integer": "2", "flag": "{n} > 0.5"}
FORMS = (NUMBERS | MORE_NUMBERS, ARRAYS | {"given": ["{v}.u", "{v}.first.mix({a})"]}, CHANGES | MORE_CHANGES,
         MADE | MORE_MADE)
PARAMETERS = ("object", "object", "given", "array", "array", "number", "numbers", "dict", "arrays")
FINAL = RETURNED | {"integer": "{v} * 0.1", "flag": "{v}", "objects": "sum(o.t * np.sum(o.w) for o in {v})",
                    "functions": "{v}[0](0.7)",
                    "given": "np.sum({v}.u * {v}.v) * {v}.t + {v}.k * {v}.first.t + np.sum({v}.second.w)"}


class GivenProgram(Program):
    """A program with an object that is given, and the helpers of its module: by name the kinds of their parameters and
    of what they return."""

    numbers, arrays, changes, made = FORMS

    def __init__(self, seed: int):
        super().__init__(seed)
        self.helpers: dict[str, tuple[list[str], str]] = {}
        self.in_helper, self.result = False, ""

    def number(self, depth: int = 0) -> str:
        if depth > 2 and self.random.random() < 0.5 and (variable := self.variable("number")):
            return variable
        found = self.called("number", depth) if self.random.random() < 0.12 else None
        return found or super().number(depth)

    def array(self, depth: int = 0) -> str:
        if depth > 2 and self.random.random() < 0.6 and (variable := self.variable("array")):
            return variable
        found = self.called("array", depth) if self.random.random() < 0.2 else None
        return found or super().array(depth)

    def called(self, kind: str, depth: int) -> str | None:
        """A call of a helper, with variables of its parameters' kinds: one may be given twice."""
        names = [n for n, (_, returned) in self.helpers.items() if kind in (returned, "any")]
        if not names or depth > 2:
            return None
        name = self.random.choice(names)
        given = [self.array(3) if self.random.random() < 0.5 else self.variable("array") or "x"]
        for wanted in self.helpers[name][0]:
            found = self.variable(wanted)
            if wanted in ("number", "array") and self.random.random() < 0.4:
                found = self.filled("{n}" if wanted == "number" else "{a}", depth=depth + 1)
            if found is None:
                return None
            given.append(found)
        if self.random.random() < 0.3 and self.helpers[name][0][-1:] == ["number"]:
            given.pop()
        return f"{name}({', '.join(given)})"

    def statement(self) -> None:
        more = [self.early, self.call, self.call, self.call, self.function_in_loop, self.each_object, self.copied,
                self.until, self.outer_name]
        chance = self.random.random()
        if chance < 0.3:
            self.change()
        elif chance < 0.65 and self.depth < 4:
            self.random.choice(more)()
        else:
            super().statement()

    def call(self) -> None:
        found = self.called("any" if self.random.random() < 0.5 else "array", 0) or self.called("number", 0)
        if found:
            self.write(found)

    def early(self) -> None:
        """A return in a branch."""
        if self.in_helper and self.random.random() < 0.7:
            kind = self.result
            self.write(f"if {self.test()}:")
            self.depth += 1
            self.write(f"return {self.array(2) if kind == 'array' else self.number(2)}")
            self.depth -= 1
        elif not self.in_helper and self.random.random() < 0.3:
            self.write(f"if {self.test()}:")
            self.depth += 1
            self.write(f"return {self.number(1)}")
            self.depth -= 1

    def function_in_loop(self) -> None:
        """Functions of a loop's variable, as it is now or when they are called."""
        found, i = self.fresh(), self.fresh()
        self.write(f"{found} = []")
        self.write(f"for {i} in {self.random.choice(['range(3)', 'x', '(0.5, 1.5)', 'range(x.size)'])}:")
        self.depth += 1
        self.write(f"{found}.append(lambda p{self.random.choice(['', f', {i}={i}'])}: p * {i} + {self.number(2)})")
        self.depth -= 1
        self.bind(found, "functions")

    def each_object(self) -> None:
        """A loop over objects, some of them twice."""
        found, kinds = self.fresh(), dict(self.kinds)
        objects = [v for v in (self.variable("object"), self.variable("object")) if v]
        listed = self.variable("objects")
        if not objects:
            return
        form = f"({', '.join(objects)},)" if listed is None or self.random.random() < 0.5 else listed
        number = self.fresh()
        self.write(self.random.choice([f"for {found} in {form}:", f"for {number}, {found} in enumerate({form}):",
                                       f"for {found}, {number} in zip({form}, x):"]))
        self.bind(found, "object")
        if number in self.lines[-1]:
            self.bind(number, "number")
        self.loops += 1
        self.block()
        self.loops -= 1
        self.kinds = kinds

    def copied(self) -> None:
        """A copy of an object, with the arrays that it has or with its own."""
        variable = self.variable("object")
        if variable:
            found = self.fresh()
            self.write(f"{found} = copy.{self.random.choice(['copy', 'deepcopy'])}({variable})")
            self.bind(found, "object")

    def until(self) -> None:
        """A loop that goes on until an attribute is large."""
        variable, count, kinds = self.variable("object"), self.fresh(), dict(self.kinds)
        if variable:
            self.write(f"{count} = 0")
            self.write(f"while {variable}.t < {self.random.choice(['2.0', '3.0', self.number(2)])}:")
            self.depth += 1
            self.write(f"{count} += 1")
            self.write(f"if {count} > 3:")
            self.write("    break")
            self.write(f"{variable}.t = {variable}.t * 0.9 + {self.random.choice(['0.5', self.number(2)])}")
            self.depth -= 1
            self.loops += 1
            self.block()
            self.loops -= 1
            self.kinds = kinds

    def outer_name(self) -> None:
        """A function that binds a name of the function around it."""
        names = [v for v, k in self.kinds.items() if k in ("number", "array") and v.isidentifier()]
        names = [v for v in names if v.startswith("v") and self.depth == 1]
        if names:
            variable, found = self.random.choice(names), self.fresh()
            value = self.number(1) if self.kinds[variable] == "number" else self.array(1)
            self.write(f"def {found}(p):")
            self.write(f"    nonlocal {variable}")
            self.write(f"    {variable} = {variable} * p + {value}")
            self.write(f"    return p * {self.number(2)}")
            self.bind(found, "function")

    def helper(self) -> list[str]:
        """The text of a function of the module."""
        name, outer = f"helper{len(self.helpers)}", self.kinds
        kinds = [self.random.choice(PARAMETERS) for _ in range(self.random.randrange(1, 4))]
        names = [f"{n}{k}" for n, k in zip("abc", range(3))][:len(kinds)]
        self.kinds, self.in_helper, self.lines = dict(zip(names, kinds)), True, []
        for n, k in zip(names, kinds):
            if k in ("object", "given"):
                self.kinds |= {f"{n}.t": "number"}
        self.result = self.random.choice(["array", "number"])
        for _ in range(self.random.randrange(1, 5)):
            self.statement()
        of_kind = [v for v, k in self.kinds.items() if k == self.result]
        returned = self.random.choice(of_kind) if of_kind and self.random.random() < 0.6 else (
            self.array(1) if self.result == "array" else self.number(1))
        self.write(f"return {returned}")
        default = " = 0.6" if kinds[-1] == "number" else ""
        text = [f"def {name}(x, {', '.join(names)}{default.replace(' ', '')}):", *self.lines, "", ""]
        self.lines, self.kinds, self.in_helper = [], outer, False
        self.helpers[name] = kinds, self.result
        return text


def source(seed: int) -> str:
    """The module of a program."""
    program = GivenProgram(seed)
    helpers = [line for _ in range(program.random.randrange(4)) for line in program.helper()]
    program.kinds = {**GIVEN}
    for _ in range(program.random.randrange(3, 10)):
        program.statement()
    kinds = list(program.kinds.items())
    program.random.shuffle(kinds)
    parts = [FINAL[k].replace("{v}", v) for v, k in kinds]
    program.write("return " + " + ".join(parts[:8]))
    return HEAD + "\n".join(helpers) + "\ndef f(x, s):\n" + "\n".join(program.lines) + "\n"


def given(module: Any, seed: int) -> Any:
    """The object of a program: some of its arrays and objects are in two places."""
    chosen, rng = random.Random(seed), np.random.default_rng(seed)

    def array() -> Any:
        return rng.uniform(0.2, 1.7, 4)

    def part() -> Any:
        return chosen.choice([module.Base, module.Derived])(array(), float(rng.uniform(0.2, 1.7)))
    first, second, u, v = part(), part(), array(), array()
    shared = chosen.random() < 0.35
    if shared and chosen.random() < 0.5:
        second = first
    if shared and chosen.random() < 0.3:
        v = u
    if shared and chosen.random() < 0.3:
        first.w = u
    parts = [first if shared and chosen.random() < 0.3 else part(), part()]
    named = {"a": u if shared and chosen.random() < 0.3 else array(), "b": array(), "k": float(rng.uniform(0.2, 1.7)),
             "o": second if shared and chosen.random() < 0.3 else part()}
    return module.Given(first, second, parts, u, v, named)
