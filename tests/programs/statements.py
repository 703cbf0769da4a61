"""Random statements of the supported language, for `programs`: each kind is a method named after its feature."""
from __future__ import annotations

from collections.abc import Callable

from tests.programs.expressions import Choices, Expressions, Scope

# how often each kind is chosen; the simplest first
SIMPLE = {"scalar": 5, "store": 6, "augment": 5, "accumulate": 3, "whole": 2, "local": 2, "row": 1, "integer": 1,
          "flag": 1, "unpack": 1, "swap": 1, "mutate": 2, "pair": 1, "guard": 1, "chain": 1}


class SimpleStatements(Expressions):
    """Writes the body of one function, line by line; loops and branches are added by `loops`."""

    def __init__(self, choices: Choices, scope: Scope, without: frozenset[str] = frozenset()):
        super().__init__(choices)
        self.scope = scope
        self.without = without
        self.lines: list[str] = []
        self.indent = 1
        self.used = scope.names()
        self.loops: list[bool] = []          # of the loops around: whether `continue` is safe
        self.results: Callable[[], str] | None = None
        self.mutators: list[tuple[str, int]] = []
        self.pairs: list[str] = []
        self.budget = 30
        self.written: set[str] = set()       # arrays that are stored to, rows by their matrix
        self.bases: dict[str, str] = {}
        self.sizes = ["n", "3"]              # the sizes that have a name here
        self.loops_of: dict[str, int] = {}
        self.alone: set[str] = set()

    # -- blocks -----------------------------------------------------------------------------------------------------
    def write(self, line: str) -> None:
        self.lines.append("    " * self.indent + line)

    def fresh(self, stem: str) -> str:
        k = 0
        while f"{stem}{k}" in self.used:
            k += 1
        self.used.add(f"{stem}{k}")
        return f"{stem}{k}"

    def root(self, array: str) -> str:
        """The array that a name is a part of."""
        while array in self.bases:
            array = self.bases[array]
        return array

    # -- simple statements ------------------------------------------------------------------------------------------
    def bind(self, value: str) -> str:
        """Assigns a tame value to a new or an old scalar."""
        known = self.scope.assignable()
        name = self.choices.pick(known) if known and self.choices.chance(55) else self.fresh("s")
        self.write(f"{name} = {value}")
        if name not in self.scope.floats:
            self.scope.floats.append(name)
        return name

    def scalar(self) -> None:
        self.bind(self.tame(2))

    def chain(self) -> None:
        a = self.fresh("s")
        if self.choices.chance(50):
            b = self.fresh("s")
            self.write(f"{a} = {b} = {self.tame(1)}")
            self.scope.floats += [a, b]
        else:
            self.write(f"{a}: float = {self.tame(2)}")
            self.scope.floats.append(a)

    def target(self) -> str | None:
        arrays = [*self.scope.vectors, *self.scope.matrices]
        arrays = [a for a in arrays if a not in self.scope.frozen]
        return self.element(self.marked(self.choices.pick(arrays))) if arrays else None

    def marked(self, array: str) -> str:
        """The array, of which it is noted that it is written."""
        self.written.add(self.bases.get(array, array))
        return array

    def store(self) -> None:
        if (target := self.target()) is not None:
            self.write(f"{target} = {self.tame(2)}")

    def augment(self) -> None:
        """An augmented assignment that keeps its target between -2 and 2."""
        c, known = self.choices, self.scope.assignable()
        target = c.pick(known) if known and c.chance(35) else self.target()
        if target is None:
            return
        e = self.tame(1)
        self.write(c.pick([f"{target} += {c.number(0.05, 0.4)} * ({e} - {target})", f"{target} *= 0.5",
                           f"{target} -= 0.2 * ({target} - ({e}))", f"{target} /= 1.0 + ({e}) ** 2",
                           f"{target} *= 0.4 + 0.3 * np.sin({e})", f"{target} /= 2.5 + math.cos({e})"]))

    def accumulate(self) -> None:
        c, scope = self.choices, self.scope
        if scope.wide_vectors and c.chance(60):
            target = self.element(self.marked(c.pick(list(scope.wide_vectors))))
        elif scope.wides and self.indent > 1:
            target = c.pick(scope.wides)
        elif not self.loops:
            name = self.fresh("total")
            self.write(f"{name} = 0.0")
            scope.wides.append(name)
            return
        else:
            return
        self.write(f"{target} {c.pick(['+=', '-='])} {self.tame(1)}")

    def whole(self) -> None:
        c, scope = self.choices, self.scope
        arrays = [a for a in [*scope.vectors, *scope.matrices] if a not in scope.frozen]
        if not arrays:
            return
        u = self.marked(c.pick(arrays))
        size = scope.vectors.get(u)
        v = c.pick([a for a in ([n for n, s in scope.vectors.items() if s == size] if size else scope.matrices)])
        at = c.pick([f"{u}[:]", f"{u}[...]"])
        e = self.tame(1)
        self.write(c.pick([f"{at} = 0.0", f"{at} = {v}", f"{at} = {e}", f"{u} += 0.2 * ({v} - {u})", f"{u} *= 0.75",
                           f"{at} = 0.5 * {v} - 0.4 * {u} * {self.atom()}", f"{at} = np.sin({v})",
                           f"{u} -= 0.3 * ({u} - np.tanh({v}))", f"{u} /= 1.5 + {v} ** 2",
                           f"{at} = 0.5 * ({u} + {v}) * np.cos({v})"]))

    def local(self) -> None:
        c, scope = self.choices, self.scope
        name = self.fresh("w")
        size = c.pick(self.sizes)
        like = [v for v, s in scope.vectors.items() if s == size]
        forms = [f"np.zeros({size})", f"np.ones({size})", f"np.full({size}, {self.tame(1)})", "empty"]
        if like:
            v = c.pick(like)
            forms += [f"np.zeros_like({v})", f"{v}.copy()", f"0.5 * {v}", f"0.4 * {v} * {c.pick(like)} + 0.1"]
        if size == "3":
            forms += [f"np.array([{self.tame(1)}, {self.atom()}, {self.atom()}])"]
        form = c.pick(forms)
        self.write(f"{name} = np.empty({size})" if form == "empty" else f"{name} = {form}")
        if form == "empty":
            self.write(f"{name}[:] = {self.atom()}")
        scope.vectors[name] = size

    def row(self) -> None:
        if not self.scope.matrices:
            return
        matrix = self.choices.pick(self.scope.matrices)
        name = self.fresh("row")
        self.write(f"{name} = {matrix}[{self.index('n')}]")
        self.bases[name] = self.root(matrix)
        self.scope.vectors[name] = "3"

    def integer(self) -> None:
        c, scope = self.choices, self.scope
        known = [i for i in scope.ints if i.startswith("k") and i not in scope.frozen]
        if known and c.chance(50):
            self.write(f"{c.pick(known)} += {c.integer(1, 3)}")
        elif scope.ints:
            name, size = self.fresh("k" if c.chance(40) else "at"), c.pick(self.sizes)
            self.write(f"{name} = ({c.integer(1, 3)} * {c.pick(list(scope.ints))} + {c.integer(0, 4)}) % {size}")
            scope.ints[name] = None if name.startswith("k") else size

    def flag(self) -> None:
        name = self.fresh("ok")
        self.write(f"{name} = {self.condition()}")
        self.scope.bools.append(name)

    def unpack(self) -> None:
        c, scope = self.choices, self.scope
        threes = [v for v, s in scope.vectors.items() if s == "3"]
        a, b, d = self.fresh("s"), self.fresh("s"), self.fresh("s")
        forms = [f"{a}, {b}, {d} = {self.tame(1)}, {self.atom()}, {self.atom()}",
                 f"({a}, {b}), {d} = ({self.atom()}, {self.tame(1)}), {self.atom()}"]
        self.write(c.pick(forms + [f"{a}, {b}, {d} = {v}" for v in threes] * 2))
        scope.floats += [a, b, d]

    def swap(self) -> None:
        known = self.scope.assignable()
        if len(known) > 1 and self.choices.chance(50):
            target, other = known[-1], known[0]
        else:
            target, other = self.target(), self.target()
        if target is not None and other is not None:
            self.write(f"{target}, {other} = {other}, {target}")

    def mutate(self) -> None:
        c, scope = self.choices, self.scope
        arrays = [v for v in scope.vectors if v not in scope.frozen]
        if not self.mutators or not arrays:
            return
        name, count = c.pick(self.mutators)
        u = self.marked(c.pick(arrays))
        same = [v for v, s in scope.vectors.items() if s == scope.vectors[u]]
        # parts of one array may be the same memory under two names: only one of them is passed
        others = [v for v in same if v == u or self.root(v) != self.root(u)]
        self.write(f"{name}({u}, {', '.join([c.pick(others)] * (count - 1) + [self.tame(1)])})")

    def pair(self) -> None:
        if self.pairs:
            a, b = self.fresh("s"), self.fresh("s")
            self.write(f"{a}, {b} = {self.choices.pick(self.pairs)}({self.tame(1)}, {self.atom()})")
            self.scope.floats += [a, b]

    def guard(self) -> None:
        e = self.atom()
        self.write(self.choices.pick([f"assert {e} < 50.0", f"assert abs({e}) < 50.0, 'out of bounds'"]))
