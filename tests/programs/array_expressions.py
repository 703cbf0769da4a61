"""Random expressions of whole arrays, for `programs`: parts, broadcasting, reductions, moved elements, products.

A shape is a tuple of sizes, a size its text: "n", "3", "n - 1", "2", "1", "n - i". A program with arrays has n of at
least 4, so that what is cut off both ends of "n" and "n - 1" is there. "3 - 2" is a size that the text does not show
to be 1: it does not broadcast. As in `expressions` every element is
between about -2 and 2 if those of the names are.
"""
from __future__ import annotations


from tests.programs.expressions import Expressions

Shape = tuple[str, ...]
SHORTER = {"n": "n - 1", "n - 1": "n - 2", "3": "2", "2": "3 - 2"}
HALVES = {"n": ("(n + 1) // 2", "n // 2"), "3": ("2", "3 - 2")}


def cuts(size: str, ints: dict[str, str | None], least: int) -> dict[str, list[str]]:
    """The slices of an axis of this size, by the size of what they take."""
    found: dict[str, list[str]] = {size: [":", "::-1"]}

    def add(made: str, *slices: str) -> None:
        found.setdefault(made, []).extend(slices)

    one = SHORTER.get(size)
    if one is not None:
        add(one, "1:", ":-1", f":{size} - 1", f"1:{size}", ":0:-1", "-2::-1")
    if size in ("n", "3"):
        add(SHORTER[SHORTER[size]], "1:-1", "2:", ":-2", f"1:{size} - 1", "-2:0:-1")
        add("2", ":2", "-2:", "1:3", "0:3:2", "2:0:-1", "-1:-3:-1", "-3:-1")
        add(HALVES[size][0], "::2", "-1::-2" if size == "3" else "0::2")
        add(HALVES[size][1], "1::2")
        for i in (i for i, s in ints.items() if s == size):
            add(f"{size} - {i}", f"{i}:", f"{i}:{size}")
            add(i, f":{i}", f"-{i} - 1:-1")
            add(f"{size} - 1 - {i}", f"{i} + 1:", f":{size} - 1 - {i}")
            add("1", f"{i}:{i} + 1")
            add("2", f"{i} % ({size} - 1):{i} % ({size} - 1) + 2")
    elif size == "n - 1" and least > 3:
        add("2", ":2", "-2:", "1:3")
    if size in ("n", "3", "n - 1", "2"):
        add("1", ":1", "-1:", "1:2")
    return found


