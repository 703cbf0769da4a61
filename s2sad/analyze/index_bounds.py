"""index_bounds: for which sizes and integers a function may ask for an element outside of an array.

    def f(x, y, n):                         in bounds unless one of these holds:
        for i in range(1, n):                   n >= 2 and n > len(x)
            y[i - 1] = x[i] - x[i - 1]          n >= 2 and n - 1 > len(y)

    def g(x, picked):
        for k in range(len(picked)):        len(picked) >= 1 and max(picked) >= len(x)
            x[picked[k]] = 0.0              len(picked) >= 1 and min(picked) < -len(x)

Requires types and resolved views. Each access claims that its index is out of bounds; `index_systems.py` says for which
arguments that can hold. An index that is no affine form, in none of its cases, may be anything; an element of an array
of integers that nobody writes is between the least and the greatest of all. Negative indices count from the end, as
NumPy's do; slices are never out of bounds.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Set
from dataclasses import replace

from s2sad import rules
from s2sad.infer.argument_parts import GREATEST, LEAST, Part
from s2sad.infer.index_systems import Callee, IndexBounds, IndexSystems, apart
from s2sad.analyze.symbolic_ranges import SymbolicRanges
from s2sad.infer.affine import Affine, at_most, equals
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import ALLOCATIONS, bare_shapes
from s2sad.infer.signatures.laws import Shape
from s2sad.infer.path_conditions import CallSite
from s2sad.tree import (
    AST, And, Assert, Assign, Attribute, BinOp, BoolOp, Call, Compare, Constant, Eq, For, FunctionDef, If, IfExp, Name,
    Return, Slice, Subscript, While, attribute, call, call_name, children, const, dump, index, indices, name, names,
    stored_names, times_bound, user_call, walk_statements,
)

_SYSTEMS = 200          # of one function
# whose operands guards have looked at
_CHECKING = frozenset({"numpy.dot", "numpy.matmul", "numpy.outer", "runtime.stacked_matmul"})
_UNKNOWN = IndexBounds(frozenset({()}), {})


def index_bounds(function: FunctionDef, typing: Typing, callee: Callee, written: Set[str]) -> IndexBounds:
    """The bounds of a function, which stores into the arrays `written`; `callee` gives those of what a call calls, None
    where nothing is known."""
    if not is_searchable(function, typing):
        return _UNKNOWN
    return IndexSearch(function, typing, callee, written).found()


def is_searchable(function: FunctionDef, typing: Typing) -> bool:
    """Whether a size, or a counter, is never another one later."""
    parameters = {p.id for p in function.args.args}
    bound = Counter(parameters) + times_bound(function.body, Assign, For)
    return parameters <= typing.table.keys() and not any(
        typing.table[n].is_array and times > 1 for n, times in bound.items()) and not any(
        s.target.id in stored_names(s.body) for s in walk_statements(function.body) if isinstance(s, For))


class IndexSearch:
    """Goes through a function, and collects what it asks for."""

    def __init__(self, function: FunctionDef, typing: Typing, callee: Callee, written: Set[str] | None = None):
        self.function, self.typing = function, typing
        stored = Counter(p.id for p in function.args.args) + times_bound(function.body)
        again = {n for n, times in stored.items() if times > 1}
        self.shapes = bare_shapes(function, typing)
        self.extremes = {} if written is None else {p.id: _extremes(p.id) for p in function.args.args if typing.table[
            p.id].is_array and typing.table[p.id].holds_integers and p.id not in written}
        self.systems = IndexSystems(self.shapes, _symbols(function, typing, again) | {
            symbol: (place, part) for place, p in enumerate(function.args.args) if p.id in self.extremes
            for symbol, part in zip(self.extremes[p.id], (LEAST, GREATEST))}, callee)
        counters = {s.target.id for s in walk_statements(function.body) if isinstance(s, For)}
        self.several = frozenset(n for n in again - counters if typing.table[n].dtype == "int64")
        self.result: tuple[tuple[Affine, tuple[Affine, ...]], ...] = ()
        self.looking = False

    def found(self) -> IndexBounds:
        loops = frozenset(dump(s.target) for s in walk_statements(self.function.body) if isinstance(s, For))
        for self.looking in (False, True):      # what names are bound to is known before anything is asked
            self.block(self.function.body, CallSite(self.shapes, loops, extremes=self.extremes))
        found = self.systems.weakest()
        if () in found or len(found) > _SYSTEMS:
            return _UNKNOWN
        if sum(isinstance(s, Return) for s in walk_statements(self.function.body)) != 1:
            self.result = ()
        return IndexBounds(found, self.systems.parameters, self.result)

    def block(self, statements: list[AST], here: CallSite) -> None:
        for statement in statements:
            if () in self.systems.found:
                return
            here = self.statement(statement, here)

    def statement(self, statement: AST, here: CallSite) -> CallSite:
        """Looks at a statement; the place behind it."""
        if isinstance(statement, For):
            self.expression(statement.iter, here)
            self.block(statement.body, here.within(statement))
        elif isinstance(statement, While):
            self.expression(statement.test, here)
            self.block(statement.body, here)
        elif isinstance(statement, If):
            self.expression(statement.test, here)
            branches = [(statement.body, here.where(statement.test, True)),
                        (statement.orelse, here.where(statement.test, False))]
            for body, place in branches:
                self.block(body, place)
        else:
            self.expression(statement, here)
            last = statement is self.function.body[-1] and isinstance(statement, Return)
            if last and self.looking and statement.value is not None:
                self.result = self.systems.result(self.index(statement.value, here), here)
            if isinstance(statement, Assert):
                return self.asserted(statement.test, here)
            self.bind(statement, here)
            here = self.sized(statement, here)
            if all(n in here.bound or self.shapes.values.get(n) is None for n in names(statement)):
                return replace(here, bound=here.bound | set(stored_names(statement)))
        return here

    def bind(self, statement: AST, here: CallSite) -> None:
        """Notes what a statement binds of the integers that are bound several times."""
        if self.looking:
            return
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and user_call(statement.value) and target.id not in self.several:
            self.systems.calls[dump(target)] = target.id, statement.value
        for name_ in self.several.intersection(stored_names(statement)):
            form = here.size(statement.value) if isinstance(target, Name) else None
            self.systems.bindings.setdefault(dump(name(name_)), []).extend((form, places) for places in apart(here))

    def sized(self, statement: AST, here: CallSite) -> CallSite:
        """The place behind a statement that makes an array: its sizes are known."""
        if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
            return here
        target, value, called = statement.targets[0].id, statement.value, call_name(statement.value)
        if not self.typing.table[target].is_array or called is None or called.startswith("user."):
            return here
        if called in ("numpy.empty", "numpy.zeros"):
            shape = tuple(map(here.size, self.shapes.size_nodes(value.args[0]) or []))
        elif called in ALLOCATIONS:
            shape = self.shapes.of(value.args[0]) if isinstance(value.args[0], Name) else ()
        elif rules.find_array(called) is not None:      # of slices a form may be negative, where the size is 0
            shape = tuple(d if d is not None and here.is_place(d) else None for d in self.shapes.of(value))
        else:
            return here
        own = tuple(self.shapes.own_symbol(target, k) for k in range(self.typing.table[target].rank))
        for symbol, form in zip(own, shape):
            if form is not None and self.never_changes(form, here):
                self.shapes.equal[symbol.terms[0][0]] = form
        return self.equal(own, tuple(d and self.shapes.reduced(d) for d in shape), here)

    def never_changes(self, form: Affine | None, here: CallSite) -> bool:
        """Whether a form is made of what the function is given alone."""
        def stays(symbol: str) -> bool:
            atom = self.shapes.atoms.get(symbol)
            parts = atom.args if isinstance(atom, Call) else [atom.left, atom.right] if isinstance(atom, BinOp) else []
            return symbol in self.systems.parameters or bool(parts) and all(
                self.never_changes(here.size(part), here) for part in parts)
        return form is not None and all(stays(s) for s, _ in form.terms)

    def asserted(self, test: AST, here: CallSite) -> CallSite:
        """The place behind an assertion, which may be that two shapes are equal."""
        sides = [test.left, test.comparators[0]] if isinstance(test, Compare) and isinstance(test.ops[0], Eq) else []
        if sides and all(isinstance(s, Attribute) and s.attr == "shape" and isinstance(s.value, Name) for s in sides):
            return self.equal(self.shapes.of(sides[0].value), self.shapes.of(sides[1].value), here)
        return here.where(test, True)

    def equal(self, one: Shape, other: Shape, here: CallSite) -> CallSite:
        """The place where two shapes are equal."""
        known = [equals(a, b) for a, b in zip(one, other) if a is not None and b is not None and not any(
            s in self.shapes.transient for s, _ in (*a.terms, *b.terms)) and self.shapes.reduced(a) != b]
        return replace(here, places=(*here.places, *(f for both in known for f in both)))

    def expression(self, node: AST, here: CallSite) -> None:
        """Looks at what is computed, where a choice computes it."""
        if not self.looking:
            return
        if isinstance(node, Subscript) and self.typing.of(node.value).is_array:
            self.access(node, here)
        elif isinstance(node, Call):
            self.call(node, here)
        for part, place in _parts(node, here):
            self.expression(part, place)

    # -- what is asked for -------------------------------------------------------------------------------------------

    def access(self, node: Subscript, here: CallSite) -> None:
        """An access to elements or regions of an array."""
        if not isinstance(node.value, Name):
            self.systems.collect(here)
            return
        shape = self.shapes.of(node.value)
        for axis, subscript in enumerate(indices(node)):
            if isinstance(subscript, Slice):
                continue
            form, extent = self.index(subscript, here), shape[axis] if axis < len(shape) else None
            if extent is not None and self.are_products(subscript, form, extent) and SymbolicRanges(here).is_below(
                    subscript, extent):
                continue
            if form is None or extent is None:
                self.systems.collect(here)
                continue
            self.systems.collect(here, at_most(extent, form))
            self.systems.collect(here, at_most(form.plus(extent).shift(1), Affine()))

    def are_products(self, node: AST, *forms: Affine | None) -> bool:
        """Whether an integer is no affine form, or one of some forms has symbols for what is none."""
        if None in forms:
            return isinstance(node, BinOp) and self.typing.of(node).is_integer
        return any(isinstance(self.shapes.atoms.get(s), BinOp) for form in forms if form for s, _ in form.terms)

    def index(self, node: AST, here: CallSite) -> Affine | None:
        """The form of an integer, any one of an array of them; None for an ellipsis, a new axis."""
        if isinstance(node, Constant) and type(node.value) is not int:
            return None
        kind = self.typing.of(node)
        if kind.is_array:
            return here.any_element(node)
        return replace(here, several=self.several).size(node) if kind.is_integer and kind.dtype != "bool" else None

    def call(self, node: Call, here: CallSite) -> None:
        """A call: of a kernel's function, with what it is given; of another one, that must look after itself."""
        bounds = self.systems.callee(node) if user_call(node) else None
        if bounds is not None:
            given = self.systems.arguments(node, bounds, here)
            for system in bounds.systems:
                self.systems.collect(here, *(form.replaced(given) for form in system))
        elif user_call(node) or not _is_harmless(node, self.typing):
            self.systems.collect(here)


