"""Assignments to several targets become assignments to one.

    a, b = p              ->  a = p[0]; b = p[1]
    x, y = i * dx, j * dx ->  x = i * dx; y = j * dx
    a, b = b, a           ->  a_value = b; b_value = a; ... only where a later value reads an earlier target
    u = v = np.zeros(n)   ->  u = np.zeros(n); v = u
"""
from __future__ import annotations

from s2sad.evaluate.argument_binding import result_count, user_call
from s2sad.normalize.control.hoist import bound_call, hoist, hoist_all, impure, into, operands, replace_operands
from s2sad.evaluate.effects import STABLE
from s2sad.evaluate.scope import KernelScope, atomic
from s2sad.evaluate.unpacking import item_count
from s2sad.liveness import base_name
from s2sad.tree import (
    AST, Attribute, Constant, List, Name, Subscript, Tuple, assign, const, copy, index,
    name, names, stored_names, tuple_of,
)

Pair = tuple[AST, AST]


def unpack(targets: list[AST], value: AST, scope: KernelScope) -> list[AST]:
    """`targets[0] = targets[1] = ... = value` as assignments in structured form."""
    if len(targets) == 1:
        return _assigned(targets[0], value, scope)
    first, *rest = targets
    statements: list[AST] = []
    if isinstance(first, Name) and not isinstance(value, (Constant, Tuple, List)):
        statements += _assigned(first, value, scope)
        value = name(first.id)
    else:
        rest = targets
        before, value = _once(targets, value, scope)
        statements += before
    for position, target in enumerate(rest):
        if set(names(value)) & {n for earlier in rest[:position] for n in stored_names(earlier)}:
            scope.refuse(target, "a name is bound twice in one statement", help="write one assignment per line")
        statements += _assigned(target, copy(value), scope)
    return statements


def _once(targets: list[AST], value: AST, scope: KernelScope) -> tuple[list[AST], AST]:
    """The value evaluated once: as it is if it is a constant or an untouched name, else held in names."""
    stored = {n for target in targets for n in stored_names(target)}
    if atomic(value) and not stored & set(names(value)):
        return [], value
    if isinstance(value, (Tuple, List)) and all(isinstance(t, (Tuple, List)) for t in targets):
        statements, items = hoist_all(value.elts, scope)
        return statements, tuple_of(*[scope.held(item, "held", statements) for item in items])
    statements, value = hoist(value, scope)
    return statements, scope.held(value, "held", statements)


def _assigned(target: AST, value: AST, scope: KernelScope) -> list[AST]:
    if isinstance(target, (Tuple, List)):
        return _unpacked(target, value, scope)
    if isinstance(target, Name):
        return into(target, value, scope)
    if isinstance(target, Subscript):
        return _stored(target, value, scope)
    unassignable(target, scope)
    return []


def unassignable(target: AST, scope: KernelScope) -> None:
    """Refuses a target that is neither a name nor an element."""
    if not isinstance(target, Attribute):
        scope.refuse(target, "this cannot be assigned to", help="assign to a name or to an element of an array")
        return
    help = ("bind the new shape to a new name: y = x.reshape(...)" if target.attr == "shape" else
            "store both parts: z[...] = a + 1j * b" if target.attr in ("real", "imag") else
            "return the value, or write it to an element of an array argument")
    scope.refuse(target, f"an assignment to the attribute .{target.attr} is not supported in a kernel", help=help)


def _stored(target: Subscript, value: AST, scope: KernelScope) -> list[AST]:
    if not impure(target):
        return into(target, value, scope)
    parts = operands(target)
    before, (value, *new) = hoist_all([value, *parts], scope)
    return [*before, assign(replace_operands(target, parts, new), value)]


def _unpacked(target: AST, value: AST, scope: KernelScope) -> list[AST]:
    statements: list[AST] = []
    called = user_call(value)
    if called is not None and result_count(called, scope.program) > 1:
        return _results(target, value, scope)
    if not isinstance(value, (Tuple, List)):
        before, value = hoist(value, scope)
        statements += before
        if not _cheap(value):
            value = scope.held(value, "items", statements)
    statements += _counted(target, value, scope)
    return statements + _parallel(_pairs(target, value, scope), scope)


