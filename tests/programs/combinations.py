"""Random statements that combine features, for `programs`: each kind is a method named after its feature.

What a mask picks before and after it changes, places that are sought in what is stored, products row by row, results
that are written into given arrays, axes and slices under names, helpers that write and return.
"""
from __future__ import annotations

from tests.programs.arrays import ArrayStatements

# how often each kind is chosen
COMBINED = {"remasked": 2, "sought": 2, "multiplied": 2, "into": 1, "along": 1, "sliced": 1, "given_back": 2}


class CombinedStatements(ArrayStatements):
    """Writes statements that combine features."""

    def vectors_to_write(self, size: str) -> list[str]:
        return [v for v, s in self.scope.vectors.items() if s == size and v not in self.scope.frozen]

    def remasked(self) -> None:
        """Stores and loads through a mask that changes in between."""
        c, scope, free = self.choices, self.scope, self.vectors_to_write("n")
        if not scope.flags or not free:
            return
        mask, v = c.pick(scope.flags), self.marked(c.pick(free))
        u = c.pick([a for a, s in scope.vectors.items() if s == "n"])
        values = [f"0.5 * {u}[{mask}] ** 2", self.tame(1), f"0.9 * np.sin({u}[{mask}])"]
        self.write(self.change(f"{v}[{mask}]", c.pick(values)))
        kept = self.fresh("few") if c.chance(40) else ""
        if kept:
            self.write(f"{kept} = {v}[{mask}] * 0.5")
        self.mask_changed()
        self.write(self.change(f"{v}[{mask}]", c.pick(values)))
        if kept:
            self.bind(f"np.sin(np.sum({kept})) * {self.atom()} * 0.5")

    def sought(self) -> None:
        """A store at the extreme of what is stored into, or of another array."""
        c, scope = self.choices, self.scope
        matrices = [m for m in scope.matrices if m not in scope.frozen]
        free = [v for v in scope.vectors if v not in scope.frozen]
        function = c.pick(["np.argmax", "np.argmin"])
        if matrices and c.chance(30):
            m = self.marked(c.pick(matrices))
            place = f"{m}[{function}({c.pick([m, c.pick(scope.matrices)])}[:, {c.integer(0, 2)}])]"
            self.write(self.change(place, self.operand(("3",), 1)))
        elif free:
            v = self.marked(c.pick(free))
            u = c.pick([a for a, s in scope.vectors.items() if s == scope.vectors[v]] + [v])
            asked = c.pick([u, f"np.abs({u})", f"{u} * {u}", f"np.sin({u})"])
            self.write(self.change(f"{v}[{function}({asked})]", self.tame(1)))

    def multiplied(self) -> None:
        """Rows of a matrix multiplied with one matrix in a loop, or a state that such products drive."""
        c, scope = self.choices, self.scope
        matrices = [m for m in scope.matrices if m not in scope.frozen]
        if not matrices:
            return
        w = next((a for a, s in scope.arrays.items() if s == ("3", "3")), "")
        if not w:
            w = self.fresh("t")
            self.write(f"{w} = {self.new_values(('3', '3'))}")
            self.known(w, ("3", "3"))
        m, x = c.pick(matrices), c.pick(scope.matrices)
        i = self.fresh("i")
        self.write(f"for {i} in range({c.pick(['n', 'n', 'n - 1, -1, -1', '1, n', '0, n, 2'])}):")
        product = c.pick([f"{w} @ {x}[{i}]", f"{x}[{i}] @ {w}", f"{w}.T @ {x}[{i}]", f"{w} @ {m}[{i}]",
                          f"{w} @ {x}[{i} - 1]"])
        states = self.vectors_to_write("3")
        inner = [f"{m}[{i}] = 0.9 * np.tanh({product})", f"{m}[{i}] += 0.2 * (np.sin({product}) - {m}[{i}])",
                 f"{m}[{i}] = 0.5 * np.cos({product}) * {x}[{i}]"]
        if states:
            h = c.pick(states)
            inner += [f"{h}[:] = np.tanh({product} + {w} @ {h})"] * 2
        for _ in range(2 if c.chance(30) else 1):
            line = c.pick(inner)
            self.marked(line.partition("[")[0])
            self.write(f"    {line}")

    def into(self) -> None:
        """A function that writes what it gives into an array."""
        c, scope = self.choices, self.scope
        size = c.pick(["n", "3"])
        like, free = [v for v, s in scope.vectors.items() if s == size], self.vectors_to_write(size)
        if free:
            out = self.marked(c.pick(free))
            a, b = c.pick(like), self.values((size,), 1)
            self.write(c.pick([f"np.sin({b}, out={out})", f"np.minimum({a}, {b}, out={out})",
                               f"np.multiply({a}, {c.number(0.3, 0.8)}, out={out})", f"np.tanh({b}, {out})",
                               f"np.copyto({out}, {b})", f"np.add(0.5 * {a}, 0.4 * ({b}), out={out})"]))

    def along(self) -> None:
        """A function along an axis that a name gives."""
        c = self.choices
        if self.scope.matrices:
            axis, name, chosen = self.fresh("axis"), self.fresh("t"), c.integer(0, 1)
            a = self.values(("n", "3"), 1)
            self.write(f"{axis} = {chosen - 2 * c.integer(0, 1)}")
            if c.chance(60):
                how = c.pick(["np.mean({}, axis={})", "np.sin(np.sum({}, axis={}))", "np.max({}, axis={})"])
                self.write(f"{name} = 0.9 * {how.format(a, axis)}")
                self.known(name, ("3",) if chosen == 0 else ("n",))
            else:
                how = c.pick(["np.roll({}, 1, axis={})", "np.flip({}, axis={})"])
                self.write(f"{name} = 0.9 * {how.format(a, axis)}")
                self.known(name, ("n", "3"))

    def sliced(self) -> None:
        """A slice under a name, whose bounds change after it is made."""
        c, scope = self.choices, self.scope
        free = [v for v in scope.vectors if v not in scope.frozen]
        if not free or not scope.places:
            return
        p, v, s = c.pick(list(scope.places)), self.marked(c.pick(free)), self.fresh("span")
        self.write(f"{s} = slice({p}[{c.integer(0, 1)}], {c.pick(['3', f'{p}[1] + 1', f'{p}[0] + 1'])})")
        if c.chance(60):
            self.write(f"{p}[{c.integer(0, 1)}] = {self.index('3')}")
        self.write(self.change(f"{v}[{s}]", self.tame(1)))

    returning: list[str] = []

    def given_back(self) -> None:
        """A call that writes an array and returns a number, beside elements of that array."""
        c, scope = self.choices, self.scope
        free = [v for v in scope.vectors if v not in scope.frozen]
        if not free or not self.returning:
            return
        u = self.marked(c.pick(free))
        called, element = f"{c.pick(self.returning)}({u}, {self.tame(1)})", f"{u}[{self.index(scope.vectors[u])}]"
        self.bind(c.pick([f"0.5 * {element} * {called}", f"0.5 * {called} * {element}", f"0.9 * {called}",
                          f"0.4 * {element} - 0.4 * {called}", f"0.3 * np.sin({u}[0]) + 0.3 * {called}"]))
