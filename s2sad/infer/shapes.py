"""shapes: the sizes of arrays as affine forms over sizes of parameters and numbers bound once.

Requires types; knows of two array expressions whether their shapes are equal, from how arrays are allocated and from
the guards that were put before. A size that is no such form is a symbol of its own.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy as replica

from s2sad import rules
from s2sad.infer.affine import Affine
from s2sad.infer.infer import Typing
from s2sad.infer.laws import LAWS, ONE, Shape, whole_number
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, AugAssign, BinOp, Compare, Constant, Eq, FloorDiv, For, FunctionDef, If, Mod,
    Mult, Name, Slice, Store, Sub, Subscript, Tuple, USub, UnaryOp, While, attribute, call, call_name,
    children, const, copy, dump, index, indices, name, names, tuple_of, walk,
)


class Shapes:
    """The shapes of one function; `values` are the names bound once, with what they are bound to, None if a loop or
    a call binds them."""

    def __init__(self, typing: Typing, values: Mapping[str, AST | None]):
        self.typing, self.values = typing, values
        self.arrays: dict[str, Shape] = {}
        self.atoms: dict[str, AST] = {}
        self.equal: dict[str, Affine] = {}
        self.serial = 0  # of the statement: an array of bools picks as many as it did only within one
        self.counters: dict[str, int] = {}  # the loop counters here, with the least that each can be
        self.required: list[Affine] = []  # sizes that must not be negative for slices to mean what they are taken for

    # -- sizes -------------------------------------------------------------------------------------------------------

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

    def same(self, a: Affine | None, b: Affine | None) -> bool:
        """Whether two sizes are known to be equal."""
        return a is not None and b is not None and self.reduced(a) == self.reduced(b)

    def unify(self, a: Affine, b: Affine) -> None:
        """Takes two sizes for equal from here on."""
        form = self.reduced(a).plus(self.reduced(b), -1)
        for symbol, coefficient in sorted(form.terms):
            if abs(coefficient) == 1:
                rest = Affine.of({s: c for s, c in form.terms if s != symbol}, form.constant)
                self.equal[symbol] = rest.times(-coefficient)
                return

    def size(self, node: AST, depth: int = 0) -> Affine | None:
        """The form of an integer expression; None if it may change."""
        number = whole_number(node)
        if number is not None:
            return Affine((), number)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.size(node.operand, depth)
            return inner and inner.times(-1)
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
            made = self._binary(node, depth)
            if made is not None:
                return made
        if isinstance(node, Name) and depth < 20:
            value = self.values.get(node.id)
            inner = None if value is None else self.size(value, depth + 1)
            if inner is not None:
                return inner
        asked = self._asked(node)
        if asked is not None:
            return asked
        return self.symbol(node) if self.stable(node) else None

    def _binary(self, node: BinOp, depth: int) -> Affine | None:
        left, right = self.size(node.left, depth), self.size(node.right, depth)
        if left is None or right is None:
            return None
        if isinstance(node.op, Mult):
            if left.terms and right.terms:
                return None
            return right.times(left.constant) if not left.terms else left.times(right.constant)
        return left.plus(right, 1 if isinstance(node.op, Add) else -1)

    def _asked(self, node: AST) -> Affine | None:
        """The size of an axis of an array that an expression asks for."""
        if isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape":
            axis, base = whole_number(node.slice), node.value.value
            rank = self.typing.of(base).rank
            return self.of(base)[axis] if axis is not None and -rank <= axis < rank else None
        if call_name(node) == "builtins.len" and self.typing.of(node.args[0]).is_array:
            return self.of(node.args[0])[0]
        if isinstance(node, Attribute) and node.attr == "size" and self.typing.of(node.value).rank == 1:
            return self.of(node.value)[0]
        return None

    def stable(self, node: AST) -> bool:
        """Whether an expression is the same wherever it stands: its names are bound once, and it reads no array."""
        if any(n not in self.values for n in names(node) if not self.typing.table[n].is_array):
            return False
        return not any(isinstance(n, Subscript) and self.typing.of(n.value).is_array for n in _content(node))

    def is_counted(self, node: AST) -> bool:
        """Whether an integer expression is known not to be negative: made of counters and sizes."""
        if isinstance(node, BinOp) and isinstance(node.op, Mod):
            return self.is_counted(node.right)
        form = self.size(node)
        if form is None or any(c < 0 or s not in self.least() for s, c in form.terms):
            return False
        return form.constant + sum(c * self.least()[s] for s, c in form.terms) >= 0

    def least(self) -> dict[str, int]:
        """The least value of every symbol of which one is known."""
        sizes = {s: 0 for s, atom in self.atoms.items() if _is_size(atom)}
        return {**sizes, **{dump(name(c)): low for c, low in self.counters.items()}}

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

    # -- shapes ------------------------------------------------------------------------------------------------------

    def of(self, node: AST) -> Shape:
        """The shape of an expression; () for a number."""
        if not self.typing.of(node).is_array:
            return ()
        if isinstance(node, Name):
            if node.id not in self.arrays:
                rank = self.typing.of(node).rank
                ones = self.typing.ones.get(node.id, ())
                self.arrays[node.id] = tuple(ONE if k in ones else self.symbol(index(
                    attribute(name(node.id), "shape"), const(k))) for k in range(rank))
            return tuple(d and self.reduced(d) for d in self.arrays[node.id])
        if isinstance(node, Subscript):
            return self._region(node)
        rule = rules.find_array(call_name(node))
        if rule is not None:
            arguments = rule.arguments(node)
            made = LAWS[rule.law].shape([self.of(arguments[o]) for o in rule.operands], arguments)
            if "shape" in rule.operands:
                made = self.asked_for(arguments["shape"], self.of(arguments["x"]))
            elif rule.law == "raveled":
                made = self.asked_for(const(-1), self.of(arguments["x"]))
            elif made is None and rule.law == "singular":
                made = (self._least(self.of(arguments["a"])),)
            return made if made is not None else (None,) * self.typing.of(node).rank
        return self.broadcast(self.of(part) for part in children(node) if self.typing.of(part).is_array)

    def asked_for(self, shape: AST, old: Shape = ()) -> Shape | None:
        """The shape that an argument spells; a size of -1 is what is left of the elements of the old shape."""
        parts = list(shape.elts) if isinstance(shape, Tuple) else [shape]
        if isinstance(shape, Attribute) and shape.attr == "shape":
            return self.of(shape.value)
        if isinstance(shape, BinOp) and self.typing.of(shape).kind == "tuple":
            left, right = self.asked_for(shape.left), self.asked_for(shape.right)
            return None if left is None or right is None else left + right
        if not isinstance(shape, Tuple) and self.typing.of(shape).kind == "tuple":
            return None
        found = [self.size(p) for p in parts]
        for k, part in enumerate(parts):
            if whole_number(part) == -1:
                others = [d for j, d in enumerate(found) if j != k]
                found[k] = None if None in others or None in old else self._rest(old, others)
        return tuple(found)

    def _rest(self, old: Shape, others: list[Affine | None]) -> Affine | None:
        """The size that is left when the elements of the old shape are put into rows of the others."""
        above = [d for d in old if d is not None and d != ONE]
        below = [d for d in others if d is not None and d != ONE]
        for size in list(below):
            if size in above:
                above.remove(size)
                below.remove(size)
        if not below and len(above) <= 1:
            return above[0] if above else ONE
        made = self._product(above)
        return self.symbol(BinOp(made, FloorDiv(), self._product(below)) if below else made)

    def _least(self, sizes: Shape) -> Affine | None:
        if None in sizes:
            return None
        return self.symbol(call("builtins.min", *(self.expression(d) for d in sizes if d is not None)))

    def _product(self, sizes: list[Affine]) -> AST:
        made = self.expression(sizes[0])
        for size in sizes[1:]:
            made = BinOp(made, Mult(), self.expression(size))
        return made

    def broadcast(self, shapes: Iterable[Shape]) -> Shape:
        """The shape of an elementwise operation on arrays of these shapes."""
        result: list[Affine | None] = []
        for shape in shapes:
            result = [ONE] * (len(shape) - len(result)) + result
            for k, size in enumerate(reversed(shape), 1):
                if result[-k] == ONE or result[-k] is None and size is not None and size != ONE:
                    result[-k] = size
        return tuple(result)

    def own(self, base: str, axis: int) -> Affine:
        """The size of an array's axis, by its own name."""
        size = index(attribute(name(base), "shape"), const(axis))
        self.symbol(size)
        return Affine.symbol(dump(size))

    def allocated(self, array: str, shape: Shape) -> None:
        """Notes the shape in which an array has been allocated; it holds as long as equal sizes are remembered."""
        self.arrays[array] = tuple(d if d is not None and not d.terms else self.own(array, k)
                                   for k, d in enumerate(shape))
        for own, size in zip(self.arrays[array], shape):
            if own is not None and own.terms and size is not None:
                (symbol, _), = own.terms
                self.equal.pop(symbol, None)
                known = self.reduced(size)
                if symbol not in dict(known.terms):
                    self.equal[symbol] = known

    def forget(self, array: str, other: str) -> None:
        """An array that is allocated in several places, of which any may have been the last, as `other` may."""
        both = zip(self.of(name(array)), self.of(name(other)))
        self.arrays[array] = tuple(ONE if ONE == a == b else self.own(array, k) for k, (a, b) in enumerate(both))
        for own in self.arrays[array]:
            for symbol, _ in own.terms if own is not None else ():
                self.equal.pop(symbol, None)

    def learn(self, statement: AST) -> None:
        """Notes what an allocation or a guard says of shapes."""
        if isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
            called, value = call_name(statement.value) or "", statement.value
            target = statement.targets[0].id
            if called in ("numpy.empty_like", "numpy.zeros_like"):
                self.allocated(target, self.of(value.args[0]))
            elif called in ("numpy.empty", "numpy.zeros"):
                found = self.asked_for(value.args[0]) or (None,) * self.typing.table[target].rank
                self.allocated(target, found)
        elif isinstance(statement, Assert) and isinstance(statement.test, Compare) and isinstance(
                statement.test.ops[0], Eq):
            left, right = statement.test.left, statement.test.comparators[0]
            if all(isinstance(x, Attribute) and x.attr == "shape" for x in (left, right)):
                pairs = list(zip(self.of(left.value), self.of(right.value)))
            else:
                pairs = [(self.size(left), self.size(right))]
            for a, b in pairs:
                if a is not None and b is not None:
                    self.unify(a, b)

    def learn_single(self, statement: Assign) -> None:
        """Notes the axes of length 1 of an array that is allocated anew in a loop or a branch; all else may change."""
        called, value, target = call_name(statement.value) or "", statement.value, statement.targets[0].id
        if called in ("numpy.empty_like", "numpy.zeros_like"):
            found: Shape | None = self.of(value.args[0])
        elif called in ("numpy.empty", "numpy.zeros"):
            found = self.asked_for(value.args[0])
        else:
            return
        known = self.arrays.get(target, found)
        if found is not None and known is not None:
            self.arrays[target] = tuple(ONE if ONE == a == b else self.own(target, k)
                                        for k, (a, b) in enumerate(zip(found, known)))

    def _region(self, node: Subscript) -> Shape:
        base = self.of(node.value)
        found: list[Affine | None] = []
        axis, picked = 0, False
        for subscript in self.full(indices(node), len(base)):
            if isinstance(subscript, Constant) and subscript.value is None:
                found.append(ONE)
                continue
            if isinstance(subscript, Slice):
                found.append(self.sliced(subscript, base[axis]))
            elif (kind := self.typing.of(subscript)).is_array and not picked:
                picked = True
                found += [self.symbol(call("numpy.count_nonzero", subscript), f"{dump(subscript)} {self.serial}")] \
                    if kind.dtype == "bool" else self.picked(node)
            axis += self.width(subscript)
        return tuple(found)

    def picked(self, node: Subscript) -> Shape:
        """The shape of the elements that arrays of integers pick."""
        return self.broadcast(self.of(s) for s in indices(node) if not isinstance(s, (Slice, Constant)))

    def width(self, subscript: AST) -> int:
        """How many axes a subscript stands for: as many as it has for an array of bools."""
        if isinstance(subscript, Constant) and subscript.value in (None, Ellipsis):
            return 0
        kind = None if isinstance(subscript, (Slice, Constant)) else self.typing.of(subscript)
        return kind.rank if kind is not None and kind.is_array and kind.dtype == "bool" else 1

    def full(self, subscripts: list[AST], rank: int) -> list[AST]:
        """The subscripts with `...` written out and one for every axis."""
        missing: list[AST] = [Slice(None, None, None) for _ in range(rank - sum(map(self.width, subscripts)))]
        made: list[AST] = []
        for s in subscripts:
            if isinstance(s, Constant) and s.value is Ellipsis:
                made, missing = made + missing, []
            else:
                made.append(s)
        return made + missing

    def sliced(self, part: Slice, size: Affine | None) -> Affine | None:
        """How many elements a slice of an axis takes."""
        if part.lower is None and part.upper is None and (part.step is None or abs(whole_number(part.step) or 0) == 1):
            return size
        if size is None:
            return None
        if self.is_single(part, size):
            return ONE
        span = self.span(part, size)
        if span is None:
            return None
        start, stop, step = span
        if step == 1 and (stop == size or self.ordered(part)):
            return stop.plus(start, -1)
        return self.symbol(call("builtins.len", call("builtins.range", self.expression(start), self.expression(stop),
                                                     const(step))))

    def is_single(self, part: Slice, size: Affine) -> bool:
        """Whether a slice is written to take one element, `i:i + 1`; that there is one becomes a guard."""
        if part.upper is None or part.step is not None:
            return False
        low, high = (Affine() if p is None else self.size(p) for p in (part.lower, part.upper))
        if low is None or high is None or high.plus(low, -1) != ONE or not (
                part.lower is None or self.is_counted(part.lower)):
            return False
        self.required.append(size.plus(high, -1))
        return True

    def ordered(self, part: Slice) -> bool:
        """Whether a slice is taken not to stop before it starts: its bounds are written, or follow each other."""
        bounds = [p for p in (part.lower, part.upper) if p is not None and whole_number(p) is None]
        if not bounds or len(bounds) == 1 and (part.lower is None or whole_number(part.lower) == 0):
            return True
        low, high = (None if p is None else self.size(p) for p in (part.lower, part.upper))
        if part.upper is None:
            return True
        if low is None or high is None or not self.is_counted(part.lower):
            return False
        rest = high.plus(low, -1)
        return all(c > 0 and s in self.least() for s, c in rest.terms) and rest.constant + sum(
            c * self.least()[s] for s, c in rest.terms) >= 0

    def span(self, part: Slice, size: Affine) -> tuple[Affine, Affine, int] | None:
        """Where a slice of an axis of this size starts and stops, and its step, as a range; None if it may change."""
        step = 1 if part.step is None else whole_number(part.step)
        if not step:
            return None
        if step < 0:
            start = size.shift(-1) if part.lower is None else self.placed("runtime.position_down", part.lower, size)
            stop = Affine((), -1) if part.upper is None else self.placed("runtime.position_down", part.upper, size)
        else:
            start = Affine() if part.lower is None else self.lower(part.lower, size)
            stop = size if part.upper is None else self.upper(part.upper, size)
        return None if start is None or stop is None else (start, stop, step)

    def here(self, part: Slice, size: Affine) -> Shapes:
        """The shapes for a slice at one place, where the names in its bounds are what they are there."""
        if self.span(part, size) is not None:
            return self
        made = replica(self)
        made.values, made.equal = {**dict.fromkeys(names(part)), **self.values}, {}
        return made

    def lower(self, node: AST, size: Affine) -> Affine | None:
        """Where a slice starts: a written number as it is (beyond the end nothing is taken anyway)."""
        number = whole_number(node)
        if number is not None and number >= 0:
            return Affine((), number)
        if number is not None:
            self.required.append(size.shift(number))
            return size.shift(number)
        return self.placed("runtime.position", node, size)

    def upper(self, node: AST, size: Affine) -> Affine | None:
        """Where a slice stops."""
        number = whole_number(node)
        if number is not None and number < 0:
            return size.shift(number)
        if number is not None:
            return Affine((), min(number, size.constant)) if not size.terms else self.symbol(
                call("builtins.min", const(number), self.expression(size)))
        return self.placed("runtime.position", node, size)

    def placed(self, function: str, node: AST, size: Affine) -> Affine | None:
        """A bound as a position: counted from the end if negative, and not beyond either end."""
        form = self.size(node)
        if form is None:
            return None
        below = size.plus(form, -1)
        if function == "runtime.position" and (not below.terms and below.constant >= 0 or all(
                self._sizes_only(f) for f in (form, below))):
            if not self._sizes_only(form):
                self.required.append(form)
            return form
        return self.symbol(call(function, copy(node), self.expression(size)))

    def _sizes_only(self, form: Affine) -> bool:
        """Whether a form adds up sizes of arrays, so that it is never negative."""
        return form.constant >= 0 and all(c > 0 and _is_size(self.atoms[s]) for s, c in form.terms)


