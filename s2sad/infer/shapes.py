"""shapes: the sizes of arrays as affine forms over sizes of parameters and numbers bound once.

Requires types; knows of two array expressions whether their shapes are equal, from how arrays are allocated and from
the guards that were put before. A size that is no such form is a symbol of its own.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from s2sad import rules
from s2sad.infer.affine import Affine
from s2sad.infer.requested_shapes import RequestedShapes
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import LAWS, LEAST, ONE, SIZE_ARGUMENTS, Shape, whole_number
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, Compare, Constant, Eq, FloorDiv, For, FunctionDef, GtE, If, Name,
    Store, Subscript, While, attribute, call, call_name, children, const, index, is_known, name, names, stored_names,
    tuple_of, walk, walk_statements,
)

ALLOCATIONS = frozenset({"numpy.empty", "numpy.zeros", "numpy.empty_like", "numpy.zeros_like"})


class Shapes(RequestedShapes):
    """The shapes of one function, as they follow from its allocations and guards."""

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
            return self.region(node)
        rule = rules.find_array(call_name(node))
        if rule is not None:
            arguments = rule.arguments(node)
            made = LAWS[rule.law].shape([self.of(arguments[o]) for o in rule.operands], arguments)
            if "shape" in rule.operands:
                made = self.requested(arguments["shape"], self.of(arguments["x"]))
            elif "norm" in arguments:
                made = self.transformed(rule.law, arguments)
            elif rule.law == "raveled":
                made = self.requested(const(-1), self.of(arguments["x"]))
            elif made is not None and LEAST in made:
                least = self._least(self.of(arguments[rule.operands[0]]))
                made = tuple(least if d == LEAST else d for d in made)
            elif made is not None:
                made = tuple(self.size(arguments[SIZE_ARGUMENTS[d]]) if d in SIZE_ARGUMENTS else d for d in made)
            return made if made is not None else (None,) * self.typing.of(node).rank
        return self.broadcast(self.of(part) for part in children(node) if self.typing.of(part).is_array)

    def transformed(self, law: str, arguments: Mapping[str, AST]) -> Shape:
        """The shape of a transform along an axis, or of the adjoint of one, with the size of its option there."""
        old = self.of(arguments["x" if "x" in arguments else "g"])
        axis, count = (whole_number(arguments["axis"]) or 0) % len(old), arguments.get("size", arguments.get("n"))
        if count is None or isinstance(count, Constant) and count.value is None:
            found = old[axis]
            if law == "signal" and found is not None:
                found = found.times(2).shift(-2)
        else:
            found = self.size(count)
        if law == "half" and found is not None:
            found = self.symbol(BinOp(self.expression(found), FloorDiv(), const(2))).shift(1)
        return (*old[:axis], found, *old[axis + 1:])

    def enter(self, statement: AST) -> None:
        """Goes to a statement: what the guards before it say holds from here on."""
        self.equal = self.scopes.get(id(statement), self.equal)

    def _least(self, sizes: Shape) -> Affine | None:
        if None in sizes:
            return None
        if len(set(sizes)) == 1:
            return sizes[0]
        return self.symbol(call("builtins.min", *(self.expression(d) for d in sizes if d is not None)))

    def allocated(self, array: str, shape: Shape) -> None:
        """Notes the shape in which an array has been allocated; it holds as long as equal sizes are remembered."""
        self.arrays[array] = tuple(d if d is not None and not d.terms else self.own_symbol(array, k)
                                   for k, d in enumerate(shape))
        for own, size in zip(self.arrays[array], shape):
            if own is not None and own.terms and size is not None:
                (symbol, _), = own.terms
                self.equal.pop(symbol, None)
                known = self.reduced(size)
                if len(known.terms) == 1 and known.terms[0][0] in self.transient and known.terms[0][1] == 1:
                    self.equal[known.terms[0][0]] = own.shift(-known.constant)
                elif symbol not in dict(known.terms):
                    self.equal[symbol] = known

    def note_same_shape(self, array: str, other: str) -> None:
        """Notes that an array has the shape of another, wherever it is used."""
        if self.of(name(other)):
            self.arrays[array] = self.arrays[other]

    def note_two_shapes(self, array: str, one: Shape, other: Shape) -> None:
        """An array that has been allocated in one shape or in another."""
        if all(self.are_equal(a, b) for a, b in zip(one, other)):
            self.allocated(array, one)
            return
        self.arrays[array] = tuple(ONE if ONE == a == b else self.own_symbol(array, k)
                                   for k, (a, b) in enumerate(zip(one, other)))
        for own in self.arrays[array]:
            for symbol, _ in own.terms if own is not None else ():
                self.equal.pop(symbol, None)

    def note_statement(self, statement: AST) -> None:
        """Notes what an allocation or a guard says of shapes."""
        if isinstance(statement, Assign) and getattr(statement.targets[0], "id", "") in self.several:
            self.learn_single(statement)
        elif isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
            called, value = call_name(statement.value) or "", statement.value
            target = statement.targets[0].id
            if called in ("numpy.empty_like", "numpy.zeros_like"):
                self.allocated(target, self.of(value.args[0]))
            elif called in ("numpy.empty", "numpy.zeros"):
                found = self.requested(value.args[0]) or (None,) * self.typing.table[target].rank
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

    def forget(self, statement: AST) -> None:
        """Forgets what is equal to sizes of arrays that a statement, or one inside it, may allocate anew."""
        self.forget_sizes(self.several & set(stored_names([statement])) if self.several else ())

    def forget_sizes(self, arrays: Iterable[str]) -> None:
        """Forgets what is equal to sizes of arrays."""
        for array in arrays:
            symbols = {s for k in range(self.typing.table[array].rank) for s, _ in self.own_symbol(array, k).terms}
            self.equal = {s: f for s, f in self.equal.items() if symbols.isdisjoint({s, *(t for t, _ in f.terms)})}

    def learn_single(self, statement: Assign) -> None:
        """Notes the axes of length 1 of an array that is allocated anew in a loop or a branch; all else may change."""
        self.forget(statement)
        called, value, target = call_name(statement.value) or "", statement.value, statement.targets[0].id
        if called in ("numpy.empty_like", "numpy.zeros_like"):
            found: Shape | None = self.of(value.args[0])
        elif called in ("numpy.empty", "numpy.zeros"):
            found = self.requested(value.args[0])
        else:
            return
        known = self.arrays.get(target, found)
        if found is not None and known is not None:
            self.arrays[target] = tuple(ONE if ONE == a == b else self.own_symbol(target, k)
                                        for k, (a, b) in enumerate(zip(found, known)))


def shape_expression(shapes: Shapes, shape: Shape) -> AST:
    """A shape as an expression: a size, or a tuple of them."""
    parts = [shapes.extent(d) for d in shape if d is not None]
    return parts[0] if len(parts) == 1 else tuple_of(*parts)


def shapes_of(function: FunctionDef, typing: Typing) -> Shapes:
    """The shapes of a function with resolved views, as they follow from its allocations and guards."""
    weakened: dict[str, Shape] = {}
    while True:     # a length of 1 that a later allocation ends has been none for those before it in a loop, either
        made = bare_shapes(function, typing)
        made.arrays |= weakened
        _learn_block(made, function.body, True)
        found = {a: made.arrays.get(a, ()) for a in made.several}
        if found.keys() == weakened.keys() and all(_ones(found[a]) == _ones(weakened[a]) for a in found):
            return made
        weakened = found


def _ones(shape: Shape) -> tuple[int, ...]:
    return tuple(k for k, size in enumerate(shape) if size == ONE)


def _learn_block(shapes: Shapes, block: list[AST], top: bool = False) -> None:
    """Learns what statements say; a guard in a branch or a loop holds from there to the end of its block."""
    for statement in block:
        shapes.scopes[id(statement)] = shapes.equal
        if isinstance(statement, (For, While, If)):
            shapes.forget(statement)
            known = shapes.equal
            for inner in (statement.body, statement.orelse):
                _learn_block(shapes, inner)
                shapes.equal = known
        elif isinstance(statement, Assert) or top:
            shapes.equal = dict(shapes.equal)
            shapes.note_statement(statement)
        elif isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
            shapes.learn_single(statement)


def bare_shapes(function: FunctionDef, typing: Typing) -> Shapes:
    """The shapes of a function with resolved views of which nothing has been learnt but its counters."""
    made = Shapes(typing, single_values(function))
    made.guarded = True
    allocations = Counter(s.targets[0].id for s in walk_statements(function.body) if isinstance(s, Assign)
                          and isinstance(s.targets[0], Name) and call_name(s.value) in ALLOCATIONS)
    made.several = frozenset(a for a, count in allocations.items() if count > 1)
    again = made.several & {s.targets[0].id for loop in walk_statements(function.body) if isinstance(loop, (For, While))
                            for s in walk_statements(loop.body) if isinstance(s, Assign) and isinstance(
                                s.targets[0], Name) and call_name(s.value) in ALLOCATIONS} if made.several else ()
    if again:       # the size that a number was bound to may be another one when it is read
        made.values = {n: None if v is not None and again & {*names(v)} else v for n, v in made.values.items()}
    made.counters = counters_of(function, made.values)
    return made


def started_shapes(function: FunctionDef, typing: Typing) -> Shapes:
    """The shapes of which nothing has been learnt but of arrays that several statements allocate, what these share."""
    made = bare_shapes(function, typing)
    if made.several:
        guarded = shapes_of(function, typing)
        made.arrays |= {array: guarded.arrays[array] for array in made.several}
    return made


def least_of(loop: For) -> dict[str, int]:
    """The least value of a loop's counter, if it is a constant."""
    args = loop.iter.args
    low = 0 if len(args) == 1 else whole_number(args[0])
    step = 1 if len(args) < 3 else whole_number(args[2])
    if step is not None and step < 0:
        stop = whole_number(args[1])
        low = None if stop is None else stop + 1
    return {} if low is None or not step else {loop.target.id: low}


