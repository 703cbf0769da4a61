"""Random statements over whole arrays, for `programs`: each kind is a method named after its feature.

Feature group "arrays": `without` leaves out all of it, or single kinds.
"""
from __future__ import annotations

from tests.programs.array_expressions import ArrayExpressions, Shape
from tests.programs.statements import SimpleStatements

# how often each kind is chosen
ARRAYS = {"part": 8, "view": 3, "rebound": 1, "broadcast": 3, "fresh_array": 4, "masked": 3, "mask_bound": 2,
          "mask_changed": 1, "picked": 3, "places_bound": 1, "compressed": 2, "piece": 3, "number": 3, "transposed": 1,
          "sized": 1}
SHAPES: list[Shape] = [("n",), ("3",), ("n", "3"), ("n", "1"), ("1", "3"), ("n - 1",), ("2",), ("n - 2",),
                       ("(n + 1) // 2",), ("n", "2"), ("3", "3"), ("n - 1", "3"), ("1",), ("n", "n")]


class ArrayStatements(ArrayExpressions, SimpleStatements):
    """Writes statements over whole arrays."""

    # -- names ------------------------------------------------------------------------------------------------------
    def known(self, array: str, shape: Shape) -> None:
        """Notes a new array, where scalar code finds it too if it can."""
        scope = self.scope
        if shape in (("n",), ("3",)):
            scope.vectors[array] = shape[0]
        elif shape == ("n", "3"):
            scope.matrices.append(array)
        else:
            scope.arrays[array] = shape

    def writable(self) -> dict[str, Shape]:
        return {a: s for a, s in self.shaped().items() if a not in self.scope.frozen}

    def shapes(self) -> list[Shape]:
        """The shapes of which every axis has elements here."""
        return SHAPES if self.least > 3 else [s for s in SHAPES if "n - 2" not in s]

    def target_part(self) -> tuple[str, Shape] | None:
        """A place to store to, with its shape."""
        c, arrays = self.choices, self.writable()
        if not arrays:
            return None
        array = c.pick(list(arrays))
        have, found = arrays[array], []
        for shape in [*SHAPES, have, *(((f"{s} - {i}",)) for i, s in self.scope.ints.items() if s in have),
                      *((i,) for i, s in self.scope.ints.items() if s in have)]:
            found += [(p, shape) for p in self.parts(array, have, shape)]
        place, shape = c.pick(found)
        return (f"{array}[{c.pick([':', '...'])}]" if place == array else place), shape

    def change(self, place: str, value: str) -> str:
        """A store or an augmented store that keeps the place tame."""
        c = self.choices
        bare = place.removesuffix("[...]").removesuffix("[:]")
        return c.pick([f"{place} = {value}", f"{place} = {value}",
                       f"{bare} += {c.number(0.05, 0.3)} * ({value} - {bare})",
                       f"{bare} *= 0.5 + 0.3 * np.sin({value})", f"{bare} /= 1.0 + ({value}) ** 2",
                       f"{bare} -= 0.2 * ({bare} - ({value}))", f"{bare} *= 0.75"])

    # -- statements -------------------------------------------------------------------------------------------------
    def part(self) -> None:
        found = self.target_part()
        if found is not None:
            place, shape = found
            self.marked(place.partition("[")[0])
            self.write(self.change(place, self.operand(shape, self.choices.integer(1, 2))))

    def view(self) -> None:
        found = self.target_part()
        if found is None or not found[1]:
            return
        place, shape = found
        if any(s not in self.nonempty for s in shape):
            return
        name = self.fresh("part")
        self.write(f"{name} = {place}")
        self._is_part(name, place, shape)

    def _is_part(self, name: str, place: str, shape: Shape) -> None:
        base = place.partition("[")[0]
        self.bases[name] = self.root(base)
        self.known(name, shape)
        if base in self.scope.frozen:
            self.scope.frozen.add(name)
        self.scope.mine[name] = shape

    def rebound(self) -> None:
        """A name that this block has bound, bound to another part or a new array; its views stay what they are."""
        c, mine = self.choices, self.scope.mine
        if not mine:
            return
        name = c.pick(list(mine))
        if c.chance(40):
            self.write(f"{name} = {self.new_values(mine[name])}")
            return
        found = [p for a, have in self.writable().items() if self.root(a) != name
                 for p in self.parts(a, have, mine[name])]
        if found:
            place = c.pick(found)
            self.write(f"{name} = {place}{'[:]' if place.isidentifier() else ''}")
            self.bases[name] = self.root(place.partition("[")[0])
            self.marked(name)

    def broadcast(self) -> None:
        """An array over both axes, changed in place, and an array gained by it."""
        c = self.choices
        name, shape = self.fresh("b"), c.pick([("n", "3"), ("3", "n"), ("n", "2")])
        a, b = self.values((shape[0], "1"), 1), self.values(c.pick([shape[1:], ("1", shape[1])]), 1)
        self.write(f"{name} = {c.pick(['0.5 * (', '0.9 * np.sin('])}({a}) {c.pick('*+-')} ({b}))")
        self.known(name, shape)
        self.write(self.change(f"{name}[...]", self.operand(shape, 1)))

    def fresh_array(self) -> None:
        """A new array: the value of an expression, or a work array filled afterwards."""
        c, name, shape = self.choices, self.fresh("t"), self.choices.pick(self.shapes())
        if c.chance(60):
            self.write(f"{name} = {self.new_values(shape)}")
        else:
            self.write(f"{name} = np.{c.pick(['zeros', 'empty', 'ones'])}({self.fit(shape)})")
            self.write(f"{name}[{c.pick([':', '...'])}] = {self.operand(shape, 1)}")
        self.known(name, shape)
        self.scope.mine[name] = shape

    def new_values(self, shape: Shape) -> str:
        """The values of an array of its own: neither a name nor a part."""
        forms = [lambda: self._joined_arrays(shape, 1), lambda: self._mapped(shape, 1), lambda: self._chosen(shape, 1),
                 lambda: f"0.9 * ({self._moved(shape, 1)})"]
        return self.choices.pick(forms)()

    def sized(self) -> None:
        """A work array whose size changes with a loop."""
        c, scope = self.choices, self.scope
        counters = [i for i, s in scope.ints.items() if s in ("n", "3") and i in scope.frozen]
        if counters:
            i = c.pick(counters)
            shape = c.pick([(f"{scope.ints[i]} - {i}",), (i,)])
            name = self.fresh("t")
            self.write(f"{name} = 0.9 * {self.values(shape, 1)}" if c.chance(50) else
                       f"{name} = np.zeros({shape[0]})")
            scope.arrays[name] = shape
            self.write(self.change(f"{name}[:]", self.operand(shape, 1)))

    def transposed(self) -> None:
        """A transpose that is bound and read at once."""
        c = self.choices
        if self.scope.matrices:
            name, m = self.fresh("turned"), c.pick(self.scope.matrices)
            self.write(f"{name} = {m}.T")
            self.scope.arrays[name] = ("3", "n")
            self.scope.frozen.add(name)
            other = self.fresh("t")
            self.write(f"{other} = 0.5 * {name} * {self.operand(('3', 'n'), 1)}")
            del self.scope.arrays[name]
            self.scope.arrays[other] = ("3", "n")

    def number(self) -> None:
        self.bind(self._sum(1) if self.choices.chance(80) else self.tame(2))

    # -- masks ------------------------------------------------------------------------------------------------------
    def mask_bound(self) -> None:
        shape = self.choices.pick([("n",), ("n",), ("3",), ("n", "3")])
        name = self.fresh("high")
        self.write(f"{name} = {self.mask_of(shape)}")
        if shape == ("n",):
            self.scope.flags.append(name)
        else:
            self.scope.masks[name] = shape

    def mask_changed(self) -> None:
        c, scope = self.choices, self.scope
        if scope.flags:
            mask = c.pick(scope.flags)
            self.write(c.pick([f"{mask}[{self.index('n')}] = {c.pick(['True', 'False'])}",
                               f"{mask}[{self.index('n')}] = {self.condition(0)}",
                               f"{mask}[:] = {self.mask_of(('n',))}", f"{mask}[1:] = {mask}[:-1]"]))

    def masked(self) -> None:
        """A store or an augmented store through a mask; the value is a number, or what the same mask picks."""
        c = self.choices
        arrays = {a: s for a, s in self.writable().items() if all(size in self.nonempty for size in s)}
        if not arrays:
            return
        array = self.marked(c.pick(list(arrays)))
        shape = arrays[array]
        rows = len(shape) == 2 and shape[0] in ("n", "3") and c.chance(50)
        mask = self.mask_of(shape[:1] if rows else shape, named=True)
        place, inner = f"{array}[{mask}]", shape[1:] if rows else ()
        same = [a for a, s in self.shaped().items() if s == shape and a.isidentifier()]
        forms = [self.tame(1), f"0.5 * {c.pick(same)}[{mask}] + 0.5 * {self.atom()}", f"np.sin({c.pick(same)}[{mask}])",
                 f"0.4 * {c.pick(same)}[{mask}] * {c.pick(same)}[{mask}]"]
        if inner:
            forms += [self.values(inner, 1)] * 2
        self.write(self.change(place, c.pick(forms)))

    def compressed(self) -> None:
        """What a mask picks, under a name, and put back or summed."""
        c, scope = self.choices, self.scope
        vectors = [v for v, s in scope.vectors.items() if s == "n"]
        if not scope.flags or not vectors:
            return
        mask, name, v = c.pick(scope.flags), self.fresh("few"), c.pick(vectors)
        self.write(f"{name} = 0.25 * {v}[{mask}] * {c.pick(vectors)}[{mask}] + 0.5 * {self.atom()}")
        if c.chance(40):
            self.write(c.pick([f"{name} *= 0.5 + 0.2 * np.sin({name})", f"{name}[:] = np.tanh({name})",
                               f"{name} += 0.3 * (np.cos({v}[{mask}]) - {name})"]))
        if c.chance(40):
            self.part()
        free = [u for u in vectors if u not in scope.frozen]
        if free and c.chance(50):
            self.write(f"{self.marked(c.pick(free))}[{mask}] = {name}")
        else:
            self.bind(f"np.sin(np.sum({name}))")

    # -- arrays of integers -----------------------------------------------------------------------------------------
    def places_bound(self) -> None:
        c, scope = self.choices, self.scope
        name = self.fresh("places")
        if scope.positions and c.chance(30):
            self.write(f"{name} = ({c.pick(scope.positions)} + {c.integer(1, 3)}) % n")
            scope.positions.append(name)
        elif c.chance(15) and "n" in scope.vectors.values():
            self.write(f"{name} = np.argsort({c.pick([v for v, s in scope.vectors.items() if s == 'n'])})")
            scope.positions.append(name)
        elif scope.places and c.chance(30):
            self.write(f"{c.pick(list(scope.places))}[{c.integer(0, 1)}] = {self.index('3')}")
        else:
            length = c.pick(["2", "3"])
            self.write(f"{name} = np.array([{', '.join(str(c.integer(0, 2)) for _ in range(int(length)))}])")
            scope.places[name] = length

    def picked(self) -> None:
        """A store or an augmented store through an array of integers."""
        c, scope, found = self.choices, self.scope, []
        for places, length in [*((p, "n") for p in scope.positions), *scope.places.items()]:
            for array, have in self.writable().items():
                if have[0] == "n" or have[0] == "3" and places in scope.places:
                    found.append((array, places, (length, *have[1:])))
                    if len(have) == 2 and have[1] in ("3", "n"):
                        found.append((array, f"{places}, {c.integer(0, 2)}", (length,)))
        if not found:
            self.places_bound()
            return
        array, places, shape = c.pick(found)
        self.marked(array)
        self.write(self.change(f"{array}[{places}]", self.operand(shape, 1)))

    # -- helpers ----------------------------------------------------------------------------------------------------
    def piece(self) -> None:
        """A part of an array for a helper that writes it; the other array is not of the same one."""
        c = self.choices
        if not self.mutators:
            return
        name, count = c.pick(self.mutators)
        size = c.pick(["n", "n", "3", "n - 1"] if self.least > 3 else ["n", "3"])
        found = [(a, p) for a, have in self.writable().items() for p in self.parts(a, have, (size,))]
        if not found:
            return
        array, place = c.pick(found)
        others = [p for a, have in self.shaped().items() if self.root(a) != self.root(array)
                  for p in self.parts(a, have, (size,))]
        if count == 2 and not others:
            return
        self.marked(array)
        self.write(f"{name}({', '.join([place, *([c.pick(others)] if count == 2 else []), self.tame(1)])})")
