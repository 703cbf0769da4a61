"""lists_of_views: a list of arrays that other names stand for as well is a view of these, where one of them is written.

    rows = builtins.list(n)             rows = a[0:n]
    count = 0                           count = 0
    for i in range(n):                  for i in range(n):
        rows[i] = a[i]                      count += 1
        count += 1                      rows[1][0] *= 3.0
    rows[1][0] *= 3.0

Requires structured form and types. `rows` makes an array in place of a list, into which arrays are copied: establishes
that no copy is written, nor what it was made from, where the other one would tell. Only a list of the rows of one
array, one after the other, can be a view; all others are refused.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from s2sad.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.call_types import LISTED, stored_into
from s2sad.normalize.lists.copy_semantics import told_apart
from s2sad.evaluate.effects import Memory
from s2sad.normalize.lists.row_order import in_order, least, moved
from s2sad.normalize.buffers.upcoming_uses import UpcomingUses
from s2sad.normalize.views.unsupported_views import shows
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Break, Call, Constant, Expr, For, FunctionDef, IfExp, Name, Slice, Store,
    Subscript, While, add, assign, at, call_name, const, copy, index, indices, name, names, stored_names, sub, walk,
    with_body,
)

Writes = Callable[[Call], Sequence[int]]
HELP = "append a copy: .append(x.copy())"


def lists_of_views(function: FunctionDef, typing: Typing, memory: Memory, writes: Writes,
                   report: Report) -> FunctionDef:
    """The function with those views; what cannot be one goes into the report."""
    held = ListContents(function, typing, writes)
    told: dict[str, tuple[str, AST, str]] = {}
    stores = [s for several in held.stores.values() for s in several]
    for statement in told_apart(function, stores, typing, memory):
        told.setdefault(base_name(statement.targets[0]),
                        ("a list holds an array that is written, not a copy of it", statement, HELP))
    for listed in held.stores:
        if (place := held.bound_anew(listed)) is not None:
            told.setdefault(listed, (f"an element of the list {listed!r} becomes another array, and what it was is "
                                     "read later", place, "name a copy of what it was: x = xs[k].copy()"))
        if (place := held.telling(listed)) is not None:
            told.setdefault(listed, (f"the list {listed!r} holds views of an array, or one array several times, and "
                                     "what it holds is written", place, HELP))
    if not told:
        return function
    together = {other for listed in told for other in held.related(listed)}
    views = {listed: view for listed in sorted(together) if (view := held.as_view(listed)) is not None}
    for listed, (message, place, help) in told.items():
        if any(other not in views for other in held.related(listed)):
            report.error("S201", message, place, help=help)
    return with_body(function, held.viewed(function.body, views))


class ListContents:
    """What the lists of one function hold, and which names are views of it."""

    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.function, self.typing, self.writes = function, typing, writes
        self.parameters = {p.id for p in function.args.args}
        nodes = list(walk(function.body))
        self.order = {id(n): k for k, n in enumerate(nodes)}
        self.blocks = [b for n in (function, *nodes) for b in (getattr(n, "body", None), getattr(n, "orelse", None))
                       if isinstance(b, list)]
        self.made = {s.targets[0].id: s for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)
                     and call_name(s.value) == LISTED}
        self.stores: dict[str, list[Assign]] = {n: [] for n in self.made}
        for s in nodes:
            if isinstance(s, Assign) and (listed := stored_into(s.targets[0], self.made)):
                self.stores[listed].append(s)
        self.links: dict[str, set[str]] = {}        # a name and what it may be a view of
        for s in nodes:
            if isinstance(s, Assign) and isinstance(s.targets[0], Name):
                self.links.setdefault(s.targets[0].id, set()).update(self.sources(s.value))
        self.references = UpcomingUses(function)

    def sources(self, value: AST) -> set[str]:
        """The names whose memory a value may be."""
        if isinstance(value, IfExp):
            return self.sources(value.body) | self.sources(value.orelse)
        if shows(value):
            return self.sources(value.args[0])
        if not isinstance(value, (Name, Subscript, Attribute)) or not self.typing.of(value).is_array:
            return set()
        picked = isinstance(value, Subscript) and any(self.typing.of(i).is_array for i in indices(value))
        return set() if picked else {base_name(value.value if isinstance(value, Attribute) else value)} - {""}

    def is_shared(self, store: Assign) -> bool:
        return self.typing.of(store.value).is_array and isinstance(store.value, (Name, Subscript, Attribute))

    def views_of(self, held: Iterable[str]) -> set[str]:
        """Names and those that may be views of them."""
        found = set(held)
        while more := {n for n, above in self.links.items() if above & found} - found:
            found |= more
        return found

    def component(self, held: Iterable[str]) -> set[str]:
        """All names that may share memory with some, through lists as well."""
        found = self.views_of(held)
        while True:
            above = {a for n in found for a in self.links.get(n, ())}
            for listed, stores in self.stores.items():
                of = {a for s in stores if self.is_shared(s) and not self.is_new(s) for a in self.sources(s.value)}
                above |= {listed} if of & found else of if listed in found else set()
            if above <= found:
                return found
            found = self.views_of(found | above)

    def related(self, listed: str) -> list[str]:
        """A list and the other ones that hold views of the same array."""
        found = self.component({listed})
        return [n for n in self.made if n == listed or n in found]

    def around(self, node: AST, of: AST) -> list[AST]:
        """The loops around a statement that are not around another one."""
        return [n for n in walk(self.function.body) if isinstance(n, (For, While)) and any(m is node for m in walk(n))
                and not any(m is of for m in walk(n))]

    def is_new(self, store: Assign, kept: str = "") -> bool:
        """Whether what is stored is a name that was bound to a new array just before, which lies in no other list;
        `kept` is the name where it lies in a row that is stored."""
        block = next(b for b in self.blocks if any(s is store for s in b))
        kept = kept or (store.value.id if isinstance(store.value, Name) else "")
        before = block[:next(k for k, s in enumerate(block) if s is store)]
        bound = max((k for k, s in enumerate(before) if kept in stored_names(s)), default=-1)
        if bound < 0 or not isinstance(before[bound], Assign) or self.sources(before[bound].value):
            return False
        after = [n for s in block[bound:] for n in walk(s)]
        return not any(s is not store and kept in self.sources(s.value) and any(n is s for n in after)
                       for stores in self.stores.values() for s in stores)

    def is_repeated(self, listed: str) -> bool:
        """Whether a list may hold one array, or one part of it, several times."""
        shared = [s for s in self.stores[listed] if self.is_shared(s) and not self.is_new(s)]
        if any(self.component(self.sources(a.value)) & self.component(self.sources(b.value))
               for k, a in enumerate(shared) for b in shared[:k]):
            return True
        for s in shared:
            loops = self.around(s, self.made[listed])
            own = indices(s.value) if isinstance(s.value, Subscript) else []
            if len(loops) > 1 or loops and not any(moved(i, loops[0]) is not None for i in own):
                return True
        return False

    def telling(self, listed: str) -> AST | None:
        """The first statement that writes what a list holds where other names, or other elements, would tell."""
        shared = [s for s in self.stores[listed] if self.is_shared(s)]
        if not shared:
            return None
        own, filling = self.views_of({listed}), {id(s) for s in self.stores[listed]}
        writing = [s for s in walk(self.function.body) if id(s) not in filling and self.written(s) & own]
        if writing and self.is_repeated(listed):
            return writing[0]
        kept = [self.views_of({s.value.id}) if self.is_new(s) and isinstance(s.value, Name)
                else self.component(self.sources(s.value)) for s in shared]
        others = set().union(*kept) - own
        for s in writing:
            seen = self.references.after[id(s)] | self.parameters | (
                set(names(s.value)) if isinstance(s.value, Call) else set())
            if others & seen or any(n.startswith("array.") for n in others):
                return s
        return None

    def bound_anew(self, listed: str) -> AST | None:
        """The first statement that puts another array in place of one that a name stands for, which is read later."""
        parts = {n for n in self.views_of({listed}) if self.typing.of(name(n)).rank < self.typing.of(name(listed)).rank}
        return next((s for s in self.stores[listed] if isinstance(s.targets[0].value, Subscript)
                     and parts & self.references.after[id(s)]), None)

    def written(self, statement: AST) -> set[str]:
        """The arrays that a statement stores into."""
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            return set()
        target = statement.targets[0] if isinstance(statement, Assign) else getattr(statement, "target", None)
        whole = isinstance(statement, AugAssign) and target is not None and self.typing.of(target).is_array
        found = {base_name(target)} if isinstance(target, Subscript) or whole else set()
        called = isinstance(statement.value, Call) and (call_name(statement.value) or "").startswith("user.")
        return found | ({base_name(statement.value.args[k]) for k in self.writes(statement.value)} if called else set())

    # -- views -------------------------------------------------------------------------------------------------------

    def as_view(self, listed: str) -> tuple[AST, AST] | None:
        """The part of an array whose rows a list holds, one after the other, and the loop that puts them there."""
        made, stores = self.made[listed], self.stores[listed]
        block = next(b for b in self.blocks if any(s is made for s in b))
        here = next(k for k, s in enumerate(block) if s is made)
        place = next((k for k, s in enumerate(block) if isinstance(s, For) and len(stores) == 1 and any(
            n is stores[0] for n in s.body)), 0)
        loop = block[place]
        if not isinstance(loop, For) or any(isinstance(n, Break) for n in walk(loop.body)) or listed in names(
                block[here + 1:place]):
            return None
        value = self.picked(stores[0], loop)
        if not isinstance(value, Subscript) or not isinstance(value.value, Name):
            return None
        first, *rest = indices(value)
        shift = moved(first, loop)
        bounds = loop.iter.args if len(loop.iter.args) == 2 else [const(0), *loop.iter.args]
        plain = len(bounds) == 2 and all(
            isinstance(r, Slice) and (r.lower, r.upper, r.step) == (None, None, None) for r in rest)
        if shift is None or not plain or not all(self.lasts(n, loop) for n in names([value.value, *bounds])):
            return None
        lowest = least(bounds[0], self.function)        # a row that is counted from the end is no part's first one
        if lowest is None or lowest + shift < 0 or not in_order(stores[0], loop, self.function):
            return None
        return index(value.value, Slice(*(_plus(copy(b), shift) for b in bounds), None)), loop

    def picked(self, store: Assign, loop: For) -> AST:
        """What is stored; of a name that the same iteration binds, what it is bound to."""
        if not isinstance(store.value, Name):
            return store.value
        place = next(k for k, s in enumerate(loop.body) if s is store)
        bound = [s for s in loop.body[:place] if store.value.id in stored_names(s)]
        return bound[0].value if len(bound) == 1 and isinstance(bound[0], Assign) else store.value

    def lasts(self, identifier: str, place: AST) -> bool:
        """Whether a name is bound once, and before a statement."""
        stores = [n for n in walk(self.function.body) if isinstance(n, Name) and n.id == identifier
                  and isinstance(n.ctx, Store)]
        return "." in identifier or len(stores) == (identifier not in self.parameters) and all(
            self.order[id(n)] < self.order[id(place)] for n in stores)

    def viewed(self, block: list[AST], views: dict[str, tuple[AST, AST]]) -> list[AST]:
        """A block in which the view stands before the loop that would fill the list."""
        gone = {id(s) for listed in views for s in (self.made[listed], *self.stores[listed])}
        made: list[AST] = []
        for s in block:
            made += [at(assign(listed, view), self.made[listed]) for listed, (view, loop) in views.items() if loop is s]
            made += [] if id(s) in gone else [with_blocks(s, lambda inner: self.viewed(inner, views))]
        return made


def _plus(bound: AST, shift: int) -> AST:
    if isinstance(bound, Constant) and type(bound.value) is int:
        return const(bound.value + shift)
    return bound if not shift else add(bound, const(shift)) if shift > 0 else sub(bound, const(-shift))
