"""slice_extents: how many elements a subscript takes of an axis, and where it starts and stops, as forms.

Requires types. Where NumPy would clamp or count from the end and the forms cannot tell, a guard is asked for.
"""
from __future__ import annotations

from collections.abc import Iterable
from copy import copy as replica

from s2sad.infer.affine import Affine
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE, Shape, whole_number
from s2sad.infer.symbolic_integers import Sizes
from s2sad.tree import AST, Add, BinOp, Constant, Name, Slice, Subscript, call, const, copy, dump, indices, mult, names


Step = int | AST        # a written number, or a positive expression that stays what it is


class Slices(Sizes):
    """What the subscripts in one function take; `settled` where guards have been put before it."""
    settled = False

    def region(self, node: Subscript) -> Shape:
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
                found += [self.chosen(subscript)] if kind.dtype == "bool" else self.picked(node)
            axis += self.width(subscript)
        return tuple(found)

    def chosen(self, mask: AST) -> Affine:
        """How many elements an array of bools picks in this statement."""
        key = f"{dump(mask)} {self.serial}"
        self.passing.add(key)
        return self.symbol(call("numpy.count_nonzero", mask), key)

    def picked(self, node: Subscript) -> Shape:
        """The shape of the elements that arrays of integers pick."""
        return self.broadcast(self.of(s) for s in indices(node) if not isinstance(s, (Slice, Constant)))

    def broadcast(self, shapes: Iterable[Shape]) -> Shape:
        """The shape of an elementwise operation on arrays of these shapes."""
        result: list[Affine | None] = []
        for shape in shapes:
            result = [ONE] * (len(shape) - len(result)) + result
            for k, size in enumerate(reversed(shape), 1):
                if result[-k] == ONE or result[-k] is None and size is not None and size != ONE:
                    result[-k] = size
        return tuple(result)

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
        if is_step(step, 1) and (stop == size or self.ordered(part)):
            return stop.plus(start, -1)
        return self.taken(span)

    def taken(self, span: tuple[Affine, Affine, Step]) -> Affine:
        """How many elements there are from a start to a stop."""
        start, stop, step = span
        return self.symbol(call("builtins.len", call("builtins.range", self.expression(start), self.expression(stop),
                                                     spelled(step))))

    def is_single(self, part: Slice, size: Affine) -> bool:
        """Whether a slice is written to take one element, `i:i + 1`; that there is one becomes a guard."""
        if part.upper is None or part.step is not None:
            return False
        low, high = (Affine() if p is None else self.size(p) for p in (part.lower, part.upper))
        if low is None or high is None:
            return self.settled and _is_next(part)
        if high.plus(low, -1) != ONE:
            return False
        if part.lower is not None and not self.is_counted(part.lower):
            if not isinstance(part.lower, Name):
                return False
            self.required.append(low)
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

    def span(self, part: Slice, size: Affine) -> tuple[Affine, Affine, Step] | None:
        """Where a slice of an axis of this size starts and stops, and its step, as a range; None if it may change."""
        step = 1 if part.step is None else self.step(part.step)
        if not step:
            return None
        if isinstance(step, int) and step < 0:
            start = size.shift(-1) if part.lower is None else self.placed("runtime.position_down", part.lower, size)
            stop = Affine((), -1) if part.upper is None else self.placed("runtime.position_down", part.upper, size)
        else:
            start = Affine() if part.lower is None else self.lower(part.lower, size)
            stop = size if part.upper is None else self.upper(part.upper, size)
        return None if start is None or stop is None else (start, stop, step)

    def step(self, node: AST) -> Step | None:
        """The step of a slice: a written number, or one that stays what it is and is positive; None if it may not."""
        number, form = whole_number(node), self.size(node)
        if number is not None or form is None:
            return number
        if not form.terms:
            return form.constant
        if not self.is_place(form.shift(-1)):
            self.stepping.append(form.shift(-1))
        return self.expression(form)

    def moved(self, start: Affine, count: Affine, step: Step) -> Affine:
        """Where one comes to from a position by so many steps."""
        if isinstance(step, int):
            return start.plus(count, step)
        if count.terms:
            return start.plus(self.symbol(mult(self.expression(count), copy(step))))
        form = self.size(step)
        return start.plus(form if form is not None else self.symbol(copy(step)), count.constant)

    def here(self, part: Slice, size: Affine) -> Slices:
        """The shapes for a slice at one place, where the names in its bounds are what they are there."""
        return self.at_once(part) if self.span(part, size) is None else self

    def at_once(self, node: AST) -> Slices:
        """The shapes for an expression at one place, where the names in it are what they are there."""
        made = replica(self)
        made.values, made.equal = {**dict.fromkeys(names(node)), **self.values}, {}
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


def is_step(step: Step, number: int) -> bool:
    """Whether a step is this number."""
    return isinstance(step, int) and step == number


def spelled(step: Step) -> AST:
    """A step as an expression."""
    return const(step) if isinstance(step, int) else copy(step)


def _is_next(part: Slice) -> bool:
    """Whether a slice is spelled `i:i + 1`."""
    end = part.upper
    return isinstance(end, BinOp) and isinstance(end.op, Add) and whole_number(end.right) == 1 and (
        part.lower is not None and dump(end.left) == dump(part.lower))


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
