"""Names that hold several results become one name per result.

    def g(x):
        return np.sin(x), np.cos(x)

is called for both:

    def f(x, y):                        def f(x, y):
        r = g(x)                            r_0, r_1 = g(x)
        y[0] = r[0] * (x, y[1])[1]          y[0] = r_0 * y[1]
        return r                            return r_0, r_1

*Requires* resolved names. *Establishes* that no single name is bound to a function's several results, and that no item
of what is spelled out is picked by a constant. A name is taken apart when every binding is a tuple of one length and
every reading an index, an unpacking or a return; one that is spelled out and used otherwise (`shape = (n, n)`) is
spelled out where it is read; one that comes from a call is refused.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.argument_binding import result_structure, user_call
from s2sad.evaluate.loops.late_reads import late_reads
from s2sad.evaluate.expressions.hoist import constant_index
from s2sad.evaluate.effects import is_writing_call, parameters
from s2sad.evaluate.scope import KernelScope
from s2sad.evaluate.expressions.slice_names import one_by_one
from s2sad.tree import (
    AST, Assign, Call, For, FunctionDef, List, Name, Return, Starred, Store, Subscript, Tuple, assign, at, call_name,
    const, copy, index, indices, name, rebuild, stored_names, tuple_of, walk, walk_statements,
)


def tuple_names(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    function = rebuild(rebuild(function, _picked), lambda node: _with_rows_apart(node, function, scope))
    function.body = apart(function.body)
    lengths = _bundled(function, scope)
    function = late_reads(function, lengths, scope)
    parts = {n: [scope.fresh(f"{n}_{k}") for k in range(count)] for n, count in lengths.items()}
    bound = [(s.targets[0].id, s.value) for s in walk_statements(function.body) if isinstance(s, Assign) and isinstance(
        s.targets[0], Name)]
    listed = set(parts) - {n for n, value in bound if not isinstance(value, List)}
    function = rebuild(function, lambda node: _taken_apart(node, parts, listed)) if parts else function
    return _rows_apart(function, {n for own in parts.values() for n in own}, scope)


def _with_rows_apart(node: AST, function: FunctionDef, scope: KernelScope) -> AST | None:
    """A loop over tuples under one name, of which constants pick the items: `for t in zip(u, v)` with `t[0]` has a name
    for each."""
    if not isinstance(node, For):
        return None
    new = copy(node)
    for field in ("body", "orelse"):
        setattr(new, field, [rebuild(s, lambda n: _with_rows_apart(n, function, scope)) for s in getattr(node, field)])
    word, count = getattr(node.target, "id", ""), _width(node.iter, function)
    if not count or not word or word in parameters(function) or not _is_of_loops(word, function) or _odd_use(
            node, word, count) is not None:
        return new
    parts = {word: [scope.fresh(f"{word}_{k}") for k in range(count)]}
    new.target = at(tuple_of(*(Name(n, Store(), None, None) for n in parts[word])), node.target)
    new.body = [rebuild(s, lambda n: _taken_apart(n, parts, set())) for s in new.body]
    return new


def _is_of_loops(word: str, function: FunctionDef) -> bool:
    """Whether a name stands for what loops go through, each by itself, and for nothing else."""
    loops = [n for n in walk_statements(function.body) if isinstance(n, For) and getattr(n.target, "id", "") == word]
    within = [n for s in loops for n in walk([s.target, *s.body]) if isinstance(n, Name) and n.id == word]
    everywhere = [n for n in walk(function.body) if isinstance(n, Name) and n.id == word]
    return len(within) == len(everywhere) and not any(word in stored_names(s.body) for s in loops)


def _width(iterable: AST, function: FunctionDef) -> int:
    """How many items each of what a loop goes through has, as far as the text shows it, else 0."""
    if call_name(iterable) in ("builtins.zip", "builtins.enumerate"):
        starred = any(isinstance(a, Starred) for a in iterable.args)
        return 0 if starred else 2 if call_name(iterable) == "builtins.enumerate" else len(iterable.args)
    if isinstance(iterable, Name):
        values = [s.value for s in walk_statements(function.body) if isinstance(s, Assign) and any(
            isinstance(t, Name) and t.id == iterable.id for t in s.targets)]
        stores = [n for n in walk(function.body) if isinstance(n, Name) and n.id == iterable.id and isinstance(
            n.ctx, Store)]
        alone = len(values) == len(stores) == 1
        return _width(values[0], function) if alone and isinstance(values[0], (Tuple, List)) else 0
    rows = iterable.elts if isinstance(iterable, (Tuple, List)) else []
    lengths = {len(r.elts) if isinstance(r, Tuple) and not any(isinstance(i, Starred) for i in r.elts) else 0
               for r in rows}
    return lengths.pop() if len(lengths) == 1 else 0


def _rows_apart(function: FunctionDef, new: set[str], scope: KernelScope) -> FunctionDef:
    """The function with names for the items of rows, of which the new names are bound to, that may be arrays."""
    def row(value: AST) -> bool:
        return isinstance(value, (Tuple, List)) and any(
            isinstance(n, Subscript) or isinstance(n, Name) and "." not in n.id or row(n) for n in value.elts)

    def in_tuple(node: AST) -> AST | None:
        several = isinstance(node, Assign) and isinstance(node.targets[0], Tuple) and isinstance(node.value, List)
        return at(assign(copy(node.targets[0]), tuple_of(*node.value.elts)), node) if several and set(stored_names(
            node.targets[0])) <= new and any(map(row, node.value.elts)) else None
    function = rebuild(function, in_tuple)
    function.body = apart(function.body, row)
    held = {s.targets[0].id for s in walk_statements(function.body) if isinstance(s, Assign)
            and isinstance(s.targets[0], Name)
            and s.targets[0].id in new and row(s.value)}
    lengths = {n: count for n, count in _bundled(function, scope).items() if n in held}
    function = late_reads(function, lengths, scope)
    parts = {n: [scope.fresh(f"{n}_{k}") for k in range(count)] for n, count in lengths.items()}
    if not parts:
        return function
    function = rebuild(function, lambda node: _taken_apart(node, parts, set()))
    return _rows_apart(function, {n for own in parts.values() for n in own}, scope)


def apart(block: list[AST], wanted: Callable[[AST], bool] = lambda value: isinstance(value, (List, Tuple))
          ) -> list[AST]:
    """A block in which lists and tuples that are bound at once, `rows, columns = [0, 1], [2, 3]`, are bound one by
    one."""
    made: list[AST] = []
    for statement in block:
        for new in map(copy, one_by_one(statement, wanted)):
            for field in ("body", "orelse"):
                if isinstance(inner := getattr(new, field, None), list):
                    setattr(new, field, apart(inner, wanted))
            made.append(new)
    return made


def _picked(node: AST) -> AST | None:
    """The item of a spelled-out tuple or list that a constant picks, or its length, where nothing is lost with it."""
    counted = node.args[0] if call_name(node) == "builtins.len" and len(node.args) == 1 else None
    if isinstance(counted, (Tuple, List)) and not any(isinstance(n, (Starred, Call)) for n in walk(counted)):
        return at(const(len(counted.elts)), node)
    if not isinstance(node, Subscript) or not isinstance(node.value, (Tuple, List)):
        return None
    items, position = node.value.elts, constant_index(node)
    if position is None or not -len(items) <= position < len(items) or any(
            isinstance(n, Starred) or user_call(n) is not None or isinstance(n, Call) and is_writing_call(n)
            for item in items for n in walk(item)):
        return None
    return rebuild(items[position], _picked)


def _bundled(function: FunctionDef, scope: KernelScope) -> dict[str, int]:
    counts: dict[str, list[int]] = {}
    called: set[str] = set()
    stores: dict[str, int] = {}
    for node in walk(function.body):
        if isinstance(node, Name) and isinstance(node.ctx, Store):
            stores[node.id] = stores.get(node.id, 0) + 1
        if isinstance(node, Assign) and len(node.targets) == 1 and isinstance(node.targets[0], Name):
            count = _length(node.value, scope)
            counts.setdefault(node.targets[0].id, []).append(count)
            if count and user_call(node.value) is not None:
                called.add(node.targets[0].id)
    found = {}
    for n, lengths in counts.items():
        if not any(lengths):
            continue
        bad = _odd_use(function, n, lengths[0])
        regular = len(set(lengths)) == 1 and stores[n] == len(lengths) and n not in parameters(function)
        if regular and (bad is None or n not in called):
            found[n] = lengths[0]
        elif n in called:
            place = bad if bad is not None else function
            scope.refuse(place, f"{n!r} holds several results", help="unpack them where they come: a, b = f(...)")
    return found


def _length(value: AST, scope: KernelScope) -> int:
    """The number of items of a tuple that is spelled out or returned by a call, else 0."""
    if isinstance(value, (Tuple, List)):
        return 0 if any(isinstance(v, Starred) for v in value.elts) else len(value.elts)
    kernel = user_call(value)
    structure = result_structure(kernel, scope.program) if kernel is not None else None
    return len(structure) if structure is not None and len(structure) > 1 else 0


def _odd_use(function: FunctionDef, identifier: str, count: int) -> AST | None:
    """The first reading that is no constant index, no unpacking and no return."""
    regular = {id(node) for parent in walk(function.body) for node in [_read(parent, identifier, count)] if node}
    return next((n for n in walk(function.body) if isinstance(n, Name) and n.id == identifier
                 and not isinstance(n.ctx, Store) and id(n) not in regular), None)


def _read(node: AST, identifier: str, count: int) -> AST | None:
    """The name itself, where the node reads it as a bundle."""
    value = getattr(node, "value", None)
    if not (isinstance(value, Name) and value.id == identifier):
        return None
    if isinstance(node, Subscript):
        position = constant_index(node)
        fits = not isinstance(node.ctx, Store) and position is not None and -count <= position < count
    elif isinstance(node, Assign):
        fits = len(node.targets) == 1 and isinstance(node.targets[0], (Tuple, List))
    else:
        fits = isinstance(node, Return)
    return value if fits else None


def _taken_apart(node: AST, parts: dict[str, list[str]], listed: set[str]) -> AST | None:
    if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in parts:
        position, own = constant_index(node), parts[node.value.id]
        if position is None or not -len(own) <= position < len(own):
            return None
        return at(Name(own[position], node.ctx, None, None), node)      # a target is one: what it overwrites is asked
    if isinstance(node, Subscript) and any(isinstance(i, Name) and i.id in listed for i in indices(node)):
        # a list as a subscript picks several, where a tuple is one subscript for each axis
        picked = [List(list(map(name, parts[i.id])), name("_").ctx) if isinstance(i, Name) and i.id in listed
                  else rebuild(i, lambda n: _taken_apart(n, parts, listed)) for i in indices(node)]
        value = rebuild(node.value, lambda n: _taken_apart(n, parts, listed))
        return at(Subscript(value, index(value, *picked).slice, node.ctx), node)
    if isinstance(node, Assign) and isinstance(node.targets[0], Name) and node.targets[0].id in parts:
        value = rebuild(node.value, lambda n: _taken_apart(n, parts, listed))
        return at(assign(tuple_of(*map(name, parts[node.targets[0].id])), value), node)
    if isinstance(node, Name) and node.id in parts and not isinstance(node.ctx, Store):
        return at(tuple_of(*map(name, parts[node.id])), node)
    return None
