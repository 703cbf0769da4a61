"""products: what a loop multiplies with one matrix row by row, it multiplies a block of its iterations at a time.

    for i in range(n):                          for first in range(0, n, 64):
        t = a @ x[i]                                last = min(first + 64, n)
        ...                                         t_rows = x[first:last] @ a.T
        for j in range(m):                          for i in range(first, last):
            for k in range(d):                          t = t_rows[i - first]
                a_bar[j, k] += s[j] * x[i, k]           ...
        y = a.T @ s                                     (s and x[i] are kept: rows of s_kept, x_kept)
        for k in range(d):                          a_bar += s_kept.T @ x_kept
            x_bar[i, k] += y[k]                     x_bar[first:last] += s_kept @ a

Requires finished text, in which the inner loops may be whole-array statements; establishes the same values up to
rounding. A product of matrices does many times more in a second than one of a matrix and a vector, which waits for
memory; blocks bound what is kept. A product that both sweeps compute stays: both must have the same digits.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from s2sad.analyze.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import integer
from s2sad.simplify.bounds import changed, counted, stores
from s2sad.simplify.rank_one import Gain, added_row, rank_one
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Break, Call, For, FunctionDef, Name, Return, Slice, Store, Subscript,
    add, assign, at, attribute, augment, call, call_name, children, const, copy, counted_for, dump, index, indices,
    name, names, rebuild, sub, tuple_of, walk, with_body,
)

CHANGES_ROUNDING = True

_BLOCK = 64


def products(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function with such loops in blocks."""
    if not any(call_name(n) == "numpy.matmul" for n in walk(function.body)):
        return function
    text = Text(function, types)

    def block(statements: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in statements:
            inner = with_blocks(statement, block)
            made += Blocks(inner, text).loops() if _multiplies(inner) else [inner]
        return made
    return with_body(function, block(function.body))


def _multiplies(loop: AST) -> bool:
    """Whether a statement is a loop whose iterations all run and store or bind products."""
    return isinstance(loop, For) and counted(loop) is not None and any(
        isinstance(s, (Assign, AugAssign)) and any(map(_is_product, walk(s.value))) for s in loop.body) and not any(
        isinstance(n, (Break, Return)) for n in walk(loop.body))


def _is_product(node: AST) -> bool:
    return call_name(node) == "numpy.matmul"


class Text:
    """What a function says of its names: how often each is mentioned and bound; how often each product stands in it."""

    def __init__(self, function: FunctionDef, types: Mapping[str, Type]):
        found = [n for n in walk(function.body) if isinstance(n, Name)]
        self.types, self.free = types, Names({n.id for n in found} | set(types))
        self.mentions = Counter(n.id for n in found)
        self.bound = Counter(n.id for n in found if isinstance(n.ctx, Store))
        self.calls = Counter(dump(n) for n in walk(function.body) if call_name(n) == "numpy.matmul")

    def rank(self, node: AST) -> int:
        """The rank of a name, a row of one or the transpose of one; 0 of anything else."""
        if isinstance(node, Subscript):
            single = isinstance(node.slice, Name) and (kind := self.types.get(node.slice.id)) and kind.is_number
            return self.rank(node.value) - 1 if single else 0
        base = node.args[0] if call_name(node) == "numpy.transpose" and len(node.args) == 1 else node
        kind = self.types.get(base.id) if isinstance(base, Name) else None
        return kind.rank if kind is not None and kind.is_float else 0


class Blocks:
    """One loop: what is done before, in and after the iterations of a block, and the allocations of what is kept."""

    def __init__(self, loop: AST, text: Text):
        bounds = counted(loop)
        assert isinstance(loop, For) and bounds is not None
        self.loop, self.bounds, self.text = loop, bounds, text
        self.counter = bounds.counter
        self.changed = changed(loop.body) | {self.counter}
        given = {n for c in walk(loop.body) if (call_name(c) or "").startswith("user.") for n in names(c)}
        self.stored = given | {base_name(t) for t in stores(loop.body)}
        self.inside = Counter(n.id for n in walk(loop.body) if isinstance(n, Name))
        self.first, self.last = text.free.fresh("first"), text.free.fresh("last")
        self.row = sub(name(self.counter), name(self.first))
        self.allocations: list[AST] = []
        self.before: list[AST] = []
        self.after: list[AST] = []
        self.moved: list[AST] = []      # nests that stand behind the block

    def loops(self) -> list[AST]:
        """The loop over blocks with what stands before it, or the loop as it is."""
        body: list[AST] = []
        for position, statement in enumerate(self.loop.body):
            body += [at(s, statement) if s is not statement else s for s in self.statement(statement, position)]
        least = integer(self.bounds.upwards()[0]) if len(self.bounds.upwards()) == 2 else 0
        counts_up = least is not None and least >= 0    # else a row of the block may count from the end
        if not self.before and not self.after or not counts_up or not all(
                map(self.is_fixed, (self.bounds.start, self.bounds.stop))):
            self.text.free.give_back(self.first, self.last)
            return [self.loop]
        body = [s for s in body if not any(s is m for m in self.moved)]
        fixed = [s for s in body if isinstance(s, Assert) and self.is_fixed(s.test)]
        rest = [s for s in body if not any(s is f for f in fixed)]
        return [*(at(s, self.loop) for s in self.allocations), self.around(fixed, rest)]

    def around(self, fixed: list[AST], body: list[AST]) -> AST:
        """The loop over blocks, in the order of the iterations."""
        upwards = self.bounds.upwards()
        least, end = upwards if len(upwards) == 2 else (const(0), upwards[0])
        first, last = name(self.first), name(self.last)
        if self.bounds.step > 0:
            over, bounds = self.first, [least, copy(end), const(_BLOCK)]
            inner: list[AST] = [first, last]
            head = assign(self.last, call("builtins.min", add(first, const(_BLOCK)), end))
        else:
            over, bounds = self.last, [end, copy(least), const(-_BLOCK)]
            inner = [sub(last, const(1)), sub(first, const(1)), const(-1)]
            head = assign(self.first, call("builtins.max", sub(last, const(_BLOCK)), least))
        rows = at(counted_for(self.counter, inner, body), self.loop)
        made = counted_for(over, bounds, [at(head, self.loop), *fixed, *self.before, rows, *self.after])
        return at(made, self.loop)

    def statement(self, statement: AST, position: int) -> list[AST]:
        """What stands for a statement of the loop."""
        gain = rank_one(statement)
        made = self.gained(gain) if gain is not None else None
        if made is None and isinstance(statement, (Assign, AugAssign)):
            made = self.hoisted(statement, position) or self.given(statement, position)
        return made or [statement]

    # -- products ----------------------------------------------------------------------------------------------------

    def hoisted(self, statement: Assign | AugAssign, position: int) -> list[AST] | None:
        """The statement with a row of a product that is made before the block for every `a @ x[i]` in it."""
        def change(node: AST) -> AST | None:
            found = self.factors(node)
            source = self.source(found[0], position) if found is not None else None
            if found is None or source is None or self.text.calls[dump(node)] != 1:
                return None
            rows = self.text.free.fresh(f"{base_name(_target(statement))}_rows")
            self.before.append(at(assign(rows, call("numpy.matmul", self.rows_of(source), found[1])), statement))
            return index(name(rows), copy(self.row))
        made = len(self.before)
        new = copy(statement)
        new.value = rebuild(statement.value, change)
        return [new] if len(self.before) > made else None

    def factors(self, node: AST) -> tuple[AST, AST] | None:
        """The vector of a product with a matrix that stays, and the matrix that rows of vectors are multiplied by."""
        if not _is_product(node) or not isinstance(node, Call):
            return None
        a, b = node.args
        matrix, row = (a, b) if self.text.rank(a) == 2 else (b, a)
        if self.text.rank(matrix) != 2 or self.text.rank(row) != 1 or not self.is_fixed(matrix):
            return None
        return row, copy(matrix) if matrix is b else _transposed(matrix)

    def given(self, statement: Assign | AugAssign, position: int) -> list[AST] | None:
        """What keeps the vector whose product is only added to a row: it is multiplied behind the block."""
        found, target = self.factors(statement.value), _target(statement)
        if found is None or not isinstance(found[0], Name):
            return None
        if isinstance(target, Name):
            return self.in_loop(statement, found[0], found[1], position)
        if not isinstance(target.slice, Name) or target.slice.id != self.counter or not self.is_alone(
                target, statement):
            return None
        kept, part = self.keep_vector(*found), self.rows_of(base_name(target))
        product = call("numpy.matmul", self.filled(kept), found[1])
        self.after.append(at(assign(part, product) if isinstance(statement, Assign)
                             else augment(part, statement.op, product), statement))
        return [assign(index(name(kept), copy(self.row)), found[0])]

    def in_loop(self, statement: Assign | AugAssign, vector: Name, right: AST, position: int) -> list[AST] | None:
        """The same where the product has a name, and a loop adds its elements."""
        made = _target(statement).id
        nest = next((s for s in self.loop.body[position + 1:] if made in names(s)), None)
        place = added_row(nest, made, self.counter)
        if place is None or not isinstance(nest, For) or self.text.bound[made] != 1 or self.text.mentions[
                made] != 2 or not self.is_fixed(nest.iter) or not self.is_alone(place, nest):
            return None
        rows, kept = self.text.free.fresh(f"{made}_rows"), self.keep_vector(vector, right)
        self.moved.append(nest)
        self.after += [at(assign(rows, call("numpy.matmul", self.filled(kept), right)), statement),
                       at(counted_for(self.counter, [name(self.first), name(self.last)], [
                           self.from_rows(nest, made, rows)]), nest)]
        column = self.text.free.fresh("j")
        return [self.into(kept, column, _height(right), index(copy(vector), name(column)))]

    def source(self, row: AST, position: int) -> str | None:
        """The matrix of whose row a vector is made that this iteration multiplies: every iteration before it leaves
        that row as it is."""
        if isinstance(row, Name):
            made = [k for k, s in enumerate(self.loop.body[:position]) if isinstance(s, Assign) and isinstance(
                s.targets[0], Name) and s.targets[0].id == row.id and call_name(s.value) == "numpy.copy"]
            if len(made) != 1 or self.text.bound[row.id] != 1 or row.id in self.stored:
                return None
            position = made[0]
            row = self.loop.body[position].value.args[0]
        if not isinstance(row, Subscript) or not isinstance(row.value, Name) or self.text.rank(
                row) != 1 or dump(row.slice) != dump(name(self.counter)) or row.value.id in self.changed:
            return None
        matrix = row.value.id
        given = any((call_name(c) or "").startswith("user.") and matrix in names(c) for c in walk(self.loop.body))
        early = any(base_name(t) == matrix for t in stores(self.loop.body[:position + 1]))
        own = all(dump(indices(t)[0]) == dump(name(self.counter)) for t in stores(self.loop.body)
                  if base_name(t) == matrix)
        return matrix if own and not early and not given else None

    def from_rows(self, nest: AST, vector: str, rows: str) -> AST:
        """The loop that adds a vector, with the rows in its place."""
        def change(node: AST) -> AST | None:
            is_it = isinstance(node, Subscript) and base_name(node) == vector
            return index(name(rows), copy(self.row), *map(copy, indices(node))) if is_it else None
        return rebuild(nest, change)

    def gained(self, gain: Gain) -> list[AST] | None:
        """What keeps the column and the row of a gain, which are multiplied behind the block."""
        kind = self.text.types.get(gain.array)
        places = [n for n in names(indices(gain.gain.target)) if n not in gain.counters]
        vectors = [f for f in gain.factors if not gain.counters and self.text.rank(f) != 1]
        if kind is None or kind.dtype != "float64" or not self.is_alone(gain.gain.target, gain.nest) or set(
                places) & (self.changed | self.stored) or not all(map(self.is_fixed, gain.ends)) or vectors or any(
                isinstance(n, Call) for f in gain.factors for n in walk(f)):
            return None
        kept = [self.keep(f"{gain.array}_{side}", size, "float64")
                for side, size in zip(("column", "row"), gain.sizes())]
        product = self.text.free.fresh(f"{gain.array}_gain")
        columns, rows = map(self.filled, kept)
        self.after += [at(assign(product, call("numpy.matmul", call("numpy.transpose", columns), rows)), gain.gain),
                       gain.of(product)]
        if not gain.counters:
            return [assign(index(name(k), copy(self.row)), copy(f)) for k, f in zip(kept, gain.factors)]
        return [self.into(*made) for made in zip(kept, gain.counters, gain.sizes(), gain.factors)]

    def keep(self, wanted: str, size: AST, dtype: str) -> str:
        """An array with a row for each iteration of a block."""
        kept = self.text.free.fresh(f"{wanted}_kept")
        kind = [] if dtype == "float64" else [name(f"numpy.{dtype}")]
        self.allocations.append(assign(kept, call("numpy.empty", tuple_of(const(_BLOCK), copy(size)), *kind)))
        return kept

    def keep_vector(self, vector: AST, right: AST) -> str:
        """The same for a vector that a matrix behind it is multiplied with."""
        assert isinstance(vector, Name)
        return self.keep(vector.id, _height(right), self.text.types[vector.id].dtype)

    def into(self, kept: str, counter: str, size: AST, value: AST) -> AST:
        """The loop that fills the row of an iteration."""
        cell = index(name(kept), copy(self.row), name(counter))
        return counted_for(counter, [copy(size)], [assign(cell, copy(value))])

    def rows_of(self, matrix: str) -> AST:
        """The rows of the block."""
        return index(name(matrix), Slice(name(self.first), name(self.last), None))

    def filled(self, kept: str) -> AST:
        return index(name(kept), Slice(None, sub(name(self.last), name(self.first)), None))

    def is_fixed(self, node: AST) -> bool:
        """Whether an expression has one value in all iterations; of what they store into it may read the sizes."""
        if isinstance(node, Attribute):
            return not self.changed & set(names(node))
        if isinstance(node, Name):
            return node.id not in self.changed | self.stored
        return not (call_name(node) or "").startswith("user.") and all(map(self.is_fixed, children(node)))

    def is_alone(self, target: Subscript, nest: AST) -> bool:
        """Whether the loop mentions an array in one nest alone."""
        array = base_name(target)
        return array not in self.changed and self.inside[array] == sum(
            isinstance(n, Name) and n.id == array for n in walk(nest))


def _transposed(matrix: AST) -> AST:
    return copy(matrix.args[0]) if isinstance(matrix, Call) else call("numpy.transpose", copy(matrix))


def _height(matrix: AST) -> AST:
    """How many rows a matrix, or the transpose of one, has."""
    base, axis = (matrix.args[0], 1) if isinstance(matrix, Call) else (matrix, 0)
    return index(attribute(copy(base), "shape"), const(axis))


def _target(statement: Assign | AugAssign) -> AST:
    return statement.targets[0] if isinstance(statement, Assign) else statement.target


__all__ = ["products"]
