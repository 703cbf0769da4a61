"""allocations: their two normal forms, `np.empty`/`np.zeros` of a shape and of an array's shape, and guards of shapes.

    w = np.ones(n)                  w = np.empty(n)
                                    w[...] = 1.0
    w = np.array([a, b])            w = np.empty(2)
                                    w[0] = a
                                    w[1] = b
    w = 2.0 * u + v                 w = np.empty_like(u)
                                    w[...] = 2.0 * u + v
"""
from __future__ import annotations

from s2sad import rules
from s2sad.diagnostics import Report
from s2sad.infer.affine import Affine
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import FITTING, INNER, ONE, Shape
from s2sad.infer.shapes import Shapes, shape_expression
from s2sad.infer.types import Type
from s2sad.normalize.array_anf import is_function
from s2sad.normalize.shape_guards import mask_fits, shapes_equal, sparse_size_matches, written
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, List, Name, Slice, Subscript, Tuple, assign, attribute, call, call_name,
    children, const, copy, dump, index, indices, name, tuple_of, walk,
)

_FILLS = {"numpy.ones": 1.0, "numpy.ones_like": 1.0}
_SHAPED = {"numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full"}
_LIKE = {"numpy.empty_like", "numpy.zeros_like", "numpy.ones_like", "numpy.full_like"}
_COPIES = {"numpy.copy", "numpy.array", "numpy.asarray", "numpy.ascontiguousarray"}
ALLOCATING = _SHAPED | _LIKE | _COPIES


