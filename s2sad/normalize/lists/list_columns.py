"""list_columns: a list of tuples is a list for each of their items, which may be of different types.

    todo = [(0, x[0])]                  todo_0 = [0]
    while todo:                         todo_1 = [x[0]]
        row = todo.pop()                while todo_0:
        s += row[1] * y[row[0]]             row_0 = todo_0.pop()
                                            row_1 = todo_1.pop()
                                            s += row_1 * y[row_0]

Requires resolved names, and no comprehensions. All that is put into such a list is a tuple that is spelled out, or a
row of another one, and of what is read of it only items are used; any other list stays one, whose rows have one type.
"""
from __future__ import annotations

from collections.abc import Callable, Collection

from s2sad.normalize.lists.list_statements import appended_list, grown_lists, popped_list
from s2sad.tree import (
    AST, Assert, Assign, BoolOp, Call, Compare, Constant, Expr, FunctionDef, List, Load, Name, Slice, Store, Subscript,
    Tuple, UnaryOp, assign, at, attribute, call_name, children, const, copy, dump, head_copy, index, name, names,
    rebuild, walk, with_body,
)

Fresh = Callable[[str], str]


def list_columns(function: FunctionDef, fresh: Fresh) -> FunctionDef:
    """The function with a list for each item of tuples."""
    while True:
        found = _Rows(function)
        if not found.lists:
            return function
        function = _Columns(found.lists, found.rows, fresh).function(function)


class _Rows:
    """The lists of tuples of a function, and the names of their rows, each with how many items a tuple has."""

    def __init__(self, function: FunctionDef):
        self.nodes = list(walk(function.body))
        self.occurrences: dict[str, list[Name]] = {}
        for n in self.nodes:
            if isinstance(n, Name):
                self.occurrences.setdefault(n.id, []).append(n)
        self.picked = {id(n.value): n.slice.value for n in self.nodes if isinstance(n, Subscript) and isinstance(
            n.slice, Constant) and type(n.slice.value) is int and not isinstance(n.ctx, Store)}
        self.lists = self.widths(grown_lists(function))
        self.rows: dict[str, int] = {}
        before = None
        while before != self.lists:
            before = dict(self.lists)
            self.rows = self.row_names({p.id for p in function.args.args})
            self.lists = {n: w for n, w in self.lists.items() if self.is_read_by_item(n, w)}

    def widths(self, lists: list[str]) -> dict[str, int]:
        """The lists in which tuples are put, spelled out or as rows of other lists."""
        found: dict[str, set[int]] = {n: set() for n in lists}
        sources: dict[str, set[str]] = {}
        for s in self.nodes:
            for listed, item in put_items(s):
                if listed in found and isinstance(item, Name) or item_source(item) in found:
                    sources.setdefault(listed, set()).add(item_source(item) or item.id)
                elif listed in found:
                    found[listed].add(len(item.elts) if isinstance(item, Tuple) else -1)
            if isinstance(s, Assign) and len(s.targets) == 1 and isinstance(s.targets[0], Name) and (
                    source := row_source(s, found)):
                sources.setdefault(s.targets[0].id, set()).add(source)
        while more := {(n, w) for n, several in sources.items() for m in several for w in found.get(m, ())
                       if w not in found.get(n, ())}:
            for n, w in more:
                found.setdefault(n, set()).add(w)
        return {n: w for n in lists if len(found[n]) == 1 and (w := next(iter(found[n]))) > 0}

    def row_names(self, parameters: set[str]) -> dict[str, int]:
        """The names that are rows of such lists and nothing else, of which only items are read."""
        bound: dict[str, set[str]] = {}
        times: dict[str, int] = {}
        for s in self.nodes:
            if isinstance(s, Assign) and len(s.targets) == 1 and isinstance(s.targets[0], Name):
                source = row_source(s, self.lists)
                bound.setdefault(s.targets[0].id, set()).add(source)
                times[s.targets[0].id] = times.get(s.targets[0].id, 0) + 1
        rows = {r: 0 for r, n in times.items() if r not in parameters and n == sum(
            isinstance(m.ctx, Store) for m in self.occurrences[r])}
        before = None
        while before != rows:
            before = dict(rows)
            widths = {**self.lists, **{r: w for r, w in rows.items() if w}}
            rows = {r: max(found) for r in rows if (found := {widths.get(n, 0) for n in bound[r]} | {rows[r]}) and len(
                found - {0}) <= 1 and all(n in self.lists or n in rows for n in bound[r])}
        rows = {r: w for r, w in rows.items() if w}
        while unread := [r for r, w in rows.items() if not self.is_row(r, w, rows)]:
            rows = {r: w for r, w in rows.items() if r not in unread}
        return rows

    def is_row(self, row: str, width: int, rows: dict[str, int]) -> bool:
        """Whether of a name only items and its length are read, but where it becomes another row."""
        moved = {id(s.value) for s in self.nodes if isinstance(s, Assign) and len(s.targets) == 1 and isinstance(
            s.targets[0], Name) and rows.get(s.targets[0].id) == width and isinstance(s.value, Name)}
        moved |= {id(i) for s in self.nodes for listed, i in put_items(s) if self.lists.get(listed) == width}
        moved |= {id(n.args[0]) for n in self.nodes if call_name(n) == "builtins.len"}
        bound = {n for s in self.nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)
                 and s.targets[0].id == row for n in [row_source(s, self.lists)]}
        return all(n in self.lists or n in rows for n in bound) and all(
            isinstance(n.ctx, Store) or id(n) in moved or 0 <= self.picked.get(id(n), -1) < width
            for n in self.occurrences[row])

    def is_read_by_item(self, listed: str, width: int) -> bool:
        """Whether a list is no more than filled, asked for its length and read row by row."""
        allowed = set[int]()
        for n in self.nodes:
            if listed in (appended_list(n), popped_list(n)) and (
                    not isinstance(n, Assign) or isinstance(n.targets[0], Name) and n.targets[0].id in self.rows):
                allowed.add(id(n.value.func.value))
            elif isinstance(n, Assign) and isinstance(n.targets[0], Name) and n.targets[0].id in self.rows and (
                    isinstance(n.value, Subscript)):
                allowed.add(id(n.value.value))
            elif isinstance(n, Assign) and isinstance(n.targets[0], Subscript):
                allowed.add(id(n.targets[0].value))
            elif isinstance(n, Subscript) and 0 <= self.picked.get(id(n), -1) < width:
                allowed.add(id(n.value))
            elif call_name(n) == "builtins.len":
                allowed.add(id(n.args[0]))
            allowed |= {id(t) for t in _truths(getattr(n, "test", None))}
            allowed |= {id(i.value) for found, i in put_items(n) if item_source(i) == listed
                        and self.lists.get(found) == width}
        names_put = [i for s in self.nodes for found, i in put_items(s) if found == listed and isinstance(i, Name)]
        taken = [source for s in self.nodes for found, i in put_items(s) if found == listed and (
            source := item_source(i))]
        return all(self.rows.get(i.id) == width for i in names_put) and all(
            self.lists.get(source) == width for source in taken) and all(
            isinstance(n.ctx, Store) or id(n) in allowed for n in self.occurrences[listed])


