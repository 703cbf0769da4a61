"""Affine forms of integer expressions, and whether a system of inequalities over them has a solution.

Fourier-Motzkin elimination with integer tightening (Schrijver, Theory of Linear and Integer Programming, 12.2): it may
say "perhaps" where there is none, never the reverse.
"""
from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import gcd

from s2sad.tree import AST, Add, Mult, Sub

_LIMIT = 600


@dataclass(frozen=True)
class Affine:
    """constant + sum of coefficient * symbol."""
    terms: tuple[tuple[str, int], ...] = ()
    constant: int = 0

    @classmethod
    def of(cls, terms: dict[str, int], constant: int) -> Affine:
        return cls(tuple(sorted((s, c) for s, c in terms.items() if c)), constant)

    @classmethod
    def symbol(cls, name: str) -> Affine:
        return cls(((name, 1),), 0)

    def plus(self, other: Affine, factor: int = 1) -> Affine:
        """self + factor * other.

        >>> Affine.symbol("i").plus(Affine.symbol("i"), -1)
        Affine(terms=(), constant=0)
        """
        terms = dict(self.terms)
        for symbol, coefficient in other.terms:
            terms[symbol] = terms.get(symbol, 0) + factor * coefficient
        return Affine.of(terms, self.constant + factor * other.constant)

    def times(self, factor: int) -> Affine:
        return Affine.of({s: factor * c for s, c in self.terms}, factor * self.constant)

    def shift(self, number: int) -> Affine:
        return Affine(self.terms, self.constant + number)

    def replaced(self, forms: Mapping[str, Affine]) -> Affine:
        """The form with forms in place of symbols."""
        made = Affine.of({s: c for s, c in self.terms if s not in forms}, self.constant)
        for symbol, coefficient in self.terms:
            if symbol in forms:
                made = made.plus(forms[symbol], coefficient)
        return made

    def renamed(self, mapping: Mapping[str, str]) -> Affine:
        return Affine.of({mapping[s]: c for s, c in self.terms}, self.constant)


def combined(op: AST, left: Affine | None, right: Affine | None) -> Affine | None:
    """A sum, a difference, or a product with a number; None if it is none of these."""
    if left is None or right is None:
        return None
    if isinstance(op, (Add, Sub)):
        return left.plus(right, 1 if isinstance(op, Add) else -1)
    if isinstance(op, Mult) and not left.terms:
        return right.times(left.constant)
    return left.times(right.constant) if isinstance(op, Mult) and not right.terms else None


def at_most(a: Affine, b: Affine) -> Affine:
    """The inequality a <= b, as a form that must not be negative."""
    return b.plus(a, -1)


def equals(a: Affine, b: Affine) -> list[Affine]:
    return [at_most(a, b), at_most(b, a)]


def feasible(system: list[Affine]) -> bool:
    """Whether integers may exist for which every form is >= 0.

    >>> i, j = Affine.symbol("i"), Affine.symbol("j")
    >>> feasible([at_most(i.shift(1), j), *equals(i, j)])
    False
    """
    forms = {_tight(f) for f in system}
    while True:
        if any(not f.terms and f.constant < 0 for f in forms):
            return False
        forms = {f for f in forms if f.terms}
        if not forms or len(forms) > _LIMIT:
            return True
        forms = _eliminate(forms, _cheapest(forms))


def projected(system: list[Affine], kept: Collection[str]) -> list[Affine] | None:
    """Forms in the symbols `kept` alone that are all >= 0 wherever those of the system are, for some values of its
    other symbols; None if integers for which they are cannot exist.

    >>> i, n, m = map(Affine.symbol, "inm")
    >>> set(projected([i, at_most(i.shift(1), n), at_most(m, i)], {"n", "m"})) == {n.shift(-1), at_most(m.shift(1), n)}
    True
    """
    if not feasible(system):
        return None
    forms = {_tight(f) for f in system}
    while True:
        forms = {f for f in forms if f.terms}
        others = {f for f in forms if any(s not in kept for s, _ in f.terms)}
        if not others or len(forms) > _LIMIT:
            return sorted(forms - others, key=repr)
        forms = _eliminate(forms, _cheapest(others, kept))


def _tight(form: Affine) -> Affine:
    divisor = 0
    for _, coefficient in form.terms:
        divisor = gcd(divisor, coefficient)
    if divisor <= 1:
        return form
    return Affine(tuple((s, c // divisor) for s, c in form.terms), form.constant // divisor)


def _cheapest(forms: set[Affine], kept: Collection[str] = ()) -> str:
    """The symbol whose elimination makes the fewest forms, none of those that are `kept`."""
    up: dict[str, int] = {}
    down: dict[str, int] = {}
    for form in forms:
        for symbol, coefficient in form.terms:
            side = up if coefficient > 0 else down
            side[symbol] = side.get(symbol, 0) + 1
    return min(sorted({*up, *down}.difference(kept)), key=lambda s: up.get(s, 0) * down.get(s, 0))


def _eliminate(forms: set[Affine], symbol: str) -> set[Affine]:
    lower, upper, rest = [], [], set()
    for form in forms:
        coefficient = dict(form.terms).get(symbol, 0)
        if coefficient > 0:
            lower.append((form, coefficient))
        elif coefficient < 0:
            upper.append((form, -coefficient))
        else:
            rest.add(form)
    for low, a in lower:
        for high, b in upper:
            rest.add(_tight(low.times(b).plus(high, a)))
    return rest
