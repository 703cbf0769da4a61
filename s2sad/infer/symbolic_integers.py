"""symbolic_integers: integer expressions as affine forms over sizes of parameters and numbers bound once.

Requires types. A size that is no such form is a symbol of its own; guards say which symbols are equal.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping

from s2sad.infer.bounded_arithmetic import is_bounded
from s2sad.infer.affine import Affine, combined
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE, Shape, whole_number
from s2sad.tree import (
    AST, Add, Attribute, BinOp, FloorDiv, Mod, Mult, Name, Sub, Subscript, USub, UnaryOp, attribute, call, call_name,
    children, const, copy, dump, index, name, names, user_call,
)

_NAMES = 64     # that are followed for one form


class Sizes(ABC):
    """The sizes of one function; `values` are the names bound once, with what they are bound to, None if a loop or
    a call binds them."""

    def __init__(self, typing: Typing, values: Mapping[str, AST | None]):
        self.typing, self.values = typing, values
        self.arrays: dict[str, Shape] = {}
        self.atoms: dict[str, AST] = {}
        self.equal: dict[str, Affine] = {}
        self.scopes: dict[int, dict[str, Affine]] = {}  # the equalities that hold at a statement, by its id
        self.several: frozenset[str] = frozenset()  # arrays that more than one statement allocates
        self.serial = 0  # of the statement: an array of bools has one count only within one
        self.transient: set[str] = set()  # the symbols that mean a size within one statement only
        self.counters: dict[str, int] = {}  # the loop counters here, with the least that each can be
        self.positive_steps: list[Affine] = []  # steps of slices less 1, that must not be negative either
        self._places: dict[str, bool] = {}      # the names asked for, and whether they are known not to be negative
        self.required: list[Affine] = []  # sizes that must not be negative for slices to have the extents assumed

    @abstractmethod
    def of(self, node: AST) -> Shape:
        """The shape of an expression; () for a number."""

    def symbol(self, node: AST, key: str = "") -> Affine:
        key = key or dump(node)
        self.atoms[key] = node
        return self.reduced(Affine.symbol(key))

    def reduced(self, size: Affine) -> Affine:
        """The size with what guards have found equal replaced."""
        while True:
            found = next((s for s, _ in size.terms if s in self.equal), None)
            if found is None:
                return size
            factor = dict(size.terms)[found]
            rest = Affine.of({s: c for s, c in size.terms if s != found}, size.constant)
            size = rest.plus(self.equal[found], factor)

    def are_equal(self, a: Affine | None, b: Affine | None) -> bool:
        """Whether two sizes are known to be equal."""
        return a is not None and b is not None and self.reduced(a) == self.reduced(b)

    def unify(self, a: Affine, b: Affine) -> None:
        """Assumes from here on that two sizes are equal."""
        form = self.reduced(a).plus(self.reduced(b), -1)
        for symbol, coefficient in sorted(form.terms):
            if abs(coefficient) == 1:
                rest = Affine.of({s: c for s, c in form.terms if s != symbol}, form.constant)
                self.equal[symbol] = rest.times(-coefficient)
                return

    def size(self, node: AST, found: dict[str, Affine | None] | None = None) -> Affine | None:
        """The form of an integer expression; None if it may change. `found` has the forms of the names in it, as far as
        these are known already; a name within its own is a symbol."""
        found = {} if found is None else found
        number = whole_number(node)
        if number is not None:
            return Affine((), number)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.size(node.operand, found)
            return inner and inner.times(-1)
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
            made = self._binary(node, found)
            if made is not None:
                return made
        if isinstance(node, Name) and len(found) < _NAMES:
            value = self.values.get(node.id)
            if value is not None and node.id not in found:
                found[node.id] = None
                found[node.id] = self.size(value, found)
            inner = found.get(node.id)
            if inner is not None:
                return inner
        if isinstance(node, Attribute) and node.attr == "ndim" and self.typing.of(node.value).is_array:
            return Affine((), self.typing.of(node.value).rank)
        extent = self.axis_size(node)
        if extent is not None and self.is_extent(extent):
            return extent
        return self.symbol(node) if self.stable(node) else None

    def _binary(self, node: BinOp, found: dict[str, Affine | None]) -> Affine | None:
        form = combined(node.op, self.size(node.left, found), self.size(node.right, found))
        return form if form is not None and all(map(is_bounded, (form.constant, *dict(form.terms).values()))) else None

    def is_extent(self, size: Affine) -> bool:
        """Whether a form may be a term of a sum: it is not negative."""
        return size == ONE or not size.terms and size.constant >= 0 or self.is_place(self.reduced(size))

    def axis_size(self, node: AST) -> Affine | None:
        """The size of the axis that an expression reads, as `len(x)` does; None for any other expression."""
        if isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape":
            axis, base = whole_number(node.slice), node.value.value
            rank = self.typing.of(base).rank
            return self.of(base)[axis] if axis is not None and -rank <= axis < rank else None
        if call_name(node) == "builtins.len" and self.typing.of(node.args[0]).is_array:
            return self.of(node.args[0])[0]
        if call_name(node) == "numpy.size" and self.typing.of(node.args[0]).rank == 1:
            return self.of(node.args[0])[0]
        if isinstance(node, Attribute) and node.attr == "size" and self.typing.of(node.value).rank == 1:
            return self.of(node.value)[0]
        return None

    def stable(self, node: AST) -> bool:
        """Whether an expression is invariant: its names are bound once, and it reads no array."""
        if any(n not in self.values for n in names(node) if not self.typing.table[n].is_array):
            return False
        return not any(isinstance(n, Name) and n.id in self.typing.table and self.typing.table[n.id].is_array
                       or user_call(n) for n in _content(node))

    def is_counted(self, node: AST) -> bool:
        """Whether an integer expression is known not to be negative: made of counters and sizes."""
        if isinstance(node, BinOp) and isinstance(node.op, Mod):
            return self.is_counted(node.right)
        form, least = self.size(node), self.lower_bounds()
        if form is None or any(c < 0 or s not in least for s, c in form.terms):
            return False
        return form.constant + sum(c * least[s] for s, c in form.terms) >= 0

    def lower_bounds(self) -> dict[str, int]:
        """The least value of every symbol of which one is known."""
        sizes = {s: 0 for s, atom in self.atoms.items() if self._is_never_negative(atom)}
        return {**sizes, **{dump(name(c)): low for c, low in self.counters.items()}}

    def _is_never_negative(self, node: AST) -> bool:
        """Whether an integer is a size, or is made of sizes and numbers that are not negative."""
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Mult, FloorDiv)):
            return self._is_never_negative(node.left) and self._is_never_negative(node.right)
        if isinstance(node, Name):
            if node.id not in self._places:
                value, self._places[node.id] = self.values.get(node.id), False      # what its own value may read
                self._places[node.id] = value is not None and self._is_never_negative(value)
            return self._places[node.id]
        if call_name(node) in ("builtins.min", "builtins.max"):
            return (all if call_name(node) == "builtins.min" else any)(map(self._is_never_negative, node.args))
        number = whole_number(node)
        return (call_name(node) == "builtins.len" or _is_size(node)) if number is None else number >= 0

    def expression(self, size: Affine, reduced: bool = True) -> AST:
        """The size as an expression."""
        size = self.reduced(size) if reduced else size
        made: AST | None = None
        for symbol, coefficient in sorted(size.terms, key=lambda t: t[1] < 0):
            atom = copy(self.atoms[symbol])
            part = atom if abs(coefficient) == 1 else BinOp(const(abs(coefficient)), Mult(), atom)
            if made is None:
                made = part if coefficient > 0 else UnaryOp(USub(), part)
            else:
                made = BinOp(made, Add() if coefficient > 0 else Sub(), part)
        if made is None:
            return const(size.constant)
        if not size.constant:
            return made
        return BinOp(made, Add() if size.constant > 0 else Sub(), const(abs(size.constant)))

    def extent(self, size: Affine) -> AST:
        """The size as an expression that is 0 where the form is negative: a slice takes no elements then."""
        form, made = self.reduced(size), self.expression(size)
        below = form.constant < 0 or any(c < 0 for _, c in form.terms)
        return call("builtins.max", made, const(0)) if below else made

    def own_symbol(self, base: str, axis: int) -> Affine:
        """The size of an array's axis, by its own name."""
        size = index(attribute(name(base), "shape"), const(axis))
        self.atoms[key := dump(size)] = size
        return Affine.symbol(key)

    def is_place(self, form: Affine) -> bool:
        """Whether a form is known not to be negative, made of sizes and counters."""
        least = self.lower_bounds()
        return all(c > 0 and s in least for s, c in form.terms) and form.constant + sum(
            c * least[s] for s, c in form.terms) >= 0

    def _sizes_only(self, form: Affine) -> bool:
        """Whether a form adds up sizes of arrays, so that it is never negative."""
        return form.constant >= 0 and all(c > 0 and _is_size(self.atoms[s]) for s, c in form.terms)


def _is_size(node: AST) -> bool:
    return isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape"


def _content(node: AST) -> Iterable[AST]:
    """The nodes below whose content is read; arrays of which only the shape is read are left out."""
    if isinstance(node, Attribute) and node.attr in ("shape", "size", "ndim"):
        return
    yield node
    for child in children(node):
        yield from _content(child)
