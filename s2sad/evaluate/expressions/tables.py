"""tables: rows of written numbers, of which a variable picks some, are an array, or one for each column.

    def f(x, s: int64):                     def f(x, s):
        a = [[0.0, 1.0], [0.5, 0.25]]           a = np.array(((0.0, 1.0), (0.5, 0.25)))
        for j in range(2):                      for j in range(2):
            x[j] = a[s][j] * x[j]                   x[j] = a[s][j] * x[j]

    def f(x, k: int64):                                 def f(x, k):
        q = ((0, 0.5), (3, 0.25))                           q_0, q_1 = np.array((0, 3)), np.array((0.5, 0.25))
        t = x[q[k][0]] ** q[k][1]                           t = x[q_0[k]] ** q_1[k]
        for i, w in q:                                      for i, w in zip(q_0, q_1):
            t += w * x[i]                                       t += w * x[i]
        i, w = q[k]                                         i, w = q_0[k], q_1[k]
        return t + w * x[i]                                 return t + w * x[i]

*Requires* resolved names. *Establishes* that such rows are arrays. A name that is bound more than once, written to, or
used in any other way than by its numbers, the numbers of its rows and its length stays what it is: an array of integers
would cut what is stored in it, and a row is a list. Rows that stand where they are picked from, as those of a module
do, get a name first. An integer that is negative and an exponent is a float: Python's integers have such powers, an
array's have not.
"""
from __future__ import annotations

from collections import Counter

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.expressions.table_columns import column, column_kind, number, rows
from s2sad.evaluate.expressions.hoist import constant_index
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Call, For, FunctionDef, List, Load, Name, Pow, Slice, Starred, Store, Subscript,
    Tuple, assign, at, call, call_name, children, const, copy, dump, index, name, names, rebuild, stored_names,
    tuple_of, walk, walk_statements, with_body,
)

_THROUGH = ("builtins.len", "builtins.enumerate", "builtins.zip", "builtins.reversed")


