"""list_iteration: loops and comprehensions through written lists of arrays are written out, element by element.

    W = [a.copy(), b.copy()]            W = [a.copy(), b.copy()]
    g = [2.0 * w for w in W]            g = [2.0 * W[0], 2.0 * W[1]]
    for w, d in zip(W, g):              w, d = W[0], g[0]
        w -= 0.1 * d                    w -= 0.1 * d
                                        w, d = W[1], g[1]
                                        w -= 0.1 * d
    for k in range(1, -1, -1):          s += np.sum(W[1] * W[0])
        s += np.sum(W[k] * W[k - 1])    s += np.sum(W[0] * W[-1])

Requires resolved names, before `lists`. What is left of such lists is picked by written numbers, so that `bundles`
takes them apart: their elements are names, may have different shapes, and may be bound anew. Python reads a list's
element when a loop comes to it, and so is it here. A list that is used in any other way stays what it is.
"""
from __future__ import annotations

from collections.abc import Mapping
from itertools import product

from s2sad.evaluate.completion import BREAK, CONTINUE, completion
from s2sad.evaluate.expressions.hoist import constant_index
from s2sad.evaluate.effects import parameters
from s2sad.evaluate.loops.escaping_lists import ListBindings
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Call, Constant, For, FunctionDef, If, List, ListComp, Name, Return, Slice,
    Starred, Store, Sub, Subscript, Tuple, USub, UnaryOp, While, assign, at, call_name, const, copy, dump, index, name,
    names, rebuild, stored_names, substitute, tuple_of, walk, walk_statements, with_body,
)

_LONGEST, _MOST = 16, 160       # elements of a list, statements of a loop that is written out
_SIZED = ("numpy.zeros", "numpy.ones", "numpy.empty", "numpy.full")
_THROUGH = ("builtins.zip", "builtins.enumerate", "builtins.reversed")


def list_iteration(function: FunctionDef) -> FunctionDef:
    """The function without such loops and comprehensions."""
    new = with_body(function, function.body)
    lengths = _lengths(new)
    if not lengths or not _is_needed(new, lengths):
        return function
    new.body = _Through(new, lengths).block(new.body)
    return new


def _lengths(function: FunctionDef) -> dict[str, int]:
    """The names of such lists, with how many elements each has."""
    bound: dict[str, list[AST]] = {}
    for s in walk_statements(function.body):
        if isinstance(s, Assign) and len(s.targets) == 1 and isinstance(s.targets[0], Name) and isinstance(
                s.value, (List, ListComp)):
            bound.setdefault(s.targets[0].id, []).append(s.value)
    stores = [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    given, known = set(parameters(function)), ListBindings(function)
    found: dict[str, int] = {}
    bound = {n: v for n, v in bound.items() if len(v) == stores.count(n) and n not in given}
    while more := {n: length for n, values in bound.items() if n not in found
                   and (length := _common([_count(v, found) for v in values if not _is_again(v, n)])) is not None}:
        found |= more
    while lost := {n for n in found if not _is_plain(function, n, found) or any(
            _count(v, found) != found[n] for v in bound[n])}:
        found = {n: length for n, length in found.items() if n not in lost}
    arrays = {n for n in found if any(known.is_array(i) or isinstance(i, Name) and i.id in given
                                      for v in bound[n] if isinstance(v, List) for i in v.elts)}
    return found if arrays or any(_is_bound_anew(function, bound[n]) for n in found) else {}


def _is_bound_anew(function: FunctionDef, values: list[AST]) -> bool:
    """Whether one of a list's bindings is a comprehension in a loop or a branch, which no array can stand for."""
    first = {id(s.value) for s in function.body if isinstance(s, Assign)}
    return len(values) > 1 and any(isinstance(v, ListComp) and id(v) not in first for v in values)


def _is_again(value: AST, listed: str) -> bool:
    return isinstance(value, ListComp) and listed in names(value.generators[0].iter)


def _common(lengths: list[int | None]) -> int | None:
    """The length that several have, from 1 on."""
    return lengths[0] if lengths and len(set(lengths)) == 1 and lengths[0] else None


def _count(value: AST, known: dict[str, int]) -> int | None:
    if isinstance(value, List):
        return None if any(isinstance(i, Starred) for i in value.elts) else len(value.elts)
    one = value.generators[0]
    simple = len(value.generators) == 1 and not one.ifs and not isinstance(value.elt, (ListComp, List, Tuple)) and not (
        set(stored_names(value.elt)) & set(stored_names(one.target)))
    items = _items(one.iter, known) if simple else None
    fits = items is not None and all(_pairs(one.target, i) is not None for i in items)
    return len(items) if items is not None and fits else None


def _items(iterable: AST, known: dict[str, int]) -> list[AST] | None:
    """What a loop through such lists goes through, as expressions; None for any other."""
    called, args = call_name(iterable), getattr(iterable, "args", [])
    if isinstance(iterable, Name) and iterable.id in known:
        return [index(name(iterable.id), const(k)) for k in range(known[iterable.id])]
    if called == "builtins.range" and len(args) == 1 and call_name(args[0]) == "builtins.len" and isinstance(
            args[0].args[0], Name) and args[0].args[0].id in known:
        return [const(k) for k in range(known[args[0].args[0].id])]
    if called == "builtins.range" and (numbers := _written_range(iterable)) is not None:
        return list(map(const, numbers))
    if called not in _THROUGH or not args or iterable.keywords or called != "builtins.zip" and len(args) != 1:
        return None
    columns = [list(a.elts) if called == "builtins.zip" and isinstance(a, (List, Tuple)) and all(
        isinstance(i, Constant) for i in a.elts) else _items(a, known) for a in args]
    if any(c is None for c in columns):
        return None
    rows = [c for c in columns if c is not None]
    if all(isinstance(a, (List, Tuple)) for a in args):
        return None
    if called == "builtins.reversed":
        return rows[0][::-1] if not isinstance(args[0], Call) or call_name(args[0]) == "builtins.range" else None
    return [tuple_of(*row) for row in zip(*rows)] if called == "builtins.zip" else [
        tuple_of(const(k), item) for k, item in enumerate(rows[0])]


def _written_range(iterable: AST) -> range | None:
    """The numbers of a short range with written bounds."""
    bounds = [_number(a, {}) for a in iterable.args] if isinstance(iterable, Call) and not iterable.keywords else []
    if not 1 <= len(bounds) <= 3 or None in bounds or bounds[2:] == [0]:
        return None
    made = range(*(b for b in bounds if b is not None))
    return made if 0 < len(made) <= _LONGEST else None


def _number(node: AST, counters: Mapping[str, int]) -> int | None:
    """The integer that a sum or difference of written ones and of counters is; None for anything else."""
    if isinstance(node, Constant):
        return node.value if type(node.value) is int else None
    if isinstance(node, Name):
        return counters.get(node.id)
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = _number(node.operand, counters)
        return None if inner is None else -inner
    if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub)):
        left, right = _number(node.left, counters), _number(node.right, counters)
        return None if left is None or right is None else left + right if isinstance(node.op, Add) else left - right
    return None


