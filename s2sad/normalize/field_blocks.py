"""The statements of one kernel while structures are taken apart.

    q = state.inner              ->   (nothing: q.u is state_inner_u from here on)
    w, b = layers[1]             ->   w, b = layers_1_0, layers_1_1
    for w, b in layers:          ->   x = np.tanh(layers_0_0 @ x + layers_0_1)
        x = np.tanh(w @ x + b)        x = np.tanh(layers_1_0 @ x + layers_1_1)
    state.t += dt                ->   state_t[0] += dt
    if mask is not None: ...     ->   the branch that is taken
    state = step(state, p)       ->   state_u, state_t = step(state_u, state_t, p_k)
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.infer.types import NONE, UNKNOWN
from s2sad.normalize.calls import user_call
from s2sad.normalize.exits import BREAK, CONTINUE, FALL, exits
from s2sad.normalize.field_values import NO, Values, listed
from s2sad.normalize.groups import (
    ORDINARY, Conflict, Group, Leaf, Ordinary, Plain, Value, flat, nothing, spelled, usable,
)
from s2sad.normalize.loops import LONGEST
from s2sad.structure import step
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, AugAssign, BoolOp, Break, Call, Compare, Constant, Continue, Expr, For, If,
    List, Mult, Name, Not, Return, Store, Sub, Subscript, Tuple, UnaryOp, While, assign, at, call_name, const, copy,
    index, name, names, stored_names, tuple_of, walk,
)

Env = dict[str, "Value | Conflict | Ordinary"]
_KEPT_LOCALLY = "return the value, or write it to an element of an array argument"


class Blocks(Values):
    """The statements of one kernel; `returned` are the structures that it returns."""

    def __init__(self, kernel, maker, report, fresh: Callable[[str], str]):
        super().__init__(kernel, maker, report)
        self.fresh = fresh
        self.returned: list[tuple[Return, Group]] = []
        self.jumps: list[list[Env]] = []

    def block(self, statements: list[AST]) -> list[AST]:
        made: list[AST] = []
        for node in statements:
            made += [at(s, node) for s in self._statement(node)]
        return made

    def _statement(self, node: AST) -> list[AST]:
        known = _STEPS.get(type(node))
        if known is not None:
            return known(self, node)
        if isinstance(node, (Break, Continue)) and self.jumps:
            self.jumps[-1].append(dict(self.env))
        return [self.plain(node)]

    # -- assignments ---------------------------------------------------------------------------------------------------

    def _assign(self, node: Assign) -> list[AST]:
        before, value = self._result(node.value, node.targets)
        if isinstance(value, (Group, Leaf)) and not (isinstance(value, Leaf) and usable(value)) or nothing(value):
            return before + [s for t in node.targets for s in self._bound(t, value, node)]
        plain = self.plainly(value, node.value)
        targets = [self._target(t, plain) for t in node.targets]
        return [*before, Assign(targets, plain, None)]

    def _result(self, node: AST, targets: list[AST]) -> tuple[list[AST], Value]:
        """A value that may be what a helper returns as a structure: the call comes before."""
        if not isinstance(node, Call) or user_call(node) is None:
            return [], self.value(node)
        callee, made, passed = self.call(node)
        if callee is None or callee.result is None:
            return [], Plain(made)
        wanted = targets[0].id if targets and isinstance(targets[0], Name) else user_call(node) or ""
        old = self.env.get(wanted) if targets and isinstance(targets[0], Name) else None
        return self._received(made, callee.result, passed, wanted, old)

    def _received(self, made: Call, result: Group, passed: dict[int, Leaf], wanted: str,
                  old: Value | Conflict | None) -> tuple[list[AST], Value]:
        """What a helper returned, in names of its own, or in those that its name had before."""
        kept = isinstance(old, Group) and self._replaceable(wanted, old, result)
        earlier = [leaf for leaf in flat(old) if isinstance(leaf, Leaf)] if kept and isinstance(old, Group) else []
        bound: list[str] = []

        def received(value: Value, path: str) -> Value:
            if isinstance(value, Group):
                parts = [received(i, step(value.form, path, k)) for k, i in zip(value.form.keys, value.items)]
                return replace(value, items=tuple(parts), path=path)
            if not isinstance(value, Leaf) or not usable(value):
                return value
            if value.place >= 0 and not earlier:
                return passed.get(value.place, value)
            bound.append(earlier[len(bound)].name if earlier else self.fresh(path))
            return Leaf(bound[-1], path, UNKNOWN)
        group = received(result, wanted)
        if not bound:
            return [Expr(made)], group
        target = name(bound[0]) if len(bound) == 1 else tuple_of(*map(name, bound))
        return [assign(target, made)], group

    def _replaceable(self, identifier: str, old: Group, result: Group) -> bool:
        """Whether a name's flat names can take new values: nothing else means them, and no field can be assigned."""
        held = {leaf.name for leaf in flat(old) if isinstance(leaf, Leaf)}
        others = {leaf.name for n, v in self.env.items() if n != identifier and isinstance(v, (Group, Leaf))
                  for leaf in flat(v) if isinstance(leaf, Leaf)}
        values = [leaf for leaf in flat(result) if isinstance(leaf, Leaf)]
        return (not held & others and _shape(old) == _shape(result) and _fixed(old)
                and all(leaf.place < 0 for leaf in values))

    def _target(self, target: AST, value: AST | None) -> AST:
        """A target of a plain value."""
        if isinstance(target, Name):
            self.env[target.id] = ORDINARY
            return target
        if isinstance(target, (Tuple, List)):
            parts = value.elts if isinstance(value, (Tuple, List)) and len(value.elts) == len(target.elts) else None
            return type(target)([self._target(t, parts[k] if parts else None) for k, t in enumerate(target.elts)],
                                target.ctx)
        if isinstance(target, (Attribute, Subscript)):
            return self._stored(target, value, False) or self.plain(target)
        return target

    def stored(self, node: AST) -> AST | None:
        return self._stored(node, None, False)

    def _bound(self, target: AST, value: Value, node: AST, alias: frozenset[str] | None = None) -> list[AST]:
        """The statements that give a target a structure, or None; the names of `alias` must be assigned."""
        if isinstance(target, Name):
            return self._named(target, value, alias)
        if isinstance(target, (Tuple, List)):
            if not isinstance(value, Group):
                return [Assign([self._target(target, None)], self.plainly(value, node), None)]
            if len(value.items) != len(target.elts):
                self.refuse(target, f"{len(target.elts)} targets for {len(value.items)} values", code="S203")
                return []
            return self._parallel(target.elts, value, node, alias)
        if isinstance(target, (Attribute, Subscript)) and self._stored(target, None, False) is not None:
            self.refuse(target, "a structure or None is assigned to a field", "assign its fields one by one")
        elif isinstance(target, (Attribute, Subscript)):
            return [Assign([self.plain(target)], self.plainly(value, node), None)]
        return []

    def _named(self, target: Name, value: Value, alias: frozenset[str] | None) -> list[AST]:
        if isinstance(value, Group):
            made, self.env[target.id] = self._kept(value, target.id)
            return made
        if nothing(value) or isinstance(value, Leaf) and not usable(value):
            self.env[target.id] = value if isinstance(value, Leaf) else Leaf("", target.id, NONE)
            return []
        if alias is not None and target.id not in alias and isinstance(value, Leaf) and value.type.is_array:
            self.env[target.id] = value
            return []
        plain = self.plainly(value, target)
        constant = alias is not None and target.id not in alias and isinstance(plain, Constant)
        self.env[target.id] = Plain(plain) if constant else ORDINARY
        return [] if constant and isinstance(plain.value, str) else [Assign([target], plain, None)]

    def _kept(self, group: Group, wanted: str) -> tuple[list[AST], Group]:
        """A group whose plain items have names of their own."""
        before: list[AST] = []
        items: list[Value] = []
        for key, item in zip(group.form.keys, group.items):
            if isinstance(item, Group):
                inner, item = self._kept(item, step(group.form, wanted, key))
                before += inner
            elif isinstance(item, Plain) and not isinstance(item.node, Constant) or (
                    isinstance(item, Leaf) and item.is_cell and group.path == "the tuple"):
                held = self.fresh(step(group.form, wanted, key))
                origin = item.node if isinstance(item, Plain) else name(held)
                before.append(assign(held, spelled(item, origin) or origin))
                item = Leaf(held, step(group.form, wanted, key), UNKNOWN)
            items.append(item)
        return before, replace(group, items=tuple(items))

    def _parallel(self, targets: list[AST], value: Group, node: AST, alias: frozenset[str] | None) -> list[AST]:
        """The items of a structure, bound at once."""
        plain: list[tuple[AST, AST]] = []
        made: list[AST] = []
        for target, item in zip(targets, value.items):
            simple = spelled(item, node) if not isinstance(item, Group) and not nothing(item) else None
            if simple is None or alias is not None and isinstance(target, Name):
                made += self._bound(target, item, node, alias)
            else:
                plain.append((self._target(target, simple), simple))
        if len(plain) == 1:
            return [*made, Assign([plain[0][0]], plain[0][1], None)]
        if plain:
            left = at(Tuple([t for t, _ in plain], Store()), node)
            made.append(Assign([left], at(tuple_of(*[v for _, v in plain]), node), None))
        return made

    def _augmented(self, node: AugAssign) -> list[AST]:
        value = self.plain(node.value)
        target = node.target
        if isinstance(target, (Attribute, Subscript)):
            found = self._stored(target, value, True, node.op)
            return [AugAssign(found if found is not None else self.plain(target), node.op, value)]
        found = self.env.get(target.id) if isinstance(target, Name) else None
        if isinstance(found, Leaf) and found.type.is_array:
            return [AugAssign(at(Name(found.name, Store(), None, None), target), node.op, value)]
        if isinstance(found, (Group, Leaf, Conflict)):
            self.plainly(found, target) if not isinstance(found, Conflict) else self.value(name(target.id))
        if isinstance(target, Name):
            self.env[target.id] = ORDINARY
        return [AugAssign(target, node.op, value)]

    # -- fields that are assigned --------------------------------------------------------------------------------------

    def _stored(self, node: AST, value: AST | None, augmented: bool, op: AST | None = None) -> AST | None:
        """The target for an item of a structure; None if the target is no such item."""
        base = self.structural(node.value)
        if not isinstance(base, Group):
            if isinstance(node, Attribute):
                said = f"{node.value.id}.{node.attr}" if isinstance(node.value, Name) else f".{node.attr}"
                self.refuse(node, f"an assignment to the attribute {said} {NO}", _KEPT_LOCALLY)
                return at(Name("_", Store(), None, None), node)
            return None
        read = type(node)(*[getattr(node, f) for f in node._fields[:-1]], name("x").ctx)
        item = self.field_of(base, at(read, node)) if isinstance(node, Attribute) else self.item_of(base, at(read, node))
        dummy = at(Name("_", Store(), None, None), node)
        if not isinstance(item, Leaf) or not self._assignable(base, item, node, augmented):
            if isinstance(item, Group):
                self.refuse(node, f"'{item.path}' is {item.form}, which is replaced by another value",
                            "assign what is in it")
            return dummy
        if item.type.is_array:
            return at(Name(item.name, Store(), None, None), node)
        if not item.is_cell and item.place < 0:
            return at(Name(item.name, Store(), None, None), node)
        if not _keeps_dtype(item, value, augmented, op):
            self.refuse(node, f"'{item.path}' is of type {item.type.dtype or item.type}, and what is assigned need not "
                        "be", "give a float (0.0, not 0) if it is a real quantity", "S203")
        if not item.is_cell:
            self.needed.add(item.place)
        cell = index(name(item.name), const(0))
        return at(Subscript(cell.value, cell.slice, Store()), node)

    def _assignable(self, base: Group, item: Leaf, node: AST, augmented: bool) -> bool:
        if base.form.fixed:
            what = "a frozen dataclass" if base.form.kind == "record" else str(base.form)
            self.refuse(node, f"'{base.path}' is {what}, to which nothing can be assigned",
                        f"write into an array, {item.path}[...] = ..." if item.type.is_array else
                        "return the new value")
        elif nothing(item) or not usable(item):
            self._unusable(item, node)
        elif item.type.is_array and not augmented:
            self.refuse(node, f"the array '{item.path}' is replaced by another one",
                        f"write into it: {item.path}[...] = ...")
        elif item.type.kind == "text":
            self.refuse(node, f"'{item.path}' is a str, which is replaced by another one", "use an int")
        else:
            return True
        return False

    # -- control -------------------------------------------------------------------------------------------------------

    def _if(self, node: If) -> list[AST]:
        decided = self.decide(node.test)
        if decided is not None:
            return self.block(node.body if decided else node.orelse)
        test, start = self.plain(node.test), dict(self.env)
        body, after = self.block(node.body), self.env
        self.env = start
        orelse = self.block(node.orelse)
        if FALL not in exits(orelse):
            self.env = after
        elif FALL in exits(body):
            self.env = _merged(after, self.env)
        return [If(test, body, orelse)]

    def _while(self, node: While) -> list[AST]:
        if self.decide(node.test) is False:
            return self.block(node.orelse)
        test, body = node.test, node.body

        def once() -> list[AST]:
            return [While(self.plain(test), self.block(body), [])]
        loop = self._looped(once)
        loop[0].orelse = self.block(node.orelse)
        return loop

    def _looped(self, once: Callable[[], list[AST]]) -> list[AST]:
        """A loop's body under what holds in every iteration."""
        start, mark, returned = dict(self.env), len(self.report.found), len(self.returned)
        while True:
            self.env = dict(start)
            self.jumps.append([])
            made = once()
            ends = [self.env, *self.jumps.pop()]
            merged = start
            for end in ends:
                merged = _merged(merged, end)
            if all(merged.get(n) == start[n] for n in start):
                self.env = merged
                return made
            start = {n: merged[n] for n in start}
            del self.report.found[mark:], self.returned[returned:]

    def _for(self, node: For) -> list[AST]:
        items = self._items(node.iter, node)
        if items is None:
            iterable = self.plain(node.iter)

            def once() -> list[AST]:
                target = self._target(node.target, None)
                return [For(target, iterable, self.block(node.body), [], None)]
            loop = self._looped(once)
            loop[0].orelse = self.block(node.orelse)
            return loop
        if {BREAK, CONTINUE} & exits(node.body):
            return self._spelled(node, items)
        if len(items) > LONGEST * 4:
            self.refuse(node.iter, f"a loop over a structure of {len(items)} items", "put them into an array")
            return []
        stored = {t.id for s in walk(node.body) if isinstance(s, (Assign, For))
                  for t in walk(getattr(s, "targets", None) or [s.target])
                  if isinstance(t, Name) and isinstance(t.ctx, Store)}
        made: list[AST] = []
        for item in items:
            made += [at(s, node) for s in self._bound(copy(node.target), item, node, frozenset(stored))]
            made += self.block(copy(node.body))
        return made + self.block(node.orelse)

    def _spelled(self, node: For, items: list[Value]) -> list[AST]:
        """A loop that is left early goes through a tuple that is written out."""
        shown = [spelled(item, node.iter) for item in items]
        if any(s is None for s in shown):
            self.refuse(node, "a loop over structures, or over a structure and None, is left by break or continue",
                        "put the body under an if")
            return []
        iterable = at(tuple_of(*[s for s in shown if s is not None]), node.iter)

        def once() -> list[AST]:
            return [For(self._target(copy(node.target), None), iterable, self.block(node.body), [], None)]
        loop = self._looped(once)
        loop[0].orelse = self.block(node.orelse)
        return loop

    def _items(self, iterable: AST, loop: For | None = None) -> list[Value] | None:
        """The items of a loop that is written out because of structures; None for any other loop."""
        called, parts = call_name(iterable), getattr(iterable, "args", [])
        if called == "builtins.reversed" and len(parts) == 1:
            inner = self._items(parts[0], loop)
            return None if inner is None else inner[::-1]
        if called == "builtins.enumerate" and len(parts) == 1 and not iterable.keywords:
            inner = self._items(parts[0])
            return None if inner is None else [listed((Plain(at(const(k), iterable)), i)) for k, i in enumerate(inner)]
        if called == "builtins.zip":
            return self._zipped(iterable)
        if called == "builtins.range" and loop is not None and self._picks(loop):
            bounds = [self.key(p) for p in parts]
            if bounds and all(isinstance(b, int) for b in bounds):
                return [Plain(at(const(k), iterable)) for k in range(*bounds)]
        found = self.structural(iterable)
        if not isinstance(found, Group):
            return None
        if found.form.kind == "dict":
            return [Plain(at(const(k), iterable)) for k in found.form.keys]
        return list(found.items) if found.form.is_sequence else None

    def _zipped(self, iterable: Call) -> list[Value] | None:
        columns = [self._items(p) for p in iterable.args]
        if all(c is None for c in columns):
            return None
        for k, part in enumerate(iterable.args):
            if columns[k] is None and isinstance(part, (Tuple, List)):
                columns[k] = [self.value(e) for e in part.elts]
            elif columns[k] is None and call_name(part) == "builtins.range":
                bounds = [self.key(p) for p in part.args]
                if all(isinstance(b, int) for b in bounds):
                    columns[k] = [Plain(at(const(i), part)) for i in range(*bounds)]
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
                if isinstance(found, Group):
                    return True
        return False

    # -- the rest ------------------------------------------------------------------------------------------------------

    def _expression(self, node: Expr) -> list[AST]:
        before, value = self._result(node.value, [])
        if before or isinstance(value, (Group, Leaf)):
            return before
        return [Expr(value.node)]

    def _return(self, node: Return) -> list[AST]:
        if node.value is None or isinstance(node.value, Constant) and node.value.value is None:
            return [Return(node.value)]
        before, value = self._result(node.value, [])
        if nothing(value):
            return [*before, Return(at(const(None), node))]
        if not isinstance(value, Group):
            return [*before, Return(self.plainly(value, node.value))]
        made, value = self._kept(value, "result")
        last = Return(None)
        self.returned.append((last, value))
        return [*before, *made, last]

    def _assert(self, node: Assert) -> list[AST]:
        decided = self.decide(node.test)
        if decided:
            return []
        test = self.plain(node.test) if decided is None else at(const(False), node.test)
        return [Assert(test, None if node.msg is None else self.plain(node.msg))]


