"""list_elements: what may lie in a list, in whose place there is one array: what differs from Python's list is refused.

    us = [2.0 * x]                      refused: a row of the array would be filled with 0.5
    us.append(0.5)

    ts.append((u, v))                   refused: the list would hold copies
    u[0] = 0.0
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report
from s2sad.evaluate.effects import fresh_value
from s2sad.infer.list_arrays import MARKS, has_list_arrays
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.normalize.context import NormalContext
from s2sad.normalize.lists.list_contents import (
    HELP, ListContents, Writes, is_shared, is_stored_into_later, memory_with_lists,
)
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Break, Expr, For, FunctionDef, If, IfExp, List, Name, Return, Slice, Subscript,
    Tuple, While, call_name, indices, name, names, rename, stored_names, times_bound, walk,
    walk_statements, with_body,
)

_ALIKE = "give them names of their own, or make an array of each that is like the others"
_NAMED = "give it a name in a statement of its own, or make it an array: np.array([...])"


def copies_in_tuples(function: FunctionDef, context: NormalContext) -> None:
    """Refuses tuples and lists in a list whose arrays are stored into: they are copies here, in Python arrays.

        def f(x, n):
            u = np.zeros(2)
            ts = []
            for k in range(n):
                ts.append([u, x])
            u[0] = x[0]
            return ts[0][0][0]

    refused: a list holds an array that is written, not a copy of it

        def f(x, n):
            ts = []
            for k in range(n):
                ts.append((x, x))
            for k in range(n):
                p, q = ts[k]
                p[0] += q[1]
            return x[0]

    refused: the list 'ts' holds views of an array, or one array several times, and what it holds is written

    Requires structured form and types, and the marks of `growing`, by which such an element differs from an array that
    is made of arrays. Changes nothing.
    """
    typing, program, writes, report = context.typing, context.program, context.written, context.report
    if not has_list_arrays(function):
        return
    contents = ListContents(function, typing, writes)
    shared_items = {id(s): [i for i in _items(s.value) if is_shared(i, typing)
                            and base_name(i) not in contents.made]      # a list of its own has stores of its own
                    for stores in contents.stores.values() for s in stores if _is_row(s.value)}
    if not any(shared_items.values()):
        return
    memory = memory_with_lists(function, program)
    every = [s for stores in contents.stores.values() for s in stores]
    for listed, stores in contents.stores.items():
        for store in stores:
            items = shared_items.get(id(store), [])
            if any(is_stored_into_later(function, store, item, every, memory) for item in items):
                report.error("S201", "a list holds an array that is written, not a copy of it", store, help=HELP)
            elif items and (place := _diverging_store(listed, store, items, contents, typing)) is not None:
                report.error("S201", f"the list {listed!r} holds views of an array, or one array several times, and "
                             "what it holds is written", place, help=HELP)


def _is_row(value: AST) -> bool:
    if isinstance(value, IfExp):
        return _is_row(value.body) or _is_row(value.orelse)
    return isinstance(value, (Tuple, List)) or call_name(value) in MARKS


def _items(value: AST) -> Iterator[AST]:
    """What lies in a row, or in the rows in it."""
    if isinstance(value, IfExp):
        yield from (i for v in (value.body, value.orelse) for i in _items(v))
    elif isinstance(value, (Tuple, List)):
        yield from (i for v in value.elts for i in _items(v))
    elif call_name(value) in MARKS:
        yield from _items(value.args[0])
    else:
        yield value


def _diverging_store(listed: str, store: Assign, items: list[AST], contents: ListContents,
                     typing: Typing) -> AST | None:
    """The first store through the list into an array of a row that another name or row shares in Python."""
    shared = [i for i in items if not _is_unshared(store, i, items, contents)]
    rank = min((typing.of(i).rank for i in shared), default=0)
    own = contents.views_of({listed})
    while more := {n for n, stores in contents.stores.items() if any(
            contents.sources(s.value) & own for s in stores)} - own:
        own |= contents.views_of(more)
    filling = {id(s) for stores in contents.stores.values() for s in stores if not isinstance(s.targets[0], Name)}
    parts = {n for n in own if 0 < contents.typing.table[n].rank <= rank}
    for statement in walk(contents.function.body):
        if not shared or id(statement) in filling or not _stored_arrays(statement, contents) & own:
            continue
        if not _replaces_element(statement, rank, typing) or parts & contents.uses.after[id(statement)]:
            return statement
    return None


def _stored_arrays(statement: AST, contents: ListContents) -> set[str]:
    """The arrays that a statement stores into, through names bound just before in its block as well."""
    found: set[str] = set()
    for n in contents.stored_arrays(statement):
        bound = _binding_before(statement, n, contents)
        found |= {n} if bound is None or n in contents.made else contents.sources(bound.value)
    return found


def _binding_before(statement: AST, identifier: str, contents: ListContents) -> Assign | None:
    """The last statement before one in its block that binds a name; None if that is no plain assignment."""
    block = next(b for b in contents.blocks if any(s is statement for s in b))
    for s in reversed(block[:next(k for k, s in enumerate(block) if s is statement)]):
        if isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id == identifier:
            return s
        if identifier in stored_names(s):
            return None
    return None


def _is_unshared(store: Assign, item: AST, items: list[AST], contents: ListContents) -> bool:
    """Whether an array in a row is made for it and used under no other name."""
    if not isinstance(item, Name) or sum(isinstance(i, Name) and i.id == item.id for i in items) > 1:
        return False
    return contents.is_fresh(store, item.id) and not contents.views_of({item.id}) & contents.uses.after[id(store)]


def _replaces_element(statement: AST, rank: int, typing: Typing) -> bool:
    """Whether a statement puts another array in place of an element of a row, and stores into none."""
    target = statement.targets[0] if isinstance(statement, Assign) else None
    return isinstance(target, Subscript) and typing.of(target).rank >= rank and not any(
        isinstance(i, Slice) or typing.of(i).is_array or getattr(i, "value", None) is Ellipsis for i in indices(target))


def element_types(function: FunctionDef, typing: Typing, writes: Writes, report: Report) -> None:
    """Refuses what is stored into a list and is of another rank or dtype than what else it holds."""
    contents = ListContents(function, typing, writes)
    for listed, stores in contents.stores.items():
        row = typing.of(name(listed))
        if row.rank < 2:
            continue
        kinds = [typing.of(s.value) for s in stores]
        mixed = len({k.dtype for k in kinds if k.is_array}) > 1 and _is_stored_into(listed, contents)
        for store, kind in zip(stores, kinds):
            if kind.is_number or kind.is_array and kind.rank != row.rank - 1:
                report.error("S201", f"the list {listed!r} holds arrays of several numbers of axes", store, help=_ALIKE)
            elif kind.is_array and kind.dtype != row.dtype and (mixed or _is_float32(kind, row)):
                report.error("S201", f"the list {listed!r} holds arrays of several dtypes", store, help=_ALIKE)


def _is_float32(*kinds: Type) -> bool:
    return any(k.dtype == "float32" for k in kinds)


def _is_stored_into(listed: str, contents: ListContents) -> bool:
    """Whether an array that the list holds is stored into, through the list or under a name."""
    own, filling = contents.views_of({listed}), {id(s) for s in contents.stores[listed]}
    return any(id(s) not in filling and contents.stored_arrays(s) & own for s in walk(contents.function.body))


def coalesce_names(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function in which an array that is made under one name and goes on under another one has one name.

        def f(x, n):                        def f(x, n):
            us = []                             us = list(len(range(n)))
            for k in range(n):                  us_count = 0
                w = np.zeros(3)                 for k in range(n):
                w[0] = x[k]                         made = np.zeros(3)
                made = w                            made[0] = x[k]
                us.append(made)                     us[k] = made
            return us[0][0]                         us_count += 1
                                                return us[element(0, len(us))][0]

    Requires structured form, where functions that return arrays are written out; establishes that an array which goes
    into a list is seen to be new where it is. Only where there are lists.
    """
    if not has_list_arrays(function):
        return function
    mentions = Counter(n.id for n in walk(function.body) if isinstance(n, Name))

    def block(body: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in body]
        place = 0
        while place < len(made):
            start = _allocation_of(made, place, mentions)
            if start is None:
                place += 1
                continue
            old, new = made[place].value.id, made[place].targets[0].id
            made[start:place + 1] = [rename(s, {old: new}) for s in made[start:place]]
            mentions[new] += mentions.pop(old) - 2
            place = start
        return made
    return with_body(function, block(function.body))