def _is_size(node: AST) -> bool:
    return isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape"


def scattered(place: AST, typing: Typing) -> bool:
    """Whether arrays of integers pick the elements of a place, which may name one twice."""
    return isinstance(place, Subscript) and any(
        typing.of(s).is_array and typing.of(s).dtype != "bool" for s in indices(place) if not isinstance(s, Slice))


def stand_apart(subscripts: list[AST], typing: Typing) -> bool:
    """Whether a slice or a new axis stands between subscripts of which one is an array.

    NumPy then puts the axis of what they pick first."""
    kinds = [isinstance(s, Slice) or isinstance(s, Constant) and s.value in (None, Ellipsis) for s in subscripts]
    if not any(typing.of(s).is_array for s, between in zip(subscripts, kinds) if not between):
        return False
    places = [k for k, between in enumerate(kinds) if not between]
    return places[-1] - places[0] + 1 != len(places)


def is_whole(subscript: AST) -> bool:
    """Whether a subscript takes all of an axis."""
    if isinstance(subscript, Slice):
        return subscript.lower is None and subscript.upper is None and subscript.step is None
    return isinstance(subscript, Constant) and subscript.value is Ellipsis


def shape_expression(shapes: Shapes, shape: Shape) -> AST:
    """A shape as an expression: a size, or a tuple of them."""
    parts = [shapes.expression(d) for d in shape if d is not None]
    return parts[0] if len(parts) == 1 else tuple_of(*parts)