def tables(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    new = _named(_zipped(function, scope), scope)
    times = Counter(n.id for n in walk(new) if isinstance(n, Name) and isinstance(n.ctx, Store))
    for word in [w for s in walk(new.body) if (w := _bound_by(s)) and times[w] == 1 and rows(s.value)]:
        statement = _binding(new, word)
        width = len(_Table(word, statement, scope).columns) if statement is not None else 0
        if not width:
            continue
        new = _spread(new, word, width, scope)
        statement = _binding(new, word)
        if statement is not None and _is_read_as_table(word, width, new):
            new = _Table(word, statement, scope).made(new)
    return new


def _zipped(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with columns picked in place of rows of a module that are too many to be written out."""
    def is_zipped(node: AST | None) -> bool:
        return call_name(node) == "builtins.zip" and all(
            isinstance(a, Name) for a in getattr(node, "args", []))
    new, several = function, [n.value for n in walk(function.body) if isinstance(n, Subscript) and is_zipped(n.value)]
    for node in {dump(n): n for n in several}.values():
        text, word = dump(node), scope.fresh("table")
        new = rebuild(new, lambda n, text=text, word=word: name(word) if call_name(
            n) == "builtins.zip" and dump(n) == text else None)
        uses = _Uses(word, len(node.args), new)
        if not uses.by_columns:
            scope.refuse(node, f"the columns of rows of {len(node.args)} numbers are picked by a variable",
                         help="make an array of each column")
        new = rebuild(new, _Columns(uses, [a.id for a in node.args]).change)
    return new


def _spread(function: FunctionDef, word: str, width: int, scope: KernelScope) -> FunctionDef:
    """The function with a name for each number of a row that has a name: `row = q[k]` is `row_0, row_1 = q[k]`."""
    parts: dict[str, list[str]] = {}
    for node in walk(function.body):
        row = node.targets[0].id if isinstance(node, Assign) and len(node.targets) == 1 and isinstance(
            node.targets[0], Name) else ""
        if not row or not _is_row(node.value, word) or any(user_call(n) for n in walk(node.value)):
            continue
        picked = {id(n.value) for n in walk(function.body) if isinstance(n, Subscript) and isinstance(
            n.ctx, Load) and (place := constant_index(n)) is not None and -width <= place < width}
        reads = [n for n in walk(function.body) if isinstance(n, Name) and n.id == row and n is not node.targets[0]]
        if reads and all(id(n) in picked for n in reads):
            parts[row] = [scope.fresh(f"{row}_{k}") for k in range(width)]

    def change(node: AST) -> AST | None:
        if isinstance(node, Assign) and isinstance(node.targets[0], Name) and node.targets[0].id in parts:
            return at(assign(tuple_of(*map(name, parts[node.targets[0].id])), node.value), node)
        if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in parts:
            return at(name(parts[node.value.id][constant_index(node) or 0]), node)
        return None
    return rebuild(function, change) if parts else function


def _is_row(node: AST | None, word: str) -> bool:
    return isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id == word and not isinstance(
        node.slice, (Slice, Tuple))


def _bound_by(statement: AST) -> str | None:
    """The name that an assignment to one name binds."""
    target = statement.targets[0] if isinstance(statement, Assign) and len(statement.targets) == 1 else None
    return target.id if isinstance(target, Name) else None


def _binding(function: FunctionDef, word: str) -> Assign | None:
    return next((s for s in walk(function.body) if _bound_by(s) == word), None)


def _named(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with names, bound at its start, for rows that stand where a variable picks from them."""
    made: dict[str, tuple[str, AST]] = {}

    def is_table(node: AST) -> bool:
        found = rows(node)
        return bool(found) and all(number(i, scope.program.constants) is not None for row in found for i in row)
    for node in walk(function.body):
        if isinstance(node, Subscript) and names(node.slice) and is_table(node.value) and dump(node.value) not in made:
            made[dump(node.value)] = scope.fresh("table"), node.value
    if not made:
        return function

    def change(node: AST) -> AST | None:
        picked = node.value if isinstance(node, Subscript) else node.args[0] if call_name(
            node) == "builtins.len" and len(node.args) == 1 else None
        if picked is None or dump(picked) not in made:
            return None
        by = name(made[dump(picked)][0])
        return rebuild(at(call("builtins.len", by) if isinstance(node, Call) else Subscript(
            by, node.slice, node.ctx), node), change)
    changed = [rebuild(s, change) for s in function.body]
    return with_body(function, [*(at(assign(n, copy(t)), t) for n, t in made.values()), *changed])


class _Table:
    """Rows of written numbers under a name; `columns` are its numbers, empty if it is no such table."""

    def __init__(self, word: str, statement: Assign, scope: KernelScope):
        self.word, self.statement, self.scope = word, statement, scope
        self.rows = rows(statement.value)
        values = [[number(i, scope.program.constants) for i in row] for row in self.rows]
        self.columns = [] if any(v is None for row in values for v in row) else [list(c) for c in zip(*values)]

    def made(self, function: FunctionDef) -> FunctionDef:
        """The function with arrays in its place."""
        kinds = [column_kind(c) for c in self.columns]
        uses = _Uses(self.word, len(kinds), function)
        inverted = {k for k, c in enumerate(self.columns) if kinds[k] == "int" and min(c) < 0
                    and uses.is_exponent(k) and not uses.is_index(k)}
        kinds = ["float" if k in inverted else "int" if of == "bool" and uses.is_summand(k) else of
                 for k, of in enumerate(kinds)]
        mixed = len(set(kinds)) > 1
        if "" not in kinds and (mixed or inverted or uses.unpacked) and uses.by_columns:
            parts = [self.scope.fresh(f"{self.word}_{k}") for k in range(len(kinds))]
            arrays = [column([row[k] for row in self.rows], kinds[k], self.scope.program.constants)
                      for k in range(len(kinds))]
            return self.bound(function, assign(tuple_of(*map(name, parts)), tuple_of(*arrays)), _Columns(uses, parts))
        if "" in kinds or mixed and "bool" in kinds:
            return function
        if mixed and any(map(uses.is_index, range(len(kinds)))):
            self.scope.refuse(self.statement, f"{self.word!r} holds integers and floats, and a variable picks its "
                              "columns", help="make an array of each column")
        whole = tuple_of(*(column(row, "float" if mixed else kinds[0], self.scope.program.constants).args[0]
                           for row in self.rows))
        return self.bound(function, assign(self.word, call("numpy.array", whole)), _Columns(uses, []))

    def bound(self, function: FunctionDef, binding: AST, columns: _Columns) -> FunctionDef:
        return rebuild(function, lambda n: at(binding, n) if n is self.statement else columns.change(n))


class _Uses:
    """How the numbers of a table are read: `by_columns` if every row is unpacked or its number is picked by a constant;
    `unpacked` are the statements that unpack rows."""

    def __init__(self, word: str, width: int, function: FunctionDef):
        self.word, self.width, self.function = word, width, function
        self.unpacked = [s for s in walk(function.body) if _unpacks(s, word, width)]
        whole = [n for n in walk(function.body) if self.is_row(getattr(n, "value", None)) and isinstance(n, Subscript)]
        read = {id(n.value) for n in [*whole, *self.unpacked]} | {
            id(n.args[0]) for n in walk(function.body) if call_name(n) == "builtins.len"}
        self.by_columns = all(self.place(n) is not None for n in whole) and all(
            id(n) in read for n in walk(function.body) if self.is_row(n))

    def is_row(self, node: AST | None) -> bool:
        return _is_row(node, self.word)

    def place(self, node: AST) -> int | None:
        """Which column a number of a row is picked from; None where a variable says it, and for anything else."""
        if not isinstance(node, Subscript) or not self.is_row(node.value):
            return None
        found = constant_index(node)
        return found % self.width if found is not None and -self.width <= found < self.width else None

    def named(self, place: int) -> set[str]:
        """The names that numbers of a column are bound to."""
        targets = [s.targets[0] for s in self.unpacked] + [
            t for s in walk_statements(self.function.body) if isinstance(s, For) and self.word in names(s.iter)
            for t in [s.target, *getattr(s.target, "elts", [])] if isinstance(t, Tuple) and len(t.elts) == self.width]
        return set(stored_names([t.elts[place] for t in targets]))

    def stands(self, place: int, nodes: list[AST]) -> bool:
        """Whether a number of a column is in one of these expressions."""
        words = self.named(place)
        return any(isinstance(n, Name) and n.id in words or isinstance(n, Subscript) and self.is_row(n.value)
                   and self.place(n) in (place, None) for n in walk(nodes))

    def is_exponent(self, place: int) -> bool:
        return self.stands(place, [n.right for n in walk(self.function.body) if isinstance(n, BinOp)
                                   and isinstance(n.op, Pow)])

    def is_summand(self, place: int) -> bool:
        """Whether arithmetic is done with a number: NumPy's bools have a sum that is none of integers."""
        return self.stands(place, [n for n in walk(self.function.body) if isinstance(n, (BinOp, AugAssign))])

    def is_index(self, place: int) -> bool:
        return self.stands(place, [n.slice for n in walk(self.function.body) if isinstance(n, Subscript)])


class _Columns:
    """What is read of a table as it is read of the arrays of its columns, or of one array if there are none."""

    def __init__(self, uses: _Uses, parts: list[str]):
        self.uses, self.parts = uses, parts

    def change(self, node: AST) -> AST | None:
        word, width = self.uses.word, self.uses.width
        if _unpacks(node, word, width):
            place = rebuild(node.value.slice, self.change)
            picked = [self.picked(k, copy(place)) for k in range(width)]
            return at(Assign(node.targets, at(tuple_of(*picked), node.value), None), node)
        if not self.parts:
            return None
        place = self.uses.place(node)
        if place is not None:
            return at(self.picked(place, rebuild(node.value.slice, self.change)), node)
        if call_name(node) == "builtins.len" and len(node.args) == 1 and word in names(node.args[0]):
            length = const(width) if self.uses.is_row(node.args[0]) else call("builtins.len", name(self.parts[0]))
            return at(length, node)
        turned = call_name(node) == "builtins.reversed" and isinstance(node.args[0], Name) and node.args[0].id == word
        if turned or isinstance(node, Name) and node.id == word:
            parts = [call("builtins.reversed", name(p)) if turned else name(p) for p in self.parts]
            return at(call("builtins.zip", *parts), node)
        return None

    def picked(self, column_: int, place: AST) -> AST:
        if self.parts:
            return index(name(self.parts[column_]), place)
        return index(index(name(self.uses.word), place), const(column_))


def _unpacks(node: AST, word: str, width: int) -> bool:
    """Whether a row is unpacked into as many targets."""
    if not isinstance(node, Assign) or len(node.targets) > 1 or not isinstance(node.targets[0], (Tuple, List)):
        return False
    value, targets = node.value, node.targets[0].elts
    return _is_row(value, word) and len(targets) == width and not any(
        isinstance(n, Starred) or user_call(n) is not None for n in walk([*targets, value]))


def _is_read_as_table(word: str, width: int, function: FunctionDef) -> bool:
    """Whether a variable picks numbers or rows, and nothing else is done but going through all of them."""
    parents = {id(c): p for p in walk(function.body) for c in children(p)}
    reads = [n for n in walk(function.body) if isinstance(n, Name) and n.id == word and not isinstance(n.ctx, Store)]
    picked = False
    for read in reads:
        parent = parents.get(id(read))
        if isinstance(parent, Subscript) and _is_stored(parent, parents):
            return False
        if isinstance(parent, Subscript) and parent.value is read and not isinstance(parent.slice, (Slice, Tuple)):
            outer = parents.get(id(parent))
            whole = isinstance(outer, Subscript) and outer.value is parent and not isinstance(outer.slice, Slice)
            if not whole and not _unpacks(outer, word, width) and not _goes_through(outer, parent, parents, 1):
                return False
            picked = picked or bool(names([parent.slice, *([outer.slice] if isinstance(outer, Subscript) else [])]))
        elif not _goes_through(parent, read, parents, 2):
            return False
    return picked


def _is_stored(node: AST, parents: dict[int, AST]) -> bool:
    """Whether an element of a subscript, or what it picks itself, is stored into."""
    while isinstance(outer := parents.get(id(node)), Subscript) and outer.value is node:
        node = outer
    return isinstance(node, Subscript) and isinstance(node.ctx, Store)


def _goes_through(parent: AST | None, node: AST, parents: dict[int, AST], axes: int) -> bool:
    """Whether a length is asked for, or a loop goes through numbers: those of a row, or of the rows one by one."""
    word = call_name(parent)
    if word == "builtins.len":
        return True
    loop = parents.get(id(parent)) if word in _THROUGH else parent
    if not isinstance(loop, For) or loop.iter is not (node if loop is parent else parent):
        return False
    target = loop.target
    if isinstance(parent, Call) and word != "builtins.reversed":
        place = 1 if word == "builtins.enumerate" else parent.args.index(node)
        target = target.elts[place] if isinstance(target, Tuple) and len(target.elts) > place else None
    return isinstance(target, Name if axes == 1 else Tuple)