def _merged(a: Env, b: Env) -> Env:
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
            found[n] = _either(one, other)
    return found


def _either(one: Value | Conflict | Ordinary, other: Value | Conflict | Ordinary) -> Value | Conflict | Ordinary:
    """One structure whose flat names are the same, whatever they hold; else a conflict."""
    if isinstance(one, Group) and isinstance(other, Group) and one.form.keys == other.form.keys and one.form.fixed:
        parts = [_either(x, y) for x, y in zip(one.items, other.items)]
        if all(isinstance(p, (Plain, Leaf, Group)) for p in parts):
            return replace(one, items=tuple(parts))  # pyright: ignore[reportArgumentType]
    if isinstance(one, Leaf) and isinstance(other, Leaf) and one.name and one.name == other.name and not (
            one.is_cell or other.is_cell):
        return replace(one, place=-1, type=one.type if one.type == other.type else UNKNOWN)
    return one if one == other else Conflict()


def _shape(value: Value) -> object:
    """The keys of a structure and of what is in it."""
    if isinstance(value, Group):
        return (value.form.kind, value.form.keys, tuple(map(_shape, value.items)))
    return nothing(value)


def _fixed(value: Value) -> bool:
    """Whether no part of a structure can be assigned, so that nobody sees that its names take new values."""
    return not isinstance(value, Group) or value.form.fixed and all(map(_fixed, value.items))


def _keeps_dtype(item: Leaf, value: AST | None, augmented: bool, op: AST | None) -> bool:
    """Whether what is assigned to a number surely has its type; an element of an array cannot change it."""
    dtype = item.type.dtype
    if dtype in ("", "float64"):
        return True
    if dtype == "bool":
        return isinstance(value, (Compare,)) or isinstance(value, Constant) and isinstance(value.value, bool) or (
            isinstance(value, UnaryOp) and isinstance(value.op, Not)) or isinstance(value, BoolOp) and all(
            _keeps_dtype(item, v, False, None) for v in value.values)
    whole = isinstance(value, Constant) and type(value.value) is int
    return dtype.startswith(("int", "uint")) and whole and (not augmented or isinstance(op, (Add, Sub, Mult)))


_STEPS: dict[type, Callable[[Blocks, AST], list[AST]]] = {
    Assign: Blocks._assign, AugAssign: Blocks._augmented, If: Blocks._if, While: Blocks._while, For: Blocks._for,
    Expr: Blocks._expression, Return: Blocks._return, Assert: Blocks._assert,
}
