"""How names take values while structures are taken apart.

    q = state.inner              ->   (nothing: q.u is state_inner_u from here on)
    w, b = layers[1]             ->   w, b = layers_1_0, layers_1_1
    o = Orbit(o.x + o.v, o.v)    ->   o_x = o_x + o_v
    state = step(state, p)       ->   state_u, state_t = step(state_u, state_t, p_k)

The flat names of a structure take new values only where nothing else means them and nothing can be assigned to it, so
that nobody could tell; the values of one statement are all read before the first is stored.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.diagnostics import Report
from s2sad.infer.types import NONE, UNKNOWN
from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.structures.assign_fields import Assignments
from s2sad.evaluate.structures.call_values import Maker, Passed, plain_tuple
from s2sad.evaluate.structures.groups import (
    ORDINARY, SPELLED, Conflict, StructureValue, Leaf, Ordinary, Plain, Value, flat, listed, nothing, spelled, usable,
)
from s2sad.program import Kernel
from s2sad.pytree import step
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, Expr, List, Name, Store, Subscript, Tuple, assign, at,
    const, equal, keyword, name, stored_names, tuple_of, walk,
)

Env = dict[str, "Value | Conflict | Ordinary"]
Pair = tuple[AST, AST]
_OTHERS = ".others"                     # no user's name: what else the statement binds


class Bindings(Assignments):
    """What statements bind; `fresh` gives names for paths, `in_loop` says whether a loop surrounds the statement."""

    def __init__(self, kernel: Kernel, maker: Maker, report: Report, fresh: Callable[[str], str]):
        super().__init__(kernel, maker, report)
        self.fresh = fresh
        self.in_loop = False
        stores = [n.id for n in walk(kernel.tree.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        self.rebound = {n for n in stores if stores.count(n) > 1 or n in kernel.parameters}
        self.assigned_keys = _assigned(kernel)
        self.anywhere_assigned = {k for every in maker.program.kernels.values() for k in _assigned(every)}

    # -- values --------------------------------------------------------------------------------------------------------

    def result(self, node: AST, targets: list[AST]) -> tuple[list[AST], Value]:
        """A value that may be what a helper returns as a structure: the call comes before."""
        called = self.as_call(node)
        if called is None:
            return [], self.value(node)
        before: list[AST] = []
        callee, made, passed = self.call(called)
        given = flat(callee.result) if callee is not None and callee.result is not None else ()
        if any(isinstance(leaf, Leaf) and leaf.place >= 0 and leaf.place not in passed for leaf in given):
            before, called = self._under_names(called)
            callee, made, passed = self.call(called)
        if callee is None or callee.result is None:
            return before, Plain(made)
        target = targets[0] if len(targets) == 1 else None
        if isinstance(target, (Tuple, List)) and _straight(target, callee.result):
            return before, Plain(made)
        wanted = target.id if isinstance(target, Name) else user_call(called) or ""
        after, value = self._received(made, callee.result, passed, wanted,
                                      self.env.get(wanted) if target is not None else None)
        return [*before, *after], value

    def _under_names(self, called: Call) -> tuple[list[AST], Call]:
        """A call with names for the structures that are written out in it, and the statements that bind these; where
        another argument calls a function, which is called in its turn, it stays."""
        if any(user_call(n) is not None for a in (*called.args, *called.keywords) for n in walk(a)):
            return [], called
        before: list[AST] = []

        def named(argument: AST) -> AST:
            value = self.argument(argument)
            if not isinstance(value, StructureValue) or value.path != SPELLED:
                return argument
            held = name(self.fresh("given"))
            before.extend(self.bound(held, value, argument))
            return at(held, argument)
        arguments = list(map(named, called.args))
        keywords = [at(keyword(str(k.arg), named(k.value)), k.value) for k in called.keywords]
        return before, at(Call(called.func, arguments, keywords), called)

    def _received(self, made: Call, result: StructureValue, passed: Passed, wanted: str,
                  old: Value | Conflict | Ordinary | None) -> tuple[list[AST], Value]:
        """What a helper returned, in names of its own, or in those that its name had before."""
        kept = (isinstance(old, StructureValue) and self._replaceable(wanted, old, result)
                and all(isinstance(leaf, Leaf) and leaf.place < 0 for leaf in flat(result)))
        earlier = [leaf for leaf in flat(old) if isinstance(leaf, Leaf)] if kept and isinstance(old,
                                                                                                StructureValue) else []
        bound: list[str] = []

        def received(value: Value, path: str) -> Value:
            if isinstance(value, StructureValue):
                parts = [received(i, step(value.form, path, k)) for k, i in zip(value.form.keys, value.items)]
                return replace(value, items=tuple(parts), path=path)
            if not isinstance(value, Leaf) or not usable(value):
                return value
            if value.place >= 0:
                if value.place not in passed:
                    self.refuse(made, "a structure is written out where it is given to a function that returns it",
                                "give it a name before: s = S(...)")
                return passed.get(value.place, replace(value, place=-1))
            bound.append(earlier[len(bound)].name if earlier else self.fresh(path))
            return Leaf(bound[-1], path, UNKNOWN)
        group = received(result, wanted)
        if not bound:
            return [Expr(made)], group
        target = name(bound[0]) if len(bound) == 1 else tuple_of(*map(name, bound))
        return [assign(target, made)], group

    # -- names ---------------------------------------------------------------------------------------------------------

    def target(self, target: AST, value: AST | None) -> AST:
        """A target of a plain value."""
        if isinstance(target, Name):
            self.env[target.id] = ORDINARY
            return target
        if isinstance(target, (Tuple, List)):
            parts = value.elts if isinstance(value, (Tuple, List)) and len(value.elts) == len(target.elts) else None
            return type(target)([self.target(t, parts[k] if parts else None) for k, t in enumerate(target.elts)],
                                target.ctx)
        if isinstance(target, (Attribute, Subscript)):
            return self.assigned(target, value, False) or self.plain(target)
        return target

    def bound(self, target: AST, value: Value, node: AST, unrolled: frozenset[str] | None = None) -> list[AST]:
        """The statements that give a target a structure, or None. In a loop that is written out, names that its body
        does not bind (`unrolled` are those that it does) only mean their items."""
        env: Env = {}
        pairs = self._pairs(target, value, node, unrolled, env)
        self.env |= env
        if len(pairs) < 2:
            return [Assign([_storing(t)], v, None) for t, v in pairs]
        left = at(Tuple([_storing(t) for t, _ in pairs], Store()), node)
        return [Assign([left], at(tuple_of(*[v for _, v in pairs]), node), None)]

    def _pairs(self, target: AST, value: Value, node: AST, unrolled: frozenset[str] | None, env: Env) -> list[Pair]:
        if isinstance(target, (Tuple, List)):
            if not isinstance(value, StructureValue):
                return [(self.target(target, None), self.plainly(value, node))]
            self.gone_through(value, node)
            if value.form.kind == "record":
                self.plainly(value, node)
            if len(value.items) != len(target.elts):
                self.refuse(target, f"{len(target.elts)} targets for {len(value.items)} values", code="S203")
                return []
            found: list[Pair] = []
            before = self.env.get(_OTHERS)
            for k, (part, item) in enumerate(zip(target.elts, value.items)):
                others = tuple(i for i in value.items[:k] + value.items[k + 1:]
                               if unrolled is not None or not self._read_at_once(i))
                self.env[_OTHERS] = listed(others if before is None else (*others, before))  # pyright: ignore
                found += self._pairs(part, item, node, unrolled, env)
            self.env.pop(_OTHERS)
            if before is not None:
                self.env[_OTHERS] = before
            return found
        if isinstance(target, Name):
            return self._named(target, value, unrolled, env)
        plain = isinstance(value, Plain) or isinstance(value, Leaf) and usable(value)
        stored = self.assigned(target, self.plainly(value, node) if plain else None, False)
        if stored is not None and not plain:
            self.refuse(target, "a structure or None is assigned to a field or an item", "assign its fields one by one")
        return [(stored if stored is not None else self.plain(target), self.plainly(value, node))]

    def _read_at_once(self, value: Value) -> bool:
        """Whether a value is copied where it is bound, so that it does not change with names that it was read from."""
        return self.in_loop and self.is_fixed(value) if isinstance(value, StructureValue) else True

    def _named(self, target: Name, value: Value, unrolled: frozenset[str] | None, env: Env) -> list[Pair]:
        if isinstance(value, StructureValue):
            old = self.env.get(target.id)
            copying = self.in_loop and unrolled is None and self.is_fixed(value)
            if isinstance(old, StructureValue) and (copying or value.path == SPELLED) and self._replaceable(
                    target.id, old, value):
                env[target.id] = _unplaced(old)
                return [(name(was.name), spelled(new, target) or const(0.0)) for was, new in zip(flat(old), flat(value))
                        if isinstance(was, Leaf) and was != new]
            constants = target.id in self.rebound and self.is_fixed(value)
            pairs, env[target.id] = self._kept(value, target, target.id, copying, constants)
            return pairs
        if nothing(value) or isinstance(value, Leaf) and not usable(value):
            env[target.id] = value if isinstance(value, Leaf) else Leaf("", target.id, NONE)
            return []
        only_meant = unrolled is not None and target.id not in unrolled
        constant = isinstance(value, Leaf) and (value.type.is_array or value.type.is_number and value.place >= 0)
        if only_meant and constant:
            env[target.id] = value
            return []
        plain = self.plainly(value, target)
        written = only_meant and isinstance(plain, Constant)
        env[target.id] = Plain(plain) if written else ORDINARY
        return [] if written and isinstance(plain.value, str) else [(target, plain)]

    def _kept(self, group: StructureValue, origin: AST, wanted: str, copying: bool, constants: bool = False
              ) -> tuple[list[Pair], StructureValue]:
        """A group whose expressions have names of their own; `copying` its names, too. Of one that is spelled out for
        a name that is bound again (`constants`) everything has, so that it can take new values."""
        pairs: list[Pair] = []
        items: list[Value] = []
        for key, item in zip(group.form.keys, group.items):
            path = step(group.form, wanted, key)
            if isinstance(item, StructureValue):
                inner, part = self._kept(item, origin, path, copying, constants)
                pairs += inner
                items.append(part)
            elif isinstance(item, Plain) and not self._stays(group, key, item, constants) or isinstance(
                    item, Leaf) and usable(item) and (copying or (constants or item.is_cell) and group.path == SPELLED):
                held = self.fresh(path)
                pairs.append((name(held), spelled(item, origin) or const(0.0)))
                items.append(Leaf(held, path, UNKNOWN))
            else:
                items.append(item)
        path = wanted if group.path == SPELLED or copying else group.path
        return pairs, replace(group, items=tuple(items), path=path)

    def _stays(self, group: StructureValue, key: object, item: Plain, constants: bool) -> bool:
        """Whether an item is a constant that it remains: nothing is assigned to it."""
        assigned = not group.form.fixed and key in self.assigned_keys
        return isinstance(item.node, Constant) and (nothing(item) or isinstance(item.node.value, str) or not (
            constants or assigned))

    def kept(self, group: StructureValue, origin: AST, wanted: str) -> tuple[list[AST], StructureValue]:
        """A structure whose expressions have names of their own, given before."""
        pairs, group = self._kept(group, origin, wanted, False)
        return [assign(t, v) for t, v in pairs], group

    def detached(self, body: list[AST]) -> list[AST]:
        """Structures that a loop gives new values have names of their own before it."""
        made: list[AST] = []
        for identifier in stored_names(body):
            old = self.env.get(identifier)
            if not isinstance(old, StructureValue) or not self.is_fixed(old) or not self._shared(identifier,
                                                                                                 old) or any(
                    isinstance(leaf, Plain) or leaf.is_cell for leaf in flat(old)):
                continue
            fresh = {leaf.name: self.fresh(leaf.path.replace(old.path, identifier, 1)) for leaf in flat(old)
                     if isinstance(leaf, Leaf)}
            made += [assign(new, name(was)) for was, new in fresh.items()]
            self.env[identifier] = _unplaced(old, fresh)
        return made

    def is_fixed(self, value: Value) -> bool:
        """Whether no part of a structure can be assigned, or none is, so that nobody sees that its names take new
        values."""
        return not isinstance(value, StructureValue) or all(map(self.is_fixed, value.items)) and (
            value.form.fixed or value.form.kind == "record" and not self.anywhere_assigned & {*value.form.keys})

    def _shared(self, identifier: str, group: StructureValue) -> bool:
        """Whether another name means a part of the structure."""
        held = {leaf.name for leaf in flat(group) if isinstance(leaf, Leaf)}
        return any(isinstance(leaf, Leaf) and leaf.name in held for n, v in self.env.items()
                   if n != identifier and isinstance(v, (StructureValue, Leaf)) for leaf in flat(v))

    def _replaceable(self, identifier: str, old: StructureValue, result: StructureValue) -> bool:
        """Whether a name's flat names can take new values: nothing else means them, and no field can be assigned."""
        return (_shape(old) == _shape(result) and self.is_fixed(old) and not self._shared(identifier, old)
                and all(isinstance(leaf, Leaf) and not leaf.is_cell or isinstance(leaf, Plain) and isinstance(
                    new, Plain) and equal(leaf.node, new.node) for leaf, new in zip(flat(old), flat(result))))


