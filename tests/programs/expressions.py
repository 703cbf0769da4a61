"""Random expressions of the supported language, for `programs`.

Every float expression written here is *tame*: between -2 and 2 if the names it reads are. That is what keeps
generated kernels bounded however long they loop, and their functions within their domains. A *wide* name (a
running sum) is read only through sin or tanh. Choices put the simplest first, so that shrinking simplifies.
"""
from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any


class Choices:
    """Where decisions come from: a `random.Random`, or functions that Hypothesis draws from."""

    def __init__(self, integer: Callable[[int, int], int]):
        self.integer = integer

    @classmethod
    def seeded(cls, seed: int) -> Choices:
        return cls(random.Random(seed).randint)

    def pick(self, items: Sequence[Any]) -> Any:
        return items[self.integer(0, len(items) - 1)]

    def chance(self, percent: int) -> bool:
        return self.integer(0, 99) >= 100 - percent

    def number(self, low: float, high: float) -> str:
        """A literal between the two, never a round number: conditions on round numbers tie."""
        step = (high - low) / 997
        return f"{low + step * self.integer(0, 996) + 0.0137 * step:.4f}"


@dataclass
class Scope:
    """What can be read and written at a place. Sizes are texts: "n" or "3"; None is an integer of any value."""
    floats: list[str] = field(default_factory=list)
    wides: list[str] = field(default_factory=list)
    ints: dict[str, str | None] = field(default_factory=dict)
    bools: list[str] = field(default_factory=list)
    vectors: dict[str, str] = field(default_factory=dict)
    matrices: list[str] = field(default_factory=list)
    wide_vectors: dict[str, str] = field(default_factory=dict)
    flags: list[str] = field(default_factory=list)
    positions: list[str] = field(default_factory=list)
    frozen: set[str] = field(default_factory=set)
    arrays: dict[str, tuple[str, ...]] = field(default_factory=dict)     # of other shapes than vectors and matrices
    masks: dict[str, tuple[str, ...]] = field(default_factory=dict)      # of other shapes than flags
    places: dict[str, str] = field(default_factory=dict)                 # arrays of 0, 1 and 2, by their sizes
    mine: dict[str, tuple[str, ...]] = field(default_factory=dict)       # arrays bound in this very block

    def copy(self) -> Scope:
        return Scope(*(type(v)(v) for v in vars(self).values()))

    def assignable(self) -> list[str]:
        return [f for f in self.floats if f not in self.frozen]

    def names(self) -> set[str]:
        return {n for v in vars(self).values() for n in v}