def put_items(statement: AST) -> list[tuple[str, AST]]:
    """What a statement puts into lists: into which, and what."""
    if (listed := appended_list(statement)) is not None:
        return [(listed, statement.value.args[0])]
    found: list[tuple[str, AST]] = []
    for target in statement.targets if isinstance(statement, Assign) else ():
        if isinstance(target, Name) and isinstance(statement.value, List):
            found += [(target.id, item) for item in statement.value.elts]
        elif isinstance(target, Subscript) and isinstance(target.value, Name):
            found.append((target.value.id, statement.value))
    return found


def item_source(item: AST) -> str:
    """The name of what an item is picked from, "" of other expressions."""
    base = item.value if isinstance(item, Subscript) and not isinstance(item.slice, Slice) else None
    return base.id if isinstance(base, Name) else ""


def row_source(statement: AST, lists: Collection[str]) -> str:
    """The list, or the row, of which a name is made a row; "" where it is none."""
    value = statement.value
    if isinstance(value, Name):
        return value.id
    base = value.value if isinstance(value, Subscript) else None
    return popped_list(statement) or (base.id if isinstance(base, Name) and base.id in lists else "")


def _truths(test: AST | None) -> list[AST]:
    """The names of a test that are asked whether they are true."""
    if isinstance(test, Name):
        return [test]
    return [n for c in children(test) for n in _truths(c)] if isinstance(test, (BoolOp, UnaryOp)) else []


