"""blocked_products: matrix-vector products of a loop's iterations become one matrix product for a block of iterations.

    def f(a: float64[:, :], x: float64[:, :], n):
        s = 0.0
        for i in range(n):
            s += np.sum(np.sin(a @ x[i]))
        return s

in its adjoint:

    def f_adjoint(...):
        ...
        for i in range(n - 1, -1, -1):
            matmul_value[...] = np.matmul(a, x[i])
            matmul_value_bar[...] += np.cos(matmul_value) * s_bar
            a_bar[...] += np.outer(matmul_value_bar, x[i])
            x_bar[i] += np.matmul(np.transpose(a), matmul_value_bar)
            matmul_value_bar[...] = 0.0

becomes

    def f_adjoint(...):
        ...
        for last in range(n, 0, -64):
            first = max(last - 64, 0)
            matmul_value_rows = np.matmul(x[first:last], np.transpose(a))
            for i in range(last - 1, first - 1, -1):
                matmul_value[...] = matmul_value_rows[i - first]
                matmul_value_bar[...] += np.cos(matmul_value) * s_bar
                a_bar_column_kept[i - first] = matmul_value_bar
                a_bar_row_kept[i - first] = x[i]
                matmul_value_bar_kept[i - first] = matmul_value_bar
                matmul_value_bar[...] = 0.0
            a_bar_gain = np.matmul(np.transpose(a_bar_column_kept[:last - first]), a_bar_row_kept[:last - first])
            a_bar[...] += a_bar_gain
            x_bar[first:last] += np.matmul(matmul_value_bar_kept[:last - first], a)

*Requires* finished text, in which inner loops may be whole-array statements. *Establishes* the same values up to
rounding. Strip mining: a matrix product reaches the arithmetic peak where matrix-vector products wait for memory, and
the length of a block bounds the buffers. A product that both sweeps compute stays, so that both have the same digits.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import integer_literal
from s2sad.optimize.loop_bounds import bound_names, counted_loop, stored_elements
from s2sad.optimize.rank_one_update import RankOneUpdate, added_row, rank_one_update
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Break, Call, For, FunctionDef, Name, Return, Slice, Store, Subscript,
    add, assign, at, attribute, augment, call, call_name, children, const, copy, counted_for, dump, index, indices,
    name, names, rebuild, sub, tuple_of, user_call, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = True

_BLOCK = 64


def blocked_products(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such loops in blocks."""
    types = context.types
    if not any(call_name(n) == "numpy.matmul" for n in walk(function.body)):
        return function
    text = NameCounts(function, types)

    def block(statements: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in statements:
            inner = with_blocks(statement, block)
            made += BlockedLoop(inner, text).loops() if _has_products(inner) else [inner]
        return made
    return with_body(function, block(function.body))


def _has_products(loop: AST) -> bool:
    """Whether a statement is a counted loop, left nowhere, whose body stores or binds products."""
    return isinstance(loop, For) and counted_loop(loop) is not None and any(
        isinstance(s, (Assign, AugAssign)) and any(map(_is_matmul, walk(s.value))) for s in loop.body) and not any(
        isinstance(n, (Break, Return)) for n in walk_statements(loop.body))


def _is_matmul(node: AST) -> bool:
    return call_name(node) == "numpy.matmul"


class NameCounts:
    """How often a function mentions and binds each name, and how often each product occurs in it."""

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


class BlockedLoop:
    """One loop: the statements before, in and after the iterations of a block, and the allocations of its buffers."""

    def __init__(self, loop: AST, text: NameCounts):
        bounds = counted_loop(loop)
        assert isinstance(loop, For) and bounds is not None
        self.loop, self.bounds, self.text = loop, bounds, text
        self.counter = bounds.counter
        self.changed = bound_names(loop.body) | {self.counter}
        given = {n for c in walk(loop.body) if user_call(c) for n in names(c)}
        self.stored = given | {base_name(t) for t in stored_elements(loop.body)}
        self.inside = Counter(n.id for n in walk(loop.body) if isinstance(n, Name))
        self.first, self.last = text.free.fresh("first"), text.free.fresh("last")
        self.row = sub(name(self.counter), name(self.first))
        self.allocations: list[AST] = []
        self.before: list[AST] = []
        self.after: list[AST] = []
        self.deferred_nests: list[AST] = []      # nests that stand behind the block

    def loops(self) -> list[AST]:
        """The loop over blocks behind its allocations, or the loop as it is."""
        body: list[AST] = []
        for position, statement in enumerate(self.loop.body):
            body += [at(s, statement) if s is not statement else s for s in self.statement(statement, position)]
        least = integer_literal(self.bounds.upwards()[0]) if len(self.bounds.upwards()) == 2 else 0
        counts_up = least is not None and least >= 0    # else a row of the block may count from the end
        if not self.before and not self.after or not counts_up or not all(
                map(self.is_invariant, (self.bounds.start, self.bounds.stop))):
            self.text.free.release(self.first, self.last)
            return [self.loop]
        body = [s for s in body if not any(s is m for m in self.deferred_nests)]
        fixed = [s for s in body if isinstance(s, Assert) and self.is_invariant(s.test)]
        rest = [s for s in body if not any(s is f for f in fixed)]
        return [*(at(s, self.loop) for s in self.allocations), self.block_loop(fixed, rest)]

    def block_loop(self, fixed: list[AST], body: list[AST]) -> AST:
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
        """The statements that replace one of the loop's."""
        update = rank_one_update(statement)
        made = self.defer_rank_one_update(update) if update is not None else None
        if made is None and isinstance(statement, (Assign, AugAssign)):
            made = self.hoist_products(statement, position) or self.defer_product(statement, position)
        return made or [statement]

    # -- products ----------------------------------------------------------------------------------------------------

    def hoist_products(self, statement: Assign | AugAssign, position: int) -> list[AST] | None:
        """The statement with each `a @ x[i]` in it read from a product of the whole block, made before it."""
        def change(node: AST) -> AST | None:
            found = self.factors(node)
            source = self.row_source(found[0], position) if found is not None else None
            if found is None or source is None or self.text.calls[dump(node)] != 1:
                return None
            rows = self.text.free.fresh(f"{base_name(_target(statement))}_rows")
            self.before.append(at(assign(rows, call("numpy.matmul", self.block_rows(source), found[1])), statement))
            return index(name(rows), copy(self.row))
        made = len(self.before)
        new = copy(statement)
        new.value = rebuild(statement.value, change)
        return [new] if len(self.before) > made else None

    def factors(self, node: AST) -> tuple[AST, AST] | None:
        """The vector of a product with an invariant matrix, and the matrix by which rows of such vectors are
        multiplied."""
        if not _is_matmul(node) or not isinstance(node, Call):
            return None
        a, b = node.args
        matrix, row = (a, b) if self.text.rank(a) == 2 else (b, a)
        if self.text.rank(matrix) != 2 or self.text.rank(row) != 1 or not self.is_invariant(matrix):
            return None
        return row, copy(matrix) if matrix is b else _transposed(matrix)

    def defer_product(self, statement: Assign | AugAssign, position: int) -> list[AST] | None:
        """The store of the vector into a buffer, where its product is only added to a row: the block is multiplied
        behind it."""
        found, target = self.factors(statement.value), _target(statement)
        if found is None or not isinstance(found[0], Name):
            return None
        if isinstance(target, Name):
            return self.defer_added_product(statement, found[0], found[1], position)
        if not isinstance(target.slice, Name) or target.slice.id != self.counter or not self.is_used_only_in(
                target, statement):
            return None
        kept, part = self.vector_buffer(*found), self.block_rows(base_name(target))
        product = call("numpy.matmul", self.filled_rows(kept), found[1])
        self.after.append(at(assign(part, product) if isinstance(statement, Assign)
                             else augment(part, statement.op, product), statement))
        return [assign(index(name(kept), copy(self.row)), found[0])]

    def defer_added_product(self, statement: Assign | AugAssign, vector: Name, right: AST,
                            position: int) -> list[AST] | None:
        """The same where the product has a name, and a loop adds its elements."""
        made = _target(statement).id
        nest = next((s for s in self.loop.body[position + 1:] if made in names(s)), None)
        place = added_row(nest, made, self.counter)
        if place is None or not isinstance(nest, For) or self.text.bound[made] != 1 or self.text.mentions[
                made] != 2 or not self.is_invariant(nest.iter) or not self.is_used_only_in(place, nest):
            return None
        rows, kept = self.text.free.fresh(f"{made}_rows"), self.vector_buffer(vector, right)
        self.deferred_nests.append(nest)
        self.after += [at(assign(rows, call("numpy.matmul", self.filled_rows(kept), right)), statement),
                       at(counted_for(self.counter, [name(self.first), name(self.last)], [
                           self.with_rows(nest, made, rows)]), nest)]
        column = self.text.free.fresh("j")
        return [self.fill_row(kept, column, _row_count(right), index(copy(vector), name(column)))]

    def row_source(self, row: AST, position: int) -> str | None:
        """The matrix whose row of this iteration a vector is; earlier iterations do not write that row."""
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
        given = any(user_call(c) and matrix in names(c) for c in walk(self.loop.body))
        early = any(base_name(t) == matrix for t in stored_elements(self.loop.body[:position + 1]))
        own = all(dump(indices(t)[0]) == dump(name(self.counter)) for t in stored_elements(self.loop.body)
                  if base_name(t) == matrix)
        return matrix if own and not early and not given else None

    def with_rows(self, nest: AST, vector: str, rows: str) -> AST:
        """The loop that adds a vector, with the rows of the block in its place."""
        def change(node: AST) -> AST | None:
            is_it = isinstance(node, Subscript) and base_name(node) == vector
            return index(name(rows), copy(self.row), *map(copy, indices(node))) if is_it else None
        return rebuild(nest, change)

    def defer_rank_one_update(self, update: RankOneUpdate) -> list[AST] | None:
        """The stores of column and row into buffers; the block's are multiplied behind it."""
        kind = self.text.types.get(update.array)
        target, ends = update.increment.target, update.ends
        places = [n for n in names(indices(target)) if n not in update.counters]
        vectors = [f for f in update.factors if not update.counters and self.text.rank(f) != 1]
        if kind is None or kind.dtype != "float64" or not self.is_used_only_in(target, update.nest) or set(
                places) & (self.changed | self.stored) or not all(map(self.is_invariant, ends)) or vectors or any(
                isinstance(n, Call) for f in update.factors for n in walk(f)):
            return None
        kept = [self.row_buffer(f"{update.array}_{side}", size, "float64")
                for side, size in zip(("column", "row"), update.sizes())]
        product = self.text.free.fresh(f"{update.array}_gain")
        columns, rows = map(self.filled_rows, kept)
        multiplied = assign(product, call("numpy.matmul", call("numpy.transpose", columns), rows))
        self.after += [at(multiplied, update.increment), update.with_matrix(product)]
        if not update.counters:
            return [assign(index(name(k), copy(self.row)), copy(f)) for k, f in zip(kept, update.factors)]
        return [self.fill_row(*made) for made in zip(kept, update.counters, update.sizes(), update.factors)]

    def row_buffer(self, wanted: str, size: AST, dtype: str) -> str:
        """Allocates a buffer with a row for each iteration of a block."""
        kept = self.text.free.fresh(f"{wanted}_kept")
        kind = [] if dtype == "float64" else [name(f"numpy.{dtype}")]
        self.allocations.append(assign(kept, call("numpy.empty", tuple_of(const(_BLOCK), copy(size)), *kind)))
        return kept

    def vector_buffer(self, vector: AST, right: AST) -> str:
        """The same for a vector that is multiplied by a matrix on its right."""
        assert isinstance(vector, Name)
        return self.row_buffer(vector.id, _row_count(right), self.text.types[vector.id].dtype)

    def fill_row(self, kept: str, counter: str, size: AST, value: AST) -> AST:
        """The loop that fills the buffer's row of an iteration."""
        cell = index(name(kept), copy(self.row), name(counter))
        return counted_for(counter, [copy(size)], [assign(cell, copy(value))])

    def block_rows(self, matrix: str) -> AST:
        """The rows of a matrix that belong to the block."""
        return index(name(matrix), Slice(name(self.first), name(self.last), None))

    def filled_rows(self, kept: str) -> AST:
        return index(name(kept), Slice(None, sub(name(self.last), name(self.first)), None))

    def is_invariant(self, node: AST) -> bool:
        """Whether an expression has one value in all iterations; it may read the sizes of arrays that they write."""
        if isinstance(node, Attribute):
            return not self.changed & set(names(node))
        if isinstance(node, Name):
            return node.id not in self.changed | self.stored
        return not user_call(node) and all(map(self.is_invariant, children(node)))

    def is_used_only_in(self, target: Subscript, nest: AST) -> bool:
        """Whether the loop mentions an array in one nest only."""
        array = base_name(target)
        return array not in self.changed and self.inside[array] == sum(
            isinstance(n, Name) and n.id == array for n in walk(nest))


def _transposed(matrix: AST) -> AST:
    return copy(matrix.args[0]) if isinstance(matrix, Call) else call("numpy.transpose", copy(matrix))


def _row_count(matrix: AST) -> AST:
    """The number of rows of a matrix, or of the transpose of one."""
    base, axis = (matrix.args[0], 1) if isinstance(matrix, Call) else (matrix, 0)
    return index(attribute(copy(base), "shape"), const(axis))


def _target(statement: Assign | AugAssign) -> AST:
    return statement.targets[0] if isinstance(statement, Assign) else statement.target


__all__ = ["blocked_products"]
