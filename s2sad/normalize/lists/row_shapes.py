"""row_shapes: the sizes of what a loop puts into a list, where they follow from what is there before the loop.

    rows.append(x[i:i + 2] * 1.0)               (2,)
    rows.append(np.roll(f[q], 1, axis=0))       f.shape[1:]
    rows.append(x[i * m:(i + 1) * m])           (m,)        the same in the first iteration and in the second
    rows.append(x[:i])                          None

Requires structured form and types. The names that a loop binds stand for what they are bound to, and counters for where
they start. A row that has other sizes is an error when it is stored.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.diagnostics import Report
from s2sad.infer.affine import Affine
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import Shape
from s2sad.infer.shapes import Shapes, bare_shapes
from s2sad.naming import Names
from s2sad.normalize.array_anf import named_arrays
from s2sad.normalize.library.expand import is_piece
from s2sad.normalize.library.expand import expanded
from s2sad.tree import (
    AST, Assign, Call, For, FunctionDef, List, Name, Slice, Tuple, add, assign, call_name, const, copy, name, rebuild,
    times_bound, walk,
)

_MADE = ("numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full")
_PLAIN = {"builtins.len", "builtins.range", "builtins.min", "builtins.max", "runtime.position", "runtime.position_down"}
_DEEPEST = 8

There = Callable[[AST], bool]       # whether all that an expression reads is there


class RowShapes:
    """The sizes of the arrays of one function, of what `there` says of."""

    def __init__(self, function: FunctionDef, typing: Typing):
        self.function = function
        self.given = self.typing = typing.copy(Report(typing.report.source))
        nodes = list(walk(function.body))
        self.bound = {s.targets[0].id: s.value for s in reversed(nodes) if isinstance(s, Assign)
                      and isinstance(s.targets[0], Name)}
        self.times = times_bound(function.body)
        self.starts = {s.target.id: s.iter.args[0] if len(s.iter.args) > 1 else const(0)
                       for s in nodes if isinstance(s, For) and isinstance(s.target, Name)}

    def of(self, value: AST, there: There) -> list[AST] | None:
        """The sizes of an array; None if they are not known, or change."""
        found = [self.shape(value, there, trip) for trip in (0, 1)]
        if not found[0] or found[0] != found[1]:
            return None
        return [self.shapes.extent(d) for d in found[0] if d is not None]

    def shape(self, value: AST, there: There, trip: int) -> Shape:
        """The shape in a loop's first trip, or in the second; () if it is not known."""
        self.typing = self.given.copy()
        self.shapes = _SliceShapes(bare_shapes(self.function, self.typing))
        plain = self.opened(value, there, trip, False)
        if any(is_piece(n, self.typing) for n in walk(plain)):
            return self.of_pieces(plain, there)
        found = self.shapes.of(self.opened(value, there, trip))
        known = all(d is not None and all(self.is_plain(self.shapes.atoms[s], there) for s, _ in d.terms)
                    for d in found)
        return found if known and len(found) == self.typing.of(value).rank else ()

    def of_pieces(self, value: AST, there: There) -> Shape:
        """The shape of what a function gives that is written out in others."""
        free = Names({n.id for n in walk(self.function) if isinstance(n, Name)})
        row = self.typing.declare(free.fresh("row"), self.typing.of(value))
        alone = copy(self.function)
        alone.body = [assign(row, value)]
        made = expanded(named_arrays(alone, self.typing, free), self.typing, free, self.typing.report)
        if self.typing.report.found or any(is_piece(n, self.typing) for n in walk(made)):
            return ()
        alone.body = [*self.function.body, *made.body]
        inner = RowShapes(alone, self.typing)
        found = inner.shape(name(row), there, 0)
        self.shapes = inner.shapes
        return found

    def is_plain(self, size: AST, there: There) -> bool:
        return there(size) and all(call_name(n) in _PLAIN for n in walk(size) if isinstance(n, Call))

    def opened(self, value: AST, there: There, trip: int, named: bool = True, depth: int = 0) -> AST:
        """The expression over what is there; an array that is allocated has a name of its own, of a shape that is
        known, if `named`."""
        def inner(node: AST) -> AST:
            return self.opened(node, there, trip, named, depth + 1)

        def change(node: AST) -> AST | None:
            if isinstance(node, Name) and "." not in node.id and not there(node) and depth < _DEEPEST:
                if node.id in self.starts and self.times[node.id] == 1:
                    return add(inner(self.starts[node.id]), const(trip)) if trip else inner(self.starts[node.id])
                again = self.typing.of(node).is_number and self.times[node.id] > 1
                return inner(self.bound[node.id]) if node.id in self.bound and not again else None
            if named and call_name(node) in _MADE and isinstance(node, Call):
                return self.named(node, self.shapes.asked_for(inner(node.args[0])))
            if named and call_name(node) == "numpy.array" and isinstance(node, Call) and isinstance(
                    node.args[0], (List, Tuple)):
                return self.named(node, tuple(Affine((), n) for n in written_sizes(node.args[0])))
            return None
        return rebuild(value, change)

    def named(self, node: AST, shape: Shape | None) -> AST:
        """A name for an array of such a shape."""
        held = f"made {len(self.shapes.arrays)}"
        self.typing.declare(held, kind := self.typing.of(node))
        self.shapes.arrays[held] = shape if shape is not None else (None,) * kind.rank
        return name(held)


class _SliceShapes(Shapes):
    """Shapes where slices are taken to lie inside their arrays."""

    def __init__(self, given: Shapes):
        super().__init__(given.typing, given.values)
        self.settled, self.several, self.counters = given.settled, given.several, given.counters

    def ordered(self, part: Slice) -> bool:
        return True

    def placed(self, function: str, node: AST, size: Affine) -> Affine | None:
        form = self.size(node)
        if form is None or function != "runtime.position":
            return None
        ends = bool(form.terms) and all(c < 0 for _, c in form.terms)
        return size.plus(form) if ends else form


def written_sizes(node: AST) -> list[int]:
    """The sizes of the array that nested lists spell."""
    if not isinstance(node, (List, Tuple)):
        return []
    return [len(node.elts), *(written_sizes(node.elts[0]) if node.elts else [])]
