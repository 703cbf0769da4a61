"""symbolic_ranges: whether an index that is made of products, quotients and remainders of sizes is below an extent.

    for i in range(m * n):              i <= m * n - 1, so i // n <= m - 1 and i % n <= n - 1
        y[i] = x[i // n, i % n]

Symbolic range propagation (Blume and Eigenmann, IPPS 1995) over numbers that are not negative: in place of each counter
its greatest value, a polynomial in sizes. A quotient needs a dividend that is known to be below a multiple of the
divisor, which is not 0 then.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.path_conditions import CallSite
from s2sad.tree import AST, Add, Attribute, BinOp, FloorDiv, Mod, Mult, dump, name

_SPELLINGS = 8      # of what one integer does not exceed
Polynomial = dict[tuple[str, ...], Fraction]
"""The coefficients of the products of symbols, each product in order; () is that of the constant."""


@dataclass
class SymbolicRanges:
    """What integers do not exceed at one place of a function, each in several spellings, of which there are none where
    it is not known, or the integer may be negative."""
    here: CallSite
    _asked: set[str] = field(default_factory=set)      # counters whose greatest values are being looked for

    def is_below(self, node: AST, extent: Affine) -> bool:
        """Whether an index is known not to be negative, and to be less than a size."""
        size = self.exact(extent)
        return size is not None and any(all(c >= 0 for c in _sum(size, above, -1).values()) for most in self.most(node)
                                        for above in self._spellings(_shifted(most, 1)))

    def most(self, node: AST) -> list[Polynomial]:
        """What an integer does not exceed."""
        form = self.here.size(node)
        whole = None if form is None else self.exact(form)
        if form is not None and whole is not None and self.here.is_place(form):
            return [whole]
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Mult)):
            combine = _sum if isinstance(node.op, Add) else _product
            right = self.most(node.right)
            return [combine(a, b) for a in self.most(node.left) for b in right][:_SPELLINGS]
        if isinstance(node, BinOp) and isinstance(node.op, (FloorDiv, Mod)):
            return self._divided(node)[:_SPELLINGS]
        return self._most_of(form) if form is not None and self._is_place(form) else []

    def exact(self, form: Affine) -> Polynomial | None:
        """A form of sizes as a polynomial; None if it has others in it, or such as may be negative."""
        form = self.here.shapes.reduced(form)
        made: Polynomial = {(): Fraction(form.constant)}
        for symbol, factor in form.terms:
            term = self._exact_symbol(symbol)
            if term is None:
                return None
            made = _sum(made, term, factor)
        return made

    def _is_place(self, form: Affine) -> bool:
        """Whether a form is known not to be negative, or is a sum of what has none but such terms."""
        return self.here.is_place(form) or form.constant >= 0 and all(
            c > 0 and (self.here.is_place(Affine.symbol(s)) or isinstance(self.here.shapes.atoms.get(s), BinOp))
            for s, c in form.terms)

    def _most_of(self, form: Affine) -> list[Polynomial]:
        """What a form does not exceed: terms with negative factors are at most 0."""
        form = self.here.shapes.reduced(form)
        if any(c < 0 and not self.here.is_place(Affine.symbol(s)) for s, c in form.terms):
            return []
        made: list[Polynomial] = [{(): Fraction(form.constant)}]
        for symbol, factor in form.terms:
            if factor > 0:
                made = [_sum(m, term, factor) for m in made for term in self._most_of_symbol(symbol)][:_SPELLINGS]
        return made

    def _most_of_symbol(self, symbol: str) -> list[Polynomial]:
        found, atom = self._exact_symbol(symbol), self.here.shapes.atoms.get(symbol)
        if found is not None:
            return [found]
        if isinstance(atom, BinOp):
            return self.most(atom) if isinstance(atom.op, (Add, Mult, FloorDiv, Mod)) else []
        if symbol in self._asked:
            return []
        self._asked.add(symbol)
        above = [f.plus(Affine.symbol(symbol)) for f in self.here.places if (symbol, -1) in f.terms]
        made = [m for f in above for m in self._most_of(f)][:_SPELLINGS]
        self._asked.discard(symbol)
        return made

    def _exact_symbol(self, symbol: str) -> Polynomial | None:
        atom, shapes = self.here.shapes.atoms.get(symbol), self.here.shapes
        if isinstance(atom, BinOp) and isinstance(atom.op, (Add, Mult)):
            forms = [self.here.size(n) for n in (atom.left, atom.right)]
            left, right = (None if f is None else self.exact(f) for f in forms)
            if left is None or right is None:
                return None
            return _sum(left, right) if isinstance(atom.op, Add) else _product(left, right)
        if isinstance(atom, Attribute) and atom.attr == "size":
            extents = [d and self.exact(d) for d in shapes.of(atom.value)]
            return None if None in extents else reduce(_product, extents)  # pyright: ignore[reportArgumentType]
        counts = symbol in {dump(name(c)) for c in self.here.counters}
        return None if counts or not shapes.is_place(Affine.symbol(symbol)) else {(symbol,): Fraction(1)}

    def _divided(self, node: BinOp) -> list[Polynomial]:
        """What a quotient or a remainder does not exceed."""
        form = self.here.size(node.right)
        divisor = None if form is None else self.exact(form)
        if divisor is None or any(c <= 0 for c in divisor.values()):
            return []
        multiples = [q for most in self.most(node.left) for above in self._spellings(_shifted(most, 1))
                     if (q := _quotient(above, divisor)) is not None]
        if isinstance(node.op, FloorDiv):
            return [_shifted(q, -1) for q in multiples]
        return [_shifted(divisor, -1)] if multiples or divisor.keys() == {()} and self.most(node.left) else []

    def _spellings(self, most: Polynomial) -> Iterator[Polynomial]:
        """A polynomial, and others that it does not exceed: with quotients for what is rounded down, and with what
        the conditions here say is equal."""
        yield most
        yield self._relaxed(most)
        for old, new in self._equal_products():
            yield _rewritten(most, old, new)

    def _equal_products(self) -> Iterator[tuple[Polynomial, Polynomial]]:
        """The products that are equal here, both ways: what a reshape asserts of numbers of elements."""
        known = {*self.here.places}
        for form in self.here.places:
            if form.constant or form.times(-1) not in known:
                continue
            sides = [self.exact(Affine.of({s: sign * c for s, c in form.terms if sign * c > 0}, 0)) for sign in (1, -1)]
            left, right = (s if s is not None and len(s) == 1 and () not in s else None for s in sides)
            if left is not None and right is not None:
                yield left, right

    def _relaxed(self, most: Polynomial) -> Polynomial:
        """What a polynomial does not exceed, with a / 2 in place of a // 2."""
        made: Polynomial = {}
        for product, factor in most.items():
            term: Polynomial = {(): factor}
            for symbol in product:
                floor = self._floor(symbol) if factor > 0 else None
                term = _product(term, floor or {(symbol,): Fraction(1)})
            made = _sum(made, term)
        return made

    def _floor(self, symbol: str) -> Polynomial | None:
        """Of the symbol of a size over a number, what it does not exceed."""
        atom = self.here.shapes.atoms.get(symbol)
        if not isinstance(atom, BinOp) or not isinstance(atom.op, FloorDiv):
            return None
        divisor, form = whole_number(atom.right) or 0, self.here.size(atom.left)
        size = None if form is None or divisor <= 0 else self.exact(form)
        return None if size is None else {p: c / divisor for p, c in size.items()}


