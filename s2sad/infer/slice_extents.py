"""slice_extents: how many elements a subscript takes of an axis, and where it starts and stops, as forms.

Requires types. Where NumPy would clamp or count from the end and the forms do not decide it, a guard is required.
"""
from __future__ import annotations

from collections.abc import Iterable
from copy import copy as replica

from s2sad.infer.affine import Affine
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE, Shape, whole_number
from s2sad.infer.symbolic_integers import Sizes
from s2sad.tree import AST, Add, BinOp, Constant, Name, Slice, Subscript, call, const, copy, dump, indices, mult, names


Step = int | AST        # a constant, or a positive invariant expression


class SliceExtents(Sizes):
    """The extents of the subscripts in one function; `guarded` where the guards stand before it."""
    guarded = False

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
                found += [self.mask_count(subscript)] if kind.dtype == "bool" else self.gathered(node)
            axis += self.width(subscript)
        return tuple(found)

    def mask_count(self, mask: AST) -> Affine:
        """The number of elements that an array of bools picks in this statement."""
        key = f"{dump(mask)} {self.serial}"
        self.transient.add(key)
        return self.symbol(call("numpy.count_nonzero", mask), key)

    def gathered(self, node: Subscript) -> Shape:
        """The shape of what arrays of integers gather."""
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
        """The number of axes that a subscript indexes: an array of bools as many as it has."""
        if isinstance(subscript, Constant) and subscript.value in (None, Ellipsis):
            return 0
        kind = None if isinstance(subscript, (Slice, Constant)) else self.typing.of(subscript)
        return kind.rank if kind is not None and kind.is_array and kind.dtype == "bool" else 1

    def full(self, subscripts: list[AST], rank: int) -> list[AST]:
        """The subscripts with `...` expanded, one for every axis."""
        missing: list[AST] = [Slice(None, None, None) for _ in range(rank - sum(map(self.width, subscripts)))]
        made: list[AST] = []
        for s in subscripts:
            if isinstance(s, Constant) and s.value is Ellipsis:
                made, missing = made + missing, []
            else:
                made.append(s)
        return made + missing

    def sliced(self, part: Slice, size: Affine | None) -> Affine | None:
        """The extent of a slice of an axis."""
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
        if is_step(step, 1) and (stop == size or self.is_ordered(part)):
            return stop.plus(start, -1)
        return self.range_length(span)

    def range_length(self, span: tuple[Affine, Affine, Step]) -> Affine:
        """The length of a range."""
        start, stop, step = span
        return self.symbol(call("builtins.len", call("builtins.range", self.expression(start), self.expression(stop),
                                                     step_expression(step))))

    def is_single(self, part: Slice, size: Affine) -> bool:
        """Whether a slice has the form `i:i + 1`; that there is such an element becomes a guard."""
        if part.upper is None or part.step is not None:
            return False
        low, high = (Affine() if p is None else self.size(p) for p in (part.lower, part.upper))
        if low is None or high is None:
            return self.guarded and _is_next(part)
        if high.plus(low, -1) != ONE:
            return False
        if part.lower is not None and not self.is_counted(part.lower):
            if not isinstance(part.lower, Name):
                return False
            self.required.append(low)
        self.required.append(size.plus(high, -1))
        return True

    def is_ordered(self, part: Slice) -> bool:
        """Whether a slice is assumed not to stop before it starts: its bounds are constants, or known in order."""
        bounds = [p for p in (part.lower, part.upper) if p is not None and whole_number(p) is None]
        if not bounds or len(bounds) == 1 and (part.lower is None or whole_number(part.lower) == 0):
            return True
        low, high = (None if p is None else self.size(p) for p in (part.lower, part.upper))
        if part.upper is None:
            return True
        if low is None or high is None or not self.is_counted(part.lower):
            return False
        rest = high.plus(low, -1)
        return all(c > 0 and s in self.lower_bounds() for s, c in rest.terms) and rest.constant + sum(
            c * self.lower_bounds()[s] for s, c in rest.terms) >= 0

    def span(self, part: Slice, size: Affine) -> tuple[Affine, Affine, Step] | None:
        """Start, stop and step of a slice of an axis of this size, as of a range; None if they may change."""
        step = 1 if part.step is None else self.step(part.step)
        if not step:
            return None
        if isinstance(step, int) and step < 0:
            start = size.shift(-1) if part.lower is None else self.clamped("runtime.position_down", part.lower, size)
            stop = Affine((), -1) if part.upper is None else self.clamped("runtime.position_down", part.upper, size)
        else:
            start = Affine() if part.lower is None else self.lower(part.lower, size)
            stop = size if part.upper is None else self.upper(part.upper, size)
        return None if start is None or stop is None else (start, stop, step)

    def step(self, node: AST) -> Step | None:
        """The step of a slice: a constant, or invariant and positive; None for any other."""
        number, form = whole_number(node), self.size(node)
        if number is not None or form is None:
            return number
        if not form.terms:
            return form.constant
        if not self.is_place(form.shift(-1)):
            self.positive_steps.append(form.shift(-1))
        return self.expression(form)

    def position_after(self, start: Affine, count: Affine, step: Step) -> Affine:
        """The position so many steps after another."""
        if isinstance(step, int):
            return start.plus(count, step)
        if count.terms:
            return start.plus(self.symbol(mult(self.expression(count), copy(step))))
        form = self.size(step)
        return start.plus(form if form is not None else self.symbol(copy(step)), count.constant)

    def for_slice(self, part: Slice, size: Affine) -> SliceExtents:
        """The shapes at one slice, where the names in its bounds are invariant."""
        return self.at_statement(part) if self.span(part, size) is None else self

    def at_statement(self, node: AST) -> SliceExtents:
        """The shapes at one statement, where the names in an expression are invariant."""
        made = replica(self)
        made.values, made.equal = {**dict.fromkeys(names(node)), **self.values}, {}
        return made

    def lower(self, node: AST, size: Affine) -> Affine | None:
        """Where a slice starts; a constant is not clamped (beyond the end there are no elements anyway)."""
        number = whole_number(node)
        if number is not None and number >= 0:
            return Affine((), number)
        if number is not None:
            self.required.append(size.shift(number))
            return size.shift(number)
        return self.clamped("runtime.position", node, size)

    def upper(self, node: AST, size: Affine) -> Affine | None:
        """Where a slice stops."""
        number = whole_number(node)
        if number is not None and number < 0:
            return size.shift(number)
        if number is not None:
            return Affine((), min(number, size.constant)) if not size.terms else self.symbol(
                call("builtins.min", const(number), self.expression(size)))
        return self.clamped("runtime.position", node, size)

    def clamped(self, function: str, node: AST, size: Affine) -> Affine | None:
        """A bound as a position, as NumPy has it: counted from the end if negative, and clamped to both ends."""
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


def step_expression(step: Step) -> AST:
    """A step as an expression."""
    return const(step) if isinstance(step, int) else copy(step)


def _is_next(part: Slice) -> bool:
    """Whether a slice has the form `i:i + 1`."""
    end = part.upper
    return isinstance(end, BinOp) and isinstance(end.op, Add) and whole_number(end.right) == 1 and (
        part.lower is not None and dump(end.left) == dump(part.lower))


def scattered(place: AST, typing: Typing) -> bool:
    """Whether a store there is a scatter: arrays of integers index it, and may name an element twice."""
    return isinstance(place, Subscript) and any(
        typing.of(s).is_array and typing.of(s).dtype != "bool" for s in indices(place) if not isinstance(s, Slice))


def are_separated(subscripts: list[AST], typing: Typing) -> bool:
    """Whether a slice or a new axis separates subscripts of which one is an array: NumPy puts their axis first then."""
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
