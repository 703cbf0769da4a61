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
        kind = type(part)
        if kind is Name:
            if type(part.ctx) is not Store and "." not in part.id:
                found.add(part.id)
            continue
        base = (part.value if kind is Attribute and part.attr in _ASKED else
                part.args[0] if kind is Call and call_name(part) in _SHAPES else None)
        if isinstance(base, (Name, Subscript)) and (n := base_name(base)):
            found.add("=" + n)
            while isinstance(base, Subscript):
                waiting.append(base.slice)
                base = base.value
        elif kind is not Constant:
            waiting += children(part)
    return found


class Accesses:
    """What statements read, bind and do, found once for each: for all rounds of a fixpoint, and for all trees that
    share them.

    `writes(call)` tells which arrays a kernel's call writes, `pure(call)` whether it may be dropped, `unread(call)`
    which arrays it is given and whose content it does not read.
    """

    def __init__(self, writes: Writes = lambda call: [], pure: Callable[[Call], bool] = lambda call: False,
                 unread: Callable[[Call], set[str]] = lambda call: set()):
        self.writes, self.pure, self.unread = writes, pure, unread
        # by the identity of a node, which the table keeps alive
        self._read: dict[int, tuple[AST, set[str]]] = {}
        self._flow: dict[int, tuple[AST, set[str], set[str]]] = {}
        self._done: dict[int, tuple[AST, set[str] | None]] = {}

    def read(self, node: AST) -> set[str]:
        """`read_names` of an expression."""
        found = self._read.get(id(node))
        if found is None:
            found = self._read[id(node)] = node, read_names(node)
        return found[1]

    def flow(self, statement: AST) -> tuple[set[str], set[str]]:
        """The names that are not live before a simple statement because of those behind it, and those that are."""
        found = self._flow.get(id(statement))
        if found is None:
            found = self._flow[id(statement)] = statement, *self._flow_of(statement)
        return found[1:]

    def _flow_of(self, statement: AST) -> tuple[set[str], set[str]]:
        ended: set[str] = set()
        begun: set[str] = set()
        for target in targets(statement):
            base = base_name(target)
            if isinstance(target, Name):
                both = {base, "=" + base}
                ended, begun = ended | both, begun - both
            elif isinstance(statement, Assign) and is_whole_array(target):
                ended, begun = ended | {base}, (begun - {base}) | {"=" + base}
            else:
                begun = begun | (read_names(target) - {base}) | {base}
        if isinstance(statement, AugAssign):
            begun = begun | read_names(statement.target) | {base_name(statement.target)}
        read = read_names(statement.value)
        if user_call(statement.value):
            unread = self.unread(statement.value)
            read = (read - unread) | {"=" + n for n in unread}
        return ended, begun | read

    def done(self, statement: AST) -> set[str] | None:
        """The names of which one must be live for a simple statement to do anything; None if it always does."""
        found = self._done.get(id(statement))
        if found is None:
            found = self._done[id(statement)] = statement, self._done_by(statement)
        return found[1]

    def _done_by(self, statement: AST) -> set[str] | None:
        if isinstance(statement, (Assign, AugAssign)):
            found = {base_name(t) for t in targets(statement)}
            found |= {"=" + t.id for t in targets(statement) if isinstance(t, Name)}
            for node in walk(statement.value):
                if user_call(node):
                    if not self.pure(node):
                        return None
                    found |= set(self.writes(node))
            return found
        if isinstance(statement, Expr) and isinstance(statement.value, Call):
            return set(self.writes(statement.value)) if self.pure(statement.value) else None
        return set() if isinstance(statement, Pass) or forgotten(statement) else None


class Liveness:
    """The table: `after[id(statement)]` and, for loops, `entry[id(loop)]`, the names live where its body begins;
    `idle`, the loops that do nothing that is read."""

    def __init__(self, function: FunctionDef, live_out: set[str], accesses: Accesses, strong: bool = True):
        self.accesses, self.strong = accesses, strong
        self.after: dict[int, set[str]] = {}
        self.entry: dict[int, set[str]] = {}
        self.idle: set[int] = set()
        self._break: list[set[str]] = []
        self._out = set(live_out)
        self._loops: dict[int, tuple[set[str], set[str]]] = {}      # what was last live behind it, and before it
        self._inner: dict[int, list[AST] | None] = {}
        self.start = self.block(function.body, self._out)

    def block(self, block: list[AST], live: set[str]) -> set[str]:
        for statement in reversed(block):
            self.after[id(statement)] = live
            live = self.statement(statement, live)
        return live

    def needed(self, statement: AST, live: set[str]) -> bool:
        """Whether a simple statement does anything that is read later."""
        done = self.accesses.done(statement)
        return done is None or not done.isdisjoint(live)

    def statement(self, statement: AST, live: set[str]) -> set[str]:
        if isinstance(statement, If):
            body, orelse = self.block(statement.body, live), self.block(statement.orelse, live)
            if self.strong and body == live == orelse and not self._does(statement, live):
                return live
            return body | orelse | self.accesses.read(statement.test)
        if isinstance(statement, (For, While)):
            found = self._loops.get(id(statement))
            if found is None or found[0] != live:
                found = self._loops[id(statement)] = live, self._loop(statement, live)
            return found[1]
        if isinstance(statement, Break):
            return self._break[-1]
        if isinstance(statement, (Assert, Raise, Return)):
            return (self._out if isinstance(statement, Return) else live) | self.accesses.read(statement)
        if marked := forgotten(statement):      # what the arrays hold is not read, but they are written
            return {"=" + n if n in marked else n for n in live}
        if self.strong and not self.needed(statement, live):
            return live
        ended, begun = self.accesses.flow(statement)
        return (live - ended) | begun

    def _loop(self, loop: AST, live: set[str]) -> set[str]:
        if self.strong and not self._does(loop, live):
            self.idle.add(id(loop))
            return live
        self.idle.discard(id(loop))
        test = self.accesses.read(loop.iter if isinstance(loop, For) else loop.test)
        own = {loop.target.id} if isinstance(loop, For) else set()
        around = live if isinstance(loop, For) else live | test
        while True:
            self._break.append(live)
            entry = self.block(loop.body, around)
            self._break.pop()
            self.entry[id(loop)] = entry
            grown = around | (entry - own)
            if grown == around:
                return around | test
            around = grown

    def _does(self, statement: AST, live: set[str]) -> bool:
        """Whether a loop or branch binds or stores anything live, or has an effect of its own.

        Names that only loop into themselves do not count: they are found dead by growing from what is live.
        """
        if id(statement) not in self._inner:
            inner = list(walk_statements(statement))
            always = any(isinstance(s, (Assert, Raise, Return)) or isinstance(s, Break) and isinstance(statement, If)
                         for s in inner)
            self._inner[id(statement)] = None if always else [
                s for s in inner if isinstance(s, (Assign, AugAssign, Expr))]
        found = self._inner[id(statement)]
        return found is None or any(self.needed(s, live) for s in found)


def is_whole_array(place: AST) -> bool:
    """Whether a place is all of an array: `x[...]`."""
    return isinstance(place, Subscript) and isinstance(place.slice, Constant) and place.slice.value is Ellipsis