def _assigned(kernel: Kernel) -> set[object]:
    """The names of fields, and the keys, that a kernel assigns to."""
    stored = [n for n in walk(kernel.tree.body) if isinstance(n, (Attribute, Subscript)) and isinstance(n.ctx, Store)]
    return {n.attr if isinstance(n, Attribute) else getattr(n.slice, "value", None) for n in stored}


def _storing(target: AST) -> AST:
    return Name(target.id, Store(), None, None) if isinstance(target, Name) else target


def _straight(target: AST, result: StructureValue) -> bool:
    """Whether the names of a target are the results of a call, one by one."""
    return plain_tuple(result) and len(target.elts) == len(result.items) and all(
        isinstance(t, Name) for t in target.elts)


def _unplaced(value: StructureValue, fresh: dict[str, str] | None = None) -> StructureValue:
    """The structure whose names are no parameters any more."""
    items = [_unplaced(i, fresh) if isinstance(i, StructureValue) else
             replace(i, name=(fresh or {}).get(i.name, i.name), place=-1, type=UNKNOWN)
             if isinstance(i, Leaf) and usable(i) else i for i in value.items]
    return replace(value, items=tuple(items))


def _shape(value: Value) -> object:
    """The keys of a structure and of what is in it."""
    if isinstance(value, StructureValue):
        return (value.form.kind, value.form.keys, tuple(map(_shape, value.items)))
    return nothing(value)
