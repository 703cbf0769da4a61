"""Expressions made pure: what needs statements of its own (a user's call, a conditional expression) moves before.

    y = u[i] + f(u) if c else 0.0    ->    if c:
                                               held = u[i]
                                               f_value = user.f(u)
                                               y = held + f_value
                                           else:
                                               y = 0.0

Requires resolved names. Keeps Python's order and laziness: operands from left to right, an operand that a
later one's call may change is held in a name before that call, and the right of `and`, `or` and of a
chained comparison is evaluated only where Python does.
"""
from __future__ import annotations

from s2sad.evaluate.argument_binding import bound_arguments, user_call
from s2sad.evaluate.mutating_calls import changed, stored_out
from s2sad.evaluate.scope import KernelScope, atomic
from s2sad.tree import (
    AST, And, Attribute, BoolOp, Call, Compare, Constant, If, IfExp, Name, Not, Slice, Subscript, USub, UnaryOp,
    assign, children, const, copy, dump, expr, index, indices, keyword, name, names, rebuild, walk,
)


def impure(node: AST | list[AST]) -> bool:
    """Whether an expression needs statements of its own."""
    return any(isinstance(n, IfExp) or user_call(n) is not None or _fills(n) for n in walk(node))


def hoist(node: AST, scope: KernelScope) -> tuple[list[AST], AST]:
    """The statements to run before, and the pure expression that is left."""
    if not impure(node):
        return [], node
    if isinstance(node, IfExp):
        return _named(node, "choice", scope)
    if isinstance(node, BoolOp):
        if impure(node.values[1:]):
            return _named(node, "condition", scope)
        before, first = hoist(node.values[0], scope)
        return before, _like(node, BoolOp(node.op, [first, *node.values[1:]]))
    if isinstance(node, Compare) and impure(node.comparators[1:]):
        return _named(node, "condition", scope)
    if isinstance(node, Compare) and len(node.ops) > 1:
        before, (left, middle) = hoist_all([node.left, node.comparators[0]], scope)
        return before, _like(node, Compare(left, node.ops, [middle, *node.comparators[1:]]))
    if user_call(node) is not None:
        return _called(node, scope)
    return stored(node, scope) if _fills(node) else _operands(node, scope)


def hoist_all(nodes: list[AST], scope: KernelScope) -> tuple[list[AST], list[AST]]:
    """Expressions evaluated one after the other: what runs before, and what is left of each."""
    parts = [hoist(node, scope) for node in nodes]
    statements: list[AST] = []
    left: list[AST] = []
    for position, (before, value) in enumerate(parts):
        statements += before
        later = [s for following, _ in parts[position + 1:] for s in following]
        affected = scope.memory.affected(value, scope.memory.written(later))
        left.append(scope.held(value, "held", statements) if affected else value)
    return statements, left


def into(target: AST, value: AST, scope: KernelScope) -> list[AST]:
    """Statements that leave the value in the target, a name or an element whose subscripts are pure."""
    if isinstance(value, IfExp):
        before, test = hoist(value.test, scope)
        arms = into(target, value.body, scope), into(copy(target), value.orelse, scope)
        return [*before, _like(value, If(test, *arms))]
    is_name = isinstance(target, Name)
    if is_name and user_call(value) is not None:
        before, bound = bound_call(value, scope)
        return [*before, assign(target, bound)]
    if is_name and target.id not in names(value):
        if isinstance(value, BoolOp) and impure(value.values[1:]):
            return _short_circuit(target, value, scope)
        if isinstance(value, Compare) and impure(value.comparators[1:]):
            return _chain(target, value, scope)
    before, left = hoist(value, scope)
    return [*before, assign(target, left)]


def bound_call(node: Call, scope: KernelScope) -> tuple[list[AST], Call]:
    """A user's call with pure arguments by position, and what runs before it."""
    before, arguments = hoist_all([*node.args, *(k.value for k in node.keywords)], scope)
    given = [keyword(k.arg, a) for k, a in zip(node.keywords, arguments[len(node.args):])]
    pure = _like(node, Call(node.func, arguments[:len(node.args)], given))
    return before, _like(node, Call(node.func, bound_arguments(pure, scope), []))


def _named(node: AST, wanted: str, scope: KernelScope) -> tuple[list[AST], AST]:
    target = scope.fresh(wanted)
    scope.memory.bind([target], node)
    return into(name(target), node, scope), name(target)


