"""Random statements about memory that functions give, for `programs`: each kind is a method named after its feature.

Views that functions make and that are written beside their operands, helpers that return arrays, buffers that change
places, lists of arrays of which a variable picks one.
"""
from __future__ import annotations

from tests.programs.array_expressions import Shape
from tests.programs.combinations import CombinedStatements

# how often each kind is chosen
GIVEN = {"viewed": 2, "made": 3, "exchanged": 1, "picked_one": 1}


class FunctionStatements(CombinedStatements):
    """Writes statements about memory that functions give."""

    makers: list[str] = []          # the helpers that return arrays
    given: frozenset[str] = frozenset()     # the kernel's parameters

    def _of_function(self, base: str) -> tuple[str, Shape]:
        """A view that a function makes of an array, with its shape."""
        c, matrix = self.choices, base in self.scope.matrices
        size = "n" if matrix else self.scope.vectors[base]
        forms: list[tuple[str, Shape]] = [(f"{base}.T", (size,)), (f"np.asarray({base})", (size,)),
                                          (f"{base}.reshape({size}, 1)", (size, "1")),
                                          (f"np.reshape({base}, (1, -1))", ("1", size))]
        if matrix:
            forms = [(f"{base}.ravel()", ("n * 3",)), (f"{base}.reshape(-1)", ("n * 3",)), (f"{base}.T", ("3", "n")),
                     (f"{base}.reshape(3, n)", ("3", "n")), (f"np.transpose({base})", ("3", "n")),
                     (f"{base}.swapaxes(0, 1)", ("3", "n")), (f"np.ravel({base})", ("n * 3",))]
        return c.pick(forms)

    def _element(self, shape: Shape) -> str:
        """The subscript of an element of an array of this shape."""
        return ", ".join("0" if s == "1" else f"{self.choices.integer(0, 8)} % ({s})" for s in shape)

    def viewed(self) -> None:
        """A view that a function makes; it and its operand are written and read in turn."""
        c, scope = self.choices, self.scope
        bases = [a for a in (*scope.matrices, *scope.vectors) if a not in scope.frozen and a in self.given]
        if not bases:
            return
        base, name = self.marked(c.pick(bases)), self.fresh("seen")
        view, shape = self._of_function(base)
        self.write(f"{name} = {view}")
        inner = "    " if c.chance(30) else ""
        if inner:
            self.write(f"for {self.fresh('round')} in range({c.integer(1, 3)}):")
        for _ in range(c.integer(1, 4)):
            forms = [f"{name}[{self._element(shape)}] = {self.tame(1)}",
                     f"{name}[{self._element(shape)}] *= 0.5 + 0.3 * np.sin({self.tame(1)})",
                     self.change(f"{name}[...]", f"np.sin({name})"),
                     f"{base}[{self.index('n' if base in scope.matrices else scope.vectors[base])}] = {self.tame(1)}"]
            self.write(inner + c.pick(forms[:3] if inner else forms))     # both by elements in a loop is refused
        self.bind(f"0.5 * {name}[{self._element(shape)}] + 0.5 * {base}[{'0, 0' if base in scope.matrices else '0'}]")

    def made(self) -> None:
        """What a helper returns: a new array, stored, added, handed on, or the next value of a name in a loop."""
        c, scope = self.choices, self.scope
        size = c.pick(["n", "3"])
        like = [v for v, s in scope.vectors.items() if s == size]
        if not self.makers or not like:
            return
        maker, u = c.pick(self.makers), c.pick(like)
        called = f"{maker}({u}, {self.tame(1)})"
        free = self.vectors_to_write(size)
        if free and c.chance(40):
            out = self.marked(c.pick(free))
            self.write(c.pick([f"{out}[:] = {called}", f"{out} += 0.2 * ({called} - {out})",
                               f"{out}[:] = 0.5 * {called} + 0.5 * {c.pick(self.makers)}({c.pick(like)}, 0.3)",
                               f"{out}[:] = {maker}({called}, {self.atom()})"]))
            return
        name = self.fresh("new")
        self.write(f"{name} = {called}")
        if c.chance(50):
            self.write(c.pick([f"{name} *= 0.5 + 0.3 * np.sin({u})", f"{name}[0] = {self.tame(1)}",
                               f"{name} = {c.pick(self.makers)}({name}, {self.atom()})"]))
        if c.chance(30):
            self.write(f"for {self.fresh('round')} in range({c.integer(1, 3)}):")
            self.write(f"    {name} = {c.pick([f'{maker}({name}, {self.atom()})', f'0.5 * {name} + 0.4 * {called}'])}")
        scope.vectors[name] = size

    def exchanged(self) -> None:
        """Two buffers that change places in a loop."""
        c, size = self.choices, self.choices.pick(["n", "3"])
        old, new = self.fresh("old"), self.fresh("next")
        self.write(f"{old} = {self.new_values((size,))}")
        self.write(f"{new} = np.zeros({size})")
        turn = self.fresh("round")
        self.write(f"for {turn} in range({c.pick(['2', '3', *(i for i in ('steps',) if i in self.scope.ints)])}):")
        if c.chance(40):
            i = self.fresh("i")
            self.write(f"    for {i} in range(1, {size} - 1):")
            self.write(f"        {new}[{i}] = 0.4 * {old}[{i} - 1] + 0.5 * np.sin({old}[{i} + 1] * {self.atom()})")
        else:
            self.write(f"    {new}[1:] = 0.9 * {old}[:-1] * np.cos({old}[1:])")
        if c.chance(50):
            self.write(f"    {new}[0] = {self.tame(1)}")
        self.write(f"    {old}, {new} = {new}, {old}")
        free = self.vectors_to_write(size)
        if free:
            self.write(f"{self.marked(c.pick(free))}[:] = {c.pick([old, new, f'0.5 * ({old} - {new})'])}")
        else:
            self.bind(f"0.5 * ({old}[0] + {new}[1])")

    def picked_one(self) -> None:
        """A list of two arrays; a variable says which is read and which is written."""
        c, size = self.choices, self.choices.pick(["n", "3"])
        names = [self.fresh("buf"), self.fresh("buf")]
        self.write(f"{names[0]} = {self.new_values((size,))}")
        self.write(f"{names[1]} = 0.9 * np.cos({names[0]})")
        both, turn = self.fresh("bufs"), self.fresh("round")
        self.write(f"{both} = [{names[0]}, {names[1]}]")
        self.write(f"for {turn} in range({c.integer(1, 4)}):")
        here, there = f"{both}[{turn} % 2]", f"{both}[({turn} + 1) % 2]"
        self.write("    " + c.pick([f"{there}[1:] = 0.8 * np.sin({here}[:-1]) + 0.1 * {here}[1:]",
                                    f"{there}[:] = np.tanh({here} * {self.atom()})",
                                    f"{there}[0] = 0.5 * {here}[1] * {here}[2]"]))
        if c.chance(50):
            self.write(f"    {here}[{self.index('3')}] = {self.tame(1)}")
        self.bind(f"0.5 * {both}[{c.integer(0, 1)}][1] + 0.5 * {both}[{c.integer(0, 1)}][0]")
