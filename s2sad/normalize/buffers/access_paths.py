"""access_paths: the access path of an array expression: its base array with all of its subscripts.

Used by `resolve_views`, which knows the access path of every name. Guards that an expression needs go before its
statement.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import Shapes
from s2sad.infer.slice_extents import is_whole, are_separated
from s2sad.infer.types import INT, Type
from s2sad.naming import Names
from s2sad.normalize.buffers.allocations import Allocations, is_full
from s2sad.normalize.control.hoist import constant_index
from s2sad.normalize.buffers.compose_subscripts import composed, is_new
from s2sad.tree import (
    AST, Attribute, BinOp, Call, Constant, List, Name, Slice, Subscript, Tuple, assign, at, attribute, call, call_name,
    const, copy, index, indices, mult, name, names, rebuild, substitute, tuple_of, walk,
)

AccessPath = tuple[str, tuple[AST, ...]]
AMBIGUOUS: AccessPath = ("", ())


class AccessPaths:
    """The access paths of the names of one function where a statement is."""

    def __init__(self, types: Mapping[str, Type], typing: Typing, free: Names, report: Report, bound: list[str],
                 shapes: Shapes):
        self.types, self.typing, self.free, self.report, self.shapes = types, typing, free, report, shapes
        self.preceding: list[AST] = []
        self.loops = self.testing = False               # `testing`: in the test of a while, which has no place before
        self.paths: dict[str, AccessPath] = {}
        self.tuples: dict[str, AST] = {}
        self.parameters: set[str] = set()
        self.bound = bound
        self.depth = 0
        self.versions: set[str] = set()
        self.depths: dict[str, int] = {}                  # how many loops are around an allocation
        self.allocations = Allocations(typing, report, shapes)
        self.ambiguous: set[str] = set()                  # names that have been refused

    def access_path(self, node: AST) -> AccessPath | None:
        """The access path of an array expression, or None if it is no name or part of an array."""
        if isinstance(node, Name):
            if not self.typing.of(node).is_array:
                return None
            view = self.paths.get(node.id)
            if view is None and node.id.startswith("array."):
                return node.id, ()
            if view is None or view == AMBIGUOUS:
                self.ambiguous.add(node.id)
                self.report.error("S201", f"'{self.free.user_name(node.id)}' may stand for different arrays here", node,
                                  help="copy into one array with x[...] = ..., or use two names")
                return None
            return view
        if isinstance(node, Subscript):
            inner = self.access_path(node.value)
            if inner is None:
                return None
            if self.gathers_from_part(node, inner):
                inner = (self.copied_part(node.value), ())
            added = [self.resolved_subscript(s) for s in indices(node)]
            if self.loops and not self.testing and self.typing.of(node).is_array:
                added = [self.frozen(s, "place") if self.is_computed(s) else s for s in added]
            return inner[0], self.composed(inner, added, node)
        return None

    def is_computed(self, subscript: AST) -> bool:
        """Whether an index is computed from an array, `np.argmax(x)`: a loop over a row computes it once, before it."""
        return not isinstance(subscript, Slice) and self.typing.of(subscript).is_number and any(
            isinstance(n, Call) and any(self.typing.of(a).is_array for a in n.args) for n in walk(subscript))

    def gathers_from_part(self, node: Subscript, view: AccessPath) -> bool:
        """Whether arrays pick elements of a part of an array that slices take, or behind a slice of one that numbers
        do: it is copied first."""
        picks = any(self.typing.of(s).is_array for s in indices(node) if not isinstance(s, (Slice, Constant)))
        return picks and (any(isinstance(s, Slice) or is_new(s) for s in view[1]) or are_separated(
            [*view[1], *indices(node)], self.typing))

    def copied_part(self, part: AST) -> str:
        """A name for a copy of a part of an array."""
        held = self.typing.declare(self.free.fresh("part"), self.typing.of(part))
        made = self.allocations.allocate(held, self.typing.of(part), call("numpy.copy", self.resolve(part)), part)
        self.paths[held] = (held, ())
        self.preceding += made
        return held

    def resolved_subscript(self, subscript: AST) -> AST:
        """A subscript with views resolved; the bounds of a slice stay what they are now."""
        if isinstance(subscript, Name) and self.typing.of(subscript).is_array:
            return self.index_array(subscript)
        if not isinstance(subscript, Slice):
            return self.resolve(subscript)
        parts = (subscript.lower, subscript.upper, subscript.step)
        return self.frozen(Slice(*(p and self.resolve(p) for p in parts)), "bound")

    def frozen(self, subscript: AST, wanted: str) -> AST:
        """A subscript as an expression that stays what it is now; what may change gets a name before."""
        return self._frozen(subscript, wanted, {})

    def _frozen(self, subscript: AST, wanted: str, known: dict[str, str]) -> AST:
        """The same; `known` are the names that the bounds of a slice have got, so that `i:i + 1` takes one element."""
        if isinstance(subscript, Slice):
            parts = (subscript.lower, subscript.upper, subscript.step)
            return Slice(*(p and self._frozen(p, wanted, known) for p in parts))
        simple = not any(isinstance(n, (Subscript, Call)) for n in walk(subscript))
        if simple and all(self.bound.count(n) <= 1 for n in names(subscript)) or self.is_invariant(subscript):
            return subscript
        counters = [n for n in names(subscript) if n in self.shapes.counters]
        if simple and set(counters) == {n for n in names(subscript) if self.bound.count(n) > 1}:
            for n in counters:
                if n not in known:
                    known[n] = self.frozen_name(name(n), wanted)
                    self.shapes.counters = {**self.shapes.counters, known[n]: self.shapes.counters[n]}
            return substitute(subscript, {n: name(known[n]) for n in counters})
        return name(self.frozen_name(subscript, wanted))

    def frozen_name(self, value: AST, wanted: str) -> str:
        """A name for an integer as it is now."""
        held = self.typing.declare(self.free.fresh(wanted), INT)
        self.preceding.append(assign(held, value))
        self.shapes.values = {**self.shapes.values, held: None}
        return held

    def is_invariant(self, node: AST) -> bool:
        """Whether an expression is made of sizes of arrays that are bound once: they stay what they are."""
        if isinstance(node, BinOp):
            return self.is_invariant(node.left) and self.is_invariant(node.right)
        asked = isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape"
        return isinstance(node, Constant) or asked and self.depth == 0 and all(
            self.bound.count(n) <= 1 for n in names(node))

    def composed(self, view: AccessPath, added: list[AST], node: AST) -> tuple[AST, ...]:
        """The subscripts of a view's part, trailing whole axes left out."""
        def refuse(what: str) -> None:
            self.report.error("S201", what, node, help="take the part from the array itself, or write a loop")
        if not view[1] and len(added) == 1 and is_full(added[0]):
            return ()
        if any(self.typing.of(s).is_array for s in (*view[1], *added) if not isinstance(s, Slice)):
            if any(isinstance(s, Slice) or is_new(s) or self.typing.of(s).is_array for s in view[1]):
                refuse("elements picked from a part of an array")
            elif are_separated([*view[1], *added], self.typing):
                refuse("subscripts that pick elements on both sides of a slice")
            return (*view[1], *added)
        if all(not isinstance(s, Slice) and not is_new(s) and not is_full(s) for s in (*view[1], *added)):
            return (*view[1], *added)
        found = composed(self.shapes, name(view[0]), list(view[1]), added, refuse)
        while found and is_whole(found[-1]) and not any(map(is_new, found)) and len(found) > 1 and \
                not isinstance(found[-2], Slice):
            found.pop()
        if all(map(is_whole, found)):
            return ()
        self.shapes.of(index(name(view[0]), *found))  # asks for the guards under which its slices are exact
        return tuple(found)

    def index_array(self, array: Name) -> AST:
        """An array of subscripts: a name; a part of an array is copied before."""
        base, subscripts = self.access_path(array) or AMBIGUOUS
        if subscripts and base and not self.testing:
            kind = self.typing.of(array)
            held = self.typing.declare(self.free.fresh("places"), kind)
            self.preceding += self.allocations.allocate(held, kind, index(name(base), *map(copy, subscripts)), array)
            return name(held)
        if subscripts or base == "":
            self.report.error("S201", "a part of an array as a subscript", array,
                              help="copy it before: places = x[...].copy()")
        return name(base or array.id)

    def store_target(self, target: AST) -> Subscript:
        base, subscripts = self.access_path(target) or AMBIGUOUS
        if not base and not self.report.found:
            self.report.error("S201", "an element of something that is no array is written", target,
                              help="make it an array: np.zeros(n), or np.array([...])")
        if base.startswith("array."):
            self.report.error("S201", f"the global array '{base[6:]}' is written", target,
                              help="pass it as an argument")
        new = index(name(base), *([self.unaliased(s, base, target) for s in subscripts] or (const(...),)))
        self.preceding += self.allocations.mask_guards(new) if self.loops else []
        return at(new, target) if hasattr(target, "lineno") else new

    def unaliased(self, subscript: AST, base: str, target: AST) -> AST:
        """A subscript of a store; an array of integers that picks what is stored into itself is copied before."""
        kind = self.typing.of(subscript) if isinstance(subscript, Name) and subscript.id == base else None
        if kind is None or not kind.is_array or kind.dtype == "bool":
            return subscript
        held = self.typing.declare(self.free.fresh("places"), kind)
        self.preceding += self.allocations.allocate(held, kind, call("numpy.copy", name(base)), target)
        return name(held)

    def is_region(self, place: Subscript) -> bool:
        return self.typing.of(place).is_array

    def resolve(self, node: AST) -> AST:
        def change(n: AST) -> AST | None:
            if isinstance(n, Name) and n.id in self.tuples:
                return copy(self.tuples[n.id])
            if isinstance(n, Subscript) and isinstance(n.value, Name) and n.value.id in self.tuples:
                return self.item(self.tuples[n.value.id], n)
            if isinstance(n, Subscript) and isinstance(n.value, (Tuple, List)):
                return self.item(self.resolve(n.value), n)
            if isinstance(n, Subscript) and isinstance(n.value, Attribute) and self.typing.of(n.value.value).is_array:
                return _item(self.attribute(n.value) or n.value, self.resolve(n.slice))
            if isinstance(n, Attribute) and self.typing.of(n.value).is_array:
                return self.attribute(n)
            if isinstance(n, Call) and isinstance(n.func, Attribute):
                return self.method(n)
            if call_name(n) == "builtins.len" and self.typing.of(n.args[0]).is_array:
                return self.shape_of(n.args[0], 0) if self.prefix_length(n.args[0]) else None
            if isinstance(n, (Name, Subscript)) and (view := self.access_path(n)) is not None:
                base, subscripts = view
                return at(index(name(base), *map(copy, subscripts)) if subscripts else name(base), n) \
                    if hasattr(n, "lineno") else index(name(base), *subscripts) if subscripts else name(base)
            return None
        made = rebuild(node, change)
        if any(isinstance(side, (Tuple, List)) for n in walk(made) if isinstance(n, BinOp) for side in (n.left, n.right)
               if self.typing.of(n.left).is_array or self.typing.of(n.right).is_array):
            self.report.error("S201", "an array meets a tuple or list that is spelled out", node,
                              help="make it an array: np.array([...])")
        self.preceding += self.allocations.function_guards(made, self.loops)
        self.preceding += self.allocations.mask_guards(made) if self.loops else []      # NumPy raises by itself
        return made

    def item(self, value: AST, node: Subscript) -> AST:
        """An item of what is spelled out; a variable picks a number from an array of them."""
        position = constant_index(node)
        items = getattr(value, "elts", [])
        if position is not None and -len(items) <= position < len(items):
            return copy(items[position])
        if items and not self.testing and all(self.typing.of(i).is_number for i in items):
            held = self.held("items", call("numpy.array", List(list(map(copy, items)))), node)
            return index(name(held), self.resolve(node.slice))
        if isinstance(value, List) or any(self.typing.of(i).is_float or self.typing.of(i).is_array for i in items):
            what = "list" if isinstance(value, List) else "tuple"
            self.report.error("S201", f"an item of a {what} that is spelled out is picked by a variable", node,
                              help="make it an array: np.array([...])[k]")
            return const(0.0)
        return _item(value, self.resolve(node.slice))

    def held(self, wished: str, value: AST, node: AST) -> str:
        """The name of an array that is made in front of the statement."""
        kind = self.typing.of(value)
        held = self.typing.declare(self.free.fresh(wished), kind)
        self.preceding += self.allocations.allocate(held, kind, value, node)
        return held

    def prefix_length(self, node: AST) -> int:
        return len((self.access_path(node) or AMBIGUOUS)[1])

    def shape_of(self, node: AST, axis: int) -> AST:
        base, subscripts = self.access_path(node) or ("_", ())
        if not any(isinstance(x, Slice) or is_new(x) or self.typing.of(x).is_array for x in subscripts):
            return index(attribute(name(base), "shape"), const(axis + len(subscripts)))
        size = self.shapes.of(index(name(base), *subscripts))[axis]
        if size is None:
            self.report.error("S201", "the size of a part of an array whose bounds change", node,
                              help="give the bounds names that are bound once")
            return const(0)
        return self.shapes.extent(size)

    def attribute(self, node: Attribute) -> AST | None:
        skip, rank = self.prefix_length(node.value), self.typing.of(node.value).rank
        if node.attr == "ndim":
            return const(rank)
        path, computed = self.access_path(node.value), node.value
        while isinstance(computed, Subscript):
            computed = computed.value
        if path is None and self.testing:
            self.report.error("S201", f"the attribute '{node.attr}' of an array that a condition computes", node,
                              help="give the array a name before")
        if path is None and not isinstance(computed, Name):
            path = self.held("value", self.resolve(node.value), node), ()
        base = name(path[0] if path is not None else "_")
        if node.attr == "size" and skip:
            sizes = [self.shape_of(node.value, k) for k in range(rank)]
            product = sizes[0]
            for size in sizes[1:]:
                product = mult(product, size)
            return product
        if node.attr == "shape" and skip:
            return tuple_of(*(self.shape_of(node.value, k) for k in range(rank)))
        if node.attr in ("shape", "size", "dtype"):
            return attribute(base, node.attr)
        self.report.error("S201", f"the attribute '{node.attr}' of an array", node, help="write a loop")
        return base

    def method(self, node: Call) -> AST | None:
        assert isinstance(node.func, Attribute)
        if node.func.attr == "copy":
            return call("numpy.copy", self.resolve(node.func.value))
        self.report.error("S201", f"the method '{node.func.attr}'", node, help="write it as a loop")
        return const(0.0)


def is_whole_place(place: Subscript) -> bool:
    """Whether a place is all of its array."""
    return all(map(is_whole, indices(place)))


def _item(value: AST, position: AST) -> AST:
    if isinstance(value, Tuple) and isinstance(position, Constant):
        return copy(value.elts[position.value])
    return index(copy(value), position)
