"""The arrays that say where the entries of sparse matrices are, and whether they are written while they are used.

    A_row = sparse.shared(rows)         A_row = rows            SciPy copies such an array or not, as its type is: one
    B_row = sparse.copied(A_row)        B_row = A_row           that is written before its last use is refused, or is
                                                                copied where SciPy copies it
"""
from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from s2sad.blocks import with_blocks
from s2sad.evaluate.effects import FRESH_METHODS, STABLE, fresh_value
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Call, Expr, For, IfExp, List, Name, Store, Subscript, Tuple, While, at, call,
    call_name, children, walk,
)

SHARED, COPIED = "sparse.shared", "sparse.copied"
ROWS = "runtime.sparse_rows"
_QUIET = ("builtins.print", "print")
Refuse = Callable[[AST], Exception]


@dataclass(frozen=True)
class _Place:
    """A statement by its number, with the loops around it."""
    number: int
    loops: tuple[int, ...]

    def may_follow(self, other: _Place) -> bool:
        return self.number > other.number or any(loop in other.loops for loop in self.loops)


def settled_places(block: Sequence[AST], refuse: Refuse) -> list[AST]:
    """The statements with arrays, or copies of them, in place of what is marked; `refuse` makes the error for a
    statement after which such an array would be another one."""
    if not any(_marked(s) for s in _statements(block)):
        return list(block)
    uses = _Uses(block)
    copies: set[int] = set()
    for statement, made in reversed(uses.marked):
        written = uses.written_before_use(statement)
        if call_name(made) == COPIED and written is not None:
            copies.add(id(statement))
        elif written is not None:
            raise refuse(written)
    through = uses.written_through()
    if through is not None:
        raise refuse(through)

    def change(statements: list[AST]) -> list[AST]:
        return [_plain(s, id(s) in copies) if _marked(s) is not None else with_blocks(s, change) for s in statements]
    return change(list(block))


def _plain(statement: Any, is_copied: bool) -> AST:
    (array,) = statement.value.args
    made = call("numpy.copy", array) if is_copied else array
    return at(Assign(statement.targets, at(made, statement), None), statement)


def _marked(node: Any) -> Call | None:
    """The call of a statement that marks an array of places."""
    made = node.value if isinstance(node, Assign) else None
    return made if isinstance(made, Call) and call_name(made) in (SHARED, COPIED) else None


def _statements(block: Sequence[Any]) -> Iterator[AST]:
    for s in block:
        yield s
        for inner in ("body", "orelse"):
            yield from _statements(getattr(s, inner, ()))