def _pairs(target: AST, item: AST) -> list[tuple[str, AST]] | None:
    """The names of a target and what each is bound to."""
    if isinstance(target, Name):
        return [(target.id, item)] if not isinstance(item, Tuple) else None
    if not isinstance(target, (Tuple, List)) or not isinstance(item, Tuple) or len(target.elts) != len(item.elts):
        return None
    found = [_pairs(t, i) for t, i in zip(target.elts, item.elts)]
    return None if None in found else [pair for several in found if several is not None for pair in several]


def _is_written_out(loop: AST, known: dict[str, int]) -> bool:
    items = _items(loop.iter, known) if isinstance(loop, For) else None
    if isinstance(loop, For) and _is_range(loop) and not _picked(loop, known):
        return False
    if items is None or loop.orelse or len(items) > _LONGEST or completion(loop.body) & {BREAK, CONTINUE} or set(
            names(loop.iter)) & set(stored_names([*loop.body, loop.target])):
        return False
    pairs = [_pairs(loop.target, i) for i in items]
    counters = {n for several in pairs for n, i in several or [] if isinstance(i, Constant)}
    size = sum(isinstance(s, (Assign, AugAssign, If, For, While)) for s in walk_statements(loop.body))
    return None not in pairs and not counters & set(stored_names(loop.body)) and len(items) * (size + 1) <= _MOST


def _is_range(loop: For) -> bool:
    return call_name(loop.iter) == "builtins.range" and _written_range(loop.iter) is not None


def _picked(loop: For, known: dict[str, int]) -> set[str]:
    """The lists of which a loop's counter picks elements."""
    return {n.value.id for n in walk(loop.body) if isinstance(n, Subscript) and isinstance(n.value, Name)
            and n.value.id in known and set(names(n.slice)) & set(stored_names(loop.target))}