class Allocations:
    """Makes allocations of one function and remembers which arrays have one shape."""

    def __init__(self, typing: Typing, report: Report, shapes: Shapes):
        self.typing, self.report, self.shapes = typing, report, shapes

    def allocate(self, target: str, kind: Type, value: AST, place: AST) -> list[AST]:
        """The statements that bind `target` to a new array holding `value` (an expression with resolved views)."""
        function = call_name(value)
        args = value.args if isinstance(value, Call) else []
        if function in _SHAPED:
            return self._shaped(target, kind, function, args)
        if function in _LIKE:
            made: list[AST] = [self.empty_like(target, kind, args[0], "zeros" if "zeros" in function else "empty")]
            fill = const(_FILLS[function]) if function in _FILLS else args[1] if function == "numpy.full_like" else None
            return made + ([] if fill is None else [assign(index(name(target), const(...)), fill)])
        if function in _COPIES and isinstance(args[0], (List, Tuple)):
            return self._listed(target, kind, args[0])
        if function in _COPIES:
            value = args[0]
        return self._filled(target, kind, value, place)

    def _filled(self, target: str, kind: Type, value: AST, place: AST) -> list[AST]:
        """An array of the shape of an expression, holding it."""
        shape = self.shapes.of(value)
        if not self.typing.of(value).is_array or None in shape:
            self.report.error("S201", f"an array made by {call_name(value) or 'this expression'}", place,
                              help="allocate it with np.empty and write it in a loop")
            return []
        guards = self.reshape_guards(value) if is_function(value) else self.operands_fit(value, shape)
        model = next((n for n in walk(value) if isinstance(n, Name) and self.typing.of(n) == kind
                      and self.shapes.of(n) == shape), None)
        made = call("numpy.empty_like", model) if model is not None else call(
            "numpy.empty", shape_expression(self.shapes, shape), *dtype_of(kind))
        self.shapes.allocated(target, shape)
        return [*guards, assign(target, made), assign(index(name(target), const(...)), value)]

    def reshape_guards(self, value: AST) -> list[AST]:
        """Guards that the sizes of a reshape are not negative."""
        if call_name(value) != "numpy.reshape":
            return []
        return [written(s) for s in self.shapes.may_be_remainder(value.args[1])]

    def operands_fit(self, value: AST, shape: Shape) -> list[AST]:
        """Guards that the arrays of an elementwise expression have the shape, or length 1."""
        found: list[AST] = []
        parts = [n for n in _outermost(value, self.typing)]
        model = next((p for p in parts if self.shapes.of(p) == shape), None)
        for part in parts:
            found += self.fitting(model, part) if model is not None else self.fits(shape, part)
        return list({dump(m): m for m in found}.values())

    def fitting(self, whole: AST, part: AST) -> list[AST]:
        """Guards that an array expression fits into another one."""
        a, b = self.shapes.of(whole), self.shapes.of(part)
        plain = isinstance(whole, Name) and isinstance(part, Name) and len(a) == len(b)
        unknown = [(x, y) for x, y in zip(a, b) if not self.shapes.are_equal(x, y)] if plain else []
        if plain and len(unknown) == len(a) and all(x is not None and y is not None and ONE not in (x, y)
                                                    for x, y in unknown):
            for x, y in unknown:
                if x is not None and y is not None:
                    self.shapes.unify(x, y)
            return [shapes_equal(attribute(whole, "shape"), attribute(part, "shape"))]
        return self.fits(a, part)

    def fits(self, shape: Shape, part: AST) -> list[AST]:
        made: list[AST] = []
        found = self.shapes.of(part)
        for x, y in zip(shape[len(shape) - len(found):], found):
            if x is None or y is None:
                self.report.error("S201", "the size of this part of an array changes", part,
                                  help="give its bounds names that are bound once")
            elif y != ONE and not self.shapes.are_equal(x, y):
                made.append(shapes_equal(self.shapes.extent(x), self.shapes.extent(y)))
                self.shapes.unify(x, y)
        return made

    def store_guards(self, place: Subscript, value: AST) -> list[AST]:
        """Guards that the arrays of a whole-array statement fit what it stores into."""
        whole = loaded(place)
        made: list[AST] = []
        for part in [value] if is_function(value) else array_operands(value, self.typing):
            if self.typing.of(part).rank > self.typing.of(place).rank:
                self.report.error("S203", f"a {self.typing.of(part)} does not fit into a {self.typing.of(place)}",
                                  place, help="the shapes must be equal, or of length 1 where they differ")
                continue
            made += self.fitting(whole, part)
        return list({dump(m): m for m in made}.values())

    def function_guards(self, node: AST, loops: bool) -> list[AST]:
        """Guards that the arrays in an operand of a function of whole arrays fit each other."""
        functions = [n for n in walk(node) if isinstance(n, Call) and rules.find_array(call_name(n)) is not None]
        operands = [a for n in functions for a in n.args]
        fitting = [guard for n in functions for guard in self.entries_fit(n, loops)]
        return fitting + [guard for o in operands if len({dump(p) for p in array_operands(o, self.typing)}) > 1
                for guard in self.operands_fit(o, self.shapes.of(o))]

    def mask_guards(self, node: AST) -> list[AST]:
        """Guards that arrays of bools are as long as what they pick from: loops go through the one and index the
        other."""
        made: list[AST] = []
        for n in walk(node):
            if not isinstance(n, Subscript) or not self.typing.of(n.value).is_array:
                continue
            sizes, axis = self.shapes.of(n.value), 0
            for s in self.shapes.full(indices(n), len(sizes)):
                kind = None if isinstance(s, (Slice, Constant)) else self.typing.of(s)
                if kind is not None and kind.is_array and kind.dtype == "bool":
                    made += [guard for x, y in zip(sizes[axis:], self.shapes.of(s)) for guard in self.mask_fits(x, y)]
                axis += self.shapes.width(s)
        return made

    def mask_fits(self, x: Affine | None, y: Affine | None) -> list[AST]:
        """The guard that two sizes are equal, if that is not known."""
        if x is None or y is None or self.shapes.are_equal(x, y):
            return []
        guard = mask_fits(self.shapes.extent(x), self.shapes.extent(y))
        self.shapes.unify(x, y)
        return [guard]

    def entries_fit(self, node: Call, loops: bool) -> list[AST]:
        """Guards that the operands of a function fit each other, where its law says how."""
        rule = rules.find_array(call_name(node))
        assert rule is not None
        arguments, made = rule.arguments(node), []
        sparse = "sparse" in rule.law
        for pair in FITTING.get(rule.law, ()) if sparse or loops else ():     # NumPy raises by itself
            first, second = (self.size_along(arguments[p], axis) for p, axis in pair)
            if self.shapes.are_equal(first, second):
                continue
            sizes = [copy(arguments[p]) if size is None else self.shapes.extent(size)
                     for (p, _), size in zip(pair, (first, second))]
            if not any(self.typing.of(w).is_array for w in sizes):
                made.append((sparse_size_matches if sparse else shapes_equal)(sizes[0], sizes[1]))
            if first is not None and second is not None:
                self.shapes.unify(first, second)
        return made

    def size_along(self, node: AST, axis: int) -> Affine | None:
        """The size of an operand along an axis, or a number."""
        rank = self.typing.of(node).rank
        if not rank:
            return self.shapes.size(node)
        return self.shapes.of(node)[-min(rank, 2) if axis == INNER else axis]

    def _shaped(self, target: str, kind: Type, function: str, args: list[AST]) -> list[AST]:
        shape = tuple_of(*args[0].elts) if isinstance(args[0], List) else args[0]
        if isinstance(shape, Tuple) and len(shape.elts) == 1:
            shape = shape.elts[0]
        self.note_shape(target, shape)
        start = "numpy.zeros" if function == "numpy.zeros" else "numpy.empty"
        made: list[AST] = [assign(target, call(start, shape, *dtype_of(kind)))]
        if function in _FILLS or function == "numpy.full":
            fill = const(_FILLS[function]) if function in _FILLS else args[1]
            made.append(assign(index(name(target), const(...)), fill))
        return made

    def note_shape(self, target: str, shape: AST) -> None:
        """Notes the shape that an array is allocated in, where its sizes stay what they are."""
        found = self.shapes.requested(shape)
        if found is not None:
            self.shapes.allocated(target, found)

    def empty_like(self, target: str, kind: Type, model: AST, start: str) -> Assign:
        """`target = np.empty_like(model)`, or by shape where the model is a part or has another dtype."""
        shape = self.shapes.of(model)
        if isinstance(model, Name) and self.typing.of(model).dtype == kind.dtype:
            self.shapes.allocated(target, shape)
            return assign(target, call(f"numpy.{start}_like", model))
        if None in shape:
            self.report.error("S201", "an array in the shape of a part whose bounds change", model,
                              help="give the bounds names that are bound once")
        made = assign(target, call(f"numpy.{start}", shape_expression(self.shapes, shape), *dtype_of(kind)))
        self.shapes.allocated(target, shape)
        return made

    def _listed(self, target: str, kind: Type, value: AST) -> list[AST]:
        entries: list[tuple[list[AST], AST]] = []
        sizes: list[int] = []

        def visit(node: AST, at: list[AST]) -> None:
            if isinstance(node, (List, Tuple)):
                sizes[len(at):len(at) + 1] = [len(node.elts)]
                for k, item in enumerate(node.elts):
                    visit(item, [*at, const(k)])
            else:
                entries.append((at, node))
        visit(value, [])
        shape = const(sizes[0]) if len(sizes) == 1 else tuple_of(*map(const, sizes))
        self.note_shape(target, shape)
        return [assign(target, call("numpy.empty", shape, *dtype_of(kind))),
                *(assign(index(name(target), *at), item) for at, item in entries)]