def _allocation_of(block: list[AST], place: int, mentions: Counter[str]) -> int | None:
    """Where the array that a statement binds to another name is made, if that name may be the only one."""
    rebound = block[place]
    if not isinstance(rebound, Assign) or not isinstance(rebound.targets[0], Name) or not isinstance(
            rebound.value, Name):
        return None
    old, new = rebound.value.id, rebound.targets[0].id
    start = next((k for k in range(place - 1, -1, -1) if times_bound([block[k]], Assign, For)[old]), None)
    if start is None or not isinstance(first := block[start], Assign) or not isinstance(first.targets[0], Name) or not (
            fresh_value(first.value)):
        return None
    found = Counter(n.id for n in walk(block[start:place]) if isinstance(n, Name))
    left = any(isinstance(n, (Break, Return)) for n in walk_statements(block[start:place]))
    alone = found[old] + 1 == mentions[old] and not found[new] and old not in names(first.value)
    return start if alone and not left else None


def unsupported_lists(function: FunctionDef, context: NormalContext) -> None:
    """Refuses a list, or a part of one, that stands inside an expression, where no pass has bound it to a name.

        def f(x):
            ks = [1, 2]
            return x[0] if ks == [1, 2] else x[1]

    refused: a list inside an expression is not supported here

    Requires views resolved; changes nothing. What `verify` would call no normal form is said here at the user's line.
    """
    report = context.report
    for statement in walk(function.body):
        value = _expression_of(statement)
        if value is None:
            continue
        wrong = next((n for n in walk(value) if isinstance(n, List) or isinstance(n, Subscript) and not isinstance(
            n.value, (Name, Attribute, Tuple))), None)
        if wrong is not None:
            place = wrong if getattr(wrong, "lineno", None) else statement
            what = "a list inside an expression" if isinstance(wrong, List) else "a part of what an expression gives"
            report.error("S201", f"{what} is not supported here", place, help=_NAMED)


def _expression_of(statement: AST) -> AST | None:
    if isinstance(statement, (Assign, AugAssign, Expr, Return)):
        return statement.value
    return statement.test if isinstance(statement, (If, While)) else statement.iter if isinstance(
        statement, For) else None