class Expressions:
    """Writes expressions over a scope; `pure` and `pairs` are the helpers that can be called."""

    def __init__(self, choices: Choices):
        self.choices = choices
        self.scope = Scope()
        self.pure: list[str] = []

    # -- integers ---------------------------------------------------------------------------------------------------
    def index(self, size: str, depth: int = 1) -> str:
        """An integer that is valid as an index into `size` elements; negative ones are."""
        c, scope = self.choices, self.scope
        fitting = [i for i, s in scope.ints.items() if s == size]
        if not fitting or c.chance(8):
            return self._other_index(size, depth)
        i = c.pick(fitting)
        forms = [i, i, i, f"{i} - 1", f"{size} - 1 - {i}", f"({i} + 1) % {size}", f"-1 - {i}", f"{i} // 2",
                 f"(2 * {i} + 1) % {size}", f"({i} + {c.pick(list(scope.ints))}) % {size}"]
        if size == "n" and scope.positions:
            forms += [f"{c.pick(scope.positions)}[{i}]"] * 2
        return c.pick(forms)

    def _other_index(self, size: str, depth: int) -> str:
        c = self.choices
        forms = ["0", "-1", "1", "2", "-2"]
        forms += [f"{i} % {size}" for i in self.scope.ints] * 2
        if depth and (self.scope.floats or self.scope.vectors):
            forms.append(f"int(abs({self.atom(0)}) * 7.3) % {size}")
        return c.pick(forms)

    # -- conditions -------------------------------------------------------------------------------------------------
    def condition(self, depth: int = 1) -> str:
        c, scope = self.choices, self.scope
        forms = [self._on_data, self._on_data, self._chained]
        if scope.ints:
            forms += [self._on_indices] * 2
        if scope.bools or scope.flags:
            forms.append(self._on_flags)
        if depth:
            forms.append(self._joined)
        return c.pick(forms)()

    def _on_data(self) -> str:
        c = self.choices
        left, op = self.atom(1), c.pick([">", "<", ">=", "<="])
        return f"{left} {op} {self.atom(1) if c.chance(30) else c.number(-0.8, 0.8)}"

    def _chained(self) -> str:
        c = self.choices
        return f"{c.number(-1.2, -0.3)} < {self.atom(1)} <= {c.number(0.3, 1.2)}"

    def _on_indices(self) -> str:
        c = self.choices
        i = c.pick(list(self.scope.ints))
        return c.pick([f"{i} == {c.integer(0, 3)}", f"{i} > 0", f"{i} % 2 == 0", f"{i} != {c.integer(0, 3)}",
                       f"{i} < {c.pick(list(self.scope.ints))}", f"0 < {i} < 3", f"not {i} == 1", f"({i} & 1) == 1"])

    def _on_flags(self) -> str:
        c, scope = self.choices, self.scope
        name = c.pick([*scope.bools, *(f"{f}[{self.index('n', 0)}]" for f in scope.flags)])
        return f"not {name}" if c.chance(30) else name

    def _joined(self) -> str:
        c = self.choices
        return f"({self.condition(0)}) {c.pick(['and', 'or'])} ({self.condition(0)})"

    # -- floats -----------------------------------------------------------------------------------------------------
    def atom(self, depth: int = 1) -> str:
        """A name, an element or a number."""
        c, scope = self.choices, self.scope
        forms: list[Callable[[], str]] = []
        if scope.floats:
            forms += [lambda: c.pick(scope.floats)] * 3
        if scope.vectors:
            forms += [lambda: self.element(c.pick(list(scope.vectors)), depth)] * 4
        if scope.matrices:
            forms += [lambda: self.element(c.pick(scope.matrices), depth)] * 2
        if scope.wides:
            forms.append(lambda: f"math.tanh(0.1 * {c.pick(scope.wides)})")
        if scope.wide_vectors:
            forms.append(lambda: f"math.sin(0.2 * {self.element(c.pick(list(scope.wide_vectors)), depth)})")
        if scope.ints and c.chance(15):
            forms.append(lambda: f"0.1 * ({c.pick(list(scope.ints))} % 7)")
        return c.pick(forms)() if forms else c.number(-1.5, 1.5)

    def element(self, array: str, depth: int = 1) -> str:
        scope = self.scope
        if array in scope.matrices:
            i, j = self.index("n", depth), self.index("3", depth)
            return f"{array}[{i}][{j}]" if self.choices.chance(20) else f"{array}[{i}, {j}]"
        return f"{array}[{self.index({**scope.vectors, **scope.wide_vectors}[array], depth)}]"

    def tame(self, depth: int = 2) -> str:
        """A float expression between -2 and 2."""
        c = self.choices
        if depth == 0 or c.chance(12):
            return self.atom()
        kinds = [self._linear, self._linear, self._product, self._smooth, self._smooth, self._quotient, self._power,
                 self._choice, self._library]
        if self.pure:
            kinds.append(self._called)
        if self.scope.vectors and c.chance(30):
            kinds.append(self._sum)
        return c.pick(kinds)(depth - 1)

    def _linear(self, depth: int) -> str:
        c, a, b = self.choices, self.tame(depth), self.tame(depth)
        return c.pick([f"0.5 * ({a} + {b})", f"{c.number(0.2, 0.5)} * ({a}) - {c.number(0.2, 0.5)} * ({b})",
                       f"0.5 * ({a} - ({b}))", f"-({a})", f"({a}) / 2 + {c.number(-0.9, 0.9)}"])

    def _product(self, depth: int) -> str:
        c, a = self.choices, self.tame(depth)
        return c.pick([f"0.5 * ({a}) * ({self.tame(depth)})", f"({a}) * math.cos({self.atom()})"])

    def _smooth(self, depth: int) -> str:
        c, a = self.choices, self.tame(depth)
        return c.pick([f"math.sin({a})", f"np.tanh({a})", f"np.cos({a})", f"math.tanh({a})", f"math.atan({a})",
                       f"0.2 * math.exp({a})", f"0.5 * np.exp(-({a}) * ({a}))", f"np.log(2.5 + {a})",
                       f"0.8 * np.sqrt(1.0 + ({a}) ** 2)", f"0.9 * math.sqrt(2.5 + {a})", f"math.log1p(0.3 * ({a}))",
                       f"0.5 * math.sinh(0.7 * ({a}))", f"np.arcsinh({a})", f"math.erf({a})", f"np.expm1(0.4 * ({a}))"])

    def _quotient(self, depth: int) -> str:
        c, a, b = self.choices, self.tame(depth), self.tame(depth)
        return c.pick([f"({a}) / (1.0 + ({b}) ** 2)", f"({a}) / (2.5 + np.sin({b}))", f"1.0 / (2.6 + {b})",
                       f"0.8 * ({a}) / (0.9 + abs({b}))"])

    def _power(self, depth: int) -> str:
        c, a = self.choices, self.tame(depth)
        return c.pick([f"0.5 * ({a}) ** 2", f"0.25 * ({a}) ** 3", f"0.2 * (2.5 + {a}) ** 1.5",
                       f"0.6 * (2.5 + {a}) ** -0.5", f"(2.5 + {a}) ** (0.2 * ({self.atom()}))",
                       f"0.3 * (2.5 + {a}) ** -1", f"np.square({a}) / 2.0"])

    def _choice(self, depth: int) -> str:
        c, a, b = self.choices, self.tame(depth), self.tame(depth)
        return c.pick([f"({a} if {self.condition(0)} else {b})", f"max({a}, {b})", f"min({a}, {b})", f"abs({a})",
                       f"np.maximum({a}, {c.number(-0.9, 0.9)})", f"np.minimum({b}, {a})", f"math.fabs({a})"])

    def _library(self, depth: int) -> str:
        c, a, b = self.choices, self.tame(depth), self.tame(depth)
        return c.pick([f"0.7 * math.hypot({a}, 0.3 + abs({b}))", f"np.arctan2({a}, 2.5 + {b})", "G",
                       f"0.3 * np.logaddexp({a}, {b})", f"float({a})", f"0.1 * np.pi * ({a})", f"np.cbrt(2.5 + {a})"])

    def _called(self, depth: int) -> str:
        return f"{self.choices.pick(self.pure)}({self.tame(depth)}, {self.tame(0)})"

    def _sum(self, depth: int) -> str:
        c = self.choices
        u = c.pick(list(self.scope.vectors))
        same = [v for v, size in self.scope.vectors.items() if size == self.scope.vectors[u]]
        return c.pick([f"np.sum({u}) / len({u})", f"0.5 * np.sum({u} * {c.pick(same)}) / {u}.size",
                       f"np.sum(np.sin({u})) / {u}.shape[0]", f"0.5 * np.sum({u} ** 2) / len({u})"])