def _content(node: AST) -> Iterable[AST]:
    """The nodes below whose content is read, those that ask for a shape left out."""
    if isinstance(node, Attribute) and node.attr in ("shape", "size", "ndim"):
        return
    yield node
    for child in children(node):
        yield from _content(child)


def shapes_of(function: FunctionDef, typing: Typing) -> Shapes:
    """The shapes of a function with resolved views, as its allocations and guards tell them."""
    made = Shapes(typing, single_values(function))
    inside = {id(s) for outer in walk(function.body) if isinstance(outer, (For, While, If)) for s in walk(outer)}
    for statement in walk(function.body):
        if isinstance(statement, Assert) or id(statement) not in inside:
            made.learn(statement)
        elif isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
            made.learn_single(statement)
    return made


def single_values(function: FunctionDef) -> dict[str, AST | None]:
    """The names bound once, with what an assignment binds them to, None for parameters and loop counters."""
    found: dict[str, AST | None] = {p.id: None for p in function.args.args}
    twice: set[str] = set()
    for statement in walk(function.body):
        bound: list[tuple[str, AST | None]] = []
        if isinstance(statement, Assign):
            target = statement.targets[0]
            value = statement.value if isinstance(target, Name) else None
            bound = [(n.id, value) for n in walk(target) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        elif isinstance(statement, (For, AugAssign)) and isinstance(statement.target, Name):
            bound = [(statement.target.id, None)]
        twice |= {n for n, _ in bound if n in found}
        found |= dict(bound)
    return {n: v for n, v in found.items() if n not in twice}
