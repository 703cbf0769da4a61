"""Random branches, loops and ways out of them, for `programs`: what makes a `Writer` of simple statements complete."""
from __future__ import annotations

from collections.abc import Callable

from tests.programs.arrays import ARRAYS
from tests.programs.combinations import COMBINED
from tests.programs.functions import GIVEN
from tests.programs.results import RESULTS, ResultStatements
from tests.programs.statements import SIMPLE

COMPOUND = {"branch": 3, "loop": 5, "over": 2, "trips": 2}
EXITS = {"leave": 1, "skip": 1, "result": 1}
FEATURES = (*SIMPLE, *COMPOUND, *EXITS, "arrays", *ARRAYS, *COMBINED, *GIVEN, *RESULTS)


class Writer(ResultStatements):
    """Writes the body of one function."""

    # -- blocks -----------------------------------------------------------------------------------------------------
    def block(self, depth: int, count: int, first: Callable[[], None] | None = None) -> None:
        """An indented block; names that it binds are not known after it."""
        outside = self.scope
        self.scope = outside.copy()
        self.scope.mine = {}
        self.indent += 1
        if first:
            first()
        at = len(self.lines)
        self.statements(depth, count)
        if len(self.lines) == at:
            self.scalar()
        self.indent -= 1
        self.scope = outside

    def statements(self, depth: int, count: int) -> None:
        often = 3 if self.indent == 1 else 1
        weights = {**SIMPLE, **({k: often * w for k, w in COMPOUND.items()} if depth else {})}
        if self.loops or self.indent > 1:
            weights.update(EXITS)
        if self.arrays:
            weights.update({**ARRAYS, **COMBINED, **GIVEN, **RESULTS})
        kinds = [k for k, w in weights.items() if k not in self.without for _ in range(w)]
        for _ in range(count):
            if self.budget <= 0:
                return
            self.budget -= 1
            kind = self.choices.pick(kinds)
            if kind in COMPOUND:
                getattr(self, kind)(depth - 1)
            else:
                getattr(self, kind)()

    # -- ways out ---------------------------------------------------------------------------------------------------
    def leave(self) -> None:
        if self.loops:
            self.write(f"if {self.condition()}:")
            if self.choices.chance(40):
                self.block(0, 1)
            self.write("    break")

    def skip(self) -> None:
        if self.loops and self.loops[-1]:
            self.write(f"if {self.condition()}:")
            if self.choices.chance(40):
                self.block(0, 1)
            self.write("    continue")

    def result(self) -> None:
        if self.results is not None and self.choices.chance(50):
            self.write(f"if {self.condition()}:")
            self.write(f"    return {self.results()}".rstrip())

    # -- compound statements ----------------------------------------------------------------------------------------
    def branch(self, depth: int) -> None:
        c = self.choices
        self.write(f"if {self.condition()}:")
        self.block(depth, c.integer(1, 3))
        if c.chance(25):
            self.write(f"elif {self.condition()}:")
            self.block(depth, c.integer(1, 2))
        if c.chance(45):
            self.write("else:")
            self.block(depth, c.integer(1, 2))

    def _counter(self) -> str:
        """A loop variable's name: one that an earlier loop used, if it is free again."""
        for name in ("i", "j", "k_", "l"):
            if name not in self.scope.ints and name not in self.scope.names() and name not in self.alone:
                self.used.add(name)
                self.loops_of[name] = self.loops_of.get(name, 0) + 1
                return name
        return self.fresh("i")

    def _range(self) -> tuple[str, str | None]:
        """The bounds of a range, and the size that its values index."""
        c, size = self.choices, self.choices.pick(self.sizes)
        inner = [i for i, s in self.scope.ints.items() if s == size]
        forms = [f"{size}", f"1, {size}", f"{size} - 1", f"{size} - 1, -1, -1", f"0, {size}, 2", f"{size} - 1, 0, -2",
                 f"1, {size} - 1"]
        forms += [f for i in inner for f in (f"{i}", f"{i}, {size}", f"{i} + 1, {size}", f"{i}, -1, -1")]
        if c.chance(20):
            steps = ["steps", "steps, 0, -1"] if "steps" in self.scope.ints else []
            return c.pick(["2", "3", "-2, 3", *steps]), None
        return c.pick(forms), size

    def loop(self, depth: int) -> None:
        bounds, size = self._range()
        counter = self._counter()

        def first() -> None:
            self.scope.ints[counter] = size
            self.scope.frozen.add(counter)
        self._looped(f"for {counter} in range({bounds}):", depth, first)
        if self.choices.chance(10) and bounds in (size, f"1, {size}", f"{size} - 1, -1, -1"):
            last = self.fresh("last")        # a loop that surely runs leaves its counter behind
            self.write(f"{last} = {counter}")
            self.scope.ints[last] = size

    def _looped(self, head: str, depth: int, first: Callable[[], None], safe: bool = True) -> None:
        c = self.choices
        self.write(head)
        self.loops.append(safe)
        self.block(depth, c.integer(1, 4), first)
        self.loops.pop()
        if head.startswith("for") and c.chance(6):
            self.write("else:")
            self.block(0, 1)

    def over(self, depth: int) -> None:
        """A loop over arrays: their elements, their rows, two at once, backwards."""
        c, scope = self.choices, self.scope
        forms: list[Callable[[], tuple[str, list[str], list[str], dict[str, str | None]]]] = []
        v, u = self.fresh("v"), self.fresh("v")
        i = self._counter()
        vectors = [a for a in scope.vectors]
        for a in vectors[:3]:
            size = scope.vectors[a]
            b = c.pick([x for x, s in scope.vectors.items() if s == size])
            forms += [lambda a=a: (f"for {v} in {a}:", [v], [], {}),
                      lambda a=a, s=size: (f"for {i}, {v} in enumerate({a}):", [v], [], {i: s}),
                      lambda a=a, b=b: (f"for {v}, {u} in zip({a}, {b}):", [v, u], [], {})]
        row = self.fresh("row")
        for m in scope.matrices:
            self.bases[row] = self.root(m)
            forms += [lambda m=m: (f"for {row} in {m}:", [], [row], {}),
                      lambda m=m: (f"for {i}, {v} in np.ndindex({m}.shape):", [], [], {i: "n", v: "3"})]
        forms += [lambda: (f"for {i} in reversed(range(n)):", [], [], {i: "n"}),
                  lambda: (f"for {i}, {v} in np.ndindex(n, 3):", [], [], {i: "n", v: "3"})]
        head, floats, rows, ints = c.pick(forms)()

        def first() -> None:
            self.scope.floats += floats
            self.scope.vectors.update(dict.fromkeys(rows, "3"))
            self.scope.ints.update(ints)
            self.scope.frozen.update(ints)
        self._looped(head, depth, first)

    def trips(self, depth: int) -> None:
        """A while loop that ends: a counter, a scalar that shrinks, or a break."""
        c = self.choices
        shrinking = c.chance(40)
        if shrinking:
            name = self.fresh("left")
            self.write(f"{name} = 1.1 + 0.4 * {self.atom()}")
            head, step = f"while {name} > {c.number(0.25, 0.45)}:", f"{name} *= 0.5 + 0.1 * np.tanh({self.atom()})"
        else:
            name = self.fresh("count")
            self.write(f"{name} = 0")
            limit = f"{name} < {c.pick(['3', '2', *(i for i in ('steps',) if i in self.scope.ints)])}"
            head = c.pick([f"while {limit}:", f"while {limit} and {self.condition(0)}:", "while True:"])
            step = f"{name} += 1"
        early = c.chance(50)
        stop = f"if {name} > {c.integer(1, 3)}{' or ' + self.condition(0) if c.chance(40) else ''}:"

        def known() -> None:
            if shrinking:
                self.scope.floats.append(name)
            else:
                self.scope.ints[name] = None
            self.scope.frozen.add(name)

        def first() -> None:
            known()
            if early or head == "while True:":
                self.write(step)
            if head == "while True:":
                self.write(stop)
                self.write("    break")
        self._looped(head, depth, first, early or head == "while True:")
        if not (early or head == "while True:"):
            self.write("    " + step)
        known()
