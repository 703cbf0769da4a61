"""scalarize: whole-array statements become loops over their elements, for the engine that compiles loops.

Requires resolved views; establishes that every store and every load is of one element.

    u[...] += dt * du               for i in range(u.shape[0]):
                                        u[i] += dt * du[i]
    t = 0.5 * np.sum(u ** 2)        total = 0.0
                                    for i in range(u.shape[0]):
                                        total += u[i] ** 2
                                    t = 0.5 * total

A sum runs in blocks of one row, so that its error grows with the length of a row and the number of rows.
"""
from __future__ import annotations

from s2sad.analyze.liveness import base_name
from s2sad.infer.infer import Typing
from s2sad.infer.types import INT, Type
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, Constant, For, FunctionDef, If, Name, Subscript, While, add, assign, at,
    attribute, augment, call, call_name, children, const, copy, counted_for, index, indices, name, rebuild,
)

_BLOCK = 128


def scalarize(function: FunctionDef, typing: Typing, free: Names) -> FunctionDef:
    """The function without whole-array statements; the table of `typing` gains the new counters."""
    new = copy(function)
    new.body = _Scalarize(typing, free).block(function.body)
    return new


class _Scalarize:
    def __init__(self, typing: Typing, free: Names):
        self.typing, self.free = typing, free

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) if getattr(s, "lineno", None) else made for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, For):
            return [For(statement.target, statement.iter, self.block(statement.body), [], None)]
        if isinstance(statement, While):
            return [While(statement.test, self.block(statement.body), [])]
        if isinstance(statement, If):
            return [If(statement.test, self.block(statement.body), self.block(statement.orelse))]
        if isinstance(statement, (Assign, AugAssign)):
            return self.store(statement)
        return [statement]

    def store(self, statement: AST) -> list[AST]:
        before: list[AST] = []
        value = statement.value
        if not (call_name(value) or "").startswith("user."):
            value = self.sums(value, before)
        target = statement.targets[0] if isinstance(statement, Assign) else statement.target
        if isinstance(target, Subscript) and (kind := self.typing.of(target)).is_array:
            counters = self.counters(kind.rank)
            place, done = self.element(target, counters), _done(target)
            value = self.held(value, base_name(target), before)
            inner = self.element_of(value, counters)
            made: AST = (assign(place, inner) if isinstance(statement, Assign)
                         else augment(place, statement.op, inner))
            return before + [self.nest(target.value, done, counters, [made])]
        if not before:
            return [statement]
        return before + [assign(target, value) if isinstance(statement, Assign)
                         else augment(target, statement.op, value)]

    def counters(self, rank: int) -> list[str]:
        made = [self.free.fresh(c) for c in ("i", "j", "k", "l", "m", "o")[:rank]]
        self.typing.table.update(dict.fromkeys(made, INT))
        return made

    def nest(self, base: AST, done: int, counters: list[str], body: list[AST]) -> AST:
        for k in range(len(counters) - 1, -1, -1):
            body = [counted_for(counters[k], [index(attribute(copy(base), "shape"), const(done + k))], body)]
        return body[0]

    def element(self, target: AST, counters: list[str]) -> Subscript:
        if isinstance(target, Name):
            return index(target, *map(name, counters))
        assert isinstance(target, Subscript)
        kept = indices(target)[:_done(target)]
        return index(copy(target.value), *map(copy, kept), *map(name, counters))

    def element_of(self, value: AST, counters: list[str]) -> AST:
        def change(n: AST) -> AST | None:
            if isinstance(n, (Name, Subscript)) and (kind := self.typing.of(n)).is_array:
                return self.element(n, counters[len(counters) - kind.rank:])
            if isinstance(n, (Subscript, Attribute)) or call_name(n) == "builtins.len":
                return copy(n)
            return None
        return rebuild(value, change)

    def held(self, value: AST, array: str, before: list[AST]) -> AST:
        """The value with the elements that it reads of the array that is filled taken out before the loop: they are
        what they were before the statement, for all of it."""
        def change(n: AST) -> AST | None:
            if isinstance(n, Subscript) and base_name(n) == array and self.typing.of(n).is_number:
                made = self.free.fresh(f"{array}_held")
                self.typing.table[made] = self.typing.of(n)
                before.append(assign(made, copy(n)))
                return name(made)
            return None
        return rebuild(value, change)

    def sums(self, value: AST, before: list[AST]) -> AST:
        def change(n: AST) -> AST | None:
            if call_name(n) == "numpy.sum":
                return self.sum(self.sums(n.args[0], before), before)
            return None
        return rebuild(value, change)

    def sum(self, operand: AST, before: list[AST]) -> AST:
        model = max(self.arrays(operand), key=lambda n: self.typing.of(n).rank)
        kind = self.typing.of(operand)
        number = Type("number", kind.dtype) if kind.is_float else INT
        total = self.accumulator("total", number, before)
        if isinstance(model, Name) and kind.rank == 1:
            before.extend(self.blocked(model, operand, total, number))
        else:
            before.extend(self.rows(model, operand, total, number))
        return name(total)

    def arrays(self, node: AST) -> list[AST]:
        """The arrays and regions that an expression reads, a region without the array that it is of."""
        if isinstance(node, (Name, Subscript)) and self.typing.of(node).is_array:
            return [node]
        if isinstance(node, (Subscript, Attribute)) or call_name(node) == "builtins.len":
            return []
        return [a for child in children(node) for a in self.arrays(child)]

    def accumulator(self, wanted: str, number: Type, before: list[AST]) -> str:
        made = self.free.fresh(wanted)
        self.typing.table[made] = number
        before.append(assign(made, const(0.0 if number.is_float else 0)))
        return made

    def rows(self, model: AST, operand: AST, total: str, number: Type) -> list[AST]:
        """The last axis summed on its own, then the rows' sums."""
        rank = self.typing.of(model).rank
        counters = self.counters(rank)
        base, done = (model, 0) if isinstance(model, Name) else (model.value, _done(model))
        row: list[AST] = []
        part = self.accumulator("row_total", number, row)
        last = index(attribute(copy(base), "shape"), const(done + rank - 1))
        row.append(counted_for(counters[-1], [last], [augment(part, Add(), self.element_of(operand, counters))]))
        row.append(augment(total, Add(), name(part)))
        return row if rank == 1 else [self.nest(base, done, counters[:-1], row)]

    def blocked(self, model: Name, operand: AST, total: str, number: Type) -> list[AST]:
        """A vector summed in blocks."""
        start, counter = self.free.fresh("start"), self.counters(1)[0]
        self.typing.table[start] = INT
        size = index(attribute(copy(model), "shape"), const(0))
        row: list[AST] = []
        part = self.accumulator("row_total", number, row)
        stop = call("builtins.min", add(name(start), const(_BLOCK)), copy(size))
        row.append(counted_for(counter, [name(start), stop], [
            augment(part, Add(), self.element_of(operand, [counter]))]))
        row.append(augment(total, Add(), name(part)))
        return [counted_for(start, [const(0), size, const(_BLOCK)], row)]


def _done(target: AST) -> int:
    """How many subscripts of a region are given."""
    if isinstance(target, Name):
        return 0
    assert isinstance(target, Subscript)
    return sum(not (isinstance(s, Constant) and s.value is Ellipsis) for s in indices(target))