def _parts(node: AST, here: CallSite) -> Iterator[tuple[AST, CallSite]]:
    """The parts of an expression, each with its place."""
    if isinstance(node, IfExp):
        yield node.test, here
        yield node.body, here.where(node.test, True)
        yield node.orelse, here.where(node.test, False)
    elif isinstance(node, BoolOp):
        for value in node.values:
            yield value, here
            here = here.where(value, isinstance(node.op, And))
    else:
        for part in children(node):
            yield part, here


def _extremes(array: str) -> tuple[str, str]:
    """The symbols of the least and the greatest element of an array."""
    return dump(call("builtins.min", name(array))), dump(call("builtins.max", name(array)))


def _symbols(function: FunctionDef, typing: Typing, again: set[str]) -> dict[str, tuple[int, Part]]:
    """The symbols of the sizes and integers of a function's parameters, but for those that are bound again."""
    found: dict[str, tuple[int, Part]] = {}
    for place, parameter in enumerate(function.args.args):
        kind = typing.table[parameter.id]
        if kind.is_array:
            found |= {dump(index(attribute(name(parameter.id), "shape"), const(k))): (place, k)
                      for k in range(kind.rank)}
        elif kind.dtype == "int64" and parameter.id not in again:
            found[dump(name(parameter.id))] = place, None
    return found


def _is_harmless(node: Call, typing: Typing) -> bool:
    """Whether a function of a library asks for no element that its arguments do not have: it takes numbers, or one
    array and no integers beside it."""
    given = [*node.args, *(k.value for k in node.keywords)]
    kinds = [typing.of(a) for a in given if not isinstance(a, Constant)]
    arrays, called = [kind for kind in kinds if kind.is_array], call_name(node)
    if called is None or called.startswith("given."):
        return False
    if not arrays or called in _CHECKING or called in ALLOCATIONS:
        return True
    return len(arrays) == len(kinds) == 1
