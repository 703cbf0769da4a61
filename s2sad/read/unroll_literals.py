"""unroll_literals: loops and comprehensions through written functions, and dicts made over written keys, are written
out.

    for f in (np.sin, np.cos):              s += np.sin(x)
        s += f(x)                           s += np.cos(x)
    e = [f(x) for f in (np.sin, np.cos)]    e = [np.sin(x), np.cos(x)]
    p, q = [w * v for w, v in zip((0.1, 0.6), (a, b))]      p, q = [0.1 * a, 0.6 * b]
    g = {k: 2.0 * p[k] for k in p}          g = {"a": 2.0 * p["a"], "b": 2.0 * p["b"]}      p = {"a": ..., "b": ...}

Before the fence is asked, which refuses what is left of them.
"""
from __future__ import annotations

from collections.abc import Collection, Iterable

from s2sad.tree import (
    AST, Assign, Attribute, Break, Call, Constant, Continue, Dict, DictComp, For, FunctionDef, GeneratorExp, List,
    ListComp, Name, Store, Subscript, Tuple, UnaryOp, assign, at, call_name, children, const, copy, rebuild,
    stored_names, substitute, tuple_of, walk, walk_statements,
)

_LONGEST = 16
Pairs = list[tuple[str, AST]]


def unroll_literals(function: FunctionDef) -> FunctionDef:
    """The function without such loops and comprehensions."""
    if not any(isinstance(n, (For, ListComp, GeneratorExp, DictComp)) for n in walk(function.body)):
        return function
    made, new = _UnrollLiterals(function), copy(function)
    new.body = made.block(function.body)
    return new