class ArrayExpressions(Expressions):
    """Writes expressions over a scope whose value is an array."""

    least = 4        # what n is at least
    loops_of: dict[str, int]     # how many loops a counter has
    alone: set[str]              # the counters that no other loop may have
    nonempty = frozenset({"n", "3", "n - 1", "2", "1", "3 - 2", "n - 2", "(n + 1) // 2", "n // 2"})

    # -- names and parts --------------------------------------------------------------------------------------------
    def shaped(self) -> dict[str, Shape]:
        """Every array of tame floats that is known, with its shape."""
        scope = self.scope
        return {**{v: (s,) for v, s in scope.vectors.items()}, **dict.fromkeys(scope.matrices, ("n", "3")),
                **scope.arrays}

    def fit(self, shape: Shape) -> str:
        """A shape as an argument of np.zeros."""
        return shape[0] if len(shape) == 1 else f"({', '.join(shape)})"

    def cut(self, size: str, wanted: str) -> list[str]:
        """The slices; `i:i + 1` of the counter of one loop alone, for of several a length of 1 is not seen."""
        ints = {i: s for i, s in self.scope.ints.items() if wanted != "1" or self.loops_of.get(i, 1) < 2}
        self.alone |= set(ints) if wanted == "1" else set()
        return cuts(size, ints, self.least).get(wanted, [])

    def parts(self, array: str, have: Shape, shape: Shape) -> list[str]:
        """The ways to take a part of this shape from an array."""
        c = self.choices
        if len(have) == len(shape):
            each = [self.cut(h, s) for h, s in zip(have, shape)]
            if not all(each):
                return []
            slices = [c.pick(e) if c.chance(40) else e[0] for e in each]
            return [array if all(s == ":" for s in slices) and c.chance(80) else f"{array}[{', '.join(slices)}]"]
        found: list[str] = []
        if len(have) == 2 and len(shape) == 1:
            rows, columns = self.cut(have[0], shape[0]), self.cut(have[1], shape[0])
            if columns and have[0] in ("n", "3", "1"):
                at, slice_ = self.index(have[0]) if have[0] != "1" else "0", c.pick(columns[:1] + columns)
                found.append(f"{array}[{at}]" if slice_ == ":" else f"{array}[{at}, {slice_}]")
            if rows and have[1] in ("n", "3", "1"):
                found.append(f"{array}[{c.pick(rows[:1] + rows)}, {self.index(have[1]) if have[1] != '1' else '0'}]")
        return found

    def picks(self, shape: Shape) -> list[str]:
        """Elements that arrays of integers pick."""
        c, scope, found = self.choices, self.scope, []
        for places, length in [*((p, "n") for p in scope.positions), *scope.places.items()]:
            for array, have in self.shaped().items():
                if have[0] not in ("n", "3") or places in scope.positions and have[0] != "n":
                    continue
                if (length, *have[1:]) == shape:
                    found.append(f"{array}[{places}]")
                elif len(have) == 2 and shape == (length,):
                    found += [f"{array}[{places}, {self.index('3')}]"] if have[1] == "3" else []
        return [c.pick(found)] if found else []

    def leaf(self, shape: Shape) -> str:
        """A name, a part of an array or elements picked, of this very shape."""
        c = self.choices
        found = [p for a, have in self.shaped().items() for p in self.parts(a, have, shape)]
        found += self.picks(shape) if c.chance(30) else []
        if len(shape) == 2:
            found += [f"{p}.T" for a, have in self.shaped().items() if len(have) == 2 and c.chance(40)
                      for p in self.parts(a, have, shape[::-1])]
            for a, have in self.shaped().items():
                if len(have) == 1 and shape[1] == "1":
                    found += [f"{p}[:, None]" for p in self.parts(a, have, shape[:1])]
                if len(have) == 1 and shape[0] == "1":
                    found += [f"{p}[None, :]" for p in self.parts(a, have, shape[1:])]
        return c.pick(found) if found else f"{self.atom()} * np.ones({self.fit(shape)})"

    # -- values -----------------------------------------------------------------------------------------------------
    def operand(self, shape: Shape, depth: int) -> str:
        """What can be broadcast to a shape."""
        c = self.choices
        if c.chance(55):
            return self.values(shape, depth)
        if len(shape) == 2 and c.chance(60):
            return self.values(c.pick([shape[1:], ("1", shape[1]), (shape[0], "1")]), depth)
        return self.tame(min(depth, 1)) if c.chance(60) else self.values(shape[:-1] + ("1",), depth)

    def values(self, shape: Shape, depth: int = 2) -> str:
        """An expression for an array of this shape."""
        c = self.choices
        if depth <= 0 or c.chance(15):
            return self.leaf(shape)
        kinds = [self._joined_arrays, self._joined_arrays, self._mapped, self._mapped, self._chosen, self._moved]
        if len(shape) == 1 and shape[0] in ("n", "3") or c.chance(20):
            kinds += [self._reduced, self._multiplied]
        return c.pick(kinds)(shape, depth - 1)

    def _joined_arrays(self, shape: Shape, depth: int) -> str:
        c, a, b = self.choices, self.values(shape, depth), self.operand(shape, depth)
        if c.chance(30):
            a, b = b, a
        return c.pick([f"0.5 * ({a} + {b})", f"0.5 * ({a}) * ({b})", f"0.4 * ({a}) - {c.number(0.2, 0.5)} * ({b})",
                       f"({a}) / (1.0 + ({b}) ** 2)", f"({a}) * np.cos({b})", f"({a}) / (2.5 + np.sin({b}))",
                       f"0.3 * (({a}) - ({b})) ** 2", f"0.5 * np.hypot({a}, 1.3 + ({b}))"])

    def _mapped(self, shape: Shape, depth: int) -> str:
        c, a = self.choices, self.values(shape, depth)
        return c.pick([f"np.sin({a})", f"np.tanh({a})", f"0.5 * ({a}) ** 2", f"0.8 * np.sqrt(1.0 + ({a}) ** 2)",
                       f"-({a})", f"0.2 * np.exp({a})", f"np.log(2.5 + {a})", f"np.square({a}) / 2.0",
                       f"({a}) / 2 + {c.number(-0.9, 0.9)}", f"np.abs({a})"])

    def _chosen(self, shape: Shape, depth: int) -> str:
        c, a, b = self.choices, self.values(shape, depth), self.operand(shape, depth)
        mask = self.mask_of(shape)
        return c.pick([f"np.where({mask}, {a}, {b})", f"np.where({mask}, {b}, {a})", f"np.maximum({a}, {b})",
                       f"np.minimum({b}, {a})", f"np.clip({a}, {c.number(-0.9, -0.2)}, {c.number(0.2, 0.9)})"])

    def mask_of(self, shape: Shape, named: bool = False) -> str:
        """Bools of this shape: a name, or a comparison; joined with `&`, `|`, `~`."""
        c, scope = self.choices, self.scope
        known = [f for f in scope.flags if shape == ("n",)] + [m for m, s in scope.masks.items() if s == shape]
        if known and (named or c.chance(50)):
            one = c.pick(known)
        else:
            one = f"({self.leaf(shape)} {c.pick(['>', '<', '>='])} {c.number(-0.6, 0.6)})"
        if c.chance(15):
            return f"~{one}"
        return f"({one} {c.pick(['&', '|'])} {self.mask_of(shape)})" if c.chance(12) else one

    # -- functions of whole arrays ----------------------------------------------------------------------------------
    def _moved(self, shape: Shape, depth: int) -> str:
        c, a = self.choices, self.values(shape, depth)
        shift = c.pick(["1", "-1", "2", *(i for i in self.scope.ints)])
        if len(shape) == 2:
            axis = c.integer(0, 1)
            return c.pick([f"np.roll({a}, {shift}, axis={axis})", f"np.flip({a}, axis={axis})",
                           f"np.transpose({self.values(shape[::-1], depth)})",
                           f"0.5 * np.outer({self.values(shape[:1], depth)}, {self.values(shape[1:], depth)})",
                           f"np.sin(np.cumsum({a}, axis={axis}))" if shape[axis] in self.nonempty else a,
                           self._stacked(shape, depth)])
        forms = [f"np.roll({a}, {shift})", f"np.flip({a})", f"np.sin(np.cumsum({a}))", f"{a}.copy()"
                 if a.isidentifier() else f"({a})[::-1]"]
        longer = next((k for k, v in SHORTER.items() if v == shape[0]), None)
        if longer is not None:
            forms += [f"0.5 * np.diff({self.values((longer,), depth)})"] * 2
            if longer != "n - 1":
                forms.append(f"0.4 * np.diff(({self.values((longer, '3'), depth)})[:, 1])")
        if shape[0] in SHORTER:
            one, rest = self.values(("1",), 0), self.values((SHORTER[shape[0]],), depth)
            forms += [f"np.concatenate(({one}, {rest}))", f"np.concatenate([{rest}, {one}])"]
        return c.pick(forms)

    def _stacked(self, shape: Shape, depth: int) -> str:
        for axis in (0, 1):
            if shape[axis] in ("2", "3"):
                each = [self.values((shape[1 - axis],), min(depth, 1)) for _ in range(int(shape[axis]))]
                return f"np.stack(({', '.join(each)}), axis={axis})"
        return self.leaf(shape)

    def _reduced(self, shape: Shape, depth: int) -> str:
        """A reduction of this shape; its operand has one more axis, or keeps one of length 1."""
        c = self.choices
        if len(shape) == 2:
            if "1" not in shape:
                return self.leaf(shape)
            axis = shape.index("1")
            over = c.pick(["n", "3"])
            whole = (over, shape[1]) if axis == 0 else (shape[0], over)
            return self._over(self.values(whole, depth), f"axis={axis}, keepdims=True", over)
        axis, over = c.integer(0, 1), c.pick(["n", "3"])
        whole = (over, shape[0]) if axis == 0 else (shape[0], over)
        return self._over(self.values(whole, depth), f"axis={c.pick([axis, axis - 2])}", over)

    def _over(self, a: str, how: str, over: str) -> str:
        c, how = self.choices, f", {how}" if how else ""
        return c.pick([f"np.mean({a}{how})", f"0.7 * np.sum({a}{how}) / {over or 12}", f"np.sin(np.sum({a}{how}))",
                       f"np.max({a}{how})", f"np.min({a}{how})", f"np.prod(np.cos({a}){how})",
                       f"0.4 * np.var({a}{how})", f"0.8 * np.std({a}{how})", f"np.sin(np.linalg.norm({a}{how}))",
                       f"({a}).mean({how[2:]})", f"({a}).max({how[2:]})", f"np.tanh(({a}).sum({how[2:]}))"])

    def _multiplied(self, shape: Shape, depth: int) -> str:
        c, inner = self.choices, self.choices.pick(["n", "3"])
        if len(shape) == 2:
            a, b = self.values((shape[0], inner), depth), self.values((inner, shape[1]), depth)
        elif c.chance(50):
            a, b = self.values((shape[0], inner), depth), self.values((inner,), depth)
        else:
            a, b = self.values((inner,), depth), self.values((inner, shape[0]), depth)
        return c.pick([f"np.sin(({a}) @ ({b}))", f"0.1 * np.dot({a}, {b})", f"np.tanh(({a}) @ ({b}))"])

    # -- numbers from arrays ----------------------------------------------------------------------------------------
    def _sum(self, depth: int) -> str:
        if not self.arrays:
            return super()._sum(depth)
        c = self.choices
        shape = c.pick([("n",), ("3",), ("n", "3"), ("2",), ("n - 1",)])
        a = self.values(shape, min(depth, 1))
        forms = [self._over(a, "", "")] * 3
        if len(shape) == 1:
            b = self.values(shape, min(depth, 1))
            forms += [f"np.sin(np.dot({a}, {b}))", f"np.tanh(({a}) @ ({b}))", f"np.tanh(np.sum({a}, axis=0))"]
        return c.pick(forms)

    arrays = False

    def _on_data(self) -> str:
        c = self.choices
        if not self.arrays or not self.scope.vectors or not c.chance(15):
            return super()._on_data()
        shape = c.pick([("n",), ("3",), ("n", "3")])
        return f"np.{c.pick(['any', 'all'])}({self.mask_of(shape)})"