def counters_of(function: FunctionDef, values: Mapping[str, AST | None]) -> dict[str, int]:
    """The loop counters bound once, and what is bound once to a counter, with the least that each can be."""
    loops: dict[str, list[dict[str, int]]] = {}
    for loop in walk_statements(function.body):
        if isinstance(loop, For) and loops.get(loop.target.id) != [{}]:
            loops.setdefault(loop.target.id, []).append(least_of(loop))
        elif isinstance(loop, Assign):
            loops |= {n: [{}] for n in stored_names(loop.targets)}
        elif is_known(loop) and isinstance(loop.test.ops[0], GtE):      # of a counter of a loop around the function
            loops[loop.test.left.id] = [{loop.test.left.id: whole_number(loop.test.comparators[0]) or 0}]
    least = {n: min(found[n] for found in each) for n, each in loops.items() if all(each)}
    held = {n: least[v.id] for n, v in values.items() if isinstance(v, Name) and v.id in least}
    return {**{n: low for n, low in least.items() if n in values}, **held}


def single_values(function: FunctionDef) -> dict[str, AST | None]:
    """The names bound once, with what an assignment binds them to, None for parameters and loop counters."""
    found: dict[str, AST | None] = {p.id: None for p in function.args.args}
    twice: set[str] = set()
    for statement in walk_statements(function.body):
        bound: list[tuple[str, AST | None]] = []
        if isinstance(statement, Assign):
            target = statement.targets[0]
            value = statement.value if isinstance(target, Name) else None
            bound = [(n.id, value) for n in walk(target) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        elif isinstance(statement, (For, AugAssign)) and isinstance(statement.target, Name):
            bound = [(statement.target.id, None)]
        twice |= {n for n, _ in bound if n in found}
        found |= dict(bound)
    after_loops = _counters_after_loops(function, found)
    return {n: None if n in after_loops else v for n, v in found.items() if n not in twice}


def _counters_after_loops(function: FunctionDef, values: Mapping[str, AST | None]) -> set[str]:
    """The names that hold a loop's counter after the loop, where it is that of the last iteration."""
    copies = {n: v.id for n, v in values.items() if isinstance(v, Name)}
    loops = [s for s in walk_statements(function.body) if isinstance(s, For) and s.target.id in copies.values()]
    every = Counter(n.id for n in walk(function.body) if isinstance(n, Name)) if loops else Counter()
    found: set[str] = set()
    for loop in loops:
        inside = Counter(n.id for n in walk(loop.body) if isinstance(n, Name))
        bound = set(stored_names(loop.body))
        found |= {n for n, v in copies.items() if v == loop.target.id and n in bound and inside[n] < every[n]}
    return found