class _Columns:
    """`names` are the lists and rows with the names of their columns."""

    def __init__(self, widths: dict[str, int], rows: dict[str, int], fresh: Fresh):
        self.fresh, self.lists, self.rows = fresh, widths, rows
        self.names = {n: [fresh(f"{n}_{k}") for k in range(w)] for n, w in {**widths, **rows}.items()}

    def function(self, function: FunctionDef) -> FunctionDef:
        return with_body(function, self.block(function.body))

    def block(self, statements: list[AST]) -> list[AST]:
        return [at(made, s) for s in statements for made in self.statement(s)]

    def statement(self, s: AST) -> list[AST]:
        listed = appended_list(s)
        if listed in self.lists:
            before, items = self.held(s.value.args[0])
            return [*before, *(Expr(Call(attribute(name(n), "append"), [i], [])) for n, i in zip(
                self.names[listed], items))]
        if popped_list(s) in self.lists and isinstance(s, Expr):
            return [Expr(Call(attribute(name(n), "clear"), [], [])) for n in self.names[popped_list(s) or ""]]
        target = s.targets[0] if isinstance(s, Assign) and len(s.targets) == 1 else None
        if isinstance(target, Name) and target.id in self.rows:
            return self.row(s, target.id, row_source(s, self.lists))
        if isinstance(target, Name) and target.id in self.lists:
            rows = [self.held(item) for item in s.value.elts]
            return [*(b for before, _ in rows for b in before), *(
                assign(n, List([items[k] for _, items in rows], Load())) for k, n in enumerate(self.names[target.id]))]
        if isinstance(target, Subscript) and isinstance(target.value, Name) and target.value.id in self.lists:
            before, items = self.held(s.value)
            return [*before, *(assign(index(name(n), self.read(target.slice)), i) for n, i in zip(
                self.names[target.value.id], items))]
        if isinstance(s, Assert) and isinstance(s.test, Compare) and dump(self.read(s.test.left)) == dump(
                s.test.comparators[0]) and self.is_length(s.test.left):
            return []
        new = head_copy(s)
        for field in s._fields:
            inner = getattr(s, field)
            if field in ("body", "orelse"):
                setattr(new, field, self.block(inner))
            elif isinstance(inner, AST):
                setattr(new, field, self.read(inner))
            elif isinstance(inner, list):
                setattr(new, field, [self.read(i) if isinstance(i, AST) else i for i in inner])
        return [new]

    def held(self, item: AST) -> tuple[list[AST], list[AST]]:
        """The items of a tuple, under names where one reads what the list is."""
        before: list[AST] = []
        if isinstance(item, Name):
            return [], [name(n) for n in self.names[item.id]]
        if item_source(item) in self.lists:
            before, place = self.place(item)
            return before, [index(name(n), copy(place)) for n in self.names[item_source(item)]]
        items = [self.read(i) for i in item.elts]
        if any(n in self.lists for n in names(item)):
            held = [self.fresh("item") for _ in items]
            before += [assign(h, i) for h, i in zip(held, items)]
            items: list[AST] = [name(h) for h in held]
        return before, items

    def row(self, s: Assign, row: str, listed: str) -> list[AST]:
        """What binds the items of a row."""
        if isinstance(s.value, Name):
            return [assign(r, name(n)) for r, n in zip(self.names[row], self.names[listed])]
        if popped_list(s) is not None:
            return [assign(r, Call(attribute(name(n), "pop"), [copy(s.value.args[0])], []))
                    for r, n in zip(self.names[row], self.names[listed])]
        before, place = self.place(s.value)
        return [*before, *(assign(r, index(name(n), copy(place))) for r, n in zip(
            self.names[row], self.names[listed]))]

    def place(self, item: Subscript) -> tuple[list[AST], AST]:
        """The place of an item of a list, under a name where a call computes it."""
        place = self.read(item.slice)
        if not any(isinstance(n, Call) for n in walk(place)):
            return [], place
        held = self.fresh("place")
        return [assign(held, place)], name(held)

    def read(self, node: AST) -> AST:
        return rebuild(node, self.change)

    def is_length(self, node: AST) -> bool:
        """Whether an expression is the number of a row's items."""
        return call_name(node) == "builtins.len" and isinstance(node.args[0], Name) and node.args[0].id in self.rows

    def change(self, node: AST) -> AST | None:
        if self.is_length(node):
            return const(self.rows[node.args[0].id])
        if isinstance(node, Subscript) and isinstance(node.slice, Constant) and isinstance(
                node.value, Name) and node.value.id in self.names and node.value.id not in self.lists:
            return at(name(self.names[node.value.id][node.slice.value]), node)
        inner = node.value if isinstance(node, Subscript) else None
        if isinstance(inner, Subscript) and isinstance(inner.value, Name) and inner.value.id in self.lists:
            return at(index(name(self.names[inner.value.id][node.slice.value]), self.read(inner.slice)), node)
        if isinstance(node, Name) and node.id in self.lists:
            return at(name(self.names[node.id][0]), node)
        return None