def _is_plain(function: FunctionDef, listed: str, known: dict[str, int]) -> bool:
    """Whether a list is used by its elements alone, which written numbers pick, and by what is written out."""
    good: set[int] = set()
    counted: dict[str, set[int]] = {}
    for s in walk(function.body):
        if _is_written_out(s, known):
            for n, item in (pair for i in _items(s.iter, known) or [] for pair in _pairs(s.target, i) or []):
                if isinstance(item, Constant):
                    counted.setdefault(n, set()).add(item.value)
    for node in walk(function.body):
        if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id == listed:
            position = constant_index(node)
            if position is not None and -known[listed] <= position < known[listed] or position is None and _is_inside(
                    node.slice, known[listed], counted):
                good.add(id(node.value))
        elif isinstance(node, For) and _is_written_out(node, known) or isinstance(node, ListComp) and _count(
                node, known) is not None:
            through = node.iter if isinstance(node, For) else node.generators[0].iter
            good |= {id(n) for n in walk(through)}
        elif call_name(node) == "builtins.len" or isinstance(node, Return) or _is_unpacked(node, known[listed]):
            good |= {id(n) for n in (node.args if isinstance(node, Call) else [node.value])}
    return all(id(n) in good or isinstance(n.ctx, Store) for n in walk(function.body)
               if isinstance(n, Name) and n.id == listed)


def _is_inside(place: AST, length: int, counted: Mapping[str, set[int]]) -> bool:
    """Whether a place is made of counters and is in a list in all their rounds."""
    given = names(place)
    if not given or not all(n in counted for n in given):
        return False
    places = [_number(place, dict(zip(given, values))) for values in product(*(sorted(counted[n]) for n in given))]
    return all(p is not None and -length <= p < length for p in places)


def _is_unpacked(node: AST, count: int) -> bool:
    """Whether a statement binds a name to each of so many elements."""
    return isinstance(node, Assign) and len(node.targets) == 1 and isinstance(node.targets[0], Tuple) and len(
        node.targets[0].elts) == count and all(isinstance(t, Name) for t in node.targets[0].elts)


def _of_sizes(value: AST) -> bool:
    """Whether the arrays of a written list may have several sizes, as its text shows: parts of arrays, or allocations
    of sizes that are spelled differently."""
    items = value.elts if isinstance(value, List) else []
    sizes = {dump(i.args[0]) for i in items if call_name(i) in _SIZED and isinstance(i, Call) and i.args}
    return len(sizes) > 1 or any(isinstance(n, Slice) for i in items for n in walk(i))


def _is_needed(function: FunctionDef, known: dict[str, int]) -> bool:
    """Whether some list is made of others, or bound anew in part while a loop goes through it."""
    parted = {s.targets[0].id for s in walk_statements(function.body) if isinstance(s, Assign) and isinstance(
        s.targets[0], Name) and _of_sizes(s.value)}

    def stored(loop: For) -> bool:
        return any(isinstance(n, Subscript) and isinstance(n.ctx, Store) and isinstance(n.value, Name)
                   and n.value.id in known for n in walk(loop.body))
    return any(isinstance(s, Assign) and isinstance(s.value, ListComp) and isinstance(s.targets[0], Name)
               and s.targets[0].id in known or isinstance(s, For) and _is_written_out(s, known) and (
                   stored(s) or _is_range(s) and any(map(parted.__contains__, _picked(s, known))))
               for s in walk_statements(function.body))


class _Through:
    def __init__(self, function: FunctionDef, known: dict[str, int]):
        self.known = known
        self.used = [n.id for n in walk(function.body) if isinstance(n, Name)]

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, For) and _is_written_out(statement, self.known):
            return [made for item in _items(statement.iter, self.known) or [] for made in self.round(statement, item)]
        new = rebuild(statement, self.spelled)
        for field in ("body", "orelse"):
            if isinstance(inner := getattr(statement, field, None), list):
                setattr(new, field, self.block(inner))
        return [new]

    def round(self, loop: For, item: AST) -> list[AST]:
        """One turn of a loop."""
        pairs = _pairs(loop.target, item) or []
        counters = {n: i for n, i in pairs if isinstance(i, Constant)}
        inside = [n.id for n in walk(loop) if isinstance(n, Name)]
        made: list[AST] = [assign(n, i) for n, i in pairs if n not in counters or self.used.count(n) > inside.count(n)]
        return [at(s, loop) for s in made] + self.block([
            rebuild(substitute(copy(s), counters), self.placed) for s in loop.body])

    def placed(self, node: AST) -> AST | None:
        """An element of a list by a number that is written."""
        own = isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in self.known
        number = _number(node.slice, {}) if own and isinstance(node, Subscript) else None
        return None if number is None or not isinstance(node, Subscript) else at(
            Subscript(node.value, const(number % self.known[node.value.id]), node.ctx), node)

    def spelled(self, node: AST) -> AST | None:
        """A comprehension through such lists as the list of its elements."""
        if not isinstance(node, ListComp) or _count(node, self.known) is None:
            return None
        one = node.generators[0]
        rows = [dict(_pairs(one.target, i) or []) for i in _items(one.iter, self.known) or []]
        return at(List([substitute(copy(node.elt), row) for row in rows], name("_").ctx), node)