def array_operands(node: AST, typing: Typing) -> list[AST]:
    """The array references (whole or partly indexed) that an elementwise expression reads, outermost only."""
    if isinstance(node, (Name, Subscript)) and typing.of(node).is_array:
        return [node]
    if isinstance(node, (Attribute, Name, Constant, Subscript)) or isinstance(node, Call) and typing.of(node).is_number:
        return []   # what is asked of a whole array is no matter of its shape
    return [part for child in children(node) for part in array_operands(child, typing)]


def loaded(place: Subscript) -> AST:
    """What a place holds: the array by its name where it is all of it."""
    subscripts = indices(place)
    return name(place.value.id) if is_full(subscripts[0]) and len(subscripts) == 1 else copy(place)


def is_full(node: AST) -> bool:
    """Whether a subscript takes all of an array: `:` or `...`."""
    if isinstance(node, Slice):
        return node.lower is None and node.upper is None and node.step is None
    return isinstance(node, Constant) and node.value is Ellipsis


def _outermost(node: AST, typing: Typing) -> list[AST]:
    """The arrays and parts of arrays that an elementwise expression reads."""
    if isinstance(node, (Name, Subscript)):
        return [node] if typing.of(node).is_array else []
    if isinstance(node, Attribute) or not typing.of(node).is_array:
        return []
    return [part for child in children(node) for part in _outermost(child, typing)]


def dtype_of(kind: Type) -> list[AST]:
    """The argument for the dtype of an allocation, none for float64."""
    return [] if kind.dtype == "float64" else [name(f"numpy.{kind.dtype}" if kind.dtype != "bool" else "numpy.bool_")]
