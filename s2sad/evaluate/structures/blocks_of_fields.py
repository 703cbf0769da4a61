"""The statements of one kernel while structures are taken apart.

    for w, b in layers:          ->   x = np.tanh(layers_0_0 @ x + layers_0_1)
        x = np.tanh(w @ x + b)        x = np.tanh(layers_1_0 @ x + layers_1_1)
    state.t += dt                ->   state_t[0] += dt
    if mask is not None: ...     ->   the branch that is taken
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.diagnostics import Report
from s2sad.infer.types import UNKNOWN
from s2sad.evaluate.completion import BREAK, CONTINUE, FALL, completion
from s2sad.evaluate.structures.bindings import Env
from s2sad.evaluate.structures.literal_arguments import given_names
from s2sad.evaluate.structures.inner_results import Inner
from s2sad.evaluate.structures.iterated_structures import is_of_its_own, late, reads, written_leaves
from s2sad.evaluate.structures.call_values import Maker
from s2sad.evaluate.structures.groups import (
    ORDINARY, SPELLED, Conflict, StructureValue, Leaf, Ordinary, Plain, Value, listed, nothing, spelled, usable,
)
from s2sad.evaluate.loops.counted_loops import LONGEST
from s2sad.evaluate.effects import bindings
from s2sad.program import Kernel
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Break, Call, Constant, Continue, Expr, For, If, List, Name, Return,
    Store, Subscript, Tuple, While, assign, at, call_name, const, copy, name, names, tuple_of, walk, walk_statements,
)

_ITEMS = ".items"                       # no user's name: what a loop that is written out still goes through


class StructureBlocks(Inner):
    """The statements of one kernel; `returned` are the structures that it returns."""

    def __init__(self, kernel: Kernel, maker: Maker, report: Report, fresh: Callable[[str], str]):
        super().__init__(kernel, maker, report, fresh)
        self.returned: list[tuple[Return, StructureValue]] = []
        self.jumps: list[list[Env]] = []
        self.written: set[str] = set()          # the flat names that the loop at hand may write
        self.held: list[AST] = []               # names for what it goes through that is made before it
        self.handed = given_names(kernel.tree)
        others = {t.id for t, v in bindings(kernel.tree) if isinstance(t, Name) and not isinstance(v, (Tuple, List))}
        self.item_stores = {n.value.id for n in walk(kernel.tree.body) if isinstance(n, Subscript) and isinstance(
            n.value, Name) and isinstance(n.ctx, Store)}
        self.again = (self.rebound & set(self.nests)) - others

    def block(self, statements: list[AST]) -> list[AST]:
        made: list[AST] = []
        for node in statements:
            before, left = self.named_first(node)
            new = [*before, *(at(s, node) for s in self._statement(left))]
            made += new
            if isinstance(node, If) and FALL not in completion(new):
                break                   # what follows a branch that is always taken may be about what is not there
        return made

    def _statement(self, node: AST) -> list[AST]:
        known = _STEPS.get(type(node))
        if known is not None:
            return known(self, node)
        if isinstance(node, (Break, Continue)) and self.jumps:
            self.jumps[-1].append(dict(self.env))
        return [self.plain(node)]

    # -- assignments ---------------------------------------------------------------------------------------------------

    def assign(self, node: Assign) -> list[AST]:
        before, value = self.result(node.value, node.targets)
        if isinstance(value, Plain) and self._as_structure(node.targets[0], node.value):
            value = self.whole(node.value)
        if isinstance(value, StructureValue) and len(node.targets) > 1:
            made, value = self.kept(value, node, "held")
            before += made
        if isinstance(value, (StructureValue, Leaf)) and not (isinstance(value, Leaf)
                                                              and usable(value)) or nothing(value):
            return before + [s for t in node.targets for s in self.bound(t, value, node)]
        plain = self.plainly(value, node.value)
        targets = [self.target(t, plain) for t in node.targets]
        return [*before, Assign(targets, plain, None)]

    def _as_structure(self, target: AST, value: AST) -> bool:
        """Whether a tuple is taken apart for a target: a name that held one, or is handed to helpers. One that is bound
        again is handed on by its items, if nothing in it is a structure. A list is where its name held one, too, and
        no item is ever assigned."""
        if not isinstance(target, Name) or not isinstance(value, (Tuple, List)):
            return False
        held = isinstance(self.env.get(target.id), (StructureValue, Conflict))
        if isinstance(value, List):
            return held and target.id not in self.item_stores
        return held or target.id in self.handed - self.again

    def _augmented(self, node: AugAssign) -> list[AST]:
        target = node.target
        called = self.in_place(node) if isinstance(target, Name) else None
        if called is not None:
            return self.assign(at(Assign([target], called, None), node))
        value = self.plain(node.value)
        if isinstance(target, (Attribute, Subscript)):
            found = self.assigned(target, value, True, node.op)
            return [AugAssign(found if found is not None else self.plain(target), node.op, value)]
        found = self.env.get(target.id) if isinstance(target, Name) else None
        if isinstance(found, Leaf) and found.type.is_array:
            return [AugAssign(at(Name(found.name, Store(), None, None), target), node.op, value)]
        if isinstance(found, (StructureValue, Leaf, Conflict)):
            self.plainly(found, target) if not isinstance(found, Conflict) else self.value(name(target.id))
        if isinstance(target, Name):
            self.env[target.id] = ORDINARY
        return [AugAssign(target, node.op, value)]

    # -- control -------------------------------------------------------------------------------------------------------

    def _if(self, node: If) -> list[AST]:
        decided = self.decide(node.test)
        if decided is not None:
            return self.block(node.body if decided else node.orelse)
        test, start = self.plain(node.test), dict(self.env)
        body, after = self.block(node.body), self.env
        self.env = start
        orelse = self.block(node.orelse)
        if FALL not in completion(orelse):
            self.env = after
        elif FALL in completion(body):
            self.env = _merged(after, self.env, self.is_fixed)
        return [If(test, body, orelse)]

    def _while(self, node: While) -> list[AST]:
        if self.decide(node.test) is False:
            return self.block(node.orelse)
        test, body = node.test, node.body

        def once() -> list[AST]:
            return [While(self.plain(test), self.block(body), [])]
        return self._looped(once, node.body, node.orelse)

    def _looped(self, once: Callable[[], list[AST]], body: list[AST], orelse: list[AST]) -> list[AST]:
        """A loop's body under what holds in every iteration."""
        before, outer = self.detached(body), self.in_loop
        self.in_loop = True
        start, mark, returned = dict(self.env), len(self.report.found), len(self.returned)
        while True:
            self.env = dict(start)
            self.jumps.append([])
            made = once()
            ends = [self.env, *self.jumps.pop()]
            merged = start
            for end in ends:
                merged = _merged(merged, end, self.is_fixed)
            if all(merged.get(n) == start[n] for n in start):
                self.env, self.in_loop = merged, outer
                made[0].orelse = self.block(orelse)
                return before + made
            start = {n: merged[n] for n in start}
            del self.report.found[mark:], self.returned[returned:]

    def _for(self, node: For) -> list[AST]:
        self.written, self.held = written_leaves([node.target, *node.body], self.env), []
        items = self._items(node.iter, node)
        before, written = self.held, self.written
        if items is None:
            iterable = self.plain(node.iter)

            def once() -> list[AST]:
                target = self.target(node.target, None)
                return [For(target, iterable, self.block(node.body), [], None)]
            return self._looped(once, node.body, node.orelse)
        if {BREAK, CONTINUE} & completion(node.body):
            return [*before, *self._spelled(node, items, written)]
        if len(items) > LONGEST * 4:
            self.refuse(node.iter, f"a loop over a structure of {len(items)} items", "put them into an array")
            return []
        stored = {t.id for s in walk_statements(node.body) if isinstance(s, (Assign, For))
                  for t in walk(getattr(s, "targets", None) or [s.target])
                  if isinstance(t, Name) and isinstance(t.ctx, Store)}
        made: list[AST] = []
        mine = f"{_ITEMS}{id(node)}"
        self.env[mine] = listed(tuple(items))
        for item in items:
            made += [at(s, node) for s in self.bound(copy(node.target), item, node, frozenset(stored))]
            made += self.block(copy(node.body))
        self.env.pop(mine, None)
        return before + made + self.block(node.orelse)

    def _spelled(self, node: For, items: list[Value], written: set[str]) -> list[AST]:
        """A loop that is left early goes through a tuple that is written out."""
        shown = [spelled(item, node.iter) for item in items]
        if any(s is None for s in shown):
            self.refuse(node, "a loop over structures, or over a structure and None, is left by break or continue",
                        "put the body under an if")
            return []
        iterable = late(at(tuple_of(*[s for s in shown if s is not None]), node.iter), written)

        def once() -> list[AST]:
            return [For(self.target(copy(node.target), None), iterable, self.block(node.body), [], None)]
        return self._looped(once, node.body, node.orelse)

    def _items(self, iterable: AST, loop: For | None = None) -> list[Value] | None:
        """The items of a loop that is written out because of structures; None for any other loop."""
        called, parts = call_name(iterable), getattr(iterable, "args", [])
        if called == "builtins.reversed" and len(parts) == 1:
            if (whole := self.structural(parts[0])) is not None:
                self.gone_through(whole, iterable, "__reversed__", "__len__", "__getitem__")
            inner = self._items(parts[0], loop)
            return None if inner is None else inner[::-1]
        if called == "builtins.enumerate" and len(parts) == 1 and not iterable.keywords:
            inner = self._items(parts[0])
            return None if inner is None else [listed((Plain(at(const(k), iterable)), i)) for k, i in enumerate(inner)]
        if called == "builtins.zip":
            return self._zipped(iterable)
        if called == "builtins.range" and loop is not None and self._picks(loop):
            return self._counted(iterable)
        if loop is not None and isinstance(iterable, (Tuple, List)) and self._picks(loop) and all(
                isinstance(i, Constant) for i in iterable.elts):
            return [Plain(i) for i in iterable.elts]
        found = self.structural(iterable)
        if not isinstance(found, StructureValue):
            return None
        found = self._made_before(found, iterable)
        self.gone_through(found, iterable)
        if found.form.kind == "dict":
            return [Plain(at(const(k), iterable)) for k in found.form.keys]
        return list(found.items) if found.form.is_sequence else None

    def _made_before(self, found: StructureValue, iterable: AST) -> StructureValue:
        """What a loop goes through; numbers that it writes have names of their own where it is made before the loop."""
        def held(item: Value) -> Value:
            if isinstance(item, StructureValue):
                return replace(item, items=tuple(map(held, item.items))) if item.path == SPELLED else item
            if not reads(item, self.written):
                return item
            new = self.fresh("held")
            self.held.append(at(assign(new, spelled(item, iterable) or const(0.0)), iterable))
            return Leaf(new, new, UNKNOWN)
        return replace(found, items=tuple(map(held, found.items))) if is_of_its_own(iterable) else found

    def _counted(self, node: Call) -> list[Value] | None:
        """The numbers of a range whose bounds are known here."""
        bounds = [b for b in map(self.key, node.args) if isinstance(b, int)]
        if not bounds or len(bounds) < len(node.args) or bounds[2:] == [0] or len(range(*bounds)) > LONGEST * 4:
            return None
        return [Plain(at(const(k), node)) for k in range(*bounds)]

    def _zipped(self, iterable: Call) -> list[Value] | None:
        columns = [self._items(p) for p in iterable.args]
        if all(c is None for c in columns):
            return None
        for k, part in enumerate(iterable.args):
            if columns[k] is None and isinstance(part, (Tuple, List)):
                columns[k] = list(self._made_before(listed(tuple(map(self.value, part.elts))), part).items)
            elif columns[k] is None and call_name(part) == "builtins.range":
                columns[k] = self._counted(part)
        if any(c is None for c in columns):
            self.refuse(iterable, "zip() of a structure and of something whose length is not known here",
                        "loop over range(len(...)) of the structure, and index both")
            return []
        return [listed(row) for row in zip(*[c for c in columns if c is not None])]

    def _picks(self, loop: For) -> bool:
        """Whether a loop's counter picks the items of a structure."""
        counter = loop.target.id if isinstance(loop.target, Name) else ""
        for node in walk(loop.body):
            if isinstance(node, Subscript) and counter in names(node.slice) and isinstance(node.value, (
                    Name, Attribute, Subscript)):
                mark = len(self.report.found)
                found = self.structural(node.value)
                del self.report.found[mark:]
                if isinstance(found, StructureValue):
                    return True
        return False

    # -- the rest ------------------------------------------------------------------------------------------------------

    def _expression(self, node: Expr) -> list[AST]:
        before, value = self.result(node.value, [])
        if before or isinstance(value, (StructureValue, Leaf)):
            return before
        return [Expr(value.node)]

    def _return(self, node: Return) -> list[AST]:
        if node.value is None or isinstance(node.value, Constant) and node.value.value is None:
            return [Return(node.value)]
        before, value = self.result(node.value, [])
        if isinstance(node.value, (Tuple, List)):
            value = self.whole(node.value)
        if nothing(value):
            return [*before, Return(at(const(None), node))]
        if not isinstance(value, StructureValue):
            return [*before, Return(self.plainly(value, node.value))]
        made, value = self.kept(value, node.value, "result") if value.path != SPELLED else ([], value)
        last = Return(None)
        self.returned.append((last, value))
        return [*before, *made, last]

    def _assert(self, node: Assert) -> list[AST]:
        decided = self.decide(node.test)
        if decided:
            return []
        test = self.plain(node.test) if decided is None else at(const(False), node.test)
        return [Assert(test, None if node.msg is None else self.plain(node.msg))]