class _Uses:
    """Where names are bound, read and written in a block."""

    def __init__(self, block: Sequence[AST]):
        self.marked: list[tuple[Any, Call]] = []
        self.at: dict[int, _Place] = {}
        self.bound: dict[str, list[_Place]] = defaultdict(list)
        self.read: dict[str, list[_Place]] = defaultdict(list)
        self.written: list[tuple[str, _Place, AST]] = []
        self.sources: dict[str, set[str]] = defaultdict(set)        # what a name may share memory with, or is made of
        self.views: dict[str, set[str]] = defaultdict(set)          # without what is made of others
        self._count = 0
        self._block(block, ())

    def _block(self, block: Sequence[Any], loops: tuple[int, ...]) -> None:
        for s in block:
            self._count += 1
            place = self.at[id(s)] = _Place(self._count, loops)
            inner = (*loops, self._count) if isinstance(s, (For, While)) else loops
            parts = [c for c in children(s) if not any(c is b for f in ("body", "orelse") for b in getattr(s, f, ()))]
            head = _Place(self._count, inner) if isinstance(s, While) else place
            self._expressions(s, parts, head)
            for field in ("body", "orelse"):
                self._block(getattr(s, field, ()), inner if field == "body" else loops)

    def _expressions(self, s: Any, parts: Sequence[AST], place: _Place) -> None:
        made = _marked(s)
        if made is not None:
            self.marked.append((s, made))
        for part in parts:
            for n in walk(part):
                if isinstance(n, Name):
                    (self.bound if isinstance(n.ctx, Store) else self.read)[n.id].append(place)
        for node in (s, *(n for p in parts for n in walk(p))):
            self.written += [(name, place, s) for array in _written(node) for name in _bases(array)]
        pairs = [(t, s.value) for t in s.targets] if isinstance(s, Assign) else [
            (s.target, s.iter)] if isinstance(s, For) else []
        for target, value in pairs:
            several = isinstance(target, Tuple) and isinstance(value, Tuple) and len(target.elts) == len(value.elts)
            for t, v in zip(target.elts, value.elts) if several else [(target, value)]:
                names = [n.id for n in walk(t) if isinstance(n, Name) and isinstance(n.ctx, Store)]
                for name in names:
                    self.views[name] |= {*_bases(v)}
                    self.sources[name] |= {*_bases(v), *_bases_of_rows(v)}

    def _from(self, names: set[str], table: dict[str, set[str]], copied: bool = True) -> set[str]:
        """Names and all that are made of them."""
        stops = {s.targets[0].id for s, made in self.marked if call_name(made) == COPIED} if not copied else set()
        found = set(names)
        while more := {n for n, of in table.items() if of & found and n not in stops} - found:
            found |= more
        return found

    def _roots(self, name: str) -> set[str]:
        """What a name is made of, itself included."""
        found = {name}
        while more := {s for n in found for s in self.sources.get(n, ())} - found:
            found |= more
        return found

    def written_before_use(self, statement: Any) -> AST | None:
        """What may write the array that a statement marks before it is used for the last time."""
        own, start = statement.targets[0].id, self.at[id(statement)]
        memory = self._from(self._roots(own) - {own}, self.views) | {own}
        readers = self._from({own}, self.sources, False)
        for name, place, writer in self.written:
            if name not in memory or not place.may_follow(start):
                continue
            for reader in readers:
                direct = reader == own and len(self.bound[own]) == 1
                for read in self.read[reader]:
                    if (_between(start, place, read) if direct else read.may_follow(place)):
                        return writer
        return None

    def written_through(self) -> AST | None:
        """What writes an array of places by its own name: that of an attribute of a matrix."""
        own = self._from({s.targets[0].id for s, _ in self.marked}, self.views)
        return next((writer for name, _, writer in self.written if name in own), None)


def _between(start: _Place, write: _Place, read: _Place) -> bool:
    """Whether something is written after it was bound and before it is read, where it is bound once."""
    around = read.loops[len(start.loops):] if read.loops[:len(start.loops)] == start.loops else ()
    return start.number < write.number < read.number or any(loop in write.loops for loop in around)


def _written(node: AST) -> list[AST]:
    """The arrays that a node may write."""
    if isinstance(node, Subscript) and isinstance(node.ctx, Store):
        return [node.value]
    if isinstance(node, AugAssign):
        return [node.target]
    called = node.value if isinstance(node, Expr) else node
    if not isinstance(called, Call) or call_name(called) in _QUIET:
        return []
    out = [k.value for k in called.keywords if k.arg == "out"]
    if not isinstance(node, Expr) and not (call_name(called) or "").startswith(("function.", "separate.")):
        return out
    method = [called.func.value] if isinstance(called.func, Attribute) else []
    appends = isinstance(called.func, Attribute) and called.func.attr == "append"
    return method if appends else [*method, *called.args, *(k.value for k in called.keywords)]


def _bases(node: AST) -> list[str]:
    """The names whose memory an expression may be a part of."""
    if isinstance(node, Name):
        return [node.id]
    if isinstance(node, Subscript) or isinstance(node, Attribute) and node.attr not in STABLE:
        return _bases(node.value)
    if isinstance(node, IfExp):
        return [*_bases(node.body), *_bases(node.orelse)]
    if isinstance(node, (Tuple, List)):
        return [n for item in node.elts for n in _bases(item)]
    if not isinstance(node, Call) or fresh_value(node):
        return []
    called = call_name(node) or ""
    if called.startswith(("runtime.", "scipy.", "builtins.", "math.")) or called == COPIED:
        return []
    if isinstance(node.func, Attribute):
        return [] if node.func.attr in FRESH_METHODS else _bases(node.func.value)
    return [n for a in (*node.args, *(k.value for k in node.keywords)) for n in _bases(a)]


def _bases_of_rows(node: AST) -> list[str]:
    """The arrays that rows are computed of, which are those of a matrix only as long as these are not written."""
    if isinstance(node, Call) and call_name(node) in (ROWS, COPIED):
        return [n for a in node.args for n in _bases(a)]
    return []