def _called(node: Call, scope: KernelScope) -> tuple[list[AST], AST]:
    kernel = user_call(node)
    assert kernel is not None
    before, bound = bound_call(node, scope)
    target = scope.fresh(f"{kernel}_value")
    scope.memory.bind([target], bound)
    return [*before, assign(target, bound)], name(target)


def _fills(node: AST) -> bool:
    """Whether a call inside an expression names the array for its result; one by position may be a mistake."""
    return stored_out(node) is not None and (changed(node) is not None or any(k.arg == "out" for k in node.keywords))


def stored(node: AST, scope: KernelScope) -> tuple[list[AST], AST]:
    """What fills the array that a call is given for its result, and the array: one that is made here has a name."""
    filled, value = stored_out(node) or (index(node, const(...)), node)
    made = not isinstance(filled.value, Name)
    if made and any(user_call(n) is not None for n in walk([*node.args, *node.keywords])):
        scope.refuse(node, "the array for a result is made, or a part, beside a call of a kernel",
                     help="give the array a name of its own before")
    before, place = hoist(filled.value, scope)
    if made:
        text, place = dump(filled.value), scope.held(place, "filled", before)
        value = rebuild(value, lambda n: copy(place) if isinstance(n, expr) and dump(n) == text else None)
    return [*before, *into(index(place, const(...)), value, scope)], copy(place)


def _short_circuit(target: Name, node: BoolOp, scope: KernelScope) -> list[AST]:
    first = next(k for k, v in enumerate(node.values) if k and impure(v))
    head, tail = (v[0] if len(v) == 1 else BoolOp(node.op, v) for v in (node.values[:first], node.values[first:]))
    go_on = name(target.id) if isinstance(node.op, And) else UnaryOp(Not(), name(target.id))
    return [*into(target, head, scope), If(go_on, into(copy(target), tail, scope), [])]


def _chain(target: Name, node: Compare, scope: KernelScope) -> list[AST]:
    """`a < b < f(c)`: the middle is evaluated once, the rest only if the first comparison holds."""
    statements, (left, middle) = hoist_all([node.left, node.comparators[0]], scope)
    if not atomic(middle):
        middle = scope.held(middle, "held", statements)
    first = Compare(left, node.ops[:1], [middle])
    rest = Compare(copy(middle), node.ops[1:], node.comparators[1:])
    return [*statements, assign(target, first), If(name(target.id), into(copy(target), rest, scope), [])]


def operands(node: AST) -> list[AST]:
    """The operands of one operation in the order in which Python evaluates them."""
    if isinstance(node, Subscript):
        return [node.value, *(o for i in indices(node) for o in (_present(i) if isinstance(i, Slice) else [i]))]
    if isinstance(node, Call):
        function = [node.func.value] if isinstance(node.func, Attribute) else []
        return [*function, *node.args, *(k.value for k in node.keywords)]
    return [child for child in children(node) if _is_operand(child)]


def _present(node: Slice) -> list[AST]:
    return [part for part in (node.lower, node.upper, node.step) if part is not None]


def _is_operand(node: AST) -> bool:
    # a context or an operator has neither a place nor operands
    return "lineno" in getattr(node, "_attributes", ())


def replace_operands(node: AST, old: list[AST], new: list[AST]) -> AST:
    """The operation with other operands."""
    by_id = {id(o): n for o, n in zip(old, new) if o is not n}
    return rebuild(node, lambda n: by_id.get(id(n)))


def _operands(node: AST, scope: KernelScope) -> tuple[list[AST], AST]:
    old = operands(node)
    before, new = hoist_all(old, scope)
    return before, replace_operands(node, old, new)


def constant_index(node: Subscript) -> int | None:
    """The integer constant that a subscript is, or None."""
    value, sign = node.slice, 1
    if isinstance(value, UnaryOp) and isinstance(value.op, USub):
        value, sign = value.operand, -1
    if isinstance(value, Constant) and isinstance(value.value, int) and not isinstance(value.value, bool):
        return sign * value.value
    return None


def _like(node: AST, new: AST) -> AST:
    """The new node at the place of the old one."""
    for field in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
        if hasattr(node, field):
            setattr(new, field, getattr(node, field))
    return new