def _merged(a: Env, b: Env, fixed: Callable[[Value], bool]) -> Env:
    """What holds where two ways meet."""
    found: Env = {}
    for n in {**a, **b}:
        one, other = a.get(n), b.get(n)
        if one is None or other is None or one == other:
            both = one if one is not None else other
            assert both is not None
            found[n] = both
        elif isinstance(one, (Plain, Ordinary)) and isinstance(other, (Plain, Ordinary)):
            found[n] = ORDINARY
        else:
            found[n] = _either(one, other, fixed)
    return found


def _either(one: Value | Conflict | Ordinary, other: Value | Conflict | Ordinary,
            fixed: Callable[[Value], bool]) -> Value | Conflict | Ordinary:
    """One structure whose flat names are the same, whatever they hold; else a conflict."""
    if (isinstance(one, StructureValue) and isinstance(other, StructureValue)
            and one.form.keys == other.form.keys and fixed(one)):
        parts = [_either(x, y, fixed) for x, y in zip(one.items, other.items)]
        if all(isinstance(p, (Plain, Leaf, StructureValue)) for p in parts):
            return replace(one, items=tuple(parts))  # pyright: ignore[reportArgumentType]
    if isinstance(one, Leaf) and isinstance(other, Leaf) and one.name and one.name == other.name and not (
            one.is_cell or other.is_cell):
        return replace(one, place=-1, type=one.type if one.type == other.type else UNKNOWN)
    return one if one == other else Conflict()


_STEPS: dict[type, Callable[[StructureBlocks, AST], list[AST]]] = {
    Assign: StructureBlocks.assign, AugAssign: StructureBlocks._augmented, If: StructureBlocks._if,
                                                                   While: StructureBlocks._while,
                                                                   For: StructureBlocks._for,
    Expr: StructureBlocks._expression, Return: StructureBlocks._return, Assert: StructureBlocks._assert,
}
