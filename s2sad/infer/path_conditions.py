"""path_conditions: what the loops and branches around a call say of the integers there, as inequalities between
affine forms.

    for i in range(n):
        for j in range(i + 1, n):       at the call: 0 <= i < n and i + 1 <= j < n
            rotate(a[i], a[j])

Requires the normal form of loops: a counter is bound by its loop alone, and nothing else is it in its loop.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from s2sad.infer.affine import Affine, at_most, combined, equals, feasible
from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.shapes import Shapes
from s2sad.tree import (
    AST, Add, And, BinOp, BoolOp, Call, Compare, Eq, FloorDiv, For, Gt, GtE, If, Lt, LtE, Mod, Mult, Name, Not, NotEq,
    Or, Sub, Subscript, USub, UnaryOp, While, call_name, const, dump, name, names, stored_names, walk,
    walk_statements,
)

_SAME = frozenset({"builtins.int", "numpy.int64", "numpy.intp"})     # of an integer itself
_BY_CASES = frozenset({"builtins.min", "builtins.max", "builtins.abs", "runtime.element"})
_NEGATED: dict[type[AST], type[AST]] = {Eq: NotEq, NotEq: Eq, Lt: GtE, GtE: Lt, Gt: LtE, LtE: Gt}


@dataclass(frozen=True)
class CallSite:
    """A place in a function: the counters of all loops and of those around it, the names that are bound on every way to
    it since these counted, forms that are not negative there, and forms that are not zero."""
    shapes: Shapes
    counting: frozenset[str]
    counters: frozenset[str] = frozenset()
    bound: frozenset[str] = frozenset()
    places: tuple[Affine, ...] = ()
    others: tuple[Affine, ...] = ()
    several: frozenset[str] = frozenset()       # names bound several times that are symbols where they are mentioned
    remainders: dict[str, tuple[Affine, int]] = field(default_factory=dict)     # what the symbol of a quotient divides
    extremes: Mapping[str, tuple[str, str]] = field(default_factory=dict)       # symbols of the least and the greatest
    # element of arrays of integers that are never written, and for the symbol of an element of one those two
    elements: dict[str, tuple[str, str]] = field(default_factory=dict)

    def size(self, node: AST) -> Affine | None:
        """The form of an integer expression; None if it may have changed since the loops and branches asked for it."""
        if isinstance(node, Name):
            return self._named(node)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub) and whole_number(node) is None:
            inner = self.size(node.operand)
            return inner and inner.times(-1)
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
            found = combined(node.op, self.size(node.left), self.size(node.right))
            if found is not None or not isinstance(node.op, Mult) or any(
                    dump(name(n)) in self.counting for n in names(node)):
                return found
        if isinstance(node, BinOp) and isinstance(node.op, Mod) and (divisor := whole_number(node.right) or 0) > 0:
            return self._remainder(node, divisor)
        if self.extremes and (found := self._of_elements(node)) is not None:
            return found
        form = self.shapes.size(node)
        return None if form is None or any(s in self.counting for s, _ in form.terms) else form

    def _of_elements(self, node: AST) -> Affine | None:
        """The form of an element of an array that is never written, and of what functions make of such."""
        if isinstance(node, Call) and call_name(node) in _SAME and len(node.args) == 1 and self.shapes.typing.of(
                node.args[0]).is_integer:
            return self.size(node.args[0])
        read = {n.value.id for n in walk(node) if isinstance(n, Subscript) and isinstance(n.value, Name)}
        if not read & self.extremes.keys():
            return None
        if isinstance(node, Subscript):
            return self._element(node)
        given = node.args if isinstance(node, Call) and call_name(node) in _BY_CASES else [
            node.left, node.right] if isinstance(node, BinOp) and isinstance(node.op, (Mod, FloorDiv)) else []
        lasts = given and read <= self.extremes.keys() and self._lasts(node)
        return self.shapes.symbol(node) if lasts and all(self.size(g) is not None for g in given) else None

    def _element(self, node: Subscript) -> Affine | None:
        """The symbol of an element: one for each mention, unless what picks it is what it was at the conditions."""
        return self.any_element(node.value, dump(node) if self._lasts(node) else "") if self.shapes.typing.of(
            node).is_number else None

    def any_element(self, array: AST, which: str = "") -> Affine | None:
        """The symbol of an element of an array that is never written, or of rows of one: a new one unless it is known
        which; None of any other array."""
        array = array.value if isinstance(array, Subscript) else array
        if not isinstance(array, Name) or array.id not in self.extremes:
            return None
        self.elements[symbol := f"{which or len(self.elements)} element"] = self.extremes[array.id]
        return Affine.symbol(symbol)

    def _lasts(self, node: AST) -> bool:
        """Whether the numbers in an expression are what they were where the conditions of this place were asked."""
        values, typing = self.shapes.values, self.shapes.typing
        return all(n in self.counters or typing.of(name(n)).is_array or dump(name(n)) not in self.counting
                   and n in values and (n in self.bound or values[n] is None) for n in names(node))

    def _remainder(self, node: BinOp, divisor: int) -> Affine | None:
        """`a % 3` as a - 3 * q, of which `may` knows that it is from 0 to 2."""
        form, quotient = self.size(node.left), Affine.symbol(f"{dump(node)} quotient")
        if form is None:
            return None
        found = form.plus(quotient, -divisor)
        self.remainders[quotient.terms[0][0]] = found, divisor
        return found

    def _named(self, node: Name) -> Affine | None:
        """The form of a name: what it is bound to may be what a counter was, if it is not bound on every way."""
        symbol, value = Affine.symbol(dump(node)), self.shapes.values.get(node.id)
        if node.id in self.counters or node.id in self.several:
            return symbol
        if value is not None:
            here = replace(self, several=frozenset()) if self.several else self     # they may have changed since
            return (here.size(value) if node.id in self.bound else None) or symbol
        return None if dump(node) in self.counting else self.shapes.size(node)

    def is_place(self, form: Affine) -> bool:
        """Whether a form is known not to be negative."""
        return self.shapes.is_place(form) or not self.may([at_most(form, Affine((), -1))])

    def differ(self, a: AST, b: AST) -> bool:
        """Whether two places along one axis are known to be different ones, both counted from the start."""
        one, other = self.size(a), self.size(b)
        if one is None or other is None or not self.is_place(one) or not self.is_place(other):
            return False
        apart = one.plus(other, -1)
        return apart in self.others or apart.times(-1) in self.others or not self.may(equals(one, other))

    def may(self, system: list[Affine]) -> bool:
        """Whether a system of forms that are not negative may have a solution here."""
        return feasible(self.with_bounds([*self.places, *system]))

    def with_bounds(self, system: list[Affine]) -> list[Affine]:
        """The system with what is known of its symbols: of sizes, of counters, and of quotients by numbers."""
        known, least = [*system], self.shapes.lower_bounds()
        for quotient in sorted({s for form in known for s, _ in form.terms if s in self.remainders}):
            form, divisor = self.remainders[quotient]
            known += [form, at_most(form, Affine((), divisor - 1))]
        for element in sorted({s for form in known for s, _ in form.terms if s in self.elements}):
            first, last = map(Affine.symbol, self.elements[element])
            known += [at_most(first, Affine.symbol(element)), at_most(Affine.symbol(element), last)]
        symbols = sorted({s for form in known for s, _ in form.terms})
        return [*known, *(Affine.symbol(s).shift(-least[s]) for s in symbols if s in least)]

    def within(self, loop: For) -> CallSite:
        """The place inside a loop that counts."""
        here = replace(self, counters=self.counters | {loop.target.id})
        args = loop.iter.args
        start, stop = (const(0), args[0]) if len(args) == 1 else args[:2]
        step = whole_number(args[2]) if len(args) > 2 else 1
        counter, low, high = here.size(loop.target), self.size(start), self.size(stop)
        if not step or counter is None:
            return here
        first = [] if low is None else [at_most(low, counter) if step > 0 else at_most(counter, low)]
        last = [] if high is None else [
            at_most(counter.shift(1), high) if step > 0 else at_most(high.shift(1), counter)]
        return replace(here, places=(*self.places, *first, *last))

    def where(self, test: AST, holds: bool) -> CallSite:
        """The place in a branch: its test holds there, or it does not."""
        if isinstance(test, UnaryOp) and isinstance(test.op, Not):
            return self.where(test.operand, not holds)
        if isinstance(test, BoolOp) and isinstance(test.op, And if holds else Or):
            here = self
            for value in test.values:
                here = here.where(value, holds)
            return here
        if not isinstance(test, Compare) or len(test.ops) > 1 or type(test.ops[0]) not in _NEGATED:
            return self
        left, right = self.size(test.left), self.size(test.comparators[0])
        kind = type(test.ops[0]) if holds else _NEGATED[type(test.ops[0])]
        if left is None or right is None or any(
                self.shapes.typing.of(n).dtype != "int64" for n in (test.left, test.comparators[0])):
            return self
        if kind is NotEq:
            return replace(self, others=(*self.others, left.plus(right, -1)))
        found = {Eq: equals(left, right), Lt: [at_most(left.shift(1), right)], LtE: [at_most(left, right)],
                 Gt: [at_most(right.shift(1), left)], GtE: [at_most(right, left)]}[kind]
        return replace(self, places=(*self.places, *found))


def path_conditions(body: list[AST], shapes: Shapes) -> dict[int, CallSite]:
    """The place of every call, by its id."""
    counting = frozenset(dump(s.target) for s in walk_statements(body) if isinstance(s, For))
    return {id(call): here for call, here in _calls(body, CallSite(shapes, counting))}


def _calls(block: list[AST], here: CallSite) -> list[tuple[AST, CallSite]]:
    found: list[tuple[AST, CallSite]] = []
    for statement in block:
        if isinstance(statement, For):
            found += _calls(statement.body, here.within(statement))
        elif isinstance(statement, If):
            found += _calls(statement.body, here.where(statement.test, True))
            found += _calls(statement.orelse, here.where(statement.test, False))
        elif isinstance(statement, While):
            found += _calls(statement.body, here)
        else:
            found += [(n, here) for n in walk(statement) if isinstance(n, Call)]
            if all(n in here.bound or here.shapes.values.get(n) is None for n in names(statement)):
                here = replace(here, bound=here.bound | set(stored_names(statement)))
    return found