def _rewritten(one: Polynomial, old: Polynomial, new: Polynomial) -> Polynomial:
    """A polynomial with one product in place of another."""
    (before, divisor), = old.items()
    made: Polynomial = {}
    for product, c in one.items():
        rest = _without(product, before)
        made = _sum(made, {product: c} if rest is None else _product({rest: c / divisor}, new))
    return made


def _without(product: tuple[str, ...], factors: tuple[str, ...]) -> tuple[str, ...] | None:
    """The other factors of a product, None if it lacks one of them."""
    left = list(product)
    for factor in factors:
        if factor not in left:
            return None
        left.remove(factor)
    return tuple(left)


def _sum(one: Polynomial, other: Polynomial, factor: int = 1) -> Polynomial:
    made = {p: one.get(p, Fraction(0)) + factor * other.get(p, Fraction(0)) for p in {**one, **other}}
    return {p: c for p, c in made.items() if c}


def _shifted(one: Polynomial, number: int) -> Polynomial:
    return _sum(one, {(): Fraction(number)})


def _product(one: Polynomial, other: Polynomial) -> Polynomial:
    made: Polynomial = {}
    for a, c in one.items():
        for b, d in other.items():
            made = _sum(made, {tuple(sorted(a + b)): c * d})
    return made


def _quotient(one: Polynomial, divisor: Polynomial) -> Polynomial | None:
    """One polynomial over another, a single product; None unless that is a polynomial in whole numbers.

    >>> _quotient({("m", "n"): Fraction(6)}, {("n",): Fraction(2)})
    {('m',): Fraction(3, 1)}
    """
    if len(divisor) != 1:
        return None
    (factors, coefficient), = divisor.items()
    made: Polynomial = {}
    for product, c in one.items():
        rest = _without(product, factors)
        if rest is None:
            return None
        made[rest] = c / coefficient
    return made if all(c.denominator == 1 for c in made.values()) else None