def _counted(target: AST, value: AST, scope: KernelScope) -> list[AST]:
    """The guards that arrays and lists have as many items as targets; what a function gives may be a tuple."""
    if not isinstance(target, (Tuple, List)):
        return []
    if isinstance(value, (Tuple, List)):
        return [guard for t, v in zip(target.elts, value.elts) for guard in _counted(t, v, scope)]
    if not _cheap(value) or isinstance(value, Attribute) or base_name(value) not in scope.sequences:
        return []
    return [item_count(value, len(target.elts)), *(
        guard for k, t in enumerate(target.elts) for guard in _counted(t, index(copy(value), const(k)), scope))]


def _cheap(value: AST) -> bool:
    """Whether an expression may be written once per item: a name, x.shape, x[i]."""
    if isinstance(value, Attribute):
        return value.attr in STABLE and isinstance(value.value, Name)
    if isinstance(value, Subscript):
        return _cheap(value.value) and all(map(atomic, operands(value)[1:])) and operands(value)[1:] != []
    return isinstance(value, Name)


def _results(target: AST, value: AST, scope: KernelScope) -> list[AST]:
    """`a, b = f(x)` keeps its tuple of names."""
    kernel = user_call(value)
    assert kernel is not None
    before, bound = bound_call(value, scope)
    count = result_count(kernel, scope.program)
    if count != len(target.elts):
        scope.refuse(value, f"{kernel} returns {count} values, here are {len(target.elts)} names", code="S203")
        return []
    direct = all(isinstance(t, Name) for t in target.elts) and len({t.id for t in target.elts}) == len(target.elts)
    if direct:
        scope.memory.bind([t.id for t in target.elts], bound)
        return [*before, assign(target, bound)]
    fresh = [scope.fresh(f"{kernel}_{k}") for k in range(len(target.elts))]
    scope.memory.bind(fresh, bound)
    after = [s for t, f in zip(target.elts, fresh) for s in _assigned(t, name(f), scope)]
    return [*before, assign(tuple_of(*map(name, fresh)), bound), *after]


def _pairs(target: AST, value: AST, scope: KernelScope) -> list[Pair]:
    """The single assignments, as targets with values, tuples within tuples flattened."""
    if not isinstance(target, (Tuple, List)):
        return [(target, value)]
    if isinstance(value, (Tuple, List)):
        if len(value.elts) != len(target.elts):
            scope.refuse(target, f"{len(target.elts)} targets for {len(value.elts)} values", code="S203")
            return []
        return [pair for t, v in zip(target.elts, value.elts) for pair in _pairs(t, v, scope)]
    if not _cheap(value):
        return [(target, value)]
    return [pair for k, t in enumerate(target.elts) for pair in _pairs(t, index(copy(value), const(k)), scope)]


def _parallel(pairs: list[Pair], scope: KernelScope) -> list[AST]:
    """All values are evaluated before the first store: in order where that is the same, else through names."""
    clash = [any(_overwrites(t, v, scope) for t, _ in pairs[:k]) for k, (_, v) in enumerate(pairs)]
    statements: list[AST] = []
    if any(clash) and impure([v for _, v in pairs]):
        before, values = hoist_all([v for _, v in pairs], scope)
        statements += before
        pairs = [(t, _before(t, v, scope, statements)) for (t, _), v in zip(pairs, values)]
    else:
        pairs = [(t, _before(t, v, scope, statements) if c else v) for (t, v), c in zip(pairs, clash)]
    for target, value in pairs:
        statements += _assigned(target, value, scope)
    return statements


def _before(target: AST, value: AST, scope: KernelScope, statements: list[AST]) -> AST:
    """The value in a name, called after what is read or what it is for."""
    if isinstance(value, Name):
        return scope.held(value, f"{value.id}_before", statements)
    return scope.held(value, f"{target.id}_after" if isinstance(target, Name) else "held", statements)


def _overwrites(target: AST, value: AST, scope: KernelScope) -> bool:
    """Whether storing into the target first would change what the value is, or what its calls see."""
    if set(stored_names(target)) & set(names(value)):
        return True
    stores: list[AST] = [assign(t, const(0)) for t in _elements(target)]
    return bool(stores) and (impure(value) or scope.memory.affected(value, scope.memory.written(stores)))


def _elements(target: AST) -> list[AST]:
    """The element stores among the targets."""
    if isinstance(target, (Tuple, List)):
        return [e for item in target.elts for e in _elements(item)]
    return [target] if isinstance(target, Subscript) else []
