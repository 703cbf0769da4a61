"""capacity: how long a list can become, as an expression where it is made.

    us = []                             p[0] = p[1]
    p[0] = p[1]                         stop = user.f(p)
    for k in range(user.f(p)):          us = []
        us.append(x[k])                 for k in range(stop):
                                            us.append(x[k])

Requires resolved names. A list that begins empty is made where it is first used (`made_late`), and what a loop that
fills it calls is called once, before it. `Capacity` multiplies the trip counts of the loops around each append;
`IndexIntervals` says between which numbers an index lies, as far as the text shows it:

    k for k in range(1, n): 1 and more          t % 2: 0 to 1          1 - t % 2: 0 to 1
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.effects import Memory
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Add, Assign, BinOp, Constant, For, FunctionDef, If, List, Mod, Name, Store, Sub, USub, UnaryOp, While, assign,
    at, call_name, copy, head_copy, name, walk, walk_statements,
)

Appended = Callable[[AST], str | None]          # the name of the list that a statement appends to


def made_late(tree: FunctionDef, scope: KernelScope, appended: Appended) -> FunctionDef:
    """The function with lists that are made where they are first used."""
    grown = {n for s in walk(tree.body) if (n := appended(s)) is not None}
    new = copy(tree)
    new.body = _block(tree.body, grown, scope, appended) if grown else tree.body
    return new


def _block(block: list[AST], grown: set[str], scope: KernelScope, appended: Appended) -> list[AST]:
    made: list[AST] = []
    waiting: list[Assign] = []
    for statement in block:
        if _starts_empty(statement, grown):
            waiting.append(statement)
            continue
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if hasattr(statement, field):
                setattr(new, field, _block(getattr(statement, field), grown, scope, appended))
        if isinstance(new, For) and any(appended(s) is not None for s in walk(new.body)):
            made += _called_before(new, scope)
        used = {n.id for n in walk(new) if isinstance(n, Name)}
        made += [s for s in waiting if s.targets[0].id in used]
        waiting = [s for s in waiting if s.targets[0].id not in used]
        made.append(new)
    return [*made, *waiting]


def _starts_empty(statement: AST, grown: set[str]) -> bool:
    return isinstance(statement, Assign) and len(statement.targets) == 1 and isinstance(
        statement.targets[0], Name) and statement.targets[0].id in grown and isinstance(
        statement.value, List) and not statement.value.elts


def _called_before(loop: For, scope: KernelScope) -> list[AST]:
    """Names for the bounds of a range that calls of kernels give; the loop goes by the names."""
    calls = any(user_call(n) is not None for n in walk(loop.iter))
    if call_name(loop.iter) != "builtins.range" or not calls:
        return []
    before: list[AST] = []
    roles = ("stop",) if len(loop.iter.args) == 1 else ("start", "stop", "step")
    for position, (bound, role) in enumerate(zip(list(loop.iter.args), roles)):
        if not isinstance(bound, Constant):
            before.append(at(assign(new := scope.fresh(role), bound), loop))
            loop.iter.args[position] = at(name(new), bound)
    return before


def only_after(made: Assign, block: list[AST], appended: Appended) -> bool:
    """Whether all that appends to a list follows in the block in which it is made, so that it is made before."""
    home = next(b for b in _blocks(block) if any(s is made for s in b))
    after = {id(s) for s in _statements(home[home.index(made) + 1:])}
    return all(id(s) in after for s in _statements(block) if appended(s) == made.targets[0].id)


def changed(found: AST, made: Assign, loops: list[AST], body: list[AST], memory: Memory) -> bool:
    """Whether the content that an expression reads may be written between the statement that makes a list and the last
    time that the inner one of the loops around an append, the outermost first, goes by the expression."""
    order = {id(n): k for k, n in enumerate(walk(body))}
    first, last = order[id(made)], order[id(loops[-1])]
    again = {id(n) for n in walk(loops[0].body)} if len(loops) > 1 else set()
    parts = [own_part(s) for s in _statements(body) if first < order[id(s)] < last or id(s) in again or last < first]
    return bool(memory.written([found])) or memory.affected(found, memory.written([*parts, *made.value.elts]))


def _blocks(block: list[AST]) -> list[list[AST]]:
    inner = [getattr(s, field) for s in block for field in ("body", "orelse") if hasattr(s, field)]
    return [block, *(b for i in inner for b in _blocks(i))]


def _statements(block: list[AST]) -> list[AST]:
    return [s for b in _blocks(block) for s in b]


def own_parts(block: list[AST]) -> list[AST]:
    """Every statement below, of those with blocks what is not in a block."""
    return [own_part(s) for s in _statements(block)]


def own_part(statement: AST) -> AST:
    """What of a statement is not in a block of its own."""
    if isinstance(statement, For):
        return statement.iter
    return statement.test if isinstance(statement, (If, While)) else statement


Span = tuple[int | None, int | None]
_DEEPEST = 8


class IndexIntervals:
    """The names of one function and what binds them."""

    def __init__(self, function: FunctionDef):
        self.function = function

    def from_start(self, place: AST) -> bool:
        """Whether a place is never negative."""
        low, _ = self.span(place)
        return low is not None and low >= 0

    def span(self, node: AST, depth: int = 0) -> Span:
        """What an integer is at least, and at most; None where that is not known."""
        if isinstance(node, Constant):
            return (node.value, node.value) if type(node.value) is int else (None, None)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            low, high = self.span(node.operand, depth)
            return None if high is None else -high, None if low is None else -low
        if isinstance(node, Name):
            return self.of_name(node.id, depth)
        if not isinstance(node, BinOp):
            return None, None
        if isinstance(node.op, Mod):
            whole = type(getattr(node.right, "value", None)) is int and node.right.value > 0
            return (0, node.right.value - 1) if whole else (None, None)
        if not isinstance(node.op, (Add, Sub)):
            return None, None
        one, other = self.span(node.left, depth), self.span(node.right, depth)
        other = other if isinstance(node.op, Add) else other[::-1]
        sign = 1 if isinstance(node.op, Add) else -1
        low, high = (None if a is None or b is None else a + sign * b for a, b in zip(one, other))
        return low, high

    def of_name(self, identifier: str, depth: int) -> Span:
        low = self.least(identifier)
        if low is not None or depth > _DEEPEST:
            return low, None
        bound = [s for s in walk_statements(self.function.body) if isinstance(s, Assign) and any(
            isinstance(t, Name) and t.id == identifier for t in s.targets)]
        once = len(bound) == self.stores(identifier) == 1 and len(bound[0].targets) == 1
        return self.span(bound[0].value, depth + 1) if once else (None, None)

    def stores(self, identifier: str) -> int:
        given = any(p.id == identifier for p in self.function.args.args)
        return given + sum(isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store)
                           for n in walk(self.function.body))

    def least(self, identifier: str) -> int | None:
        """The least value of a name that only loops over ranges with written starts bind."""
        loops = [s for s in walk_statements(self.function.body) if isinstance(s, For) and isinstance(s.target, Name)
                 and s.target.id == identifier]
        if not loops or len(loops) != self.stores(identifier):
            return None
        lows = [_low(s.iter) for s in loops]
        return None if None in lows else min(low for low in lows if low is not None)


def _low(iterable: AST) -> int | None:
    args = getattr(iterable, "args", [])
    if call_name(iterable) != "builtins.range" or len(args) == 3:
        return None
    if len(args) == 1:
        return 0
    return args[0].value if isinstance(args[0], Constant) and type(args[0].value) is int else None
