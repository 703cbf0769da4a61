"""liveness: which names are read later; strong (a name that only feeds dead names is dead itself).

Requires a structured function; establishes, for every statement, the names live after it.
An element store reads nothing of its array and does not end its life; a binding does.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Break, Call, Constant, Expr, For, FunctionDef, If, Name, Pass, Raise,
    Return, Store, Subscript, Tuple, While, call_name, children, forgotten, names, user_call, walk, walk_statements,
)

Writes = Callable[[Call], list[str]]


def base_name(node: AST) -> str:
    """The array behind `x`, `x[i]`, `x[i][j]`."""
    while isinstance(node, Subscript):
        node = node.value
    return node.id if isinstance(node, Name) else ""


def targets(statement: AST) -> list[AST]:
    """What a statement binds or stores into."""
    if isinstance(statement, Assign):
        target = statement.targets[0]
        return list(target.elts) if isinstance(target, Tuple) else [target]
    return [statement.target] if isinstance(statement, (AugAssign, For)) else []


def touched(statement: AST) -> set[str]:
    """The names that a statement may write: what it binds or stores into, and what it gives to a kernel."""
    found = {base_name(t) for part in walk_statements(statement) for t in targets(part)}
    for part in walk(statement):
        if user_call(part):
            found |= {n for a in part.args for n in names(a)}
    return found


_ASKED = ("shape", "size", "dtype", "flags")
_SHAPES = {"builtins.len", "numpy.zeros_like", "numpy.empty_like"}


def read_names(node: AST | list[AST]) -> set[str]:
    """The names that an expression reads; `=x` for an array of which it needs the shape alone."""
    found: set[str] = set()
    waiting = list(node) if isinstance(node, list) else [node]
    while waiting:
        part = waiting.pop()
        base = part.value if isinstance(part, Attribute) else part.args[0] if call_name(part) in _SHAPES else None
        if isinstance(base, (Name, Subscript)) and (n := base_name(base)) and (
                not isinstance(part, Attribute) or part.attr in _ASKED):
            found.add("=" + n)
            while isinstance(base, Subscript):
                waiting.append(base.slice)
                base = base.value
            continue
        if isinstance(part, Name) and not isinstance(part.ctx, Store) and "." not in part.id:
            found.add(part.id)
        waiting += children(part)
    return found


class Liveness:
    """The table: `after[id(statement)]` and, for loops, `entry[id(loop)]`, the names live where its body begins;
    `idle`, the loops that do nothing that is read.

    `writes(call)` tells which arrays a kernel's call writes, `pure(call)` whether it may be dropped, `unread(call)`
    which arrays it is given and whose content it does not read.
    """

    def __init__(self, function: FunctionDef, live_out: set[str], writes: Writes, pure: Callable[[Call], bool],
                 strong: bool = True, unread: Callable[[Call], set[str]] = lambda call: set()):
        self.unread = unread
        self.after: dict[int, set[str]] = {}
        self.entry: dict[int, set[str]] = {}
        self.idle: set[int] = set()
        self.writes, self.pure, self.strong = writes, pure, strong
        self._break: list[set[str]] = []
        self._out = set(live_out)
        self.start = self.block(function.body, set(live_out))

    def block(self, block: list[AST], live: set[str]) -> set[str]:
        for statement in reversed(block):
            self.after[id(statement)] = set(live)
            live = self.statement(statement, live)
        return live

    def needed(self, statement: AST, live: set[str]) -> bool:
        """Whether a simple statement does anything that is read later."""
        if isinstance(statement, (Assign, AugAssign)):
            bound = {base_name(t) for t in targets(statement)}
            bound |= {"=" + t.id for t in targets(statement) if isinstance(t, Name)}
            if bound & live:
                return True
            effects: set[str] = set()
            for node in walk(statement.value):
                if user_call(node):
                    if not self.pure(node):
                        return True
                    effects |= set(self.writes(node))
            return bool(effects & live)
        if isinstance(statement, Expr) and isinstance(statement.value, Call):
            return not self.pure(statement.value) or bool(set(self.writes(statement.value)) & live)
        return not isinstance(statement, Pass) and not forgotten(statement)

    def statement(self, statement: AST, live: set[str]) -> set[str]:
        if forgotten(statement):        # what the arrays hold is not read, but they are written
            return {"=" + n if n in forgotten(statement) else n for n in live}
        if isinstance(statement, If):
            body, orelse = self.block(statement.body, set(live)), self.block(statement.orelse, set(live))
            if self.strong and body == live == orelse and not _does(statement, self, live):
                return live
            return body | orelse | read_names(statement.test)
        if isinstance(statement, (For, While)):
            return self._loop(statement, live)
        if isinstance(statement, Break):
            return set(self._break[-1])
        if isinstance(statement, (Assert, Raise, Return)):
            return (self._out if isinstance(statement, Return) else live) | read_names(statement)
        if self.strong and not self.needed(statement, live):
            return live
        return self._simple(statement, live)

    def _simple(self, statement: AST, live: set[str]) -> set[str]:
        live = set(live)
        for target in targets(statement):
            if isinstance(target, Name):
                live -= {target.id, "=" + target.id}
            elif isinstance(statement, Assign) and is_whole_array(target):
                live = (live - {base_name(target)}) | {"=" + base_name(target)}
            else:
                live |= read_names(target) - {base_name(target)}
                live.add(base_name(target))
        if isinstance(statement, AugAssign):
            live |= read_names(statement.target) | {base_name(statement.target)}
        read = read_names(statement.value)
        if user_call(statement.value):
            unread = self.unread(statement.value)
            read = (read - unread) | {"=" + n for n in unread}
        return live | read

    def _loop(self, loop: AST, live: set[str]) -> set[str]:
        if self.strong and not _does(loop, self, live):
            self.idle.add(id(loop))
            return live
        self.idle.discard(id(loop))
        test = read_names(loop.iter if isinstance(loop, For) else loop.test)
        own = {loop.target.id} if isinstance(loop, For) else set()
        around = set(live) | (set() if isinstance(loop, For) else test)
        while True:
            self._break.append(set(live))
            entry = self.block(loop.body, set(around))
            self._break.pop()
            self.entry[id(loop)] = entry
            grown = around | (entry - own)
            if grown == around:
                return around | test
            around = grown


def is_whole_array(place: AST) -> bool:
    """Whether a place is all of an array: `x[...]`."""
    return isinstance(place, Subscript) and isinstance(place.slice, Constant) and place.slice.value is Ellipsis


def _does(statement: AST, liveness: Liveness, live: set[str]) -> bool:
    """Whether a loop or branch binds or stores anything live, or has an effect of its own.

    Names that only loop into themselves do not count: they are found dead by growing from what is live.
    """
    inner = [s for s in walk_statements(statement) if isinstance(s, (Assign, AugAssign, Expr, Assert, Raise, Return))]
    if any(isinstance(s, (Assert, Raise, Return)) for s in inner):
        return True
    return any(liveness.needed(s, live) for s in inner) or any(
        isinstance(s, Break) for s in walk_statements(statement)) and isinstance(statement, If)