class _UnrollLiterals:
    def __init__(self, function: FunctionDef):
        self.function = function
        self.stores = [n.id for n in walk(function) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        self.local = [n for c in walk(function) for g in getattr(c, "generators", []) for n in stored_names(g.target)]
        self.keys: dict[str, list[AST]] = {}
        given = {p.id for p in function.args.args}
        for s in walk(function.body):       # in the order of the text: a dict may be made of one before it
            target = s.targets[0] if isinstance(s, Assign) and len(s.targets) == 1 else None
            keys = self.keys_of(s.value) if isinstance(target, Name) else None
            if keys is None or target is None:
                continue
            same = self.keys.setdefault(target.id, keys)
            if [k.value for k in same] != [k.value for k in keys]:
                self.stores.append(target.id)
        bound = [s.targets[0].id for s in walk_statements(function.body) if isinstance(s, Assign) and isinstance(
            s.targets[0], Name) and isinstance(s.value, (Dict, DictComp))]
        self.keys = {n: keys for n, keys in self.keys.items() if bound.count(n) == self.stores.count(n)
                     and n not in given and not self.grows(n, keys)}

    def keys_of(self, value: AST) -> list[AST] | None:
        """The written keys of a dict."""
        if isinstance(value, DictComp):
            rows = self.rows(value)
            return None if rows is None or not isinstance(value.key, Name) else [
                substitute(copy(value.key), dict(row)) for row in rows]
        plain = isinstance(value, Dict) and all(isinstance(k, Constant) for k in value.keys)
        return list(value.keys) if plain else None

    def grows(self, identifier: str, keys: list[AST]) -> bool:
        """Whether an element is stored under another key, or one is removed."""
        known = {k.value for k in keys}
        for n in walk(self.function.body):
            own = isinstance(n, (Subscript, Attribute)) and isinstance(n.value, Name) and n.value.id == identifier
            if own and isinstance(n, Attribute) and n.attr not in ("keys", "items", "values"):
                return True
            if own and isinstance(n, Subscript) and isinstance(n.ctx, Store) and (
                    n.slice.value not in known if isinstance(n.slice, Constant) else not self.is_key(n.slice, known)):
                return True
        return False

    def is_key(self, place: AST, known: set[object]) -> bool:
        """Whether a name is bound by loops through dicts of these keys alone."""
        if not isinstance(place, Name):
            return False
        loops = [s for s in walk_statements(self.function.body) if isinstance(s, For)
                 and place.id in stored_names(s.target)]
        through = [s.iter.func.value if isinstance(s.iter, Call) and isinstance(s.iter.func, Attribute) else s.iter
                   for s in loops]
        return len(loops) == self.stores.count(place.id) - self.local.count(place.id) and all(
            isinstance(t, Name) and {k.value for k in self.keys.get(t.id, [])} == known for t in through)

    def rows(self, made: DictComp) -> list[Pairs] | None:
        """What the names of a dict comprehension are bound to, turn by turn."""
        one = made.generators[0]
        if len(made.generators) > 1 or one.ifs:
            return None
        through, method = one.iter, ""
        if isinstance(through, Call) and isinstance(through.func, Attribute) and not through.args:
            through, method = through.func.value, through.func.attr
        if not isinstance(through, Name) or through.id not in self.keys or method not in ("", "keys", "items"):
            return None
        keys = self.keys[through.id]
        items = [k if method != "items" else tuple_of(k, Subscript(copy(through), k, through.ctx)) for k in keys]
        found = [pairs(one.target, i) for i in items]
        return None if None in found else [row for row in found if row is not None]

    # -- rewriting ---------------------------------------------------------------------------------------------------

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for s in block:
            if isinstance(s, For) and (rounds := self.rounds(s)) is not None:
                made += self.block(rounds)
                continue
            new = rebuild(s, self.spelled)
            for field in ("body", "orelse"):
                if isinstance(inner := getattr(s, field, None), list):
                    setattr(new, field, self.block(inner))
            made.append(new)
        return made

    def rounds(self, loop: For) -> list[AST] | None:
        """The turns of a loop through functions; None for any other loop."""
        rows = self.through_functions(loop.target, loop.iter, loop.body)
        if rows is None or loop.orelse or any(isinstance(n, (Break, Continue)) for n in walk_statements(loop.body)):
            return None
        functions = {n for n, item in rows[0] if n in _called(loop.body)}
        if functions & set(stored_names(loop.body)) or any(_is_used(self.function.body, n) for n in functions):
            return None
        made: list[AST] = []
        for row in rows:
            made += [at(assign(n, copy(item)), loop) for n, item in row if n not in functions]
            made += [substitute(copy(s), {n: item for n, item in row if n in functions}) for s in loop.body]
        return made

    def spelled(self, node: AST) -> AST | None:
        if isinstance(node, DictComp) and (rows := self.rows(node)) is not None:
            both = [(substitute(copy(node.key), dict(r)), substitute(copy(node.value), dict(r))) for r in rows]
            return at(Dict([k for k, _ in both], [rebuild(v, self.spelled) for _, v in both]), node)
        if isinstance(node, Call) and isinstance(node.func, Name) and node.func.id == "sum" and len(
                node.args) == 1 and isinstance(node.args[0], GeneratorExp) and (items := self.items(node.args[0])):
            return at(Call(node.func, [tuple_of(*items)], []), node)
        if isinstance(node, ListComp) and (items := self.items(node) or self.written(node)):
            return at(List([rebuild(i, self.spelled) for i in items], tuple_of().ctx), node)
        return None

    def items(self, node: AST) -> list[AST]:
        """The elements of a comprehension through functions; none of any other."""
        one = node.generators[0]
        plain = len(node.generators) == 1 and not one.ifs
        rows = self.through_functions(one.target, one.iter, [node.elt]) if plain else None
        return [substitute(copy(node.elt), dict(row)) for row in rows or []]

    def written(self, node: ListComp) -> list[AST]:
        """The elements of a comprehension through names and numbers that are written out; none of any other."""
        one = node.generators[0]
        bound = {*self.stores, *(p.id for p in self.function.args.args)}
        items = written_items(one.iter, bound) if len(node.generators) == 1 and not one.ifs else []
        rows = [pairs(one.target, i) for i in items if all(isinstance(n, (Name, Constant)) for n in _leaves(i))]
        if not 0 < len(rows) == len(items) or None in rows:
            return []
        return [substitute(copy(node.elt), dict(row)) for row in rows if row is not None]

    def through_functions(self, target: AST, iterable: AST, body: list[AST]) -> list[Pairs] | None:
        """What the names of a target are bound to, turn by turn, where one of them is called and the others are
        written numbers."""
        if not isinstance(iterable, (Tuple, List)) or not 0 < len(iterable.elts) <= _LONGEST:
            return None
        rows, called = [pairs(target, i) for i in iterable.elts], _called(body)
        if any(row is None or not any(n in called for n, _ in row) or not all(
                self.is_function(item) if n in called else isinstance(item, Constant) for n, item in row)
                for row in rows):
            return None
        return [row for row in rows if row is not None]

    def is_function(self, item: AST) -> bool:
        """Whether an item may be a function by its name, which is bound nowhere here: `f`, `np.sin`."""
        return isinstance(item, Name) and item.id not in self.stores or isinstance(
            item, Attribute) and self.is_function(item.value)


def _is_used(block: list[AST], identifier: str) -> bool:
    """Whether a name is read, but in loops and comprehensions that bind it."""
    for node in block:
        binds = isinstance(node, For) and identifier in stored_names(node.target) or any(
            identifier in stored_names(g.target) for g in getattr(node, "generators", []))
        if isinstance(node, Name) and node.id == identifier or not binds and _is_used(children(node), identifier):
            return True
    return False


def written_items(iterable: AST, bound: Collection[str] = ()) -> list[AST]:
    """What an iterable gives, where that is written out, also through `zip` and `enumerate`, which are not `bound` to
    anything else; nothing of any other."""
    if isinstance(iterable, (Tuple, List)):
        return list(iterable.elts) if len(iterable.elts) <= _LONGEST else []
    called = (call_name(iterable) or "").removeprefix("builtins.")
    if called not in ("zip", "enumerate") or called in bound or iterable.keywords or not iterable.args:
        return []
    through = [written_items(a, bound) for a in iterable.args]
    if called == "zip":
        left = [n for t in through for item in t[min(map(len, through)):] for n in walk(item)]
        calls = any(isinstance(n, Call) for n in left)      # what is left over is evaluated as well
        return [tuple_of(*row) for row in zip(*through)] if all(through) and not calls else []
    return [tuple_of(const(k), i) for k, i in enumerate(through[0])] if len(through) == 1 else []


def _leaves(item: AST) -> list[AST]:
    """What a tuple within tuples holds; the number behind a sign."""
    if isinstance(item, (Tuple, List)):
        return [leaf for i in item.elts for leaf in _leaves(i)]
    return [item.operand if isinstance(item, UnaryOp) and isinstance(item.operand, Constant) else item]


def _called(body: Iterable[AST]) -> set[str]:
    return {n.func.id for s in body for n in walk(s) if isinstance(n, Call) and isinstance(n.func, Name)}


def pairs(target: AST, item: AST) -> Pairs | None:
    """The names of a target and what each is bound to."""
    if isinstance(target, Name):
        return [(target.id, item)]
    if not isinstance(target, (Tuple, List)) or not isinstance(item, (Tuple, List)) or len(target.elts) != len(
            item.elts):
        return None
    found = [pairs(t, i) for t, i in zip(target.elts, item.elts)]
    return None if None in found else [pair for row in found if row is not None for pair in row]
